# SPDX-License-Identifier: BSD-3-Clause
"""Collision-free paths for a drone among moving obstacles.

`plan` and `replay` do what the commands of these names do, with the same bits. `HorizonPlanner`, `verify` and `Pmomvo`
are the parts they are made of. Frames are ENU, units m, s, rad. docs/python.md has examples.
"""

import pathlib

from . import _jink

# The shipped files; JINK_CONFIG_DIR comes first.
_jink.set_config_folder(str(pathlib.Path(__file__).parent / "config"))

from ._jink import Error, Front, Path, Plan, Scenario, Settings, Solid, Tracks, Vehicle, Verification
from .lab import ArenaResults, StudyResults, read_arena, read_study
from .planners import HorizonPlanner, Pmomvo, tracks, verify
from .runs import FlightResult, PlanResult, RecordingResult, plan, replay, settings

__all__ = [
    "ArenaResults", "Error", "FlightResult", "Front", "HorizonPlanner", "Path", "Plan", "PlanResult", "Pmomvo",
    "RecordingResult", "Scenario", "Settings", "Solid", "StudyResults", "Tracks", "Vehicle", "Verification",
    "__version__", "config_folder", "plan", "read_arena", "read_study", "replay", "settings", "tracks", "verify",
]


__version__: str = _jink.version()
Error.__module__ = "jink"  # where users find it


def config_folder() -> pathlib.Path:
    """Where the shipped scenarios, missions, vehicles and planner.yaml are: JINK_CONFIG_DIR, or inside the package."""
    return pathlib.Path(_jink.config_folder())
