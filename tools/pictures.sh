#!/usr/bin/env bash
# Makes the documents' pictures, docs/images: a screenshot of the flight report, the figure of the same flight, PX4's hovers.
# The test check_pictures says when they are old.
set -euo pipefail
cd "$(dirname "$0")/.."
tools/setup.sh test
tools/build.sh release jink draw_px4_hovers
mkdir -p docs/images
.venv/bin/python tests/tools/report/check_pictures.py build/release/jink build/release/draw_px4_hovers --write docs/images
ls -l docs/images
