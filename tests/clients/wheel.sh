#!/usr/bin/env bash
# Makes a wheel of the Python module of what `cargo test` has built: maturin packs it as `pip wheel .` does, but nothing below crates/py
# is built again. Prints the wheel's path. Usage: tests/clients/wheel.sh PYTHON FOLDER
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
python=$1 folder=$2

# maturin asks cargo for the library alone, and cargo would then leave out what tests ask of the crates below and build them anew.
tools=$(mktemp -d)
trap 'rm -rf "$tools"' EXIT
cat >"$tools/cargo" <<END
#!/usr/bin/env bash
if [ "\${1:-}" = rustc ]; then
    shift
    set -- rustc --tests "\$@"
fi
exec "$(command -v cargo)" "\$@"
END
chmod +x "$tools/cargo"
rm -rf "$folder"
(cd "$top" && PATH="$tools:$PATH" "$python" -m maturin build --quiet --interpreter "$python" --profile dev --strip false --compression-level 1 --out "$folder") >&2
ls "$folder"/*.whl
