# SPDX-License-Identifier: BSD-3-Clause
"""A ground station beside `jink fly`: it watches, takes the flight over with HOLD, and lands it.

    test_ground_station.py JINK INSTANCE

Its port, 14550, is shared by all instances: it listens to its own system alone, and must not run beside another one.
"""

import os
import time

os.environ["MAVLINK20"] = "1"  # read when pymavlink is imported
from pymavlink import mavutil  # noqa: E402

from flight import CONFIG, Arena, Failed, check, interrupt, main, wait

MAV = mavutil.mavlink
HOLD, LAND, OFFBOARD = 0x03040000, 0x06040000, 0x00060000
ARMED = 0x80


class GroundStation:
    def __init__(self, system):
        self.system = system
        self.link = mavutil.mavlink_connection("udpin:127.0.0.1:14550", source_system=255, source_component=190, dialect="common")
        self.last_heartbeat = 0.0
        self.texts = []
        self.chunks = {}
        self.position = None  # NED
        self.heartbeat = None
        self.landed_state = None

    def note(self, message):
        kind = message.get_type()
        if kind == "HEARTBEAT":
            self.heartbeat = message
        elif kind == "LOCAL_POSITION_NED":
            self.position = (message.x, message.y, message.z)
        elif kind == "EXTENDED_SYS_STATE":
            self.landed_state = message.landed_state
        elif kind == "STATUSTEXT":
            text = self.chunks.pop(message.id, "") + message.text
            if text.endswith("\t"):
                self.texts.append(text.rstrip("\t"))
            else:
                self.chunks[message.id] = text

    def pump(self, seconds, until=lambda message: False):
        """Listens, with a heartbeat a second, for `seconds` or until `until(message)`; that message, else None."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if time.monotonic() - self.last_heartbeat > 1.0:
                self.last_heartbeat = time.monotonic()
                self.link.mav.heartbeat_send(MAV.MAV_TYPE_GCS, MAV.MAV_AUTOPILOT_INVALID, 0, 0, MAV.MAV_STATE_ACTIVE)
            message = self.link.recv_match(blocking=True, timeout=0.05)
            if message is None or message.get_srcSystem() != self.system or message.get_srcComponent() != 1:
                continue
            self.note(message)
            if until(message):
                return message
        return None

    def expect(self, condition, seconds, text):
        if not condition() and self.pump(seconds, lambda _: condition()) is None:
            raise Failed(f"the ground station waited {seconds} s in vain for {text}; texts: {self.texts}")
        check(True, f"the ground station saw: {text}")

    def command(self, number, *parameters, acks=1):
        """The results of the acknowledgements to a command."""
        fields = list(parameters) + [0.0] * (7 - len(parameters))
        self.link.mav.command_long_send(self.system, 1, number, 0, *fields)
        results = []
        while len(results) < acks:
            ack = self.pump(5.0, lambda m: m.get_type() == "COMMAND_ACK" and m.command == number and m.get_srcSystem() == self.system)
            if ack is None:
                break
            results.append(ack.result)
        return results

    def set_mode(self, main_mode, sub_mode=0):
        return self.command(MAV.MAV_CMD_DO_SET_MODE, 1, main_mode, sub_mode, acks=2)

    def mode(self):
        return self.heartbeat.custom_mode if self.heartbeat else None

    def armed(self):
        return bool(self.heartbeat and self.heartbeat.base_mode & ARMED)


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        ground = GroundStation(arena.instance + 1)
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

        check(ground.set_mode(4, 3) == [0, 0], "HOLD by DO_SET_MODE is accepted, twice acknowledged")
        ground.expect(lambda: ground.mode() == HOLD, 3, "HOLD")
        taken_over = time.monotonic()
        ground.pump(60, lambda _: fly.poll() is not None)
        check(wait(fly, 5) == 1, f"fly ends with exit status 1, after {time.monotonic() - taken_over:.1f} s")
        summary = arena.read("fly.json")
        check(summary["outcome"] == "aborted", f"outcome {summary['outcome']}: {summary['reason']}")

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
