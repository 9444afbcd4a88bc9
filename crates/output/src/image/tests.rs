//! Pictures: geometry, colours and sameness, not taste.

use super::*;

fn scene<'a>(x: &'a [[f64; 3]], r: &'a [f64], c: &'a [Colour]) -> Scene<'a> {
    Scene {
        positions: x,
        radii: r,
        colours: c,
        lines: &[],
        walls: &[],
        scale: None,
        legend: None,
        title: "",
        caption: "",
    }
}

fn pixel(image: &Image, x: usize, y: usize) -> [u8; 3] {
    image.pixels[y * image.width + x]
}

fn look(width: usize, height: usize) -> Look {
    Look { width, height, ..Look::default() }
}

#[test]
fn the_nearer_sphere_is_seen_and_the_frame_fits() {
    let (red, blue) = (Colour::hex(0xd00000), Colour::hex(0x0000d0));
    // Seen from +z with y up: x to the right; the blue one is in front.
    let x = [[0.0, 0.0, 0.0], [0.0, 0.0, 5.0], [-3.0, 0.0, 0.0]];
    let (r, c) = ([2.0, 1.0, 1.0], [red, blue, red]);
    let camera = Camera { theta: 0.0, phi: 0.0, ..Camera::default() };
    let view = camera.frame(x.iter().copied().zip(r));
    // Along x from -4 to 2, along y from -2 to 2, with 6 % to spare.
    assert!((view.span[0] - 6.0 * 1.06).abs() < 1e-12 && (view.span[1] - 4.0 * 1.06).abs() < 1e-12);
    for perspective in [0.0, 30.0] {
        let view = View { distance: if perspective > 0.0 { 30.0 } else { f64::INFINITY }, ..view };
        let image = render(&scene(&x, &r, &c), &view, &look(300, 200));
        // The middle of the view is x = -1; 300 pixels are 6.36 long.
        let at = |px: f64| pixel(&image, (150.0 + (px + 1.0) * 300.0 / 6.36) as usize, 100);
        let [front, side, left] = [at(0.0), at(1.6), at(-3.0)];
        assert!(front[2] > 100 && front[0] < 100, "{front:?}");
        assert!(side[0] > side[2] + 50, "{side:?}");
        assert!(left[0] > left[2] + 50, "{left:?}");
        assert_eq!(pixel(&image, 2, 2)[0], pixel(&image, 297, 2)[0]);
        assert!(pixel(&image, 2, 2)[0] > 230);
    }
}

#[test]
fn thread_count_does_not_show() {
    let x: Vec<[f64; 3]> = (0..3000).map(|i| [i % 15, i / 15 % 10, i / 150].map(|c| c as f64)).collect();
    let r = vec![0.55; x.len()];
    let c: Vec<Colour> = (0..x.len()).map(|i| MAPS[1].at(i as f64 / 3000.0)).collect();
    let view = Camera::default().frame(x.iter().copied().zip(r.iter().copied()));
    let draw = || render(&scene(&x, &r, &c), &view, &look(200, 150));
    perigrain_base::par::set_threads(1);
    let one = draw();
    perigrain_base::par::set_threads(3);
    let three = draw();
    perigrain_base::par::set_threads(1);
    assert!(one == three);
}

#[test]
fn what_large_spheres_hide_is_not_drawn_and_nothing_else_is_missing() {
    // A body of cubes a hundredth as wide as their spheres: the one seen at each sample, found by testing all of them.
    let x: Vec<[f64; 3]> =
        (0..600).map(|i| [i % 10, i / 10 % 10, i / 100].map(|c| 0.01 * f64::from(c))).collect();
    let r: Vec<f64> = (0..600).map(|i| 0.5 + 1e-4 * f64::from(i % 7)).collect();
    let c: Vec<Colour> = (0..600).map(|i| by_kind(i % 8)).collect();
    let scene = scene(&x, &r, &c);
    for camera in [Camera::default(), Camera { perspective: 40.0, ..Camera::default() }] {
        let view = camera.frame(x.iter().copied().zip(r.iter().copied()));
        let frame = Frame::new(&scene, &look(150, 100));
        let raster = Raster::new(&scene, &view, &frame);
        for y in 0..200 {
            for px in 0..300 {
                let depth = raster.discs.iter().map(|d| d.depth(px as f32 + 0.5, y as f32 + 0.5));
                let most = depth.fold(f32::NEG_INFINITY, f32::max);
                // Another order of the same operations rounds otherwise, most at the rim of a sphere, where a depth is the root of a small
                // difference: 4e-4 measured.
                let seen = raster.depth(px, y);
                assert!(seen == most || (seen - most).abs() < 1e-3, "{px} {y}: {seen} {most}");
            }
        }
    }
}

#[test]
fn walls_are_seen_through_before_and_behind_a_sphere() {
    let (x, r, c) = ([[0.0; 3]], [1.0], [Colour::hex(0xd0d0d0)]);
    let wall = |z: f64| [[-3.0, -3.0, z], [3.0, -3.0, z], [0.0, 6.0, z]];
    let camera = Camera { theta: 0.0, phi: 0.0, ..Camera::default() };
    let view = camera.frame(x.iter().copied().zip(r));
    let of = |walls: &[[[f64; 3]; 3]]| render(&Scene { walls, ..scene(&x, &r, &c) }, &view, &look(80, 60));
    let [bare, front, behind, both] =
        [&[][..], &[wall(2.0)], &[wall(-2.0)], &[wall(2.0), wall(-2.0)]].map(of);
    let (sphere, beside) = (|i: &Image| pixel(i, 40, 30), |i: &Image| pixel(i, 8, 30));
    assert!(sphere(&front)[0] < sphere(&bare)[0] && sphere(&behind) == sphere(&bare));
    assert!(beside(&front) == beside(&behind) && beside(&front)[0] < beside(&bare)[0]);
    assert!(beside(&both)[0] < beside(&front)[0] && sphere(&both) == sphere(&front));
    // More than half of the light comes through one.
    assert!(u32::from(beside(&front)[0]) > u32::from(beside(&bare)[0]) / 2);
}

#[test]
fn a_scale_bar_has_its_stated_length() {
    let (x, r, c) = ([[0.0; 3]], [1.0], [Colour::hex(0xd0d0d0)]);
    let view = Camera::default().frame(x.iter().copied().zip(r));
    let bar = ScaleBar { units: &[] };
    let bare = Look { background: [Colour::hex(0xffffff); 2], ..look(400, 300) };
    let image = render(&Scene { scale: Some(&bar), ..scene(&x, &r, &c) }, &view, &bare);
    // The sphere's 2.12 fit into 300 pixels less the line of 23 (2.6 × 9): 130.66 to a length, of which a fifth of 400 is 0.61: 0.5.
    let row = 300 - 18 + 4;
    let dark: Vec<usize> = (200..400).filter(|k| pixel(&image, *k, row)[0] < 120).collect();
    let run = dark
        .iter()
        .scan(dark[0], |last, k| {
            (k - *last <= 1).then(|| {
                *last = *k;
                *k
            })
        })
        .count();
    assert!((63..=69).contains(&run), "{run}: {dark:?}");
}

#[test]
fn nothing_breaks_on_odd_input() {
    let x = [[f64::NAN, 0.0, 0.0], [1e300, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0]];
    let (r, c) = ([1.0, 1.0, -1.0, f64::INFINITY], [Colour::default(); 4]);
    for n in [0, 4] {
        let view = Camera::default().frame(x[..n].iter().copied().zip(r[..n].iter().copied()));
        let tiny = Look { width: 3, height: 2, samples: 0, ..Look::default() };
        let legend = Legend::Scale { title: "µm".into(), map: &MAPS[0], range: [f64::NAN, 1.0] };
        let scene = Scene { legend: Some(&legend), title: "t", ..scene(&x[..n], &r[..n], &c[..n]) };
        assert_eq!(render(&scene, &view, &tiny).pixels.len(), 6);
    }
    let line = [[[0.0; 3], [1.0, 1.0, 1.0]]];
    let view = Camera { perspective: 40.0, ..Camera::default() }.frame_box([[0.0, 1.0]; 3]);
    let scene = Scene { lines: &line, ..scene(&[], &[], &[]) };
    let image = render(&scene, &view, &look(60, 60));
    let darkest = (0..9).map(|k| pixel(&image, 29 + k % 3, 29 + k / 3)[0]).min();
    assert!(darkest < Some(200), "a line crosses the middle: {darkest:?}");
}

#[test]
fn colour_maps() {
    // Ends and middle of matplotlib 3's viridis: (68, 1, 84), (253, 231, 37); its middle is (33, 145, 140).
    let viridis = Map::by_name("viridis").unwrap();
    assert_eq!(viridis.at(0.0).bytes(), [68, 1, 84]);
    assert_eq!(viridis.at(1.0).bytes(), [253, 231, 37]);
    assert_eq!(viridis.at(0.5).bytes(), [33, 145, 140]);
    assert_eq!(viridis.at(7.0), viridis.at(1.0));
    assert_eq!(viridis.of(3.0, [1.0, 5.0]), viridis.at(0.5));
    assert_eq!(viridis.of(2.0, [2.0, 2.0]), viridis.at(0.5));
    assert_eq!(viridis.of(f64::NAN, [0.0, 1.0]).bytes(), [255, 0, 255]);
    // Bytes survive the way to linear light and back.
    for v in 0..=255 {
        assert_eq!(Colour::from_bytes([v, 255 - v, 7]).bytes(), [v, 255 - v, 7]);
    }
    assert_eq!(colour_by_name("#0a0B0c").unwrap().bytes(), [10, 11, 12]);
    assert!(colour_by_name("#12345g").is_none() && colour_by_name("mauve-ish").is_none());
}

#[test]
fn round_ticks() {
    assert_eq!(ticks([0.0, 1.0]).1, ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
    assert_eq!(ticks([-1.0, 1.0]).1, ["-1", "-0.5", "0", "0.5", "1"]);
    assert_eq!(ticks([3.0, 3.0]).1, ["3"]);
    assert_eq!(ticks([0.0, 1.7e-5]).1, ["0", "5e-06", "1e-05", "1.5e-05"]);
}

#[test]
fn png_reads_back() {
    let image = Image { width: 2, height: 1, pixels: vec![[1, 2, 3], [250, 0, 9]] };
    let bytes = image.png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, image.pixels.as_flattened());
}
#[test]
fn letters_show() {
    for c in ' '..='~' {
        let mut one = Image { width: 40, height: 40, pixels: vec![[255; 3]; 1600] };
        text::draw(&mut one, &c.to_string(), 10.0, 5.0, 20.0, Colour::hex(0));
        assert_eq!(one.pixels.iter().any(|p| p[0] < 128), c != ' ', "{c}");
    }
}
