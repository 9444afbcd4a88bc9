#!/usr/bin/env bash
# Makes a release of what is built already and installs each of its files as a user would: checksums, source archive, program archive,
# Debian package in a fresh root, wheel in a fresh environment. Each makes the README's first crack; man pages and completions are parsed.
# Usage: tests/clients/release.sh PERIGRAIN [PYTHON]. The wheel is that of python.sh; what is not installed is skipped with a word.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
perigrain=$(realpath "$1")
python=${2:-python3}
files=$top/target/release-files
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for tool in git dpkg-deb python3 strip objdump; do
    command -v "$tool" >/dev/null || { echo "release: skipped, $tool is not installed"; exit 0; }
done
git -C "$top" rev-parse --verify --quiet HEAD >/dev/null || { echo "release: skipped, this is no git repository"; exit 0; }
fail() {
    echo "release: $1" >&2
    exit 1
}
crack() { # crack README COMMAND...: the first deck of a README, in an empty folder, must tear the plate and draw it
    local folder readme=$1
    shift
    folder=$(mktemp -d -p "$work")
    sed -n '/^```text$/,/^```$/p' "$readme" | sed '1d; /^```$/,$d' >"$folder/in.readme"
    (cd "$folder" && "$@" -in in.readme -log none >out) || fail "$1 fails with the README's deck"
    grep -q '^ *350 .* 0\.01475 ' "$folder/out" || fail "$1: the crack of the README has not come through"
    [ "$(head -c 4 "$folder/crack.png" | tail -c 3)" = PNG ] || fail "$1 has drawn no crack.png"
    echo "crack made by $1 ($("$1" -version))"
}
quiet() { # quiet COMMAND...: must succeed and print nothing
    local said
    said=$("$@" 2>&1 >/dev/null) && [ -z "$said" ] || fail "$*: $said"
}

wheel=$(ls "$top"/target/clients/wheel/*.whl 2>/dev/null || true)
"$top/release" --binary "$perigrain" --wheel "${wheel:-none}"
(cd "$files" && sha256sum --check --quiet SHA256SUMS)
version=$("$perigrain" -version | cut -d ' ' -f 2)

# The source archive has every file of the commit, the commit itself, and packages that cargo finds complete.
mkdir "$work/source"
tar -C "$work/source" -xzf "$files/perigrain-$version.tar.gz"
cd "$work/source/perigrain-$version"
diff <(git -C "$top" ls-tree -r --name-only HEAD | sort) <(find . -type f -printf '%P\n' | sort) || fail "the source archive is not complete"
quiet cargo metadata --offline --locked --format-version 1
rustc --edition 2024 -o "$work/build" build.rs
commit=$(git -C "$top" rev-parse HEAD)
found=$(PROFILE=release TARGET=none "$work/build" | sed -n 's/.*PERIGRAIN_COMMIT=\([^ ]*\) .*/\1/p')
[ -n "$found" ] && [[ $commit = "$found"* ]] || fail "a build of the source archive would not know its commit: '$found', not $commit"
crack README.md "$perigrain"

# The program archive, as below ~/.local.
mkdir "$work/local"
tar -C "$work/local" --strip-components=1 -xzf "$files/perigrain-$version"-*-*.tar.gz
crack "$work/local/share/doc/perigrain/README.md" "$work/local/bin/perigrain"
for page in "$work"/local/share/man/man1/*.1.gz; do
    gzip -d "$page"
    if command -v groff >/dev/null; then quiet groff -k -man -ww -Tutf8 -z "${page%.gz}"; fi
    if command -v man >/dev/null; then LC_ALL=C.UTF-8 MANWIDTH=80 quiet man --warnings -E UTF-8 -l "${page%.gz}"; fi
done
command -v groff >/dev/null || echo "man pages: not rendered, groff is not installed"
shells=(bash-completion/completions/perigrain zsh/site-functions/_perigrain fish/vendor_completions.d/perigrain.fish)
for file in "${shells[@]}"; do
    shell=${file%%[-/]*}
    if command -v "$shell" >/dev/null; then quiet "$shell" -n "$work/local/share/$file"; else echo "completions: not parsed, $shell is not installed"; fi
done
bash -c "source '$work/local/share/${shells[0]}' && complete -p perigrain" >/dev/null

# The Debian package, by dpkg into a root of its own; images of Debian leave out pages and licences otherwise.
root=$work/root
mkdir -p "$root/var/lib/dpkg/info" "$root/var/lib/dpkg/updates"
touch "$root/var/lib/dpkg/status"
dpkg --root="$root" --log=/dev/null --force-not-root --force-depends --path-include='/usr/share/*' -i "$files"/*.deb >"$work/dpkg.log" 2>&1 ||
    fail "dpkg refuses the package: $(cat "$work/dpkg.log")"
quiet dpkg --root="$root" --verify perigrain
[ -f "$root/usr/share/man/man1/perigrain.1.gz" ] && [ -f "$root/usr/share/doc/perigrain/copyright" ] || fail "the Debian package lacks files"
crack "$root/usr/share/doc/perigrain/README.md" "$root/usr/bin/perigrain"

# The wheel, with numpy of PYTHON; nothing is fetched.
if [ -z "$wheel" ] || ! "$python" -c 'import numpy' 2>/dev/null; then
    echo "wheel: skipped, numpy or the wheel of tests/clients/python.sh is missing"
    exit 0
fi
"$python" -m venv --without-pip "$work/venv"
fresh=$work/venv/bin
"$python" -c 'import numpy, pathlib; print(pathlib.Path(numpy.__file__).parents[1])' >"$("$fresh/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/others.pth"
"$python" -m pip --python "$fresh/python" install --quiet --disable-pip-version-check --no-index --no-deps --no-compile "$files"/*.whl
crack "$top/README.md" "$fresh/perigrain"
"$fresh/python" -c "import perigrain; assert perigrain.__version__ == '$version'"
