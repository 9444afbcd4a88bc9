//! `run_style`: steps of one length, levels of steps within each other, or short ones for solids inside long ones for grains.

mod respa;

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::setting;
use perigrain_styles::words::{At, Forms, Kind, Or, Syntax, Value, Words};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::{MOST_SHORT, RunStyle, World};

/// The command.
pub struct RunStyleCommand;

/// The styles.
pub const RUN_STYLES: [&str; 3] = ["verlet", "respa", "staggered"];

impl Style for RunStyleCommand {
    fn name(&self) -> &'static str {
        "run_style"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "How steps are made: all alike, several lengths within each other, or short ones for solids inside long ones for grains.",
            text: "`respa` is the multi-level scheme of Tuckerman, Berne & Martyna (1992). `timestep`, and whatever counts steps, \
                   means the outermost. The forces of a level kick by half of its step at both of its ends, and particles move in \
                   level 1. LAMMPS' order bond ≤ angle ≤ dihedral ≤ improper ≤ pair ≤ kspace is held. `inner`, `middle` and `outer` \
                   are refused: no pair style here is cut up by distance.\n\n\
                   Under `respa` fixes act as in LAMMPS: addforce, addtorque, aveforce, drag, gravity, indent, setforce, spring, \
                   spring/self, viscous and viscous/sphere in the level that `fix_modify ID respa M` names, else the outermost; \
                   what takes components of forces away (setforce, aveforce, lineforce, planeforce, enforce2d, freeze) in every \
                   level, with its value in that one; walls in the outermost; `nve`, `nve/sphere` and `nve/limit` kick in every \
                   level, nve/noforce moves in level 1 and `move` in the outermost. Values of such a fix (f_ID) count all levels. \
                   Lists are made anew at the beginning of an outermost step.\n\n\
                   Springs and dashpots of contacts in a longer step go by the way of that step, and while springs stick no energy \
                   is made; LAMMPS, and `compat lammps`, takes its length times the velocity at its end, which makes energy where \
                   bonds swing in the shorter steps. Refused with the reason: rigid bodies, `fix move` with free components, \
                   energy/ledger, dt/guard and plastic grains (`mdr`).\n\n\
                   `staggered`: `timestep` is the long step. Contacts, walls and body forces kick all particles by half a long step \
                   at both of its ends; in between solids make m velocity-Verlet steps under their bonds alone. Momentum is \
                   conserved, contacts go by the way of the long step; with m = 1 the bits are those of `verlet`. `respa 2 m hybrid \
                   1 2`, with the peridynamic sub-style named first, comes to the same, but moves grains in the short steps too.\n\n\
                   What takes components of forces away (setforce, lineforce, planeforce, enforce2d, freeze) does so in both kinds \
                   of staggered step. Solids are moved by `fix nve` or `nve/sphere` there; other fixes that move them are refused.",
            example: "units si\n\
                atom_style hybrid sphere peri\n\
                boundary s s s\n\
                lattice sc 5.0e-4\n\
                region plate block -0.00126 0.00126 -0.00126 0.00126 -0.00101 0.00001 units box\n\
                region world block -0.002 0.002 -0.002 0.002 -0.002 0.003 units box\n\
                create_box 2 world\n\
                create_atoms 1 region plate\n\
                create_atoms 2 single 0.0 0.0 0.00127 units box\n\
                material glass E 65e9 nu 0.25 rho 2230 Gc 204\n\
                set type 1 diameter 5.0e-4 density 2230 volume 1.25e-10\n\
                set type 2 diameter 0.002 density 7800 volume 1.25e-10\n\
                group pd type 1\n\
                group grain type 2\n\
                pair_style hybrid/overlay peri/pmb granular\n\
                pair_coeff 1 1 peri/pmb material glass horizon 3.015\n\
                pair_coeff * 2 granular hertz/material 5e8 0.9 0.28 damping coeff_restitution tangential mindlin NULL 0.5 0.3\n\
                neighbor 2.0e-4 bin\n\
                velocity grain set 1.0 0.0 -10.0 units box\n\
                fix 1 pd nve\n\
                fix 2 grain nve/sphere\n\
                timestep 16.0e-8\n\
                run_style staggered m 4\n\
                run 20",
        }
    }
}

#[derive(Words)]
#[word(forms = "run_style", what = "run style", foreign = respa::not_split)]
enum Line {
    /// All steps are alike.
    Verlet,
    /// N levels of steps within each other, numbered from the shortest: n1 steps of level 1 make one of level 2, n2 of those one of level 3 …
    Respa(respa::Line),
    /// Short steps for solids inside long ones for grains.
    Staggered(Staggered),
}

#[derive(Words)]
struct Staggered {
    /// Short steps in a long one; `auto` takes the fewest that stay within 0.8 of the solids' stable step, and looks again when the step changes.
    #[word(
        keyword,
        name = "N",
        what = "the number of short steps in a long one, or auto",
        default = Or::Word(Auto::Auto),
        shown = "auto"
    )]
    m: Or<Auto, Steps>,
    #[word(keyword, default = Side::Solids)]
    faster: Side,
    #[word(keyword, placed, shown = "kick")]
    scheme: Option<At<Scheme>>,
}

/// The word in the place of a number of steps.
#[derive(Words)]
enum Auto {
    Auto,
}

/// A number of short steps.
struct Steps(i64);

impl Value for Steps {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        let steps = args.integer_from(1, what)?;
        refuse_many(steps, span).map(|()| Self(steps))
    }
}

/// Which side has the shorter steps.
#[derive(PartialEq, Words)]
#[word(what = "side with the shorter steps")]
enum Side {
    /// Solids make the shorter steps.
    Solids,
    /// Bonds act at every N-th step only, with N times their force; `timestep` is then the grains' step, and the forces that are printed are those
    /// that act.
    Grains,
}

/// How solids move in both kinds of steps.
#[derive(Words)]
#[word(what = "scheme")]
enum Scheme {
    /// Forces of the long step kick.
    Kick,
    /// The particles of a group drift in the long step and again in the short ones, as Hartmann, Thoeni & Rojek (2022, eq. 47) print it: a free
    /// particle then moves at twice its velocity, which is as if it had half its inertia. It is there to reproduce their figures.
    Hartmann(
        #[word(name = "GROUP", what = "the group of hybrid particles, which drift twice", kind = Kind::Group)]
         Word,
    ),
}

impl CommandStyle for RunStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let (style, log) = match Line::form(a, cx)? {
            Line::Verlet => (RunStyle::Verlet, vec![]),
            Line::Respa(line) => line.read()?,
            Line::Staggered(line) => (staggered(line, a, cx)?, vec![]),
        };
        Ok(setting(move |cx| {
            log.iter().for_each(|line| cx.print(line));
            put(cx.world, style.clone());
            Ok(())
        }))
    }
}

/// Puts a style in force; what another one has kept between steps is dropped.
fn put(w: &mut World, style: RunStyle) {
    if w.settings.run_style != style {
        w.settings.run_style = style;
        w.columns.forget_levels();
    }
}

/// Refuses a step that would last for ever: a run ends at whole steps.
fn refuse_many(short: i64, span: Span) -> Result<()> {
    if short <= MOST_SHORT {
        return Ok(());
    }
    let text = format!("{short} of the shortest steps would fill one of the longest, {MOST_SHORT} may");
    Err(Diagnostic::error(Code::BAD_VALUE, span, text)
        .help("a longer shortest step, or a shorter `timestep`: runs, output and restart files know whole steps only")
        .into())
}

fn staggered(Staggered { m, faster, scheme }: Staggered, a: &Args, cx: &BuildCx) -> Result<RunStyle> {
    let rare = faster == Side::Grains;
    let ratio = match m {
        Or::Word(_) => None,
        Or::Else(Steps(m)) => Some(m),
    };
    let twice = match &scheme {
        Some(At { value: Scheme::Hartmann(group), span, .. }) => {
            let text = "scheme hartmann moves the hybrid particles twice per step: they behave as if they had half their inertia";
            cx.note(
                Diagnostic::warning(Code::SUSPICIOUS, span.to(group.span), text)
                    .help("`scheme kick` is the consistent form"),
            );
            Some(cx.group(group)?)
        }
        _ => None,
    };
    if rare && ratio.is_none() {
        return fail(
            Code::MISSING_ARGUMENT,
            a.name_span(),
            "with `faster grains` give the interval of bonds: `m N`",
        );
    }
    if rare && twice.is_some() {
        return fail(Code::CONFLICT, a.name_span(), "`scheme hartmann` belongs to `faster solids`");
    }
    Ok(RunStyle::Staggered { ratio, rare, twice })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, refused};

    pub(super) fn read(words: &str) -> RunStyle {
        let mut w = World::default();
        act(&mut w, &format!("run_style {words}"), &[]).unwrap();
        w.settings.run_style
    }

    #[test]
    fn all_forms_are_read() {
        let staggered = |ratio, rare, twice| RunStyle::Staggered { ratio, rare, twice };
        assert_eq!(read("verlet"), RunStyle::Verlet);
        assert_eq!(read("respa 1"), RunStyle::Verlet);
        assert_eq!(read("staggered"), staggered(None, false, None));
        assert_eq!(read("staggered m 4 scheme kick"), staggered(Some(4), false, None));
        assert_eq!(read("staggered m 3 faster grains"), staggered(Some(3), true, None));
        assert_eq!(
            read("staggered m 3 scheme hartmann all"),
            staggered(Some(3), false, Some(perigrain_world::GroupId::ALL))
        );
    }

    #[test]
    fn what_has_no_meaning_is_refused_at_its_word() {
        for (words, word) in [
            ("staggered m 0", "0"),
            ("staggered faster grains", "run_style"),
            ("staggered scheme hartmann surf", "surf"),
            ("staggered n 3", "n"),
        ] {
            let (found, _) = refused(&World::default(), &format!("run_style {words}"));
            assert_eq!(found, word, "{words}");
        }
    }
}
