#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens flight reports in a browser without a screen and checks that something is drawn and no error is printed.

check_report.py TEST_REPORT_BINARY   makes the reports with the test binary, then looks at them
check_report.py REPORT.html...       looks at these

Exit 0: all well; 1: not; 77: no /usr/bin/chromium here, nothing was checked.
"""
import html
import json
import os
import re
import subprocess
import sys
import tempfile

CHROMIUM = "/usr/bin/chromium"
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--enable-logging=stderr",
         "--window-size=1400,1000", "--virtual-time-budget=2000", "--dump-dom"]
LEAST_INK = 0.005  # share of the scene's pixels; the ground grid alone draws more


def look(page, fragment):
    """What the page says it drew, and the browser's console errors."""
    with tempfile.TemporaryDirectory() as profile:
        address = f"file://{os.path.abspath(page)}{fragment}"
        done = subprocess.run([CHROMIUM, *FLAGS, f"--user-data-dir={profile}", address], capture_output=True, text=True,
                              timeout=60, check=False)
    errors = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    found = re.search(r'data-ready="([^"]*)"', done.stdout)
    return (json.loads(html.unescape(found.group(1))) if found else None), errors


def check(page, wanted, fragment="", time=None):
    """Prints one line; true where the page drew at least `wanted` of each kind."""
    drawn, errors = look(page, fragment)
    faults = list(errors)
    if drawn is None:
        faults.append("the page never got ready")
    else:
        faults += [f"{key}: {drawn[key]} drawn, {least} expected" for key, least in wanted.items()
                   if drawn[key] < least]
        if drawn["ink"] < LEAST_INK:
            faults.append(f"the scene is blank: ink {drawn['ink']}")
        if time is not None and abs(drawn["t"] - time) > 1e-6:
            faults.append(f"shows t = {drawn['t']}, not {time}")
    print(f"{os.path.basename(page)}{fragment}: {'; '.join(faults) if faults else 'ok'} {json.dumps(drawn)}")
    return not faults


def main(arguments):
    if not os.path.exists(CHROMIUM):
        print(f"check_report: skipped, there is no {CHROMIUM}")
        return 77
    if not arguments:
        print(__doc__)
        return 2
    if arguments[0].endswith(".html"):
        return 0 if all([check(page, {}) for page in arguments]) else 1
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([arguments[0], "--gtest_filter=FlightReport.TheTwoKindsOfLogs"], check=True,
                       stdout=subprocess.DEVNULL, env={**os.environ, "JINK_REPORT_DIR": folder})
        moving = {"vehicle": 1, "flown": 50, "whole": 50, "plan": 10, "plotted": 500, "tracks": 1}
        results = [
            check(f"{folder}/replay.html", {**moving, "obstacles": 2, "events": 3}, "#t=3.2", 3.2),
            check(f"{folder}/fly.html", {**moving, "obstacles": 1, "events": 3}, "#t=6.5", 6.5),
            check(f"{folder}/empty.html", {}),
        ]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
