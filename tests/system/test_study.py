# SPDX-License-Identifier: BSD-3-Clause
"""`jink study` as users call it: files, resuming, shards, merging, Ctrl-C, bad usage and broken results.

    test_study.py JINK
"""

import csv
import json
import os
import subprocess

from campaigns import Campaigns, change_seed, in_scratch, refused
from flight import check, main

# Everything of the study, each search of no length.
SMALL = ["--quick", "--runs", 2, "--set", "optimizer.iterations=10", "--set", "optimizer.population=24"]
TABLES = ["table03", "table04", "table05", "table06", "table07", "table07-flight", "table08", "table09", "table10", "table10-pairs",
          "table11", "table11-pairs", "table12", "table13", "table14", "table15", "anytime"]
EXTRA_TABLES = ["table13-reached-blocked", "success", "claims", "verdicts"]
FIGURES = [f"figure{number:02}" for number in range(8, 18)] + ["anytime", "figure08-blocked", "figure09-blocked", "figure10-blocked",
                                                               "figure11-blocked", "anytime-blocked"]
# Tables with wall times in them, which no two runs share.
TIMED = {"table07", "table09", "table11", "table11-pairs", "table14", "table15", "anytime", "verdicts", "claims"}
BAD_USAGE = [
    (["--runs", "0"], ["--runs", "0", "1 to 1000"]),
    (["--runs", "1001"], ["--runs", "1001", "1 to 1000"]),
    (["--shard", "3/2"], ["--shard", "'3/2'", "K/N"]),
    (["--threads", "0"], ["--threads", "0"]),
    (["--set", "optimizer.populaton=1"], ["optimizer.populaton"]),
    (["--set", "paper.waypoints=4"], ["paper.waypoints", "7 or more"]),
    (["--set", "optimizer.population=8", "--set", "optimizer.slaves=2"], ["PMOMVO-10", "population: 8"]),
    (["--out", "/proc/no/such"], ["--out", "/proc/no/such"]),
    (["--merge", "no-such-folder"], ["no-such-folder", "cannot be read"]),
    (["--merge", "a", "--runs", "3"], ["--merge", "--runs"]),
    (["--merge", "a", "--quick"], ["--merge", "--quick"]),
    (["--merge", "a", "--seed", "3"], ["--merge", "--seed"]),
]


class Studies(Campaigns):
    def runs(self, out):
        """All that does not come from the wall clock or the machine, in the order of runs."""
        lines = [json.loads(line) for line in (self.folder / out / "runs.jsonl").read_text().splitlines()]
        for line in lines:
            line.pop("measured", None)
        return sorted((line for line in lines if line["type"] == "run"), key=lambda line: line["job"])

    def tables(self, out):
        """The tables without times."""
        names = [name for name in TABLES if name not in TIMED]
        names = names + [f"{name}-blocked" for name in names] + ["success", "table13-reached-blocked"]
        return {name: (self.folder / out / f"{name}.csv").read_text() for name in names}


def bad_usage(study):
    study.refuses(BAD_USAGE)
    without = study.run(*SMALL, environment={"PATH": "/nowhere"})
    refused(without, ["gnuplot is not in PATH"])
    check(not list(study.folder.iterdir()), "no gnuplot: said before anything is run")


def files(study):
    said = study.make("whole", *SMALL, "--json", "whole.json")
    folder = study.folder / "whole"
    summary = json.loads((study.folder / "whole.json").read_text())
    check(summary["format"] == "jink-study/1" and summary["complete"] and summary["runs_done"] == len(study.runs("whole")), "all runs are there")
    tables = TABLES + [f"{name}-blocked" for name in TABLES] + EXTRA_TABLES
    missing = [f"{name}.{kind}" for name in tables for kind in ("csv", "md", "tex") if not (folder / f"{name}.{kind}").stat().st_size]
    check(set(tables) == set(summary["tables"]) and not missing, f"{len(tables)} tables in three forms")
    check(set(FIGURES) == set(summary["figures"]), f"{len(FIGURES)} figures")
    for name in FIGURES:
        check((folder / f"{name}.png").read_bytes()[:4] == b"\x89PNG" and "<svg" in (folder / f"{name}.svg").read_text(), name)
    page = (folder / "report.html").read_text()
    check(all(text in page for text in ("What agrees and what does not", "NSGA-II", "MOEA/D", "cannot be reproduced", "<svg")), "the report")
    check("PMOMVO-6 against NSGA-II" in said and str(folder / "report.html") in said, "the terminal says the verdict and where the report is")


def numbers(study):
    """Table 6 follows from the runs, and has the paper's numbers beside it."""
    with open(study.folder / "whole" / "table06.csv", newline="", encoding="utf-8") as file:
        rows = {(row["Algorithm"], row["Statistic"]): row for row in csv.DictReader(file)}
    lengths = [run["values"]["slr"] for run in study.runs("whole") if run["kind"] == "path" and run["algorithm"] == "pmomvo-6"
               and run["world"] == "table2-3" and run["population"] == 24 and run["iterations"] == 10 and run["sharing"] == 9]
    row = rows["PMOMVO-6", "Mean"]
    check(len(lengths) == 2 and float(row["Scenario 3"]) == sum(lengths) / 2, f"mean SLR {row['Scenario 3']} of two runs")
    check(row["Scenario 3 (paper)"] == "1.0162", "beside the paper's 1.0162")
    scenario = study.folder / "whole" / "worlds" / "blocked2-1-run1.yaml"
    done = subprocess.run([study.program, "plan", scenario, "--mode", "paper"], capture_output=True, text=True, timeout=60, cwd=study.folder)
    check(done.returncode in (0, 1) and not done.stderr, "jink plan reads a blocked world")


def same_however(study):
    whole = study.runs("whole"), study.tables("whole")
    study.make("threads", *SMALL, "--threads", 3)
    check((study.runs("threads"), study.tables("threads")) == whole, "the same with 3 threads")
    for part in (1, 2):
        study.make(f"part{part}", *SMALL, "--shard", f"{part}/2")
    said = study.make("incomplete", "--merge", "part2", status=1)
    check("--resume" in said, "one part alone is incomplete, which is said")
    fake = study.folder / "bin" / "gnuplot"
    fake.parent.mkdir()
    fake.write_text("#!/bin/sh\nexit 1\n")
    fake.chmod(0o755)
    path = {**os.environ, "PATH": f"{fake.parent}:{os.environ['PATH']}"}
    refused(study.run("--out", "merged", "--merge", "part2", "part1", environment=path), ["gnuplot failed"])
    study.make("merged", "--merge", "part2", "part1")  # what failed before it ended can be repeated
    check((study.runs("merged"), study.tables("merged")) == whole, "two shards merged are the whole")
    refused(study.run("--out", "merged", "--merge", "part1"), ["merged", "holds a campaign"])
    change_seed(study.folder / "part2" / "runs.jsonl")
    refused(study.run("--out", "x", "--merge", "part1", "part2"), ["part2"])


def resumed(study):
    whole = study.runs("whole"), study.tables("whole")
    refused(study.run("--out", "whole", *SMALL), ["--out", "--resume"])
    refused(study.run("--out", "whole", *SMALL, "--resume", "--seed", 2), ["seed: 1 in whole, 2 in this call"])
    refused(study.run("--out", "whole", "--resume"), ["quick: on in whole, off in this call"])
    cut = study.folder / "cut"
    cut.mkdir()
    text = (study.folder / "whole" / "runs.jsonl").read_text()
    (cut / "runs.jsonl").write_text(text[: 2 * len(text) // 3])
    said = study.make("cut", *SMALL, "--resume")
    check("cut off" in said and (study.runs("cut"), study.tables("cut")) == whole, "goes on behind what was cut off")


def broken(study):
    """A results file that is not one: file and line, nothing else."""
    lines = (study.folder / "whole" / "runs.jsonl").read_text().splitlines()
    run = json.loads(lines[3])
    for name, text, parts in (
        ("empty", "\n", ["runs.jsonl:1", "is not JSON"]),
        ("strange", "{}\n", ["runs.jsonl:1", "jink-study-results"]),
        ("torn", "\n".join([*lines[:3], lines[3][:40], *lines[4:]]) + "\n", ["runs.jsonl:4", "is not JSON"]),
        ("seed", "\n".join([*lines[:3], json.dumps({**run, "seed": 7})]) + "\n", ["runs.jsonl:4", "should be"]),
        ("text", "\n".join([*lines[:3], json.dumps({**run, "values": {"hv": "x"}})]) + "\n", ["runs.jsonl:4", "values.hv"]),
        ("lacking", "\n".join([*lines[:3], json.dumps({**run, "values": {}})]) + "\n", ["runs.jsonl:4", "the run has no"]),
    ):
        (study.folder / name).mkdir()
        (study.folder / name / "runs.jsonl").write_text(text)
        refused(study.run("--out", name, *SMALL, "--resume"), [name, *parts])
        refused(study.run("--out", "y", "--merge", name), [name, *parts])


def interrupted(study):
    """Ctrl-C keeps what is done, makes tables and figures of it and says how to go on."""
    study.interrupt("stopped", "--quick", "--runs", 30, "--json", "stopped.json", file="runs.jsonl", lines=20)
    summary = json.loads((study.folder / "stopped.json").read_text())
    check(10 < summary["runs_done"] < summary["runs_of_whole"] and not summary["complete"], f"{summary['runs_done']} runs are kept")
    check("Incomplete" in (study.folder / "stopped" / "report.html").read_text(), "the report says that it is incomplete")


def test(program):
    in_scratch(Studies, program, "study", (bad_usage, files, numbers, same_however, resumed, broken, interrupted))


main(test)
