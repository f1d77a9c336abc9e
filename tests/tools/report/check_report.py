#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Opens flight reports in a browser without a screen, plays them, and looks at what is drawn.

check_report.py TEST_REPORT_BINARY   makes the reports with the test binary, then looks at them
check_report.py REPORT.html...       looks at these

Exit 0: all well; 1: not; 77: there is no Chromium here, nothing was checked (tools/test.sh installs one).
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import browser

LEAST_INK = 0.005  # share of the scene's pixels; the ground grid alone draws more
VEHICLE = (0, 114, 178)
PLAN = (0, 158, 115)


class Failed(Exception):
    """A check did not hold; its text says which."""


def check(holds, text):
    if not holds:
        raise Failed(text)


def open_page(page, fragment="", **size):
    return browser.Page(f"file://{os.path.abspath(page)}{fragment}", **size)


def look(page, wanted, fragment="", time=None, **size):
    """The page draws at least `wanted` of each kind, at that time, without an error."""
    with open_page(page, fragment, **size) as shown:
        drawn = shown.data("ready")
        check(not shown.errors, f"errors: {shown.errors}")
        for key, least in wanted.items():
            check(drawn[key] >= least, f"{key}: {drawn[key]} drawn, {least} expected")
        check(drawn["ink"] >= LEAST_INK, f"the scene is blank: ink {drawn['ink']}")
        check(time is None or abs(drawn["t"] - time) < 1e-6, f"shows t = {drawn['t']}, not {time}")
        wide = shown.value("document.documentElement.scrollWidth") - shown.value("window.innerWidth")
        check(wide <= 0, f"the page is {wide} pixels wider than its window")
    return drawn


def around(spot, reach):
    x, y = map(round, spot)
    return x - reach, y - reach, x + reach, y + reach


def play(page):
    """The play button plays: time runs, the vehicle moves along its way, and the picture with it."""
    with open_page(page, "#t=2") as shown:
        begin = shown.data("shown")
        before = shown.screenshot()
        check(before.count(VEHICLE, box=around(begin["vehicles"][0], 6)) >= 5, "no vehicle where it should be")
        check(before.count(PLAN, box=tuple(shown.box(".scene"))) >= 20, "no plan in its colour")
        shown.click("#play")
        shown.wait("JSON.parse(document.body.dataset.shown).playing")
        shown.wait("JSON.parse(document.body.dataset.shown).t > 3.5")
        shown.click("#play")
        shown.wait("!JSON.parse(document.body.dataset.shown).playing")
        end, after = shown.data("shown"), shown.screenshot()
        check(end["t"] > begin["t"] + 1.5, f"time does not run: {begin['t']} to {end['t']}")
        check(shown.data("shown")["t"] == end["t"], "time runs on after pause")
        (x0, y0), (x1, y1) = begin["vehicles"][0], end["vehicles"][0]
        check(abs(x1 - x0) + abs(y1 - y0) > 40, f"the vehicle stays at {x0:.0f}, {y0:.0f}")
        check(after.count(VEHICLE, box=around((x1, y1), 6)) >= 5, "the vehicle is not drawn where it moved to")
        check(after.differing(before, around((x1, y1), 6)) >= 5, "the picture stays as it was")
        slider = float(shown.value("document.getElementById('slider').value"))
        check(abs(slider - end["t"]) < 1e-3, f"the slider stays behind, at {slider}")
        check(not shown.errors, f"errors: {shown.errors}")
        # Dragging turns the scene, and the slider sets the time.
        shown.value("(() => { const s = document.getElementById('slider'); s.value = 8;"
                    " s.dispatchEvent(new Event('input')); })()")
        shown.wait("Math.abs(JSON.parse(document.body.dataset.shown).t - 8) < 1e-9")
        shown.value("document.querySelector('[data-view=top]').click()")
        shown.wait(f"Math.abs(JSON.parse(document.body.dataset.shown).vehicles[0][1] - {y1}) > 3")
    return {"t": [begin["t"], end["t"]], "vehicle": [begin["vehicles"][0], end["vehicles"][0]]}


def compare(page):
    """Two flights under one time: both are drawn, and playing moves both."""
    with open_page(page, "#t=1") as shown:
        check(shown.data("ready")["flights"] == 2, "does not show two flights")
        begin = shown.data("shown")["vehicles"]
        check(begin[1][0] - begin[0][0] > 300, f"the two do not stand side by side: {begin}")
        shown.click("#play")
        shown.wait("JSON.parse(document.body.dataset.shown).t > 2")
        end = shown.data("shown")["vehicles"]
        for k in (0, 1):
            check(abs(end[k][0] - begin[k][0]) + abs(end[k][1] - begin[k][1]) > 10, f"vehicle {k} stays")
        check(not shown.errors, f"errors: {shown.errors}")
    return {"vehicles": [begin, end]}


def attempt(name, action, *arguments, **options):
    """Prints one line; true where the action found nothing wrong."""
    try:
        print(f"ok   {name} {json.dumps(action(*arguments, **options))}", flush=True)
        return True
    except (Failed, RuntimeError, TimeoutError, ValueError) as failure:
        print(f"FAIL {name}: {failure}", flush=True)
        return False


def main(arguments):
    if not browser.find():
        print("check_report: skipped, there is no Chromium here")
        return 77
    if not arguments:
        print(__doc__)
        return 2
    if arguments[0].endswith(".html"):
        return 0 if all([attempt(page, look, page, {}) for page in arguments]) else 1
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([arguments[0], "--gtest_filter=FlightReport.TheKindsOfLogs"], check=True,
                       stdout=subprocess.DEVNULL, env={**os.environ, "JINK_REPORT_DIR": name})
        moving = {"vehicle": 1, "flown": 50, "whole": 50, "plan": 10, "plotted": 500, "tracks": 1}
        replay = {**moving, "obstacles": 2, "shapes": 2, "events": 3}
        results = [
            attempt("replay", look, folder / "replay.html", replay, "#t=3.2", 3.2),
            attempt("replay, narrow", look, folder / "replay.html", replay, "#t=3.2", 3.2, width=800),
            attempt("fly", look, folder / "fly.html", {**moving, "obstacles": 1, "events": 3}, "#t=6.5", 6.5),
            attempt("team", look, folder / "team.html", {"vehicle": 2, "flown": 60}, "#t=5", 5),
            attempt("empty", look, folder / "empty.html", {}),
            attempt("play", play, folder / "replay.html"),
            attempt("compare", compare, folder / "compare.html"),
            attempt("compare, narrow", look, folder / "compare.html", {"vehicle": 2}, width=800),
        ]
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
