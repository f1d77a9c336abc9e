#!/usr/bin/env bash
# Makes the README's pictures, docs/images: a screenshot of the flight report, and the figure of the same flight.
# The test check_pictures says when they are old.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh test
tools/build.sh release jink
mkdir -p docs/images
.venv/bin/python tests/tools/report/check_pictures.py build/release/jink --write docs/images
ls -l docs/images
