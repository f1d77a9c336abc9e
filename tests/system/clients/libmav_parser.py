# SPDX-License-Identifier: BSD-3-Clause
"""libmav, an implementation of MAVLink of its own, reads the simulator's stream: run in .venv/clients by
test_foreign_clients.py. It takes its messages from the XML, and drops what does not fit: sizes, order and checksums.

    libmav_parser.py PORT SYSTEM XML
"""

import sys
import time

import libmav

# What the simulator streams by itself (PX4's names), and a field whose value says that it was read at the right place.
EXPECTED = {
    "HEARTBEAT": lambda m: m["autopilot"] == 12 and m["type"] == 2,
    "ATTITUDE": lambda m: abs(m["roll"]) < 0.1 and abs(m["pitch"]) < 0.1,
    "ATTITUDE_QUATERNION": lambda m: abs(sum(m[f"q{i}"] ** 2 for i in (1, 2, 3, 4)) - 1.0) < 1e-3,
    "GLOBAL_POSITION_INT": lambda m: abs(m["lat"] - 473977430) < 1000 and abs(m["lon"] - 85455940) < 1000,
    "LOCAL_POSITION_NED": lambda m: abs(m["x"]) < 3.0 and abs(m["vx"]) < 2.0,
    "ODOMETRY": lambda m: m["frame_id"] == 1 and m["child_frame_id"] == 1 and len(m["pose_covariance"]) == 21,
    "HIGHRES_IMU": lambda m: 9.0 < abs(m["zacc"]) < 11.0,
    "GPS_RAW_INT": lambda m: m["fix_type"] >= 3,
    "SYS_STATUS": lambda m: m["voltage_battery"] == 16200,
    "EXTENDED_SYS_STATE": lambda m: m["landed_state"] == 1,
    "ESTIMATOR_STATUS": lambda m: m["flags"] == 895,
    "BATTERY_STATUS": lambda m: m["battery_remaining"] == 100,
    "HOME_POSITION": lambda m: abs(m["latitude"] - 473977430) < 1000,
    "MISSION_CURRENT": lambda m: m["total"] == 65535,
    "CURRENT_MODE": lambda m: m["custom_mode"] == 0x03040000,
    "SYSTEM_TIME": lambda m: m["time_unix_usec"] > 1.7e15,
    "VFR_HUD": lambda m: abs(m["groundspeed"]) < 3.0,
}
SECONDS = 12.0


def main():
    port, system, xml = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    messages = libmav.MessageSet(xml)
    heartbeat = messages.create("HEARTBEAT")
    heartbeat.set_from_dict({"type": 18, "autopilot": 8, "base_mode": 0, "custom_mode": 0, "system_status": 4,
                             "mavlink_version": 3})
    physical = libmav.UDPServer(port)
    runtime = libmav.NetworkRuntime(libmav.Identifier(system, 191), messages, heartbeat, physical)
    connection = runtime.await_connection(20000)
    missing, wrong = dict(EXPECTED), {}
    end = time.monotonic() + SECONDS
    for name, fits in EXPECTED.items():
        while time.monotonic() < end:
            message = connection.receive(name, 5000)
            if message.header.system_id == system:
                missing.pop(name)
                if not fits(message.to_dict()):
                    wrong[name] = message.to_dict()
                break
    assert not missing, f"not read: {sorted(missing)}"
    assert not wrong, f"read wrongly: {wrong}"
    print(f"ok   libmav: {len(EXPECTED)} kinds of message are read, their values where they belong", flush=True)
    request = messages.create("COMMAND_LONG")
    request.set_from_dict({"target_system": system, "target_component": 1, "command": 512, "confirmation": 0, "param1": 148.0,
                           "param2": 0.0, "param3": 0.0, "param4": 0.0, "param5": 0.0, "param6": 0.0, "param7": 0.0})
    answer = connection.expect("AUTOPILOT_VERSION")
    connection.send(request)
    version = connection.receive(answer, 5000)
    assert version.to_dict()["capabilities"] & 0x2004 == 0x2004, version.to_dict()
    print("ok   libmav: a command of its own is understood", flush=True)


main()
