//! Bodies on all lattices that decks make, along the axes and turned: rows against the textbook loop, lists and themselves.

use perigrain_base::par;
use perigrain_peri::families::*;

use super::layouts::{DX, Scatter, check_in, coeff};
use super::scene::Scene;
use super::states;

type Matrix = [[f64; 3]; 3];

/// A lattice with its direction.
#[derive(Clone)]
struct Crystal {
    name: &'static str,
    /// Sites in a cell, and the cell's edges in distances of nearest neighbours.
    sites: Vec<[f64; 3]>,
    edges: [f64; 3],
    turn: Matrix,
}

const UPRIGHT: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// About z by the angle with cosine 0.6.
const ABOUT_Z: Matrix = [[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];

/// By angles of no lattice about two axes.
fn anyhow() -> Matrix {
    let (s, c) = 0.3f64.sin_cos();
    let (t, d) = 1.1f64.sin_cos();
    [[c, -s * d, s * t], [s, c * d, -c * t], [0.0, t, d]]
}

/// Rows along x of a matrix with these rows: `orient x … orient y … orient z …`.
fn orient(rows: [[i32; 3]; 3]) -> Matrix {
    rows.map(|row| {
        let size = row.iter().map(|a| f64::from(a * a)).sum::<f64>().sqrt();
        row.map(|a| f64::from(a) / size)
    })
}

fn crystal(name: &'static str, turn: Matrix) -> Crystal {
    let (h, corner) = (3f64.sqrt(), [0.0; 3]);
    let faces = vec![corner, [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let fcc = 2f64.sqrt();
    let hcp = vec![corner, [0.5, 0.5, 0.0], [0.5, 5.0 / 6.0, 0.5], [0.0, 1.0 / 3.0, 0.5]];
    let (sites, edges) = match name {
        "sc" => (vec![corner], [1.0; 3]),
        "fcc" => (faces, [fcc; 3]),
        "bcc" => (vec![corner, [0.5; 3]], [2.0 / h; 3]),
        "hcp" => (hcp, [1.0, h, (8f64 / 3.0).sqrt()]),
        // Cells that are longer than those of spheres.
        "hcp long" => (hcp, [1.0, h, 1.75]),
        "diamond" => {
            let beside = faces.iter().map(|x| x.map(|x| x + 0.25));
            (faces.iter().copied().chain(beside).collect(), [4.0 / h; 3])
        }
        "sq" => (vec![corner], [1.0, 1.0, 0.0]),
        "sq2" => (vec![corner, [0.5, 0.5, 0.0]], [fcc, fcc, 0.0]),
        "hex" => (vec![corner, [0.5, 0.5, 0.0]], [1.0, h, 0.0]),
        _ => unreachable!("{name}"),
    };
    Crystal { name, sites, edges, turn }
}

/// Everything that decks make, upright or turned by `orient` or a rotation.
fn crystals() -> Vec<Crystal> {
    let diagonal = orient([[1, 1, 0], [-1, 1, 0], [0, 0, 1]]);
    let steep = orient([[1, 1, 1], [1, -1, 0], [1, 1, -2]]);
    vec![
        crystal("sc", ABOUT_Z),
        crystal("sc", steep),
        crystal("fcc", UPRIGHT),
        crystal("fcc", diagonal),
        crystal("fcc", steep),
        crystal("fcc", anyhow()),
        crystal("bcc", UPRIGHT),
        crystal("bcc", steep),
        crystal("bcc", anyhow()),
        crystal("hcp", UPRIGHT),
        crystal("hcp", anyhow()),
        crystal("hcp long", UPRIGHT),
        crystal("diamond", diagonal),
        crystal("sq", ABOUT_Z),
        crystal("sq2", UPRIGHT),
        crystal("sq2", ABOUT_Z),
        crystal("hex", UPRIGHT),
        crystal("hex", ABOUT_Z),
    ]
}

impl Crystal {
    fn flat(&self) -> bool {
        self.edges[2] == 0.0
    }

    /// Adds the sites inside a box whose corners are given in distances of neighbours, beginning with one in its middle.
    fn fill(&self, s: &mut Scene, lo: [f64; 3], hi: [f64; 3]) {
        let middle = [0, 1, 2].map(|k| 0.5 * (lo[k] + hi[k]));
        let depth = if self.flat() { 0..=0 } else { -16..=16 };
        for k in depth {
            for j in -16..=16 {
                for i in -24..=24 {
                    for site in &self.sites {
                        let cell = [i, j, k].map(f64::from);
                        let at = [0, 1, 2].map(|d| (cell[d] + site[d]) * self.edges[d]);
                        let turned = self.turn.map(|row| (0..3).map(|d| row[d] * at[d]).sum::<f64>());
                        let x = [0, 1, 2].map(|d| turned[d] + middle[d]);
                        if (0..3).all(|d| lo[d] - 1e-6 <= x[d] && x[d] <= hi[d] + 1e-6) {
                            let x = x.map(|x| x * DX);
                            s.x.push(x);
                            s.x0.push(x);
                            s.v.push([0.0; 3]);
                            s.f.push([0.0; 3]);
                            s.kind.push(1);
                            s.volume.push(DX * DX * DX);
                            s.density.push(2200.0);
                        }
                    }
                }
            }
        }
    }

    /// A block of some types hit from the side by a smaller one.
    fn impact(&self, types: u16) -> Scene {
        let mut s = Scene::new(DX, 4e-8, usize::from(types));
        let first = if self.flat() {
            self.fill(&mut s, [0.0; 3], [20.0, 14.0, 0.0]);
            let first = s.x.len();
            self.fill(&mut s, [23.3, 3.0, 0.0], [29.5, 10.0, 0.0]);
            first
        } else {
            self.fill(&mut s, [0.0; 3], [8.0, 6.0, 5.0]);
            let first = s.x.len();
            self.fill(&mut s, [11.3, 1.0, 0.3], [15.0, 5.8, 4.4]);
            first
        };
        for i in 0..s.x.len() {
            let x = s.x[i].map(|x| x / DX);
            let up = if self.flat() { 0.0 } else { 10.0 };
            s.v[i] = if i < first { [0.0, 5.0 * (x[2] + x[0]), 0.0] } else { [-1500.0, 30.0, up] };
        }
        for (a, b) in (1..=types).flat_map(|a| (1..=types).map(move |b| (a, b))) {
            let k = 15e9 / (1.0 + 0.5 * f64::from(a.abs_diff(b)));
            s.table.set(a, b, coeff(k, 0.002 + 0.001 * f64::from(a + b), 0.25)).unwrap();
        }
        s
    }

    /// Types in layers, or scattered with various volumes.
    fn impact_of_types(&self, scattered: bool) -> Scene {
        let mut s = self.impact(3);
        let mut scatter = Scatter(7);
        for i in 0..s.x.len() {
            let layer = (s.x[i][1] / DX / 3.0).round() as u16 % 3;
            s.kind[i] = 1 + if scattered { (3.0 * scatter.next()) as u16 } else { layer };
            if scattered {
                s.volume[i] *= 0.8 + 0.4 * scatter.next();
            }
        }
        s
    }
}

fn families(s: &Scene, layout: Layout) -> Families {
    let options = FamilyOptions { layout, ..s.options };
    Families::build_of(&s.view(), &s.table, options, s.law.clone()).unwrap()
}

#[test]
fn impacts_agree_with_the_textbook() {
    for crystal in crystals() {
        let scene = crystal.impact(1);
        let laid = families(&scene, Layout::Auto);
        assert_eq!((laid.lattices.len(), laid.list.record.len()), (2, 0), "{}", crystal.name);
        check_in(Layout::Auto, crystal.name, &scene, if crystal.flat() { 110 } else { 70 });
    }
}

#[test]
fn types_and_volumes_agree_with_the_textbook() {
    for (name, turn) in [("fcc", UPRIGHT), ("bcc", anyhow()), ("hcp", UPRIGHT), ("hex", ABOUT_Z)] {
        for scattered in [false, true] {
            let scene = crystal(name, turn).impact_of_types(scattered);
            assert_eq!(families(&scene, Layout::Auto).lattices.len(), 2, "{name}");
            check_in(Layout::Auto, name, &scene, if name == "hex" { 110 } else { 70 });
        }
    }
}

#[test]
fn rules_of_volumes_and_breaking_agree_with_the_textbook() {
    for (volume, compat_lammps) in [(VolumeRule::None, true), (VolumeRule::Full, false)] {
        let mut scene = crystal("fcc", anyhow()).impact(1);
        (scene.options.volume, scene.options.compat_lammps) = (volume, compat_lammps);
        check_in(Layout::Auto, "rules", &scene, 70);
    }
}

#[test]
fn drifting_through_the_faces_of_a_box_agrees_with_the_textbook() {
    for name in ["bcc", "hcp"] {
        let mut scene = crystal(name, anyhow()).impact(1);
        scene.bounds = Bounds { lo: [-4.0 * DX; 3], hi: [26.0 * DX; 3], periodic: [true; 3], tilt: [0.0; 3] };
        assert_eq!(families(&scene, Layout::Auto).lattices.len(), 2);
        scene.v.iter_mut().for_each(|v| v[1] += 2000.0);
        check_in(Layout::Auto, "drift", &scene, 70);
    }
}

/// A box that repeats in x and y, filled: its bonds cross the faces, which rows cannot.
#[test]
fn bodies_that_go_on_through_the_faces_of_a_box_stay_lists() {
    let fcc = crystal("fcc", UPRIGHT);
    let mut scene = Scene::new(DX, 4e-8, 1);
    let side = 6.0 * fcc.edges[0];
    fcc.fill(&mut scene, [0.0; 3], [side - 0.1, side - 0.1, 4.0]);
    let lo = [scene.x.iter().map(|x| x[0]).fold(f64::INFINITY, f64::min) - 0.1 * DX; 3];
    let hi = lo.map(|lo| lo + side * DX);
    scene.bounds = Bounds { lo, hi, periodic: [true, true, false], tilt: [0.0; 3] };
    let mut scatter = Scatter(5);
    scene.v.iter_mut().for_each(|v| *v = [0, 1, 2].map(|_| 60.0 * (scatter.next() - 0.5) + 100.0));
    scene.table.set(1, 1, coeff(15e9, 0.004, 0.25)).unwrap();
    assert!(families(&scene, Layout::Auto).lattices.is_empty());
    check_in(Layout::Auto, "wraps", &scene, 40);
}

#[test]
fn state_based_forces_are_those_of_the_formulas() {
    for (name, turn) in [("fcc", UPRIGHT), ("bcc", anyhow()), ("hcp", UPRIGHT), ("sq2", ABOUT_Z)] {
        for kind in states::KINDS {
            for types in [1, 3] {
                let crystal = crystal(name, turn);
                let scene = if types == 1 { crystal.impact(1) } else { crystal.impact_of_types(true) };
                let scene = states::with_law(states::shaken(scene), kind);
                assert_eq!(families(&scene, Layout::Auto).lattices.len(), 2);
                states::check(&format!("{name} {kind:?} {types}"), &scene);
            }
        }
    }
}

/// Everything that can be asked of families and their bonds, in both layouts, while bonds break under all laws.
#[test]
fn layouts_say_the_same_while_bonds_break() {
    let laws = states::KINDS.into_iter().chain(["pmb", "plastic", "shaped"]);
    for (kind, crystal) in laws.zip(crystals().into_iter().cycle().skip(2)) {
        let name = format!("{} {kind:?}", crystal.name);
        let scene = states::with_law(crystal.impact(1), kind);
        let law = Law { yields: vec![-0.003], surface: kind == "shaped", ..scene.law.clone() };
        let mut all = [Layout::Auto, Layout::List].map(|layout| {
            let mut s = scene.clone();
            (s.law, s.options.layout) = (law.clone(), layout);
            s.setup();
            let mut families = s.families.take().unwrap();
            let cut = |a: [f64; 3], b: [f64; 3]| {
                (a[0] - 2.4 * DX) * (b[0] - 2.4 * DX) < 0.0 && a[1] + b[1] < 6.0 * DX
            };
            assert!(families.cut(&s.view(), cut) > 0, "{name}");
            families.counts_losses = true;
            s.families = Some(families);
            (0..45).for_each(|_| s.step());
            s
        });
        let (n, view) = (all[0].x.len(), all[1].view());
        let [rows, list] = [0, 1].map(|k| all[k].families.as_ref().unwrap());
        assert!(rows.lattices.len() == 2 && list.lattices.is_empty(), "{name}");
        assert!(list.live_bonds() < list.bonds() - 200, "{name}: {} {}", list.bonds(), list.live_bonds());
        assert_eq!((rows.bonds(), rows.live_bonds()), (list.bonds(), list.live_bonds()), "{name}");
        let near = |a: f64, b: f64, size: f64| assert!((a - b).abs() <= 1e-9 * size, "{name}: {a:e} {b:e}");
        near(all[0].energy, all[1].energy, all[1].energy.abs());
        let most = all[1].virial.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        (0..6).for_each(|k| near(all[0].virial[k], all[1].virial[k], most));
        near(rows.released, list.released, list.released.abs());
        near(rows.heat, list.heat, all[1].energy.abs());
        let critical = [rows, list].map(|f| f.critical_stretches(&view));
        for i in 0..n {
            let [a, b] = [rows, list].map(|f| f.neighbours_apart(i));
            assert_eq!(a.len(), b.len(), "{name}");
            for ((p, length), (q, other)) in a.iter().zip(&b) {
                assert_eq!(p, q, "{name}");
                near(*length, *other, DX);
                assert_eq!(rows.bonded(i as u32, p.partner), p.alive);
                assert_eq!(rows.bonded(p.partner, i as u32), p.alive);
            }
            near(critical[0][i], critical[1][i], critical[1][i].abs());
            let [a, b] = [rows, list].map(|f| f.gradient(&view, i));
            assert_eq!(a.is_some(), b.is_some(), "{name}");
            for (a, b) in a.iter().flatten().flatten().zip(b.iter().flatten().flatten()) {
                near(*a, *b, 1.0);
            }
            near(rows.dilatation(i), list.dilatation(i), 1e-2);
            near(rows.plastic_strain(i), list.plastic_strain(i), 1e-2);
        }
        // What each particle has of energies and virials, and what is left when some are deleted.
        for s in &mut all {
            let map: Vec<Option<u32>> = (0..n as u32)
                .scan(0, |next, i| Some((i % 5 != 2).then(|| std::mem::replace(next, *next + 1))))
                .collect();
            s.keep(|i| i % 5 != 2);
            s.families.as_mut().unwrap().remap(&map);
        }
        let found = all.each_mut().map(|s| {
            let (mut energy, mut virial) = (vec![0.0; s.x.len()], vec![[0.0; 6]; s.x.len()]);
            let (mut families, mut f) = (s.families.take().unwrap(), vec![[0.0; 3]; s.x.len()]);
            let mut tally = PeriTally {
                per_atom_energy: Some(&mut energy),
                per_atom_virial: Some(&mut virial),
                ..PeriTally::default()
            };
            families.force(&s.view(), &mut f, false, Some(&mut tally));
            (energy, virial, f, families.live_bonds())
        });
        assert_eq!(found[0].3, found[1].3, "{name}");
        let most = found[1].0.iter().fold(0.0f64, |m, e| m.max(e.abs()));
        found[0].0.iter().zip(&found[1].0).for_each(|(a, b)| near(*a, *b, most));
        for (a, b) in [
            (found[0].1.as_flattened(), found[1].1.as_flattened()),
            (found[0].2.as_flattened(), found[1].2.as_flattened()),
        ] {
            let most = b.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            a.iter().zip(b).for_each(|(a, b)| near(*a, *b, most));
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_skipping() {
    let _alone = super::threads::alone();
    for (name, turn, kind) in [("fcc", anyhow(), "pmb"), ("hcp", UPRIGHT, "eps"), ("bcc", UPRIGHT, "ves")] {
        let mut scene = crystal(name, turn).impact(1);
        // At rest until the smaller block arrives.
        scene.v.iter_mut().for_each(|v| *v = if v[0] < 0.0 { *v } else { [0.0; 3] });
        let mut bits = Vec::new();
        for (threads, skip_rest) in [(1, true), (2, true), (7, true), (2, false)] {
            par::set_threads(threads);
            let mut s = states::with_law(scene.clone(), kind);
            s.options.skip_rest = skip_rest;
            s.setup();
            (0..70).for_each(|_| s.step());
            let state: Vec<u64> =
                s.x.iter().chain(&s.v).chain(&s.f).flatten().map(|x| (x + 0.0).to_bits()).collect();
            bits.push((state, s.energy.to_bits(), s.families.as_ref().unwrap().live_bonds()));
        }
        par::set_threads(1);
        assert!(bits.windows(2).all(|b| b[0] == b[1]), "{name} {kind:?}");
    }
}
