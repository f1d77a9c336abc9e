# SPDX-License-Identifier: BSD-3-Clause
"""`jink arena` and `jink study` on a cluster: each shard is a task of Dask's scheduler, which runs it again elsewhere
where a worker dies. Needs `distributed`; on the workers this package and the program jink.

    python -m jink.campaign --scheduler ADDRESS [--shards N] [--program FILE] arena|study [OPTION...]

The options are the command's. The results are those of one machine, but for wall times. A finished shard is kept in
OUT.parts until all are there: the same command goes on.
"""

from __future__ import annotations

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator

from ._jink import Error

RESULTS = {"arena": "flights.jsonl", "study": "runs.jsonl"}
OURS = ("--shard", "--merge", "--resume", "--write", "--json")  # options that are not a user's here


def _complaint(done: subprocess.CompletedProcess[str]) -> str:
    lines = done.stderr.strip().splitlines()
    return lines[-1].removeprefix("jink: ") if lines else f"exit code {done.returncode}"


def run_shard(program: str, command: list[str], shard: int, shards: int) -> dict[str, bytes]:
    """One shard, on a worker: what a merge needs of its folder, by name. Raises Error with the words of the command."""
    with tempfile.TemporaryDirectory(prefix="jink-shard-") as folder:
        words = [program, *command, "--shard", f"{shard}/{shards}", "--out", folder]
        if tied := shutil.which("setpriv"):  # whoever kills the worker ends its work
            words = [tied, "--pdeathsig", "KILL", *words]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Error(_complaint(done))
        place = pathlib.Path(folder)
        files = [place / RESULTS[command[0]], *(file for file in (place / "failed").rglob("*") if file.is_file())]
        return {str(file.relative_to(place)): file.read_bytes() for file in files}


def _keep(part: pathlib.Path, files: dict[str, bytes]) -> None:
    """The part's folder, which appears whole or not at all."""
    unfinished = part.with_suffix(".unfinished")
    shutil.rmtree(unfinished, ignore_errors=True)
    for name, content in files.items():
        (unfinished / name).parent.mkdir(parents=True, exist_ok=True)
        (unfinished / name).write_bytes(content)
    unfinished.rename(part)


def _run_missing(scheduler: str, program: str, command: list[str], parts: list[pathlib.Path]) -> Iterator[int]:
    """Runs the shards whose parts are not there; yields the number of each as it is."""
    import distributed

    with distributed.Client(scheduler) as client:
        missing = {client.submit(run_shard, program, command, k, len(parts), pure=False,
                                 key=f"{command[0]}-{k}-of-{len(parts)}-{client.id}"): k
                   for k, part in enumerate(parts, 1) if not part.exists()}
        try:
            for future, files in distributed.as_completed(list(missing), with_results=True):
                _keep(parts[missing[future] - 1], files)
                future.release()
                yield missing[future]
        finally:
            client.cancel(list(missing))  # of a campaign that ends early


def _option(options: list[str], name: str) -> str | None:
    """The value of --name VALUE or --name=VALUE."""
    for word, following in zip(options, [*options[1:], ""]):
        if word == name:
            return following
        if word.startswith(name + "="):
            return word.partition("=")[2]
    return None


def _without(options: list[str], name: str) -> list[str]:
    value = _option(options, name)
    if value is None:
        return options
    at = next(i for i, word in enumerate(options) if word.partition("=")[0] == name)
    return options[:at] + options[at + (1 if "=" in options[at] else 2):]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m jink.campaign", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scheduler", required=True, help="address of Dask's scheduler, as tcp://host:8786")
    parser.add_argument("--shards", type=int, default=64, help="tasks that the campaign is cut into (default: 64)")
    parser.add_argument("--program", default="jink", help="the program on the workers and here (default: jink)")
    parser.add_argument("command", choices=sorted(RESULTS))
    parser.add_argument("options", nargs=argparse.REMAINDER, help="the command's; --threads is 1 unless given")
    given = parser.parse_args(arguments)
    for name in OURS:
        if any(word.partition("=")[0] == name for word in given.options):
            parser.error(f"{name}: is not for a campaign on a cluster")
    if given.shards < 1:
        parser.error(f"--shards: Value {given.shards} is not at least 1")
    out = pathlib.Path(_option(given.options, "--out") or given.command)
    command = [given.command, *_without(given.options, "--out")]
    if _option(command, "--threads") is None:
        command += ["--threads", "1"]  # a worker runs as many tasks at once as it has threads
    folder = out.with_name(out.name + ".parts")
    folder.mkdir(parents=True, exist_ok=True)
    parts = [folder / f"{k}-of-{given.shards}" for k in range(1, given.shards + 1)]
    try:
        for shard in _run_missing(given.scheduler, given.program, command, parts):
            print(f"shard {shard}: {sum(part.exists() for part in parts)} of {len(parts)} done", flush=True)
    except Error as error:
        print(f"jink: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted: the same command goes on", file=sys.stderr)
        return 1
    merged = subprocess.run([given.program, given.command, "--merge", *map(str, parts), "--out", str(out)], check=False)
    if merged.returncode == 0:
        shutil.rmtree(folder)
    return merged.returncode


if __name__ == "__main__":
    sys.exit(main())
