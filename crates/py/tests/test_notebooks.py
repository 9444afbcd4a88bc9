"""The notebooks run from top to bottom, cell by cell."""

import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).resolve().parents[3] / "docs" / "notebooks").glob("*.ipynb"))


def test_there_are_notebooks():
    assert [path.stem for path in NOTEBOOKS] == ["calibration", "crack", "hopper"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path):
    shell_of = pytest.importorskip("IPython.core.interactiveshell")
    notebook = json.loads(path.read_text(encoding="utf-8"))
    shell = shell_of.InteractiveShell.instance()
    shell.reset(new_session=True)
    for k, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] != "code":
            continue
        assert not cell["outputs"], f"cell {k} keeps outputs, which would grow old"
        shell.run_cell("".join(cell["source"])).raise_error()
    # the last cell shows a picture
    shown = shell.display_formatter.format(shell.user_ns["_"])[0]
    assert shown["image/png"]
    shell.reset(new_session=True)
