"""The contents of the wheel: files, metadata, and stubs that match the compiled part."""

import ast
import importlib.metadata
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import perigrain
from perigrain import _core

STUBS = Path(perigrain.__file__).with_name("_core.pyi")


def test_files_and_metadata():
    try:
        wheel = importlib.metadata.distribution("perigrain")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("it is not installed")
    assert wheel.version == perigrain.__version__ == _core.VERSION
    metadata = wheel.metadata
    assert metadata["Requires-Python"] == ">=3.9" and metadata.get_all("Requires-Dist") == ["numpy"]
    assert metadata["License-Expression"] == "MIT OR Apache-2.0" and "fracture" in metadata["Summary"]
    assert metadata["Description-Content-Type"].startswith("text/markdown") and "perigrain" in metadata.get_payload()
    files = {str(f) for f in wheel.files or []}
    assert {"perigrain/__init__.py", "perigrain/__main__.py", "perigrain/py.typed", "perigrain/_core.pyi"} <= files
    assert [f for f in files if f.startswith("perigrain/_core.") and ".abi3." in f]
    assert {Path(f).name for f in files if ".dist-info/licenses/" in f} == {"LICENSE-MIT", "LICENSE-APACHE"}
    assert not [f for f in files if "test" in f]
    commands = {entry.name: entry.value for entry in wheel.entry_points if entry.group == "console_scripts"}
    assert commands == {"perigrain": "perigrain.__main__:main"}
    script = Path(sys.executable).with_name("perigrain")
    if script.exists():
        ended = subprocess.run([str(script), "-version"], capture_output=True, text=True)
        assert ended.returncode == 0 and perigrain.__version__ in ended.stdout
    assert "cp39-abi3" in (wheel.read_text("WHEEL") or "")
    # the imported package is the installed one
    assert Path(perigrain.__file__).resolve() == Path(str(wheel.locate_file("perigrain/__init__.py"))).resolve()


def _words(function):
    return [a.arg for a in function.args.posonlyargs + function.args.args]


def test_stubs_declare_what_there_is():
    tree = ast.parse(STUBS.read_text())
    declared = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    public = {name for name in vars(_core) if not name.startswith("_")} - {"VERSION"}
    assert set(declared) == public
    for name, node in declared.items():
        there = getattr(_core, name)
        if isinstance(node, ast.FunctionDef):
            assert _words(node) == list(inspect.signature(there).parameters), name
            continue
        methods = {part.name: part for part in node.body if isinstance(part, ast.FunctionDef)}
        own = {part for part in vars(there) if not part.startswith("_")}
        assert {part for part in methods if not part.startswith("_")} == own, name
        for part in own & set(methods):
            if not any(isinstance(d, ast.Name) and d.id == "property" for d in methods[part].decorator_list):
                assert _words(methods[part]) == list(inspect.signature(getattr(there, part)).parameters), (name, part)
