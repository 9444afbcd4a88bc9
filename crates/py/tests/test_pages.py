"""Pages of the manual: their code blocks run in order, and their assertions hold."""

import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parents[3] / "docs"


def work_off(page, least=4):
    """Runs the code blocks of a page in order; returns the defined names."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.S)
    assert len(blocks) >= least
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
    # The same scene with the same bits: as large as the picture in the book, up to differences between C libraries.
    assert abs(made.stat().st_size - kept.stat().st_size) < 0.05 * kept.stat().st_size


def test_a_first_crack_is_made_as_the_page_says(folder):
    page = (DOCS / "howto" / "first-crack.md").read_text(encoding="utf-8")
    words = re.search(r"^python (-m perigrain new in\.crack)$", page, re.M)[1].split()
    subprocess.run([sys.executable, *words], check=True)
    work_off("howto/first-crack.md", least=2)
    for picture in ("crack.png", "again.png"):
        assert (folder / picture).read_bytes().startswith(b"\x89PNG")
