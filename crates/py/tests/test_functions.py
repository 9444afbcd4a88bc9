"""Functions of Python in a deck: the command `python` and variables of style `python`; the program as a module; benches."""

import subprocess
import sys

import pytest

import perigrain

CODE = """
units lj
atom_style sphere
region b block 0 1 0 1 0 1
create_box 1 b
create_atoms 1 single 0.3 0.3 0.3
set group all diameter 0.1
set group all mass 1.0
variable n equal step
python square input 1 v_n return v_square format ff here \"\"\"
def square(n):
    return n * n
\"\"\"
variable square python square
"""


def test_a_variable_is_what_a_function_gives(make):
    lmp = make(CODE + "fix 1 all nve\nvariable twice equal 2*v_square\nthermo_style custom step v_twice\n")
    lmp.command("run 3")
    assert lmp.get_thermo("v_square") == 9.0
    assert lmp.get_thermo("v_twice") == 18.0
    assert lmp.expand("${square}") == "9"
    # evaluated each time
    lmp.command("run 1")
    assert lmp.get_thermo("v_square") == 16.0


def test_texts_whole_numbers_and_functions_of_the_program(make):
    import __main__

    said = []
    __main__.label = lambda k, text: said.append((k, text)) or f"{text}-{k}"
    lmp = make("variable k index 7\npython label input 2 v_k grain return v_name format iss exists\nvariable name python label")
    assert lmp.expand("file.${name}.txt") == "file.grain-7.txt"
    assert said == [(7, "grain")]
    lmp.command("python label invoke")
    assert len(said) == 2
    lmp.command("python source here 'known = 5'")
    assert __main__.known == 5
    with pytest.raises(perigrain.DeckError, match="no number"):
        lmp.eval("1+v_name")


def test_mistakes_of_functions_are_named(make):
    lmp = make("variable n index 2.5")
    for line, words in [
        ("python f input 1 v_n return v_x format if here 'f = abs'", None),
        ("variable y python g", None),
        ("python nowhere exists", "has no function"),
        ("python f input 1 SELF format p exists", "cannot have the scene"),
        ("python f input 2 1 2 format i exists", "1 letters for 2"),
        ("python f input 1 1 exists", "format"),
        ("python f input 1 1 format i", "where the function stands"),
        ("print ${y}", "no function `g`"),
    ]:
        if words is None:
            lmp.command(line)
            continue
        with pytest.raises(perigrain.DeckError, match=words):
            lmp.command(line)
    lmp.command("variable x python f")
    with pytest.raises(perigrain.DeckError, match="a whole number"):
        lmp.expand("${x}")
    lmp.command("python f input 0 return v_x format i here 'def f(): return \"five\"'")
    with pytest.raises(perigrain.DeckError, match="gave back a text"):
        lmp.expand("${x}")
    lmp.command("python f input 0 return v_x format i here 'def f(): return 1/0'")
    with pytest.raises(ZeroDivisionError):
        lmp.expand("${x}")
    with pytest.raises(ZeroDivisionError):
        lmp.command("print ${x}")
    with pytest.raises(SyntaxError):
        lmp.command("python source here 'def'")
    lmp.command("print fine")


def program(*words, **options):
    return subprocess.run([sys.executable, "-m", "perigrain", *words], capture_output=True, text=True, **options)


def test_the_module_is_the_program(tmp_path):
    (tmp_path / "in.deck").write_text("print hello\nvariable x python f\n")
    ended = program("-in", "in.deck", "-log", "none", cwd=tmp_path)
    assert "hello" in ended.stdout and ended.returncode == 1
    assert "no Python inside" in ended.stderr
    version = program("-version")
    assert version.returncode == 0 and version.stdout.startswith("perigrain ") and version.stdout.endswith(", python\n")


FALL = """
units lj
atom_style sphere
variable dt index 0.1
region b block -1 1 -1 1 -100 1
create_box 1 b
create_atoms 1 single 0 0 0
set group all diameter 0.1
set group all mass 1.0
fix 1 all nve
fix 2 all viscous 0.5
fix 3 all gravity 1.0 vector 0 0 -1
timestep ${dt}
thermo 1000
run $(round(2/v_dt))
"""


def test_a_bench_has_errors_and_orders(tmp_path):
    table = perigrain.bench(FALL, {"dt": [0.1, 0.05, 0.025]}, "ke", folder=tmp_path)
    assert len(table) == 3 and (table["seconds"] >= 0.0).all()
    assert table["ke_error"][0] > table["ke_error"][1] > 0.0
    # Verlet with drag, errors against the finest run: a ratio of (0.1 - 0.025)/(0.05 - 0.025) for first order, 5 for second.
    assert 1.0 < table["ke_order_dt"][1] < 3.0
    assert (tmp_path / "bench" / "bench.csv").is_file()
    with pytest.raises(perigrain.BenchError, match="dtt"):
        perigrain.bench(FALL, {"dtt": [0.1, 0.05]}, "ke")
