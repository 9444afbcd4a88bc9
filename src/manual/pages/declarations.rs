//! Pages of the commands that declare: pair styles, fixes, computes, dumps, and their options.

use super::Entry;
use crate::graph::heads::{self, OfCompute, OfDump, OfFix};
use crate::graph::pair_modify::PairModify;
use perigrain_styles::Doc;
use perigrain_styles::words::{Syntax, Words};

pub(super) const PAIR_STYLE: Entry = (
    "pair_style",
    Doc {
        syntax: Syntax::Behind(&heads::PAIR_STYLE),
        summary: "Chooses the forces between particles.",
        text: "`perigrain doc` lists the styles; each has a page of its own, as `perigrain doc pair_style peri/pmb`. Another \
            style forgets the coefficients of the old one, and so does `hybrid`; the same style again keeps them. With `none`, or without the command, particles do not \
            feel each other; a run then draws a warning.",
        example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0030001 5.0e-4 0.25",
    },
);

pub(super) const PAIR_COEFF: Entry = (
    "pair_coeff",
    Doc {
        syntax: Syntax::Behind(&heads::PAIR_COEFF),
        summary: "Gives the coefficients of the pair style for some types.",
        text: "The smaller type comes first; a line that names none is refused. A later line replaces what an earlier one gave. What the \
            words are is on the page of the pair style. It needs `pair_style` and the box before it, and every pair of \
            types must have coefficients, its own or mixed ones where the style can mix, when a run begins. With `hybrid` the \
            words begin with the name of the sub-style.",
        example: "pair_style peri/pmb\npair_coeff * * 1.6863e22 0.0030001 5.0e-4 0.25\npair_coeff 1 2*3 1.0e22 0.0030001 1.0e-4 0.0",
    },
);

pub(super) const PAIR_MODIFY: Entry = (
    "pair_modify",
    Doc {
        syntax: Syntax::Behind(PairModify::GRAMMAR),
        summary: "How types are mixed, and options of LAMMPS' pair styles that have no effect here.",
        text: "A note names the words that change nothing. `special` would change forces and is refused.",
        example: "pair_modify shift yes mix geometric",
    },
);

pub(super) const BOND_STYLE: Entry = (
    "bond_style",
    Doc {
        syntax: Syntax::Behind(&heads::BOND_STYLE),
        summary: "Chooses the forces along bonds.",
        text: "Each style has a page of its own, as `perigrain doc bond_style harmonic`. Needs an atom style with bonds. A new \
            `bond_style` forgets the coefficients of the old one; with `none`, or without the command, bonds exert no forces and \
            a run of a scene with bonds draws a warning. Restart files hold style and coefficients.",
        example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                  create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\n\
                  bond_style harmonic\nbond_coeff 1 50.0 1.0\nfix 1 all nve\nrun 10",
    },
);

pub(super) const BOND_COEFF: Entry = (
    "bond_coeff",
    Doc {
        syntax: Syntax::Behind(&heads::BOND_COEFF),
        summary: "Gives the coefficients of the bond style for some bond types.",
        text: "What the words are is on the page of the bond style; \
            with `hybrid` they begin with the name of the sub-style. It needs `bond_style` and the box before it, and every \
            bond type must have coefficients when a run begins.",
        example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                  create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2.1 1 1\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\n\
                  bond_style harmonic\nbond_coeff 1 50.0 1.0\nfix 1 all nve\nrun 10",
    },
);

pub(super) const PERI_MODIFY: Entry = (
    "peri_modify",
    Doc {
        // The lines stand on the pages of the pair styles.
        syntax: Syntax::Forms(&[]),
        summary: "Sets options of the peridynamic pair styles.",
        text: "With `force newton` grains and bodies exchange momentum, and energies add up in one scene. See `pair_style \
            peri/pmb`. LAMMPS has no such command.",
        example: "peri_modify force newton volume full",
    },
);

pub(super) const FIX: Entry = (
    "fix",
    Doc {
        syntax: Syntax::Behind(&heads::FIX),
        summary: "Declares something that is done to particles in every step.",
        text: "`perigrain doc` lists the styles; each has a page of its own, as `perigrain doc fix nve`. Within a stage of the step, fixes act in the order of their lines. The same \
            ID with the same style replaces the old fix in its place, with a warning if the group is another one; with another \
            style it is refused. Values of a fix are `f_ID` and `f_ID[i]` in formulas, thermo output and dumps.",
        example: "fix 1 all nve\nfix calm plate viscous 1.0e-3",
    },
);

pub(super) const FIX_MODIFY: Entry = (
    "fix_modify",
    Doc {
        syntax: Syntax::Behind(&heads::FIX_MODIFY),
        summary: "Sets options of a fix.",
        text: "Fixes without such a level refuse `respa`. Other keywords belong to the fix and stand on its \
            page. LAMMPS' `virial`, `temp`, `press`, `dynamic/dof` and `bodyforces` are refused unless the page names them.",
        example: "fix tip all indent 1.0e9 sphere 0 0 0.006 0.004 units box\nfix_modify tip energy yes",
    },
);

pub(super) const UNFIX: Entry = (
    "unfix",
    Doc {
        syntax: Syntax::Behind(OfFix::GRAMMAR),
        summary: "Removes a fix.",
        text: "What it has done to the particles stays. Thermo columns, dumps and variables that name it are refused at \
            the next run.",
        example: "fix calm all viscous 1.0e-3\nunfix calm",
    },
);

pub(super) const COMPUTE: Entry = (
    "compute",
    Doc {
        syntax: Syntax::Behind(&heads::COMPUTE),
        summary: "Declares a quantity to be computed from the particles.",
        text: "`perigrain doc` lists the styles; each has a page of its own, as `perigrain doc compute reduce`. A compute \
            costs nothing until something reads it, and is computed at most once in a step. `c_ID` is its number or its \
            value per particle, `c_ID[i]` an element of its vector or a column of values per particle. An ID that exists \
            is refused.\n\n\
            Three are there by themselves once there is a box: `thermo_temp` (temp), `thermo_press` (pressure) and \
            `thermo_pe` (pe).",
        example: "compute energy plate ke\nthermo_style custom step c_energy c_thermo_pe",
    },
);

pub(super) const COMPUTE_MODIFY: Entry = (
    "compute_modify",
    Doc {
        syntax: Syntax::Behind(&heads::COMPUTE_MODIFY),
        summary: "Sets options of a compute.",
        text: "Only temperatures have options; a note names those of other computes, which have no effect.",
        example: "compute_modify thermo_temp extra/dof 0",
    },
);

pub(super) const UNCOMPUTE: Entry = (
    "uncompute",
    Doc {
        syntax: Syntax::Behind(OfCompute::GRAMMAR),
        summary: "Removes a compute.",
        text: "Thermo columns, dumps and variables that name it are refused at the next run.",
        example: "compute energy all ke\nuncompute energy",
    },
);

pub(super) const DUMP: Entry = (
    "dump",
    Doc {
        syntax: Syntax::Behind(&heads::DUMP),
        summary: "Writes snapshots of particles every N steps.",
        text: "`perigrain doc` lists the styles; each has a page of its own, as `perigrain doc dump custom`. A `*` in the file name becomes \
            the step. Name and options are checked when the line is read; the file is made with the first snapshot. An ID \
            that exists is refused.",
        example: "dump 1 all custom 2 flow.*.txt id type x y z vx vy vz",
    },
);

pub(super) const DUMP_MODIFY: Entry = (
    "dump_modify",
    Doc {
        syntax: Syntax::Forms(&perigrain_dumps::MODIFIED),
        summary: "Sets options of a dump.",
        text: "The first line has the keywords of all dumps, the second those of all dumps of particles, the others those that \
            styles add, each on its page too. LAMMPS' further keywords are refused by name. In LAMMPS a dump is unsorted \
            unless set otherwise; here rows are sorted by id.",
        example: "dump 1 all custom 2 plate.*.txt id type x y z c_dmg\n\
            dump_modify 1 region half sort -1 pad 6 first yes format float %.8g thresh c_dmg >= 0",
    },
);

pub(super) const UNDUMP: Entry = (
    "undump",
    Doc {
        syntax: Syntax::Behind(OfDump::GRAMMAR),
        summary: "Ends a dump.",
        text: "Its file is complete and stays.",
        example: "dump 1 all atom 1 flow.txt\nrun 1\nundump 1",
    },
);
