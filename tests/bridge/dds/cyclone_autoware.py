#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Autoware's perception, played by another vendor's DDS (Eclipse Cyclone DDS): a bounding box and a polygon, as
TrackedObjects at 10 Hz (reliable, volatile, as Autoware publishes), until its stdin closes.

    cyclone_autoware.py --domain 7
"""
import argparse
import math
import select
import sys
import time
from dataclasses import dataclass
from types import new_class

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, annotations as annotate, types
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

F, D, U8, B = types.float32, types.float64, types.uint8, bool
COVARIANCE = types.array[D, 36]


def message(package, name, **fields):
    cls = new_class(name, (IdlStruct,), {"typename": f"{package}.msg.dds_.{name}_"},
                    lambda body: body.update(__annotations__=fields, __module__=__name__))
    return annotate.final(dataclass(cls))


Time = message("builtin_interfaces", "Time", sec=types.int32, nanosec=types.uint32)
Header = message("std_msgs", "Header", stamp=Time, frame_id=str)
UUID = message("unique_identifier_msgs", "UUID", uuid=types.array[U8, 16])
Point = message("geometry_msgs", "Point", x=D, y=D, z=D)
Point32 = message("geometry_msgs", "Point32", x=F, y=F, z=F)
Vector3 = message("geometry_msgs", "Vector3", x=D, y=D, z=D)
Quaternion = message("geometry_msgs", "Quaternion", x=D, y=D, z=D, w=D)
Polygon = message("geometry_msgs", "Polygon", points=types.sequence[Point32])
Pose = message("geometry_msgs", "Pose", position=Point, orientation=Quaternion)
PoseWithCovariance = message("geometry_msgs", "PoseWithCovariance", pose=Pose, covariance=COVARIANCE)
Twist = message("geometry_msgs", "Twist", linear=Vector3, angular=Vector3)
TwistWithCovariance = message("geometry_msgs", "TwistWithCovariance", twist=Twist, covariance=COVARIANCE)
Accel = message("geometry_msgs", "Accel", linear=Vector3, angular=Vector3)
AccelWithCovariance = message("geometry_msgs", "AccelWithCovariance", accel=Accel, covariance=COVARIANCE)
AUTOWARE = "autoware_perception_msgs"
ObjectClassification = message(AUTOWARE, "ObjectClassification", label=U8, probability=F)
TrackedObjectKinematics = message(AUTOWARE, "TrackedObjectKinematics", pose_with_covariance=PoseWithCovariance,
                                  twist_with_covariance=TwistWithCovariance,
                                  acceleration_with_covariance=AccelWithCovariance, orientation_availability=U8,
                                  is_stationary=B)
Shape = message(AUTOWARE, "Shape", type=U8, footprint=Polygon, dimensions=Vector3)
TrackedObject = message(AUTOWARE, "TrackedObject", object_id=UUID, existence_probability=F,
                        classification=types.sequence[ObjectClassification], kinematics=TrackedObjectKinematics,
                        shape=Shape)
TrackedObjects = message(AUTOWARE, "TrackedObjects", header=Header, objects=types.sequence[TrackedObject])


def tracked(number, position, velocity, yaw, shape):
    zero = Vector3(0.0, 0.0, 0.0)
    pose = Pose(Point(*position), Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))
    kinematics = TrackedObjectKinematics(PoseWithCovariance(pose, [0.25] + [0.0] * 35),
                                         TwistWithCovariance(Twist(Vector3(*velocity), zero), [0.0] * 36),
                                         AccelWithCovariance(Accel(zero, zero), [0.0] * 36), 2, False)
    return TrackedObject(UUID([number] * 16), 0.75, [ObjectClassification(7, 0.5)], kinematics, shape)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", type=int, default=0)
    options = parser.parse_args()

    participant = DomainParticipant(options.domain)
    topic = Topic(participant, "rt/perception/object_recognition/tracking/objects", TrackedObjects)
    writer = DataWriter(participant, topic,
                        qos=Qos(Policy.Reliability.Reliable(max_blocking_time=0), Policy.Durability.Volatile,
                                Policy.History.KeepLast(1), Policy.DataRepresentation(use_cdrv0_representation=True)))
    footprint = Polygon([Point32(3.0, 0.0, 0.0), Point32(0.0, 1.0, 0.0), Point32(-1.0, -1.0, 0.0)])
    objects = [tracked(1, (1.0, 2.0, 3.0), (2.0, 1.0, 0.0), math.pi / 2, Shape(0, Polygon([]), Vector3(4.0, 4.0, 2.0))),
               tracked(2, (4.0, 5.0, 6.0), (0.0, 0.0, 0.0), 0.0, Shape(2, footprint, Vector3(0.0, 0.0, 8.0)))]
    while not select.select([sys.stdin], [], [], 0.1)[0]:
        now = time.time_ns()
        writer.write(TrackedObjects(Header(Time(now // 10**9, now % 10**9), "map"), objects))


if __name__ == "__main__":
    main()
