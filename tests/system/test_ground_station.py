# SPDX-License-Identifier: BSD-3-Clause
"""A ground station beside `jink fly`: it watches, takes the flight over with HOLD, and lands it.

    test_ground_station.py JINK INSTANCE

Its port, 14550, is shared by all instances: it listens to its own system alone, and must not run beside another one.
"""

import time

from flight import CONFIG, Arena, check, interrupt, main, wait
from peer import HOLD, LAND, MAV, OFFBOARD, Peer


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        ground = Peer.ground_station(arena.instance + 1)
        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml")
        ground.expect(lambda: ground.heartbeat is not None, 30, "a heartbeat of the simulator")
        fly = arena.fly(arena.mission("sitl"))
        output = arena.folder / "fly.txt"
        ground.expect(lambda: ground.armed() and ground.mode() == OFFBOARD, 60, "armed, in OFFBOARD")
        ground.expect(lambda: "Takeoff detected" in ground.texts, 30, "the text 'Takeoff detected'")
        check("Armed by external command" in ground.texts, "the text 'Armed by external command'")
        # Before it comes among the obstacles, where holding would not be safe.
        ground.expect(lambda: output.exists() and "phase: flying" in output.read_text(), 60, "the mission under way")
        ground.expect(lambda: ground.position and ground.position[2] < -1.0, 20, "the vehicle above 1 m")
        for phase in ("taking over", "climbing", "flying"):  # at two texts a second the last may still be to come
            told = (MAV.MAV_SEVERITY_INFO, f"jink: {phase}")
            ground.expect(lambda: told in [t[:2] for t in ground.companion_texts], 3, f"the pilot is told: {phase}")

        check(ground.set_mode(4, 3) == [0, 0], "HOLD by DO_SET_MODE is accepted, twice acknowledged")
        ground.expect(lambda: ground.mode() == HOLD, 3, "HOLD")
        taken_over = time.monotonic()
        ground.pump(60, lambda _: fly.poll() is not None)
        check(wait(fly, 5) == 1, f"fly ends with exit status 1, after {time.monotonic() - taken_over:.1f} s")
        summary = arena.read("fly.json")
        check(summary["outcome"] == "aborted", f"outcome {summary['outcome']}: {summary['reason']}")

        end = "jink: done: aborted, the mode was changed to hold by pilot or autopilot"
        ground.expect(lambda: (MAV.MAV_SEVERITY_CRITICAL, end) in [t[:2] for t in ground.companion_texts], 3, end)
        times = [t[3] for t in ground.companion_texts]
        check(all(b - a > 0.9 for a, b in zip(times, times[2:-1])), "no more than two texts a second, but the end's")
        check({t[2] for t in ground.companion_texts} == {MAV.MAV_COMP_ID_ONBOARD_COMPUTER}, "from the onboard computer")

        left = [ground.mode()]
        ground.pump(4.0, lambda _: left.append(ground.mode()))
        check(set(left) == {HOLD} and ground.heartbeat.system_status == MAV.MAV_STATE_ACTIVE, "HOLD stays, nobody takes it back")
        check(ground.set_mode(6) == [0, 1], "OFFBOARD is refused: no setpoints come any more")

        check(ground.command(MAV.MAV_CMD_NAV_LAND) == [0], "NAV_LAND is accepted")
        ground.expect(lambda: ground.mode() == LAND, 5, "LAND")
        ground.expect(lambda: ground.landed_state == MAV.MAV_LANDED_STATE_ON_GROUND, 60, "on the ground")
        ground.expect(lambda: not ground.armed(), 20, "disarmed")
        ground.expect(lambda: "Disarmed by landing" in ground.texts, 3, "the text 'Disarmed by landing'")
        check(interrupt(sim) == 0, "sim ends with exit status 0: nothing was hit")


main(test)
