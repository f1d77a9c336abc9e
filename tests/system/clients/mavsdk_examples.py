# SPDX-License-Identifier: BSD-3-Clause
"""MAVSDK-Python 3 against the simulator, as its own examples use it: run in .venv/clients by test_foreign_clients.py.

    mavsdk_examples.py MAVLINK_PORT SERVER_PORT

Prints a line for each example that holds; the first that does not ends it.
"""

import asyncio
import math
import sys
import time

from mavsdk import System
from mavsdk.ftp import FtpError
from mavsdk.geofence import Circle, FenceType, GeofenceData, Point, Polygon
from mavsdk.log_files import LogFilesError
from mavsdk.mission import MissionItem, MissionPlan
from mavsdk.mission_raw import MissionItem as RawItem
from mavsdk.mission_raw import MissionRawError
from mavsdk.offboard import OffboardError, PositionNedYaw, VelocityNedYaw
from mavsdk.telemetry import FlightMode, LandedState

METRES_PER_DEGREE = 111320.0
NAN = float("nan")
AT_ONCE = 3.0  # s, a fifth of the client's time-outs at the most


def check(holds, text):
    if not holds:
        raise AssertionError(text)
    print(f"ok   MAVSDK-Python: {text}", flush=True)


async def first(stream, until=lambda value: True, seconds=60.0):
    async def wait():
        async for value in stream:
            if until(value):
                return value
    return await asyncio.wait_for(wait(), seconds)


class Examples:
    def __init__(self, drone):
        self.drone = drone
        self.home = None

    def place(self, north, east):
        latitude = self.home.latitude_deg + north / METRES_PER_DEGREE
        return latitude, self.home.longitude_deg + east / (METRES_PER_DEGREE * math.cos(math.radians(latitude)))

    async def position(self):
        """North, east, height above home."""
        now = await first(self.drone.telemetry.position())
        north = (now.latitude_deg - self.home.latitude_deg) * METRES_PER_DEGREE
        east = (now.longitude_deg - self.home.longitude_deg) * METRES_PER_DEGREE * math.cos(math.radians(now.latitude_deg))
        return north, east, now.relative_altitude_m

    async def is_at(self, north, east, height, within=1.5, seconds=40.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            at = await self.position()
            if math.dist(at, (north, east, height)) < within:
                return True
            await asyncio.sleep(0.1)
        return False

    async def mode(self, mode):
        await first(self.drone.telemetry.flight_mode(), lambda value: value == mode)

    async def telemetry(self):
        await first(self.drone.telemetry.health_all_ok(), lambda ok: ok)
        self.home = await first(self.drone.telemetry.home())
        check(True, "telemetry: health, home")
        battery = await first(self.drone.telemetry.battery())
        check(battery.remaining_percent > 50, "telemetry: battery")
        attitude = await first(self.drone.telemetry.attitude_euler())
        check(abs(attitude.roll_deg) < 5, "telemetry: attitude")
        version = await self.drone.info.get_version()
        check(version.flight_sw_major == 1, f"version {version.flight_sw_major}.{version.flight_sw_minor}")

    async def parameters(self):
        await self.drone.param.set_param_float("MIS_TAKEOFF_ALT", 4.0)
        check(await self.drone.param.get_param_float("MIS_TAKEOFF_ALT") == 4.0, "a parameter is set and read")
        check(await self.drone.param.get_param_int("COM_OBL_RC_ACT") == 0, "a whole number is read")

    async def files_and_logs(self):
        begin = time.monotonic()
        try:
            await self.drone.ftp.list_directory("/fs/microsd/log")
            check(False, "there is no such directory")
        except FtpError as error:
            check("FILE_DOES_NOT_EXIST" in str(error), "FTP: no such directory")
        check(time.monotonic() - begin < AT_ONCE, "FTP answers at once")
        begin = time.monotonic()
        try:
            check(not await self.drone.log_files.get_entries(), "log list: none")
        except LogFilesError as error:
            check("NO_LOGFILES" in str(error), "log list: none")
        check(time.monotonic() - begin < AT_ONCE, "the log list comes at once")

    async def geofence(self):
        corners = [Point(*self.place(*corner)) for corner in ((-50, -50), (-50, 50), (50, 50), (50, -50))]
        circle = Circle(Point(*self.place(30, 30)), 5.0, FenceType.EXCLUSION)
        await self.drone.geofence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], [circle]))
        fence = await self.drone.mission_raw.download_geofence()
        check([item.command for item in fence] == [5001] * 4 + [5004], "a geofence goes up and comes down")
        await self.drone.geofence.clear_geofence()
        check(not await self.drone.mission_raw.download_geofence(), "it is cleared")

    async def raw_mission(self):
        latitude, longitude = (round(value * 1e7) for value in self.place(10, 0))
        items = [RawItem(0, 6, 22, 1, 1, 0, 0, 0, NAN, latitude, longitude, 5.0, 0),
                 RawItem(1, 6, 16, 0, 1, 0, 2, 0, NAN, latitude, longitude, 5.0, 0),
                 RawItem(2, 2, 20, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0)]
        await self.drone.mission_raw.upload_mission(items)
        back = await self.drone.mission_raw.download_mission()
        check([(i.command, i.frame, i.x, i.y, i.z) for i in back] == [(i.command, i.frame, i.x, i.y, i.z) for i in items],
              "a raw mission comes down as it went up")
        rally = RawItem(0, 6, 5100, 0, 1, 0, 0, 0, 0, latitude, longitude, 10.0, 2)
        await self.drone.mission_raw.upload_rally_points([rally])
        check(len(await self.drone.mission_raw.download_rallypoints()) == 1, "rally points too")
        unknown = RawItem(0, 6, 84, 1, 1, 0, 0, 0, NAN, latitude, longitude, 5.0, 0)  # NAV_VTOL_TAKEOFF
        try:
            await self.drone.mission_raw.upload_mission([unknown])
            check(False, "what a multicopter cannot fly is refused")
        except MissionRawError as error:
            check("UNSUPPORTED" in str(error), "what a multicopter cannot fly is refused")
        await self.drone.mission_raw.clear_mission()
        check(not await self.drone.mission_raw.download_mission(), "the mission is cleared")

    async def mission(self):
        def item(north, east, height, speed=NAN, fly_through=True):
            return MissionItem(*self.place(north, east), height, speed, fly_through, NAN, NAN, MissionItem.CameraAction.NONE,
                               NAN, NAN, 1.0, NAN, NAN, MissionItem.VehicleAction.NONE)
        plan = MissionPlan([item(0, 0, 5), item(20, 0, 5, 4.0), item(20, 15, 6, 4.0, False)])
        await self.drone.mission.set_return_to_launch_after_mission(False)
        await self.drone.mission.upload_mission(plan)
        back = await self.drone.mission.download_mission()
        check(len(back.mission_items) == 3, "a mission goes up and comes down")
        seen = []

        async def watch():
            async for progress in self.drone.mission.mission_progress():
                seen.append((progress.current, progress.total))
        watcher = asyncio.ensure_future(watch())
        await self.drone.action.arm()
        await self.drone.mission.start_mission()
        await self.mode(FlightMode.MISSION)
        await first(self.drone.mission.mission_progress(), lambda progress: progress.current >= 1)
        await self.drone.mission.pause_mission()
        await self.mode(FlightMode.HOLD)
        await self.drone.mission.start_mission()
        await self.mode(FlightMode.MISSION)
        check(True, "the mission starts on the ground, is paused and goes on")
        await first(self.drone.mission.mission_progress(), lambda progress: progress.current == progress.total)
        check(await self.drone.mission.is_mission_finished(), "it is finished")
        watcher.cancel()
        check([at for at, _ in dict.fromkeys(seen)][-3:] == [1, 2, 3], f"progress is told: {list(dict.fromkeys(seen))}")
        await self.mode(FlightMode.HOLD)
        check(await self.is_at(20, 15, 6), "it ends in HOLD at its last item")
        await self.drone.mission.clear_mission()

    async def goto(self):
        ground = (await first(self.drone.telemetry.position())).absolute_altitude_m - (await self.position())[2]
        await self.drone.action.goto_location(*self.place(5, 5), ground + 8.0, 90.0)
        check(await self.is_at(5, 5, 8), "goto_location")
        heading = await first(self.drone.telemetry.heading(), lambda value: abs(value.heading_deg - 90.0) < 5.0)
        check(True, f"with its heading, {heading.heading_deg:.0f} deg")

    async def offboard(self):
        try:
            await self.drone.offboard.start()
            check(False, "OFFBOARD without a setpoint is refused")
        except OffboardError as error:
            check("NO_SETPOINT_SET" in str(error), "OFFBOARD without a setpoint is refused")
        now = await first(self.drone.telemetry.position_velocity_ned())
        at = now.position
        await self.drone.offboard.set_position_ned(PositionNedYaw(at.north_m, at.east_m, at.down_m, 0.0))
        await self.drone.offboard.start()
        await self.drone.offboard.set_position_ned(PositionNedYaw(at.north_m + 5.0, at.east_m, at.down_m, 0.0))
        check(await self.is_at(10, 5, 8), "offboard position")
        await self.drone.offboard.set_velocity_ned(VelocityNedYaw(0.0, -2.0, 0.0, 0.0))
        moving = await first(self.drone.telemetry.velocity_ned(), lambda value: value.east_m_s < -1.2)
        check(True, f"offboard velocity, {-moving.east_m_s:.1f} m/s")
        await self.drone.offboard.stop()
        await self.mode(FlightMode.HOLD)

    async def land(self):
        await self.drone.action.land()
        await first(self.drone.telemetry.landed_state(), lambda state: state == LandedState.ON_GROUND)
        await first(self.drone.telemetry.armed(), lambda armed: not armed)
        check(True, "lands and disarms")

    async def take_off_and_land(self):
        await self.drone.action.set_takeoff_altitude(3.0)
        await self.drone.action.arm()
        await self.drone.action.takeoff()
        await first(self.drone.telemetry.position(), lambda value: value.relative_altitude_m > 2.0)
        check(True, "takes off")
        await self.land()


async def run(mavlink_port, server_port):
    drone = System(port=server_port)
    await drone.connect(f"udpin://127.0.0.1:{mavlink_port}")
    await first(drone.core.connection_state(), lambda state: state.is_connected)
    examples = Examples(drone)
    for example in (examples.telemetry, examples.parameters, examples.files_and_logs, examples.geofence,
                    examples.raw_mission, examples.mission, examples.goto, examples.offboard, examples.land,
                    examples.take_off_and_land):
        begin = time.monotonic()
        await example()
        print(f"     {example.__name__} took {time.monotonic() - begin:.1f} s", flush=True)


# In time to end the server that it started.
asyncio.run(asyncio.wait_for(run(int(sys.argv[1]), int(sys.argv[2])), 200))
