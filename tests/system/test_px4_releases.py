# SPDX-License-Identifier: BSD-3-Clause
"""The releases of PX4 that `jink sim` plays are flown, over MAVLink and over DDS, with a battery that is low.

    test_px4_releases.py JINK INSTANCE
"""

import json
import subprocess

import yaml

from flight import Arena, check, interrupt, main, wait, wait_until

VERSIONS = {"1.14": "PX4 1.14.0", "1.16": "PX4 1.16.0", "1.18": "PX4 1.18.0"}
LOW = {"at": 0.5, "kind": "low_battery", "remaining": 0.12}
PILOT = {"at": 1.5, "kind": "pilot_mode", "mode": "position"}
LOW_AT_ONCE = {**LOW, "at": PILOT["at"]}  # 1.14 says CRITICAL for it: nothing but the sticks tells it from a failsafe


def scenario(arena, *faults):
    world = {"format": "jink-scenario/1", "name": "releases", "start": [0, 0, 1.5], "target": [8, 0, 1.5], "vehicle": "ardrone2",
             "obstacles": [{"radius": 0.4, "position": [4, 4, 1.5]}], "faults": list(faults)}
    file = arena.folder / "releases.yaml"
    file.write_text(yaml.safe_dump(world))
    return file


def flight(jink, instance, version, faults, **mission):
    """One flight; the exit status, the summary and the folder's events."""
    with Arena(jink, instance) as arena:
        sim = arena.sim(scenario(arena, *faults), "--px4", version, "--dds-vehicle")
        wait_until(lambda: "Ctrl-C" in (arena.folder / "sim.txt").read_text(), 60, "the simulator")
        name = f"px4_{instance}" if instance else ""
        file = arena.mission("sitl", waypoints=[[8, 0, 1.5]], dds={"domain": arena.domain, "namespace": name}, **mission)
        if not mission:
            done = subprocess.run([jink, "doctor", file, "--seconds", "3", "--json", arena.folder / "doctor.json"],
                                  capture_output=True, text=True, timeout=60)
            told = {c["name"]: c["finding"] for c in json.loads((arena.folder / "doctor.json").read_text())["checks"]}
            check(VERSIONS[version] in told["version"], f"{version}: the doctor says {told['version']}: {done.returncode}")
        fly = arena.fly(file)
        status = wait(fly, 100)
        interrupt(sim)
        return status, arena.read("fly.json"), arena.log("fly.jsonl", "event")


def test(jink, instance):
    for version in VERSIONS:
        for way in ({}, {"state": "dds", "setpoints": "dds"}):
            status, summary, events = flight(jink, int(instance), version, [LOW], **way)
            check(status == 0 and summary["outcome"] == "reached",
                  f"{version}, {'DDS' if way else 'MAVLink'}: {summary['outcome']}, {summary['reason']}")
            told = {name: [(e["t"], e["detail"]) for e in events if e["name"] == name] for name in ("battery", "phase")}
            check(any(detail == "low" for _, detail in told["battery"]), f"with a low battery: {told}")
            check(not any("failsafe" in hazard["what"] for hazard in summary["hazards"]), "which is taken for no failsafe")
        for low, reason in ((LOW, "position by pilot"),
                            (LOW_AT_ONCE, "left to the pilot" if version == "1.14" else "position by pilot")):
            status, summary, events = flight(jink, int(instance), version, [low, PILOT], arrival="hold")
            check(status == 1 and reason in summary["reason"], f"{version}: {summary['reason']}")
            requests = [e["detail"] for e in events if e["name"] == "request"]
            check(not any("hold" in request for request in requests), f"HOLD is not among {requests}")


main(test)
