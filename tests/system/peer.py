# SPDX-License-Identifier: BSD-3-Clause
"""What talks MAVLink with `jink sim` in these tests and shares no code with it: a companion or a ground station."""

import os
import struct
import time

os.environ["MAVLINK20"] = "1"  # read when pymavlink is imported
from pymavlink import mavutil  # noqa: E402

from flight import Failed, check  # noqa: E402

MAV = mavutil.mavlink
HOLD, LAND, OFFBOARD = 0x03040000, 0x06040000, 0x00060000
ARMED = 0x80
READY = 0x10000000  # of SYS_STATUS
POSITION_ONLY = 0x0DF8
EVENT = "UNKNOWN_410"  # in no dialect of pymavlink's wheel


def is_setpoint_due(message):
    """A companion that answers telemetry sends a setpoint for each of these."""
    return message.get_type() == "ATTITUDE"


class Peer:
    """Listens on a UDP port of this machine; keeps what it has heard of one system's autopilot."""

    def __init__(self, name, port, system, kind, component):
        self.name = name
        self.system = system
        self.kind = kind
        self.link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=255 if kind == MAV.MAV_TYPE_GCS else system,
                                               source_component=component, dialect="common")
        self.target = None  # NED; while it is set, setpoints answer ATTITUDE
        self.setpoint_sent = self.last_heartbeat = self.last_heard = 0.0  # monotonic
        self.texts, self.chunks, self.events = [], {}, []
        self.companion_texts = []  # severity and text, of other components of the system
        self.system_times = []  # simulated time and the autopilot's, s
        self.position = None  # NED
        self.boot_time = 0.0  # s, the autopilot's
        self.heartbeat = self.landed_state = None
        self.ready = False

    @classmethod
    def ground_station(cls, system):
        return cls("the ground station", 14550, system, MAV.MAV_TYPE_GCS, 190)

    @classmethod
    def companion(cls, instance):
        return cls("the companion", 14540 + instance, instance + 1, MAV.MAV_TYPE_ONBOARD_CONTROLLER, 191)

    def note(self, message):
        kind = message.get_type()
        self.last_heard = time.monotonic()
        if kind == "HEARTBEAT":
            self.heartbeat = message
        elif kind == "LOCAL_POSITION_NED":
            self.position = (message.x, message.y, message.z)
        elif kind == "EXTENDED_SYS_STATE":
            self.landed_state = message.landed_state
        elif kind == "SYS_STATUS":
            self.ready = bool(message.onboard_control_sensors_health & READY)
        elif kind == "ATTITUDE":
            self.boot_time = message.time_boot_ms * 1e-3
        elif kind == "SYSTEM_TIME":
            self.system_times.append((message.time_unix_usec * 1e-6, message.time_boot_ms * 1e-3))
        elif kind == EVENT:
            payload = bytes(message.get_msgbuf()[10:-2])
            self.events.append(struct.unpack_from("<I", payload)[0])
        elif kind == "STATUSTEXT":
            text = self.chunks.pop(message.id, "") + message.text
            if text.endswith("\t"):
                self.texts.append(text.rstrip("\t"))
            else:
                self.chunks[message.id] = text

    def note_companion(self, message):
        if message is None or message.get_type() != "STATUSTEXT" or message.get_srcSystem() != self.system:
            return
        key = (message.get_srcComponent(), message.id)
        text = self.chunks.pop(key, "") + message.text
        if message.id == 0 or len(message.text) < 50:
            self.companion_texts.append((message.severity, text, message.get_srcComponent(), time.monotonic()))
        else:
            self.chunks[key] = text

    def send_setpoint(self):
        self.link.mav.set_position_target_local_ned_send(0, self.system, 1, MAV.MAV_FRAME_LOCAL_NED, POSITION_ONLY,
                                                         *self.target, 0, 0, 0, 0, 0, 0, 0, 0)
        self.setpoint_sent = time.monotonic()

    def from_autopilot(self, message):
        # pymavlink tells no sender of a message that it does not know; who else sends here is another system's simulator.
        if message.get_type() == EVENT:
            return message.get_msgbuf()[5] == self.system
        return message.get_srcSystem() == self.system and message.get_srcComponent() == 1

    def pump(self, seconds, until=lambda message: False):
        """Listens, with a heartbeat a second, for `seconds` or until `until(message)`; that message, else None."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if time.monotonic() - self.last_heartbeat > 1.0:
                self.last_heartbeat = time.monotonic()
                self.link.mav.heartbeat_send(self.kind, MAV.MAV_AUTOPILOT_INVALID, 0, 0, MAV.MAV_STATE_ACTIVE)
            if self.target is not None and time.monotonic() - self.setpoint_sent > 0.2:
                self.send_setpoint()  # an answer or what it answers may have been lost
            message = self.link.recv_match(blocking=True, timeout=0.05)
            if message is None or not self.from_autopilot(message):
                self.note_companion(message)
                continue
            self.note(message)
            if self.target is not None and is_setpoint_due(message):
                self.send_setpoint()
            if until(message):
                return message
        return None

    def expect(self, condition, seconds, text):
        if not condition() and self.pump(seconds, lambda _: condition()) is None:
            raise Failed(f"{self.name} waited {seconds} s in vain for {text}; texts: {self.texts}")
        check(True, f"{self.name} saw: {text}")

    def command(self, number, *parameters, acks=1):
        """The results of the acknowledgements to a command."""
        fields = list(parameters) + [0.0] * (7 - len(parameters))
        self.link.mav.command_long_send(self.system, 1, number, 0, *fields)
        results = []
        while len(results) < acks:
            ack = self.pump(5.0, lambda m: m.get_type() == "COMMAND_ACK" and m.command == number)
            if ack is None:
                break
            results.append(ack.result)
        return results

    def set_mode(self, main_mode, sub_mode=0):
        return self.command(MAV.MAV_CMD_DO_SET_MODE, 1, main_mode, sub_mode, acks=2)

    def arm(self):
        return self.command(MAV.MAV_CMD_COMPONENT_ARM_DISARM, 1)

    def set_parameter(self, name, value):
        """A whole number, by its bytes as PX4 has it. Asked again where no answer comes, as the parameter protocol wants:
        either may be lost."""
        as_float = struct.unpack("<f", struct.pack("<i", value))[0]

        def is_told():
            self.link.mav.param_set_send(self.system, 1, name.encode(), as_float, MAV.MAV_PARAM_TYPE_INT32)
            return self.pump(1.0, lambda m: m.get_type() == "PARAM_VALUE" and m.param_id == name) is not None

        check(any(is_told() for _ in range(10)), f"{name} is set to {value}")

    def mode(self):
        return self.heartbeat.custom_mode if self.heartbeat else None

    def armed(self):
        return bool(self.heartbeat and self.heartbeat.base_mode & ARMED)

    def clock_rate(self):
        """Seconds of the autopilot's clock in a simulated one."""
        (unix, boot), (later_unix, later_boot) = self.system_times[0], self.system_times[-1]
        return (later_boot - boot) / (later_unix - unix)

    def take_off(self, target):
        """Streams `target` (NED), arms in OFFBOARD and waits until it is flown to within half a metre."""
        self.expect(lambda: self.heartbeat is not None and self.ready, 60, "a vehicle that can be armed")
        self.target = target
        self.pump(0.5)
        check(self.set_mode(6) == [0, 0], "OFFBOARD is accepted, twice acknowledged")
        # In lockstep time runs freely until it is armed, and the stream may seem to lapse.
        end = time.monotonic() + 30
        while self.arm() != [0]:
            check(time.monotonic() < end, "arming is refused, once more")
        check(True, "arming is accepted")
        self.expect(lambda: self.armed() and self.mode() == OFFBOARD, 10, "armed, in OFFBOARD")
        self.expect(lambda: self.position and abs(self.position[2] - target[2]) < 0.5, 60, "the vehicle at its height")
