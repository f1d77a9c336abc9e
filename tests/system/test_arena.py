# SPDX-License-Identifier: BSD-3-Clause
"""`jink arena` as users call it: files, resuming, shards, merging, Ctrl-C, replay of a failed flight, bad usage.

    test_arena.py JINK
"""

import csv
import html.parser
import json
import pathlib
import re
import shlex
import subprocess
import xml.etree.ElementTree

import yaml

from campaigns import Campaigns, change_seed, in_scratch, refused
from flight import check, main

# A small search takes little time; straight flight is sure to fail in these families.
QUICK = ["--set", "horizon.generations=4", "--set", "horizon.population=8", "--set", "companion.largest_replan_rate_hz=10"]
PAIR = ["--families", "darts,gates", "--pilots", "jink,straight"]
SMALL = [*PAIR, "--tiers", "field,perfect", "--runs", 1, *QUICK]
FILES = ["flights.jsonl", "flights.csv", "table.csv", "table.json", "table.md", "arena.html", "planner.yaml"]
SQUARE = pathlib.Path(__file__).resolve().parents[2] / "config/recordings/square.csv"
BAD_USAGE = [
    (["--families", "crossing,bogus"], ["--families", "'bogus'", "crossing, head_on"]),
    (["--families", "crossing,crossing"], ["--families", "'crossing' is there twice"]),
    (["--families", ""], ["--families", "''"]),
    (["--pilots", "icarus"], ["--pilots", "'icarus'", "jink"]),
    (["--tiers", "wild"], ["--tiers", "'wild'", "camera, field, lidar, perfect, realistic"]),
    (["--runs", "0"], ["--runs", "0", "1 to 1000000"]),
    (["--shard", "3/2"], ["--shard", "'3/2'", "K/N"]),
    (["--shard", "0/2"], ["--shard", "'0/2'"]),
    (["--shard", "1"], ["--shard", "'1'"]),
    (["--oracle", "maybe"], ["--oracle", "maybe", "on", "off"]),
    (["--threads", "0"], ["--threads", "0"]),
    (["--set", "horizon.margn=1"], ["horizon.margn"]),
    (["--out", "/proc/no/such"], ["--out", "/proc/no/such"]),
    (["--recorded", "no-such.csv"], ["no-such.csv", "cannot be read"]),
    (["--recorded", str(SQUARE), "--families", "crossing"], ["--families", "--recorded"]),
    (["--recorded", str(SQUARE), "--write", "crossing:1", "x.yaml"], ["--write", "'crossing'", "recorded"]),
    (["--write", "recorded:1", "x.yaml"], ["--write", "'recorded'"]),
    (["--merge", "a", "--recorded", str(SQUARE)], ["--merge", "--recorded"]),
    (["--merge", "no-such-folder"], ["no-such-folder", "cannot be read"]),
    (["--merge", "a", "--runs", "3"], ["--merge", "--runs"]),
    (["--merge", "a", "--seed", "3"], ["--merge", "--seed"]),
    (["--write", "crossing:1", "x.yaml", "--set", "horizon.margin=1"], ["--write", "--set"]),
    (["--write", "crossing", "x.yaml"], ["--write", "'crossing'", "FAMILY:SEED"]),
    (["--write", "crossing:-1", "x.yaml"], ["--write", "'crossing:-1'"]),
    (["--write", "bogus:1", "x.yaml"], ["--write", "'bogus'"]),
    (["--write", "crossing:1", "/no/such/x.yaml"], ["/no/such/x.yaml", "cannot be written"]),
]


class Flights(Campaigns):
    def result(self, out):
        """All that does not come from the wall clock, and where the files are."""
        lines = [json.loads(line) for line in (self.folder / out / "flights.jsonl").read_text().splitlines()]
        for line in lines:
            line.pop("measured", None)
            line.pop("shard", None), line.pop("shards", None)
        table = json.loads((self.folder / out / "table.json").read_text())
        for row in table["table"] + table["totals"]:
            row.pop("measured")
        table.pop("out")
        for failure in table["failures"]:
            failure.pop("replay")
        return lines, table


def bad_usage(arena):
    arena.refuses(BAD_USAGE)


class WellFormed(html.parser.HTMLParser):
    """Every element is closed where it should be."""

    EMPTY = {"meta", "br", "rect", "line", "circle"}

    def __init__(self):
        super().__init__()
        self.open = []
        self.counts = {}

    def handle_starttag(self, tag, attributes):
        self.counts[tag] = self.counts.get(tag, 0) + 1
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.EMPTY:
            assert self.open and self.open.pop() == tag, f"</{tag}> closes nothing"


def failed_flights(arena):
    with open(arena.folder / "whole" / "flights.csv", newline="", encoding="utf-8") as file:
        return [flight for flight in csv.DictReader(file) if flight["outcome"] != "reached"]


def files(arena):
    said = arena.make("whole", *SMALL, "--json", "whole.json")
    folder = arena.folder / "whole"
    check(all((folder / name).stat().st_size > 0 for name in FILES), "all files are there")
    check(json.loads((arena.folder / "whole.json").read_text()) == json.loads((folder / "table.json").read_text()), "--json is table.json")
    with open(folder / "flights.csv", newline="", encoding="utf-8") as file:
        flights = list(csv.DictReader(file))
    summary = json.loads((folder / "table.json").read_text())
    check(summary["format"] == "jink-arena/1" and summary["complete"] and len(flights) == summary["flights"] == 8, "8 flights")
    failed = failed_flights(arena)
    check(0 < len(failed) < 8, f"{len(failed)} of them failed")
    names = {path.name for path in (folder / "failed").iterdir()}
    check(names == {f"{f['family']}-{f['seed']}-{f['tier']}-{f['pilot']}" for f in failed}, "each left its folder, and no other")
    check(all(f["replay"] in said and f["replay"] in (folder / "table.md").read_text() for f in failed), "commands in table and on the terminal")
    for total in summary["totals"]:
        mine = [f for f in flights if f["tier"] == total["tier"] and f["pilot"] == total["pilot"] and f["verdict"] != "impossible"]
        reached = sum(f["outcome"] == "reached" for f in mine)
        check((total["reached"]["count"], total["reached"]["of"]) == (reached, len(mine)), f"{total['tier']}, {total['pilot']}: {reached} of {len(mine)} reached")
    page = (folder / "arena.html").read_text()
    reader = WellFormed()
    reader.feed(page)
    check(not reader.open and reader.counts["svg"] == 2 and "script" not in reader.counts, "the page is well formed, with a figure for each tier")
    for figure in re.findall(r"<svg.*?</svg>", page, re.S):
        xml.etree.ElementTree.fromstring(figure)


def replay(arena):
    """The one command flies the same flight and leaves a report."""
    flight = failed_flights(arena)[0]
    command = shlex.split(flight["replay"])
    check(command[:2] == ["jink", "replay"], flight["replay"])
    done = subprocess.run([arena.program, *command[1:], "--json", "-"], capture_output=True, text=True, timeout=300, cwd=arena.folder)
    summary = json.loads(done.stdout)
    same = all(str(summary[key]) == flight[key] for key in ("outcome", "reason", "plans"))
    check(done.returncode == 1 and same and summary["flight_time_s"] == float(flight["flight_time_s"]), f"{summary['outcome']} at {summary['flight_time_s']} s again")
    report = pathlib.Path(arena.folder / command[-1])
    check(report.stat().st_size > 10000, f"report {report.name}")


def baselines(arena):
    """Who flies the straight line hits something; that flight is replayed as that pilot's, and its log is not taken for jink's."""
    arena.make("baselines", "--families", "gates", "--runs", 1, "--pilots", "straight,jink", "--tiers", "perfect", *QUICK)
    table = json.loads((arena.folder / "baselines" / "table.json").read_text())
    check([row["pilot"] for row in table["table"]] == ["jink", "straight"], "a row for each pilot")
    failure = next(f for f in table["failures"] if f["pilot"] == "straight")
    check(failure["outcome"] == "collision" and " --pilot straight " in failure["replay"], failure["replay"])
    command = shlex.split(failure["replay"])
    done = subprocess.run([arena.program, *command[1:]], capture_output=True, text=True, timeout=300, cwd=arena.folder)
    check(done.returncode == 1 and failure["reason"] in done.stdout, "replayed: the same collision")
    log = command[command.index("--log") + 1]
    done = subprocess.run([arena.program, "replay", log], capture_output=True, text=True, timeout=60, cwd=arena.folder)
    refused(done, [log, "straight"])


def same_however(arena):
    whole = arena.result("whole")
    arena.make("threads", *SMALL, "--threads", 3)
    check(arena.result("threads") == whole, "the same with 3 threads")
    for part in (1, 2):
        arena.make(f"part{part}", *SMALL, "--shard", f"{part}/2")
    arena.make("incomplete", "--merge", "part2", status=1)
    arena.make("merged", "--merge", "part2", "part1")
    lines, table = arena.result("merged")
    check((lines, table) == whole, "two shards merged are the whole")
    left = {path.name for path in (arena.folder / "whole" / "failed").iterdir()}
    check({path.name for path in (arena.folder / "merged" / "failed").iterdir()} == left, "with the failed flights")
    refused(arena.run("--out", "merged", "--merge", "part1"), ["merged", "holds a campaign"])
    change_seed(arena.folder / "part2" / "flights.jsonl")
    refused(arena.run("--out", "x", "--merge", "part1", "part2"), ["part2"])


def resumed(arena):
    whole = arena.result("whole")
    refused(arena.run("--out", "whole", *SMALL), ["--out", "--resume"])
    refused(arena.run("--out", "whole", *PAIR, "--runs", 3, *QUICK, "--resume"), ["runs: 1 in whole, 3 in this call"])
    refused(arena.run("--out", "whole", *SMALL, "--resume", "--set", "horizon.margin=0.5"), ["horizon.margin: 0.35 in whole, 0.5 in this call"])
    refused(arena.run("--out", "whole", *SMALL, "--resume", "--seed", 2), ["seed: 1 in whole, 2 in this call"])
    cut = arena.folder / "cut"
    cut.mkdir()
    text = (arena.folder / "whole" / "flights.jsonl").read_text()
    for length, words in ((2 * len(text) // 3, "cut off"), (100, "holds no campaign")):
        (cut / "flights.jsonl").write_text(text[:length])
        said = arena.make("cut", *SMALL, "--resume")
        check(words in said and arena.result("cut") == whole, f"goes on behind what was cut off after {length} bytes")


def interrupted(arena):
    """Ctrl-C keeps what is done, writes its tables and says how to go on."""
    arena.interrupt("stopped", "--families", "darts,gates", "--runs", 40, *QUICK, file="flights.jsonl", lines=4)
    summary = json.loads((arena.folder / "stopped" / "table.json").read_text())
    check(3 <= summary["flights"] < 160 and not summary["complete"], f"{summary['flights']} flights are kept")


def written(arena):
    for name, tier, dropout in (("perfect.yaml", "perfect", None), ("realistic.yaml", "realistic", 0.05)):
        arena.run("--write", "gates:7", name, "--tiers", tier)
        scenario = yaml.safe_load((arena.folder / name).read_text())
        check(scenario["name"] == "gates-7" and scenario.get("sensing", {}).get("dropout") == dropout, f"{name}: gates-7")
    done = subprocess.run([arena.program, "plan", "perfect.yaml"], capture_output=True, text=True, timeout=60, cwd=arena.folder)
    check(done.returncode in (0, 1) and not done.stderr, "jink plan reads it")


def recorded(arena):
    """Worlds out of a recording: flown, replayed, merged, and told from those of another recording."""
    people = ["--recorded", SQUARE, "--tiers", "perfect", "--pilots", "straight", "--runs", 2]
    said = arena.make("square", *people)
    check("18 movers" in said, "says what it read")
    lines, table = arena.result("square")
    check(table["families"] == ["recorded"] and table["flights"] == 2 and "square.csv" in table["recorded"], table["recorded"])
    outcomes = {failure["outcome"] for failure in table["failures"]}
    check(outcomes == {"collision"}, f"straight flight hits people, in {len(table['failures'])} of 2 worlds")
    for part in (1, 2):
        arena.make(f"square{part}", *people, "--shard", f"{part}/2")
    arena.make("squares", "--merge", "square1", "square2")
    check(arena.result("squares") == (lines, table), "two shards merged are the whole")
    other = arena.folder / "square.csv"
    other.write_text(SQUARE.read_text() + "60.0,1,0.0,0.0,0.8,0.3,1.7\n")
    refused(arena.run("--out", "square", "--resume", "--recorded", other, *people[2:]), ["recorded: square.csv", "in square", "in this call"])
    other.write_text("t,id,x,y,z\n0,1,0,0,0\n0.4,1,east,0,0\n")
    refused(arena.run("--out", "x", "--recorded", other), ["square.csv:3: x: 'east' is not a number"])
    arena.run("--recorded", SQUARE, "--write", "recorded:7", "people.yaml")
    scenario = yaml.safe_load((arena.folder / "people.yaml").read_text())
    check(scenario["name"] == "recorded-7" and all("cylinder" in o for o in scenario["obstacles"]), "people.yaml: recorded-7")


def test(program):
    in_scratch(Flights, program, "arena", (bad_usage, files, replay, baselines, same_however, resumed, interrupted, written, recorded))


main(test)
