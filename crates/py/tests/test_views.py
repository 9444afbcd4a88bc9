"""Views of a scene: valid while particles are the same, with an error afterwards, never dangling."""

import gc
import math
import time

import numpy as np
import pytest

import perigrain


def test_steps_show_in_an_array_and_what_is_written_counts(spheres):
    x, v = spheres.numpy.extract_atom("x"), spheres.numpy.extract_atom("v")
    before = x[0, 2]
    v[0, 2] = 1.0
    spheres.command("run 10")
    assert x[0, 2] == pytest.approx(before + 10 * 1e-5, rel=1e-6)
    assert spheres.extract_atom("x")[0][2] == x[0, 2] and not x.stale
    x[0] = [0.5, 0.5, 0.5]
    assert spheres.gather_atoms("x", 1, 3)[:3] == [0.5, 0.5, 0.5]


def test_what_is_written_counts_if_nobody_looks_any_more(spheres):
    spheres.numpy.extract_atom("type")[0] = 2
    spheres.extract_atom("x")[0][0] = 0.65
    spheres.extract_atom("x")[0][1] = spheres.extract_atom("x")[0][2] = 0.7
    with pytest.raises(perigrain.DeckError, match="have not been computed"):
        spheres.command('print "$(pe)"')
    spheres.command("run 0")
    assert spheres.gather_atoms("type", 0, 1)[:] == [2, 2]
    assert abs(spheres.extract_atom("f")[0][0]) > 1.0, "the spheres overlap now"


def test_looking_alone_changes_no_bit(make):
    from conftest import PERI

    plain, looked = make(PERI), make(PERI)
    arrays = [looked.numpy.extract_atom(name) for name in ("x", "v", "f", "type", "x0")]
    for lmp in (plain, looked):
        lmp.command("run 7")
        lmp.command("run 5")
    assert plain.gather_atoms("x", 1, 3)[:] == looked.gather_atoms("x", 1, 3)[:]
    assert plain.get_thermo("pe") == looked.get_thermo("pe") and len(arrays) == 5


def test_an_energy_after_a_look(spheres):
    x = spheres.numpy.extract_atom("x")
    spheres.command("run 1")
    spheres.command('print "$(pe)"')
    assert spheres.get_thermo("pe") == 0.0 and x.shape == (2, 3)
    x[1] = [0.3, 0.3, 0.35]
    spheres.command("run 0")
    assert spheres.get_thermo("press") > 0.5, "the spheres overlap now"


@pytest.mark.parametrize(
    "line", ["create_atoms 1 single 0.1 0.1 0.1", "delete_atoms group two", "clear", "group two delete\nreset_atoms id sort yes"]
)
def test_stale_arrays_say_so(spheres, line):
    x, kinds, p = spheres.numpy.extract_atom("x"), spheres.numpy.extract_atom("type"), spheres.extract_atom("x")
    part, own = x[:, 2], x.copy()
    spheres.commands_string(line)
    if line.startswith("group"):  # reordering is not certain; the array shows whether it happened
        return
    for use in (
        lambda: x[0], lambda: x + 1, lambda: np.sum(x), lambda: x.mean(), lambda: list(x), lambda: repr(x), lambda: part[0],
        lambda: x.tolist(), lambda: kinds[0], lambda: x.__setitem__(0, 1.0), lambda: np.concatenate([x, x]), lambda: x.astype(int),
    ):  # fmt: skip
        with pytest.raises(perigrain.StaleError, match="stale"):
            use()
    assert x.stale and np.isnan(np.asarray(x.view(np.ndarray))).all() and math.isnan(p[1][2])
    assert own[1, 2] == pytest.approx(0.7, rel=1e-4), "a copy is one's own"
    spheres.command("print 'still usable'")


def test_results_look_at_nothing(spheres):
    x = spheres.numpy.extract_atom("x")
    results = [x + 1, x.copy(), np.sqrt(x), x[[0, 1]], x[x > 0.5], np.array(x), x.sum(axis=0)]
    spheres.command("clear")
    assert all(np.isfinite(np.asarray(r)).all() for r in results)


def test_an_array_outlives_its_scene(make):
    from conftest import SPHERES

    lmp = make(SPHERES)
    x, p = lmp.numpy.extract_atom("x"), lmp.extract_atom("x")
    lmp.close()
    with pytest.raises(perigrain.StaleError, match="closed"):
        x[0]
    assert math.isnan(p[0][0])
    gone = perigrain.lammps(cmdargs=["-log", "none", "-screen", "none"])
    gone.commands_string(SPHERES)
    y = gone.numpy.extract_atom("x")
    del gone
    gc.collect()
    with pytest.raises(perigrain.StaleError):
        y.sum()


def test_whole_numbers_are_mirrored(spheres):
    kinds, ids = spheres.numpy.extract_atom("type"), spheres.numpy.extract_atom("id")
    kinds[0] = 2
    spheres.command("group second type 2")
    assert spheres.eval("count(second)") == 2.0
    spheres.extract_atom("type")[0] = 1
    spheres.command("run 1")
    assert spheres.gather_atoms("type", 0, 1)[:] == [1, 2] and kinds[0] == 1
    kinds[1] = 9
    with pytest.raises(perigrain.DeckError, match="9 is no type"):
        spheres.command("run 1")
    assert kinds[1] == 2
    with pytest.raises(ValueError):
        ids[0] = 5
    spheres.command("run 1")


def test_a_million_particles_in_microseconds(make):
    lmp = make("region b block 0 100 0 100 0 100\ncreate_box 1 b\nlattice sc 1\ncreate_atoms 1 box\nmass 1 1\n")
    assert lmp.get_natoms() == 1_000_000
    for extract in (lmp.extract_atom, lmp.numpy.extract_atom):
        times = []
        for _ in range(20):
            begin = time.perf_counter()
            x = extract("x")
            times.append(time.perf_counter() - begin)
            del x
        assert min(times) < 200e-6, f"{min(times) * 1e6:.0f} µs"
