# SPDX-License-Identifier: BSD-3-Clause
"""The commands as contracts has them: exit codes, one-line errors, JSON keys, the same bits at any thread count.

    test_command_line.py JINK INSTANCE
"""

import json
import math
import os
import pathlib
import signal
import socket
import stat
import subprocess
import tempfile
import threading
import time

import yaml

from flight import CONFIG, check, main

SCENARIOS = CONFIG / "scenarios"
CROSSING = SCENARIOS / "crossing.yaml"
PAPER = [f"table2-{i}" for i in range(1, 6)] + [f"table12-{i}" for i in range(1, 4)]
PLAN_KEYS = ["format", "scenario", "mode", "algorithm", "seed", "threads", "slaves", "sharing", "population", "iterations",
             "outcome", "path", "path_length", "straight_length", "slr", "flight_time_s", "min_clearance", "evaluations",
             "planning_time_s", "front"]
ALGORITHMS = ["pmomvo", "momvo", *(f"pmomvo-{slaves}" for slaves in (2, 4, 6, 8, 10, 12)),
              "mssa", "mogwo", "nsga2", "mopso", "nspso", "moead"]
FLIGHT_KEYS = ["format", "scenario", "seed", "outcome", "reason", "flight_time_s", "path_length", "straight_length", "slr",
               "min_clearance", "max_speed", "plans", "deadline_misses", "plan_ms", "track_to_setpoint_ms"]
# Arguments, and what the one line on stderr has to hold.
BAD_USAGE = [
    ([], ["subcommand is required", "`jink --help`"]),
    (["bogus"], ["bogus", "plan, replay, sim, fly"]),
    (["plan"], ["SCENARIO", "`jink plan --help`"]),
    (["study", "--bogus"], ["--bogus", "`jink study --help`"]),
    (["plan", "no-such-file.yaml"], ["no-such-file.yaml"]),
    (["plan", CROSSING, "--mode", "wild"], ["--mode", "wild", "paper", "horizon"]),
    (["plan", CROSSING, "--algorithm", "magic"], ["--algorithm", "magic", *ALGORITHMS]),
    (["plan", CROSSING, "--algorithm", "mogwo", "--slaves", "3"], ["--slaves", "mogwo", "pmomvo"]),
    (["plan", CROSSING, "--algorithm", "pmomvo-6", "--slaves", "6"], ["--slaves", "pmomvo-6", "pmomvo"]),
    (["plan", CROSSING, "--algorithm", "momvo", "--sharing", "2"], ["--sharing", "momvo", "pmomvo"]),
    (["plan", CROSSING, "--algorithm", "pmomvo-12", "--population", "11"], ["--population", "11", "12 or more"]),
    (["plan", CROSSING, "--algorithm", "nsga2", "--set", "optimizer.archive=2"], ["archive", "2"]),
    (["plan", CROSSING, "--threads", "0"], ["--threads", "0", "1 to 256"]),
    (["plan", CROSSING, "--slaves", "65"], ["--slaves", "65", "1 to 64"]),
    (["plan", CROSSING, "--population", "3", "--slaves", "6"], ["--population", "3", "6 or more"]),
    (["plan", CROSSING, "--waypoints", "1", "--mode", "paper"], ["--waypoints", "1", "2 to 1000"]),
    (["plan", CROSSING, "--seed", "-1"], ["--seed", "-1"]),
    (["plan", CROSSING, "--seed", "18446744073709551616"], ["--seed", "18446744073709551616", "0 to 18446744073709551615"]),
    (["plan", CROSSING, "--threads", "0x2"], ["--threads", "0x2", "1 to 256"]),
    (["plan", CROSSING, "--config", ""], ["--config", "empty"]),
    (["plan", CROSSING, "--json", ""], ["--json", "empty"]),
    (["replay", CROSSING, "--log", ""], ["--log", "empty"]),
    (["replay", CROSSING, "--log", "/dev/null", "--report", "/no/such/folder/x.html"], ["--report", "/no/such/folder/x.html"]),
    (["sim", CROSSING, "--speed", "nan", "--duration", "1"], ["--speed", "nan", "0.5 to 20"]),
    (["sim", CROSSING, "--duration", "nan"], ["--duration", "nan", "0.1 to 1000000"]),
    (["sim", CROSSING, "--duration", "1", "--json", "/no/such/folder/x.json"], ["--json", "/no/such/folder/x.json"]),
    (["doctor", CONFIG / "missions" / "sitl.yaml", "--seconds", "nan"], ["--seconds", "nan", "1 to 600"]),
    (["fly", CONFIG / "missions" / "sitl.yaml", "--json", "/no/such/folder/x.json"], ["--json", "/no/such/folder/x.json"]),
    (["plan", CROSSING, "--set", "horizon.margn=1"], ["horizon.margn", "horizon.margin"]),
    (["plan", CROSSING, "--set", "horizon.margin=-1"], ["horizon.margin", "-1", "[0, 100]"]),
    (["plan", CROSSING, "--json", "/no/such/folder/x.json"], ["--json", "/no/such/folder/x.json"]),
    (["replay", CROSSING, "--log", "/no/such/folder/x.jsonl"], ["--log", "/no/such/folder/x.jsonl"]),
    (["replay", CROSSING, "--report", "x.html"], ["--report", "--log"]),
    (["replay", CROSSING, "--pilot", "icarus"], ["--pilot", "icarus", "jink"]),
    (["replay", "flight.jsonl", "--pilot", "straight"], ["--pilot", "scenario"]),
    (["sim", CROSSING, "--speed", "100"], ["--speed", "100", "20"]),
    (["sim", CONFIG / "missions" / "sitl.yaml"], ["sitl.yaml:", "format", "jink-mission/1", "jink-scenario/1"]),
    (["fly", CROSSING], ["crossing.yaml:", "format", "jink-scenario/1", "jink-mission/1"]),
    (["replay", "no-such-log.jsonl"], ["no-such-log.jsonl"]),
    (["replay", "flight.jsonl", "--log", "again.jsonl"], ["--log", "jink report"]),
    (["report", "no-such-log.jsonl"], ["no-such-log.jsonl"]),
    (["report", "a.jsonl", "b.jsonl"], ["--out", "several"]),
    (["report", "a.jsonl", "b.jsonl", "--png", "x.png"], ["--png", "one flight"]),
    (["report", "a.jsonl", "--at", "3"], ["--at", "--png"]),
    (["report", "a.jsonl", "--summary", "x.json", "--summary", "y.json"], ["--summary", "2 summaries for 1"]),
    (["export", "no-such-log.jsonl", "--mcap", "x.mcap"], ["no-such-log.jsonl"]),
    (["export", "a.jsonl"], ["--mcap"]),
    (["fly", CONFIG / "missions" / "sitl.yaml", "--report", "x.html"], ["--report", "--log"]),
    (["demo", "--out", "/dev/null/x"], ["--out", "/dev/null/x"]),
]


class Jink:
    def __init__(self, program, instance):
        self.program = program
        self.instance = instance  # the MAVLink instance that is this test's own

    def run(self, *arguments, seconds=120):
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=seconds)

    def summary(self, *arguments, status=0):
        """The summary on stdout, which holds nothing else."""
        done = self.run(*arguments, "--json", "-")
        check(done.returncode == status, f"jink {arguments[0]} {pathlib.Path(arguments[1]).stem} {' '.join(map(str, arguments[2:]))}: exit status {status}")
        return json.loads(done.stdout)


def bad_usage(jink):
    for arguments, parts in BAD_USAGE:
        done = jink.run(*arguments)
        lines = done.stderr.strip().splitlines()
        said = done.returncode == 2 and len(lines) == 1 and not done.stdout and all(part in lines[0] for part in parts)
        check(said, f"status {done.returncode}: {done.stderr.strip()}")


def bad_values(jink, folder):
    """A wrong value in a scenario is named with file, line, key, value and range."""
    text = CROSSING.read_text()
    file = folder / "wrong.yaml"
    file.write_text(text.replace("\nstart:", "\nstrat:", 1))
    done = jink.run("plan", file)
    check(done.returncode == 2 and "strat" in done.stderr and "start" in done.stderr, done.stderr.strip())
    scenario = yaml.safe_load(text)
    scenario["obstacles"][0]["radius"] = -0.5
    scenario["obstacles"][0].pop("box", None)
    file.write_text(yaml.safe_dump(scenario))
    done = jink.run("plan", file)
    parts = ["wrong.yaml:", "obstacles[0].radius", "-0.5", "(0, 1000]"]
    check(done.returncode == 2 and all(part in done.stderr for part in parts), done.stderr.strip())


def one_line(done, *parts):
    lines = done.stderr.strip().splitlines()
    return done.returncode == 2 and len(lines) == 1 and all(str(part) in lines[0] for part in parts)


def bad_peers(jink, folder):
    """What cannot be opened is named by where it was asked for, and an earlier flight's log outlives it."""
    mission = folder / "mission.yaml"
    mission.write_text((CONFIG / "missions" / "sitl.yaml").read_text().replace("udpin://127.0.0.1:14540", "serial:///dev/jink-none:57600"))
    log = folder / "earlier.jsonl"
    log.write_text("an earlier flight\n")
    for command in (["doctor", mission], ["fly", mission, "--log", log]):
        done = jink.run(*command)
        check(one_line(done, mission, "'connection'", "/dev/jink-none"), f"status {done.returncode}: {done.stderr.strip()}")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        port = 14580 + jink.instance
        other.bind(("0.0.0.0", port))
        done = jink.run("sim", CROSSING, "--instance", jink.instance, "--no-tracks", "--duration", 1, "--log", log)
        check(one_line(done, f"--instance {jink.instance}", port, "taken"), f"status {done.returncode}: {done.stderr.strip()}")
    check(log.read_text() == "an earlier flight\n", "the log of an earlier flight is as it was")
    jink.run("sim", CROSSING, "--no-vehicle", "--no-tracks", "--duration", 0.5, "--log", log)
    events = [record for record in map(json.loads, log.read_text().splitlines()) if record["type"] == "event"]
    check(events and events[0]["t"] == 0, f"the log of sim has what happens at once: {events[:1]}")
    done = jink.run("sim", CROSSING, "--no-vehicle", "--no-tracks", "--duration", 0.5, "--json", folder / "none.json")
    check("warning: --json" in done.stdout, f"sim says that there is no summary without a vehicle: {done.stdout.strip()}")


def same_file(jink, folder):
    """What is named twice is written over by nothing."""
    scenario, log = folder / "mine.yaml", folder / "mine.jsonl"
    scenario.write_text(CROSSING.read_text())
    jink.run("replay", scenario, "--log", log)
    both = folder / "both.json"
    aside = folder / "." / "mine.jsonl"
    for arguments, name in ((["plan", scenario, "--json", scenario], "--json"), (["replay", scenario, "--log", scenario], "--log"),
                            (["replay", scenario, "--log", both, "--json", both], "--json"),
                            (["report", log, "--out", aside], "--out"), (["export", log, "--mcap", log], "--mcap")):
        before = scenario.read_text(), log.read_text()
        done = jink.run(*arguments)
        check(one_line(done, name, "another file"), f"status {done.returncode}: {done.stderr.strip()}")
        check((scenario.read_text(), log.read_text()) == before and not both.exists(), "everything is as it was")
    check(jink.run("replay", scenario, "--log", "/dev/null", "--json", "/dev/null").returncode == 0, "a device may be named twice")


def odd_outputs(jink, folder):
    """Links, pipes, full and closed streams: nothing is put in another's place, nothing is lost silently."""
    check(jink.summary("plan", CROSSING, "--seed", "010")["seed"] == 10, "--seed 010 is ten")
    target, link, pipe = folder / "target.json", folder / "link.json", folder / "pipe.json"
    link.symlink_to(target)
    jink.run("plan", CROSSING, "--json", link)
    check(link.is_symlink() and json.loads(target.read_text())["format"] == "jink-plan/1", "--json writes where a link leads")
    os.mkfifo(pipe)
    received = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_text()), daemon=True)
    reader.start()
    jink.run("plan", CROSSING, "--json", pipe)
    check(stat.S_ISFIFO(pipe.stat().st_mode), "--json leaves a pipe a pipe")
    reader.join(10)
    check(received and json.loads(received[0])["format"] == "jink-plan/1", "--json writes into a pipe")
    with open("/dev/full", "w") as full:
        done = subprocess.run([jink.program, "plan", CROSSING, "--json", "-"], stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
    check(done.returncode == 2 and "--json: stdout cannot be written" in done.stderr, "a full stdout is told")
    log = folder / "closed.jsonl"
    subprocess.run(["sh", "-c", '"$0" replay "$1" --log "$2" >&- 2>&-', jink.program, CROSSING, log], timeout=120)
    check(all(json.loads(line) for line in log.read_text().splitlines()), "what is printed to a closed stdout is not in the log")


def ctrl_c(jink, folder):
    """One line or a summary, exit code 1, no half a file."""
    log = folder / "interrupted.jsonl"
    summary = folder / "interrupted.json"
    far = folder / "far.yaml"
    far.write_text(yaml.safe_dump({"format": "jink-scenario/1", "name": "far", "start": [0, 0, 2], "target": [90000, 0, 2],
                                   "vehicle": "ardrone2", "obstacles": []}))
    for arguments in (["plan", CROSSING, "--mode", "paper", "--iterations", "1000000"], ["replay", far, "--log", log]):
        process = subprocess.Popen([jink.program, *map(str, arguments), "--json", summary], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        check(process.returncode == 1, f"{arguments[0]}: Ctrl-C ends it with exit status {process.returncode}: {err.strip()}")
        check("interrupted" in out + err, f"{arguments[0]} says that it was interrupted")
        check(arguments[0] == "replay" or not summary.exists(), "an interrupted plan leaves no summary")
    check(json.loads(summary.read_text())["reason"] == "interrupted", "an interrupted replay leaves its summary")
    text = log.read_text()
    check(text.endswith("}\n") and all(json.loads(line) for line in text.splitlines()), "and a whole log")


def every_motion(jink, folder):
    """The scenario of contracts, with each shape and motion."""
    file = folder / "example.yaml"
    file.write_text(yaml.safe_dump({
        "format": "jink-scenario/1", "name": "example", "start": [0, 0, 1.5], "target": [20, 0, 1.5], "time_limit": 60,
        "vehicle": {"radius": 0.30, "length": 0.52, "mass": 0.42, "max_speed": 5.0, "cruise_speed": 3.0,
                    "max_acceleration": 6.0, "max_jerk": 30.0, "max_climb": 2.0},
        "world": {"min": [-5, -10, 0], "max": [25, 10, 8]},
        "sensing": {"range": 20, "rate": 20, "delay": 0, "position_noise": 0, "velocity_noise": 0, "dropout": 0},
        "obstacles": [
            {"radius": 0.5, "position": [5, 5, 2], "velocity": [4, -2, 1], "acceleration": [0, 0, 0]},
            {"box": [0.8, 0.8, 0.8], "motion": {"type": "trefoil", "center": [10, 0, 1], "scale": [1, 1, 1], "slower": 1.1, "offset": 0.3}},
            {"radius": 0.4, "motion": {"type": "sine", "center": [5, 0, 1], "amplitude": [0, 2, 0], "frequency_hz": [0, 0.2, 0], "phase": [0, 0, 0]}},
            {"radius": 0.4, "motion": {"type": "bounce", "position": [1, 1, 1], "velocity": [1, 2, 0], "min": [0, -5, 0], "max": [20, 5, 4]}},
            {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
             "motion": {"type": "waypoints", "times": [0, 5, 9], "points": [[3, 3, 1], [6, 0, 1], [9, 3, 1]]}}]}))
    for arguments in (["plan"], ["plan", "--mode", "paper"], ["replay"]):
        done = jink.summary(arguments[0], file, *arguments[1:])
        check(done["outcome"] == "reached" and done["min_clearance"] > 0, f"{' '.join(arguments)}: clearance {done['min_clearance']:.2f} m")


def help_reads(jink):
    for command in ([], ["plan"], ["replay"], ["sim"], ["fly"], ["doctor"], ["report"], ["export"], ["demo"], ["arena"], ["study"]):
        done = jink.run(*command, "--help")
        check(done.returncode == 0 and "Usage: jink" in done.stdout and not done.stderr, f"jink {' '.join(command)} --help")


def distance_to_obstacle(obstacle, t, point):
    position = [obstacle["position"][k] + obstacle.get("velocity", [0, 0, 0])[k] * t for k in range(3)]
    return math.dist(position, point) - obstacle["radius"]


def sampled_clearance(scenario, path, vehicle_radius, samples=50):
    """By dense sampling: an upper bound of the true minimum that is near it."""
    least = math.inf
    for (t0, *a), (t1, *b) in zip(path, path[1:]):
        for i in range(samples + 1):
            s = i / samples
            point = [a[k] + s * (b[k] - a[k]) for k in range(3)]
            for obstacle in scenario["obstacles"]:
                least = min(least, distance_to_obstacle(obstacle, t0 + s * (t1 - t0), point) - vehicle_radius)
    return least


def plans(jink):
    for name in PAPER:
        scenario = yaml.safe_load((SCENARIOS / f"{name}.yaml").read_text())
        for mode in ("paper", "horizon"):
            plan = jink.summary("plan", SCENARIOS / f"{name}.yaml", "--mode", mode)
            check(list(plan) == PLAN_KEYS, "the keys of jink-plan/1")
            path = plan["path"]
            check(plan["outcome"] == "reached" and path[-1][1:] == scenario["target"], f"reached {path[-1][1:]}")
            speeds = [math.dist(a[1:], b[1:]) / (b[0] - a[0]) for a, b in zip(path, path[1:])]
            check(max(speeds) <= 5.0 + 1e-9, f"fastest {max(speeds):.2f} m/s")
            sampled = sampled_clearance(scenario, path, 0.30)
            near = plan["min_clearance"] <= sampled + 1e-9 and sampled - plan["min_clearance"] < 0.02
            check(near and plan["min_clearance"] > 0, f"clearance {plan['min_clearance']:.3f} m, sampled {sampled:.3f} m")
            length = sum(math.dist(a[1:], b[1:]) for a, b in zip(path, path[1:]))
            check(math.isclose(length, plan["path_length"], rel_tol=1e-9), "path_length is the path's")


def algorithms(jink):
    for name in ALGORITHMS:
        for mode, population, evaluated in (("paper", 40, 18 * 40 * 30), ("horizon", 40, None)):
            plan = jink.summary("plan", CROSSING, "--mode", mode, "--algorithm", name, "--population", population, "--iterations", 30)
            slaves = int(name[7:]) if name.startswith("pmomvo-") else plan["slaves"] if name == "pmomvo" else 1
            as_asked = plan["algorithm"] == name and plan["slaves"] == slaves and (plan["sharing"] > 0) == name.startswith("pmomvo")
            check(as_asked and plan["outcome"] == "reached" and plan["min_clearance"] > 0, f"{plan['outcome']} with {plan['slaves']} slaves")
            check(evaluated in (None, plan["evaluations"]), f"{plan['evaluations']} evaluations")


def paper_slr(jink):
    """Mean SLR of 20 seeds at most 1.005 in every scenario of the paper."""
    for name in PAPER:
        rates = [jink.summary("plan", SCENARIOS / f"{name}.yaml", "--mode", "paper", "--seed", seed)["slr"] for seed in range(1, 21)]
        check(sum(rates) / 20 <= 1.005, f"{name}: mean SLR {sum(rates) / 20:.5f} of 20 seeds")


def same_bits(jink, folder):
    for mode, constraint in (("paper", "swept"), ("paper", "paper"), ("horizon", "swept")):
        found = set()
        for threads in (1, 2, 8):
            plan = jink.summary("plan", SCENARIOS / "table2-5.yaml", "--mode", mode, "--threads", threads, "--set", f"paper.constraint={constraint}")
            plan.pop("threads"), plan.pop("planning_time_s")
            found.add(json.dumps(plan))
        check(len(found) == 1, f"{mode}, {constraint}: the same bytes with 1, 2 and 8 threads")
    seeds = {json.dumps(jink.summary("plan", SCENARIOS / "table2-5.yaml", "--mode", "paper", "--seed", seed)["path"]) for seed in (1, 2)}
    check(len(seeds) == 2, "another seed gives another plan")
    flights = set()
    for threads in (1, 2, 8):
        log = folder / f"flight-{threads}.jsonl"
        flight = jink.summary("replay", CROSSING, "--threads", threads, "--log", log)
        check(list(flight)[:len(FLIGHT_KEYS)] == FLIGHT_KEYS, "the keys of jink-flight/1")
        check(flight["outcome"] == "reached" and flight["min_clearance"] > 0, f"clearance {flight['min_clearance']:.2f} m")
        flights.add(json.dumps(flight) + log.read_text())
    check(len(flights) == 1, "replay: summary and log the same bytes with 1, 2 and 8 threads")


def team_flight(jink, folder):
    """A scenario with several vehicles: all fly, the log is the first one's with the truth of all, and it plans again."""
    scenario = folder / "team.yaml"
    scenario.write_text(yaml.safe_dump({
        "format": "jink-scenario/1", "name": "team", "start": [0, 0, 3], "target": [12, 0, 3], "vehicle": "ardrone2",
        "obstacles": [], "vehicles": [{"start": [12, 0, 3], "target": [0, 0, 3]}]}))
    log = folder / "team.jsonl"
    flight = jink.summary("replay", scenario, "--log", log)
    check(flight["outcome"] == "reached" and 0 < flight["min_clearance"] < 3, f"two swap places, {flight['min_clearance']:.2f} m apart")
    check([v["vehicle"] for v in flight["vehicles"]] == [0, 1] and [v["system"] for v in flight["vehicles"]] == [1, 2], "both are told of")
    check(all(v["outcome"] == "reached" for v in flight["vehicles"]), "both reached")
    records = [json.loads(line) for line in log.read_text().splitlines()]
    starts = {r["vehicle"]: r["p"] for r in records if r["type"] == "truth" and r["t"] == 0}
    check(starts == {0: [0, 0, 3], 1: [12, 0, 3]}, f"truth of both: {starts}")
    states = [r["p"] for r in records if r["type"] == "state"]
    check(math.dist(states[0], [0, 0, 3]) < 0.5 and math.dist(states[-1], [12, 0, 3]) < 0.6, "the log is vehicle 0's")
    again = jink.summary("replay", log)
    check(again["plans"] == flight["plans"] and again["differ"] == 0, f"{again['plans']} plans, {again['differ']} differ")


def recorded_flight(jink, folder):
    """A flight log is planned again: no difference from its own parameters, some from others, one line where it is bad."""
    log = folder / "recorded.jsonl"
    flight = jink.summary("replay", CROSSING, "--seed", 3, "--log", log)
    again = jink.summary("replay", log, "--threads", 1)
    check(again["format"] == "jink-flight-replay/1" and again["flight"] == flight["scenario"], "jink-flight-replay/1")
    check(again["plans"] == flight["plans"] and again["differ"] == 0 == len(again["differences"]), f"{again['plans']} plans, {again['differ']} differ")
    without = subprocess.run([jink.program, "report", log, "--png", folder / "x.png", "--out", folder / "x.html"], capture_output=True,
                             text=True, timeout=60, env={"PATH": "/nowhere"})
    missing = without.returncode == 3 and "gnuplot-nox" in without.stderr and len(without.stderr.strip().splitlines()) == 1
    check(missing and (folder / "x.html").exists(), f"without gnuplot: a page, no figure, status {without.returncode}")
    jink.run("report", log, "--png", folder / "x.png")
    check((folder / "x.png").read_bytes()[:4] == b"\x89PNG", "with it, a figure")
    other = jink.summary("replay", log, "--set", "horizon.margin=1.5", status=1)
    check(other["differ"] == len(other["differences"]) > 0, f"with a margin of 1.5 m {other['differ']} differ")
    check(jink.summary("replay", log, "--seed", 4, status=1)["differ"] > 0, "with another seed some differ")
    lines = log.read_text().splitlines(keepends=True)
    cut = folder / "cut.jsonl"
    cut.write_text("".join(lines)[:-9])
    check(jink.summary("replay", cut)["ignored_records"] == 1, "a last line that is cut off")
    bad = {"garbage": (lines[:5] + ["garbage\n"] + lines[5:], ":6: is not JSON"),
           "header": (lines[1:], ":1: the first line is not a jink-log/1 header"),
           "old": (lines[:1] + ['{"type":"plan","t":1,"path":[],"ms":1,"status":"reaches"}\n'], "no record of what they were made from"),
           "none": (lines[:1], "holds no plans")}
    for name, (content, said) in bad.items():
        file = folder / f"{name}.jsonl"
        file.write_text("".join(content))
        done = jink.run("replay", file)
        one_line = done.returncode == 2 and len(done.stderr.strip().splitlines()) == 1 and said in done.stderr
        check(one_line and str(file) in done.stderr, f"{name}: status {done.returncode}: {done.stderr.strip()}")


def outcomes(jink, folder):
    base = {"format": "jink-scenario/1", "name": "case", "start": [0, 0, 2], "target": [10, 0, 2], "vehicle": "ardrone2"}
    cases = {
        "start_blocked": [{"radius": 1.0, "position": [0.5, 0, 2]}],
        "unreachable": [{"radius": 1.0, "position": [10, 0, 2]}],
    }
    for outcome, obstacles in cases.items():
        file = folder / f"{outcome}.yaml"
        file.write_text(yaml.safe_dump({**base, "obstacles": obstacles}))
        for mode in ("paper", "horizon"):
            check(jink.summary("plan", file, "--mode", mode, status=1)["outcome"] == outcome, f"{mode}: {outcome}")
    check(jink.summary("replay", folder / "start_blocked.yaml", status=1)["outcome"] == "start_blocked", "replay: start_blocked")
    occupied = folder / "occupied.yaml"
    occupied.write_text(yaml.safe_dump({**base, "time_limit": 20, "obstacles": cases["unreachable"]}))
    flight = jink.summary("replay", occupied, status=1)
    waits = flight["outcome"] == "timeout" and flight["min_clearance"] > 0
    check(waits, f"replay: waits clear of an occupied target, {flight['outcome']}, clearance {flight['min_clearance']:.2f} m")


def test(program, instance):
    jink = Jink(program, int(instance))
    with tempfile.TemporaryDirectory(prefix="jink-command-line-") as name:
        folder = pathlib.Path(name)
        for case in (bad_usage, help_reads, plans, algorithms, paper_slr):
            print(f"== {case.__name__}", flush=True)
            case(jink)
        for case in (bad_values, bad_peers, same_file, odd_outputs, ctrl_c, every_motion, same_bits, team_flight, recorded_flight, outcomes):
            print(f"== {case.__name__}", flush=True)
            case(jink, folder)


main(test)
