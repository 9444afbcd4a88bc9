#!/usr/bin/env bash
# Tests the Python module as users get it: a wheel (wheel.sh), installed into a fresh environment, and pytest in crates/py/tests.
# Needs python3 with numpy, pytest and maturin; without them it says so and succeeds. Usage: tests/clients/python.sh [PYTHON]
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$top/target/clients
python=${1:-python3}

command -v "$python" >/dev/null || { echo "Python module: skipped, python3 is not installed"; exit 0; }
"$python" -c 'import numpy, pytest, maturin' 2>/dev/null || { echo "Python module: skipped, numpy, pytest or maturin is missing"; exit 0; }

wheel=$("$top/tests/clients/wheel.sh" "$python" "$work/wheel")
echo "$(basename "$wheel"): $(($(stat -c %s "$wheel") / 1000)) kB"
# perigrain is what the wheel brings there and nothing else; what it asks for, and pytest, are those of PYTHON. Nothing is fetched.
rm -rf "$work/fresh"
"$python" -m venv --without-pip "$work/fresh"
fresh=$work/fresh/bin/python
"$python" -c 'import numpy, pathlib; print(pathlib.Path(numpy.__file__).parents[1])' >"$("$fresh" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/others.pth"
"$python" -m pip --python "$fresh" install --quiet --disable-pip-version-check --no-index --no-compile "$wheel"
PYTHONDONTWRITEBYTECODE=1 "$fresh" -m pytest -q -p no:cacheprovider "$top/crates/py/tests"
