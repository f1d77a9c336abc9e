# SPDX-License-Identifier: BSD-3-Clause
"""`jink doctor` beside `jink sim`: a healthy vehicle, nobody there, no tracks, parameters changed, a second autopilot.

    test_doctor.py JINK INSTANCE
"""

import json
import subprocess
import sys

from flight import CONFIG, SOURCE, Arena, check, interrupt, main, wait_until
from ground_station import set_parameter

STREAMS = ("HEARTBEAT", "LOCAL_POSITION_NED", "ATTITUDE", "ODOMETRY")


def doctor(arena, mission, *options):
    """Runs the doctor; its exit status, the checks by name, and what it printed."""
    summary = arena.folder / "doctor.json"
    summary.unlink(missing_ok=True)
    done = subprocess.run([str(arena.jink), "doctor", str(mission), "--json", str(summary), *options],
                          capture_output=True, text=True, timeout=120)
    print(done.stdout, done.stderr, flush=True)
    if not summary.exists():
        return done.returncode, {}, done.stdout + done.stderr
    told = json.loads(summary.read_text())
    check(told["format"] == "jink-doctor/1", "the JSON file says its format")
    order = ["ok", "warning", "fault", "missing"]
    worst = max((c["level"] for c in told["checks"]), key=order.index)
    check(told["worst"] == worst, f"worst is {worst}")
    check(done.returncode == {"ok": 0, "warning": 0, "fault": 1, "missing": 3}[worst], f"exit status for {worst}")
    for c in told["checks"]:
        line = next((line for line in done.stdout.splitlines() if line.split()[:1] == [c["level"]] and
                     c["finding"] in line and c["name"] in line), None)
        check(line is not None and c["remedy"] in line, f"one line for {c['name']}")
    return done.returncode, {c["name"]: c for c in told["checks"]}, done.stdout


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        mission = arena.mission("sitl")

        status, checks, text = doctor(arena, mission, "--seconds", "4")
        check(status == 3 and checks["autopilot"]["level"] == "missing", "nobody there: exit status 3")
        check(checks["rt/jink/obstacle_tracks"]["level"] == "missing", "and no writer of tracks")
        check("jink sim" in checks["autopilot"]["remedy"] and "\033" not in text, "the remedy is said, without colours")

        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml")
        wait_until(lambda: "Ctrl-C" in (arena.folder / "sim.txt").read_text(), 60, "the simulator")

        def ready():  # it boots for some seconds, and so it says
            _, checks, _ = doctor(arena, mission, "--seconds", "4")
            return checks.get("health", {}).get("level") == "ok"

        wait_until(ready, 120, "a vehicle that is ready to arm")
        status, checks, _ = doctor(arena, mission)
        check(status == 0, "a healthy vehicle: exit status 0")
        for name in ("autopilot", "version", "health", "estimator", "battery", "mode", "local position", "origin",
                     "geofence", "waypoints", "NAV_DLL_ACT", "COM_OF_LOSS_T", "rt/jink/obstacle_tracks"):
            check(checks[name]["level"] == "ok", f"{name}: {checks[name]['finding']}")
        for name in STREAMS:
            check(" Hz" in checks[name]["finding"], f"{name}: {checks[name]['finding']}")
        check("1.17.0 alpha" in checks["version"]["finding"], "PX4's version is read")
        check(f"system {arena.instance + 1}" in checks["autopilot"]["finding"], "the system id is said")
        check("ms" in checks["round trip"]["finding"], "the round trip is measured")
        check(checks["COM_OBL_RC_ACT"]["level"] == "warning" and "5 (hold)" in checks["COM_OBL_RC_ACT"]["remedy"],
              "PX4's default for a lost stream is warned of")
        check(checks["COM_RCL_EXCEPT"]["level"] == "warning", "and that for a lost remote control")

        set_parameter(arena.instance, "COM_OBL_RC_ACT", 5)
        set_parameter(arena.instance, "COM_OF_LOSS_T", 5.0)
        set_parameter(arena.instance, "COM_RCL_EXCEPT", 4)
        _, checks, _ = doctor(arena, mission)
        check(checks["COM_OBL_RC_ACT"]["level"] == "ok", "hold when setpoints stop is well")
        check(checks["COM_RCL_EXCEPT"]["level"] == "ok", "so is offboard without RC")
        check(checks["COM_OF_LOSS_T"]["level"] == "warning" and "5 s" in checks["COM_OF_LOSS_T"]["finding"],
              "five seconds until it acts are not")

        peer = SOURCE / "tests" / "bridge" / "mavsdk" / "px4_peer.py"
        with subprocess.Popen([sys.executable, str(peer), "--port", str(14540 + arena.instance), "--system", "99"],
                              stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as second:
            _, checks, _ = doctor(arena, mission, "--seconds", "4")
            second.stdin.close()
        check(checks["other autopilots"]["level"] == "fault", "a second autopilot is a fault where none is named")

        outside = arena.mission("sitl", geofence={"min": [10, -50, 0], "max": [50, 50, 20]})
        status, checks, _ = doctor(arena, outside, "--seconds", "4")
        check(status == 1 and checks["geofence"]["level"] == "fault",
              f"a vehicle outside of the geofence: exit status {status}, {checks['geofence']}")

        elsewhere = arena.mission("sitl", dds={"domain": arena.domain + 50})
        status, checks, _ = doctor(arena, elsewhere, "--seconds", "4")
        check(status == 3 and checks["rt/jink/obstacle_tracks"]["level"] == "missing", "no tracks there: exit status 3")
        optional = arena.mission("sitl", dds={"domain": arena.domain + 50}, tracks={"required": False})
        status, checks, _ = doctor(arena, optional, "--seconds", "4")
        check(status == 0 and checks["rt/jink/obstacle_tracks"]["level"] == "warning", "not required: a warning")

        bad = subprocess.run([str(jink), "doctor", str(mission), "--seconds", "0"], capture_output=True, text=True)
        check(bad.returncode == 2 and bad.stderr.count("\n") == 1, "a bad option: exit status 2 and one line")
        check(interrupt(sim) == 0, "sim ends with exit status 0")


main(test)
