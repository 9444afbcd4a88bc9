"""The page of the manual: its blocks run in order, and what stands behind a comment with a value is so."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def test_the_page_works_as_it_stands(folder):
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(blocks) >= 6
    names = {}
    for k, block in enumerate(blocks):
        exec(compile(block, f"docs/python.md, block {k + 1}", "exec"), names)
    assert names["lmp"].get_natoms() == 3 and (folder / "plate.png").read_bytes().startswith(b"\x89PNG")
    names["lmp"].close()
