"""Scenes for the tests: two spheres, a bed of grains, a peridynamic block."""

import pytest

import perigrain

SPHERES = """
units si
atom_style sphere
boundary p p f
comm_modify vel yes
region b block 0 1 0 1 0 1
create_box 2 b
create_atoms 1 single 0.3 0.3 0.3
create_atoms 2 single 0.7 0.7 0.7
set group all diameter 0.1
set group all density 1000
pair_style gran/hooke 1000.0 NULL 50.0 NULL 0.5 0
pair_coeff * *
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix ave all ave/time 1 1 1 c_thermo_temp c_thermo_pe mode scalar
compute k all ke
compute ka all ke/atom
compute pl all property/local patom1 patom2
compute pa all property/atom x y z
compute str all stress/atom NULL
compute cn all chunk/atom type
compute com all com/chunk cn
group two type 2
variable e equal step*2
variable a atom x*2
variable s string hello
variable v vector [1,2,3]
variable i index one two
variable int internal 3.0
timestep 1e-5
thermo 10
"""

PERI = """
units si
atom_style peri
boundary s s s
lattice sc 0.0005
region all block 0 0.004 0 0.004 0 0.004 units box
create_box 1 all
create_atoms 1 region all
set group all volume 1.25e-10
set group all density 2200
pair_style peri/pmb
pair_coeff 1 1 1.6863e22 0.0015001 0.0005 0.25
fix 1 all nve
timestep 1e-7
thermo 10
velocity all ramp vx -1 1 x 0 0.004 units box
"""


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Each test runs in its own folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def make():
    """Makes scenes, and closes them at the end."""
    made = []

    def scene(text="", *words):
        lmp = perigrain.lammps(cmdargs=["-log", "none", "-screen", "none", *words])
        made.append(lmp)
        if text:
            lmp.commands_string(text)
        return lmp

    yield scene
    for lmp in made:
        lmp.close()


@pytest.fixture
def spheres(make):
    """Two spheres after 20 steps."""
    lmp = make(SPHERES)
    lmp.command("run 20")
    return lmp


@pytest.fixture
def peri(make):
    """A peridynamic block under tension, before its first step."""
    return make(PERI)
