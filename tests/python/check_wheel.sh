#!/usr/bin/env bash
# Tries the wheels of tools/wheel.sh as a user has them: each in a fresh virtual environment, with what the tests need.
# The command that they are held against is build/release/jink, or JINK_PROGRAM.
#   tests/python/check_wheel.sh [PYTHON...]      /usr/bin/python3 unless told
set -euo pipefail
cd "$(dirname "$0")/../.."
[ $# -gt 0 ] || set -- /usr/bin/python3
venv=build/wheel/venv
for python in "$@"; do
  "$python" -m venv --clear $venv
  $venv/bin/pip install -q --disable-pip-version-check -r tests/python/requirements.txt
  $venv/bin/pip install -q --disable-pip-version-check --no-index --find-links build/wheel jink
  env -u JINK_CONFIG_DIR $venv/bin/python -m pytest -q -p no:cacheprovider tests/python
done
rm -rf $venv
