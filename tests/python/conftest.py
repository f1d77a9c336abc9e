# SPDX-License-Identifier: BSD-3-Clause
"""What the tests share: the command, which says what the package must say too."""

import json
import os
import pathlib
import subprocess

import pytest

import jink

SOURCE = pathlib.Path(__file__).resolve().parents[2]
WALL_TIMES = ("planning_time_s",)


class Command:
    """The program jink of the build folder, or of JINK_PROGRAM."""

    program = pathlib.Path(os.environ.get("JINK_PROGRAM", SOURCE / "build/release/jink"))

    def run(self, *words):
        return subprocess.run([str(word) for word in (self.program, *words)], capture_output=True, text=True, timeout=300,
                              check=False)

    def summary(self, *words):
        """The object of --json."""
        return json.loads(self.run(*words, "--json", "-").stdout)

    def error(self, *words):
        """The words of its error, without what it adds of --help."""
        done = self.run(*words)
        assert done.returncode == 2, done
        return done.stderr.removeprefix("jink: ").partition(" (see `jink ")[0].rstrip("\n")


@pytest.fixture(scope="session")
def command():
    assert Command.program.exists(), f"{Command.program}: tools/build.sh release jink makes it"
    return Command()


@pytest.fixture
def scenario():
    """The path of a shipped scenario."""
    return lambda name: jink.config_folder() / "scenarios" / f"{name}.yaml"


@pytest.fixture(scope="session")
def arena(command, tmp_path_factory):
    out = tmp_path_factory.mktemp("arena")
    done = command.run("arena", "--runs", 2, "--families", "crossing", "--tiers", "perfect", "--pilots", "jink,straight",
                       "--oracle", "off", "--out", out)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="session")
def study(command, tmp_path_factory):
    out = tmp_path_factory.mktemp("study")
    done = command.run("study", "--quick", "--runs", 1, "--set", "optimizer.iterations=5", "--set", "optimizer.population=24",
                       "--out", out)
    assert done.returncode == 0, done.stderr
    return out


def without_wall_times(summary):
    return {key: value for key, value in summary.items() if key not in WALL_TIMES}
