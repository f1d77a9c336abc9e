# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns of many runs as users call them, for `jink arena` and `jink study`."""

import os
import pathlib
import signal
import subprocess
import tempfile
import time

from flight import check


class Campaigns:
    """A command of jink, run in a scratch folder."""

    def __init__(self, program, command, folder):
        self.program = program
        self.command = command
        self.folder = folder

    def run(self, *arguments, seconds=500, environment=None):
        return subprocess.run([self.program, self.command, *map(str, arguments)], capture_output=True, text=True, timeout=seconds,
                              cwd=self.folder, env=environment)

    def make(self, out, *arguments, status=0):
        """What it says while it makes a campaign in the folder `out`."""
        done = self.run("--out", out, *arguments)
        check(done.returncode == status, f"{self.command} {out}: exit status {done.returncode} {done.stderr.strip()}")
        return done.stdout

    def interrupt(self, out, *arguments, file, lines, seconds=120):
        """The same, with Ctrl-C held down once the results file has so many lines: all of its process group get it."""
        process = subprocess.Popen([self.program, self.command, "--out", out, *map(str, arguments)], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, cwd=self.folder, start_new_session=True)
        results = self.folder / out / file
        end = time.monotonic() + seconds
        while time.monotonic() < end and not (results.exists() and results.read_bytes().count(b"\n") >= lines):
            time.sleep(0.05)
        end = time.monotonic() + seconds
        while time.monotonic() < end and process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
            time.sleep(0.1)
        if process.poll() is None:
            process.kill()
        output, errors = process.communicate()
        check(process.returncode == 1 and "--resume" in output and not errors, f"Ctrl-C: exit status {process.returncode} {errors.strip()}")
        return output

    def refuses(self, cases):
        """Bad usage, by arguments: each is refused in one line with these parts, and leaves nothing behind."""
        for arguments, parts in cases:
            refused(self.run(*arguments), parts)
        check(not list(self.folder.iterdir()), "nothing was left by any of these")
        for json in ("no/such/x.json", "."):
            refused(self.run("--out", "unwritten", "--json", json), ["--json", f"'{json}'"])
            check([path.name for path in self.folder.rglob("*")] == ["unwritten"], "said before anything is run")
        (self.folder / "unwritten").rmdir()


def refused(done, parts):
    lines = done.stderr.strip().splitlines()
    said = done.returncode == 2 and len(lines) == 1 and all(part in lines[0] for part in parts)
    check(said, f"status {done.returncode}: {done.stderr.strip()}")


def change_seed(file):
    """Makes a results file one of another seed."""
    text = file.read_text()
    check('"seed":1,' in text.splitlines()[0], f"{file.name} is of seed 1")
    file.write_text(text.replace('"seed":1,', '"seed":2,', 1))


def in_scratch(kind, program, command, cases):
    """Calls the cases, one after the other, with a `kind` of Campaigns in a folder that goes afterwards."""
    with tempfile.TemporaryDirectory(prefix=f"jink-{command}-") as name:
        campaigns = kind(pathlib.Path(program).resolve(), command, pathlib.Path(name))
        for case in cases:
            print(f"== {case.__name__}", flush=True)
            case(campaigns)
