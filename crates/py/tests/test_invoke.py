"""`fix python/invoke`: functions called within a run, what they can read and write, and what is refused."""

import __main__
import numpy as np
import pytest

import perigrain
from conftest import SPHERES
from test_external import FREE


@pytest.fixture
def known():
    """Defines functions as a script would, and removes them."""
    names = set()

    def make(**functions):
        for name, function in functions.items():
            names.add(name)
            setattr(__main__, name, function)

    yield make
    for name in names:
        delattr(__main__, name)


def test_functions_are_called_at_their_steps(make, known):
    lmp, seen = make(SPHERES), []

    def forces(ptr, vflag):
        inside = perigrain.lammps(ptr=ptr)
        seen.append(("forces", inside.extract_global("ntimestep"), vflag))

    def after(ptr):
        seen.append(("after", perigrain.lammps(ptr=ptr).extract_global("ntimestep")))

    known(forces=forces, after=after)
    lmp.commands_string("fix a all python/invoke 2 post_force forces\nfix b all python/invoke 3 end_of_step after")
    lmp.commands_string("thermo_style custom step press\nthermo 4\nrun 6")
    # not in the setup; the pressure is read at steps 0, 4 and the last, which excludes computes that need it, such as stress/atom
    assert seen == [("forces", 2, 0), ("after", 3), ("forces", 4, 1), ("forces", 6, 5), ("after", 6)]
    seen.clear()
    lmp.commands_string("unfix a\nrun 3")
    assert seen == [("after", 9)]


def test_forces_written_within_a_step_move_particles(make, known):
    """The same force as by `fix external`, bit for bit."""

    def pull(ptr, vflag):
        with perigrain.lammps(ptr=ptr) as lmp:
            x = lmp.numpy.extract_atom("x")
            f = lmp.extract_atom("f")
            for i in range(lmp.get_natoms()):
                for k in range(3):
                    f[i][k] += -4.0 * (x[i, k] - 0.5)

    def asked(caller, step, n, ids, x, f):
        # A fix external is also called in the setup.
        f[:] = -4.0 * (x - 0.5) if step else 0.0

    known(pull=pull)
    places = []
    for line in ("python/invoke 1 post_force pull", "external pf/callback 1 1"):
        lmp = make(FREE + f"fix 2 all {line}\n")
        if "external" in line:
            lmp.set_fix_external_callback("2", asked)
        lmp.command("run 50")
        places.append(lmp.numpy.extract_atom("x").copy())
    assert (places[0] == places[1]).all()


def test_what_is_written_after_a_step_counts(make, known):
    lmp = make(FREE)

    def after(ptr):
        inside = perigrain.lammps(ptr=ptr)
        inside.numpy.extract_atom("v")[0] = [1.0, 0.0, 0.0]
        kinds = inside.numpy.extract_atom("type")
        ids = inside.gather_atoms("id", 0, 1)
        assert list(ids) == [1, 2] and kinds.tolist() == [1, 1] and inside.extract_box()[1] == [1.0, 1.0, 1.0]
        x = inside.gather_atoms("x", 1, 3)
        x[3] = 0.75
        inside.scatter_atoms("x", 1, 3, x)

    known(after=after)
    lmp.commands_string("fix b all python/invoke 2 end_of_step after\nrun 4")
    x, v = lmp.numpy.extract_atom("x"), lmp.numpy.extract_atom("v")
    assert v[0].tolist() == [1.0, 0.0, 0.0] and x[1, 0] == 0.75
    assert x[0, 0] == pytest.approx(0.3 + 2 * 0.01)


def test_who_is_moved_or_sped_up_meets_others_at_once(make, known):
    """Neighbour lists stay valid, whatever a function does to positions and velocities."""

    def jump(ptr):
        perigrain.lammps(ptr=ptr).numpy.extract_atom("x")[1] = [0.38, 0.3, 0.3]

    def dart(ptr):
        perigrain.lammps(ptr=ptr).numpy.extract_atom("v")[1] = [-2000.0, 0.0, 0.0]

    known(jump=jump, dart=dart)
    lmp = make(SPHERES)
    lmp.commands_string("fix 2 all python/invoke 40 end_of_step jump\nrun 41")
    # they overlap by 0.02 at a stiffness of 1000, and separate slowly
    assert lmp.extract_atom("f")[1][0] == pytest.approx(20.0, rel=1e-6)
    lmp = make(SPHERES)
    lmp.commands_string("set atom 2 y 0.3 z 0.3\nthermo_modify energy ignore\nfix 2 all python/invoke 40 end_of_step dart\nrun 56")
    # 0.3 apart, 0.02 closer in each step: they meet in the sixteenth
    assert lmp.extract_atom("f")[0][0] < -1000.0


def test_an_exception_ends_the_run_and_is_raised(make, known):
    lmp = make(FREE)

    def after(ptr):
        if perigrain.lammps(ptr=ptr).extract_global("ntimestep") == 3:
            raise KeyError("step three")

    known(after=after)
    lmp.command("fix b all python/invoke 1 end_of_step after")
    with pytest.raises(KeyError, match="step three"):
        lmp.command("run 10")
    known(after=lambda ptr: None)
    lmp.command("run 5")
    assert lmp.extract_global("ntimestep") == 8 and lmp.get_natoms() == 2


def test_what_a_function_may_not_do(make, known):
    lmp, kept = make(FREE), {}

    def after(ptr):
        inside = kept["scene"] = perigrain.lammps(ptr=ptr)
        kept["x"] = inside.numpy.extract_atom("x")
        for attempt in (
            lambda: inside.command("run 1"),
            lambda: inside.get_thermo("pe"),
            lambda: inside.extract_compute("thermo_temp", 0, 0),
            lambda: inside.extract_variable("e"),
            lambda: ptr.command("run 1", "deck"),
            lambda: lmp.get_natoms(),
        ):
            with pytest.raises(perigrain.BusyError):
                attempt()
        assert inside.is_running
        # An invalid type: the run ends, and the particle keeps its type.
        if inside.extract_global("ntimestep") == 2:
            inside.numpy.extract_atom("type")[0] = 7
        ptr.close()
        inside.close()

    known(after=after)
    lmp.command("fix b all python/invoke 1 end_of_step after")
    lmp.command("run 1")
    with pytest.raises(perigrain.ClosedError, match="has returned"):
        kept["scene"].get_natoms()
    with pytest.raises(perigrain.StaleError, match="has returned"):
        kept["x"][0]
    with pytest.raises(perigrain.DeckError, match="7 is no type"):
        lmp.command("run 5")
    assert lmp.numpy.extract_atom("type").tolist() == [1, 1] and not np.isnan(lmp.numpy.extract_atom("x")).any()


def test_mistakes_are_named(make, known):
    lmp = make(FREE)
    known(after=lambda ptr: None)
    for words, message in [
        ("1 end_of_step nosuch", "has no function `nosuch`"),
        ("0 end_of_step after", "how many steps"),
        ("1 pre_force after", "post_force"),
        ("1 end_of_step", "function"),
    ]:
        with pytest.raises(perigrain.DeckError, match=message):
            lmp.command(f"fix b all python/invoke {words}")
    with pytest.raises(perigrain.DataError, match="python/invoke"):
        perigrain.lammps(ptr=3)
    # In a deck alone, as in LAMMPS' manual; `clear` keeps the functions.
    lmp.commands_string("clear\n" + FREE)
    lmp.commands_string('''
python later here """
from perigrain import lammps
said = []
def later(ptr):
    said.append(lammps(ptr=ptr).get_natoms())
"""
fix b all python/invoke 2 end_of_step later
run 4
''')
    assert __main__.said == [2, 2]
    del __main__.said, __main__.later, __main__.lammps
