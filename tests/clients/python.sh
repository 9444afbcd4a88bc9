#!/usr/bin/env bash
# Tests the Python module: pytest in crates/py/tests, with the module built from what `cargo test` has built already.
# Needs python3 with numpy and pytest; without them it says so and succeeds. Usage: tests/clients/python.sh [PYTHON]
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$top/target/clients
python=${1:-python3}

command -v "$python" >/dev/null || { echo "Python module: skipped, python3 is not installed"; exit 0; }
"$python" -c 'import numpy, pytest' 2>/dev/null || { echo "Python module: skipped, numpy or pytest is missing"; exit 0; }

# The profile and the features of `cargo test`: nothing below crates/py is built again. As maturin does, no libpython is linked.
(cd "$top" && PYO3_BUILD_EXTENSION_MODULE=1 PYO3_NO_PYTHON=1 cargo build --quiet -p perigrain-py --lib --tests)
rm -rf "$work/python"
mkdir -p "$work/python"
cp -r "$top/crates/py/python/perigrain" "$work/python/"
cp "${CARGO_TARGET_DIR:-$top/target}/debug/lib_core.so" "$work/python/perigrain/_core.abi3.so"
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$work/python "$python" -m pytest -q -p no:cacheprovider "$top/crates/py/tests"
