# SPDX-License-Identifier: BSD-3-Clause
"""A fence that a ground station (pymavlink) has stored in the autopilot is kept; one that cannot be is refused.

    test_fence.py JINK INSTANCE
"""

import math
import pathlib
import time

from flight import CONFIG, Arena, check, interrupt, main, wait
from pymavlink import mavutil

ZONE = (10.0, 0.0, 2.0)  # east, north, radius


def corner(origin, command, param1, east, north, seq):
    latitude, longitude = origin
    metres = 111_320.0  # a degree, within half a percent
    return dict(command=command, param1=param1, seq=seq, x=round(1e7 * (latitude + north / metres)),
                y=round(1e7 * (longitude + east / metres / math.cos(math.radians(latitude)))))


def upload(port, areas):
    """Stores a fence of (command, param1, [(east, north), ...]) as a ground station does."""
    link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=255)
    try:
        autopilot = link.wait_heartbeat(timeout=20).get_srcSystem()
        place = link.recv_match(type="GLOBAL_POSITION_INT", blocking=True, timeout=20)
        origin = place.lat / 1e7, place.lon / 1e7
        items = []
        for command, param1, corners in areas:
            items += [corner(origin, command, param1, east, north, len(items) + i) for i, (east, north) in enumerate(corners)]
        link.mav.mission_count_send(autopilot, 1, len(items), mavutil.mavlink.MAV_MISSION_TYPE_FENCE)
        until = time.monotonic() + 20
        while time.monotonic() < until:
            message = link.recv_match(type=["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"], blocking=True, timeout=5)
            if message is None:
                continue
            if message.get_type() == "MISSION_ACK":
                return message.type == mavutil.mavlink.MAV_MISSION_ACCEPTED
            item = items[message.seq]
            link.mav.mission_item_int_send(autopilot, 1, item["seq"], mavutil.mavlink.MAV_FRAME_GLOBAL_INT, item["command"], 0, 1,
                                           item["param1"], 0, 0, 0, item["x"], item["y"], 0,
                                           mavutil.mavlink.MAV_MISSION_TYPE_FENCE)
    finally:
        link.close()
    return False


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        port = 14540 + arena.instance
        scenario = arena.folder / "empty.yaml"
        scenario.write_text("format: jink-scenario/1\nname: fence\nstart: [0, 0, 1.5]\ntarget: [20, 0, 1.5]\n"
                            "vehicle: ardrone2\nobstacles: []\nestimate: none\n")
        sim = arena.sim(scenario)
        mission = arena.mission("sitl", fence="autopilot", waypoints=[[20, 0, 1.5]])

        field = (5001, 4, [(-5, -6), (12, -6), (12, 6), (-5, 6)])  # ends before the target
        check(upload(port, [field]), "the autopilot takes a fence")
        fly = arena.fly(mission)
        check(wait(fly, 60) == 1, "fly ends with exit status 1 where a waypoint is outside it")
        refused = arena.read("fly.json")
        check(refused["outcome"] == "aborted" and refused["reason"] == "waypoint 1 is outside the autopilot's fence",
              f"and says why: {refused['reason']}")

        field = (5001, 4, [(-5, -6), (25, -6), (25, 6), (-5, 6)])
        check(upload(port, [field, (5004, ZONE[2], [ZONE[:2]])]), "the autopilot takes another")
        doctor = arena.start("doctor", [jink, "doctor", mission, "--seconds", 3])
        wait(doctor, 60)
        check("5 items, 5 solids" in (arena.folder / "doctor.txt").read_text(), "doctor reads it")
        fly = arena.fly(mission)
        check(wait(fly, 150) == 0, "fly ends with exit status 0")
        check(arena.read("fly.json")["outcome"] == "reached", "at the target")
        check(interrupt(sim) == 0, "sim ends with exit status 0")
        places = [record["p"] for record in arena.log("sim.jsonl", "truth")]
        nearest = min(math.dist(p[:2], ZONE[:2]) for p in places)
        check(ZONE[2] < nearest < 5.0, f"it went around the zone, {nearest:.2f} m from its middle")
        check(max(abs(p[1]) for p in places) < 6.0, "and stayed in its field")
        header = arena.log("fly.jsonl", "header")[0]
        check(len(header["map"]) == 5, "the log has the fence's solids")
        replay = arena.start("replay", [jink, "replay", pathlib.Path(arena.folder) / "fly.jsonl"])
        check(wait(replay, 120) == 0, "and its plans come out the same again")


main(test)
