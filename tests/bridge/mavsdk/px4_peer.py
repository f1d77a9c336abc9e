#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The other end of the wire for the tests of bridge/mavsdk/link: what PX4 says and how it answers, by pymavlink.

Not a simulator: nothing flies. The vehicle stands still where the constants below put it, and does what it is told at
once. What it says and how it acknowledges follow recordings of PX4 1.17 (two acknowledgements for DO_SET_MODE, the
first always ACCEPTED; heartbeat strictly periodic). It sends to 127.0.0.1:PORT, and prints each message of interest as
one line of JSON on stdout, with `t`, the peer's monotonic clock. It ends when stdin closes, or on the line `quit`.
Other lines are orders, one of the methods order_NAME each: `freeze` stops everything that it sends, `thaw` starts it
again, `jump 3 0 0` moves its estimate, and so on.
"""
import argparse
import json
import math
import os
import random
import select
import struct
import sys
import time

os.environ["MAVLINK20"] = "1"  # read by the import

from pymavlink.dialects.v20 import development as mavlink  # common, and CURRENT_MODE
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
                 "ESTIMATOR_STATUS": 1, "ODOMETRY": 30, "BATTERY_STATUS": 2, "CURRENT_MODE": 0.5}
RATE_NAMES = {32: "LOCAL_POSITION_NED", 30: "ATTITUDE", 331: "ODOMETRY", 436: "CURRENT_MODE"}
ORIGIN = (473977418, 85455939, 488000)  # 1e-7 deg, 1e-7 deg, mm above mean sea level
VERSION = 0x010F04FF  # 1.15.4, a release
PARAMETERS = {"COM_OBL_RC_ACT": 5, "COM_OF_LOSS_T": 0.5, "COM_NEGATIVE": -1, "COM_RCL_EXCEPT": 4}


class Wire:
    """What stands between the autopilot and the network: loss, seeded, and delay."""

    def __init__(self, link, loss, delay):
        self.link, self.loss, self.delay = link, loss, delay
        self.random, self.queue = random.Random(1), []

    def lost(self):
        return self.random.random() < self.loss

    def write(self, data):
        if self.lost():
            return
        if self.delay > 0:
            self.queue.append((time.monotonic() + self.delay, bytes(data)))
        else:
            self.link.write(data)

    def flush(self):
        while self.queue and self.queue[0][0] <= time.monotonic():
            self.link.write(self.queue.pop(0)[1])


class Peer:
    def __init__(self, options):
        self.options = options
        self.link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{options.port}", source_system=options.system,
                                               source_component=1, dialect="development")
        if options.keyed:
            self.link.setup_signing(b"the key that jink has not got....", allow_unsigned_callback=lambda *_: False)
        self.wire = Wire(self.link, options.loss, options.delay)
        self.link.mav.file = self.wire
        self.others, self.receivers = {}, {}
        self.rates = dict(DEFAULT_RATES, HEARTBEAT=options.heartbeat_hz)
        if options.no_odometry:
            del self.rates["ODOMETRY"]
        self.next = {name: 0.0 for name in self.rates}
        self.start = time.monotonic()
        self.mode, self.armed, self.landed, self.frozen = HOLD, False, 1, False
        self.running, self.unread = True, b""
        self.shift, self.resets = [0.0, 0.0, 0.0], 254  # so that the counter wraps soon
        self.velocity = (0.0, 0.0, 0.0) if options.still else VELOCITY_NED
        self.status, self.charge, self.remaining = None, 1, 100
        self.intended = None  # the mode that flies
        self.requests = {}  # of messages and parameters, by id or name: how often

    def say(self, **line):
        print(json.dumps({"t": time.monotonic(), **line}, allow_nan=False), flush=True)

    def boot_ms(self):
        return int((time.monotonic() - self.start) * 1000)

    def emit(self, name):
        m, ms = self.link.mav, self.boot_ms()
        if name == "HEARTBEAT":
            flags = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | (ARMED if self.armed else 0)
            m.heartbeat_send(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, flags, self.mode,
                             self.status if self.status is not None else
                             mavlink.MAV_STATE_ACTIVE if self.armed else mavlink.MAV_STATE_STANDBY)
            for link in self.others.values():  # another autopilot, which says other things
                link.mav.heartbeat_send(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4,
                                        mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | ARMED, LAND, 5)
                link.mav.local_position_ned_send(ms, 100, 100, -100, 0, 0, 0)
        elif name == "LOCAL_POSITION_NED":
            m.local_position_ned_send(ms, *self.position(), *self.velocity)
        elif name == "ODOMETRY":
            m.odometry_send(ms * 1000, mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_LOCAL_NED, *self.position(),
                            [1, 0, 0, 0], *self.velocity, 0, 0, 0, [math.nan] * 21, [math.nan] * 21, self.resets % 256, 2,
                            100)
        elif name == "BATTERY_STATUS":
            m.battery_status_send(0, 0, 0, 300, [4000] * 4 + [65535] * 6, 100, 100, 10, self.remaining, 0, self.charge)
        elif name == "ATTITUDE":
            m.attitude_send(ms, 0.01, -0.02, HEADING, 0, 0, 0)
        elif name == "CURRENT_MODE":
            m.current_mode_send(0, self.mode, self.intended if self.intended is not None else self.mode)
        elif name == "SYS_STATUS":
            m.sys_status_send(PRESENT, ENABLED, self.options.health, 100, 12000, -1, self.remaining, 0, 0, 0, 0, 0, 0)
        elif name == "EXTENDED_SYS_STATE":
            m.extended_sys_state_send(0, self.landed)
        elif name == "ESTIMATOR_STATUS":
            m.estimator_status_send(ms * 1000, self.options.estimator, *([0.1] * 8))

    def position(self):
        return [a + b for a, b in zip(POSITION_NED, self.shift)]

    def asked(self, key):
        """Whether to answer: not the first --deaf times that this is asked."""
        self.requests[key] = self.requests.get(key, 0) + 1
        return self.requests[key] > self.options.deaf

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
            if RATE_NAMES[int(p[0])] in self.rates:
                self.rates[RATE_NAMES[int(p[0])]] = 1e6 / p[1]
        elif c == mavlink.MAV_CMD_REQUEST_MESSAGE:
            if p[0] == 49 and self.asked(49):
                self.link.mav.gps_global_origin_send(*ORIGIN)
            elif p[0] == 148 and self.asked(148):
                self.link.mav.autopilot_version_send(0, VERSION, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 0)
        self.ack(message, mavlink.MAV_RESULT_ACCEPTED)

    def receive(self):
        while (message := self.link.recv_msg()) is not None:
            if self.wire.lost():
                continue
            kind = message.get_type()
            if kind == "COMMAND_LONG":
                self.command(message)
            elif kind == "HEARTBEAT":
                self.say(type="heartbeat", vehicle_type=message.type,
                         source=[message.get_srcSystem(), message.get_srcComponent()])
            elif kind == "PING" and message.target_system == 0:
                self.link.mav.ping_send(message.time_usec, message.seq, message.get_srcSystem(),
                                        message.get_srcComponent())
            elif kind == "PARAM_REQUEST_READ":
                self.parameter(message.param_id)
            elif kind == "SET_POSITION_TARGET_LOCAL_NED":
                self.say(type="setpoint", mask=message.type_mask, frame=message.coordinate_frame,
                         target=[message.target_system, message.target_component], boot_ms=message.time_boot_ms,
                         position=[message.x, message.y, message.z], velocity=[message.vx, message.vy, message.vz],
                         acceleration=[message.afx, message.afy, message.afz], yaw=message.yaw,
                         yaw_rate=message.yaw_rate)

    def parameter(self, name):
        if name not in PARAMETERS or not self.asked(name):  # PX4 does not answer for a name that it does not know
            return
        value = PARAMETERS[name]
        integer = isinstance(value, int)
        field = struct.unpack("<f", struct.pack("<i", value))[0] if integer else value
        self.link.mav.param_value_send(name.encode(), field, mavlink.MAV_PARAM_TYPE_INT32 if integer else
                                       mavlink.MAV_PARAM_TYPE_REAL32, len(PARAMETERS), 0)

    def orders(self):
        # Not readline(): what it has buffered beyond one line is nothing that select() sees.
        data = os.read(sys.stdin.fileno(), 65536)
        *lines, self.unread = (self.unread + data).split(b"\n")
        if not data:
            self.running = False
        for line in lines:
            name, *words = line.decode().split()
            getattr(self, "order_" + name)(*words)

    def order_quit(self):
        self.running = False

    def order_freeze(self):
        self.frozen = True

    def order_thaw(self):
        self.frozen = False

    def order_stop(self, stream):
        """No more of one message."""
        del self.rates[stream]

    def order_jump(self, north, east, down, resets="1"):
        """The estimate moves and the vehicle does not; its counter goes on by `resets`."""
        self.shift = [a + float(b) for a, b in zip(self.shift, (north, east, down))]
        self.resets += int(resets)

    def order_reboot(self):
        self.start, self.shift, self.resets = time.monotonic(), [0.0, 0.0, 0.0], 0

    def order_status(self, status):
        self.status = int(status)

    def order_failsafe(self, mode):
        """Its own, into that mode; what was asked for stays."""
        self.intended, self.mode = self.mode, int(mode)

    def order_battery(self, charge_state, remaining):
        self.charge, self.remaining = int(charge_state), int(remaining)

    def sender(self, system, component):
        return mavutil.mavlink_connection(f"udpout:127.0.0.1:{self.options.port}", source_system=int(system),
                                          source_component=int(component), dialect="development")

    def order_other(self, system):
        """From now on there is a second autopilot on the link."""
        self.others[system] = self.sender(system, 1)

    def order_noise(self):
        """Random bytes, and the head of a message without its end."""
        generator = random.Random(7)
        for size in [1, 3, 17, 280, 1400] * 40:
            self.link.write(generator.randbytes(size))
        self.link.write(b"\xfd\xff\x00\x00")

    def order_text(self, severity, number, chunk, *words):
        self.link.mav.statustext_send(int(severity), " ".join(words).encode(), int(number), int(chunk))

    def order_adsb(self, system, component, icao, flags):
        """An aircraft 1000 m north of the origin and 100 m above it, flying east at 20 m/s and climbing at 2 m/s."""
        if (system, component) not in self.receivers:
            self.receivers[system, component] = self.sender(system, component)
        self.receivers[system, component].mav.adsb_vehicle_send(int(icao), ORIGIN[0] + 89932, ORIGIN[1], 0, ORIGIN[2] + 100000, 9000, 2000, 200,
                                        b"JINK1", 1, 1, int(flags), 0)

    def run(self):
        self.say(type="ready")
        while self.running:
            now = time.monotonic()
            self.wire.flush()
            for name, rate in list(self.rates.items()):
                if now >= self.next[name]:
                    self.next[name] = max(self.next[name] + 1.0 / rate, now - 0.05)
                    if not self.frozen:
                        self.emit(name)
            dues = [self.next[name] for name in self.rates] + [due for due, _ in self.wire.queue[:1]]
            wait = max(0.0, min(dues) - time.monotonic())
            ready, _, _ = select.select([self.link.port, sys.stdin], [], [], wait)
            if self.link.port in ready:
                self.receive()
            if sys.stdin in ready:
                self.orders()


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
    parser.add_argument("--no-odometry", action="store_true")
    parser.add_argument("--still", action="store_true", help="tells of no velocity, as its position does not change")
    parser.add_argument("--keyed", action="store_true", help="MAVLink signing, as PX4 1.18 with a key: signs, and takes "
                                                             "signed messages alone")
    parser.add_argument("--loss", type=float, default=0.0, help="share of the messages that are lost, each way")
    parser.add_argument("--delay", type=float, default=0.0, help="s, of all that it sends")
    parser.add_argument("--deaf", type=int, default=0, help="how often a message or parameter is asked for in vain")
    Peer(parser.parse_args()).run()


if __name__ == "__main__":
    main()
