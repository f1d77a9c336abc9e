# SPDX-License-Identifier: BSD-3-Clause
"""`jink sim --lockstep`: time stands while a companion owes its setpoint, for a second at most.

    test_lockstep.py JINK INSTANCE
"""

import time

from flight import CONFIG, Arena, check, interrupt, main, wait_until
from peer import MAV, OFFBOARD, Peer

BOUND = 1.0  # s, of the wall's time, that a companion is waited for
GIVEN_UP = "no setpoint from the companion"


def stands_then_goes_on(companion, output, nth):
    """The companion falls silent: nothing is told of later times until it is given up."""
    companion.target = None
    companion.pump(0.5)  # what was still under way when it fell silent
    stood_at, silent_since = companion.boot_time, companion.setpoint_sent
    later = companion.pump(20 * BOUND, lambda _: companion.boot_time > stood_at)
    stood = companion.last_heard - silent_since
    check(later is not None, f"time stood at {stood_at:.3f} s, and goes on after {stood:.2f} s")
    check(stood > 0.9 * BOUND, f"it was waited for, for {BOUND:.0f} s")
    wait_until(lambda: output.read_text().count(GIVEN_UP) == nth, 10, f"line {nth} that says so")
    check(True, f"sim says that it gave the companion up: line {nth}")


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        companion = Peer.companion(arena.instance)
        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml", "--lockstep")
        output = arena.folder / "sim.txt"
        companion.take_off((0.0, 0.0, -3.0))

        companion.set_parameter("COM_OBL_RC_ACT", 5)  # hold: however long time runs freely, it stays up

        begun = companion.boot_time
        companion.pump(10, lambda _: companion.boot_time > begun + 2.0)
        check(companion.boot_time > begun + 2.0, "with a setpoint for every ATTITUDE time goes on")
        check(GIVEN_UP not in output.read_text(), "a companion that answers is not given up")

        check(abs(companion.clock_rate() - 1.0) < 0.001, "the autopilot's clock is the simulation's")

        stands_then_goes_on(companion, output, 1)
        # Time runs freely now, and the autopilot misses its stream by its own clock.
        companion.expect(lambda: companion.heartbeat.system_status == MAV.MAV_STATE_CRITICAL, 20, "its failsafe")

        companion.target = (0.0, 0.0, -3.0)
        companion.expect(lambda: companion.mode() == OFFBOARD and companion.heartbeat.system_status == MAV.MAV_STATE_ACTIVE,
                         30, "OFFBOARD again")
        stands_then_goes_on(companion, output, 2)
        check(interrupt(sim) == 0, "sim ends with exit status 0")


main(test)
