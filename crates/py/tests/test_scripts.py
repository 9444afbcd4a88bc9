"""Scripts written for LAMMPS' module run with one import changed, with its numbers."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parent / "scripts"

# The output of the same scripts with LAMMPS' own module (22 Jul 2025), with all printed digits.
SAID = {
    "external": """
x 0.384884203398 0.455621039563 0.384884203398 0.705005499576 0.579747378519 0.814127099719
thermo 7.2633032791 0.317595326866 -0.125940013575
values 2.5 -1.0 7.0
calls [0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 33, 36, 39] (2, [1, 2])
""",
    "gather": """
force -25.60531 -25.60531
ke 0.0412311941
left 0
made 64 64
ke 0.044096709
dump 73 ITEM: ATOMS id type x y z fx fy fz ['1', '1']
gathered 1.49955551 3.49975286 6.47785052 5.64716714
concat 0.51037792 1.49955551 3.5006899
subset 1.49955551 3.49975286 6.47785052 5.64716714
scattered 1.49955551 0.25 0.5 0.75 1.25 1.5 1.75
box [0.0, 0.0, 0.0] [4.0, 4.0, 4.0] 0.0 0.0 0.0 [1, 1, 1] 0
box [0.0, 0.0, 0.0] [10.0, 10.0, 8.0] 0.0 0.0 0.0 [1, 1, 1] 0
""",
    "looks": """
mass 27 1.5 2.5 x 0.04136234351
temp 0.09644932672
eng 0.0009863088008
vy 0.2000590813 0.1999974848
vol 27 27
gathered 0.04136234351 0.07999637544 0.0799950367
scattered 1.041362344
version True 2 True False
ids ['1'] True
""",
    "moves": """
energies 0 0.005904501662 0.01104214994
taken 228 lists True
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
    "watch": """
step 5000 5000
500 4.86621901e+22
1000 1.9464876e+23
1500 4.37959711e+23
2000 7.78595041e+23
2500 6.08311518e+23
3000 8.75919587e+23
3500 1.19222366e+24
4000 7.36431022e+22
4500 5.25790175e+22
5000 1.08843984e+23
rot 0
""",
}


@pytest.mark.parametrize("name", sorted(SAID))
def test_a_script_for_lammps(name):
    words = [sys.executable, str(SCRIPTS / f"{name}.py"), "perigrain", "-compat", "lammps/2025"]
    outcome = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (outcome.returncode, outcome.stderr) == (0, "")
    assert outcome.stdout == SAID[name].lstrip()
