#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the documents (*.md) to the tree: every path that one names exists, every relative link leads somewhere, and no
line is longer than 100 characters. Needs Python alone.

check_documents.py [ROOT]     exit 0: all well; 1: one line for each fault
"""
import pathlib
import re
import sys

MOST = 100  # characters in a line
FOLDERS = ("planner", "config", "bridge", "sim", "tools", "tests", "docs", "cmake", "examples", ".ci")
PATH = re.compile(r"[\w.*-]+(?:/[\w.*-]+)*/?")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)|(?:src|href)=\"([^\"]+)\"")


def documents(root):
    skipped = ("build", "out", ".venv")
    return sorted(p for p in root.rglob("*.md") if p.relative_to(root).parts[0] not in skipped)


def exists(root, path):
    """A file or folder; without an ending, the files of that name; with a *, any."""
    path = path.rstrip("/.")
    return (root / path).exists() or any(root.glob(path)) or any(root.glob(path + ".*"))


def paths(text):
    """The words of a piece of code that are paths of the tree."""
    for word in re.split(r"[\s,;:='\"()\[\]{}|<>]+", text):
        match = PATH.fullmatch(word)
        if match and "/" in word and word.split("/")[0] in FOLDERS:
            yield word


def anchor(heading):
    """As GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def check(root, document):
    """Faults as (line, text)."""
    lines = document.read_text(encoding="utf-8").split("\n")
    fenced = False
    for number, line in enumerate(lines, 1):
        if len(line) > MOST:
            yield number, f"{len(line)} characters, at most {MOST}"
        if line.lstrip().startswith("```"):
            fenced = not fenced
            continue
        code = [line] if fenced else re.findall(r"`([^`]+)`", line)
        for path in (p for piece in code for p in paths(piece)):
            if not exists(root, path):
                yield number, f"there is no {path}"
        for link in ("".join(groups) for groups in LINK.findall("" if fenced else line)):
            if re.match(r"[a-z]+:", link):
                continue
            name, _, place = link.partition("#")
            target = (document.parent / name).resolve() if name else document
            if not target.exists():
                yield number, f"the link {link} leads nowhere"
            elif place and target.suffix == ".md":
                headings = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
                if place not in map(anchor, headings):
                    yield number, f"{name or document.name} has no heading #{place}"


def main(arguments):
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).resolve().parents[2]).resolve()
    found = documents(root)
    faults = [f"{d.relative_to(root)}:{number}: {text}" for d in found for number, text in check(root, d)]
    print("\n".join(faults) or f"{len(found)} documents: paths, links and lines are right")
    return 1 if faults or not found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
