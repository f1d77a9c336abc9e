# SPDX-License-Identifier: BSD-3-Clause
"""What `jink fly` does when things go wrong around it: one flight for each fault, real processes, several at a time.

    test_faults.py JINK FIRST_INSTANCE [CASE...]

Every case states how `fly` ends, what it says about it, and where the vehicle is in the end; in all of them nothing is
hit. The faults are the simulator's (the scenario's `faults`), or come from this script.
"""

import concurrent.futures
import dataclasses
import math
import pathlib
import queue
import random
import signal
import socket
import sys
import time
import traceback
from typing import Callable

import yaml

from flight import Arena, Failed, check, interrupt, kept_lines, main, say, wait, wait_until

SIDE_BY_SIDE = 5  # flights at a time
FIRST_DOMAIN = 50  # up to 101 none is on an ephemeral port, which anybody may hold

SCENARIO = {
    "format": "jink-scenario/1", "name": "fault", "start": [0, 0, 1.5], "target": [9, 0, 1.5], "vehicle": "ardrone2",
    "time_limit": 60,
    "obstacles": [
        {"radius": 0.4, "position": [4, -4, 1.5], "velocity": [0, 1.6, 0]},   # crosses the way ahead of the vehicle
        {"radius": 0.5, "position": [6, 1.4, 1.5]},                           # stands beside it
        {"radius": 0.4, "motion": {"type": "sine", "center": [3, 3, 2], "amplitude": [1, 0, 0], "frequency_hz": [0.3, 0, 0],
                                   "phase": [0, 0, 0]}}]}
# Nothing crosses or stands where a vehicle coasts to that jink does not steer meanwhile, or not by sight: up to 7.7 m,
# 3.3 s after it set out.
UNSTEERED = {"obstacles": [{**SCENARIO["obstacles"][0], "position": [9.2, -4, 1.5]},
                           {**SCENARIO["obstacles"][1], "position": [6, 2.4, 1.5]}, SCENARIO["obstacles"][2]]}
# Nothing is where a vehicle gets that does not know where it is, or is to stop straight on.
ASIDE = {"obstacles": [{"radius": 0.4, "position": [5, -6, 1.5]}]}


class Flight:
    """One case's processes and what they left."""

    def __init__(self, arena, mission):
        self.arena = arena
        self.mission = mission
        self.sim = self.fly = None

    def start(self, *options):
        self.fly = self.arena.fly(self.mission, *options)

    def flying(self):
        file = self.arena.folder / "fly.txt"
        return file.exists() and "phase: flying" in file.read_text()

    def wait_for_flight(self, after=1.0):
        wait_until(self.flying, 90, "flight")
        time.sleep(after)

    def events(self, name):
        return [r["detail"] for r in self.arena.log("fly.jsonl", "event") if r["name"] == name]

    def states(self):
        return self.arena.log("fly.jsonl", "state")

    def truth(self):
        return self.arena.log("sim.jsonl", "truth")


@dataclasses.dataclass
class Case:
    name: str
    faults: list = dataclasses.field(default_factory=list)
    status: int = 0                 # of fly
    reason: str = "target reached"  # is in the summary's reason
    events: tuple = ()              # names, each of which is in the log
    hazards: tuple = ()             # texts, each of which is in a hazard of the summary; () means that there is none
    end: str = ""                   # "hold": the vehicle hangs in the air, "ground": it stands on it
    scenario: dict = dataclasses.field(default_factory=dict)
    mission: dict = dataclasses.field(default_factory=dict)
    alone: bool = False             # it takes a processor, and its times are judged: flown where it is named, beside nothing
    linger: float = 0.0             # s, that the simulator goes on after fly has ended
    during: Callable = lambda flight: None
    after: Callable = lambda flight, summary: None


def at(t, kind, **keys):
    return {"at": t, "kind": kind, **keys}


# ---- what the script does during a flight

def random_bytes(flight):
    """On the companion's port, whatever comes to mind, a valid start byte now and then. A quarter of the autopilot's
    messages is lost in it, heartbeats too: it ends before their absence is a hazard, after 5 s."""
    flight.wait_for_flight(0.0)
    generator = random.Random(1)
    end = time.monotonic() + 3.0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        while time.monotonic() < end:
            data = bytearray(generator.randbytes(generator.randrange(1, 300)))
            if generator.random() < 0.5:
                data[0] = 0xFD
            sender.sendto(data, ("127.0.0.1", 14540 + flight.arena.instance))
            time.sleep(0.001)


def other_system(autopilot, system, at_once=False):
    """Another MAVLink system on the same port: positions elsewhere, a mode of its own."""
    def during(flight):
        from pymavlink import mavutil
        from pymavlink.dialects.v20 import common as mavlink
        if not at_once:
            flight.wait_for_flight(0.0)
        link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{14540 + flight.arena.instance}", source_system=system,
                                          source_component=1, dialect="common")
        for i in range(150):
            if i % 20 == 0:
                link.mav.heartbeat_send(mavlink.MAV_TYPE_QUADROTOR, autopilot, 1, 0x03040000, mavlink.MAV_STATE_STANDBY)
            link.mav.local_position_ned_send(i * 20, 100.0, 100.0, -100.0, 5.0, 0.0, 0.0)
            time.sleep(0.02)
        link.close()
    return during


def malformed_payloads(flight):
    flight.wait_for_flight(0.0)
    script = pathlib.Path(__file__).with_name("malformed_tracks.py")
    flight.arena.start("malformed", [sys.executable, script, "--domain", flight.arena.domain, "--duration", 4])


def stalled_process(seconds):
    def during(flight):
        flight.wait_for_flight()
        flight.fly.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        flight.fly.send_signal(signal.SIGCONT)
    return during


def killed_and_started_again(pause):
    def during(flight):
        flight.wait_for_flight()
        flight.fly.kill()
        flight.fly.wait()
        time.sleep(pause)
        (flight.arena.folder / "fly.txt").unlink()
        flight.start()
    return during


# ---- what is looked at afterwards

def dropped_tracks(flight, summary):
    check(summary["dropped_tracks"] > 0, f"{summary['dropped_tracks']} tracks were left out")


def keeps_up(flight, summary):
    """All tracks of all messages, 20 a second."""
    messages = [r for r in flight.arena.log("fly.jsonl", "tracks") if len(r["tracks"]) > 2000]
    rate = (len(messages) - 1) / (messages[-1]["t"] - messages[0]["t"])
    check(rate > 18.0, f"{rate:.1f} messages of over 2000 tracks in a second")


def stream_stays_stopped(flight, summary):
    last = flight.arena.log("fly.jsonl", "setpoint")[-1]["t"]
    modes = [s for s in flight.states() if s["t"] > last]
    check(all(s["mode"] != "offboard" for s in modes[1:]), "no setpoint after the pilot took over")


def no_lurch(flight, summary):
    """The true vehicle does not fly after a jump of its estimate."""
    records = flight.truth()
    fastest = max(math.hypot(*r["v"]) for r in records)
    hardest = max(math.dist(a["v"], b["v"]) / max(b["t"] - a["t"], 1e-3)
                  for a, b in zip(records, records[5:]) if a["t"] > 0.5 and b["t"] > a["t"])
    check(fastest < 4.5 and hardest < 9.0, f"fastest {fastest:.1f} m/s, hardest {hardest:.1f} m/s²")
    check(summary["estimate_resets"] == 1, "one reset counted")


def braked_soon(flight, summary):
    """Within 0.2 s of the limit the setpoints' speed falls, from wherever it has got to."""
    hazard = summary["hazards"][0]["t"]
    speeds = [math.hypot(*s["v"]) for s in flight.arena.log("fly.jsonl", "setpoint") if abs(s["t"] - hazard) < 0.2]
    check(max(speeds) > 0.5, f"{max(speeds):.1f} m/s when the tracks are stale")
    check(speeds[-1] < max(speeds) - 0.1, "it braked within 0.2 s")


# hazards=None: whether it brakes meanwhile is left to chance.
CASES = [
    Case("link_silent_0.3s", [at(1.5, "link_loss", **{"for": 0.3})], hazards=("position is stale",)),
    Case("link_silent_1s", [at(1.5, "link_loss", **{"for": 1.0})], hazards=("position is stale",)),
    Case("link_silent_5s", [at(1.5, "link_loss", **{"for": 5.0})], 1, "position is stale", ("hazard", "request"),
         ("position is stale",), scenario=UNSTEERED),
    Case("link_silent_for_good", [at(1.5, "link_loss")], 1, "position is stale", ("hazard",), ("position is stale",),
         end="ground", linger=12.0, scenario=UNSTEERED),
    Case("telemetry_lost", [at(1.5, "link_loss", direction="down")], 1, "position is stale", (), ("position is stale",),
         scenario=UNSTEERED),
    Case("setpoints_lost", [at(1.5, "link_loss", direction="up", **{"for": 4.0})], 1, "failsafe", (), ("failsafe",),
         scenario=UNSTEERED),
    Case("packet_loss", [at(0, "packet_loss", rate=0.2)]),
    Case("delay", [at(0, "delay", seconds=0.2)]),
    Case("reordering", [at(0, "reorder", rate=0.3)]),
    Case("tracks_stop_0.5s", [at(1.5, "tracks_stop", **{"for": 0.5})]),
    Case("tracks_stop_2s", [at(1.5, "tracks_stop", **{"for": 2.0})], hazards=("tracks are stale",), after=braked_soon,
         scenario=ASIDE),
    Case("tracks_stop_for_good", [at(1.0, "tracks_stop")], 1, "tracks are stale", (), ("tracks are stale",), end="hold"),
    Case("tracks_frozen", [at(1.0, "tracks_freeze")], 1, "tracks are stale", ("tracks_frozen",), ("tracks are stale",),
         end="hold"),
    Case("track_noise", [at(0, "track_noise", position=0.1, velocity=0.2)]),
    Case("id_swap", [at(1.0, "id_swap")]),
    Case("obstacle_at_short_range", scenario={"sensing": {"range": 3.5}}),
    Case("garbage_in_tracks", [at(0, "tracks_garbage")], events=("tracks_refused",), after=dropped_tracks),
    Case("ten_thousand_tracks", [at(1.0, "tracks_flood", count=10000)], alone=True),
    Case("two_thousand_tracks", [at(0, "tracks_flood", count=2000)], after=keeps_up),
    Case("malformed_payloads", during=malformed_payloads, events=("tracks_malformed",)),
    Case("own_track", [at(0, "tracks_self")], events=("tracks_self",)),
    Case("writers_clock_off_by_an_hour", [at(0, "tracks_clock", offset=3600)], events=("tracks_clock",)),
    Case("random_bytes", during=random_bytes),
    Case("wrong_sysid", during=other_system(8, 77)),
    Case("two_autopilots", during=other_system(12, 9)),
    Case("two_autopilots_before_arming", during=other_system(12, 9, at_once=True), status=1, reason="system_id",
         end="ground"),
    Case("refuses_to_arm", [at(0, "refuse_arming")], 1, "pre-arm check", ("waiting",), end="ground"),
    Case("refuses_offboard", [at(0, "refuse_offboard")], 1, "pre-arm check", ("waiting",), end="ground"),
    Case("no_position_on_dds", status=1, reason="local position", events=("waiting",), end="ground", mission={"state": "dds"}),
    Case("pilot_takes_over", [at(1.5, "pilot_mode", mode="position")], 1, "the mode was changed to position", end="hold",
         linger=2.0, after=stream_stays_stopped, scenario=UNSTEERED),
    # It drifts by metres before it stands, wherever the estimate says that it is.
    Case("gps_loss", [at(1.5, "gps_loss")], 1, "lost its GPS", hazards=("lost its GPS",), end="ground", linger=12.0,
         scenario=ASIDE),
    Case("estimate_jump", [at(1.5, "estimate_jump", by=[0, -3, 0])], events=("estimate_reset",), after=no_lurch,
         scenario=ASIDE),
    Case("battery_low", [at(1.0, "low_battery", remaining=0.12)], events=("battery",)),
    Case("battery_critical", [at(1.5, "low_battery", remaining=0.06)], 1, "battery is critical", ("battery",), end="ground",
         scenario=UNSTEERED),
    Case("autopilot_reboots", [at(1.5, "reboot")], 1, "began anew", linger=3.0, hazards=None, scenario=UNSTEERED),
    Case("process_stalls_0.4s", during=stalled_process(0.4), events=("stalled",), hazards=("did not run",)),
    # High up: meanwhile the autopilot's own failsafe sinks at 0.7 m/s.
    Case("process_stalls_4s", status=1, reason="did not run for 4", during=stalled_process(4.0), hazards=("did not run",),
         end="hold", scenario={"start": [0, 0, 4], "target": [9, 0, 4]},
         mission={"waypoints": [[9, 0, 4]], "takeoff_height": 4.0}),
    Case("killed_and_restarted_at_once", during=killed_and_started_again(0.0), hazards=None, scenario=UNSTEERED),
    Case("killed_and_restarted_2s_later", during=killed_and_started_again(2.0), hazards=None, scenario=UNSTEERED),
]


def judge(case, flight, status, simulated):
    summary = flight.arena.read("fly.json")
    truth = flight.arena.read("sim.json")
    check(truth["outcome"] not in ("collision", "left_world"), f"sim: {truth['outcome']}, clearance {truth['min_clearance']:.2f} m")
    check(simulated == 0, "sim ends with exit status 0")
    check(status == case.status, f"fly ends with exit status {status}: {summary['reason']}")
    check(case.reason in summary["reason"], f"the reason names '{case.reason}'")
    check((summary["outcome"] == "reached") == (case.status == 0), f"outcome {summary['outcome']}")
    for name in case.events:
        check(flight.events(name), f"the log has '{name}': {flight.events(name)[:1]}")
    if case.hazards is not None:
        said = [hazard["what"] for hazard in summary["hazards"]]
        for text in case.hazards:
            check(any(text in what for what in said), f"the summary has the hazard '{text}': {said}")
        check(bool(said) == bool(case.hazards), f"hazards: {said}")
    last = flight.truth()[-1]
    height, speed = last["p"][2], math.hypot(*last["v"])
    if case.end == "hold":
        check(height > 0.7 and speed < 1.5, f"it hangs in the air: {height:.1f} m, {speed:.1f} m/s")
    elif case.end == "ground":
        check(height < 0.1 and speed < 0.1, f"it stands on the ground: {height:.2f} m")
    case.after(flight, summary)


def fly_case(jink, case, instance, domain):
    with Arena(jink, instance) as arena:
        arena.domain = domain
        scenario = arena.folder / "scenario.yaml"
        scenario.write_text(yaml.safe_dump({**SCENARIO, "faults": case.faults, **case.scenario}))
        mission = {"waypoints": [[9, 0, 1.5]], "arrival": "hold", "vehicle": "ardrone2", **case.mission}
        flight = Flight(arena, arena.mission("sitl", **mission))
        flight.sim = arena.sim(scenario)
        flight.start("--threads", "1")
        case.during(flight)
        status = wait(flight.fly, 120)
        time.sleep(case.linger)
        judge(case, flight, status, interrupt(flight.sim))


def test(jink, first_instance, *names):
    unknown = set(names) - {case.name for case in CASES}
    check(not unknown, f"known cases {unknown or ''}")
    chosen = [(i, case) for i, case in enumerate(CASES) if case.name in names or not (names or case.alone)]
    instances = queue.Queue()
    for i in range(SIDE_BY_SIDE):
        instances.put(int(first_instance) + i)
    failed = []

    def run(index, case):
        instance = instances.get()
        with kept_lines() as kept:
            try:
                fly_case(jink, case, instance, FIRST_DOMAIN + index)
            except Failed as failure:
                failed.append(case.name)
                say(f"FAIL {failure}")
            except Exception:
                failed.append(case.name)
                say(f"FAIL {traceback.format_exc()}")
            finally:
                instances.put(instance)
            text = kept.getvalue()
        say(f"== {case.name}\n{text}")

    with concurrent.futures.ThreadPoolExecutor(SIDE_BY_SIDE) as pool:
        list(pool.map(lambda pair: run(*pair), chosen))
    check(not failed, f"all {len(chosen)} cases hold; failed: {', '.join(failed) or 'none'}")


main(test)
