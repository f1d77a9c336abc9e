# SPDX-License-Identifier: BSD-3-Clause
"""The progress line: rewritten and cut to the width of a terminal, a line now and then elsewhere; a terminal that nobody
reads holds nothing up.

test_live_line.py JINK INSTANCE
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

import flight
from flight import CONFIG, Arena, check

COLUMNS = 72
LIVE = re.compile(r"\[ *\d+\.\d s\].*")


class Terminal:
    """A process on a terminal of its own, COLUMNS wide."""

    def __init__(self, arena, command):
        self.own, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
        self.process = subprocess.Popen([str(part) for part in command], stdin=theirs, stdout=theirs, stderr=theirs)
        arena.processes.append(self.process)
        os.close(theirs)
        self.text = ""

    def read(self, seconds, until=lambda text: False):
        """What it writes for so long, or until it ends or `until` holds; all of it so far."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until(self.text):
            if not select.select([self.own], [], [], 0.1)[0]:
                continue
            try:
                piece = os.read(self.own, 65536)
            except OSError:  # it has ended
                break
            self.text += piece.decode()
        return self.text

    def live(self):
        """The texts that were written over each other."""
        return [part.split("\r")[0].split("\n")[0] for part in self.text.split("\r\x1b[K")[1:] if LIVE.match(part)]


def check_rewritten(terminal, name):
    lines = terminal.live()
    check(len(lines) >= 2, f"{name} rewrites its line on a terminal ({len(lines)} times)")
    check(max(map(len, lines)) < COLUMNS, f"and keeps it within the terminal's width ({max(map(len, lines))})")
    return lines


def replay_tells(arena):
    """On a terminal how far it is; in a file the result alone while it is short."""
    command = [arena.jink, "replay", CONFIG / "scenarios" / "crossing.yaml", "--set", "horizon.generations=3000"]
    terminal = Terminal(arena, command)
    terminal.read(300)
    lines = check_rewritten(terminal, "replay")
    flying = [line for line in lines if " % " in line]
    shares = [int(re.search(r"(\d+) %", line).group(1)) for line in flying]
    check(len(shares) > 1 and shares[-1] > shares[0], f"progress rises: {shares[0]} to {shares[-1]} %")
    words = ("offboard|hold", "m to go", "nearest|nothing near")
    check(all(re.search(word, line) for word in words for line in flying[1:]), f"mode, way, nearest: {lines[-1]}")
    check("reached (target reached)" in terminal.text, "and ends with the result")
    piped = subprocess.run([str(part) for part in command[:3]], capture_output=True, text=True, check=True)
    check("\x1b" not in piped.stdout and "\r" not in piped.stdout, "no control characters where there is no terminal")


def sim_and_fly_tell(arena):
    """Both on terminals, flying: then a stale input, once the simulator has gone."""
    mission = arena.mission("sitl")
    sim = Terminal(arena, [arena.jink, "sim", CONFIG / "scenarios" / "crossing.yaml", "--instance", arena.instance,
                           "--domain", arena.domain])
    fly = Terminal(arena, [arena.jink, "fly", mission])
    fly.read(90, lambda text: " % " in text and "nearest" in text)
    sim.read(2)
    check_rewritten(sim, "sim")
    lines = check_rewritten(fly, "fly")
    check(any(" % " in line and "m to go" in line for line in lines), f"fly tells the progress: {lines[-1]}")
    sim.process.send_signal(signal.SIGKILL)
    fly.read(20, lambda text: " s old" in text)
    check(" s old" in fly.text, "fly tells what has become stale")
    fly.process.send_signal(signal.SIGINT)
    fly.read(30)
    check(fly.process.wait(30) != 0, "and ends at Ctrl-C")


def plain_lines_elsewhere(arena):
    fly = arena.fly(arena.mission("sitl"))
    text = arena.folder / "fly.txt"
    flight.wait_until(lambda: text.read_text().count("! no autopilot yet") >= 2, 30, "two plain lines")
    flight.interrupt(fly)
    check("\r" not in text.read_text() and "\x1b" not in text.read_text(), "plain lines where there is no terminal")


def unread_terminal(arena):
    """A terminal that nobody reads is full after some kilobytes: the simulator's clock runs on."""
    sim = Terminal(arena, [arena.jink, "sim", CONFIG / "scenarios" / "crossing.yaml", "--instance", arena.instance,
                           "--domain", arena.domain, "--clock", "immediate", "--speed", "20", "--log",
                           arena.folder / "sim.jsonl"])
    log = arena.folder / "sim.jsonl"

    def reached():
        with open(log, "rb") as file:
            file.seek(max(0, log.stat().st_size - 4000))
            times = [float(t) for t in re.findall(rb'"t":([0-9.]+)', file.read())]
        return bool(times) and times[-1] > 100  # 500 progress lines of 70 characters: more than a terminal holds
    flight.wait_until(lambda: log.exists() and reached(), 240, "100 simulated seconds")
    check(True, "a terminal that nobody reads holds nothing up")
    sim.process.kill()


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        replay_tells(arena)
        plain_lines_elsewhere(arena)
        sim_and_fly_tell(arena)
        unread_terminal(arena)


if __name__ == "__main__":
    flight.main(test)
