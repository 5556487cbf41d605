//! The pool of `ripples`: the same state however time is cut into pictures, waves at the equation's
//! speed, energy that does not grow, and a twin of the step in 64-bit floats.

use std::collections::BTreeMap;
use std::path::Path;

use meniscus::diagnostic::{Sources, Style, render_all};
use meniscus::engine::{Engine, Frame, Runner, StepInfo};
use meniscus::files::DiskFiles;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Request};
use meniscus::program;

/// A pool and what stirs it.
#[derive(Clone, Copy, Debug)]
struct Pool {
    cells: u32,
    /// Length and width; depth does not matter to the waves.
    size_m: [f64; 2],
    speed: f64,
    damping: f64,
    ball_m: f64,
    wake: f64,
    push: f64,
    push_m: f64,
    /// Where the pointer presses, and for how long.
    press_m: [f64; 2],
    press_s: f64,
}

const STIRRED: Pool = Pool {
    cells: 96,
    size_m: [4.8, 3.2],
    speed: 1.2,
    damping: 0.2,
    ball_m: 0.22,
    wake: 0.2,
    push: 0.6,
    push_m: 0.2,
    press_m: [-0.7, 0.4],
    press_s: 0.5,
};

impl Pool {
    fn cell_m(&self) -> f64 {
        self.size_m[0] / f64::from(self.cells)
    }

    fn rows(&self) -> u32 {
        (self.size_m[1] / self.cell_m()).round() as u32
    }

    /// Steps a second, as the graph derives them.
    fn rate(&self) -> f64 {
        (2.0 * self.speed / self.cell_m()).ceil().max(60.0)
    }

    fn pressed(&self, time: f64) -> bool {
        time < self.press_s
    }

    fn params(&self) -> BTreeMap<String, Value> {
        let pool = Value::vec([self.size_m[0], 1.0, self.size_m[1]]);
        let float = Value::Float;
        let named = [
            ("cells", Value::Int(self.cells.into())),
            ("pool", pool),
            ("speed", float(self.speed)),
            ("damping", float(self.damping)),
            ("ball_m", float(self.ball_m)),
            ("wake", float(self.wake)),
            ("push", float(self.push)),
            ("push_m", float(self.push_m)),
            ("sky.face", Value::Int(16)),
        ];
        named.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }

    fn runner(&self, engine: &mut Engine) -> Runner {
        let mut sources = Sources::new();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs/ripples.ron");
        let loaded = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None);
        let request = Request {
            viewport: [8, 8],
            params: self.params(),
            inputs: BTreeMap::from([
                ("camera".into(), InputInfo::Camera),
                ("sun".into(), InputInfo::Light),
                ("pointer".into(), InputInfo::Pointer),
            ]),
            capacities: BTreeMap::new(),
            roots: vec!["surface".into()],
            stats: false,
            memory: Default::default(),
            features: engine.gpu().features(),
            limits: engine.gpu().limits(),
        };
        let planned = instantiate(&loaded.program.unwrap(), &request);
        let plan = planned.unwrap_or_else(|d| panic!("{}", render_all(&d, &sources, Style::Plain)));
        assert_eq!(plan.steps[0].rate, Some(self.rate()));
        engine.prepare(plan, None).unwrap()
    }

    /// Runs some steps in one frame that shows this time.
    fn run(&self, engine: &Engine, runner: &mut Runner, time: f64, steps: u32) {
        let live = |name: &str, step: Option<&StepInfo>| self.live(name, step.map_or(time, |s| s.time));
        let frame = Frame { time, delta: 1.0 / 60.0, frame: 0, steps: &[steps], live: &live, only: None };
        runner.run(engine, &frame).unwrap_or_else(|d| panic!("{d:#?}"));
        // So many steps at once would pile up.
        runner.finish(engine).unwrap();
    }

    /// The pointer looks straight down; camera and sun are of no matter.
    fn live(&self, name: &str, time: f64) -> Option<Value> {
        let (input, field) = name.split_once('.')?;
        Some(match (input, field) {
            ("pointer", "origin") => Value::vec([self.press_m[0], 3.0, self.press_m[1]]),
            ("pointer", "direction") => Value::vec([0.0, -1.0, 0.0]),
            ("pointer", "pressed") => Value::Int(self.pressed(time).into()),
            ("sun", "direction") => Value::vec([0.0, -1.0, 0.0]),
            ("sun", "color") => Value::vec([1.0; 3]),
            ("sun", "intensity") => Value::Float(1.0),
            ("camera", "position") => Value::vec([0.0, 3.0, 0.0]),
            ("camera", "viewport") => Value::vec([8.0; 2]),
            ("camera", "orthographic") => Value::Int(0),
            ("camera", "near" | "pixel_m") => Value::Float(0.01),
            ("camera", _) => Value::vec((0..16).map(|i| f64::from(u8::from(i % 5 == 0))).collect::<Vec<_>>()),
            _ => return None,
        })
    }
}

fn bytes(engine: &mut Engine, runner: &Runner) -> Vec<u8> {
    let surface = runner.plan().names["surface"];
    runner.read_texture(engine, surface, 0, None).unwrap().bytes
}

/// Height and vertical speed of each cell, row by row.
fn state(engine: &mut Engine, runner: &Runner) -> Vec<[f64; 2]> {
    let bytes = bytes(engine, runner);
    let float = |at: &[u8]| f64::from(f32::from_le_bytes(at.try_into().unwrap()));
    bytes.chunks_exact(8).map(|cell| [float(&cell[..4]), float(&cell[4..])]).collect()
}

/// The state after frames at a rate of pictures, each running the steps that are due.
fn watched(engine: &mut Engine, pool: &Pool, pictures_hz: f64, until_s: f64, due: impl Fn(f64, f64) -> u64) -> Vec<u8> {
    let mut runner = pool.runner(engine);
    let mut done = 0;
    for frame in 0..=(until_s * pictures_hz).round() as u64 {
        let time = frame as f64 / pictures_hz;
        let steps = due(time, 1.0 / pictures_hz).saturating_sub(done);
        pool.run(engine, &mut runner, time, steps as u32);
        done += steps;
    }
    bytes(engine, &runner)
}

pub fn state_does_not_depend_on_the_pictures(engine: &mut Engine) {
    let pool = STIRRED;
    let due = |time: f64, _: f64| (time * pool.rate() + 1.0e-9).floor() as u64;
    let all: Vec<Vec<u8>> = [24.0, 60.0, 144.0].iter().map(|hz| watched(engine, &pool, *hz, 2.0, due)).collect();
    assert!(all[0].iter().any(|byte| *byte != 0));
    assert!(all[0] == all[1] && all[0] == all[2], "the same state at 24, 60 and 144 pictures a second");
    // Seeking: all steps in the first frame that is drawn.
    let mut runner = pool.runner(engine);
    pool.run(engine, &mut runner, 2.0, due(2.0, 0.0) as u32);
    assert!(bytes(engine, &runner) == all[0], "and after seeking");
    runner.reset_state(engine).unwrap();
    pool.run(engine, &mut runner, 2.0, due(2.0, 0.0) as u32);
    assert!(bytes(engine, &runner) == all[0], "and from the start again");
    // The comparison sees a pointer that is taken at the picture's time in place of the step's.
    let mut runner = pool.runner(engine);
    let late = Pool { press_s: pool.press_s + 1.0 / pool.rate(), ..pool };
    late.run(engine, &mut runner, 2.0, due(2.0, 0.0) as u32);
    assert!(bytes(engine, &runner) != all[0], "one step more of the pointer shows");
}

/// The step in 64-bit floats, written down from the equation.
struct Twin {
    pool: Pool,
    h: Vec<f64>,
    v: Vec<f64>,
    step: u64,
}

impl Twin {
    fn new(pool: Pool) -> Self {
        let cells = (pool.cells * pool.rows()) as usize;
        Self { pool, h: vec![0.0; cells], v: vec![0.0; cells], step: 0 }
    }

    fn at(&self, x: i64, z: i64) -> f64 {
        let (w, h) = (i64::from(self.pool.cells), i64::from(self.pool.rows()));
        self.h[(z.clamp(0, h - 1) * w + x.clamp(0, w - 1)) as usize]
    }

    fn run(&mut self, steps: u32) {
        (0..steps).for_each(|_| self.advance());
    }

    fn advance(&mut self) {
        let Pool { cells, speed, damping, .. } = self.pool;
        let dt = 1.0 / self.pool.rate();
        let time = (self.step + 1) as f64 * dt;
        let gain = dt * (speed / self.pool.cell_m()).powi(2);
        for z in 0..i64::from(self.pool.rows()) {
            for x in 0..i64::from(cells) {
                let i = (z * i64::from(cells) + x) as usize;
                let around = self.at(x + 1, z) + self.at(x - 1, z) + self.at(x, z + 1) + self.at(x, z - 1);
                self.v[i] = (self.v[i] + gain * (around - 4.0 * self.h[i])) / (1.0 + damping * dt);
                self.v[i] += dt * self.pushed(self.place(x, z), time);
            }
        }
        for z in 0..i64::from(self.pool.rows()) {
            for x in 0..i64::from(cells) {
                let i = (z * i64::from(cells) + x) as usize;
                let at = self.place(x, z);
                self.h[i] += dt * self.v[i] + self.pool.wake * (self.sunk(at, time - dt) - self.sunk(at, time));
            }
        }
        self.step += 1;
    }

    /// A cell's middle from the pool's.
    fn place(&self, x: i64, z: i64) -> [f64; 2] {
        let cell = self.pool.cell_m();
        let half = [f64::from(self.pool.cells), f64::from(self.pool.rows())].map(|n| 0.5 * n * cell);
        [(x as f64 + 0.5) * cell - half[0], (z as f64 + 0.5) * cell - half[1]]
    }

    fn pushed(&self, at: [f64; 2], time: f64) -> f64 {
        if !self.pool.pressed(time) {
            return 0.0;
        }
        let away = [at[0] - self.pool.press_m[0], at[1] - self.pool.press_m[1]];
        let s = (away[0] * away[0] + away[1] * away[1]) / (self.pool.push_m * self.pool.push_m);
        -10.0 * self.pool.push * (1.0 - s) * (-s).exp()
    }

    fn sunk(&self, at: [f64; 2], time: f64) -> f64 {
        let radius = self.pool.ball_m;
        if radius == 0.0 {
            return 0.0;
        }
        let cell = self.pool.cell_m();
        let reach = [self.pool.cells, self.pool.rows()].map(|n| (0.5 * f64::from(n) * cell - 1.9 * radius).max(0.0));
        let middle = [reach[0] * (0.5 * time).sin(), 0.85 * reach[1] * time.sin()];
        let away = [at[0] - middle[0], at[1] - middle[1]];
        let rest = (1.0 - (away[0] * away[0] + away[1] * away[1]) / (radius * radius)).max(0.0);
        radius * rest * rest
    }

    /// What the equation keeps, in this discretization: half v^2 + half c^2 grad h(now) . grad h(before).
    fn energy(pool: &Pool, state: &[[f64; 2]]) -> f64 {
        let (w, rows) = (pool.cells as usize, pool.rows() as usize);
        let dt = 1.0 / pool.rate();
        let per_cell = (pool.speed / pool.cell_m()).powi(2);
        let mut sum = 0.0;
        for z in 0..rows {
            for x in 0..w {
                let [h, v] = state[z * w + x];
                sum += 0.5 * v * v;
                let beside = [(x + 1 < w).then(|| z * w + x + 1), (z + 1 < rows).then(|| (z + 1) * w + x)];
                for [other_h, other_v] in beside.into_iter().flatten().map(|i| state[i]) {
                    let now = other_h - h;
                    let before = now - dt * (other_v - v);
                    sum += 0.5 * per_cell * now * before;
                }
            }
        }
        sum * pool.cell_m() * pool.cell_m()
    }
}

/// Root of the mean squared difference of heights, in parts of the greatest height.
fn error(found: &[[f64; 2]], twin: &Twin) -> f64 {
    let greatest = twin.h.iter().fold(0.0_f64, |most, h| most.max(h.abs()));
    let squares: f64 = found.iter().zip(&twin.h).map(|([h, _], wanted)| (h - wanted).powi(2)).sum();
    (squares / found.len() as f64).sqrt() / greatest
}

pub fn a_step_is_its_twin_in_64_bits(engine: &mut Engine) {
    const STEPS: u32 = 200;
    let mut runner = STIRRED.runner(engine);
    STIRRED.run(engine, &mut runner, 0.0, STEPS);
    let found = state(engine, &runner);
    let mut twin = Twin::new(STIRRED);
    twin.run(STEPS);
    let off = error(&found, &twin);
    assert!(off < 2.0e-4, "{off}");
    // The comparison sees a tenth more of damping, and a step too few.
    let mut slow = Twin::new(Pool { damping: STIRRED.damping * 1.1, ..STIRRED });
    slow.run(STEPS);
    assert!(error(&found, &slow) > 2.0e-4);
    let mut late = Twin::new(STIRRED);
    late.run(STEPS - 1);
    assert!(error(&found, &late) > 2.0e-4);
}

/// A large pool, poked in the middle for a moment.
const POKED: Pool = Pool {
    cells: 320,
    size_m: [8.0, 8.0],
    damping: 0.0,
    ball_m: 0.0,
    push_m: 0.25,
    press_m: [0.0, 0.0],
    press_s: 0.02,
    ..STIRRED
};

/// Way from the middle to the outermost crest or trough, along the pool, in metres.
fn front(pool: &Pool, state: &[[f64; 2]]) -> f64 {
    let (w, z) = (pool.cells as usize, pool.rows() as usize / 2);
    let row: Vec<f64> = (w / 2..w).map(|x| state[z * w + x][0]).collect();
    let greatest = row.iter().fold(0.0_f64, |most, h| most.max(h.abs()));
    // From outside: the first extremum that is no ripple of rounding.
    let is_peak = |i: &usize| {
        let (a, b, c) = (row[i - 1], row[*i], row[i + 1]);
        b.abs() > 0.2 * greatest && (b - a) * (c - b) <= 0.0
    };
    let i = (1..row.len() - 1).rev().find(is_peak).unwrap();
    let (a, b, c) = (row[i - 1], row[i], row[i + 1]);
    let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
    (i as f64 + 0.5 + shift) * pool.cell_m()
}

pub fn waves_travel_at_the_speed_of_the_equation(engine: &mut Engine) {
    let mut runner = POKED.runner(engine);
    let rate = POKED.rate();
    let (first, second) = ((1.0 * rate) as u32, (2.6 * rate) as u32);
    POKED.run(engine, &mut runner, 0.0, first);
    let near = front(&POKED, &state(engine, &runner));
    POKED.run(engine, &mut runner, 0.0, second - first);
    let far = front(&POKED, &state(engine, &runner));
    let speed = (far - near) / (f64::from(second - first) / rate);
    println!("waves travel at {speed:.4} m/s, the equation's speed is {} m/s", POKED.speed);
    assert!((speed / POKED.speed - 1.0).abs() < 0.02, "{speed} m/s, from {near} m to {far} m");
}

/// 3,000 steps; with `MENISCUS_LONG=1` in the environment 100,000.
pub fn energy_does_not_grow(engine: &mut Engine) {
    let steps = if std::env::var_os("MENISCUS_LONG").is_some() { 100_000 } else { 3_000 };
    let pool = Pool { cells: 48, damping: 0.0, ball_m: 0.0, press_s: 0.3, ..STIRRED };
    let mut runner = pool.runner(engine);
    let mut done = (pool.press_s * pool.rate()).ceil() as u32 + 1;
    pool.run(engine, &mut runner, 0.0, done);
    let first = Twin::energy(&pool, &state(engine, &runner));
    assert!(first > 1.0e-6, "{first}");
    let (mut least, mut most) = (first, first);
    while done < steps {
        let more = (steps - done).min(500);
        pool.run(engine, &mut runner, 1.0e6, more);
        done += more;
        let now = Twin::energy(&pool, &state(engine, &runner));
        (least, most) = (least.min(now), most.max(now));
    }
    let (fell, grew) = (1.0 - least / first, most / first - 1.0);
    println!("over {steps} steps energy fell by at most {fell:.2e} and grew by at most {grew:.2e} of {first:.3e}");
    assert!(grew < 1.0e-4 && fell < 1.0e-4, "fell by {fell}, grew by {grew}");
}

/// The measure of energy sees a scheme that gains: heights moved by the speeds of before.
pub fn the_measure_of_energy_sees_one_that_grows(_: &mut Engine) {
    let pool = Pool { cells: 48, damping: 0.0, ball_m: 0.0, press_s: 0.3, ..STIRRED };
    let measured = |twin: &Twin| {
        let state: Vec<[f64; 2]> = twin.h.iter().zip(&twin.v).map(|(h, v)| [*h, *v]).collect();
        Twin::energy(&pool, &state)
    };
    let mut twin = Twin::new(pool);
    twin.run(40);
    let first = measured(&twin);
    twin.run(200);
    assert!((measured(&twin) / first - 1.0).abs() < 1.0e-9, "kept but for rounding in 64 bits");
    let mut gaining = Twin::new(Pool { damping: -1.0e-2, ..pool });
    (gaining.h, gaining.v, gaining.step) = (twin.h.clone(), twin.v.clone(), twin.step);
    gaining.run(200);
    assert!(measured(&gaining) / first > 1.0 + 1.0e-3);
}
