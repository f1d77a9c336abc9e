# SPDX-License-Identifier: BSD-3-Clause
"""What `jink arena` and `jink study` leave in their folders, as pandas frames. Numbers have the same bits."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
import pathlib
from typing import TYPE_CHECKING, Any

from ._jink import Error
from .runs import File

if TYPE_CHECKING:
    import pandas as pd


def _column(cells: tuple[str, ...]) -> list[Any]:
    """Whole numbers, numbers where all cells are some or empty, or text: what is empty is NaN or None."""
    try:
        return [int(cell) for cell in cells]
    except ValueError:
        pass
    try:
        return [float(cell or "nan") for cell in cells]
    except ValueError:
        return [cell or None for cell in cells]


def _csv(file: pathlib.Path) -> pd.DataFrame:
    import pandas as pd  # what else the package does needs none

    with file.open(newline="", encoding="utf-8") as text:
        head, *rows = csv.reader(text)
    return pd.DataFrame({name: _column(tuple(row[i] for row in rows)) for i, name in enumerate(head)})


def _lines(file: pathlib.Path, format: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """The header and the further lines of a results file; a last line that was cut off does not count."""
    text = file.read_text(encoding="utf-8")
    objects = []
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        if not line.endswith("\n"):
            break
        try:
            objects.append(json.loads(line))
        except json.JSONDecodeError as error:
            raise Error(f"{file}:{number}: {error}") from None
    if not objects or objects[0].get("format") != format:
        raise Error(f"{file}: is not a results file of format {format}")
    return objects[0], objects[1:]


@dataclasses.dataclass(frozen=True)
class ArenaResults:
    """`flights`: one row each; `table`: one for each family, tier and pilot, and for all families; `settings`."""

    flights: pd.DataFrame = dataclasses.field(repr=False)
    table: pd.DataFrame = dataclasses.field(repr=False)
    settings: dict[str, Any]


def read_arena(folder: File) -> ArenaResults:
    """Reads what `jink arena --out FOLDER` wrote; needs pandas. The columns are those of flights.csv and table.csv.

    Raises Error for a folder of another format, OSError where a file is missing.
    """
    place = pathlib.Path(os.fspath(folder))
    header, _ = _lines(place / "flights.jsonl", "jink-arena-results/1")
    return ArenaResults(_csv(place / "flights.csv"), _csv(place / "table.csv"), header)


@dataclasses.dataclass(frozen=True)
class StudyResults:
    """`runs`: one row each; `tables`: by name, as "table06" or "claims"; `settings`, and the machines that ran it."""

    runs: pd.DataFrame = dataclasses.field(repr=False)
    tables: dict[str, pd.DataFrame] = dataclasses.field(repr=False)
    settings: dict[str, Any]
    machines: list[dict[str, Any]] = dataclasses.field(repr=False)


def read_study(folder: File) -> StudyResults:
    """Reads what `jink study --out FOLDER` wrote; needs pandas.

    A run's values, series (lists) and times (`measured`) are columns beside its settings, empty where it has none.
    Raises Error for a folder of another format, OSError where a file is missing.
    """
    import pandas as pd

    place = pathlib.Path(os.fspath(folder))
    header, lines = _lines(place / "runs.jsonl", "jink-study-results/1")
    parts = ("values", "series", "measured")
    rows = []
    for line in lines:
        if line["type"] == "run":
            row = {key: value for key, value in line.items() if key not in ("type", *parts)}
            rows.append(row | {key: value for part in parts for key, value in line.get(part, {}).items()})
    tables = {file.stem: _csv(file) for file in sorted(place.glob("*.csv"))}
    machines = [line for line in lines if line["type"] == "machine"]
    return StudyResults(pd.DataFrame(rows), tables, header, machines)
