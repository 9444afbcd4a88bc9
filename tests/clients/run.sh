#!/usr/bin/env bash
# Lets ovito, vtk, pyvista, lammps-logfile, MDAnalysis and pandas, the newest there are, read what runs leave. Needs python3 and packages
# from PyPI; without them it says so and succeeds. Usage: tests/clients/run.sh [PATH OF perigrain | fetch]; `fetch` gets the packages, also those of
# python.sh and browser.py, and does no more.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$top/target/clients

skip() {
    echo "client programs: skipped, $1"
    exit 0
}

command -v python3 >/dev/null || skip "python3 is not installed"
mkdir -p "$work"
readers='import ovito, pyvista, vtk, lammps_logfile, MDAnalysis, pandas, yaml'
if ! "$work/venv/bin/python" -c "$readers, pytest, IPython, maturin, playwright" 2>/dev/null; then
    python3 -m venv "$work/venv" 2>/dev/null || skip "python3 has no venv"
    # Not compiled ahead: a fifth of these modules is ever imported.
    timeout 300 "$work/venv/bin/pip" install -q --no-compile --disable-pip-version-check --upgrade ovito pyvista vtk lammps-logfile MDAnalysis \
        pandas pyyaml pytest ipython maturin playwright axe-playwright-python \
        >"$work/pip.log" 2>&1 || skip "packages cannot be fetched (see $work/pip.log)"
    "$work/venv/bin/python" -c "$readers" 2>"$work/import.log" ||
        skip "the packages do not start here ($(tail -n 1 "$work/import.log"))"
fi

# For browser.py, where the system has none.
{ command -v chromium || command -v google-chrome; } >/dev/null || timeout 100 "$work/venv/bin/playwright" install --only-shell chromium >"$work/chromium.log" 2>&1 || true

perigrain=${1:-}
[ "$perigrain" != fetch ] || exit 0
if [ -z "$perigrain" ]; then
    (cd "$top" && cargo build --quiet --release)
    perigrain=$top/target/release/perigrain
fi
rm -rf "$work/run"
mkdir -p "$work/run"
cd "$work/run"
"$perigrain" -in "$top/tests/clients/in.clients" -log log.clients -screen none
timeout 300 "$work/venv/bin/python" "$top/tests/clients/read.py" "$perigrain" "$work/run"
