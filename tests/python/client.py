# SPDX-License-Identifier: BSD-3-Clause
"""A user's program, for test_package.py to check its types; not run."""

import pathlib

import numpy as np
from numpy.typing import NDArray

import jink

result = jink.plan(pathlib.Path("scenario.yaml"), "paper", 3, threads=2, slaves=4, horizon={"margin": 0.3})
length: float = result.summary["path_length"]
points: NDArray[np.float64] = result.path.position
flight = jink.replay("scenario.yaml", log="flight.jsonl")
if isinstance(flight, jink.FlightResult):
    times: NDArray[np.float64] = flight.t
planner = jink.HorizonPlanner(threads=2)
obstacles = jink.tracks([[1.0, 2.0, 3.0]], 0.5, velocity=np.zeros((1, 3)))
plan: jink.Plan = planner.plan(points[0], [0, 0, 0], (20, 0, 2), obstacles, previous=result.path.after(0.2))
free: bool = jink.verify(plan.path, obstacles, volume=[[0, 0, 0], [1, 1, 1]]).free


def evaluate(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([x[:, 0], 1 - x[:, 0]], axis=1)


front: jink.Front = jink.Pmomvo(2, 2, population=20).run(evaluate, [0, 0], [1, 1])
best: NDArray[np.float64] = front.x[front.f[:, 0].argmin()]
flights = jink.read_arena("arena").flights
try:
    jink.Scenario("scenario.yaml")
except jink.Error as error:
    print(error)
