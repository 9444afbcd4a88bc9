//! Lists compared with a double loop over all pairs.

use super::*;

/// Numbers in [0, 1) from a small multiplicative generator.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        // Knuth's MMIX constants.
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

struct Scene {
    x: Vec<[f64; 3]>,
    tag: Vec<u32>,
    kind: Vec<u16>,
    radius: Vec<f64>,
}

/// Small grains of types 1 and 2, and a few of type 2 that are ten times as large, in a box of edge 10.
fn scene(n: usize) -> Scene {
    let mut dice = Dice(7);
    let mut s = Scene { x: vec![], tag: vec![], kind: vec![], radius: vec![] };
    for k in 0..n {
        s.x.push(std::array::from_fn(|_| 10.0 * dice.roll()));
        s.tag.push(((k * 7919) % n) as u32 + 1);
        s.kind.push(1 + (k % 2) as u16);
        s.radius.push(if k % 50 == 1 { 1.0 } else { 0.1 + 0.1 * dice.roll() });
    }
    s
}

impl Scene {
    fn view(&self, length: [f64; 3]) -> View<'_> {
        let period = Periods::upright(length);
        View { x: &self.x, tag: &self.tag, kind: &self.kind, radius: &self.radius, period }
    }
}

/// The double loop over all pairs and images.
fn brute(v: &View, wanted: &Wanted, skin: f64, keep: impl Fn(usize, usize) -> bool) -> Vec<Pair> {
    let mut out = vec![];
    let m = v.period.length.map(|l| i32::from(l > 0.0));
    for i in 0..v.x.len() {
        for j in 0..v.x.len() {
            let Some(reach) = wanted.get(v.kind[i], v.kind[j]) else { continue };
            let cut = skin
                + match reach {
                    Reach::Touch => v.radius[i] + v.radius[j],
                    Reach::Beyond(gap) => v.radius[i] + v.radius[j] + gap,
                    Reach::Fixed(c) => c,
                };
            for_images(m, |shift| {
                let p = Pair { i: i as u32, j: j as u32, shift };
                let d = v.difference(&p);
                let near = d.iter().map(|a| a * a).sum::<f64>() < cut * cut;
                if near && keep(i, j) && (v.tag[i] < v.tag[j] || (i == j && shift > [0; 3])) {
                    out.push(p);
                }
            });
        }
    }
    out.sort_by_key(|p| (v.tag[p.i as usize], v.tag[p.j as usize], p.shift));
    out
}

#[test]
fn lists_hold_what_the_double_loop_finds() {
    let s = scene(600);
    let mut all = Wanted::new(2);
    all.set(1, 1, Reach::Touch);
    all.set(1, 2, Reach::Touch);
    all.set(2, 2, Reach::Touch);
    let mut some = Wanted::new(2);
    some.set(1, 2, Reach::Touch);
    some.set(2, 2, Reach::Fixed(0.7));
    for wanted in [&all, &some] {
        for period in [[0.0; 3], [10.0, 0.0, 10.0], [10.0; 3]] {
            let v = s.view(period);
            let list = pairs(&v, wanted, 0.05, &|_, _| true);
            assert!(list.len() > 20);
            assert_eq!(list, brute(&v, wanted, 0.05, |_, _| true));
            let odd = |i: usize, j: usize| (i + j) % 2 == 1;
            assert_eq!(pairs(&v, wanted, 0.05, &odd), brute(&v, wanted, 0.05, odd));
        }
    }
}

#[test]
fn lists_of_a_leaning_box_hold_what_the_double_loop_finds() {
    let mut wanted = Wanted::new(2);
    wanted.set(1, 2, Reach::Touch);
    wanted.set(2, 2, Reach::Touch);
    for tilt in [[5.0, 0.0, 0.0], [-4.0, 3.0, 5.0]] {
        let period = Periods { length: [10.0; 3], tilt };
        let mut s = scene(1200);
        s.x.iter_mut().for_each(|x| *x = period.shift(x.map(|a| a / 10.0)));
        let v = View { period, ..s.view([10.0; 3]) };
        let list = pairs(&v, &wanted, 0.05, &|_, _| true);
        assert!(list.iter().filter(|p| p.shift != [0; 3]).count() > 20);
        assert_eq!(list, brute(&v, &wanted, 0.05, |_, _| true));
    }
}

#[test]
fn a_grain_meets_its_own_image_in_a_thin_box() {
    let v = View {
        x: &[[0.5; 3]],
        tag: &[1],
        kind: &[1],
        radius: &[0.6],
        period: Periods::upright([1.0, 0.0, 0.0]),
    };
    let mut wanted = Wanted::new(1);
    wanted.set(1, 1, Reach::Touch);
    let list = pairs(&v, &wanted, 0.0, &|_, _| true);
    assert_eq!(list, [Pair { i: 0, j: 0, shift: [1, 0, 0] }]);
}

#[test]
fn the_order_of_storage_does_not_matter() {
    let s = scene(400);
    let mut wanted = Wanted::new(2);
    wanted.set(1, 2, Reach::Touch);
    wanted.set(2, 2, Reach::Touch);
    let named = |s: &Scene| -> Vec<(u32, u32, [i8; 3])> {
        let v = s.view([10.0; 3]);
        let list = pairs(&v, &wanted, 0.1, &|_, _| true);
        list.iter().map(|p| (s.tag[p.i as usize], s.tag[p.j as usize], p.shift)).collect()
    };
    let n = s.x.len();
    let back = |k: usize| n - 1 - k;
    let reversed = Scene {
        x: (0..n).map(|k| s.x[back(k)]).collect(),
        tag: (0..n).map(|k| s.tag[back(k)]).collect(),
        kind: (0..n).map(|k| s.kind[back(k)]).collect(),
        radius: (0..n).map(|k| s.radius[back(k)]).collect(),
    };
    let before = named(&s);
    assert_eq!(before, named(&reversed));
    perigrain_base::par::set_threads(2);
    assert_eq!(before, named(&s));
    perigrain_base::par::set_threads(1);
}

/// One big sphere above a block of many small particles costs little more than one test per particle.
#[test]
fn a_big_sphere_among_many_small_particles() {
    let n = 60;
    let mut x = vec![];
    for k in 0..n * n * n {
        x.push([(k % n) as f64, (k / n % n) as f64, (k / n / n) as f64]);
    }
    x.push([30.0, 30.0, 68.0]);
    let count = x.len();
    let tag: Vec<u32> = (1..=count as u32).collect();
    let mut kind = vec![1; count];
    let mut radius = vec![0.5; count];
    kind[count - 1] = 2;
    radius[count - 1] = 10.0;
    let v = View { x: &x, tag: &tag, kind: &kind, radius: &radius, period: Periods::default() };
    let mut wanted = Wanted::new(2);
    wanted.set(1, 2, Reach::Touch);
    wanted.set(2, 2, Reach::Touch);
    let list = pairs(&v, &wanted, 0.0, &|_, _| true);
    // Lattice points within 10.5 of the centre, 9 above the top layer.
    let inside =
        |p: &[f64; 3]| (p[0] - 30.0).powi(2) + (p[1] - 30.0).powi(2) + (p[2] - 68.0).powi(2) < 10.5 * 10.5;
    assert_eq!(list.len(), x[..count - 1].iter().filter(|p| inside(p)).count());
}
