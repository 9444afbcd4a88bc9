//! What several scene commands share: refusals by name, distances in lattice units, choices of axes and seeds.

use crate::Act;
use crate::{ActCx, BuildCx};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, fail, nearest};
use perigrain_base::math::rng::Marsaglia;
use perigrain_lang::args::blame;
use perigrain_lang::{Args, Param, RefKind, ValueRef, Word};
use perigrain_world::{Boundary, Domain, Extent, Particles, World};

/// The refusal of a word that LAMMPS understands and perigrain does not.
pub fn not_here(word: &Word, what: &str) -> Diagnostics {
    let text = format!("{what} `{}` is not in perigrain yet", word.text);
    Diagnostic::error(Code::NOT_SUPPORTED, word.span, text).into()
}

/// The refusal of a word where the line should end, and of all behind it.
pub fn left_over(word: &Word, a: &Args) -> Diagnostics {
    let refused = |w: &Word| {
        blame(w, Code::EXTRA_ARGUMENT, format!("`{}` does not expect `{}` here", a.command(), w.text))
    };
    let mut all = vec![refused(word)];
    let rest = a.clone().rest();
    all.extend(rest.iter().map(refused));
    Diagnostics(all)
}

/// The refusal of a word that names no style of a command, with the nearest that does.
pub fn unknown_style(word: &Word, what: &str, known: &[&'static str]) -> Diagnostics {
    let d = blame(word, Code::UNKNOWN_STYLE, format!("unknown {what} `{}`", word.text));
    match nearest(&word.text, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known: {}", known.join(" "))),
    }
    .into()
}

/// The unknown or refused keyword `word` of a command: refused by name where LAMMPS has it.
pub fn bad_keyword(a: &Args, word: &Word, known: &[&'static str], lammps: &[&str]) -> Diagnostics {
    if lammps.contains(&word.text.as_str()) {
        return not_here(word, &format!("keyword of {}", a.command()));
    }
    a.unknown(word, known)
}

/// Takes one of the known words; one that only LAMMPS knows is refused by name.
pub fn choice_or_refuse(
    a: &mut Args,
    what: &str,
    known: &[&'static str],
    lammps: &[&str],
) -> Result<&'static str> {
    match a.peek() {
        Some(w) if lammps.contains(&w.text.as_str()) => Err(not_here(w, what)),
        _ => a.choice(what, known),
    }
}

/// Factors from the words' distances to the box's.
pub fn scales(world: &World, lattice: bool) -> [f64; 3] {
    if lattice { world.lattice.spacing } else { [1.0; 3] }
}

/// Takes an axis: `x`, `y` or `z`.
pub fn axis(a: &mut Args, what: &str) -> Result<usize> {
    Ok(match a.choice(what, &["x", "y", "z"])? {
        "x" => 0,
        "y" => 1,
        _ => 2,
    })
}

/// Takes a component of velocity: `vx`, `vy` or `vz`.
pub fn velocity_axis(a: &mut Args) -> Result<usize> {
    Ok(match a.choice("velocity component", &["vx", "vy", "vz"])? {
        "vx" => 0,
        "vy" => 1,
        _ => 2,
    })
}

/// Takes a seed of the Park–Miller stream.
pub fn seed(a: &mut Args) -> Result<u32> {
    let span = a.here();
    let k = a.integer_from(1, "the random seed")?;
    if k < 2_147_483_647 {
        return Ok(k as u32);
    }
    fail(Code::BAD_VALUE, span, format!("the random seed must be below 2147483647, not {k}"))
}

/// Takes a seed of Marsaglia's stream.
pub fn marsaglia_seed(a: &mut Args) -> Result<u32> {
    let span = a.here();
    let k = a.integer_from(1, "the random seed")?;
    match u32::try_from(k) {
        Ok(seed) if seed <= Marsaglia::MAX_SEED => Ok(seed),
        _ => fail(
            Code::BAD_VALUE,
            span,
            format!("the random seed must be at most {}, not {k}", Marsaglia::MAX_SEED),
        ),
    }
}

/// Takes a number from 0 to 1.
pub fn fraction(a: &mut Args) -> Result<f64> {
    let span = a.here();
    let x = a.number("the fraction")?;
    if (0.0..=1.0).contains(&x) {
        return Ok(x);
    }
    fail(Code::BAD_VALUE, span, format!("the fraction must lie between 0 and 1: {x}"))
}

/// Takes a number or `v_name`; references of other kinds are an error here.
pub fn variable_param(a: &mut Args, what: &str) -> Result<Param> {
    match a.param(what)? {
        Param::Ref(r) if r.kind != RefKind::Variable => {
            fail(Code::WRONG_KIND, r.span, format!("{what} may be a number or a variable, not `{r}`"))
        }
        p => Ok(p),
    }
}

/// Checks that a flat scene repeats along z and holds the plane z = 0.
pub fn check_flat(boundary: Boundary, (lo, hi): (f64, f64), flat: bool) -> Result<()> {
    if !flat {
        return Ok(());
    }
    if !boundary.periodic(2) {
        return fail(Code::CONFLICT, None, "the z faces of a flat scene (`dimension 2`) must be periodic");
    }
    if lo >= 0.0 || hi <= 0.0 {
        let text = format!("the box of a flat scene must hold the plane z = 0, not run from {lo} to {hi}");
        return fail(Code::BAD_VALUE, None, text);
    }
    Ok(())
}

/// Refuses a box whose volume is too small or too large to divide by it.
pub fn check_volume(lengths: [f64; 3]) -> Result<()> {
    let [x, y, z] = lengths;
    if (x * y * z).is_normal() {
        return Ok(());
    }
    let text = format!(
        "a box of {} x {} x {} has no volume that can be computed with",
        short(x),
        short(y),
        short(z)
    );
    let d = Diagnostic::error(Code::BAD_VALUE, None, text);
    Err(d.help("take units in which its edges are nearer to 1").into())
}

/// A number to two digits, for people: 700, 25, 0.04.
pub fn about(x: f64) -> String {
    let rounded = perigrain_base::math::cformat::general(x, 2).parse().unwrap_or(x);
    perigrain_base::math::cformat::general(rounded, 6)
}

/// A number with a few digits.
fn short(x: f64) -> String {
    perigrain_base::math::cformat::general(x, 4)
}

/// The box, or the error that it is missing.
pub fn domain<'a>(cx: &BuildCx<'a>) -> Result<&'a Domain> {
    cx.world.domain().map_err(|d| d.at(cx.span))
}

/// Warns of a box that leans so far that another one of the same lattice would lean less.
pub fn warn_of_skew(cx: &ActCx, domain: &Domain) {
    let (periodic, [lx, ly, _]) = (domain.periodic(), domain.lengths());
    let [xy, xz, yz] = domain.tilt.unwrap_or_default();
    let far = [(xy, lx, periodic[0]), (xz, lx, periodic[0]), (yz, ly, periodic[1])];
    if far.into_iter().any(|(tilt, length, repeats)| repeats && tilt.abs() > 0.5 * length) {
        let text = "the box leans by more than half of an edge";
        let d = Diagnostic::warning(Code::SUSPICIOUS, None, text);
        cx.note(d.help("a whole edge less gives the same scene, and lists are made faster"));
    }
}

/// The refusal of what works in orthogonal boxes alone.
pub fn orthogonal(what: &str) -> perigrain_base::diag::Diagnostics {
    Diagnostic::error(
        Code::NOT_SUPPORTED,
        None,
        format!("{what} needs an orthogonal box: this one is triclinic"),
    )
    .help("without tilts `change_box all ortho` makes it orthogonal")
    .into()
}

/// Refuses a line that must come before the box exists.
pub fn before_box(cx: &BuildCx, command: &str) -> Result<()> {
    match *cx.world.domain {
        Some(_) => fail(
            Code::WRONG_ORDER,
            cx.span,
            format!("`{command}` must come before the simulation box is defined"),
        ),
        None => Ok(()),
    }
}

/// The atom-style variable a word names, without its `v_`.
pub fn atom_variable(cx: &BuildCx, word: &Word) -> Result<ValueRef> {
    let r = ValueRef { kind: RefKind::Variable, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, true)?;
    Ok(r)
}

/// Checks that an ID consists of letters, digits and underscores.
pub fn id(word: &Word, what: &str) -> Result<String> {
    if word.unknown || word.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Ok(word.text.clone());
    }
    fail(
        Code::BAD_VALUE,
        word.span,
        format!("{what} `{}` must consist of letters, digits and underscores", word.text),
    )
}

/// Checks the ID of a group or region: any word that formulas can name, as `count(wall-1)`.
pub fn free_id(word: &Word, what: &str) -> Result<String> {
    if word.unknown || !word.text.contains(['(', ')', '[', ']', ',', '"', '\'', '$']) {
        return Ok(word.text.clone());
    }
    let text = format!("{what} `{}` must not hold brackets, commas, quotes or $", word.text);
    fail(Code::BAD_VALUE, word.span, text)
}

/// Reads a whole number from a word.
pub fn whole(word: &Word, what: &str) -> Result<i64> {
    match word.text.parse() {
        Ok(k) => Ok(k),
        Err(_) if word.unknown => Ok(1),
        Err(_) => {
            fail(Code::BAD_NUMBER, word.span, format!("{what} must be a whole number, not `{}`", word.text))
        }
    }
}

/// Reads `a`, `*`, `a*`, `*b` or `a*b` as an inclusive range of ids; open ends are 1 and the last id.
pub fn id_range(word: &Word, last: i64) -> Result<(i64, i64)> {
    range_from(word, 1, last)
}

/// Takes a bond type.
pub fn bond_type(a: &mut Args, types: usize) -> Result<u16> {
    let span = a.here();
    let k = a.integer("the bond type")?;
    match u16::try_from(k) {
        Ok(t) if k >= 1 && k as usize <= types => Ok(t),
        _ if types == 0 => {
            let d = Diagnostic::error(Code::BAD_VALUE, span, "there are no bond types");
            Err(d.help("set the number: `create_box … bond/types N`").into())
        }
        _ => fail(Code::BAD_VALUE, span, format!("there are bond types 1 to {types}, not {k}")),
    }
}

/// As `id_range`, for numbers from `first`.
pub fn range_from(word: &Word, first: i64, last: i64) -> Result<(i64, i64)> {
    let part = |s: &str, default: i64| if s.is_empty() { Some(default) } else { s.parse().ok() };
    let (lo, hi) = match word.text.split_once('*') {
        Some((a, b)) => (part(a, first), part(b, last)),
        None => (word.text.parse().ok(), word.text.parse().ok()),
    };
    match (lo, hi) {
        (Some(a), Some(b)) if a >= first && a <= b => Ok((a, b)),
        _ if word.unknown => Ok((first, last)),
        _ => {
            fail(Code::BAD_VALUE, word.span, format!("`{}` is no id or range of ids from {first}", word.text))
        }
    }
}

/// A value that runs linearly from `by[0]` to `by[1]` between two places and is constant beyond them.
pub fn ramp(at: f64, between: [f64; 2], by: [f64; 2]) -> f64 {
    let fraction = ((at - between[0]) / (between[1] - between[0])).clamp(0.0, 1.0);
    by[0] + fraction * (by[1] - by[0])
}

/// Wraps particles into the box and lets shrink-wrapped faces follow, as LAMMPS does after it has moved them.
pub fn settle(world: &mut World) {
    let Some(domain) = &mut *world.domain else { return };
    let p = &mut world.particles;
    if let Some(extent) = Extent::of(&p.x, domain) {
        p.image.wrap(domain, &mut p.x, &extent.out);
        domain.shrink(extent.corners);
    }
}

/// Puts new particles behind those that are there; columns of fixes and computes get zeros for them.
pub fn join(world: &mut World, new: Particles) {
    if world.particles.is_empty() {
        world.particles = new;
    } else {
        world.particles.append(new);
    }
    let n = world.n();
    world.columns.resize(n);
}

/// Gives particles the mass that belongs to a density: 4/3 π r³ ρ for one with a radius, else ρ itself.
pub fn masses_from_density(p: &mut Particles, chosen: &[usize], density: &[f64]) {
    for &i in chosen {
        let rho = density[i];
        p.density[i] = rho;
        p.mass[i] = match p.radius.get(i) {
            Some(&r) if r > 0.0 => 4.0 * std::f64::consts::PI / 3.0 * r * r * r * rho,
            _ => rho,
        };
    }
}

/// An act made of a closure.
struct Do<F> {
    f: F,
    particles: bool,
    settles: Vec<&'static str>,
    group: Option<String>,
    names: bool,
}

impl<F: FnOnce(&mut ActCx) -> Result<()>> Act for Do<F> {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        (self.f)(cx)
    }

    fn needs_particles(&self) -> bool {
        self.particles
    }

    fn leaves_forces(&self) -> bool {
        self.names
    }

    fn makes_group(&self) -> Option<&str> {
        self.group.as_deref()
    }

    fn settles(&self) -> Vec<&'static str> {
        self.settles.clone()
    }
}

/// An act on settings, names or the box: it needs no particles and happens in `perigrain check` too.
pub fn setting(f: impl FnOnce(&mut ActCx) -> Result<()> + 'static) -> Box<dyn Act> {
    Box::new(Do { f, particles: false, settles: vec![], group: None, names: false })
}

/// An act that gives something new a name: nothing that is there is another for it.
pub fn naming(f: impl FnOnce(&mut ActCx) -> Result<()> + 'static) -> Box<dyn Act> {
    Box::new(Do { f, particles: false, settles: vec![], group: None, names: true })
}

/// An act on particles that settles these facts of the scene.
pub fn on_particles(
    settles: Vec<&'static str>,
    f: impl FnOnce(&mut ActCx) -> Result<()> + 'static,
) -> Box<dyn Act> {
    in_group(settles, None, f)
}

/// Refuses to act on particles of a scene that has none: nothing would happen, and particles made later would not be as the
/// deck says.
///
/// # Errors
/// Where there are none.
pub fn populated(w: &World, what: &str, at: Span) -> Result<()> {
    if w.n() > 0 {
        return Ok(());
    }
    Err(Diagnostic::error(
        Code::WRONG_ORDER,
        at,
        format!("there are no particles yet for `{what}` to act on"),
    )
    .help("`create_atoms` or `read_data` must come first")
    .into())
}

/// As `on_particles`, for acts that put particles into a group, made if it is not there.
pub fn in_group(
    settles: Vec<&'static str>,
    group: Option<String>,
    f: impl FnOnce(&mut ActCx) -> Result<()> + 'static,
) -> Box<dyn Act> {
    Box::new(Do { f, particles: true, settles, group, names: false })
}
