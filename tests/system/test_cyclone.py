# SPDX-License-Identifier: BSD-3-Clause
"""Another vendor's DDS writer in place of the simulator's tracks: what it tells of is avoided.

    test_cyclone.py JINK INSTANCE

The simulator's world is empty and it tells of nothing; Cyclone DDS publishes a sphere that stands on the straight
line, or as a detector a box.
"""

import math
import subprocess
import sys

import yaml

from flight import SOURCE, Arena, check, interrupt, main, wait

SPHERE = ([8.0, 0.0, 1.5], 0.6)  # m: centre, radius
BOX = ([8.0, 0.0, 1.5], [1.0, 2.0, 3.0])  # m: centre, edges


def fly_past(arena, script, *options):
    """A flight from 0 to 16 m; the tracks that fly saw and where the vehicle truly was."""
    scenario = arena.folder / "empty.yaml"
    scenario.write_text(yaml.safe_dump({"format": "jink-scenario/1", "name": "empty", "start": [0, 0, 1.5],
                                        "target": [16, 0, 1.5], "vehicle": "ardrone2", "obstacles": []}))
    sim = arena.sim(scenario, "--no-tracks")
    arena.start("cyclone", [sys.executable, SOURCE / "tests" / script, "--domain", arena.domain, *options],
                stdin=subprocess.PIPE)
    fly = arena.fly(arena.mission("sitl", waypoints=[[16, 0, 1.5]]))
    check(wait(fly, 150) == 0, "fly ends with exit status 0")
    check(interrupt(sim) == 0, "sim ends with exit status 0")
    seen = [track for record in arena.log("fly.jsonl", "tracks") for track in record["tracks"]]
    return seen, [record["p"] for record in arena.log("sim.jsonl", "truth")]


def check_passed(seen, center, path, clearance):
    check(seen and all(math.dist(track["p"], center) < 1e-6 for track in seen), "fly saw what Cyclone told of alone")
    check(0.0 < clearance < 3.0, f"the true vehicle passed it at {clearance:.2f} m")
    check(max(p[0] for p in path) > 15.0, "and went on to the target behind it")


def sphere(jink, instance):
    with Arena(jink, instance) as arena:
        (x, y, z), radius = SPHERE
        seen, path = fly_past(arena, "system/cyclone_tracks.py", "--rate", "20", "--duration", "200",
                              "--obstacle", f"{x},{y},{z},0,0,0,{radius}")
        check_passed(seen, SPHERE[0], path, min(math.dist(p, SPHERE[0]) for p in path) - radius - 0.30)


def detected_box(jink, instance):
    with Arena(jink, instance) as arena:
        center, edges = BOX
        seen, path = fly_past(arena, "bridge/dds/cyclone_detections.py", "--box", ",".join(map(str, center + edges)))

        def clearance(p):
            return math.hypot(*(max(0.0, abs(a - b) - 0.5 * edge) for a, b, edge in zip(p, center, edges))) - 0.30

        check_passed(seen, center, path, min(map(clearance, path)))


def test(jink, instance):
    for case in (sphere, detected_box):
        print(f"== {case.__name__}", flush=True)
        case(jink, int(instance))


main(test)
