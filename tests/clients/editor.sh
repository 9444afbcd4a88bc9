#!/usr/bin/env bash
# Neovim with the settings of docs/editor: `perigrain lsp` checks, completes, explains, renames and lays out a deck there. Without Neovim 0.11
# it says so and succeeds. Usage: tests/clients/editor.sh [PATH OF perigrain]
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)

skip() {
    echo "editor: skipped, $1"
    exit 0
}

command -v nvim >/dev/null || skip "nvim is not installed"
nvim --clean --headless -c 'lua os.exit(vim.lsp.config and 0 or 1)' 2>/dev/null || skip "nvim is older than 0.11"
PERIGRAIN=${1:-$top/target/debug/perigrain}
export PERIGRAIN
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
printf 'variable speed equal 2 # größe 𝕏\npair_sytle  zero 1.0\nprint "${speed}"\n' >in.plate
XDG_STATE_HOME=$work timeout 60 nvim --clean --headless -n -c "luafile $top/docs/editor/perigrain.lua" \
    -c "luafile $top/tests/clients/editor.lua"
