#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Flies a scenario, exports its log as MCAP and reads that with another's library: nothing is lost or moved in time.

check_mcap.py JINK
"""
import collections
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import mcap.reader
import mcap.stream_reader

SCENARIO = """
format: jink-scenario/1
name: shapes
start: [0, 0, 1.5]
target: [8, 0, 1.5]
vehicle: ardrone2
world: {min: [-5, -10, 0], max: [25, 10, 8]}
obstacles:
- {radius: 0.5, position: [4, 3, 1.5], velocity: [0, -0.5, 0]}
- {box: [0.8, 1.0, 1.2], position: [5, -3, 1]}
- {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], position: [2, 3, 1]}
"""

# A wall in the way that is there to be seen.
WALL = """
format: jink-scenario/1
name: wall
start: [0, 0, 1.5]
target: [12, 0, 1.5]
vehicle: ardrone2
world: {min: [-5, -10, 0], max: [25, 10, 4]}
map: [{box: [0.4, 8, 4], position: [6, 0, 2]}]
sensing: {scan: lidar}
obstacles: []
"""


def check(holds, text):
    if not holds:
        print(f"FAIL {text}")
        sys.exit(1)
    print(f"ok   {text}", flush=True)


def seconds(stamp):
    return stamp["sec"] + 1e-9 * stamp["nsec"]


def fits(value, schema, at="message"):
    """The parts of JSON schema that the recording uses."""
    if "oneOf" in schema:
        assert value in [choice["const"] for choice in schema["oneOf"]], f"{at}: {value}"
        return
    kind = schema["type"]
    if kind == "object":
        assert isinstance(value, dict), at
        for key, item in value.items():
            assert key in schema["properties"], f"{at}: the schema has no {key}"
            fits(item, schema["properties"][key], f"{at}.{key}")
    elif kind == "array":
        assert isinstance(value, list), at
        for item in value:
            fits(item, schema["items"], f"{at}[]")
    elif kind == "integer":
        assert isinstance(value, int) and schema.get("minimum", value) <= value <= schema.get("maximum", value), at
    elif kind == "number":
        assert isinstance(value, (int, float)) and math.isfinite(value), at
    else:
        assert isinstance(value, {"string": str, "boolean": bool}[kind]), at


def read(file):
    """{topic: [(time, message), ...]} in the order of time by the index, each message checked against its schema."""
    topics = collections.defaultdict(list)
    with open(file, "rb") as stream:
        reader = mcap.reader.make_reader(stream, validate_crcs=True)
        check(isinstance(reader, mcap.reader.SeekingReader), "the recording can be sought in")
        summary = reader.get_summary()
        metadata = {item.name: item.metadata for item in reader.iter_metadata()}
        for schema, channel, message in reader.iter_messages():
            value = json.loads(message.data)
            fits(value, json.loads(schema.data), channel.topic)
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            topics[channel.topic].append((1e-9 * message.log_time, value, schema.name))
    with open(file, "rb") as stream:  # from its beginning to its end, without the index
        records = list(mcap.stream_reader.StreamReader(stream, validate_crcs=True, emit_chunks=False).records)
    return topics, summary, metadata, records


def check_summary(topics, summary, records):
    total = sum(map(len, topics.values()))
    check(summary.statistics.message_count == total > 100, f"the statistics tell of all {total} messages")
    counts = {summary.channels[k].topic: n for k, n in summary.statistics.channel_message_counts.items()}
    check(counts == {topic: len(list_) for topic, list_ in topics.items()}, "and of those of each topic")
    check(sum(type(r).__name__ == "Message" for r in records) == total, "read from the front there are as many")
    check(len(summary.chunk_indexes) == summary.statistics.chunk_count >= 1, "each chunk has its index")
    first = min(list_[0][0] for list_ in topics.values())
    check(abs(1e-9 * summary.statistics.message_start_time - first) < 1e-9, "it begins when its first message does")


def check_against_log(topics, log):
    by_type = collections.defaultdict(list)
    for record in log:
        by_type[record["type"]].append(record)
    for topic, kind in (("/truth/pose", "truth"), ("/state/pose", "state"), ("/setpoint/pose", "setpoint"),
                        ("/plan", "plan"), ("/plan/time", "plan"), ("/tf", "truth"), ("/speed", "truth")):
        times = [t for t, _, _ in topics[topic]]
        wanted = [record["t"] for record in by_type[kind]]
        check(len(times) == len(wanted) and all(abs(a - b) < 1e-8 for a, b in zip(times, wanted)),
              f"{topic} has the log's {len(wanted)} {kind} records at their times")
    for (_, message, _), record in zip(topics["/truth/pose"], by_type["truth"]):
        assert list(message["pose"]["position"].values()) == record["p"] and message["frame_id"] == "map", record
        assert abs(seconds(message["timestamp"]) - record["t"]) < 1e-8
    for (_, message, _), record in zip(topics["/tf"], by_type["truth"]):
        assert list(message["translation"].values()) == record["p"], record
        assert (message["parent_frame_id"], message["child_frame_id"]) == ("map", "vehicle")
    for (_, message, _), record in zip(topics["/plan"], by_type["plan"]):
        assert [list(p["position"].values()) for p in message["poses"]] == [point[1:] for point in record["path"]]
    for (_, message, _), record in zip(topics["/plan/time"], by_type["plan"]):
        assert message["ms"] == record["ms"] and message["status"] == record["status"]
    for (_, message, _), record in zip(topics["/speed"], by_type["truth"]):
        assert abs(message["speed"] - math.hypot(*record["v"])) < 1e-12 and message["height"] == record["p"][2]
    check(True, "positions, paths, speeds and plan times are the log's own")
    logged = [(record["name"], record["detail"]) for record in by_type["event"]]
    told = [message["message"] for _, message, _ in topics["/events"]]
    check(len(told) >= len(logged) and all((f"{n}: {d}" if d else n) in told for n, d in logged), "so are the events")


def check_scenes(topics, log, summary_of_flight):
    scenes = topics["/scene/obstacles"]
    entities = {entity["id"]: entity for entity in scenes[0][1]["entities"]}
    check(sorted(entities) == ["obstacle 1", "obstacle 2", "obstacle 3"], "the scene holds the three obstacles")
    sphere, cube, hull = (entities[f"obstacle {k}"] for k in (1, 2, 3))
    check(sphere["spheres"][0]["size"] == {"x": 1.0, "y": 1.0, "z": 1.0}, "the sphere by its diameter")
    check(cube["cubes"][0]["size"] == {"x": 0.8, "y": 1.0, "z": 1.2}, "the box by its edges")
    triangles = hull["triangles"][0]
    origin = triangles["pose"]["position"]
    corners = sorted([round(p[k] + origin[k], 9) for k in "xyz"] for p in triangles["points"])
    check(corners == sorted([[2, 3, 1], [3, 3, 1], [2, 4, 1], [2, 3, 2]]), "the hull's corners where they stand")
    check(len(triangles["indices"]) == 12, "and its four faces")
    moved = [next(e for e in scene["entities"] if e["id"] == "obstacle 1") for _, scene, _ in scenes]
    places = {record["t"]: record["p"] for record in log if record["type"] == "obstacles" and record["id"] == 1}
    for (t, _, _), entity in zip(scenes, moved):
        near = min(places, key=lambda time: abs(time - t))
        assert list(entity["spheres"][0]["pose"]["position"].values()) == places[near], t
    check(len({e["spheres"][0]["pose"]["position"]["y"] for e in moved}) > 20, "the sphere moves as the log says")
    least = min(message["clearance"] for _, message, _ in topics["/clearance"])
    # The log samples what the judge knows in continuous time.
    check(0.0 <= least - summary_of_flight["min_clearance"] < 0.05, f"least clearance {least:.3f} m, by true shapes")
    ahead = topics["/scene/tracks"][5][1]["entities"][0]["lines"][0]["points"]
    moved = ahead[-1]["y"] - ahead[0]["y"]
    check(abs(moved + 2 * 0.5) < 0.01, f"the track of the mover is predicted 2 s ahead: {moved:.2f} m")


def check_map(jink, folder):
    (folder / "wall.yaml").write_text(WALL)
    subprocess.run([jink, "replay", folder / "wall.yaml", "--log", folder / "wall.jsonl", "--set",
                    "horizon.generations=40"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([jink, "export", folder / "wall.jsonl", "--mcap"], check=True, stdout=subprocess.DEVNULL)
    topics = read(folder / "wall.mcap")[0]
    (_, scene, _), = topics["/scene/map"]
    wall, = scene["entities"][0]["triangles"]
    place = wall["pose"]["position"]
    spans = [(min(p[k] for p in wall["points"]) + place[k], max(p[k] for p in wall["points"]) + place[k])
             for k in "xyz"]
    check(all(abs(a - b) < 1e-9 for span, wanted in zip(spans, ((5.8, 6.2), (-4, 4), (0, 4)))
              for a, b in zip(span, wanted)), "the map's wall where it stands")
    seen = topics["/scene/seen"]
    check(len(seen) > 3 and seen[-1][1]["entities"][0]["triangles"], f"what was seen of it, {len(seen)} times")
    for _, scene, _ in seen:
        for box in scene["entities"][0]["triangles"]:
            place = box["pose"]["position"]
            near = [p["x"] + place["x"] for p in box["points"]]
            on_the_ground = place["z"] < 0.5  # which a vehicle that tilts may see a little higher than it is
            assert on_the_ground or (5.3 < min(near) and max(near) < 6.7), near
    plans = [scene["entities"][0]["lines"] for _, scene, _ in topics["/scene/plan"]]
    check(any(len(lines) == 2 and len(lines[1]["points"]) > 2 for lines in plans), "plans show the guide round it")


def main(jink):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scenario.yaml").write_text(SCENARIO)
        subprocess.run([jink, "replay", folder / "scenario.yaml", "--log", folder / "flight.jsonl", "--json",
                        folder / "flight.json", "--set", "horizon.generations=40"], check=True,
                       stdout=subprocess.DEVNULL)
        with open(folder / "flight.jsonl") as lines:
            log = [json.loads(line) for line in lines]
        done = subprocess.run([jink, "export", folder / "flight.jsonl", "--mcap"], check=True, capture_output=True,
                              text=True)
        topics, summary, metadata, records = read(folder / "flight.mcap")
        check(done.stdout.startswith(f"{folder}/flight.mcap: {sum(map(len, topics.values()))} messages"),
              "the command tells the file and the number of messages")
        check(metadata["jink"]["scenario"] == "shapes" and float(metadata["jink"]["epoch_s"]) == 0.0, "metadata")
        check_summary(topics, summary, records)
        check_against_log(topics, log)
        check_scenes(topics, log, json.loads((folder / "flight.json").read_text()))
        check_map(jink, folder)
        (folder / "bad.jsonl").write_text("hello\n")
        bad = subprocess.run([jink, "export", folder / "bad.jsonl", "--mcap", folder / "bad.mcap"], capture_output=True,
                             text=True, check=False)
        check(bad.returncode == 2 and bad.stderr.count("\n") == 1, "a bad log: exit 2 and one line")
        check("bad.jsonl:1:" in bad.stderr, "which names it")
        check(not (folder / "bad.mcap").exists(), "and no recording")
        full = subprocess.run([jink, "export", folder / "flight.jsonl", "--mcap", folder / "no" / "x.mcap"],
                              capture_output=True, text=True, check=False)
        check(full.returncode == 2 and full.stderr.count("\n") == 1, "a folder that is not there: one line")


if __name__ == "__main__":
    main(sys.argv[1])
