//! The pages of the commands that are no styles: declarations, flow of the deck, output, the session itself.

use crate::styles::Doc;

/// Name and page of each.
pub const PAGES: &[(&str, Doc)] = &[
    page(
        "pair_style",
        "pair_style STYLE args",
        "Says how particles act upon each other; replaces what was said before.",
        "The styles have pages of their own. `pair_style none` takes all forces between particles away.",
        "pair_style peri/pmb",
    ),
    page(
        "pair_coeff",
        "pair_coeff I J args",
        "Gives the coefficients of a pair of types.",
        "I and J are types or ranges: `2`, `*`, `2*`, `*4`, `2*4`. With `hybrid` the words begin with the name of the \
         sub-style. What follows stands on the page of the pair style. Every pair of types needs coefficients before a \
         run; styles that can mix fill the pairs i ≠ j in.",
        "pair_style peri/pmb\npair_coeff * * 2.0e21 0.0030001 0.004 0.25",
    ),
    page(
        "peri_modify",
        "peri_modify [force density|newton] [volume lammps|none|full]",
        "Chooses what peridynamic forces are and how bonds at the edge of the horizon count.",
        "`force density` (with numbers as coefficients): forces per volume, with the density as mass, as in LAMMPS. \
         `force newton` (with `material` coefficients): true forces on particles of mass ρV, so that bodies and grains \
         exchange momentum. `volume`: see pair_style peri/pmb.",
        "peri_modify force newton volume full",
    ),
    page(
        "fix",
        "fix ID group STYLE args",
        "Does something to the particles of a group at every step.",
        "A second fix with the same ID and style replaces the first. Order counts: of two fixes that set a force the later \
         one wins.",
        "fix 1 all nve",
    ),
    page("unfix", "unfix ID", "Removes a fix.", "", "fix 9 all nve\nunfix 9"),
    page(
        "fix_modify",
        "fix_modify ID [energy yes|no] …",
        "Changes options of a fix.",
        "`energy yes` adds the fix's energy to the potential energy, for fixes that have one. Other options stand on the \
         page of the fix.",
        "fix ball all indent 1.0e20 sphere 0 0 0.01 0.005 units box\nfix_modify ball energy yes",
    ),
    page(
        "compute",
        "compute ID group STYLE args",
        "Names a quantity, to be computed whenever somebody asks for it.",
        "Used as `c_ID`, `c_ID[i]`, per particle in dumps and formulas, of one particle as `C_ID[id][column]`. It is computed \
         at most once per step, and only in steps where it is needed.",
        "compute energy all ke",
    ),
    page("uncompute", "uncompute ID", "Removes a compute.", "", "compute e all ke\nuncompute e"),
    page(
        "compute_modify",
        "compute_modify ID keyword value …",
        "Changes options of a compute.",
        "Which there are stands on the page of the compute.",
        "compute t all temp\ncompute_modify t extra/dof 0",
    ),
    page(
        "dump",
        "dump ID group STYLE N FILE args",
        "Writes the particles of a group every N steps.",
        "A `*` in the file name becomes the step and makes one file per snapshot. Snapshots are sorted by id unless \
         `dump_modify` says otherwise. Numbers printed need fewer digits than numbers computed: `dump_modify format float`.",
        "dump 1 all custom 100 plate.dump id type x y z vx vy vz",
    ),
    page(
        "undump",
        "undump ID",
        "Ends a dump and closes its file.",
        "",
        "dump 1 all atom 100 a.dump\nundump 1",
    ),
    page(
        "dump_modify",
        "dump_modify ID [append yes|no] [every N] [first yes|no] [format …] [pad N] [region ID] [sort id|off|N|-N] \
         [thresh attribute op value] …",
        "Changes options of a dump.",
        "`format line \"…\"`, `format float %.15g`, `format int %d`, `format K …` for the K-th column; `thresh` keeps \
         only particles for which the comparison holds (`< <= > >= == !=`), several add up, `thresh none` forgets them; `pad` \
         fills the step in file names with zeros. Options of dump image stand on its page.",
        "dump 1 all custom 100 p.*.dump id x y z\ndump_modify 1 pad 6 format float %.15g first yes",
    ),
    page(
        "write_dump",
        "write_dump group STYLE FILE args [modify options]",
        "Writes one snapshot now.",
        "The words are those of `dump` without ID and interval, then those of `dump_modify`.",
        "write_dump all custom final.dump id x y z modify sort id format float %.15g",
    ),
    page(
        "thermo",
        "thermo N",
        "Prints a row of the step table every N steps.",
        "N may be a variable, `v_name`, that says the next step to print at. 0: only at the beginning and the end of a run.",
        "thermo 100",
    ),
    page(
        "thermo_style",
        "thermo_style one|multi|yaml|custom columns",
        "Chooses the columns of the step table.",
        "Columns are the words step, elapsed, elaplong, dt, time, cpu, tpcpu, spcpu, cpuremain, part, atoms, temp, press, pe, \
         ke, etotal, evdwl, epair, enthalpy, econserve, vol, density, lx … zhi, pxx … pyz, xlat … and values: c_ID, c_ID[i], c_ID[*], \
         f_ID, f_ID[i], v_name. A new thermo_style forgets earlier `thermo_modify` settings, as in LAMMPS.",
        "thermo_style custom step time pe ke etotal",
    ),
    page(
        "thermo_modify",
        "thermo_modify [norm yes|no] [flush yes|no] [line one|multi|yaml] [format …] [colname …] [temp ID] [press ID] [lost error]",
        "Changes options of the step table.",
        "`norm yes` (usual with units lj) divides extensive values by the number of particles. `format float %20.15g`, `format \
         int …`, `format K …`, `format line \"…\"`. `colname K name` renames a column.",
        "thermo_modify norm no format float %20.15g",
    ),
    page(
        "run",
        "run N [upto] [start S] [stop S] [pre yes|no] [post yes|no] [every M \"command\" …]",
        "Makes N steps.",
        "`upto` counts from step 0; `start` and `stop` enclose several runs for what ramps over a run; `every M` carries out \
         commands after each M steps. Cutting a run in two with a second `run` changes no bit of the result (with `compat \
         lammps` it does, as in LAMMPS).",
        "run 10 every 5 \"print hello\"",
    ),
    page(
        "variable",
        "variable NAME equal|atom FORMULA\nvariable NAME index|string|getenv|format|loop …\nvariable NAME delete",
        "Names a formula, a text or a list.",
        "`equal` and `atom` formulas are evaluated whenever they are used, `atom` per particle. `index a b c`, `loop N`, `loop \
         N1 N2 [pad]`: `next` moves on to the next value; an index variable given with `-var` keeps that. `format of %8.3f` \
         prints another variable.\n\nUse: `$x`, `${name}` (text put into the line), `$(formula)`, `$(formula:%8.3f)`, `v_name` \
         (in formulas and where values are taken).\n\nFormulas: + - * / ^ %, comparison, && || |^ !, parentheses; PI; \
         sqrt exp ln log abs sin cos tan asin acos atan atan2 random normal ceil floor round sign ternary ramp stagger logfreq \
         stride vdisplace swiggle cwiggle; group functions count mass xcm vcm fcm bound gyration ke angmom torque inertia omega, \
         as `vcm(ball,z)` or within a region `vcm(ball,z,upper)`; `x[7]`, `vx`, `mass`, `type`, `id` … of particles; the words of thermo_style; `c_ID`, `f_ID`, \
         `v_name` with indices. As in LAMMPS unary minus binds tighter than ^: -2^2 is 4.",
        "variable E equal 22.35e9\nvariable K equal v_E/3/(1-2*0.25)\nprint \"K = ${K}\"",
    ),
    page(
        "if",
        "if CONDITION then \"command\" … [elif CONDITION \"command\" …] [else \"command\" …]",
        "Carries out commands if a condition holds.",
        "The condition is one word (quote it): numbers or texts with == != < <= > >= && || |^ and parentheses.",
        "variable n index 3\nif \"$n > 2\" then \"print large\" else \"print small\"",
    ),
    page("label", "label NAME", "Marks a place for jump.", "", "label here"),
    page(
        "jump",
        "jump FILE|SELF [LABEL]",
        "Goes on reading elsewhere.",
        "After `next` has run out of values the following jump is passed over: this ends a loop.",
        "variable i loop 3\nlabel again\nprint \"$i\"\nnext i\njump SELF again",
    ),
    page(
        "next",
        "next NAME …",
        "Moves index and loop variables on to their next value.",
        "When there is none the variable is forgotten and the next `jump` is passed over.",
        "variable i loop 2\nnext i",
    ),
    page("include", "include FILE", "Reads another deck here.", "", ""),
    page("quit", "quit [STATUS]", "Ends the deck, with an exit code if one is given.", "", "quit 0"),
    page(
        "print",
        "print \"text\" [file NAME] [append NAME] [screen yes|no]",
        "Prints a text with its variables.",
        "`file` and `append` write it to a file too.",
        "print \"box $(lx) x $(ly)\"",
    ),
    page("log", "log FILE|none [append]", "Goes on with the log in another file.", "", "log none"),
    page(
        "echo",
        "echo none|screen|log|both",
        "Says where the lines of the deck are repeated.",
        "",
        "echo screen",
    ),
    page("clear", "clear", "Forgets everything but the variables.", "", "clear"),
    page(
        "compat",
        "compat lammps|none",
        "Computes what LAMMPS 22Jul2025 computes also where it is wrong.",
        "Like `-compat lammps` on the command line. What that means stands in \"Coming from LAMMPS\".",
        "compat lammps",
    ),
    page(
        "suffix",
        "suffix …",
        "Accepted for the sake of LAMMPS decks: perigrain chooses its kernels itself.",
        "",
        "suffix omp",
    ),
    page(
        "package",
        "package …",
        "Accepted for the sake of LAMMPS decks: threads are set with `-threads`.",
        "",
        "package omp 2",
    ),
];

const fn page(
    name: &'static str,
    syntax: &'static str,
    summary: &'static str,
    text: &'static str,
    example: &'static str,
) -> (&'static str, Doc) {
    (name, Doc { syntax, summary, text, example })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::build::DECLARATIONS;
    use crate::session::commands::OWN;

    #[test]
    fn every_command_has_its_page() {
        for name in DECLARATIONS.iter().chain(&OWN) {
            // pair_modify is refused by name: no pair style here has its options.
            let found = PAGES.iter().filter(|(n, _)| n == name).count();
            assert_eq!(found, usize::from(*name != "pair_modify"), "{name}");
        }
        assert_eq!(PAGES.len(), DECLARATIONS.len() + OWN.len() - 1);
    }
}
