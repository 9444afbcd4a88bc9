//! The page about the interactive session.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const PROMPT: Entry = (
    "prompt",
    Doc {
        syntax: Syntax::Written(
            "perigrain repl [DECK] [switch …]   # the prompt, after DECK if there is one\n\
            help [NAME …]\n\
            :plan\n\
            :graph [FILE.dot]\n\
            :plot COLUMN …\n\
            :slice FORMULA x|y|z AT [WIDTH]\n\
            :show FILE.png\n\
            :undo [N]\n\
            :save FILE\n\
            :quit",
        ),
        summary: "The interactive session: lines of a deck are executed as they are typed.",
        text: TEXT,
        example: "perigrain repl",
    },
);

const TEXT: &str = "`perigrain` on a terminal, or `perigrain repl`, reads lines and carries each out at once. Every command of \
    a deck works. A line counts wholly or not at all: if it is refused or fails, a run included, the scene is as it was \
    before it, only files that were written stay. `perigrain repl < FILE` does the same without a terminal: mistakes are \
    shown, it continues after them, and the exit code is 1 if there was one.\n\n\
    Tab completes commands, styles, keywords, IDs, variables, files (of materials those built in, too), colours and words such as `INF`; what comes next stands dim behind the cursor, and \
    the right arrow takes a word that can only be one. A line continues after `&` at its end and inside `\"\"\"`. The history is \
    kept in `$XDG_STATE_HOME/perigrain/history` (`~/.local/state` without that). Ctrl-C stops a run at a whole step, \
    Ctrl-D leaves. No log is written without `-log FILE`.\n\n\
    - `help NAME` shows a page of this manual, as `help pair_style granular`; `?NAME` and `NAME?` do the same.\n\
    - `%time LINE` executes a line and prints how long it took; `exit` and `:q` leave. Other habits (`ls`, `!ls`, `plot`) get a hint what to write.\n\
    - `:plan` prints what each step of a run now would do; `:graph` lists the lines that count (a run that was stopped as far as it went) and whose names they use, or \
    writes the graph for graphviz.\n\
    - `:plot pe ke` draws columns of the step tables over the step, in one plot if they are of one size.\n\
    - `:slice c_damage z 0` draws the particles that a plane cuts, coloured by a formula as an atom-style variable would have \
    it (without blanks); WIDTH makes the cut thicker than the particles are.\n\
    - `:show FILE.png` shows a picture, such as one of `dump image`.\n\
    - `:undo` goes back to before the last line that counts, `:undo 3` by three. The snapshots for it may take 1 GiB together; \
    beyond that the oldest go, and a message says so. Files and the settings of the log stay.\n\
    - `:save FILE` writes the lines that count as a deck that comes to the same numbers; a run that was stopped becomes a run \
    of that many steps. What was included stands in it, unless the file has loops, and files are named from where it lies.\n\n\
    Loops need a file: `jump SELF` at the prompt is refused, `include in.loop` works with all its labels and jumps, and so does \
    `jump FILE label`. An `include` is one line: a mistake in the file takes all of it back.";
