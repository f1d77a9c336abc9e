# SPDX-License-Identifier: BSD-3-Clause
"""Vehicles of a team meet: one `jink sim` with all of them, and a `jink fly` for each, which tell each other their paths.

    test_team.py JINK INSTANCE swap|cross
"""

import yaml

from flight import CONFIG, Arena, check, interrupt, main, wait

HEIGHT = 3.0


SWAP = [([0.0, 0.0, HEIGHT], [20.0, 0.0, HEIGHT]), ([20.0, 0.0, HEIGHT], [0.0, 0.0, HEIGHT])]


def scenario(arena, kind, ways):
    text = {"format": "jink-scenario/1", "name": kind, "start": ways[0][0], "target": ways[0][1], "time_limit": 120,
            "vehicle": "ardrone2", "obstacles": [],
            "vehicles": [{"start": start, "target": target} for start, target in ways[1:]]}
    file = arena.folder / "scenario.yaml"
    file.write_text(yaml.safe_dump(text))
    return file


def mission(arena, k, base, **changes):
    """A shipped mission on this arena's ports and domain."""
    text = yaml.safe_load((CONFIG / "missions" / f"{base}.yaml").read_text())
    text.update(connection=f"udpin://127.0.0.1:{14540 + arena.instance + k}", dds={"domain": arena.domain}, **changes)
    file = arena.folder / f"mission{k}.yaml"
    file.write_text(yaml.safe_dump(text))
    return file


def test(jink, instance, kind):
    with Arena(jink, int(instance)) as arena:
        if kind == "swap":
            sim = arena.sim(scenario(arena, kind, SWAP))
            missions = [mission(arena, k, "sitl", takeoff_height=HEIGHT, waypoints=[target], intents=True)
                        for k, (_, target) in enumerate(SWAP)]
        else:  # as shipped
            sim = arena.sim(CONFIG / "scenarios" / "team.yaml")
            missions = [mission(arena, k, f"team-{k}") for k in range(4)]
        flights = [arena.start(f"fly{k}", [jink, "fly", file, "--threads", 1, "--json", arena.folder / f"fly{k}.json",
                                           "--log", arena.folder / f"fly{k}.jsonl"])
                   for k, file in enumerate(missions)]
        for k, fly in enumerate(flights):
            check(wait(fly, 200) == 0, f"vehicle {k}: fly ends with exit status 0")
        check(interrupt(sim) == 0, "sim, interrupted, ends with exit status 0: nothing was hit")

        for k in range(len(flights)):
            flown = arena.read(f"fly{k}.json")
            check(flown["outcome"] == "reached", f"vehicle {k}: {flown['outcome']} after {flown['flight_time_s']:.1f} s")
            events = [(record["name"], record["detail"]) for record in arena.log(f"fly{k}.jsonl", "event")]
            heard = sum(name == "team_vehicle" for name, _ in events)
            check(heard >= len(flights) - 1, f"vehicle {k} heard {heard} others")
            # Before it is ready it may not know its origin yet.
            ready = events.index(("phase", "climbing"))
            odd = {name for name, _ in events[ready:] if name.startswith("team_")} - {"team_vehicle", "team_lost"}
            check(not odd, f"vehicle {k}: nothing else to say of the team in flight {sorted(odd)}")
        truth = arena.read("sim.json")
        for vehicle in truth["vehicles"]:
            check(vehicle["outcome"] not in ("collision", "left_world"),
                  f"sim: vehicle {vehicle['vehicle']}: {vehicle['outcome']}")
            check(vehicle["min_clearance"] > 0.0, f"smallest true clearance {vehicle['min_clearance']:.2f} m")


main(test)
