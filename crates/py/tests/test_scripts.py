"""Scripts that were written for LAMMPS' module run with one import changed, to its numbers."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parent / "scripts"

# What the same scripts print with LAMMPS' own module (22 Jul 2025), to all the digits they print.
SAID = {
    "external": """
x 0.384884203398 0.455621039563 0.384884203398 0.705005499576 0.579747378519 0.814127099719
thermo 7.2633032791 0.317595326866 -0.125940013575
values 2.5 -1.0 7.0
calls [0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 33, 36, 39] (2, [1, 2])
""",
    "steps": """
force -14.70886114
place 0.4699689836 0.03806527246
step 35 70.0 2
ke 0.00463114849 TotEng
""",
    "walk": """
taken 76 energy 15.67977681 first 0
at last 15.67977681
""",
}


@pytest.mark.parametrize("name", sorted(SAID))
def test_a_script_for_lammps(name):
    words = [sys.executable, str(SCRIPTS / f"{name}.py"), "perigrain", "-compat", "lammps"]
    outcome = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (outcome.returncode, outcome.stderr) == (0, "")
    assert outcome.stdout == SAID[name].lstrip()
