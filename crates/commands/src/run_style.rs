//! `run_style`: steps of one length, levels of steps within each other, or short ones for solids inside long ones for grains.

mod respa;

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
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
            syntax: "run_style verlet\n\
                     run_style respa N n1 n2 … [bond M] [pair M] [hybrid M1 M2 …] [angle M] [dihedral M] [improper M] [kspace M]\n\
                     run_style staggered [m auto|N] [faster solids|grains] [scheme kick|hartmann GROUP]",
            summary: "How steps are made: all alike, several lengths within each other, or short ones for solids inside long ones for grains.",
            text: "`respa` is the multi-level scheme of Tuckerman, Berne & Martyna (1992) with N levels, numbered from the shortest \
                steps. n1 steps of level 1 make one of level 2, n2 of those one of level 3 …; `timestep`, and whatever counts \
                steps, means the outermost. The forces of a level kick by half of its step at both of its ends, and particles \
                move in level 1. `bond` (default 1) and `pair` (default N) choose the level of a style's forces, `hybrid` \
                that of each sub-style of pair_style hybrid, in its order. `angle`, `dihedral`, `improper` and `kspace` are \
                read, held to LAMMPS' order bond ≤ angle ≤ dihedral ≤ improper ≤ pair ≤ kspace, and name forces that no particle \
                here has. `inner`, `middle` and `outer` are refused: no pair style here is cut up by distance.\n\n\
                Under `respa` fixes act as in LAMMPS: addforce, addtorque, aveforce, drag, gravity, indent, setforce, spring, \
                spring/self, viscous and viscous/sphere in the level that `fix_modify ID respa M` names, else the outermost; \
                what takes components of forces away (setforce, aveforce, lineforce, planeforce, enforce2d, freeze) in every \
                level, with its value in that one; walls in the outermost; `nve`, `nve/sphere` and `nve/limit` kick in every \
                level, nve/noforce moves in level 1 and `move` in the outermost. Values of such a fix (f_ID) count all levels. \
                Lists are made anew at the beginning of an outermost step. Springs and dashpots of contacts in a longer step go by the \
                way of that step, and while springs stick no energy is made; LAMMPS, and `compat lammps`, takes its length times \
                the velocity at its end, which makes energy where bonds swing in the shorter steps. Refused with the reason: rigid bodies, `fix move` with \
                free components, energy/ledger, dt/guard and plastic grains (`mdr`).\n\n\
                `staggered`: `timestep` is the long step. Contacts, walls and body forces kick all particles by half a long step \
                at both of its ends; in between solids make m velocity-Verlet steps under their bonds alone. Momentum is \
                conserved, contacts go by the way of the long step; with m = 1 the bits are those of `verlet`. `m auto` (the default) takes the fewest short steps \
                that stay within 0.8 of the solids' stable step, and looks again when the step changes. `respa 2 m hybrid \
                1 2`, with the peridynamic sub-style named first, comes to the same, but moves grains in the short steps too.\n\n\
                `faster grains`: bonds act at every N-th step only, with N times their force; `timestep` is then the grains' step, \
                and the forces that are printed are those that act.\n\n\
                `scheme hartmann GROUP` lets the particles of a group drift in the long step and again in the short ones, as \
                Hartmann, Thoeni & Rojek (2022, eq. 47) print it: a free particle then moves at twice its velocity, which is as \
                if it had half its inertia. It is there to reproduce their figures.\n\n\
                What takes components of forces away (setforce, lineforce, planeforce, enforce2d, freeze) does so in both kinds of \
                staggered step. Solids are moved by `fix nve` or `nve/sphere` there; other fixes that move them are refused.",
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

impl CommandStyle for RunStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let style = match a.choice("run style", &RUN_STYLES)? {
            "respa" => {
                let (style, lines) = respa::read(a)?;
                return Ok(setting(move |cx| {
                    lines.iter().for_each(|line| cx.print(line));
                    put(cx.world, style.clone());
                    Ok(())
                }));
            }
            "staggered" => staggered(a, cx)?,
            _ => RunStyle::Verlet,
        };
        Ok(setting(move |cx| {
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

fn staggered(a: &mut Args, cx: &BuildCx) -> Result<RunStyle> {
    let (mut ratio, mut rare, mut twice) = (None, false, None);
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "m" if a.eat("auto") => ratio = None,
            "m" => {
                let span = a.here();
                let m = a.integer_from(1, "the number of short steps in a long one, or auto")?;
                refuse_many(m, span)?;
                ratio = Some(m);
            }
            "faster" => rare = a.choice("side with the shorter steps", &["solids", "grains"])? == "grains",
            "scheme" => {
                if a.choice("scheme", &["kick", "hartmann"])? == "hartmann" {
                    let group = a.expect("the group of hybrid particles, which drift twice")?;
                    twice = Some(cx.group(group)?);
                    let text = "scheme hartmann moves the hybrid particles twice per step: they behave as if they had half their inertia";
                    cx.note(
                        Diagnostic::warning(Code::SUSPICIOUS, word.span.to(group.span), text)
                            .help("`scheme kick` is the consistent form"),
                    );
                }
            }
            _ => return Err(a.unknown(word, &["m", "faster", "scheme"])),
        }
    }
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
