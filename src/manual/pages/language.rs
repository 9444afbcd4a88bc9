//! Pages of the deck language: how a deck is written, variables, branches and loops.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const DECKS: Entry = (
    "decks",
    Doc {
        syntax: Syntax::Written(
            "# decks hold one command per line\ncommand word word …\ncommand word $x ${name} $(formula) \"words in quotes\" &\n    word",
        ),
        summary: "How a deck is written: lines, words, quotes, values put in.",
        text: "A deck is executed line by line from the top; a line that is refused changes nothing and ends the \
            deck. `#` outside quotes starts a comment. `&` at the end of a line joins the next one to it. Words are \
            separated by blanks. `'…'` and `\"…\"` keep blanks together, `\"\"\"…\"\"\"` also line breaks and the other two \
            kinds of quotes; a closing quote must be followed by a blank.\n\n\
            Before a line is split into words, values are put in outside quotes:\n\n\
            - `${name}` is the value of a variable, `$x` that of a variable whose name is one letter;\n\
            - `$(formula)` is the value of a formula with 20 digits, `$(formula:%.3f)` in a C format (one `%g`, `%f` \
            or `%e`); see [formulas](formulas.md).\n\n\
            Inside quotes a `$` stays as it is; `print`, `if` and `variable … string` put values in when they use the \
            text. Numbers are written like `5`, `-0.25` or `1.5e-8`; `inf`, `nan` and anything with letters left over is \
            refused.\n\n\
            A mistake is shown with its file and line, the word underlined, and what was expected. `perigrain check` \
            shows all mistakes of a deck at once, `perigrain explain PG0102` explains the code of a message.\n\n\
            As in LAMMPS, with one difference: a word that is not understood is always an error, and so is a command of \
            LAMMPS that is not there yet.",
        example: "variable dx equal 0.001     # a comment\n\
            variable name string \"plate of ${dx}\"\n\
            print \"${name}: half a spacing is $(v_dx/2:%.4f) m, &\n\
            a third $(v_dx/3)\"",
    },
);

pub(super) const VARIABLE: Entry = (
    "variable",
    Doc {
        syntax: Syntax::Written(
            "variable NAME equal formula\n\
            variable NAME atom formula\n\
            variable NAME vector formula | [1,3,7]\n\
            variable NAME index value …\n\
            variable NAME loop N | N1 N2 [pad]\n\
            variable NAME string \"text\"\n\
            variable NAME file FILE\n\
            variable NAME atomfile FILE\n\
            variable NAME getenv KEY\n\
            variable NAME format OTHER %.6g\n\
            variable NAME timer\n\
            variable NAME internal number\n\
            variable NAME world value\n\
            variable NAME universe value …\n\
            variable NAME uloop N [pad]\n\
            variable NAME delete",
        ),
        summary: "Defines a variable: a formula, a list to loop over, a text, a file.",
        text: "- `equal`: a [formula](formulas.md) that yields one number. It is kept as a formula and evaluated at \
            each use, so `${NAME}` after a run sees the new state; as text it has 15 digits (`%.15g`).\n\
            - `atom`: a formula with one value per particle, from attributes such as `x` or `vz`. Used by `group … \
            variable`, `set`, `velocity`, `dump custom`, `compute reduce`; it cannot be put into a line.\n\
            - `vector`: a formula that yields a global vector, or its numbers in brackets. As text it is `[1,3,7]`; \
            `v_NAME[2]` is its second element.\n\
            - `index`: a list of texts, `loop`: the whole numbers from 1 (or `N1`) to `N`; `next` moves to the next \
            one. `pad` writes all numbers with the digits of the last one.\n\
            - `string`: a text; values in it are put in now.\n\
            - `file`: the lines of a file one after the other, without comments and blank lines; `next NAME`, or \
            `next(NAME)` in a formula, moves to the next one.\n\
            - `atomfile`: values per particle from a file: a line with a number N, then N lines with a particle's id and \
            its value; particles that are not named have 0. A file may hold several such sets, `next` moves through them. \
            `clear` forgets the variable.\n\
            - `getenv`: the environment variable `KEY` (empty if it is not set); `shell putenv` sets one.\n\
            - `format`: a number of an equal, timer or internal variable in a C format, one `%g`, `%f` or `%e` and \
            nothing else.\n\
            - `timer`: the moment of this line in seconds; the difference of two is the time between them.\n\
            - `internal`: a number that some commands change.\n\
            - `world` `universe` `uloop`: for the partitions of `-partition`: `world` takes one value for each of them; of `universe` \
            (a list of texts) and `uloop` (the numbers from 1 to N) each begins with its own, and `next` takes the first that no partition has had. \
            All such variables have equally many values, at least one per partition, and stand in the same `next`. With one \
            partition they are like `index` and `loop`.\n\
            - `delete` forgets the variable.\n\n\
            Names have letters, digits and underscores. An `index loop world universe uloop file` or `atomfile` line for \
            a name that exists does nothing: that is how `-var NAME value` on the command line wins over the deck, and how \
            a loop does not start over. The other styles replace a variable of the same style and refuse to replace one of \
            another style.\n\n\
            A formula may stand in quotes or, unlike LAMMPS, as several words. `variable NAME python FUNCTION` is what a function in \
            Python gives, called at each use; only where Python hosts the run, with the command `python` before it \
            ([Drive it from Python](../python.md)). In a terminal it is refused: there is no Python inside.",
        example: "variable v index 35 70 160\n\
            variable n loop 3 pad\n\
            variable energy equal 0.5*mass(ball)*v_v^2\n\
            variable height atom z-0.001\n\
            variable speeds vector [35,70,160]\n\
            variable text string \"impact at $v m/s, the fastest at $(max(v_speeds)) m/s\"\n\
            variable short format energy %.3g\n\
            variable start timer\n\
            print \"${text}: ${short} J, turn $n of ${speeds}\"",
    },
);

pub(super) const IF: Entry = (
    "if",
    Doc {
        syntax: Syntax::Written(
            "if \"condition\" then \"command\" … [elif \"condition\" \"command\" …] … [else \"command\" …]",
        ),
        summary: "Carries out commands if a condition holds.",
        text: "A condition compares numbers with `== != < <= > >=` or names with `== !=`, joined by `&& || |^` \
            (exclusive or) and `!`, with parentheses; a number alone is true when it is not zero. Values are put into the \
            condition first. It knows no arithmetic: write `$(v_a+1) > 2`.\n\n\
            Every command is one word, so put quotes around it; inside `\"…\"` use `'…'` or `\"\"\"…\"\"\"`. The commands of \
            the first branch whose condition holds are carried out as if they stood in the deck, `jump` included.\n\n\
            Where a deck is only checked, a condition may depend on what only a run determines; `0 && …` is false all the             same. `perigrain check` then checks every branch that may be taken, `perigrain plan` executes the first of them.             Variables that any of them sets are unknown behind it, a `jump` or `quit` in them is passed over, and `clear` is left out.",
        example: "variable v index 35\n\
            if \"$v > 100 && $(count(plate)) > 0\" then &\n    \"print 'fast'\" &\n  elif \"$v == 35\" &\n    \"print 'slow'\" \
            \"variable slow index yes\" &\n  else \"print 'neither'\"",
    },
);

pub(super) const LABEL: Entry = (
    "label",
    Doc {
        syntax: Syntax::Written("label NAME"),
        summary: "Marks a place in a deck for `jump`.",
        text: "It does nothing by itself. When a `jump` looks for `NAME`, all lines up to the first `label NAME` are \
            passed over.",
        example: "variable i loop 2\nlabel again\nprint \"turn $i\"\nnext i\njump SELF again",
    },
);

pub(super) const JUMP: Entry = (
    "jump",
    Doc {
        syntax: Syntax::Written("jump FILE|SELF [LABEL]"),
        summary: "Continues in another file, or at a label.",
        text: "Reading continues at the top of `FILE` (`SELF`: the present one), with `LABEL` at the first `label LABEL` \
            after that. There is no way back: `include` is the command that returns. A `jump` right after a `next` that \
            ran out is passed over, which is how loops end. From an included file it leaves the rest of that file only. \
            A file is looked for in the working folder, then beside the deck. As in LAMMPS no values are put into `label` lines while they are \
            searched.\n\n\
            A loop that can never end is refused: when a jump is made again and no variable, file or scene has changed \
            since. `perigrain check` and `perigrain plan` follow a loop for 10,000 turns, and one that ends by something only a             run determines for one turn: what its lines set is unknown behind it.\n\n\
            `jump SELF` also works for a deck on standard input. Inside `run … every` it is refused.",
        example: "jump SELF later\nprint \"this line is passed over\"\nlabel later",
    },
);

pub(super) const NEXT: Entry = (
    "next",
    Doc {
        syntax: Syntax::Written("next NAME …"),
        summary: "Moves variables with several values to their next one.",
        text: "All variables of one line must be of the same style, `index loop file atomfile universe` or `uloop`, and \
            move together (`universe` and `uloop` count as one style). When one of them has no further value it is \
            deleted, and the next `jump` is passed over.",
        example: "variable v index 35 70 160\nlabel impact\nprint \"at $v m/s\"\nnext v\njump SELF impact",
    },
);

pub(super) const INCLUDE: Entry = (
    "include",
    Doc {
        syntax: Syntax::Written("include FILE"),
        summary: "Executes another file, then continues.",
        text: "The file is looked for in the working folder, then beside the deck. Files and then-commands may nest 100 deep, so a file that \
            includes itself is refused. `if … then \"include FILE\"` includes under a condition.",
        example: "include plate.inc",
    },
);

pub(super) const QUIT: Entry = (
    "quit",
    Doc {
        syntax: Syntax::Written("quit [status]"),
        summary: "Ends the deck.",
        text: "All files are finished and the program ends with the exit code `status` (0; numbers beyond 0 … 255 \
            are cut to that range). Inside `run … every` it ends the run as well.",
        example: "if \"$(count(plate)) < 1\" then \"print 'nothing is left'\" \"quit 3\"",
    },
);
