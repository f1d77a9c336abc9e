# SPDX-License-Identifier: BSD-3-Clause
"""A wall that nobody knows of is found by a lidar, whose clouds go over DDS, and flown round.

    test_clouds.py JINK INSTANCE
"""

from flight import Arena, check, interrupt, main, wait

SCENARIO = """
format: jink-scenario/1
name: unknown wall
start: [0, 0, 1.5]
target: [14, 0, 1.5]
vehicle: ardrone2
world: {min: [-10, -12, 0], max: [25, 12, 4]}
map: [{box: [0.4, 8, 4], position: [7, 0, 2]}]
sensing: {scan: lidar}
estimate: none
obstacles: []
"""


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        scenario = arena.folder / "wall.yaml"
        scenario.write_text(SCENARIO)
        sim = arena.sim(scenario)
        mission = arena.mission("sitl", waypoints=[[14, 0, 1.5]], cloud={"range": 12, "all_round": True},
                                tracks={"required": False}, geofence={"min": [-10, -12, 0], "max": [25, 12, 4]})
        doctor = arena.start("doctor", [jink, "doctor", mission, "--seconds", 4])
        wait(doctor, 60)
        line = next(line for line in (arena.folder / "doctor.txt").read_text().splitlines() if "rt/jink/points" in line)
        check("1 writer" in line and "ok" in line, f"doctor hears the lidar: {line.strip()}")
        fly = arena.fly(mission)
        check(wait(fly, 150) == 0, "fly ends with exit status 0")
        check(arena.read("fly.json")["outcome"] == "reached", "at the target")
        check(interrupt(sim) == 0, "sim ends with exit status 0: nothing was hit")
        nearest = arena.read("sim.json")["min_clearance"]
        check(0.0 < nearest < 3.0, f"it passed the wall, {nearest:.2f} m from it")
        check("map" not in arena.log("fly.jsonl", "header")[0], "which it had not been told of")
        seen = arena.log("fly.jsonl", "seen")
        check(len(seen) > 5 and any(record["added"] for record in seen), f"and saw in {len(seen)} steps")
        replay = arena.start("replay", [jink, "replay", arena.folder / "fly.jsonl"])
        check(wait(replay, 120) == 0, "its plans come out the same again")


main(test)
