"""`fix external`: forces, values and errors of a Python function."""

import gc
import weakref

import numpy as np
import pytest

import perigrain

# Two grains of mass 1 on which only Python acts.
FREE = """
units lj
atom_style sphere
region b block 0 1 0 1 0 1
create_box 1 b
create_atoms 1 single 0.3 0.3 0.3
create_atoms 1 single 0.7 0.7 0.7
set group all diameter 0.1
set group all mass 1.0
fix 1 all nve
timestep 0.01
"""


def test_an_oscillator_keeps_its_energy_and_its_period(make):
    lmp = make(FREE + "fix pull all external pf/callback 1 1\n")
    start = lmp.numpy.extract_atom("x").copy()
    stiffness = 4.0 * np.pi**2  # a period of 1: 100 steps

    def pull(caller, step, n, ids, x, f):
        away = x - 0.5
        f[:] = -stiffness * away
        caller.fix_external_set_energy_global("pull", 0.5 * stiffness * float((away**2).sum()))

    lmp.set_fix_external_callback("pull", pull, lmp)
    lmp.command("run 0")
    before = lmp.get_thermo("etotal")
    lmp.command("run 100")
    # velocity Verlet: the period is off by (2 pi dt)^2/24 = 1.6e-4, the position near its turning point by the square of that
    assert np.abs(lmp.numpy.extract_atom("x") - start).max() < 1e-6
    # the relative energy oscillates by (2 pi dt)^2/4 = 1e-3, and returns after a period
    assert lmp.get_thermo("etotal") == pytest.approx(before, rel=1e-5)


def test_forces_stay_with_their_particles(make):
    lmp = make(FREE + "fix array all external pf/array 1\n")
    force = lmp.numpy.fix_external_get_force("array")
    force[:] = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]
    lmp.commands_string("group first id 1\ndelete_atoms group first compress no\nrun 1")
    assert lmp.numpy.extract_atom("f").tolist() == [[0.0, 2.0, 0.0]]
    with pytest.raises(perigrain.StaleError):
        force[0]
    assert lmp.fix_external_get_force("array")[0][:3] == [0.0, 2.0, 0.0]


def test_energies_and_virials_of_particles(make):
    lmp = make(FREE + "fix pull all external pf/callback 1 1\ncompute e all pe/atom\ncompute s all stress/atom NULL virial\n")
    lmp.command("compute sum all reduce sum c_e c_s[1]\nthermo_style custom step pe c_sum[1] c_sum[2]")

    def pull(caller, step, n, ids, x, f):
        f[:] = 0.0
        # Too many values: as in LAMMPS, those beyond the last particle are ignored.
        lmp.fix_external_set_energy_peratom("pull", [float(k) for k in ids] + [9.0])
        lmp.numpy.fix_external_set_virial_peratom("pull", np.outer(ids, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))

    lmp.set_fix_external_callback("pull", pull)
    lmp.command("run 1")
    assert lmp.numpy.extract_compute("e", 1, 1).tolist() == [1.0, 2.0]
    assert lmp.numpy.extract_compute("s", 1, 2)[1].tolist() == [-2.0, -4.0, -6.0, -8.0, -10.0, -12.0]
    # they are not part of any sum of the scene
    assert lmp.get_thermo("pe") == 0.0
    lmp.command("fix_modify pull energy no virial no")
    lmp.command("run 0")
    assert lmp.numpy.extract_compute("e", 1, 1).tolist() == [0.0, 0.0]
    assert not lmp.numpy.extract_compute("s", 1, 2).any()


def test_what_was_said_between_runs_stays_with_the_particles(make):
    lmp = make(FREE + "fix array all external pf/array 1\ncompute e all pe/atom fix\ncompute m all reduce max c_e\nthermo_style custom step c_m\n")
    lmp.fix_external_set_energy_peratom("array", np.array([3.0, 4.0]))
    lmp.commands_string("group first id 1\ndelete_atoms group first compress no\nrun 1")
    assert lmp.numpy.extract_compute("e", 1, 1).tolist() == [4.0]


def test_an_exception_ends_the_run_and_is_raised(make):
    lmp = make(FREE + "fix pull all external pf/callback 1 1\n")

    def fails(caller, step, n, ids, x, f):
        if step == 3:
            raise KeyError("step three")

    lmp.set_fix_external_callback("pull", fails)
    with pytest.raises(KeyError, match="step three"):
        lmp.command("run 10")
    lmp.set_fix_external_callback("pull", lambda *_: None)
    lmp.command("run 5")
    assert lmp.extract_global("ntimestep") == 8


def test_what_a_function_may_not_do(make):
    lmp = make(FREE + "fix pull all external pf/callback 1 1\n")

    def reads(caller, step, n, ids, x, f):
        lmp.get_thermo("step")

    lmp.set_fix_external_callback("pull", reads)
    with pytest.raises(perigrain.BusyError):
        lmp.command("run 1")

    def moves(caller, step, n, ids, x, f):
        x[:] = 0.0

    lmp.set_fix_external_callback("pull", moves)
    with pytest.raises(ValueError, match="read-only"):
        lmp.command("run 1")


def test_mistakes_are_named(make):
    lmp = make(FREE + "fix pull all external pf/callback 1 1\n")
    with pytest.raises(perigrain.DeckError, match="no function to call"):
        lmp.command("run 1")
    for id_, words in [("pul", "did you mean `pull`"), ("1", "is a fix nve")]:
        with pytest.raises(perigrain.DeckError, match=words):
            lmp.set_fix_external_callback(id_, lambda *_: None)
    for call, words in [
        (lambda: lmp.set_fix_external_callback("pull", 3), "a function is needed"),
        (lambda: lmp.fix_external_set_virial_global("pull", [1.0]), "six numbers"),
        (lambda: lmp.fix_external_set_energy_peratom("pull", [[1.0], [2.0]]), "shape"),
        (lambda: lmp.fix_external_set_virial_peratom("pull", [1.0, 2.0]), "shape"),
        (lambda: lmp.fix_external_set_virial_peratom("pull", [[1.0] * 6, [1.0]]), "as many for each"),
    ]:
        with pytest.raises(perigrain.DataError, match=words):
            call()
    with pytest.raises(perigrain.DeckError, match="values for 1 particles, and there are 2"):
        lmp.fix_external_set_energy_peratom("pull", [1.0])
    with pytest.raises(perigrain.DeckError, match="has 0 values"):
        lmp.fix_external_set_vector("pull", 1, 1.0)
    # another fix of this name has no function
    lmp.set_fix_external_callback("pull", lambda *_: None)
    lmp.commands_string("unfix pull\nfix pull all external pf/callback 1 1")
    with pytest.raises(perigrain.DeckError, match="no function to call"):
        lmp.command("run 1")


def test_a_scene_and_its_function_go_together():
    class Caller:
        pass

    lmp = perigrain.lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.commands_string(FREE + "fix pull all external pf/callback 1 1\n")
    caller = Caller()
    caller.lmp = lmp
    gone = weakref.ref(caller)
    lmp.set_fix_external_callback("pull", lambda *_: None, caller)
    del lmp, caller
    gc.collect()
    assert gone() is None
