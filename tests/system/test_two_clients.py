# SPDX-License-Identifier: BSD-3-Clause
"""A companion and a ground station at once, both pymavlink: each hears what is meant for it, and the pilot's word counts.

    test_two_clients.py JINK INSTANCE

The ground station's port, 14550, is shared by all instances: must not run beside another one.
"""

import threading

from flight import CONFIG, Arena, Failed, check, interrupt, main
from peer import HOLD, LAND, MAV, Peer

SITL_CLOCK_RATE = 0.987
TAKEOFF_DETECTED = 0x01414569


class Beside:
    """Lets a peer listen and stream in a thread of its own, while another one does something."""

    def __init__(self, peer):
        self.peer = peer
        self.acks = []
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.listen)

    def listen(self):
        while not self.over.is_set():
            message = self.peer.pump(0.2, lambda m: m.get_type() == "COMMAND_ACK")
            if message is not None:
                self.acks.append(message)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        companion, ground = Peer.companion(arena.instance), Peer.ground_station(arena.instance + 1)
        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml")
        with Beside(ground) as watching:
            companion.take_off((0.0, 0.0, -3.0))
        check(not watching.acks, "the companion's acknowledgements are not the ground station's")
        for text in ("Armed by external command", "Takeoff detected"):
            check(text in ground.texts, f"the ground station has read '{text}'")
        check(not companion.texts, "the companion has not: texts go to ground stations alone")
        check(TAKEOFF_DETECTED in companion.events and TAKEOFF_DETECTED in ground.events, "events go to both")
        check(abs(ground.position[2] - companion.position[2]) < 1.0, "both see the vehicle at its height")

        rate = companion.clock_rate()
        check(abs(rate - SITL_CLOCK_RATE) < 0.001, f"the autopilot's clock runs as PX4 SITL's does: {rate:.4f} s in a second")

        with Beside(companion) as flying:
            check(ground.set_mode(4, 3) == [0, 0], "the ground station takes over with HOLD")
            ground.expect(lambda: ground.mode() == HOLD, 5, "HOLD")
            ground.pump(3.0)
            if ground.mode() != HOLD:
                raise Failed("the companion's stream took the flight back")
            check(ground.command(MAV.MAV_CMD_NAV_LAND) == [0], "and lands")
            ground.expect(lambda: ground.mode() == LAND, 5, "LAND")
        check(not flying.acks, "the ground station's acknowledgements are not the companion's")
        companion.expect(lambda: companion.mode() == LAND, 5, "LAND")
        ground.expect(lambda: ground.landed_state == MAV.MAV_LANDED_STATE_ON_GROUND, 60, "on the ground")
        ground.expect(lambda: not ground.armed(), 20, "disarmed")
        check(interrupt(sim) == 0, "sim ends with exit status 0")


main(test)
