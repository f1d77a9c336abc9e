# SPDX-License-Identifier: BSD-3-Clause
"""`jink sim` and `jink fly`, two processes over UDP and DDS, reach the target without a hit.

    test_fly.py JINK INSTANCE SCENARIO MISSION
"""

import math
import re

from flight import CONFIG, Arena, check, interrupt, main, wait


def distance(a, b):
    return math.dist(a, b)


def test(jink, instance, scenario, mission):
    with Arena(jink, int(instance)) as arena:
        sim = arena.sim(CONFIG / "scenarios" / f"{scenario}.yaml")
        fly = arena.fly(arena.mission(mission))
        check(wait(fly, 150) == 0, "fly ends with exit status 0")
        check(interrupt(sim) == 0, "sim, interrupted, ends with exit status 0: nothing was hit")

        flown = arena.read("fly.json")
        check(flown["format"] == "jink-flight/1" and flown["outcome"] == "reached", f"fly: {flown['outcome']}")
        z = flown["end_estimate"][2]
        printed = (arena.folder / "fly.txt").read_text()
        check(f"{z:.1f}) m by the autopilot's estimate; z is no height above ground" in printed, f"z {z:.2f} m is the estimate's")
        check(not re.search(r"(?<!min_)height -?\d", printed), "and nothing printed claims a height")
        check(flown["min_clearance"] is None, "fly does not claim to know the true clearance")
        check(flown["plans"] > 10 and flown["plan_ms"]["p99"] > 0.0, f"{flown['plans']} plans were made")

        truth = arena.read("sim.json")
        check(truth["min_clearance"] > 0.0, f"smallest true clearance {truth['min_clearance']:.2f} m")
        # Landing may end half a metre beside the target, so its own outcome says too little.
        check("the scenario's clock runs" in (arena.folder / "sim.txt").read_text(), "the obstacles moved")

        records = arena.log("sim.jsonl", "truth")
        check(len(records) > 250, f"{len(records)} records of the truth")
        target = arena.log("fly.jsonl", "header")[0]["target"]
        raised = [target[0], target[1], max(target[2], 1.0)]
        nearest = min(distance(record["p"], raised) for record in records)
        check(nearest < 0.3 + 3 * 0.25,  # it arrives by its estimate, which is 0.25 m rms off
               f"the true vehicle came within {nearest:.2f} m of the target")
        last = records[-1]
        check(last["p"][2] < 0.1 and math.hypot(*last["v"]) < 0.1, "it stands on the ground in the end")
        names = [record["detail"].split(":")[0] for record in arena.log("fly.jsonl", "event") if record["name"] == "phase"]
        check(names == ["waiting", "engaging", "climbing", "flying", "landing", "done"], f"phases {names}")


main(test)
