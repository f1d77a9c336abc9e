#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A detector in space, played by another vendor's DDS (Eclipse Cyclone DDS): two boxes, one of them with a covariance
and a number for its name, or one as told, as vision_msgs' Detection3DArray at 10 Hz (reliable, volatile), until its
stdin closes.

    cyclone_detections.py --domain 7 [--box 8,0,1.5,1,2,3]
"""
import argparse
import math
import select
import sys
import time

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import types
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from cyclone_autoware import D, Header, Point, Pose, PoseWithCovariance, Quaternion, Time, Vector3, message

VISION = "vision_msgs"
ObjectHypothesis = message(VISION, "ObjectHypothesis", class_id=str, score=D)
ObjectHypothesisWithPose = message(VISION, "ObjectHypothesisWithPose", hypothesis=ObjectHypothesis,
                                   pose=PoseWithCovariance)
BoundingBox3D = message(VISION, "BoundingBox3D", center=Pose, size=Vector3)
Detection3D = message(VISION, "Detection3D", header=Header, results=types.sequence[ObjectHypothesisWithPose],
                      bbox=BoundingBox3D, id=str)
Detection3DArray = message(VISION, "Detection3DArray", header=Header, detections=types.sequence[Detection3D])


def detected(header, name, position, yaw, size, results):
    pose = Pose(Point(*position), Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
    uncertain = PoseWithCovariance(pose, [0.25] + [0.0] * 35)
    hypotheses = [ObjectHypothesisWithPose(ObjectHypothesis("car", score), uncertain) for score in results]
    return Detection3D(header, hypotheses, BoundingBox3D(pose, Vector3(*size)), name)


def array(header, box):
    if box:
        return Detection3DArray(header, [detected(header, "box", box[0:3], 0.0, box[3:6], ())])
    return Detection3DArray(header, [detected(header, "5", (1.0, 2.0, 3.0), math.pi / 2, (4.0, 4.0, 2.0), (0.75, 0.25)),
                                     detected(header, "door", (4.0, 5.0, 6.0), 0.0, (0.1, 1.0, 2.0), ())])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--box", type=lambda text: [float(part) for part in text.split(",")],
                        help="x,y,z of its centre and its edges, m")
    options = parser.parse_args()

    participant = DomainParticipant(options.domain)
    writer = DataWriter(participant, Topic(participant, "rt/jink/detections", Detection3DArray),
                        qos=Qos(Policy.Reliability.Reliable(max_blocking_time=0), Policy.Durability.Volatile,
                                Policy.History.KeepLast(1), Policy.DataRepresentation(use_cdrv0_representation=True)))
    while not select.select([sys.stdin], [], [], 0.1)[0]:
        now = time.time_ns()
        writer.write(array(Header(Time(now // 10**9, now % 10**9), "map"), options.box))


if __name__ == "__main__":
    main()
