#!/usr/bin/env python3
"""Prints the licences of all that the program is linked from, as a binary package has to carry them. Usage: licences.py TARGET"""

import json
import subprocess
import sys
from pathlib import Path


def linked(metadata):
    """The packages that the program is built of, without what only builds or tests need."""
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    macros = {p["id"] for p in metadata["packages"] if any("proc-macro" in t["kind"] for t in p["targets"])}
    found, left = set(), [metadata["resolve"]["root"]]
    while left:
        package = left.pop()
        if package not in found | macros:
            found.add(package)
            left += [dep["pkg"] for dep in nodes[package]["deps"] if any(kind["kind"] is None for kind in dep["dep_kinds"])]
    return [p for p in metadata["packages"] if p["id"] in found and p["source"]]


def main(target):
    command = ["cargo", "metadata", "--format-version", "1", "--locked", "--filter-platform", target]
    metadata = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    texts = {}
    for package in sorted(linked(metadata), key=lambda p: p["name"]):
        folder = Path(package["manifest_path"]).parent
        files = [f for f in sorted(folder.iterdir()) if f.is_file() and f.name.upper().startswith(("LICEN", "COPYING", "NOTICE"))]
        print(f"{package['name']} {package['version']}: {package['license']}")
        for file in files:
            text = file.read_text(encoding="utf-8", errors="replace").strip()
            texts.setdefault(text, []).append(f"{package['name']} {file.name}")
    uplot = Path(metadata["workspace_root"]) / "src/report/web/uplot/LICENSE"
    print("uPlot (in the pages of runs): MIT")
    texts.setdefault(uplot.read_text().strip(), []).append("uPlot")
    for text, names in texts.items():
        print(f"\n{'=' * 80}\n{', '.join(names)}\n\n{text}")


main(sys.argv[1])
