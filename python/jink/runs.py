# SPDX-License-Identifier: BSD-3-Clause
"""The commands `jink plan` and `jink replay`, and their parameters."""

from __future__ import annotations

import dataclasses
import json
import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _jink

File = str | os.PathLike[str]
Overrides = Iterable[str] | Mapping[str, Any]


def _text(value: Any) -> str:
    """A parameter's value as `--set` has it."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def _overrides(given: Overrides, changes: Mapping[str, Any]) -> list[str]:
    """section.key=value for each change. What is no parameter is for the reader of them to say."""
    if isinstance(given, str):
        raise TypeError(f"set: expected a list of 'section.key=value' or a mapping, not '{given}'")
    result = [f"{key}={_text(value)}" for key, value in given.items()] if isinstance(given, Mapping) else [*given]
    for name, value in changes.items():
        if isinstance(value, Mapping):
            result += [f"{name}.{key}={_text(one)}" for key, one in value.items()]
        else:
            result.append(f"{name}={_text(value)}")
    return result


def settings(config: File | None = None, set: Overrides = (), **changes: Any) -> _jink.Settings:
    """The planner's parameters: the file `config`, unless told the shipped planner.yaml, with changes.

    A change is `horizon={"margin": 0.3}`, `**{"horizon.margin": 0.3}`, or in `set` as the command has it:
    `["horizon.margin=0.3"]`, or `{"horizon.margin": 0.3}`. Raises Error with the words of the command.
    """
    return _jink.Settings(None if config is None else os.fspath(config), _overrides(set, changes))


def whole(name: str, value: Any) -> int:
    """The value of the option of that name. Raises TypeError, or Error with the words of the command."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: expected a whole number, not {value!r}") from None
    return _jink.whole(f"--{name}", str(number))


def _word(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(f"{name}: expected text, not {value!r}")
    return value


def _threads(threads: int | None) -> int:
    return 0 if threads is None else whole("threads", threads)


@dataclasses.dataclass(frozen=True)
class PlanResult:
    """What `plan` gives. `summary` is the object of `jink plan --json`, `text` what the command prints."""

    summary: dict[str, Any]
    text: str = dataclasses.field(repr=False)
    plan: _jink.Plan = dataclasses.field(repr=False)

    @property
    def reached(self) -> bool:
        """Free, within the vehicle's limits, to the target: verified."""
        return bool(self.summary["outcome"] == "reached")

    @property
    def path(self) -> _jink.Path:
        return self.plan.path

    @property
    def front(self) -> NDArray[np.float64]:
        """n x 2: the first two objectives of the first front."""
        return self.plan.front


def plan(scenario: File | _jink.Scenario, mode: str = "horizon", seed: int = 1, *, threads: int | None = None,
         config: File | None = None, set: Overrides = (), algorithm: str = "pmomvo", slaves: int | None = None,
         sharing: int | None = None, population: int | None = None, iterations: int | None = None,
         waypoints: int | None = None, deadline_ms: float | None = None, **changes: Any) -> PlanResult:
    """Plans a scenario's whole path at once, open loop, as `jink plan` does: the same options, the same bits.

    `mode` is "horizon" (the remaining path at once) or "paper" (one waypoint after the other); `threads` unless told
    one for each core; `config`, `set` and further names as `settings` takes them; the others as configured unless told.
    Other threads run meanwhile. Raises Error with the words of the command.
    """
    options = _jink.PlanOptions()
    options.mode, options.algorithm = _word("mode", mode), _word("algorithm", algorithm)
    options.seed, options.threads = whole("seed", seed), _threads(threads)
    given = {"slaves": slaves, "sharing": sharing, "population": population, "iterations": iterations,
             "waypoints": waypoints}
    for name, value in given.items():
        if value is not None:
            setattr(options, name, whole(name, value))
    if deadline_ms is not None:
        options.deadline_ms = _jink.deadline_ms(_text(deadline_ms))
    parameters = settings(config, set, **changes)
    run = _jink.plan(_scenario(scenario), parameters, options)
    return PlanResult(json.loads(run.summary), run.text, run.plan)


def _scenario(scenario: File | _jink.Scenario) -> _jink.Scenario:
    return scenario if isinstance(scenario, _jink.Scenario) else _jink.Scenario(os.fspath(scenario))


@dataclasses.dataclass(frozen=True)
class FlightResult:
    """What `replay` of a scenario gives. `summary` is the object of `jink replay --json`.

    `t` (n, s) and `position`, `velocity` (vehicles x n x 3, ENU) are the true motion, 50 times a second; `events` are
    (t, name, detail) as in the flight log.
    """

    summary: dict[str, Any]
    text: str = dataclasses.field(repr=False)
    t: NDArray[np.float64] = dataclasses.field(repr=False)
    position: NDArray[np.float64] = dataclasses.field(repr=False)
    velocity: NDArray[np.float64] = dataclasses.field(repr=False)
    events: list[tuple[float, str, str]] = dataclasses.field(repr=False)

    @property
    def reached(self) -> bool:
        """The target, and nothing was hit."""
        return bool(self.summary["outcome"] == "reached")


@dataclasses.dataclass(frozen=True)
class RecordingResult:
    """What `replay` of a flight log gives. `summary` is the object of `jink replay --json`."""

    summary: dict[str, Any]
    text: str = dataclasses.field(repr=False)

    @property
    def same(self) -> bool:
        """No plan differs from the recorded one."""
        return bool(self.summary["differ"] == 0)


def replay(scenario: File | _jink.Scenario, seed: int | None = None, *, threads: int | None = None,
           config: File | None = None, set: Overrides = (), log: File | None = None, report: File | None = None,
           pilot: str = "jink", **changes: Any) -> FlightResult | RecordingResult:
    """Flies a scenario closed loop in virtual time, as `jink replay` does: the same options, the same bits.

    `seed` is 1 unless told; `log` and `report` are files to write; the others are as of `plan`. Given a flight log
    (.jsonl) it makes its plans again, with the log's seed and parameters unless told. Other threads run meanwhile, and
    Ctrl-C ends it. Raises Error with the words of the command.
    """
    pilot = _word("pilot", pilot)
    log_file, report_file = ("" if file is None else os.fspath(file) for file in (log, report))
    number = None if seed is None else whole("seed", seed)
    if not isinstance(scenario, _jink.Scenario) and os.fspath(scenario).endswith(".jsonl"):
        parameters_file = None if config is None else os.fspath(config)
        summary, text, _ = _jink.replay_log(os.fspath(scenario), number, _threads(threads), parameters_file,
                                            _overrides(set, changes), log_file, report_file, pilot)
        return RecordingResult(json.loads(summary), text)
    parameters = settings(config, set, **changes)
    flight = _jink.fly(_scenario(scenario), parameters, 1 if number is None else number, _threads(threads), log_file,
                       report_file, pilot)
    return FlightResult(json.loads(flight.summary), flight.text, flight.t, flight.position, flight.velocity,
                        flight.events)
