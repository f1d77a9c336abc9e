# SPDX-License-Identifier: BSD-3-Clause
"""Another vendor's DDS writer in place of the simulator's tracks: what it tells of is avoided.

    test_cyclone.py JINK INSTANCE

The simulator's world is empty and it tells of nothing; Cyclone DDS publishes a sphere that stands on the straight line.
"""

import math
import pathlib
import sys

import yaml

from flight import Arena, check, interrupt, main, wait

SPHERE = ([8.0, 0.0, 1.5], 0.6)  # m: centre, radius


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        scenario = arena.folder / "empty.yaml"
        scenario.write_text(yaml.safe_dump({"format": "jink-scenario/1", "name": "empty", "start": [0, 0, 1.5],
                                            "target": [16, 0, 1.5], "vehicle": "ardrone2", "obstacles": []}))
        sim = arena.sim(scenario, "--no-tracks")
        (x, y, z), radius = SPHERE
        arena.start("cyclone", [sys.executable, pathlib.Path(__file__).parent / "cyclone_tracks.py", "--domain", arena.domain,
                                "--rate", "20", "--duration", "200", "--obstacle", f"{x},{y},{z},0,0,0,{radius}"])
        fly = arena.fly(arena.mission("sitl", waypoints=[[16, 0, 1.5]]))
        check(wait(fly, 150) == 0, "fly ends with exit status 0")
        check(interrupt(sim) == 0, "sim ends with exit status 0")
        seen = [track for record in arena.log("fly.jsonl", "tracks") for track in record["tracks"]]
        check(seen and all(math.dist(track["p"], SPHERE[0]) < 1e-6 for track in seen), "fly saw Cyclone's sphere alone")
        truth = arena.log("sim.jsonl", "truth")
        clearance = min(math.dist(record["p"], SPHERE[0]) for record in truth) - radius - 0.30
        check(0.0 < clearance < 3.0, f"the true vehicle passed it at {clearance:.2f} m")
        check(max(record["p"][0] for record in truth) > 15.0, "and went on to the target behind it")


main(test)
