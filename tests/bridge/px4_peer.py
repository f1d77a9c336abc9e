#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The other end of the wire for the tests of bridge/mavsdk_link: what PX4 says and how it answers, by pymavlink.

Not a simulator: nothing flies. The vehicle stands still where the constants below put it, and does what it is told at
once. What it says and how it acknowledges follow recordings of PX4 1.17 (two acknowledgements for DO_SET_MODE, the
first always ACCEPTED; heartbeat strictly periodic). It sends to 127.0.0.1:PORT, and prints each message of interest as
one line of JSON on stdout, with `t`, the peer's monotonic clock. It ends when stdin closes, or on the line `quit`; the
line `freeze` stops everything that it sends, `thaw` starts it again.
"""
import argparse
import json
import math
import select
import sys
import time

from pymavlink.dialects.v20 import common as mavlink
from pymavlink import mavutil

POSITION_NED = (1.0, 2.0, -3.0)
VELOCITY_NED = (0.5, -0.25, 0.125)
HEADING = 0.3  # rad, clockwise from north
ARMED = mavlink.MAV_MODE_FLAG_SAFETY_ARMED
HEALTHY = 0x1320C83F  # PX4 SITL, ready to arm: SYS_STATUS.onboard_control_sensors_health
PRESENT, ENABLED = 0x300402F, 0x301402F
ESTIMATOR_OK = 0x37F
HOLD, OFFBOARD, LAND = 0x03040000, 0x00060000, 0x06040000
# Rates in Hz before anybody asks for another: those of PX4's companion link.
DEFAULT_RATES = {"HEARTBEAT": 1, "LOCAL_POSITION_NED": 30, "ATTITUDE": 99, "SYS_STATUS": 5, "EXTENDED_SYS_STATE": 5,
                 "ESTIMATOR_STATUS": 1}
RATE_NAMES = {32: "LOCAL_POSITION_NED", 30: "ATTITUDE"}


class Peer:
    def __init__(self, options):
        self.options = options
        self.link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{options.port}", source_system=options.system,
                                               source_component=1, dialect="common")
        self.rates = dict(DEFAULT_RATES, HEARTBEAT=options.heartbeat_hz)
        self.next = {name: 0.0 for name in self.rates}
        self.start = time.monotonic()
        self.mode, self.armed, self.landed, self.frozen = HOLD, False, 1, False
        self.running = True

    def say(self, **line):
        print(json.dumps({"t": time.monotonic(), **line}, allow_nan=False), flush=True)

    def boot_ms(self):
        return int((time.monotonic() - self.start) * 1000)

    def emit(self, name):
        m, ms = self.link.mav, self.boot_ms()
        if name == "HEARTBEAT":
            flags = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (ARMED if self.armed else 0)
            m.heartbeat_send(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, flags, self.mode,
                             mavlink.MAV_STATE_ACTIVE if self.armed else mavlink.MAV_STATE_STANDBY)
        elif name == "LOCAL_POSITION_NED":
            m.local_position_ned_send(ms, *POSITION_NED, *VELOCITY_NED)
        elif name == "ATTITUDE":
            m.attitude_send(ms, 0.01, -0.02, HEADING, 0, 0, 0)
        elif name == "SYS_STATUS":
            m.sys_status_send(PRESENT, ENABLED, self.options.health, 100, 12000, -1, -1, 0, 0, 0, 0, 0, 0)
        elif name == "EXTENDED_SYS_STATE":
            m.extended_sys_state_send(0, self.landed)
        elif name == "ESTIMATOR_STATUS":
            m.estimator_status_send(ms * 1000, self.options.estimator, *([0.1] * 8))

    def ack(self, message, result):
        self.link.mav.command_ack_send(message.command, result, 0, 0, message.get_srcSystem(),
                                       message.get_srcComponent())

    def command(self, message):
        c, p = message.command, [getattr(message, f"param{i}") for i in range(1, 8)]
        said = [None if math.isnan(x) else x for x in p]  # JSON has no NaN
        self.say(type="command", command=c, params=said, target=[message.target_system, message.target_component],
                 source=[message.get_srcSystem(), message.get_srcComponent()])
        if c in self.options.mute:
            return
        if c == mavlink.MAV_CMD_DO_SET_MODE:
            self.ack(message, mavlink.MAV_RESULT_ACCEPTED)
            refused = c in self.options.refuse
            if not refused:
                self.mode = (int(p[1]) << 16) | (int(p[2]) << 24)
            time.sleep(0.01)  # PX4: the second answer comes 0 to 12 ms later
            if not self.options.single_ack:
                self.ack(message, mavlink.MAV_RESULT_TEMPORARILY_REJECTED if refused else mavlink.MAV_RESULT_ACCEPTED)
            return
        if c in self.options.refuse:
            self.ack(message, mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
            return
        if c == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            self.armed = p[0] == 1.0
            self.landed = 2 if self.armed else 1
        elif c == mavlink.MAV_CMD_NAV_LAND:
            self.mode = LAND
            self.landed = 4
        elif c == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL and int(p[0]) in RATE_NAMES:
            self.rates[RATE_NAMES[int(p[0])]] = 1e6 / p[1]
        self.ack(message, mavlink.MAV_RESULT_ACCEPTED)

    def receive(self):
        while (message := self.link.recv_msg()) is not None:
            kind = message.get_type()
            if kind == "COMMAND_LONG":
                self.command(message)
            elif kind == "HEARTBEAT":
                self.say(type="heartbeat", vehicle_type=message.type,
                         source=[message.get_srcSystem(), message.get_srcComponent()])
            elif kind == "SET_POSITION_TARGET_LOCAL_NED":
                self.say(type="setpoint", mask=message.type_mask, frame=message.coordinate_frame,
                         target=[message.target_system, message.target_component], boot_ms=message.time_boot_ms,
                         position=[message.x, message.y, message.z], velocity=[message.vx, message.vy, message.vz],
                         acceleration=[message.afx, message.afy, message.afz], yaw=message.yaw,
                         yaw_rate=message.yaw_rate)

    def order(self, line):
        if line in ("", "quit\n"):
            self.running = False
        elif line == "freeze\n":
            self.frozen = True
        elif line == "thaw\n":
            self.frozen = False

    def run(self):
        self.say(type="ready")
        while self.running:
            now = time.monotonic()
            for name, rate in self.rates.items():
                if now >= self.next[name]:
                    self.next[name] = max(self.next[name] + 1.0 / rate, now - 0.05)
                    if not self.frozen:
                        self.emit(name)
            wait = max(0.0, min(self.next.values()) - time.monotonic())
            ready, _, _ = select.select([self.link.port, sys.stdin], [], [], wait)
            if self.link.port in ready:
                self.receive()
            if sys.stdin in ready:
                self.order(sys.stdin.readline())


def main():
    def number(text):
        return int(text, 0)

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--system", type=int, default=1)
    parser.add_argument("--heartbeat-hz", type=float, default=1.0)
    parser.add_argument("--health", type=number, default=HEALTHY, help="SYS_STATUS health bits")
    parser.add_argument("--estimator", type=number, default=ESTIMATOR_OK, help="ESTIMATOR_STATUS flags")
    parser.add_argument("--refuse", type=int, nargs="*", default=[], help="commands (MAV_CMD) to refuse")
    parser.add_argument("--mute", type=int, nargs="*", default=[], help="commands (MAV_CMD) not to answer")
    parser.add_argument("--single-ack", action="store_true", help="one answer to DO_SET_MODE, as other versions give")
    Peer(parser.parse_args()).run()


if __name__ == "__main__":
    main()
