# SPDX-License-Identifier: BSD-3-Clause
"""jink.replay beside `jink replay`: virtual time, so that all of the summary has the same bits."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import jink


@pytest.mark.parametrize(("name", "seed"), [("crossing", 1), ("crossing", 5), ("team", 2), ("table2-3", 1)])
def test_gives_the_commands_summary(command, scenario, name, seed):
    said = command.summary("replay", scenario(name), "--seed", seed)
    result = jink.replay(scenario(name), seed, threads=2)
    assert result.summary == said
    assert result.reached == (said["outcome"] == "reached")
    assert result.position.shape == (len(said.get("vehicles", [0])), len(result.t), 3) == result.velocity.shape


def test_takes_parameters(command, scenario):
    said = command.summary("replay", scenario("crossing"), "--set", "horizon.margin=0.2")
    assert jink.replay(scenario("crossing"), horizon={"margin": 0.2}).summary == said


def test_writes_the_commands_log_and_report(command, scenario, tmp_path):
    mine, theirs = tmp_path / "mine.jsonl", tmp_path / "theirs.jsonl"
    result = jink.replay(scenario("crossing"), 1, log=mine, report=tmp_path / "flight.html")
    command.run("replay", scenario("crossing"), "--log", theirs)
    assert mine.read_bytes() == theirs.read_bytes()
    assert (tmp_path / "flight.html").stat().st_size > 100_000
    truth = [line for line in map(json.loads, mine.read_text().splitlines()) if line["type"] == "truth"]
    assert np.array_equal(result.t, [line["t"] for line in truth])
    assert np.array_equal(result.position[0], [line["p"] for line in truth])
    assert np.array_equal(result.velocity[0], [line["v"] for line in truth])


def test_makes_a_logs_plans_again(command, scenario, tmp_path):
    log = tmp_path / "flight.jsonl"
    jink.replay(scenario("crossing"), 3, log=log)
    again = jink.replay(log)
    assert again.same and again.summary == command.summary("replay", log) and again.summary["seed"] == 3
    other = jink.replay(log, 4, horizon={"margin": 0.1})
    said = command.summary("replay", log, "--seed", 4, "--set", "horizon.margin=0.1")
    assert not other.same and other.summary == said


@pytest.mark.parametrize(("options", "words"), [
    ({"report": "r.html"}, ["--report", "r.html"]),
    ({"log": "/nowhere/r.jsonl"}, ["--log", "/nowhere/r.jsonl"]),
    ({"log": "/"}, ["--log", "/"]),
])
def test_refuses_in_the_commands_words(command, scenario, options, words):
    with pytest.raises(jink.Error) as refused:
        jink.replay(scenario("crossing"), **options)
    assert str(refused.value) == command.error("replay", scenario("crossing"), *words)


def test_loses_no_file_to_another(scenario, tmp_path):
    mine = tmp_path / "mine.yaml"
    text = scenario("crossing").read_text()
    mine.write_text(text)
    with pytest.raises(jink.Error, match="^--log: .* expected another file$"):
        jink.replay(mine, log=mine)
    assert mine.read_text() == text


def test_refuses_what_is_no_log(command, tmp_path):
    log = tmp_path / "flight.jsonl"
    log.write_text("{}\n")
    for options, words in (({}, []), ({"pilot": "orca"}, ["--pilot", "orca"]), ({"log": "x.jsonl"}, ["--log", "x.jsonl"])):
        with pytest.raises(jink.Error) as refused:
            jink.replay(log, **options)
        assert str(refused.value) == command.error("replay", log, *words)


def test_ends_at_ctrl_c(tmp_path):
    text = (jink.config_folder() / "scenarios/crossing.yaml").read_text()
    far = tmp_path / "far.yaml"
    far.write_text(text.replace("target: [20, 0, 1.5]", "target: [20000, 0, 1.5]").replace("max: [25,", "max: [25000,"))
    script = f"import jink; print('on', flush=True); jink.replay({str(far)!r}, threads=1)"
    flight = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert flight.stdout.readline() == "on\n"
    time.sleep(1.0)
    os.kill(flight.pid, signal.SIGINT)
    _, said = flight.communicate(timeout=60)
    assert said.rstrip().endswith("KeyboardInterrupt")
