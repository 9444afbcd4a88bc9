"""The methods of LAMMPS' Python class: names, shapes, types and numbers as in LAMMPS (22 Jul 2025)."""

import ctypes
import math

import numpy as np
import pytest

import perigrain
from perigrain import LMP_SIZE_COLS, LMP_SIZE_ROWS, LMP_SIZE_VECTOR, LMP_STYLE_ATOM, LMP_STYLE_GLOBAL, LMP_STYLE_LOCAL
from perigrain import LMP_TYPE_ARRAY, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR

# LAMMPS' results for these two spheres after 20 steps of free fall; the sums are exact up to rounding.
Z = [0.2999998038000001, 0.6999998037999999]
KE = 2.0155641651342163e-06


def test_globals_have_lammps_types_and_values(spheres):
    assert spheres.extract_global("dt") == 1e-5 and spheres.extract_global("ntimestep") == 20
    assert spheres.extract_global("boxlo") == [0.0, 0.0, 0.0] and spheres.extract_global("boxzhi") == 1.0
    assert spheres.extract_global("periodicity") == [1, 1, 0] and spheres.extract_global("units") == "si"
    assert (spheres.extract_global("natoms"), spheres.extract_global("ntypes")) == (2, 2)
    assert spheres.extract_global("special_lj") == [1.0, 0.0, 0.0, 0.0]
    assert spheres.extract_global("boltz") == 1.3806504e-23 and spheres.extract_global("nosuch") is None
    codes = {"dt": 2, "ntimestep": 4, "periodicity": 0, "units": 6, "natoms": 4, "nlocal": 0, "nosuch": -1}
    assert {name: spheres.extract_global_datatype(name) for name in codes} == codes
    assert spheres.extract_box() == ([0.0] * 3, [1.0] * 3, 0.0, 0.0, 0.0, [1, 1, 0], 0)
    assert (spheres.extract_setting("nlocal"), spheres.extract_setting("nosuch")) == (2, -1)
    assert spheres.version() == 20250722 and spheres.get_natoms() == 2 and not spheres.is_running


def test_columns_are_pointers_and_arrays(spheres):
    x = spheres.extract_atom("x")
    assert [x[0][2], x[1][2]] == pytest.approx(Z, rel=1e-14) and x[1][:2] == [0.7, 0.7]
    kinds = spheres.extract_atom("type")
    assert kinds[:2] == [1, 2] and isinstance(kinds, ctypes.POINTER(ctypes.c_int))
    shapes = {
        "x": ((2, 3), "float64"), "v": ((2, 3), "float64"), "f": ((2, 3), "float64"), "omega": ((2, 3), "float64"),
        "id": ((2,), "int32"), "type": ((2,), "int32"), "mask": ((2,), "int32"), "image": ((2,), "int32"),
        "radius": ((2,), "float64"), "rmass": ((2,), "float64"),
    }  # fmt: skip
    for name, (shape, dtype) in shapes.items():
        array = spheres.numpy.extract_atom(name)
        assert (array.shape, array.dtype) == (shape, dtype), name
    for name in ["mass", "molecule", "density", "nosuch", "vfrac", "x0", "quat"]:
        assert spheres.extract_atom(name) is None and spheres.numpy.extract_atom(name) is None, name
    assert [spheres.extract_atom_datatype(n) for n in ("x", "id", "radius", "nosuch")] == [3, 0, 2, -1]
    assert spheres.extract_atom_size("x", LMP_SIZE_COLS) == 3 and spheres.extract_atom_size("x", LMP_SIZE_ROWS) == 2
    assert (spheres.map_atom(2), spheres.map_atom(99)) == (1, -1)


def test_masses_of_types_begin_at_one(make):
    lmp = make("region b block 0 1 0 1 0 1\ncreate_box 2 b\nmass 1 2.5\nmass 2 3.5\ncreate_atoms 1 single 0 0 0\n")
    assert lmp.extract_atom("mass")[:3] == [0.0, 2.5, 3.5]
    assert lmp.numpy.extract_atom("mass").tolist() == [0.0, 2.5, 3.5]


def test_computes_by_style_and_type(spheres):
    get, arrays = spheres.extract_compute, spheres.numpy.extract_compute
    assert get("k", LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR) == pytest.approx(KE, rel=1e-12)
    assert arrays("ka", LMP_STYLE_ATOM, LMP_TYPE_VECTOR).sum() == pytest.approx(KE, rel=1e-12)
    assert get("ka", LMP_STYLE_ATOM, LMP_TYPE_VECTOR)[1] == pytest.approx(KE / 2, rel=1e-12)
    places = arrays("pa", LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
    assert places.shape == (2, 3) and places[:, 2].tolist() == pytest.approx(Z, rel=1e-14)
    assert get("pa", LMP_STYLE_ATOM, LMP_SIZE_COLS) == 3
    assert arrays("thermo_temp", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR).shape == (6,)
    assert get("thermo_press", LMP_STYLE_GLOBAL, LMP_SIZE_VECTOR) == 6
    assert arrays("com", LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY).shape == (2, 3)
    assert (get("com", 0, LMP_SIZE_ROWS), get("com", 0, LMP_SIZE_COLS)) == (2, 3)
    assert get("com", 0, LMP_TYPE_ARRAY)[1][2] == pytest.approx(Z[1], rel=1e-14)
    assert (get("pl", LMP_STYLE_LOCAL, LMP_SIZE_ROWS), get("pl", LMP_STYLE_LOCAL, LMP_SIZE_COLS)) == (0, 2)
    for wrong in [("k", 0, 1), ("k", 1, 1), ("k", 7, 0)]:
        with pytest.raises(perigrain.DataError):
            get(*wrong)
    with pytest.raises(perigrain.DeckError, match="no compute `kk`"):
        get("kk", 0, 0)


def test_fixes_and_variables(spheres):
    assert spheres.extract_fix("ave", 0, 1, 0) == pytest.approx(9.73243801198921e16, rel=1e-9)
    assert (spheres.extract_fix("ave", 0, 1, 1), spheres.extract_fix("ave", 0, 3)) == (0.0, 2)
    for wrong in [("ave", 0, 0), ("ave", 0, 1, 2), ("ave", 0, 2)]:
        with pytest.raises(perigrain.DataError):
            spheres.extract_fix(*wrong)
    with pytest.raises(perigrain.DeckError):
        spheres.extract_fix("nosuch", 0, 0)
    get = spheres.extract_variable
    assert (get("e"), get("s"), get("i"), get("int"), get("nosuch")) == (40.0, "hello", "one", 3.0, None)
    assert list(get("a")) == [0.6, 1.4] and list(get("a", "two")) == [0.0, 1.4] and list(get("v")) == [1.0, 2.0, 3.0]
    assert spheres.numpy.extract_variable("a", None, 1).tolist() == [0.6, 1.4]
    with pytest.raises(perigrain.DataError, match="a number per particle"):
        get("a", None, 0)
    assert [spheres.set_variable("s", "new"), spheres.set_internal_variable("int", 4.5)] == [0, 0]
    assert [spheres.set_variable("nosuch", "1"), spheres.set_internal_variable("e", 1.0)] == [-1, -1]
    assert (get("s"), get("int"), spheres.expand("x ${s} $(v_e)"), spheres.eval("step+1")) == ("new", 4.5, "x new 40", 21.0)


def test_thermo(spheres):
    assert spheres.get_thermo("step") == 20.0 and spheres.get_thermo("c_k") == pytest.approx(KE, rel=1e-12)
    row = spheres.last_thermo()
    assert list(row) == ["Step", "Temp", "E_pair", "E_mol", "TotEng", "Press"]
    assert row["Step"] == 20 and row["Press"] == pytest.approx(1.3437094434228109e-06, rel=1e-12)
    assert spheres.last_thermo_step == 20
    with pytest.raises(perigrain.DeckError):
        spheres.get_thermo("tmep")


def test_nothing_yet(make):
    lmp = make()
    assert (lmp.last_thermo(), lmp.last_thermo_step, lmp.get_natoms()) == (None, -1, 0)
    assert lmp.extract_global("boxlo") is None and lmp.extract_atom("x") is None
    with pytest.raises(perigrain.DataError, match="create_box"):
        lmp.extract_box()


def test_gather_and_scatter_by_id(spheres):
    x = spheres.gather_atoms("x", 1, 3)
    assert isinstance(x, ctypes.Array) and x[:] == pytest.approx([0.3, 0.3, Z[0], 0.7, 0.7, Z[1]], rel=1e-14)
    assert spheres.gather_atoms("type", 0, 1)[:] == [1, 2]
    assert spheres.gather_atoms("image", 0, 1)[:] == [537395712, 537395712]
    assert spheres.gather_atoms("image", 0, 3)[:] == [0] * 6
    assert spheres.gather_atoms_subset("id", 0, 1, 1, [2])[:] == [2]
    assert spheres.gather("c_pa", 1, 3)[:] == x[:] and spheres.gather_concat("radius", 1, 1)[:] == [0.05, 0.05]
    x[0] = 0.25
    spheres.scatter_atoms("x", 1, 3, x)
    assert spheres.extract_atom("x")[0][0] == 0.25
    spheres.scatter_atoms("v", 1, 3, np.arange(6.0).reshape(2, 3))
    assert spheres.gather_atoms("v", 1, 3)[:] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    spheres.scatter_atoms_subset("type", 0, 1, 1, [1], (ctypes.c_int * 1)(2))
    assert spheres.gather_atoms("type", 0, 1)[:] == [2, 2]
    spheres.command("run 1")


@pytest.mark.parametrize(
    "call",
    [
        lambda lmp: lmp.gather_atoms("x", 0, 3),
        lambda lmp: lmp.gather_atoms("x", 1, 1),
        lambda lmp: lmp.gather_atoms("type", 1, 1),
        lambda lmp: lmp.gather_atoms("x", 2, 3),
        lambda lmp: lmp.scatter_atoms("x", 1, 3, [0.1] * 5),
        lambda lmp: lmp.scatter_atoms("x", 1, 3, ["a"] * 6),
        lambda lmp: lmp.scatter_atoms("type", 0, 1, [1.5, 2.0]),
        lambda lmp: lmp.scatter_atoms("type", 0, 1, np.array([1.0, 2.0])),
        lambda lmp: lmp.scatter_atoms("type", 0, 1, [2**40, 1]),
        lambda lmp: lmp.scatter_atoms("x", 1, 3, None),
        lambda lmp: lmp.scatter_atoms("x", 1, 3, np.zeros((2, 2))),
        lambda lmp: lmp.create_atoms(2, None, [1], [0.1] * 6),
        lambda lmp: lmp.create_atoms(1, None, [1], [0.1] * 4),
        lambda lmp: lmp.create_atoms(1, [1.5], [1], [0.1] * 3),
        lambda lmp: lmp.reset_box([0, 0], [1, 1, 1], 0, 0, 0),
        lambda lmp: lmp.command(7),
    ],
)
def test_wrong_shapes_and_types_are_named_and_the_scene_goes_on(spheres, call):
    with pytest.raises(perigrain.DataError) as e:
        call(spheres)
    assert isinstance(e.value, ValueError) and str(e.value)
    spheres.command("run 1")
    assert spheres.get_thermo("step") == 21.0


@pytest.mark.parametrize(
    "call",
    [
        lambda lmp: lmp.scatter_atoms("type", 0, 1, [1, 3]),
        lambda lmp: lmp.scatter_atoms("x", 1, 3, [math.nan] * 6),
        lambda lmp: lmp.gather_atoms("nosuch", 1, 1),
        lambda lmp: lmp.gather_atoms_subset("x", 1, 3, 1, [9]),
        lambda lmp: lmp.create_atoms(1, [1], [1], [0.1] * 3),
        lambda lmp: lmp.create_atoms(1, None, [7], [0.1] * 3),
        lambda lmp: lmp.reset_box([0, 0, 0], [2, 2, 2], 0, 0, 0),
        lambda lmp: lmp.file("no such file"),
    ],
)
def test_what_cannot_be_is_a_deck_error(spheres, call):
    with pytest.raises(perigrain.DeckError):
        call(spheres)
    spheres.command("run 1")


def test_particles_are_made(spheres):
    assert spheres.create_atoms(2, None, [1, 2], [0.1, 0.1, 0.1, 0.2, 0.2, 0.2]) == 2
    image = spheres.encode_image_flags(1, 0, -1)
    assert (image, spheres.decode_image_flags(image)) == (536347137, [1, 0, -1])
    assert spheres.create_atoms(1, [17], [1], [0.5, 0.1, 0.1], v=[1, 2, 3], image=[image]) == 1
    assert spheres.create_atoms(1, None, [1], [0.5, 0.1, 7.0]) == 0, "beyond a fixed face"
    assert (spheres.get_natoms(), spheres.map_atom(17)) == (5, 4)
    assert spheres.numpy.extract_atom("v")[4].tolist() == [1.0, 2.0, 3.0]
    spheres.command("run 5")


def test_what_there_is(spheres):
    assert spheres.has_style("pair", "gran/hooke") and not spheres.has_style("pair", "nosuch")
    assert "sphere" in spheres.available_styles("region") and spheres.available_styles("nosuch") == []
    assert spheres.available_ids("compute")[:3] == ["thermo_temp", "thermo_press", "thermo_pe"]
    assert spheres.has_id("fix", "g") and spheres.available_ids("group") == ["all", "two"]
    assert spheres.has_exceptions and spheres.get_mpi_comm() is None and spheres.gather_bonds()[0] == 0
    assert spheres.numpy.gather_bonds().shape == (0, 3)


def test_commands_in_all_their_forms(make, tmp_path):
    lmp = make()
    lmp.commands_list(["region b block 0 1 &", "0 1 0 1\n", "create_box 1 b"])
    lmp.cmd.timestep(0.25)
    assert lmp.extract_global("dt") == 0.25
    deck = tmp_path / "in.loop"
    deck.write_text("label a\nvariable i loop 3\nvariable n equal $i\nnext i\njump SELF a\n")
    lmp.file(deck)
    assert lmp.extract_variable("n") == 3.0
    with pytest.raises(SystemExit) as e:
        lmp.command("quit 3")
    assert e.value.code == 3
    lmp.command("variable after equal 1")


def test_switches(make, tmp_path, capfd):
    perigrain.lammps(cmdargs=["-log", "out.log", "-screen", "none", "-var", "n", "7"]).command("print 'n is $n'")
    assert "n is 7" in (tmp_path / "out.log").read_text() and capfd.readouterr().out == ""
    lmp = perigrain.lammps(cmdargs=["-log", "none"])
    lmp.command("print 'to Python'")
    assert capfd.readouterr().out == "to Python\n"
    for words in [["-nosuch"], ["-in", "deck"], ["-safe"], ["-partition", "2x1"], ["-var"]]:
        with pytest.raises(ValueError):
            perigrain.lammps(cmdargs=words)
    with pytest.raises(perigrain.DataError):
        perigrain.lammps(ptr=1)


def test_what_is_not_here_is_refused_with_what_stands_in_its_place(spheres):
    for name, words in [
        ("get_neighlist", "pair/local"), ("extract_pair", "deck"), ("create_molecule", "`create_atoms … mol`"), ("force_timeout", "fix halt"),
    ]:  # fmt: skip
        assert not hasattr(spheres, name)
        with pytest.raises(AttributeError, match=words):
            getattr(spheres, name)
    with pytest.raises(AttributeError, match="pair/local"):
        spheres.numpy.get_neighlist(0)
    with pytest.raises(AttributeError, match="no attribute `comand`"):
        spheres.comand("run 0")
    spheres.addstep_compute_all(5)
    assert spheres.get_gpu_device_info() == "" and spheres.numpy.gather_angles().shape == (0, 4)
    assert (perigrain.LMP_MAX_GROUP, perigrain.LMP_BUFSIZE) == (32, 1024)


def test_numbers_come_in_many_forms(spheres):
    wide = np.arange(12.0).reshape(2, 6)
    for data in (np.float32([1, 2, 3, 4, 5, 6]), np.arange(1, 7), wide[:, ::2], [1, 2.0, 3, 4, 5, 6], ((1, 2, 3), (4, 5, 6)), range(1, 7)):
        spheres.scatter_atoms("v", 1, 3, data)
        assert spheres.gather_atoms("v", 1, 3)[:] == [float(a) for a in np.ravel(data)]
    for data in (np.int64([2, 1]), np.int8([2, 1]), (2, 1), (ctypes.c_int * 2)(2, 1)):
        spheres.scatter_atoms("type", 0, 1, data)
        assert spheres.gather_atoms("type", 0, 1)[:] == [2, 1]
