# SPDX-License-Identifier: BSD-3-Clause
"""Who may tell `jink fly` of obstacles: a standby takes over, participants are named, a secured domain lets nobody in. And
what they tell: solids are flown past as they are.

    test_track_writers.py JINK INSTANCE
"""

import sys
import time

import yaml

from flight import SOURCE, Arena, check, interrupt, main, wait, wait_until

sys.path.insert(0, str(SOURCE / "tests" / "support"))

from dds_keystore import make_keystore

SCENARIO = {"format": "jink-scenario/1", "name": "aside", "start": [0, 0, 1.5], "target": [25, 0, 1.5], "vehicle": "ardrone2",
            "obstacles": [{"radius": 0.4, "position": [5, -6, 1.5]}], "time_limit": 60}


GAP = 1.2  # m, half its width
# Two walls beside the way; the spheres around them overlap in the gap.
WALLS = dict(SCENARIO, name="gap",
             obstacles=[{"box": [0.4, 6, 6], "position": [12, side * (GAP + 3), 3]} for side in (-1, 1)])


class Writers:
    """The vehicle without tracks, and programs that write them."""

    def __init__(self, arena, *options, scenario=SCENARIO):
        self.arena = arena
        self.scenario = arena.folder / "scenario.yaml"
        self.scenario.write_text(yaml.safe_dump(scenario))
        self.vehicle = arena.sim(self.scenario, "--no-tracks", *options)

    def start(self, name, *options):
        return self.arena.start(name, [self.arena.jink, "sim", self.scenario, "--no-vehicle", "--domain", self.arena.domain,
                                       *options])


def printed(arena, text):
    file = arena.folder / "fly.txt"
    return lambda: file.exists() and text in file.read_text()


def standby(jink, instance):
    with Arena(jink, instance) as arena:
        writers = Writers(arena)
        first = writers.start("first")
        # Discovery takes some seconds: both count as live for a while.
        fly = arena.fly(arena.mission("sitl", waypoints=[[25, 0, 1.5]], arrival="hold", tracks={"timeout_s": 5.0}))
        wait_until(printed(arena, "phase: flying"), 60, "flight")
        time.sleep(1.0)
        first.kill()
        writers.start("second")
        check(wait(fly, 60) == 0, "a standby takes over, and the flight reaches its target")
        check(arena.read("fly.json")["hazards"] == [], "without a hazard")
        check(interrupt(writers.vehicle) == 0, "and nothing is hit")


def named(jink, instance):
    with Arena(jink, instance) as arena:
        writers = Writers(arena)
        writers.start("first")
        fly = arena.fly(arena.mission("sitl", tracks={"writers": {"jink": ["tracker of the mission"]}}))
        wait_until(printed(arena, "waiting: obstacle tracks of 'tracker of the mission'"), 30, "the mission's writer")
        wait_until(printed(arena, "tracks of 'jink track writer', whom the mission does not name"), 10, "the refusal")
        interrupt(fly)
        fly = arena.fly(arena.mission("sitl", tracks={"writers": {"jink": ["jink track writer"]}}))
        wait_until(printed(arena, "phase: flying"), 60, "flight")
        check(interrupt(fly) == 1, "who is named is heard")
        interrupt(writers.vehicle)


def namespaced(jink, instance):
    with Arena(jink, instance) as arena:
        writers = Writers(arena)
        writers.start("theirs", "--tracks-namespace", "uav_2")
        writers.start("nobodys")
        fly = arena.fly(arena.mission("sitl", tracks={"namespace": "uav_1"}))
        time.sleep(6.0)
        check(printed(arena, "waiting: obstacle tracks")() and not printed(arena, "phase: engaging")(),
              "another vehicle's tracks are not ours")
        writers.start("ours", "--tracks-namespace", "uav_1")
        wait_until(printed(arena, "phase: flying"), 60, "flight")
        interrupt(fly)
        interrupt(writers.vehicle)


def secured(jink, instance):
    with Arena(jink, instance) as arena:
        keys = make_keystore(arena.folder / "keys", ["fly", "tracker"])
        others = make_keystore(arena.folder / "others", ["stranger"])
        writers = Writers(arena)
        writers.start("no_keys")
        writers.start("other_keys", "--dds-security", others / "stranger")
        domain = {"domain": arena.domain, "security": "keys/fly"}
        fly = arena.fly(arena.mission("sitl", dds=domain))
        time.sleep(8.0)
        check(printed(arena, "waiting: obstacle tracks")() and not printed(arena, "phase: engaging")(),
              "who has no key of this domain, or another's, is not heard")
        writers.start("tracker", "--dds-security", keys / "tracker")
        wait_until(printed(arena, "phase: flying"), 60, "flight with tracks of who has a key")
        interrupt(fly)
        interrupt(writers.vehicle)


def shaped(jink, instance):
    with Arena(jink, instance) as arena:
        writers = Writers(arena, scenario=WALLS)
        writers.start("walls")
        fly = arena.fly(arena.mission("sitl", waypoints=[[25, 0, 1.5]], arrival="hold"))
        check(wait(fly, 90) == 0, "the target behind two walls is reached")
        check(interrupt(writers.vehicle) == 0, "and nothing is hit")
        beside = [record["p"] for record in arena.log("sim.jsonl", "truth") if abs(record["p"][0] - 12) < 0.2]
        check(beside and all(abs(y) < GAP and z < 6 for _, y, z in beside), "by the gap that the walls' spheres close")


def test(jink, instance):
    for case in (standby, named, namespaced, secured, shaped):
        print(f"== {case.__name__}", flush=True)
        case(jink, int(instance))


main(test)
