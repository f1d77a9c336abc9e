# SPDX-License-Identifier: BSD-3-Clause
"""How `jink fly` ends when things go wrong: a missing peer, tracks that stop, Ctrl-C, a hit, as the mission chooses.

    test_endings.py JINK INSTANCE
"""

import signal

import yaml

from flight import CONFIG, Arena, check, interrupt, main, wait, wait_until
from ground_station import set_parameter

CROSSING = CONFIG / "scenarios" / "crossing.yaml"
ASIDE = [{"radius": 0.4, "position": [5, -6, 1.5]}]


def crossing(arena, **changes):
    """The scenario, changed, as a file."""
    scenario = yaml.safe_load(CROSSING.read_text()) | changes
    if scenario.get("world") is None:
        scenario.pop("world")
    file = arena.folder / "scenario.yaml"
    file.write_text(yaml.safe_dump(scenario))
    return file


def events(arena, name):
    return [record["detail"] for record in arena.log("fly.jsonl", "event") if record["name"] == name]


def flying(arena):
    file = arena.folder / "fly.txt"
    return lambda: file.exists() and "phase: flying" in file.read_text()


def last_mode(arena):
    return arena.log("fly.jsonl", "state")[-1]["mode"]


def nobody_there(jink, instance):
    with Arena(jink, instance) as arena:
        fly = arena.fly(arena.mission("sitl"))
        check(wait(fly, 60) == 3, "without an autopilot fly ends with exit status 3")
        lines = [line for line in (arena.folder / "fly.txt").read_text().splitlines() if line.startswith("jink: ")]
        check(len(lines) == 1 and "heartbeat" in lines[0] and "jink sim" in lines[0], f"one line says so: {lines}")


def interrupted_in_flight(jink, instance):
    with Arena(jink, instance) as arena:
        sim = arena.sim(CROSSING)
        fly = arena.fly(arena.mission("sitl"))
        wait_until(flying(arena), 60, "flight")
        fly.send_signal(signal.SIGINT)
        check(wait(fly, 30) == 1, "interrupted in flight, fly ends with exit status 1")
        check(arena.read("fly.json")["outcome"] == "aborted", "outcome aborted")
        check(last_mode(arena) == "hold", "the autopilot was put in HOLD")
        check(interrupt(sim) == 0, "and hit nothing")


def tracks_stop(jink, instance):
    with Arena(jink, instance) as arena:
        # Two processes start two clocks: what moves is not where the tracks say.
        scenario = crossing(arena, obstacles=ASIDE)
        sim = arena.sim(scenario, "--no-tracks")
        writer = arena.start("tracks", [jink, "sim", scenario, "--no-vehicle", "--domain", arena.domain])
        fly = arena.fly(arena.mission("sitl"))
        wait_until(flying(arena), 60, "flight")
        writer.send_signal(signal.SIGKILL)
        check(wait(fly, 30) == 1, "when the tracks stop, fly ends with exit status 1")
        summary = arena.read("fly.json")
        check("tracks are stale" in summary["reason"], f"reason: {summary['reason']}")
        check(any("stale" in detail for detail in events(arena, "hazard")), "the hazard is in the log")
        check(last_mode(arena) == "hold", "the autopilot was put in HOLD")
        interrupt(sim)


def simulated(arena, scenario):
    """The simulator, listening."""
    sim = arena.sim(scenario)
    wait_until(lambda: "Ctrl-C" in (arena.folder / "sim.txt").read_text(), 60, "the simulator")
    return sim


def refused(jink, instance):
    """An autopilot that cuts its motors when setpoints stop is flown by who says so, and by nobody else."""
    with Arena(jink, instance) as arena:
        sim = simulated(arena, CROSSING)
        set_parameter(instance, "COM_OBL_RC_ACT", 7)
        check(wait(arena.fly(arena.mission("sitl")), 60) == 1, "it is refused")
        check("COM_OBL_RC_ACT 7" in arena.read("fly.json")["reason"], f"reason: {arena.read('fly.json')['reason']}")
        check(not any(state["armed"] for state in arena.log("fly.jsonl", "state")), "nothing was armed")
        fly = arena.fly(arena.mission("sitl", endings={"accept": ["motors_cut"]}))
        wait_until(flying(arena), 60, "flight of a mission that accepts it")
        check(interrupt(fly) == 1 and last_mode(arena) == "hold", "and ends as any other")
        interrupt(sim)


def ending(jink, instance, cause, fault, choice):
    """The mission's choice, by what was asked for and the mode in the end."""
    with Arena(jink, instance) as arena:
        sim = simulated(arena, crossing(arena, faults=[fault], obstacles=ASIDE))  # from then on nothing is avoided
        set_parameter(instance, "RTL_RETURN_ALT", 10.0)
        fly = arena.fly(arena.mission("sitl", endings={cause: choice}))
        check(wait(fly, 120) == 1, f"endings.{cause}: {choice} ends with exit status 1")
        asked = events(arena, "request")
        modes = [state["mode"] for state in arena.log("fly.jsonl", "state")]
        check(asked[-1] == choice and choice in modes, f"asked for {asked}, modes {sorted(set(modes))}")
        check(interrupt(sim) == 0, "and hit nothing")


def tracks_land(jink, instance):
    ending(jink, instance, "tracks", {"at": 1.0, "kind": "tracks_stop"}, "land")


def battery_return(jink, instance):
    ending(jink, instance, "battery", {"at": 1.5, "kind": "low_battery", "remaining": 0.06}, "return")


def collision(jink, instance):
    """A sphere appears on the vehicle: the simulator's motors stop, and fly says what it saw."""
    with Arena(jink, instance) as arena:
        falls = {"type": "waypoints", "times": [0, 1.0, 1.5], "points": [[6, 0, 30], [6, 0, 30], [6, 0, 1.5]]}
        sim = arena.sim(crossing(arena, sensing={"range": 0.001}, world=None, obstacles=[{"radius": 3.0, "motion": falls}]))
        fly = arena.fly(arena.mission("sitl"))
        check(wait(fly, 90) == 1, "hit, fly ends with exit status 1")
        check("disarmed in flight" in arena.read("fly.json")["reason"], f"reason: {arena.read('fly.json')['reason']}")
        check(interrupt(sim) == 1, "sim ends with exit status 1")
        truth = arena.read("sim.json")
        check(truth["outcome"] == "collision" and truth["min_clearance"] < 0.0, f"sim: {truth['outcome']}, {truth['reason']}")


def test(jink, instance):
    for case in (nobody_there, interrupted_in_flight, tracks_stop, refused, tracks_land, battery_return, collision):
        print(f"== {case.__name__}", flush=True)
        case(jink, int(instance))


main(test)
