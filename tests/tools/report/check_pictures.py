#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The documents' pictures: a screenshot of the flight report, the figure of the same flight, and PX4's hovers.

check_pictures.py JINK DRAW               makes them with those programs and compares them with docs/images
check_pictures.py JINK DRAW --write DIR   makes them and writes them to DIR (tools/pictures.sh)

Exit 0: as committed; 1: one differs visibly, or is too large; 77: there is no browser here, the report was not looked at.
"""
import base64
import io
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageChops

import browser

ROOT = next(p for p in pathlib.Path(__file__).resolve().parents if (p / "config/scenarios").is_dir())
COMMITTED = ROOT / "docs/images"
SCENARIO = ROOT / "config/scenarios/crossing.yaml"
AT = 3.2  # s, the instant shown: the vehicle is among the obstacles
WIDTH, MOST_BYTES = 1200, 250_000
# Two pictures of one flight differ by the smoothing of their lines and letters alone. Both are scaled down until a
# letter is a grey pixel; what is left is counted. Measured: other hinting of the letters gives 0.35 and 0.01 %; another
# seed, or an instant 0.3 s later, gives 0.65 and 1.08 % at least.
SMALL, STEP = 150, 24  # pixels across, and the difference of a channel (of 255) from which on a pixel counts
MOST_MEAN, MOST_SHARE = 0.5, 0.003  # mean difference of a channel; share of the pixels that count


def fly(jink, folder):
    """A seeded flight in virtual time: its log, its report, its figure. The same bits on every machine."""
    log, page, figure, summary = (folder / f"crossing.{kind}" for kind in ("jsonl", "html", "png", "json"))
    for arguments in (["replay", SCENARIO, "--seed", "1", "--log", log, "--json", summary],
                      ["report", log, "--summary", summary, "--out", page],
                      ["report", log, "--at", str(AT), "--png", figure]):
        subprocess.run([jink, *arguments], check=True, stdout=subprocess.DEVNULL)
    return page, figure


def screenshot(page):
    with browser.Page(f"file://{page}#t={AT}", width=1360, height=704) as shown:
        png = shown.call("Page.captureScreenshot", format="png")["data"]
    return Image.open(io.BytesIO(base64.b64decode(png)))


def for_print(picture):
    """In the size of a committed picture, with a palette."""
    size = (WIDTH, round(picture.height * WIDTH / picture.width))
    small = picture.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    return small.quantize(256, Image.Quantize.MEDIANCUT, kmeans=2, dither=Image.Dither.NONE)


def difference(one, other):
    """Mean difference of a channel, and the share of pixels that differ by more than STEP; both of small copies."""
    if abs(one.height / one.width - other.height / other.width) > 0.01:
        return 255.0, 1.0
    size = (SMALL, round(SMALL * one.height / one.width))
    small = [p.convert("RGB").resize(size, Image.Resampling.BOX) for p in (one, other)]
    delta = ImageChops.difference(*small)
    values = delta.tobytes()
    pixels = [max(values[i:i + 3]) for i in range(0, len(values), 3)]
    return sum(values) / len(values), sum(p > STEP for p in pixels) / len(pixels)


def same(name, made):
    """Prints one line; true where the committed picture shows what was made."""
    file = COMMITTED / name
    mean, share = difference(Image.open(file), made)
    well = mean <= MOST_MEAN and share <= MOST_SHARE and file.stat().st_size <= MOST_BYTES
    print(f"{'ok  ' if well else 'FAIL'} {name}: mean difference {mean:.2f} (at most {MOST_MEAN}), {100 * share:.2f} % of"
          f" the pixels differ (at most {100 * MOST_SHARE} %), {file.stat().st_size} bytes (at most {MOST_BYTES})")
    return well


def main(arguments):
    writes = len(arguments) == 4 and arguments[2] == "--write"
    if len(arguments) != 2 and not writes:
        print(__doc__)
        return 2
    with tempfile.TemporaryDirectory() as name:
        page, figure = fly(arguments[0], pathlib.Path(name))
        subprocess.run([arguments[1], name], check=True)
        pictures = {"flight.png": for_print(Image.open(figure)), "px4.png": for_print(Image.open(f"{name}/px4.png"))}
        if browser.find():
            pictures["report.png"] = for_print(screenshot(page))
    if writes:
        if "report.png" not in pictures:
            print("check_pictures: a screenshot needs a browser: tools/setup.sh test", file=sys.stderr)
            return 1
        for name, picture in pictures.items():
            picture.save(pathlib.Path(arguments[3]) / name, optimize=True)
        return 0
    if not all([same(name, picture) for name, picture in pictures.items()]):
        print("the pictures are old: tools/pictures.sh makes them again; look at them before you commit them")
        return 1
    if "report.png" not in pictures:
        print("check_pictures: skipped report.png, there is no browser here")
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
