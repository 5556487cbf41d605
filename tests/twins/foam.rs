//! Droplets of white water against a twin in 64-bit floats: capsules along their motion, blended in any order, and seen
//! where the liquid's surface bends their light from.

use meniscus::diagnostic::{Diagnostics, Sources, Style, render_all};
use meniscus::engine::Engine;
use meniscus::files::MemoryFiles;
use meniscus::host::{Cache, Job, Moment, Session, load};

use crate::ball::unit;

const SIZE: [u32; 2] = [192, 128];
const RADIUS: f64 = 0.04;
const SHUTTER: f64 = 0.02;
const OPACITY: f64 = 0.6;
/// Against the radius; a particle stands for one droplet here.
const DROPLET: f64 = 1.5;
const IOR: f64 = 1.333;
/// Eye z of a level liquid that faces the eye, in the tests that have one.
const FRONT: f64 = -1.6;

/// The eye is at the origin and looks along -z, with a vertical angle of 60 degrees.
const TAN: f64 = 0.577_350_269_189_625_8;

#[derive(Clone, Copy)]
struct Spray {
    at: [f64; 3],
    velocity: [f64; 3],
}

const FLYING: [Spray; 5] = [
    Spray { at: [-0.6, 0.3, -1.5], velocity: [9.0, 4.0, 0.0] },
    Spray { at: [0.5, -0.2, -1.8], velocity: [0.0, -12.0, 5.0] },
    // Before and behind one another, and at rest.
    Spray { at: [0.05, 0.1, -2.0], velocity: [0.0; 3] },
    Spray { at: [0.07, 0.13, -2.6], velocity: [-6.0, 0.0, -4.0] },
    Spray { at: [0.9, 0.5, -2.2], velocity: [1.0, 1.0, 20.0] },
];

/// Weight and light of a pixel, and what stays clear.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    weight: f64,
    clear: f64,
}

fn graph(front: f64) -> String {
    format!(
        r#"Graph(
            inputs: {{ "camera": Camera, "sun": Light, "foam": Particles(attributes: ["position", "velocity?"]) }},
            resources: {{
                "layers": Texture(format: Rg32Float, size: "viewport"), "dry_z": Texture(format: R32Float, size: "viewport"),
                "picture": Texture(format: Rgba16Float, size: "viewport"), "ambient": Buffer(items: 9),
            }},
            passes: [
                Clear("layers", ({front:?}, 0.0, 0.0, 0.0)), Clear("dry_z"), Clear("picture"), Clear("ambient"),
                Use(graph: "parts/foam.ron", name: "white", bind: {{"particles": "foam"}}, params: {{
                    "droplets": 1, "spread": 0.0, "foam_size": {DROPLET:?}, "foam_opacity": {OPACITY:?}, "shutter": {SHUTTER:?}, "ior": {IOR:?},
                }}),
            ],
            outputs: ["picture"],
        )"#
    )
}

const SCENE: &str = r#"Scene(
    graph: "g.ron",
    camera: Camera(eye: (0.0, 0.0, 0.0), target: (0.0, 0.0, -1.0), fov: 60.0, near: 0.01),
    lights: {"sun": Light(direction: (0.0, -1.0, 0.0))},
    particles: {"foam": (file: "foam.csv", radius: 0.04)},
)"#;

/// The device's pixels.
fn drawn(engine: &Engine, spray: &[Spray], front: f64) -> Vec<Pixel> {
    let mut csv = "x,y,z,vx,vy,vz\n".to_owned();
    for Spray { at, velocity } in spray {
        let row: Vec<String> = at.iter().chain(velocity).map(|x| (*x as f32).to_string()).collect();
        csv += &(row.join(",") + "\n");
    }
    let files = MemoryFiles::default().with("g.ron", graph(front)).with("s.ron", SCENE).with("foam.csv", csv);
    let roots = vec!["white.light".to_owned(), "white.clear".to_owned()];
    let job = Job { source: "s.ron".into(), size: Some(SIZE), roots, ..Job::default() };
    let mut sources = Sources::new();
    let loaded = load(&files, &mut sources, &job, &mut Cache::default());
    let said = |found: &Diagnostics| render_all(found, &sources, Style::Plain);
    let content = loaded.content.unwrap_or_else(|| panic!("{}", said(&loaded.diagnostics)));
    let mut session = Session::new(engine.gpu().clone());
    session.build(content).unwrap_or_else(|found| panic!("{}", said(&found)));
    session.draw(Moment::default(), false).unwrap_or_else(|found| panic!("{}", said(&found)));
    let mut read = |name: &str| {
        let object = session.object(name).expect("it is there").0;
        session.texels(object).unwrap_or_else(|d| panic!("{d:#?}")).rgba
    };
    let (light, clear) = (read("white.light"), read("white.clear"));
    light.iter().zip(&clear).map(|(l, c)| Pixel { weight: f64::from(l[3]), clear: f64::from(c[0]) }).collect()
}

/// The second of the three numbers that `lib/scatter.wgsl` makes of (particle, 0, 2).
fn chance(particle: u32) -> f64 {
    let step = |v: [u32; 3]| {
        let x = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        let y = v[1].wrapping_add(v[2].wrapping_mul(x));
        [x, y, v[2].wrapping_add(x.wrapping_mul(y))]
    };
    let seed = [particle, 0, 2].map(|x: u32| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mixed = step(step(seed).map(|x| x ^ (x >> 16)));
    f64::from(mixed[1] >> 8) / 16_777_216.0
}

fn pixel_m(z: f64) -> f64 {
    -z * 2.0 * TAN / f64::from(SIZE[1])
}

/// A pixel's centre on the plane at eye z.
fn on_plane(x: u32, y: u32, z: f64) -> [f64; 2] {
    let [w, h] = SIZE.map(f64::from);
    [(f64::from(x) + 0.5 - 0.5 * w) * pixel_m(z), (0.5 * h - f64::from(y) - 0.5) * pixel_m(z)]
}

/// Where a droplet is seen, and what of its light comes through a level surface that faces the eye.
fn image(at: [f64; 3], front: f64) -> ([f64; 3], f64) {
    if front == 0.0 || at[2] >= front {
        return (at, 1.0);
    }
    let cosine = -unit(at)[2];
    let inner = (1.0 - (1.0 - cosine * cosine) / (IOR * IOR)).sqrt();
    let (across, along) =
        ((cosine - IOR * inner) / (cosine + IOR * inner), (IOR * cosine - inner) / (IOR * cosine + inner));
    ([at[0], at[1], front + (at[2] - front) / IOR], 1.0 - 0.5 * (across * across + along * along))
}

/// What the shader is to do, pixel by pixel.
fn expected(spray: &[Spray], front: f64) -> Vec<Pixel> {
    let mut pixels = vec![Pixel { weight: 0.0, clear: 1.0 }; (SIZE[0] * SIZE[1]) as usize];
    for (i, Spray { at, velocity }) in spray.iter().enumerate() {
        let (p, through) = image(*at, front);
        let turn = chance(i as u32);
        let radius = DROPLET * RADIUS * (0.45 + 1.1 * turn * turn);
        let shown = radius.max(0.75 * pixel_m(p[2]));
        // How far its image goes while the shutter is open, on the plane where it is.
        let smear = [0, 1].map(|k| SHUTTER * (velocity[k] - p[k] / p[2] * velocity[2]));
        let length = smear[0].hypot(smear[1]);
        let along = if length > 0.0 { smear.map(|x| x / length) } else { [1.0, 0.0] };
        let reach = (0.5 * length).min(64.0 * pixel_m(p[2])) / shown;
        let grown = radius / shown;
        let opacity = OPACITY * through * grown * grown / (1.0 + 16.0 / (3.0 * std::f64::consts::PI) * reach);
        for (k, pixel) in pixels.iter_mut().enumerate() {
            let q = on_plane(k as u32 % SIZE[0], k as u32 / SIZE[0], p[2]);
            let d = [(q[0] - p[0]) / shown, (q[1] - p[1]) / shown];
            let (beside, past) = (d[1] * along[0] - d[0] * along[1], (d[0] * along[0] + d[1] * along[1]).abs() - reach);
            let alpha = opacity * (1.0 - past.max(0.0).powi(2) - beside * beside).max(0.0);
            if alpha >= 1e-3 {
                pixel.weight += alpha * (1.0 / (1e-3 + at[2] * at[2])).clamp(1e-2, 1e2);
                pixel.clear *= 1.0 - alpha;
            }
        }
    }
    pixels
}

/// The largest difference; half floats hold three digits.
fn apart(a: &[Pixel], b: &[Pixel]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a.weight - b.weight).abs().max((a.clear - b.clear).abs()));
    differences.fold(0.0, f64::max)
}

const TOLERANCE: f64 = 4e-3;

pub fn droplets_are_capsules_along_their_motion(engine: &mut Engine) {
    let found = drawn(engine, &FLYING, 0.0);
    let difference = apart(&found, &expected(&FLYING, 0.0));
    assert!(difference < TOLERANCE, "{difference}");
    // Other motion, and none, are told from it.
    let turned = FLYING.map(|s| Spray { velocity: [s.velocity[0], -s.velocity[1], s.velocity[2]], ..s });
    let still = FLYING.map(|s| Spray { velocity: [0.0; 3], ..s });
    for wrong in [turned, still] {
        assert!(apart(&found, &expected(&wrong, 0.0)) > 20.0 * TOLERANCE);
    }
}

pub fn motion_smears_a_droplet_and_takes_nothing_from_it(engine: &mut Engine) {
    let total = |spray: Spray| drawn(engine, &[spray], 0.0).iter().map(|p| p.weight).sum::<f64>();
    let [fast, slow] = [[10.0, 3.0, 0.0], [0.0; 3]].map(|velocity| Spray { at: [0.1, 0.05, -1.5], velocity });
    let [fast, slow] = [fast, slow].map(total);
    assert!((fast / slow - 1.0).abs() < 0.02, "{fast} against {slow}");
}

pub fn the_order_of_droplets_does_not_count(engine: &mut Engine) {
    // Which one is which decides its size: two of them, alike but for their places.
    let near = Spray { at: [0.0, 0.0, -1.5], velocity: [8.0, 0.0, 0.0] };
    let all: Vec<Spray> = (0..6).map(|i| Spray { at: [0.02 * f64::from(i), 0.0, -1.5], ..near }).collect();
    let found = drawn(engine, &all, 0.0);
    assert!(apart(&found, &expected(&all, 0.0)) < TOLERANCE);
}

/// Where a droplet's light is, in pixels.
fn middle(pixels: &[Pixel]) -> [f64; 2] {
    let total: f64 = pixels.iter().map(|p| p.weight).sum();
    let mean = |f: fn(u32) -> u32| {
        let parts = pixels.iter().enumerate().map(|(k, p)| p.weight * (f64::from(f(k as u32)) + 0.5));
        parts.sum::<f64>() / total
    };
    [mean(|k| k % SIZE[0]), mean(|k| k / SIZE[0])]
}

/// Where a ray from the eye goes through a level surface to meet a point below it, by Snell's law; as a pixel along x.
fn by_snell(at: [f64; 3]) -> f64 {
    let (mut low, mut high) = (0.0, at[0]);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let sine = middle / middle.hypot(FRONT) / IOR;
        let meets = middle + (FRONT - at[2]) * sine / (1.0 - sine * sine).sqrt();
        if meets < at[0] { low = middle } else { high = middle }
    }
    low / pixel_m(FRONT) + 0.5 * f64::from(SIZE[0])
}

pub fn below_the_surface_they_are_where_it_bends_their_light_from(engine: &mut Engine) {
    let below = Spray { at: [0.6, 0.0, -2.6], velocity: [0.0; 3] };
    let found = drawn(engine, &[below], FRONT);
    let difference = apart(&found, &expected(&[below], FRONT));
    assert!(difference < TOLERANCE, "{difference}");
    let (seen, straight) = (middle(&found)[0], middle(&drawn(engine, &[below], 0.0))[0]);
    let exact = by_snell(below.at);
    assert!((seen - exact).abs() < 0.4, "seen at {seen}, by Snell's law at {exact}");
    assert!((straight - exact).abs() > 2.0, "without the surface at {straight}");
    // Before the surface nothing bends.
    let above = Spray { at: [0.3, 0.0, -1.4], ..below };
    assert!(apart(&drawn(engine, &[above], FRONT), &drawn(engine, &[above], 0.0)) == 0.0);
}
