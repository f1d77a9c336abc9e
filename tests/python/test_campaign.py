# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns on a cluster: of Dask with two workers here, of which one is killed half-way; and of Slurm, by a stand-in."""

import json
import os
import signal
import subprocess
import sys

import distributed
import pytest
from conftest import SOURCE

FLIGHTS = ["arena", "--families", "crossing", "--tiers", "perfect", "--pilots", "jink", "--runs", "12", "--oracle", "off"]


@pytest.fixture(scope="module")
def cluster():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50) as local:
        yield local


def campaign(cluster, command, *words):
    return subprocess.Popen([sys.executable, "-m", "jink.campaign", "--scheduler", cluster.scheduler_address, "--program",
                             str(command.program), *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def results(folder):
    """All but wall times, which are another machine's."""
    lines = [json.loads(line) for line in (folder / "flights.jsonl").read_text().splitlines()]
    for line in lines:
        line.pop("measured", None)
    return lines


def test_the_results_are_one_machines_though_a_worker_is_killed(cluster, command, tmp_path):
    running = campaign(cluster, command, "--shards", 12, *FLIGHTS, "--out", tmp_path / "many")
    for _ in range(3):
        assert " of 12 done" in running.stdout.readline()
    with distributed.Client(cluster) as client:
        pids = client.run(os.getpid)
        os.kill(next(iter(pids.values())), signal.SIGKILL)
        said, errors = running.communicate(timeout=240)
        assert set(client.run(os.getpid).values()) != set(pids.values())
    assert running.returncode == 0, errors
    assert said.count(" of 12 done") == 9 and not (tmp_path / "many.parts").exists()
    assert command.run(*FLIGHTS, "--out", tmp_path / "one").returncode == 0
    assert results(tmp_path / "many") == results(tmp_path / "one")


def test_goes_on_with_the_parts_that_are_there(cluster, command, tmp_path):
    words = ["--shards", 12, *FLIGHTS, "--out", tmp_path / "out"]  # most of them are still to come after the first
    first = campaign(cluster, command, *words)
    first.stdout.readline()
    first.send_signal(signal.SIGINT)
    assert "the same command goes on" in first.communicate(timeout=60)[1] and first.returncode == 1
    there = len([part for part in (tmp_path / "out.parts").iterdir() if part.suffix != ".unfinished"])
    assert 1 <= there < 12
    again = campaign(cluster, command, *words)
    said, errors = again.communicate(timeout=120)
    assert again.returncode == 0, errors
    assert said.count(" of 12 done") == 12 - there and len(results(tmp_path / "out")) == 13


@pytest.mark.parametrize(("words", "says"), [
    (["arena", "--families", "nowhere"], "jink: --families: 'nowhere' is not one of"),
    (["arena", "--shard", "1/2"], "--shard: is not for a campaign on a cluster"),
    (["--shards", "0", "arena"], "--shards: Value 0 is not at least 1"),
])
def test_says_what_is_wrong(cluster, command, tmp_path, words, says):
    running = campaign(cluster, command, *words, "--out", tmp_path / "out")
    _, errors = running.communicate(timeout=60)
    assert running.returncode == 2 and says in errors


SBATCH = """#!/usr/bin/env bash
# What sbatch does with tools/slurm.sh, here and at once.
array=1; merge=${JINK_SLURM_MERGE:-}
while [[ $1 == --* ]]; do case $1 in --array=*) array=${1#--array=1-};; esac; shift; done
if [ -n "$merge" ]; then exec "$@"; fi
for k in $(seq "$array"); do SLURM_ARRAY_TASK_ID=$k "$@" >&2 || exit 1; done
echo 7
"""


def test_a_job_array_gives_one_machines_results(command, tmp_path):
    stand_in = tmp_path / "sbatch"
    stand_in.write_text(SBATCH)
    stand_in.chmod(0o755)
    environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}", "JINK_PROGRAM": str(command.program.resolve())}
    flights = [*FLIGHTS[:-4], "--runs", "3", "--oracle", "off"]
    submit = [SOURCE / "tools/slurm.sh", "many", "2", *flights]
    done = subprocess.run(submit, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert command.run(*flights, "--out", tmp_path / "one").returncode == 0
    assert results(tmp_path / "many") == results(tmp_path / "one")
    requeued = environment | {"SLURM_ARRAY_TASK_ID": "2"}
    subprocess.run(submit, cwd=tmp_path, env=requeued, capture_output=True, timeout=120, check=True)  # it is done already
