# SPDX-License-Identifier: BSD-3-Clause
"""What a ground station does, in the system tests."""

import os
import struct

os.environ["MAVLINK20"] = "1"  # read by the import

from pymavlink import mavutil

from flight import wait_until


def set_parameter(instance, name, value):
    """As a ground station does, over its own link, of `jink sim --instance`."""
    port = 18570 + instance
    link = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=255, dialect="common")
    field = struct.unpack("<f", struct.pack("<i", value))[0] if isinstance(value, int) else value
    kind = mavutil.mavlink.MAV_PARAM_TYPE_INT32 if isinstance(value, int) else mavutil.mavlink.MAV_PARAM_TYPE_REAL32
    told = []

    def set_and_told():
        link.mav.param_set_send(link_system, 1, name.encode(), field, kind)
        message = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=0.5)
        told.extend([message] if message is not None and message.param_id == name else [])
        return told

    link_system = instance + 1
    wait_until(set_and_told, 20, f"{name} = {value}")
    link.close()
