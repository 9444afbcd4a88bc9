"""Pages of the manual: their blocks run in order, and what they assert is so."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[3] / "docs"


def work_off(page):
    """Runs the blocks of a page one after the other; their names."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)
    assert len(blocks) >= 4
    names = {}
    for k, block in enumerate(blocks):
        exec(compile(block, f"docs/{page}, block {k + 1}", "exec"), names)
    return names


def test_the_page_of_the_module_works_as_it_stands(folder):
    names = work_off("python.md")
    assert names["lmp"].get_natoms() == 3 and (folder / "plate.png").read_bytes().startswith(b"\x89PNG")
    names["lmp"].close()


def test_a_run_is_driven_as_the_page_says(folder):
    work_off("howto/from-python.md")
    made, kept = (where / "from-python.jpg" for where in (folder, DOCS / "howto" / "pictures"))
    # The same scene with the same bits: as large as the one in the book, give or take what another C library changes.
    assert abs(made.stat().st_size - kept.stat().st_size) < 0.05 * kept.stat().st_size
