//! compute temp/region: temperature of the particles in a region.

use super::thermal::{Streams, Taken, Thermal, dimension};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::matter::{Chosen, sum};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{GroupId, Key, Region, World};

/// The style.
pub struct TempRegion;

impl Style for TempRegion {
    fn name(&self) -> &'static str {
        "temp/region"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Temperature of the group's particles in a region.",
            text: "As `compute temp`, of the particles that are in the region at that moment: d N − `extra/dof` degrees of freedom, \
                   N being their number, `extra/dof` d unless `compute_modify` says otherwise. N is counted at each use, \
                   `dynamic/dof` changes nothing. As a bias (`compute temp/sphere bias ID`, `velocity … temp ID bias yes`) it \
                   takes the velocities of all others of the group away whole.",
            example: "compute t all temp/region half",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The region.
    #[word(name = "region-ID")]
    region: Key<Region>,
}

impl ComputeStyle for TempRegion {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { region } = read(args, cx)?;
        Ok(Box::new(Thermal::new(Inside(region), cx)))
    }
}

/// Excludes all particles outside the region of this name.
#[derive(Clone)]
struct Inside(Key<Region>);

impl Inside {
    fn has(&self, w: &World, i: usize) -> bool {
        w.regions.get(self.0).is_some_and(|r| r.contains(w.particles.x[i]))
    }
}

impl Streams for Inside {
    fn taken<'a>(&'a self, w: &'a World, _group: GroupId) -> Taken<'a> {
        Box::new(|i| if self.has(w, i) { [0.0; 3] } else { w.particles.v[i] })
    }

    fn freedom(&self, w: &World, group: GroupId, extra: Option<f64>) -> f64 {
        let [n] = sum(w, group, |i| [if self.has(w, i) { 1.0 } else { 0.0 }]);
        dimension(w) * n - extra.unwrap_or(dimension(w))
    }

    fn apart(&self, w: &World) -> Vec<bool> {
        (0..w.n()).map(|i| !self.has(w, i)).collect()
    }

    fn counts_anew(&self) -> bool {
        true
    }

    fn check(&self, cx: &mut dyn SealCx) -> Result<()> {
        let span = cx.span();
        Chosen::new(cx.world(), GroupId::ALL, Some(self.0.text()), span).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::compute::modify;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;
    use perigrain_world::region::Shape;

    #[test]
    fn particles_inside_count() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [4.0, 2.0, 0.0], [4.0, 5.0, 0.0]].into();
        let block = Shape::Block { lo: [-1.0; 3], hi: [1.5; 3] };
        b.world.regions.insert(Key::new("left"), Region::inside(block));
        let mut c = b.compute(&TempRegion, "left").unwrap();
        // By hand, m = 2: Σ m v² = 2 (5 + 20) over 6 − 3 degrees of freedom, then 6.
        assert!((b.evaluate(&*c).unwrap().scalar - 50.0 / 3.0).abs() < 1e-14);
        let flow = c.flow(&b.world).unwrap();
        assert_eq!((flow.taken[1], flow.taken[2]), ([0.0; 3], [4.0, 5.0, 0.0]));
        assert_eq!(flow.apart, [false, false, true]);
        b.modify("extra/dof 0", |a, cx| modify(&mut *c, a, cx)).unwrap();
        assert!((b.evaluate(&*c).unwrap().scalar - 50.0 / 6.0).abs() < 1e-14);
        for words in ["", "nowhere", "left 1"] {
            assert!(b.compute(&TempRegion, words).is_err(), "{words}");
        }
    }
}
