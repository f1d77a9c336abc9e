# SPDX-License-Identifier: BSD-3-Clause
"""Real processes for the system tests: `jink sim`, `jink fly` and others, on ports and a DDS domain of their own."""

import contextlib
import io
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import yaml

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CONFIG = SOURCE / "config"


class Failed(Exception):
    """A check did not hold; its text says which."""


_thread = threading.local()


def say(text):
    """A line to standard output, or to where this thread's lines are kept."""
    print(text, flush=True, file=getattr(_thread, "kept", None) or sys.stdout)


@contextlib.contextmanager
def kept_lines():
    """What this thread says is kept instead of printed."""
    _thread.kept = io.StringIO()
    try:
        yield _thread.kept
    finally:
        _thread.kept = None


def check(holds, text):
    if not holds:
        raise Failed(text)
    say(f"ok   {text}")


class Arena:
    """A scratch folder, a MAVLink instance and a DDS domain; ends its processes when it is left, and removes the folder
    unless something failed."""

    def __init__(self, jink, instance):
        self.jink = jink
        self.instance = instance
        self.domain = 40 + instance
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="jink-system-"))
        self.processes = []

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.wait()
        if kind is not None:
            for text in sorted(self.folder.glob("*.txt")):
                say(f"--- {text.name}\n{text.read_text(errors='replace')[-6000:]}")
        else:
            shutil.rmtree(self.folder)

    def start(self, name, command, **options):
        """Starts a process whose output goes to NAME.txt."""
        with open(self.folder / f"{name}.txt", "w") as output:
            process = subprocess.Popen([str(part) for part in command], stdout=output, stderr=subprocess.STDOUT,
                                       **options)
        self.processes.append(process)
        return process

    def sim(self, scenario, *options):
        return self.start("sim", [self.jink, "sim", scenario, "--instance", self.instance, "--domain", self.domain,
                                  "--json", self.folder / "sim.json", "--log", self.folder / "sim.jsonl", *options])

    def fly(self, mission, *options):
        return self.start("fly", [self.jink, "fly", mission, "--json", self.folder / "fly.json",
                                  "--log", self.folder / "fly.jsonl", *options])

    def mission(self, base, **changes):
        """A copy of a shipped mission on this arena's port and domain."""
        mission = yaml.safe_load((CONFIG / "missions" / f"{base}.yaml").read_text())
        mission["connection"] = f"udpin://127.0.0.1:{14540 + self.instance}"
        mission["dds"] = {"domain": self.domain}
        mission.update(changes)
        file = self.folder / "mission.yaml"
        file.write_text(yaml.safe_dump(mission))
        return file

    def read(self, name):
        return json.loads((self.folder / name).read_text())

    def log(self, name, kind):
        """The records of one type of a flight log."""
        with open(self.folder / name) as lines:
            return [record for record in map(json.loads, lines) if record["type"] == kind]


def interrupt(process, seconds=20):
    """Ctrl-C; the exit status."""
    process.send_signal(signal.SIGINT)
    return process.wait(seconds)


def wait(process, seconds):
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        raise Failed(f"{process.args[1]} still runs after {seconds} s") from None


def wait_until(condition, seconds, text):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return
        time.sleep(0.05)
    raise Failed(f"waited {seconds} s in vain for {text}")


def main(test):
    try:
        test(*sys.argv[1:])
    except Failed as failure:
        print(f"FAIL {failure}", flush=True)
        sys.exit(1)
