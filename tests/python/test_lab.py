# SPDX-License-Identifier: BSD-3-Clause
"""The results of `jink arena` and `jink study` as frames."""

import csv
import json

import numpy as np
import pytest

import jink


def test_reads_an_arena_to_the_bit(arena):
    results = jink.read_arena(arena)
    assert results.settings["families"] == ["crossing"] and len(results.flights) == 4
    assert set(results.flights.pilot) == {"jink", "straight"}
    lines = [json.loads(line) for line in (arena / "flights.jsonl").read_text().splitlines()][1:]
    flights = {line["job"]: line for line in lines if line["type"] == "flight"}
    for row in results.flights.itertuples():
        assert (row.flight_time_s, row.min_clearance) == (flights[row.job]["flight_time_s"], flights[row.job]["min_clearance"])
    jinks = results.table.query("family == 'crossing' and pilot == 'jink'").iloc[0]
    assert jinks.flights == 2 and jinks.reached == (results.flights.query("pilot == 'jink'").outcome == "reached").sum()


def test_a_line_that_was_cut_off_does_not_count(arena):
    file = arena / "flights.jsonl"
    whole = file.read_bytes()
    file.write_bytes(whole + b'{"type":"fli')
    assert len(jink.read_arena(arena).flights) == 4
    file.write_bytes(whole)


def test_reads_a_study_to_the_bit(study):
    results = jink.read_study(study)
    paths = results.runs[results.runs.kind == "path"]
    assert len(results.runs) > 100 and paths.slr.notna().all() and (paths.slr >= 1 - 1e-12).all() and paths.planning_s.notna().all()
    assert {"table06", "table07", "claims", "verdicts"} <= set(results.tables) and results.machines[0]["cores"] > 0
    with (study / "table06.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = results.tables["table06"]
    assert [float(row["Scenario 1"]) for row in rows if row["Statistic"] == "Mean"] == \
        table[table.Statistic == "Mean"]["Scenario 1"].tolist()
    front = results.runs[results.runs.kind == "front"].iloc[0]
    assert len(front.f1) == len(front.f2) and np.isfinite(front.hv)


def test_refuses_what_is_no_campaign(arena, study, tmp_path):
    with pytest.raises(FileNotFoundError, match="flights.jsonl"):
        jink.read_arena(tmp_path)
    (tmp_path / "flights.jsonl").write_text("{\n")
    with pytest.raises(jink.Error, match="flights.jsonl:1: "):
        jink.read_arena(tmp_path)
    (tmp_path / "runs.jsonl").write_bytes((arena / "flights.jsonl").read_bytes())
    with pytest.raises(jink.Error, match="is not a results file of format jink-study-results/1"):
        jink.read_study(tmp_path)
