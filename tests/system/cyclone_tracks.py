#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Publishes obstacle tracks from another vendor's DDS (Eclipse Cyclone DDS), as a ROS 2 node might.

    cyclone_tracks.py --domain 7 --rate 20 --duration 5 --obstacle 5,0,1.5,0,-1,0,0.4 --obstacle 9,2,1.5,0,0,0,0.5

An obstacle is x,y,z,vx,vy,vz,radius (m, m/s), and moves in a straight line from the start of the script; its id is its
place in the list, from 1. With --edges all of them are boxes of these edges, in their spheres; without, the message is
that of a writer that knows no shapes. Writer QoS as the contract's reader expects of any writer at least: best effort,
volatile. Prints one line `matched` when the first reader has been found, and one with the number of messages at the end.
"""
import argparse
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, annotations as annotate, types
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.topic import Topic


@dataclass
@annotate.final
class Time(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
@annotate.final
class Header(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Time
    frame_id: str


@dataclass
@annotate.final
class Point(IdlStruct, typename="geometry_msgs.msg.dds_.Point_"):
    x: types.float64
    y: types.float64
    z: types.float64


@dataclass
@annotate.final
class Vector3(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x: types.float64
    y: types.float64
    z: types.float64


@dataclass
@annotate.final
class Quaternion(IdlStruct, typename="geometry_msgs.msg.dds_.Quaternion_"):
    x: types.float64
    y: types.float64
    z: types.float64
    w: types.float64


@dataclass
@annotate.final
class ObstacleTrack(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleTrack_"):
    id: types.uint64
    position: Point
    velocity: Vector3
    acceleration: Vector3
    radius: types.float64
    position_sigma: types.float64
    velocity_sigma: types.float64


@dataclass
@annotate.final
class ObstacleShape(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleShape_"):
    type: types.uint8
    center: Point
    orientation: Quaternion
    yaw_rate: types.float64
    size: Vector3
    vertices: types.sequence[Point]


@dataclass
@annotate.final
class Spheres(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleTracks_"):
    """ObstacleTracks as they were before they had shapes."""
    header: Header
    tracks: types.sequence[ObstacleTrack]


@dataclass
@annotate.final
class ObstacleTracks(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleTracks_"):
    header: Header
    tracks: types.sequence[ObstacleTrack]
    shapes: types.sequence[ObstacleShape]


def obstacle(text):
    values = [float(part) for part in text.split(",")]
    if len(values) != 7:
        raise argparse.ArgumentTypeError("an obstacle is x,y,z,vx,vy,vz,radius")
    return values


def box(edges):
    return ObstacleShape(type=1, center=Point(0.0, 0.0, 0.0), orientation=Quaternion(0.0, 0.0, 0.0, 1.0), yaw_rate=0.0,
                         size=Vector3(*edges), vertices=[])


def message(obstacles, t, frame, sigma, edges):
    now = time.time_ns()
    tracks = [
        ObstacleTrack(id=i + 1, position=Point(*(p + v * t for p, v in zip(o[0:3], o[3:6]))), velocity=Vector3(*o[3:6]),
                      acceleration=Vector3(0.0, 0.0, 0.0), radius=o[6], position_sigma=sigma, velocity_sigma=sigma)
        for i, o in enumerate(obstacles)
    ]
    stamp = Time(sec=now // 10**9, nanosec=now % 10**9)
    header = Header(stamp=stamp, frame_id=frame)
    if edges is None:
        return Spheres(header, tracks)
    return ObstacleTracks(header, tracks, [box(edges) for _ in obstacles])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--rate", type=float, default=20.0, help="messages per second")
    parser.add_argument("--duration", type=float, default=10.0, help="seconds")
    parser.add_argument("--frame", default="map", help="header.frame_id: map or ned")
    parser.add_argument("--sigma", type=float, default=0.0, help="standard deviation stated for position and velocity")
    parser.add_argument("--reliable", action="store_true", help="a reliable writer instead of a best-effort one")
    parser.add_argument("--obstacle", type=obstacle, action="append", help="x,y,z,vx,vy,vz,radius; may be repeated")
    parser.add_argument("--edges", type=lambda text: [float(edge) for edge in text.split(",")],
                        help="x,y,z of a box (m), which all are then")
    options = parser.parse_args()
    obstacles = options.obstacle or [[5.0, 0.0, 1.5, 0.0, -1.0, 0.0, 0.4]]

    reliability = Policy.Reliability.BestEffort
    if options.reliable:
        reliability = Policy.Reliability.Reliable(max_blocking_time=0)
    qos = Qos(reliability, Policy.Durability.Volatile, Policy.History.KeepLast(1),
              Policy.DataRepresentation(use_cdrv0_representation=True))
    participant = DomainParticipant(options.domain)
    topic = Topic(participant, "rt/jink/obstacle_tracks",
                  Spheres if options.edges is None else ObstacleTracks)
    writer = DataWriter(Publisher(participant), topic, qos=qos)

    start = time.monotonic()
    sent, matched = 0, False
    while (t := time.monotonic() - start) < options.duration:
        writer.write(message(obstacles, t, options.frame, options.sigma, options.edges))
        sent += 1
        if not matched and writer.get_matched_subscriptions():
            matched = True
            print("matched", flush=True)
        time.sleep(max(0.0, start + sent / options.rate - time.monotonic()))
    print(f"sent {sent} messages", flush=True)


if __name__ == "__main__":
    main()
