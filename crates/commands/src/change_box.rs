//! `change_box`: size and faces of the box, with particles moved along if requested.

use super::boundary::AllFaces;
use super::replicate::log_box;
use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::near::{bonds_across, bonds_fit};
use perigrain_styles::words::{Each, Given, Syntax, Units, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{Boundary, Domain, GroupId};

/// The command.
pub struct ChangeBox;

impl Style for ChangeBox {
    fn name(&self) -> &'static str {
        "change_box"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Changes size, shape and faces of the box.",
            text: "What is asked happens in order. Particles stay where they are unless `remap` is said. Image counts along a \
                   dimension that is no longer periodic become 0. At the end shrink-wrapped faces follow the particles and periodic \
                   ones wrap them.\n\n\
                   Distances in `xy` and `xz` are in lattice spacings along x, in `yz` in those along y. Where peridynamic bonds \
                   cross a periodic face, its edge may change with `remap` alone: the body is strained evenly with the box, from \
                   the state at the first run.",
            example: "change_box all x scale 1.01 y final -0.01 0.01 boundary f f f remap units box",
        }
    }
}

#[derive(Words)]
#[word(least = 1)]
struct Line {
    /// The particles that `remap` moves.
    #[word(name = "GROUP")]
    group: GroupId,
    #[word(flatten)]
    changes: Each<Change>,
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
}

#[derive(Words)]
#[word(keywords)]
enum Change {
    X(#[word(name = "change")] Edge),
    Y(#[word(name = "change")] Edge),
    Z(#[word(name = "change")] Edge),
    Xy(#[word(name = "change")] Tilt),
    Xz(#[word(name = "change")] Tilt),
    Yz(#[word(name = "change")] Tilt),
    /// What the faces do from now on, as in `boundary`.
    Boundary(AllFaces),
    /// The box may not lean from now on; its tilts must be 0.
    Ortho,
    /// The box may lean from now on.
    Triclinic,
    /// The box from which `remap` begins is the present one.
    Set,
    /// The particles of the group move with the box, from where it was at the start of the line, or at the last `set` or `remap`, to where
    /// it is now.
    Remap,
}

/// How an edge changes.
#[derive(Clone, Copy, Words)]
#[word(what = "change")]
enum Edge {
    /// The new faces.
    Final(
        #[word(name = "LO", what = "the lower face")] f64,
        #[word(name = "HI", what = "the upper face")] f64,
    ),
    /// By how much each face is shifted.
    Delta(#[word(name = "DLO", what = "the shift")] f64, #[word(name = "DHI", what = "the shift")] f64),
    /// A factor, about the middle.
    Scale(#[word(name = "S", what = "the factor", positive)] f64),
    /// About the middle, so that the box has the volume that it had before the edge named just before changed; two in a row share that.
    Volume,
}

/// How a tilt changes.
#[derive(Clone, Copy, Words)]
#[word(what = "change")]
enum Tilt {
    /// The new tilt.
    Final(#[word(name = "T", what = "the tilt")] f64),
    /// By how much it changes.
    Delta(#[word(name = "DT", what = "the tilt")] f64),
}

/// One change that the line requests.
enum Step {
    /// An edge, and the edges that keep the volume for it.
    Edge {
        d: usize,
        how: Edge,
        volume: Vec<usize>,
    },
    /// A tilt (xy, xz, yz), set or changed by so much.
    Tilt {
        k: usize,
        how: Tilt,
        span: Span,
    },
    Boundary(Boundary),
    Ortho(Span),
    Triclinic,
    Set,
    Remap,
}

impl CommandStyle for ChangeBox {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { group, changes, units } = read(a, cx)?;
        let mut steps = vec![];
        for Given { word, value, .. } in changes.0 {
            match value {
                Change::X(how) => edge(0, how, &word, &mut steps)?,
                Change::Y(how) => edge(1, how, &word, &mut steps)?,
                Change::Z(how) => edge(2, how, &word, &mut steps)?,
                Change::Xy(how) => steps.push(tilt(0, how, &word, &steps, cx)?),
                Change::Xz(how) => steps.push(tilt(1, how, &word, &steps, cx)?),
                Change::Yz(how) => steps.push(tilt(2, how, &word, &steps, cx)?),
                Change::Boundary(faces) => steps.push(Step::Boundary(faces.into())),
                Change::Ortho => steps.push(Step::Ortho(word.span)),
                Change::Triclinic => steps.push(Step::Triclinic),
                Change::Set => steps.push(Step::Set),
                Change::Remap => steps.push(Step::Remap),
            }
        }
        let scale = units.scales(cx.world);
        let span = cx.span;
        if let (true, [Step::Boundary(faces)]) = (cx.checking, steps.as_slice()) {
            // A check has no particles for faces to follow, but later lines depend on what the faces are.
            let faces = *faces;
            return Ok(common::setting(move |cx| {
                if let Some(domain) = &mut *cx.world.domain {
                    common::check_flat(faces, (domain.lo[2], domain.hi[2]), domain.flat)?;
                    domain.boundary = faces;
                }
                cx.world.settings.boundary = faces;
                Ok(())
            }));
        }
        Ok(on_particles(vec![], move |cx| change(cx, group, &steps, scale, span)))
    }
}

fn cannot_lean(span: Span) -> Diagnostics {
    Diagnostic::error(Code::CONFLICT, span, "an orthogonal box cannot lean")
        .help("`triclinic` before this makes it one that may")
        .into()
}

/// Adds the change of an edge to the steps.
fn edge(d: usize, how: Edge, word: &Word, steps: &mut Vec<Step>) -> Result<()> {
    if !matches!(how, Edge::Volume) {
        steps.push(Step::Edge { d, how, volume: vec![] });
        return Ok(());
    }
    match steps.last_mut() {
        Some(Step::Edge { d: first, volume, .. })
            if *first != d && !volume.contains(&d) && volume.len() < 2 =>
        {
            volume.push(d);
            Ok(())
        }
        _ => {
            let text = "`volume` must follow a change of another edge";
            let diagnostic = Diagnostic::error(Code::CONFLICT, word.span, text);
            Err(diagnostic.help("write for example `x scale 1.1 y volume`").into())
        }
    }
}

/// The change of a tilt, of a box that may lean after the steps before.
fn tilt(k: usize, how: Tilt, word: &Word, before: &[Step], cx: &BuildCx) -> Result<Step> {
    if k > 0 && cx.world.settings.two_dimensional {
        let text = format!("the tilt {} of a flat scene must be 0", word.text);
        return fail(Code::CONFLICT, word.span, text);
    }
    let made = before.iter().any(|s| matches!(s, Step::Triclinic));
    if !made && cx.world.domain.as_ref().is_some_and(|d| d.tilt.is_none()) {
        return Err(cannot_lean(word.span));
    }
    Ok(Step::Tilt { k, how, span: word.span })
}

fn change(cx: &mut ActCx, group: GroupId, steps: &[Step], scale: [f64; 3], span: Span) -> Result<()> {
    // LAMMPS lets shrink-wrapped faces follow the particles before it reads the box.
    common::settle(cx.world);
    let mut domain = cx.world.domain()?.clone();
    let mut saved = domain.clone();
    let mut x = cx.world.particles.x.clone();
    let mut boxes = vec![];
    let mut unwound = [false; 3];
    for step in steps {
        match step {
            Step::Edge { d, how, volume } => {
                reshape(&mut domain, *d, *how, volume, scale[*d], span)?;
                boxes.push(domain.clone());
            }
            Step::Boundary(faces) => {
                common::check_flat(*faces, (domain.lo[2], domain.hi[2]), domain.flat)?;
                for (d, unwound) in unwound.iter_mut().enumerate() {
                    *unwound |= domain.boundary.periodic(d) && !faces.periodic(d);
                }
                domain.boundary = *faces;
                refit(&mut domain);
            }
            Step::Tilt { k, how, span } => {
                let Some(tilt) = &mut domain.tilt else { return Err(cannot_lean(*span)) };
                tilt[*k] = match how {
                    Tilt::Final(t) => scale[*k / 2] * t,
                    Tilt::Delta(by) => scale[*k / 2] * by + tilt[*k],
                };
                refit(&mut domain);
                boxes.push(domain.clone());
            }
            Step::Ortho(span) => {
                if domain.tilted() {
                    let d = Diagnostic::error(Code::CONFLICT, *span, "a box that leans is not orthogonal");
                    return Err(d
                        .help("set its tilts to 0 first: `xy final 0 xz final 0 yz final 0`")
                        .into());
                }
                domain.tilt = None;
                boxes.push(domain.clone());
            }
            Step::Triclinic => {
                domain.tilt.get_or_insert([0.0; 3]);
                boxes.push(domain.clone());
            }
            Step::Set => saved = domain.clone(),
            Step::Remap => {
                let members = cx.world.particles.mask.iter().map(|m| m & group.bit() != 0);
                for (x, _) in x.iter_mut().zip(members).filter(|(_, member)| *member) {
                    *x = carried(*x, &saved, &domain);
                }
                // What has moved along does not move along again.
                saved = domain.clone();
            }
        }
    }
    let (before, now) = (cx.world.domain()?.edges().vectors(), domain.edges().vectors());
    let along = steps.iter().any(|step| matches!(step, Step::Remap));
    let changes = [0, 1, 2].map(|d| before[d] != now[d]);
    if bonds_across(cx.world, changes, along).map_err(|e| e.at(span))?.is_some() {
        bonds_fit(cx.world, &domain.periods()).map_err(|e| e.at(span))?;
    }
    common::warn_of_skew(cx, &domain);
    cx.print("Changing box ...");
    for domain in boxes {
        cx.world.domain = Some(domain).into();
        log_box(cx)?;
    }
    unwind(cx, unwound);
    // What is read into the box later finds these faces in force.
    cx.world.settings.boundary = domain.boundary;
    cx.world.domain = Some(domain).into();
    cx.world.particles.x = x;
    common::settle(cx.world);
    cx.world.touch();
    Ok(())
}

/// Image counts along dimensions that are periodic no more become 0.
fn unwind(cx: &mut ActCx, unwound: [bool; 3]) {
    if unwound == [false; 3] {
        return;
    }
    let image = &mut cx.world.particles.image;
    let mut lost = false;
    for i in 0..cx.world.particles.x.len() {
        let old = image[i];
        let new = [0, 1, 2].map(|d| if unwound[d] { 0 } else { old[d] });
        lost |= new != old;
        image.set(i, new);
    }
    if lost {
        let text = "image counts along dimensions that are no longer periodic have been set to 0";
        cx.note(Diagnostic::note(Code::SUSPICIOUS, None, text));
    }
}

/// Changes an edge, and those that keep the volume for it.
fn reshape(domain: &mut Domain, d: usize, how: Edge, volume: &[usize], scale: f64, span: Span) -> Result<()> {
    let before = domain.volume();
    match how {
        Edge::Final(lo, hi) => (domain.lo[d], domain.hi[d]) = (scale * lo, scale * hi),
        Edge::Delta(lo, hi) => {
            (domain.lo[d], domain.hi[d]) = (domain.lo[d] + scale * lo, domain.hi[d] + scale * hi)
        }
        Edge::Scale(factor) => about_middle(domain, d, factor),
        // It stands with the edge before it.
        Edge::Volume => {}
    }
    check(domain, span)?;
    refit(domain);
    if volume.is_empty() {
        return Ok(());
    }
    let factor = before / domain.volume();
    let share = if volume.len() == 2 { factor.sqrt() } else { factor };
    volume.iter().for_each(|&d| about_middle(domain, d, share));
    check(domain, span)?;
    refit(domain);
    Ok(())
}

fn about_middle(domain: &mut Domain, d: usize, factor: f64) {
    let middle = 0.5 * (domain.lo[d] + domain.hi[d]);
    domain.lo[d] = middle + factor * (domain.lo[d] - middle);
    domain.hi[d] = middle + factor * (domain.hi[d] - middle);
}

fn check(domain: &Domain, span: Span) -> Result<()> {
    for (d, name) in ["x", "y", "z"].into_iter().enumerate() {
        let (lo, hi) = (domain.lo[d], domain.hi[d]);
        if hi.partial_cmp(&lo) != Some(std::cmp::Ordering::Greater) || !(hi - lo).is_finite() {
            return fail(Code::BAD_VALUE, span, format!("the box would run from {lo} to {hi} in {name}"));
        }
    }
    common::check_flat(domain.boundary, (domain.lo[2], domain.hi[2]), domain.flat)?;
    common::check_volume(domain.lengths())
}

/// What LAMMPS does with every new box: the room beyond shrink-wrapped faces is measured anew and added.
fn refit(domain: &mut Domain) {
    let fresh = Domain::new(domain.lo, domain.hi, domain.boundary);
    *domain = Domain { flat: domain.flat, tilt: domain.tilt, ..fresh };
    domain.open_shrinking_faces();
}

/// Where a place of one box is in another.
fn carried(x: [f64; 3], from: &Domain, to: &Domain) -> [f64; 3] {
    if from.tilted() || to.tilted() {
        return to.at(from.fractions(&x));
    }
    let (old, new) = (from.lengths(), to.lengths());
    [0, 1, 2].map(|d| new[d] * ((x[d] - from.lo[d]) * (1.0 / old[d])) + to.lo[d])
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};

    #[test]
    fn particles_move_with_the_box_on_request() {
        let mut w =
            scene("units si\nregion b block 0 4 0 2 0 1\ncreate_box 1 b\ncreate_atoms 1 single 1 1 0.5");
        more(&mut w, "change_box all x scale 2 y volume");
        let domain = w.domain.clone().into_inner().unwrap();
        // Calculated by hand: x about 2 from -2 to 6; y halves about 1.
        assert_eq!((domain.lo, domain.hi), ([-2.0, 0.5, 0.0], [6.0, 1.5, 1.0]));
        assert_eq!(w.particles.x[0], [1.0, 1.0, 0.5]);
        more(&mut w, "change_box all x final 0 4 remap");
        // A fraction 3/8 of the way.
        assert_eq!(w.particles.x[0], [1.5, 1.0, 0.5]);
        // The second `remap` moves along y alone, half of the way as before.
        more(&mut w, "change_box all x final 0 8 remap y final 0 3 remap");
        assert_eq!(w.particles.x[0], [3.0, 1.5, 0.5]);
    }

    #[test]
    fn blames_the_right_word() {
        let w = scene("units si\nregion b block 0 4 0 2 0 1\ncreate_box 1 b");
        for (line, word) in [
            ("change_box all xy final 0.1", "xy"),
            ("change_box all triclinic xy final 0.1 ortho", "ortho"),
            ("change_box all x volume", "x"),
            ("change_box all x scale 2 x volume", "x"),
            ("change_box all x scale -1", "-1"),
            ("change_box all x final 4 0", "change_box all x final 4 0"),
            ("change_box all boundary p pf p", "pf"),
            ("change_box all x sclae 2", "sclae"),
            ("change_box none x scale 2", "none"),
        ] {
            assert_eq!(refused(&w, line).0, word, "{line}");
        }
    }
}
