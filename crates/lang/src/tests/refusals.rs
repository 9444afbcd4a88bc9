//! What LAMMPS refuses is refused here, with words that help.

use super::output_of;

#[test]
fn conditions_as_lammps_has_them() {
    let holds = |c: &str| output_of(&format!("if \"{c}\" then \"print yes\" else \"print no\"\n"));
    for (condition, expected) in [
        ("a==a", "yes\n"),
        ("a==b", "no\n"),
        ("a != b", "yes\n"),
        ("1==1 && (2>3 || !0)", "yes\n"),
        ("1|^1", "no\n"),
        ("-1", "yes\n"),
        ("0", "no\n"),
        ("1e5==100000.0", "yes\n"),
        ("1==1==1", "yes\n"),
        ("$(1>0)", "yes\n"),
        ("!(1 > 2)", "yes\n"),
    ] {
        assert_eq!(holds(condition), expected, "{condition}");
    }
    // LAMMPS refuses all of these
    for refused in [
        "a<b",
        "a==1",
        "a",
        "1 2",
        "a && b",
        "1+1",
        "x y == x y",
        "1 = 1",
        "",
        "(1",
        "1 ==",
        "foo.bar == foo.bar",
    ] {
        assert!(holds(refused).starts_with("error"), "{refused}");
    }
}

#[test]
fn refusals_of_lines() {
    // each deck is refused by LAMMPS too, except where perigrain does not have a style yet
    for (deck, printed) in [
        ("print \"abc\n", "unmatched double quote"),
        ("print don't\n", "unmatched single quote"),
        ("print \"\"\"a\n", "unmatched triple quote"),
        ("print \"abc\"def\n", "closing quote must be followed by a space"),
        ("print 'a\"b'\n", "unmatched double quote"),
        ("print $\n", "a variable's name is expected after $"),
        ("print ${x\n", "never closed by }"),
        ("print $(1\n", "never closed by )"),
        ("print ${}\n", "is not defined"),
        ("print $x\n", "variable `x` is not defined"),
        ("print $(1:%d)\n", "no format for a number"),
        ("print $(1:abc)\n", "no format for a number"),
        // LAMMPS 22Jul2025: "Incorrect conversion in format string" for each
        ("print $(1:%g)\n", "must be % with a width and a precision"),
        ("print $(1:%8.f)\n", "must be % with a width and a precision"),
        ("print $(1:%-8.3f)\n", "must be % with a width and a precision"),
        ("print $(1:%.3lg)\n", "must be % with a width and a precision"),
        ("print $(1:a%.3f)\n", "must be % with a width and a precision"),
        ("variable y equal 2\nvariable x format y %lg\n", "has a flag or length"),
        ("variable y equal 2\nvariable x format y %+.3f\n", "has a flag or length"),
        ("print $()\n", "a number, a name or ( is expected"),
        ("variable a.b equal 1\n", "cannot name a variable"),
        ("variable x index\n", "at least one value is missing"),
        ("variable x loop 0\n", "has no turns"),
        ("variable x loop 5 3\n", "has no turns"),
        ("variable x loop 1.5\n", "must be a whole number"),
        ("variable x loop 3 pad extra\n", "does not expect `extra`"),
        ("variable x index 1\nvariable x string b\n", "is of style index already"),
        ("variable x equal 2\nvariable x atom 1\n", "is of style equal already"),
        ("variable x string a b\n", "does not expect `b`"),
        ("variable x python f\n", "no python variables"),
        ("variable x file none\n", "the file `none` does not exist"),
        ("variable x vector 3\nprint $x\n", "a global vector is needed"),
        ("variable x vector [1,2]\nprint $(v_x[3])\n", "has elements 1 to 2"),
        ("variable x vector [1,2]\nprint $(v_x)\n", "yields a global vector; one number is needed"),
        ("variable x world a b\n", "2 values for the one partition there is"),
        ("variable x uloop 2 5\n", "does not expect `5`"),
        ("variable x uloop 2\nvariable y universe a b c\n", "equally many values"),
        ("variable x internal 1/3\n", "must be a number"),
        ("variable x world a\nnext x\n", "next moves index, loop"),
        ("variable y equal 1\nvariable x format y x%.1f\n", "more than a conversion"),
        ("label a\njump SELF a\n", "this loop never ends"),
        ("label a\nvariable i loop 3\nvariable i delete\njump SELF a\n", "this loop never ends"),
        ("variable i equal 0\nlabel a\nvariable i equal 1-$i\njump SELF a\n", "this loop never ends"),
        ("variable x eqal 1\n", "did you mean `equal`?"),
        ("variable x atom 1\nprint $x\n", "one value per particle and cannot become text"),
        ("variable x string abc\nvariable y equal v_x*2\nprint $y\n", "holds `abc`, which is no number"),
        ("variable x index 5\nprint $(v_x[1])\n", "has no elements"),
        ("variable x format y %8.3f\n", "variable `y` is not defined"),
        ("variable y index 2\nvariable x format y %8.3f\n", "an equal, timer or internal variable is needed"),
        ("variable y equal 2\nvariable x format y %d\n", "no format for a number"),
        ("variable x equal v_y\nvariable y equal v_x\nprint $x\n", "depends on itself"),
        ("next x\n", "variable `x` is not defined"),
        ("next\n", "is missing"),
        ("variable x equal 1\nnext x\n", "next moves index, loop, file"),
        ("variable x index 1 2\nvariable y loop 2\nnext x y\n", "must have the same style"),
        ("label\n", "is missing"),
        ("label a b\n", "does not expect `b`"),
        ("jump\n", "is missing"),
        ("quit 3 4\n", "does not expect `4`"),
        ("quit abc\n", "must be a whole number"),
        ("if \"1>0\" the \"print a\"\n", "expected then"),
        ("if \"1>0\" then\n", "is missing"),
        ("if 0 then \"print a\" else \"print b\" elif 1 \"print c\"\n", "can never be reached"),
    ] {
        let out = output_of(deck);
        assert!(out.starts_with("error") && out.contains(printed), "{deck}{out}");
    }
}
