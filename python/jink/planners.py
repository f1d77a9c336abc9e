# SPDX-License-Identifier: BSD-3-Clause
"""The planner for loops of one's own, and PMOMVO for problems of one's own."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _jink
from .runs import File, Overrides, settings, whole

Costs = NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.float64]]


def tracks(position: ArrayLike, radius: ArrayLike, **others: ArrayLike) -> _jink.Tracks:
    """Obstacles at `position` (n x 3, m) of `radius` (n or one, m); `others` are further columns of Tracks.

    Raises ValueError where NumPy cannot bring a shape to the column's, AttributeError for a column that there is not.
    """
    places = np.asarray(position, dtype=np.float64)
    if places.ndim != 2 or places.shape[1] != 3:
        raise ValueError(f"position: expected n x 3 numbers, not an array of shape {places.shape}")
    result = _jink.Tracks(len(places))
    for name, values in {"id": np.arange(len(places)), "position": places, "radius": radius, **others}.items():
        getattr(result, name)[:] = values
    return result


def _numbers(name: str, value: ArrayLike | None, *shape: int) -> Any:
    """Lists of that shape, None for None. Raises ValueError."""
    if value is None:
        return None
    array = np.asarray(value, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name}: expected {' x '.join(map(str, shape))} numbers, not an array of shape {array.shape}")
    return array.tolist()


def verify(path: _jink.Path, tracks: _jink.Tracks | None = None, vehicle: _jink.Vehicle | None = None, *,
           volume: ArrayLike | None = None, velocity: ArrayLike | None = None, standing: _jink.Tracks | None = None,
           tracks_time: float = 0.0, until: float = math.inf, acceleration_trust: float = math.inf,
           rests: bool = True) -> _jink.Verification:
    """Checks a path, flown at constant velocity between its points, in continuous time.

    `tracks` are valid at `tracks_time` of the path; `standing` ones do not move. `volume` is (smallest, largest)
    coordinates; it and the obstacles count up to `until`. With `velocity`, the vehicle's at the first point, the
    vehicle's limits are looked at too; `rests`: the path ends at rest. Other Python threads run meanwhile.
    """
    return _jink.verify(path, tracks, vehicle or _jink.Vehicle(), volume=_numbers("volume", volume, 2, 3),
                        velocity=_numbers("velocity", velocity, 3), standing=standing, tracks_time=tracks_time,
                        until=until, acceleration_trust=acceleration_trust, rests=rests)


class HorizonPlanner(_jink.HorizonPlanner):
    """Plans the remaining path from the present state, verified, again and again: what is flown.

    `config`, `set` and `changes` are parameters as `jink.settings` takes them. One planner serves one flight at a time;
    other Python threads run while it plans.
    """

    def __init__(self, config: File | None = None, set: Overrides = (), *, threads: int = 1, **changes: Any) -> None:
        super().__init__(settings(config, set, **changes), whole("threads", threads))

    def plan(self, position: ArrayLike, velocity: ArrayLike, target: ArrayLike, tracks: _jink.Tracks | None = None, *,
             previous: _jink.Path | None = None, vehicle: _jink.Vehicle | None = None, volume: ArrayLike | None = None,
             standing: _jink.Tracks | None = None, margin: float | None = None, seed: int = 1, number: int = 0,
             generations: int | None = None, deadline_ms: float | None = None) -> _jink.Plan:
        """Plans from `position` (m) and `velocity` (m/s) on, among `tracks` that are valid now and `standing` ones.

        `previous` is the plan now flown, its times counted from now (`Path.after`). `volume` is (smallest, largest)
        coordinates. `margin` (m) and `generations` unless told are those of the parameters. `number` counts the plans of
        a flight. The same bits for the same arguments, unless a deadline ends the search.
        """
        return super().plan(_numbers("position", position, 3), _numbers("velocity", velocity, 3),
                            _numbers("target", target, 3), tracks, previous=previous,
                            vehicle=vehicle or _jink.Vehicle(), volume=_numbers("volume", volume, 2, 3),
                            standing=standing, margin=margin, seed=seed, number=number, generations=generations,
                            deadline_ms=deadline_ms)


class Pmomvo(_jink.Pmomvo):
    """PMOMVO for problems of `dimension` variables and 1 to 3 `objectives`, all minimised.

    `changes` are parameters of the section `optimizer` of planner.yaml, as `population=100`.
    """

    def __init__(self, dimension: int, objectives: int, **changes: Any) -> None:
        super().__init__(settings(optimizer=changes), dimension, objectives)

    def run(self, evaluate: Callable[[NDArray[np.float64]], Costs], lower: ArrayLike, upper: ArrayLike, *,
            initial: ArrayLike | None = None, seed: int = 1, stream: int = 0, generations: int | None = None,
            deadline_ms: float | None = None, threads: int = 1) -> _jink.Front:
        """Optimizes. `evaluate(x)` takes K solutions, a view of K x dimension, and gives their K x objectives, or a pair of
        these and K violations (0: feasible). It is called with all universes of a slave; `x` changes after it returns.

        `lower` and `upper` bound the variables; `initial` are solutions to begin with, n x dimension; `generations`
        unless told `iterations` of the parameters. With `threads` slaves run beside each other where `evaluate` lets
        other threads run. The same bits for any number of threads, unless a deadline ends the run. What `evaluate`
        raises comes out of here.
        """
        first = None if initial is None else np.ascontiguousarray(np.atleast_2d(initial), dtype=np.float64)
        bounds = [np.ascontiguousarray(bound, dtype=np.float64) for bound in (lower, upper)]
        return super().run(evaluate, *bounds, initial=first, seed=seed, stream=stream, generations=generations,
                           deadline_ms=deadline_ms, threads=whole("threads", threads))
