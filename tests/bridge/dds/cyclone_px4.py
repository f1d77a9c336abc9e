#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""PX4's uXRCE-DDS agent, played by another vendor's DDS (Eclipse Cyclone DDS), until its stdin closes.

    cyclone_px4.py --domain 7 --namespace px4_1 --version 1

Publishes a VehicleLocalPosition at 50 Hz as the agent does (best effort, transient local), in message version 0 on
vehicle_local_position or 1 on vehicle_local_position_v1, and prints each TrajectorySetpoint that came with an
OffboardControlMode before it.
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
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

F, D, U8, U64, B = types.float32, types.float64, types.uint8, types.uint64, bool
PAIR, TRIPLE = types.array[F, 2], types.array[F, 3]


def message(name, fields):
    cls = new_class(name, (IdlStruct,), {"typename": f"px4_msgs.msg.dds_.{name}_"},
                    lambda body: body.update(__annotations__=dict(fields), __module__=__name__))
    return annotate.final(dataclass(cls))


def local_position_fields(version):
    fields = [("timestamp", U64), ("timestamp_sample", U64), ("xy_valid", B), ("z_valid", B), ("v_xy_valid", B),
              ("v_z_valid", B), ("x", F), ("y", F), ("z", F), ("delta_xy", PAIR), ("xy_reset_counter", U8),
              ("delta_z", F), ("z_reset_counter", U8), ("vx", F), ("vy", F), ("vz", F), ("z_deriv", F),
              ("delta_vxy", PAIR), ("vxy_reset_counter", U8), ("delta_vz", F), ("vz_reset_counter", U8), ("ax", F),
              ("ay", F), ("az", F), ("heading", F), ("heading_var", F), ("unaided_heading", F), ("delta_heading", F),
              ("heading_reset_counter", U8), ("heading_good_for_control", B), ("tilt_var", F), ("xy_global", B),
              ("z_global", B), ("ref_timestamp", U64), ("ref_lat", D), ("ref_lon", D), ("ref_alt", F),
              ("dist_bottom_valid", B), ("dist_bottom", F), ("dist_bottom_var", F), ("delta_dist_bottom", F),
              ("dist_bottom_reset_counter", U8), ("dist_bottom_sensor_bitfield", U8), ("eph", F), ("epv", F),
              ("evh", F), ("evv", F), ("dead_reckoning", B), ("vxy_max", F), ("vz_max", F), ("hagl_min", F)]
    return fields + ([("hagl_max_z", F), ("hagl_max_xy", F)] if version else [("hagl_max", F)])


TrajectorySetpoint = message("TrajectorySetpoint", [
    ("timestamp", U64), ("position", TRIPLE), ("velocity", TRIPLE), ("acceleration", TRIPLE), ("jerk", TRIPLE),
    ("yaw", F), ("yawspeed", F)])
MODES = ["position", "velocity", "acceleration", "attitude", "body_rate", "thrust_and_torque", "direct_actuator"]
OffboardControlMode = message("OffboardControlMode", [("timestamp", U64)] + [(name, B) for name in MODES])


def position(cls, fields):
    zero = {B: False, PAIR: [0.0, 0.0], F: 0.0, D: 0.0, U8: 0, U64: 0}
    values = {name: zero[kind] for name, kind in fields}
    values.update(timestamp=time.time_ns() // 1000, xy_valid=True, z_valid=True, v_xy_valid=True, v_z_valid=True, x=5.0,
                  y=2.0, z=-10.0, vx=1.0, vy=2.0, vz=0.5, heading_good_for_control=True, unaided_heading=math.nan,
                  xy_global=True, z_global=True, ref_lat=47.397743, ref_lon=8.545594, ref_alt=489.5, hagl_min=math.inf)
    return cls(**values)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--namespace", default="", help="of the agent, before fmu")
    parser.add_argument("--version", type=int, choices=(0, 1), default=1, help="of VehicleLocalPosition")
    options = parser.parse_args()
    prefix = "rt/" + (options.namespace + "/" if options.namespace else "") + "fmu/"

    fields = local_position_fields(options.version)
    cls = message("VehicleLocalPosition", fields)
    participant = DomainParticipant(options.domain)
    plain = Policy.DataRepresentation(use_cdrv0_representation=True)
    written = Qos(Policy.Reliability.BestEffort, Policy.Durability.TransientLocal, Policy.History.KeepLast(1), plain)
    read = Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(2), plain)
    name = "vehicle_local_position" + ("_v1" if options.version else "")
    writer = DataWriter(participant, Topic(participant, prefix + "out/" + name, cls), qos=written)
    setpoints = DataReader(participant, Topic(participant, prefix + "in/trajectory_setpoint", TrajectorySetpoint),
                           qos=read)
    modes = DataReader(participant, Topic(participant, prefix + "in/offboard_control_mode", OffboardControlMode),
                       qos=read)

    print("ready", flush=True)
    mode = None
    while not select.select([sys.stdin], [], [], 0.02)[0]:
        writer.write(position(cls, fields))
        for sample in modes.take(8):
            mode = " ".join(name for name in MODES if getattr(sample, name))
        for sample in setpoints.take(8):
            if mode is None:
                continue
            parts = [f"{name} " + " ".join(f"{value:.6g}" for value in getattr(sample, name))
                     for name in ("position", "velocity", "acceleration")]
            print("setpoint", *parts, f"yaw {sample.yaw:.5g} yawspeed {sample.yawspeed:g} mode {mode}", flush=True)


if __name__ == "__main__":
    main()
