//! New particles with their volumes, on their way into the world.

use super::words::Making;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_styles::{ActCx, common};
use perigrain_world::{Domain, Particles, memory};
use std::f64::consts::PI;

/// Particles that are being made: those inside the box, and how many were not.
pub struct Newcomers<'a> {
    making: &'a Making,
    domain: Domain,
    /// Those inside, without masses.
    pub particles: Particles,
    /// Volumes, by particle.
    pub volumes: Vec<f64>,
    /// Their radii where the file has them, else those of spheres of the same volumes.
    pub radii: Vec<f64>,
    /// Their densities where the file has them.
    pub densities: Vec<f64>,
    last: u32,
    outside: usize,
    /// Corners of all places that were seen.
    seen: [[f64; 3]; 2],
}

/// A place that is not in the plane of a flat scene.
pub struct OffPlane(pub f64);

impl<'a> Newcomers<'a> {
    /// None yet; about `count` will come.
    ///
    /// # Errors
    /// More than fit into memory, a world without a box.
    pub fn new(cx: &mut ActCx, making: &'a Making, count: usize) -> Result<Self> {
        let domain = cx.world.domain()?.clone();
        if let Some(line) = memory::forecast(cx.world, count as f64)? {
            cx.print(line);
        }
        let last = cx.world.particles.last_tag();
        if u32::try_from(count).ok().and_then(|n| last.checked_add(n)).is_none() {
            return fail(Code::TOO_LARGE, None, "more particles than there are ids");
        }
        let mut particles = Particles { style: cx.world.particles.style, ..Particles::default() };
        particles.reserve(count);
        let volumes = Vec::with_capacity(count);
        let seen = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let (radii, densities) = (vec![], vec![]);
        Ok(Self { making, domain, particles, volumes, radii, densities, last, outside: 0, seen })
    }

    /// A particle at a place of the file, with a volume in box units; whether it is inside of the box.
    ///
    /// # Errors
    /// Places beside the plane of a flat scene.
    pub fn push(&mut self, x: [f64; 3], kind: u16, volume: f64) -> std::result::Result<bool, OffPlane> {
        let mut x = self.making.placement.place(x);
        if self.domain.flat {
            let size = self.domain.lengths()[0];
            if x[2].abs() > 1e-9 * size {
                return Err(OffPlane(x[2]));
            }
            x[2] = 0.0;
        }
        for d in 0..3 {
            self.seen[0][d] = self.seen[0][d].min(x[d]);
            self.seen[1][d] = self.seen[1][d].max(x[d]);
        }
        if !self.domain.holds(&x) {
            self.outside += 1;
            return Ok(false);
        }
        self.last += 1;
        self.particles.push(self.last, kind, x);
        self.volumes.push(volume);
        Ok(true)
    }

    /// How many have come, those outside of the box among them.
    pub fn all(&self) -> usize {
        self.particles.len() + self.outside
    }

    /// Puts all into the world; the index of the first one there. `what` they were in the file.
    ///
    /// # Errors
    /// None is inside of the box, no room for one more group.
    pub fn enter(mut self, cx: &mut ActCx, what: &str, checking: bool) -> Result<usize> {
        let (count, all) = (self.particles.len(), self.all());
        if self.outside > 0 {
            self.report_outside(cx, what)?;
        }
        let bit = self.group(cx)?;
        let first = cx.world.n();
        if checking {
            return Ok(first);
        }
        self.weigh();
        for mask in self.particles.mask.iter_mut() {
            *mask |= bit;
        }
        self.log_summary(cx, count, all);
        let w = &mut *cx.world;
        common::join(w, std::mem::take(&mut self.particles));
        w.spread_type_masses();
        w.touch();
        Ok(first)
    }

    /// Reports particles outside of the box; refuses if all are.
    fn report_outside(&self, cx: &ActCx, what: &str) -> Result<()> {
        let text = |x: [f64; 3]| x.map(|x| general(x, 6)).join(" ");
        let places = format!("they reach from ({}) to ({})", text(self.seen[0]), text(self.seen[1]));
        let range = format!("the box from ({}) to ({})", text(self.domain.lo), text(self.domain.hi));
        if self.particles.is_empty() {
            let text = format!("none of the {} {what} lies in the box: {places}, {range}", self.outside);
            let d = Diagnostic::error(Code::BAD_VALUE, cx.span, text);
            return Err(d.help("`scale` and `shift` bring them there").into());
        }
        let text =
            format!("{} of {} {what} lie outside of the box and are left out", self.outside, self.all());
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, None, text).help(format!("{places}, {range}")));
        Ok(())
    }

    fn group(&self, cx: &mut ActCx) -> Result<u32> {
        let Some(word) = &self.making.group else { return Ok(0) };
        let named = cx.world.groups.find(&word.text);
        if named.is_some_and(|g| cx.world.groups.dynamic(g).is_some()) {
            let text = format!("the dynamic group `{}` chooses its particles itself", word.text);
            return fail(Code::CONFLICT, word.span, text);
        }
        match cx.world.groups.find_or_add(&word.text) {
            Some(id) => Ok(id.bit()),
            None => fail(Code::TOO_LARGE, word.span, "there are 32 groups already"),
        }
    }

    /// Volumes, radii and masses of the particles.
    fn weigh(&mut self) {
        let p = &mut self.particles;
        let style = p.style;
        if style.sphere && self.radii.is_empty() {
            self.radii = self.volumes.iter().map(|v| (0.75 / PI * v).cbrt()).collect();
        }
        if style.sphere {
            p.radius.copy_from_slice(&self.radii);
        }
        if style.peri {
            p.volume.copy_from_slice(&self.volumes);
        }
        if style.sphere_mass {
            for (m, r) in p.mass.iter_mut().zip(&self.radii) {
                *m = 4.0 * PI / 3.0 * r * r * r;
            }
        }
        if let (Some(density), true) = (self.making.density, self.densities.is_empty()) {
            self.densities = vec![density; p.len()];
        }
        if style.own_mass() && !self.densities.is_empty() {
            let all: Vec<usize> = (0..p.len()).collect();
            common::masses_from_density(p, &all, &self.densities);
        }
    }

    fn log_summary(&self, cx: &mut ActCx, count: usize, all: usize) {
        cx.print(format!("Created {count} atoms"));
        if count < all {
            cx.print(format!("  {} more lie outside of the box", all - count));
        }
        let mut types: Vec<(usize, f64)> = vec![(0, 0.0); cx.world.types];
        for (kind, v) in self.particles.kind.iter().zip(&self.volumes) {
            if let Some((n, sum)) = types.get_mut(usize::from(*kind) - 1) {
                *n += 1;
                *sum += v;
            }
        }
        for (k, (n, sum)) in types.iter().enumerate().filter(|(_, (n, _))| *n > 0) {
            cx.print(format!("  type {}: {n} atoms, volume {}", k + 1, general(*sum, 10)));
        }
    }
}

/// The message about a place beside the plane of a flat scene.
pub fn off_plane(what: &str, OffPlane(z): OffPlane, at: Option<Span>) -> Diagnostic {
    let text = format!("{what} lies at z = {}; a flat scene lies in the plane z = 0", general(z, 6));
    Diagnostic::error(Code::BAD_VALUE, at, text)
        .help(format!("`shift 0 0 {}` brings it there", general(-z, 6)))
}
