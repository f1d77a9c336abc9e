#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A writer of obstacle tracks and a reader of setpoints, by another vendor's DDS (Eclipse Cyclone DDS), whose QoS
cannot match jink's, until stdin closes.

    cyclone_mismatch.py --domain 7
"""
import argparse
import sys
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, annotations as annotate, types
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
@annotate.final
class Tracks(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleTracks_"):
    nothing: types.uint64


@dataclass
@annotate.final
class Setpoint(IdlStruct, typename="px4_msgs.msg.dds_.TrajectorySetpoint_"):
    nothing: types.uint64


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", type=int, default=0)
    options = parser.parse_args()
    plain = Policy.DataRepresentation(use_cdrv0_representation=True)
    participant = DomainParticipant(options.domain)
    publisher = Publisher(participant, qos=Qos(Policy.Partition(["elsewhere"])))
    writer = DataWriter(publisher, Topic(participant, "rt/jink/obstacle_tracks", Tracks),
                        qos=Qos(Policy.Reliability.BestEffort, Policy.Ownership.Exclusive, plain))
    reader = DataReader(participant, Topic(participant, "rt/px4_1/fmu/in/trajectory_setpoint", Setpoint),
                        qos=Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal,
                                Policy.Deadline(duration(seconds=1)),
                                Policy.Liveliness.ManualByTopic(duration(seconds=1)), plain))
    print("ready", flush=True)
    sys.stdin.read()
    del writer, reader


if __name__ == "__main__":
    main()
