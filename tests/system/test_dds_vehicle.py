# SPDX-License-Identifier: BSD-3-Clause
"""`jink fly` takes the vehicle's position from DDS and sends its setpoints there, as PX4's uXRCE-DDS agent has them.

    test_dds_vehicle.py JINK INSTANCE
"""

from flight import CONFIG, Arena, check, interrupt, main, wait


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml", "--dds-vehicle")
        name = f"px4_{instance}" if int(instance) else ""
        dds = {"domain": arena.domain, **({"namespace": name} if name else {})}
        fly = arena.fly(arena.mission("sitl", dds=dds, state="dds", setpoints="dds"))
        check(wait(fly, 150) == 0, "fly ends with exit status 0")
        check(interrupt(sim) == 0, "sim, interrupted, ends with exit status 0: nothing was hit")
        check(arena.read("fly.json")["outcome"] == "reached", "the target is reached")
        check(arena.read("sim.json")["min_clearance"] > 0.0, "nothing is touched")


main(test)
