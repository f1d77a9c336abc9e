#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Publishes, from another vendor's DDS, what is no obstacle tracks on the topic of the obstacle tracks: messages that state
four billion tracks and end there, and messages cut short.

    malformed_tracks.py --domain 7 --duration 5
"""
import argparse
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct, annotations as annotate, types
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from cyclone_tracks import Header, Time


@dataclass
@annotate.final
class Claim(IdlStruct, typename="jink_msgs.msg.dds_.ObstacleTracks_"):
    header: Header
    count: types.uint32


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--duration", type=float, default=5.0)
    options = parser.parse_args()
    participant = DomainParticipant(options.domain)
    qos = Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(1))
    writer = DataWriter(participant, Topic(participant, "rt/jink/obstacle_tracks", Claim), qos=qos)
    end = time.time() + options.duration
    while time.time() < end:
        now = time.time()
        for count in (0xFFFFFFFF, 3):
            writer.write(Claim(Header(Time(int(now), 0), "map"), count))
        time.sleep(0.02)


main()
