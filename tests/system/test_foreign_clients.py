# SPDX-License-Identifier: BSD-3-Clause
"""Other people's clients against `jink sim`: MAVSDK-Python 3's usual examples, a session of MAVProxy, and libmav, which reads
the stream with no code in common with ours or pymavlink's. They are in .venv/clients (tools/setup.sh test), for
MAVSDK-Python 3 has the name of the wheel that jink is built with.

    test_foreign_clients.py JINK INSTANCE mavsdk|mavproxy|libmav
"""

import os
import pathlib
import subprocess

import yaml

from flight import SOURCE, Arena, Failed, check, interrupt, main, say, wait, wait_until

HERE = pathlib.Path(__file__).resolve().parent
CLIENTS = SOURCE / ".venv" / "clients" / "bin"
SPEED = 2  # simulated seconds in a second: the clients' own clocks and time-outs bear it
SCENARIO = {"format": "jink-scenario/1", "name": "clients", "start": [0, 0, 1.5], "target": [9, 0, 1.5], "vehicle": "px4",
            "time_limit": 600, "obstacles": [{"radius": 0.4, "position": [0, 400, 1.5]}]}
WAYPOINTS = """QGC WPL 110
0 1 3 22 0 0 0 0 47.397743 8.545594 5 1
1 0 3 16 1 2 0 0 47.397843 8.545594 5 1
2 0 3 21 0 0 0 0 47.397843 8.545594 0 1
""".replace(" ", "\t").replace("QGC\tWPL\t110", "QGC WPL 110")


def simulator(arena, speed=SPEED):
    scenario = arena.folder / "scenario.yaml"
    scenario.write_text(yaml.safe_dump(SCENARIO))
    return arena.sim(scenario, "--no-tracks", "--speed", speed)


def run_client(arena, script, *arguments):
    """A script of .venv/clients; its lines that tell of a check become ours."""
    sim = simulator(arena)
    client = arena.start("client", [CLIENTS / "python", HERE / "clients" / script, *arguments])
    status = wait(client, 240)
    for line in (arena.folder / "client.txt").read_text().splitlines():
        if line.startswith("ok "):
            say(line)
    check(status == 0, f"{script}: every example holds")
    check(interrupt(sim) == 0, "sim ends with exit status 0")


def mavsdk(arena):
    run_client(arena, "mavsdk_examples.py", 14540 + arena.instance, 50100 + arena.instance)


def libmav(arena):
    dialect = pathlib.Path(arena.jink).resolve().parent / "mavlink" / "xml" / "px4_events.xml"
    run_client(arena, "libmav_parser.py", 14540 + arena.instance, arena.instance + 1, dialect)


class MavProxy:
    """Typed into, and read from a file. It takes 0.7 ms of a core for a message, so it keeps up with PX4's 400 in a second
    only where nothing else runs: what is said once is otherwise lost in its full socket."""

    def __init__(self, arena):
        self.output = arena.folder / "mavproxy.txt"
        self.read = 0
        with open(self.output, "w") as output:
            self.process = subprocess.Popen(
                [CLIENTS / "python", "-u", CLIENTS / "mavproxy.py", f"--master=udpin:127.0.0.1:{14540 + arena.instance}",
                 f"--target-system={arena.instance + 1}", f"--state-basedir={arena.folder}"],
                stdin=subprocess.PIPE, stdout=output, stderr=subprocess.STDOUT, text=True, cwd=arena.folder,
                env={**os.environ, "HOME": str(arena.folder)})
        arena.processes.append(self.process)

    def expect(self, *texts, seconds=60):
        """All of them in what came since the last command."""
        wait_until(lambda: all(text in self.output.read_text()[self.read:] for text in texts), seconds, f"MAVProxy's {texts}")

    def type(self, line, *expected, seconds=60):
        self.read = len(self.output.read_text())
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        self.expect(*expected, seconds=seconds)
        say(f"ok   MAVProxy: {line}")


def mavproxy(arena):
    waypoints = arena.folder / "waypoints.txt"
    waypoints.write_text(WAYPOINTS)
    client = MavProxy(arena)
    client.expect("Waiting for heartbeat")
    sim = simulator(arena, speed=1)
    client.expect("Detected vehicle", "Mode LOITER", " parameters", "Ready for takeoff!")
    client.type("param show MIS_TAKEOFF_ALT", "MIS_TAKEOFF_ALT  2.5")
    client.type(f"wp load {waypoints}", "Sent all 3 waypoints", "TYPE_MISSION: ACCEPTED")
    client.type("wp list", "Requesting 3 waypoints", "22 6 47.3977", "21 6 47.3978")
    client.type("arm throttle", "COMPONENT_ARM_DISARM: ACCEPTED", "ARMED")
    client.type("takeoff 494", "NAV_TAKEOFF: ACCEPTED", "Mode TAKEOFF", "Takeoff detected", "Mode LOITER")
    # Its own command `mode` fails with PX4's modes: it knows the three numbers and sends them as one.
    client.type("long DO_SET_MODE 1 4 4", "DO_SET_MODE: ACCEPTED", "Mode MISSION", "Executing Mission")
    client.type("wp set 1", "DO_SET_MISSION_CURRENT: UNSUPPORTED")  # then it takes MISSION_SET_CURRENT, as with PX4
    client.expect("Landing detected", "Mission finished, landed", "DISARMED")
    check(True, "MAVProxy: the mission lands it")
    check(interrupt(sim) == 0, "sim ends with exit status 0")


def test(jink, instance, client):
    if not CLIENTS.exists():
        raise Failed(f"no {CLIENTS.parent}: run tools/setup.sh test")
    with Arena(jink, int(instance)) as arena:
        {"mavsdk": mavsdk, "mavproxy": mavproxy, "libmav": libmav}[client](arena)


main(test)
