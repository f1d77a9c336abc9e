#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks a live simulator's MAVLink endpoint with a client that shares no code with it.

Run `jink sim` (or PX4 SITL), then this: it connects with pymavlink, arms, is refused and granted OFFBOARD, takes off,
flies a leg, lands. One line per check; exit status 0 only if every one holds, 3 if nobody answers.
"""

import argparse
import math
import os
import sys
import time

os.environ["MAVLINK20"] = "1"  # read when pymavlink is imported
from pymavlink import mavutil  # noqa: E402

MAV = mavutil.mavlink
OFFBOARD = (6, 0)
HOLD = (4, 3)
POSITION_ONLY = 0x0DF8
ON_GROUND, IN_AIR, TAKING_OFF, LANDING = 1, 2, 3, 4
PREARM_BIT = 0x10000000


class Client:
    def __init__(self, address, port):
        self.link = mavutil.mavlink_connection(
            f"udpin:{address}:{port}", source_system=245, source_component=191, dialect="common"
        )
        self.failures = 0
        self.last_setpoint = 0.0
        self.target = None  # NED, streamed at 20 Hz while it is set
        self.landed_states = []

    def check(self, name, holds, detail=""):
        print(f"{'ok  ' if holds else 'FAIL'} {name}{': ' + str(detail) if detail != '' else ''}", flush=True)
        self.failures += not holds
        return holds

    def send_setpoint(self):
        x, y, z = self.target
        self.link.mav.set_position_target_local_ned_send(
            0, self.link.target_system, 1, MAV.MAV_FRAME_LOCAL_NED, POSITION_ONLY, x, y, z, 0, 0, 0, 0, 0, 0, 0, 0
        )

    def pump(self, seconds, until=None):
        """Receives for `seconds`, or until `until(message)` is true: then that message, else None."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.target is not None and time.monotonic() - self.last_setpoint > 0.05:
                self.last_setpoint = time.monotonic()
                self.send_setpoint()
            message = self.link.recv_match(blocking=True, timeout=0.02)
            if message is None:
                continue
            if message.get_type() == "EXTENDED_SYS_STATE" and message.landed_state not in self.landed_states[-1:]:
                self.landed_states.append(message.landed_state)
            if until is not None and until(message):
                return message
        return None

    def wait(self, kind, seconds, condition=lambda message: True):
        return self.pump(seconds, lambda m: m.get_type() == kind and condition(m))

    def command(self, number, *parameters, acks=1):
        """The results of the acknowledgements to a command."""
        fields = list(parameters) + [0.0] * (7 - len(parameters))
        self.link.mav.command_long_send(self.link.target_system, 1, number, 0, *fields)
        results = []
        for _ in range(acks):
            ack = self.wait("COMMAND_ACK", 1.0, lambda m: m.command == number)
            if ack is not None:
                results.append(ack.result)
        return results

    def set_mode(self, mode):
        return self.command(MAV.MAV_CMD_DO_SET_MODE, 1, *mode, acks=2)

    def arm(self):
        return self.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1)

    def heartbeat(self, condition=lambda message: True, seconds=3.0):
        return self.wait("HEARTBEAT", seconds, lambda m: m.get_srcComponent() == 1 and condition(m))

    def run(self):
        heartbeat = self.link.wait_heartbeat(timeout=10)
        if heartbeat is None:
            print("no heartbeat within 10 s: is the simulator running, with this port as its companion's?")
            return 3
        self.check("a PX4 quadrotor's heartbeat", (heartbeat.autopilot, heartbeat.type) == (12, 2))
        self.check_on_ground()
        self.check_offboard_flight()
        self.check_landing()
        return 1 if self.failures else 0

    def check_on_ground(self):
        healthy = self.wait("SYS_STATUS", 10, lambda m: m.onboard_control_sensors_health & PREARM_BIT)
        self.check("ready to arm", healthy is not None)
        self.check("MAVLink 2", self.link.WIRE_PROTOCOL_VERSION == "2.0")
        self.check("unknown command: unsupported", self.command(31999) == [3])
        self.check("request of an unknown message: denied", self.command(MAV.MAV_CMD_REQUEST_MESSAGE, 11000) == [2])
        self.check("set HOLD: two acks", self.set_mode(HOLD) == [0, 0])
        self.check("arm", self.arm() == [0])
        armed = self.heartbeat(lambda m: m.base_mode == 0x9D and m.custom_mode == 0x03040000)
        self.check("heartbeat: armed in HOLD", armed is not None and armed.system_status == 4)
        self.check("OFFBOARD without a stream while armed: second ack 1", self.set_mode(OFFBOARD) == [0, 1])
        self.check("disarm on the ground", self.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 0) == [0])

    def check_offboard_flight(self):
        here = self.wait("LOCAL_POSITION_NED", 2)
        if not self.check("LOCAL_POSITION_NED", here is not None):
            return
        self.target = (here.x, here.y, here.z - 3.0)
        self.pump(0.5)
        self.check("OFFBOARD with a stream: accepted", self.set_mode(OFFBOARD) == [0, 0])
        self.check("arm in OFFBOARD", self.arm() == [0])
        self.check("heartbeat: OFFBOARD", self.heartbeat(lambda m: m.custom_mode == 0x00060000) is not None)
        up = self.wait("LOCAL_POSITION_NED", 15, lambda m: abs(m.z - self.target[2]) < 0.4)
        self.check("took off to 3 m", up is not None)
        self.check("a bad AUTO sub-mode: second ack 1", self.set_mode((4, 77)) == [0, 1])
        self.check("disarm in the air: refused", self.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 0) == [1])
        self.target = (here.x + 4.0, here.y - 3.0, here.z - 3.0)
        there = self.wait(
            "LOCAL_POSITION_NED", 12, lambda m: math.dist((m.x, m.y, m.z), self.target) < 0.5
        )
        self.check("flew 5 m to a position setpoint", there is not None)
        self.check("landed state: on ground, then in air", self.landed_states == [ON_GROUND, IN_AIR], self.landed_states)
        self.target = None
        lost = self.heartbeat(lambda m: m.system_status == 5, seconds=4.0)
        self.check("stream stopped: failsafe", lost is not None and lost.custom_mode in (0x00030000, 0x03040000))
        self.target = (here.x + 4.0, here.y - 3.0, here.z - 3.0)
        back = self.heartbeat(lambda m: m.custom_mode == 0x00060000 and m.system_status == 4)
        self.check("stream back: OFFBOARD by itself", back is not None)

    def check_landing(self):
        self.check("NAV_LAND", self.command(MAV.MAV_CMD_NAV_LAND) == [0])
        self.target = None
        self.check("landed state: landing", self.wait("EXTENDED_SYS_STATE", 2, lambda m: m.landed_state == LANDING) is not None)
        landed = self.wait("EXTENDED_SYS_STATE", 40, lambda m: m.landed_state == ON_GROUND)
        self.check("landed", landed is not None)
        disarmed = self.heartbeat(lambda m: not m.base_mode & 0x80, seconds=6.0)
        self.check("disarmed by itself", disarmed is not None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--address", default="127.0.0.1", help="local address to listen on (default: %(default)s)")
    parser.add_argument("--port", type=int, default=14540, help="local UDP port to listen on (default: %(default)s)")
    arguments = parser.parse_args()
    client = Client(arguments.address, arguments.port)
    status = client.run()
    print("all checks hold" if status == 0 else f"{client.failures} check(s) failed")
    return status


if __name__ == "__main__":
    sys.exit(main())
