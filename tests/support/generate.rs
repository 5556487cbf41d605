//! Random graphs that are right by construction: what each pass reads was written before it.
//!
//! A graph grows from a list of numbers, so that proptest can shrink it and any generator of
//! numbers can make one.

#![allow(dead_code, reason = "each test program uses a part of it")]

use std::fmt::Write as _;

use meniscus::diagnostic::{Diagnostics, Sources};
use meniscus::files::MemoryFiles;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{Plan, Request};
use meniscus::program;
use wgpu_types::{Features, Limits};

const FORMATS: [&str; 3] = ["Rgba16Float", "R32Float", "Rgba8Unorm"];
const STORED: [&str; 3] = ["rgba16float", "r32float", "rgba8unorm"];
const SIZES: [&str; 3] = ["\"viewport\"", "(16, 16)", "(7, 5)"];

/// A graph with its shaders.
#[derive(Clone, Debug)]
pub struct Generated {
    pub graph: String,
    shaders: Vec<(String, String)>,
    /// Passes that the graph contributes at the values of `times` and `fancy`.
    pub passes: usize,
    times: i64,
    fancy: bool,
    /// What somebody asks for besides the first output.
    roots: Vec<String>,
}

impl Generated {
    pub fn files(&self) -> MemoryFiles {
        let files = MemoryFiles::default().with("graphs/test.ron", &self.graph);
        self.shaders.iter().fold(files, |files, (name, text)| files.with(format!("shaders/{name}"), text))
    }

    /// What to plan it with; the parameters are put in in one of two orders.
    pub fn request(&self, features: Features, limits: Limits, turned: bool) -> Request {
        let mut params = vec![("times", Value::Int(self.times)), ("fancy", Value::Bool(self.fancy))];
        if turned {
            params.reverse();
        }
        Request {
            viewport: [24, 18],
            params: params.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
            inputs: Default::default(),
            capacities: Default::default(),
            roots: self.roots.clone(),
            features,
            limits,
        }
    }

    pub fn plan(&self, request: &Request) -> Result<Plan, (Diagnostics, Sources)> {
        let mut sources = Sources::new();
        let loaded = program::load(&self.files(), &mut sources, "graphs/test.ron", None);
        let Some(program) = loaded.program else { return Err((loaded.diagnostics, sources)) };
        instantiate(&program, request).map_err(|found| (found, sources))
    }
}

/// A texture or buffer, and which of its parts something wrote.
#[derive(Clone)]
struct Thing {
    name: String,
    what: What,
    /// For each mip and layer; buffers have one part.
    written: Vec<bool>,
}

#[derive(Clone, Copy, PartialEq)]
enum What {
    Texture { format: usize, size: usize, layers: u32, mips: u32, auto: bool },
    Depth { size: usize },
    Samples { size: usize },
    Buffer { items: u32 },
    Numbers,
    Volume,
    Stencil { size: usize },
    List,
    Arguments,
}

impl Thing {
    fn is_written(&self) -> bool {
        self.written.iter().all(|part| *part)
    }
}

struct Builder<'a> {
    numbers: std::slice::Iter<'a, u32>,
    things: Vec<Thing>,
    text: String,
    names: usize,
    passes: usize,
    times: i64,
    fancy: bool,
}

/// Grows a graph from numbers; an empty list gives the smallest one.
pub fn grow(numbers: &[u32]) -> Generated {
    let mut builder = Builder {
        numbers: numbers.iter(),
        things: Vec::new(),
        text: String::new(),
        names: 0,
        passes: 0,
        times: 0,
        fancy: false,
    };
    builder.times = i64::from(builder.below(4));
    builder.fancy = builder.below(2) == 1;
    builder.declare();
    // Everything is written once by something simple, so that what follows may read it.
    builder.begin();
    while builder.numbers.len() > 0 {
        builder.step();
    }
    let steps = builder.steps();
    builder.finish(&steps)
}

impl Builder<'_> {
    fn below(&mut self, n: u32) -> u32 {
        self.numbers.next().map_or(0, |number| number % n)
    }

    fn declare(&mut self) {
        let mut add = |name: String, what: What, parts: u32| {
            self.things.push(Thing { name, what, written: vec![false; parts as usize] });
        };
        // Two of each kind, so that they can swap and be copied.
        for (format, _) in FORMATS.iter().enumerate() {
            for name in ["a", "b"] {
                let what = What::Texture { format, size: format, layers: 1, mips: 1, auto: false };
                add(format!("t{format}{name}"), what, 1);
            }
        }
        for name in ["a", "b"] {
            let what = What::Texture { format: 0, size: 1, layers: 2, mips: 3, auto: false };
            add(format!("parts_{name}"), what, 6);
            add(format!("items_{name}"), What::Buffer { items: 100 }, 1);
        }
        add("mipped".into(), What::Texture { format: 0, size: 2, layers: 1, mips: 3, auto: true }, 1);
        add("depth".into(), What::Depth { size: 1 }, 1);
        for name in ["a", "b"] {
            add(format!("samples_{name}"), What::Samples { size: 1 }, 1);
            add(format!("numbers_{name}"), What::Numbers, 1);
            add(format!("volume_{name}"), What::Volume, 1);
        }
        add("stencil".into(), What::Stencil { size: 1 }, 1);
        add("few".into(), What::Buffer { items: 1 }, 1);
        add("list".into(), What::List, 1);
        add("arguments".into(), What::Arguments, 1);
    }

    fn pass(&mut self, kind: &str, fields: &str) {
        _ = writeln!(self.text, "        {kind}(name: \"p{}\", {fields}),", self.names);
        self.names += 1;
        self.passes += 1;
    }

    fn begin(&mut self) {
        let first = self.below(self.things.len() as u32) as usize;
        for i in 0..self.things.len() {
            // Some things stay unwritten until somebody needs them.
            if i == first || self.below(3) > 0 {
                self.write(i);
            }
        }
    }

    /// Writes all of a thing.
    fn write(&mut self, i: usize) {
        let thing = self.things[i].clone();
        let name = &thing.name;
        match (thing.what, self.below(3)) {
            (What::Buffer { .. }, 0) => {
                let fields = format!("shader: \"fill.wgsl\", each: Item(\"{name}\"), bind: {{\"dst\": \"{name}\"}}");
                self.pass("Compute", &fields);
            }
            (What::Arguments, _) => {
                self.pass("Compute", "shader: \"arguments.wgsl\", each: Item(\"arguments\")");
            }
            (What::Texture { format, layers: 1, mips: 1, .. }, 0) => {
                let fields =
                    format!("shader: \"image{format}.wgsl\", each: Texel(\"{name}\"), bind: {{\"dst\": \"{name}\"}}");
                self.pass("Compute", &fields);
            }
            (What::Texture { layers: 1, auto, mips, .. }, 1) if auto || mips == 1 => {
                self.pass("Fullscreen", &format!("shader: \"paint.wgsl\", color: [\"{name}\"]"));
            }
            (What::Texture { auto: true, .. }, _) => {
                self.pass("Clear", &format!("of: \"{name}\", mip: 0, value: 0.25"));
            }
            (What::Texture { layers: 2, .. }, 2) => {
                for mip in 0..3 {
                    for layer in 0..2 {
                        let fields =
                            format!("shader: \"paint.wgsl\", color: [(to: \"{name}\", mip: {mip}, layer: {layer})]");
                        self.pass("Fullscreen", &fields);
                    }
                }
            }
            (What::Volume, 0) => {
                let fields = format!("shader: \"volume.wgsl\", each: Texel(\"{name}\"), bind: {{\"dst\": \"{name}\"}}");
                self.pass("Compute", &fields);
            }
            (What::Numbers, 0) => {
                self.pass("Fullscreen", &format!("shader: \"number.wgsl\", color: [\"{name}\"]"));
            }
            (What::Depth { .. } | What::Samples { .. } | What::Stencil { .. }, _) => {
                self.pass("Clear", &format!("of: \"{name}\", value: 0.5"));
            }
            _ => self.pass("Clear", &format!("of: \"{name}\"")),
        }
        self.things[i].written.fill(true);
    }

    /// A thing of a kind, written.
    fn written(&mut self, fits: impl Fn(&What) -> bool) -> usize {
        let all: Vec<usize> = (0..self.things.len()).filter(|i| fits(&self.things[*i].what)).collect();
        let chosen = all[self.below(all.len() as u32) as usize];
        if !self.things[chosen].is_written() {
            self.write(chosen);
        }
        chosen
    }

    /// Two different things of equal description, both written.
    fn pair(&mut self, fits: impl Fn(&What) -> bool) -> (String, String) {
        let a = self.written(|what| {
            fits(what)
                && matches!(
                    what,
                    What::Texture { auto: false, .. }
                        | What::Buffer { items: 100 }
                        | What::Samples { .. }
                        | What::Numbers
                        | What::Volume
                )
        });
        let what = self.things[a].what;
        let b = (0..self.things.len()).find(|i| *i != a && self.things[*i].what == what).unwrap();
        if !self.things[b].is_written() {
            self.write(b);
        }
        (self.things[a].name.clone(), self.things[b].name.clone())
    }

    fn name(&self, i: usize) -> String {
        self.things[i].name.clone()
    }

    fn step(&mut self) {
        match self.below(21) {
            0 => {
                let (src, dst) = self.pair(|what| matches!(what, What::Buffer { .. }));
                self.copy_items(&src, &dst);
            }
            1 => {
                let dst = self.written(|what| matches!(what, What::Buffer { .. }));
                let dst = self.name(dst);
                let fields = format!("shader: \"add.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\"}}");
                self.pass("Compute", &fields);
            }
            2 => {
                let (from, to) = self.pair(|_| true);
                self.pass("Copy", &format!("from: \"{from}\", to: \"{to}\""));
            }
            3 => {
                let (mip, layer) = (self.below(3), self.below(2));
                let (from, to) = self.pair(|what| matches!(what, What::Texture { layers: 2, .. }));
                let part = |name: &str| format!("View(of: \"{name}\", mip: {mip}, layer: {layer})");
                self.pass("Copy", &format!("from: {}, to: {}", part(&from), part(&to)));
            }
            4 => {
                let (mip, layer) = (self.below(3), self.below(2));
                let i = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
                let fields =
                    format!("of: \"{}\", mip: {mip}, layer: {layer}, value: (0.1, 0.2, 0.3, 1.0)", self.name(i));
                self.pass("Clear", &fields);
            }
            5 => self.filter(),
            6 => self.looped(),
            7 => self.branch(),
            8 => self.appended(),
            9 => self.sampled(),
            10 => self.triangles(),
            11 => self.resolved(),
            12 => {
                let i = self.below(self.things.len() as u32) as usize;
                self.write(i);
            }
            13 => self.layered(),
            14 => self.valued(),
            15 => self.indexed(),
            16 => self.two_targets(),
            17 => self.stencilled(),
            18 => self.sliced(),
            19 => self.masked(),
            _ => self.bundled(),
        }
    }

    /// Parameters, the picture's size, time and a loop's counter in a uniform; a constant.
    fn valued(&mut self) {
        let dst = self.written(|what| matches!(what, What::Buffer { .. }));
        let dst = self.name(dst);
        let before = self.passes;
        _ = writeln!(self.text, "      Repeat(times: 2, index: \"turn\", passes: [");
        let fields = format!(
            "shader: \"values.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\", \"turn\": \"turn\", \"factor\": \"2.5 * turn\"}}"
        );
        self.pass("Compute", &fields);
        self.text.push_str("      ]),\n");
        self.passes = before + 2;
    }

    /// Indices from a buffer; as many as there are, or some of them.
    fn indexed(&mut self) {
        let indices = self.written(|what| matches!(what, What::Buffer { .. }));
        let target = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let (indices, target) = (self.name(indices), self.name(target));
        let count = ["", ", vertices: 1"][self.below(2) as usize];
        let strip = ["TriangleList", "TriangleStrip", "LineStrip"][self.below(3) as usize];
        let fields = format!(
            "shader: \"triangle.wgsl\", indices: \"{indices}\"{count}, topology: {strip}, cull: Back, color: [\"{target}\"]"
        );
        self.pass("Draw", &fields);
    }

    fn two_targets(&mut self) {
        for name in ["parts_a", "parts_b"] {
            let i = self.things.iter().position(|thing| thing.name == name).unwrap();
            if !self.things[i].is_written() {
                self.write(i);
            }
        }
        let (mip, a, b) = (self.below(3), self.below(2), self.below(2));
        let fields = format!(
            "shader: \"two.wgsl\", color: [(to: \"parts_a\", mip: {mip}, layer: {a}), (to: \"parts_b\", mip: {mip}, layer: {b}, blend: Max)]"
        );
        self.pass("Fullscreen", &fields);
    }

    fn stencilled(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        self.written(|what| matches!(what, What::Stencil { .. }));
        let target = self.name(target);
        let depth = [
            "(to: \"stencil\", compare: Always, write: false, stencil: (compare: Always, pass: Replace, reference: 3))",
            "(to: \"stencil\", compare: GreaterEqual, write: true, clear: 0.0, bias: (2, 1.5), stencil: (compare: Equal, reference: 3))",
        ][self.below(2) as usize];
        let fields = format!(
            "shader: \"triangle.wgsl\", vertices: 3, color: [(to: \"{target}\", layer: 0)], depth: Depth{depth}"
        );
        self.pass("Draw", &fields);
    }

    /// A slice of a volume, and whole numbers.
    fn sliced(&mut self) {
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let volume = self.written(|what| *what == What::Volume);
        let numbers = self.written(|what| *what == What::Numbers);
        let (dst, volume, numbers) = (self.name(dst), self.name(volume), self.name(numbers));
        let fields = format!(
            "shader: \"slice.wgsl\", color: [\"{dst}\"], bind: {{\"volume\": \"{volume}\", \"numbers\": \"{numbers}\"}}"
        );
        self.pass("Fullscreen", &fields);
    }

    /// Some channels, or a region.
    fn masked(&mut self) {
        let dst = self.written(|what| matches!(what, What::Texture { size: 1, layers: 1, mips: 1, .. }));
        let dst = self.name(dst);
        let fields = match self.below(2) {
            0 => format!("shader: \"paint.wgsl\", color: [(to: \"{dst}\", write: \"rg\")]"),
            _ => format!("shader: \"paint.wgsl\", color: [\"{dst}\"], region: (1, 2, \"3 + times\", 4)"),
        };
        self.pass("Fullscreen", &fields);
    }

    /// Nothing to do: no threads, no vertices, no instances.
    fn bundled(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let list = self.written(|what| *what == What::List);
        let (target, list) = (self.name(target), self.name(list));
        self.pass("Compute", "shader: \"append.wgsl\", each: Threads(0)");
        let draw = format!("shader: \"triangle.wgsl\", vertices: 0, color: [(to: \"{target}\", clear: 0.5)]");
        self.pass("Draw", &draw);
        let groups = format!("shader: \"group.wgsl\", groups: Each(\"{list}\")");
        self.written(|what| matches!(what, What::Buffer { items: 1 }));
        self.pass("Compute", &groups);
    }

    fn copy_items(&mut self, src: &str, dst: &str) {
        let fields =
            format!("shader: \"copy.wgsl\", each: Item(\"{dst}\"), bind: {{\"src\": \"{src}\", \"dst\": \"{dst}\"}}");
        self.pass("Compute", &fields);
    }

    /// One texture is made from another, over what is there or not.
    fn filter(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        if src == dst {
            return;
        }
        let is_blendable = matches!(self.things[dst].what, What::Texture { format: 0 | 2, .. });
        let how = match self.below(4) {
            0 => ", clear: 0.0",
            1 if is_blendable => ", blend: Add",
            2 if is_blendable => ", blend: Alpha, clear: (0.0, 0.0, 0.0, 1.0)",
            _ => "",
        };
        let (src, dst) = (self.name(src), self.name(dst));
        let fields = format!("shader: \"filter.wgsl\", color: [(to: \"{dst}\"{how})], bind: {{\"src\": \"{src}\"}}");
        self.pass("Fullscreen", &fields);
    }

    fn looped(&mut self) {
        let (a, b) = self.pair(|what| matches!(what, What::Texture { layers: 1, .. } | What::Buffer { .. }));
        let times = ["0", "2", "3", "\"times\""][self.below(4) as usize];
        let count = match times {
            "\"times\"" => self.times as usize,
            number => number.parse().unwrap(),
        };
        let before = self.passes;
        _ = writeln!(
            self.text,
            "      Repeat(times: {times}, index: \"i{}\", swap: [(\"{a}\", \"{b}\")], passes: [",
            self.names
        );
        if a.starts_with("items") {
            self.copy_items(&a, &b);
        } else {
            self.pass("Fullscreen", &format!("shader: \"filter.wgsl\", color: [\"{b}\"], bind: {{\"src\": \"{a}\"}}"));
        }
        self.text.push_str("      ]),\n");
        self.passes = before + (self.passes - before) * count;
    }

    /// Both branches write what is written already, so that either is right.
    fn branch(&mut self) {
        let dst = self.written(|what| matches!(what, What::Buffer { .. }));
        let dst = self.name(dst);
        let test = ["fancy", "not fancy", "times > 1 and fancy"][self.below(3) as usize];
        let before = self.passes;
        _ = writeln!(self.text, "      If(test: \"{test}\", then: [");
        let fields = format!("shader: \"fill.wgsl\", each: Item(\"{dst}\"), bind: {{\"dst\": \"{dst}\"}}");
        self.pass("Compute", &fields);
        self.text.push_str("      ], else: [\n");
        self.pass("Clear", &format!("of: \"{dst}\", value: 3"));
        self.text.push_str("      ]),\n");
        self.passes = before + 1;
    }

    /// What was appended is used by threads, by points, or not at all.
    fn appended(&mut self) {
        let list = self.written(|what| *what == What::List);
        debug_assert_eq!(self.things[list].name, "list");
        if self.below(3) == 0 {
            self.pass("Clear", "of: \"list\"");
        }
        for _ in 0..self.below(3) {
            let n = self.below(200);
            self.pass("Compute", &format!("shader: \"append.wgsl\", each: Threads({n}, 1, 1)"));
        }
        match self.below(3) {
            0 => {
                let dst = self.written(|what| matches!(what, What::Buffer { items: 100 }));
                let dst = self.name(dst);
                self.pass(
                    "Compute",
                    &format!("shader: \"consume.wgsl\", each: Item(\"list\"), bind: {{\"dst\": \"{dst}\"}}"),
                );
            }
            1 => {
                let target = self.written(|what| matches!(what, What::Texture { format: 0, layers: 1, mips: 1, .. }));
                let target = self.name(target);
                let fields = format!(
                    "shader: \"points.wgsl\", vertices: 1, topology: PointList, instances: Each(\"list\"), color: [(to: \"{target}\")]"
                );
                self.pass("Draw", &fields);
            }
            _ => {}
        }
    }

    /// Mips that the planner makes.
    fn sampled(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { auto: true, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { format: 0, layers: 1, mips: 1, .. }));
        let (src, dst) = (self.name(src), self.name(dst));
        self.pass("Fullscreen", &format!("shader: \"sample.wgsl\", color: [\"{dst}\"], bind: {{\"src\": \"{src}\"}}"));
        if self.below(2) == 0 {
            let i = self.things.iter().position(|thing| thing.name == src).unwrap();
            self.write(i);
        }
    }

    fn triangles(&mut self) {
        let target = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        let (target, layer) = (self.name(target), self.below(2));
        let depth = match self.below(4) {
            0 => ", depth: Nearest(\"depth\")",
            1 => ", depth: Farthest(\"depth\")",
            2 => {
                self.written(|what| matches!(what, What::Depth { .. }));
                ", depth: Test(\"depth\")"
            }
            _ => "",
        };
        if depth.contains("est(\"depth\")") && !depth.contains(": Test") {
            let i = self.things.iter().position(|thing| thing.name == "depth").unwrap();
            self.things[i].written.fill(true);
        }
        let geometry = if self.below(2) == 0 {
            self.written(|what| *what == What::Arguments);
            format!("draw: Indirect(buffer: \"arguments\", item: {})", self.below(4))
        } else {
            format!("vertices: {}, instances: {}", 3 * self.below(3), self.below(3))
        };
        let clear = if self.below(2) == 0 { ", clear: 0.0" } else { "" };
        let fields =
            format!("shader: \"triangle.wgsl\", {geometry}, color: [(to: \"{target}\", layer: {layer}{clear})]{depth}");
        self.pass("Draw", &fields);
    }

    fn resolved(&mut self) {
        let samples = self.things.iter().position(|thing| thing.name == "samples_a").unwrap();
        if !self.things[samples].is_written() {
            self.write(samples);
        }
        let fields =
            "shader: \"triangle.wgsl\", vertices: 3, samples: 4, color: [(to: \"samples_a\", resolve: \"resolved\")]";
        self.pass("Draw", fields);
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let dst = self.name(dst);
        self.pass(
            "Fullscreen",
            &format!("shader: \"filter.wgsl\", color: [\"{dst}\"], bind: {{\"src\": \"resolved\"}}"),
        );
    }

    fn layered(&mut self) {
        let src = self.written(|what| matches!(what, What::Texture { layers: 2, .. }));
        let dst = self.written(|what| matches!(what, What::Texture { layers: 1, mips: 1, .. }));
        let (src, dst) = (self.name(src), self.name(dst));
        let of = if self.below(2) == 0 {
            format!("\"{src}\"")
        } else {
            format!("View(of: \"{src}\", mip: {})", self.below(3))
        };
        self.pass("Fullscreen", &format!("shader: \"layers.wgsl\", color: [\"{dst}\"], bind: {{\"src\": {of}}}"));
    }

    /// Something that happens over time, and something that looks at it.
    fn steps(&mut self) -> String {
        let swaps = 1 + self.below(3);
        let rate = ["60", "PerFrame"][self.below(2) as usize];
        let before = self.passes;
        _ = writeln!(
            self.text,
            "      Steps(rate: {rate}, passes: [ Repeat(times: {swaps}, swap: [(\"old\", \"next\")], passes: ["
        );
        self.pass(
            "Compute",
            "shader: \"copy.wgsl\", each: Item(\"next\"), bind: {\"src\": \"old\", \"dst\": \"next\"}",
        );
        self.text.push_str("      ]) ]),\n");
        self.passes = before + swaps as usize;
        let dst = self.written(|what| matches!(what, What::Buffer { items: 100 }));
        let dst = self.name(dst);
        self.copy_items("old", &dst);
        dst
    }

    fn finish(mut self, from_steps: &str) -> Generated {
        let mut written: Vec<String> = self.things.iter().filter(|t| t.is_written()).map(|t| t.name.clone()).collect();
        let first = self.below(written.len() as u32) as usize;
        written.swap(0, first);
        let second = written.iter().position(|name| name == from_steps).filter(|at| *at > 1);
        if let Some(at) = second {
            written.swap(1, at);
        }
        let roots = if self.below(2) == 0 { written.clone() } else { Vec::new() };
        let outputs: Vec<String> = written.iter().take(3).map(|name| format!("{name:?}")).collect();
        let resources: String = self.things.iter().map(declaration).collect();
        let graph = format!(
            "Graph(\n    params: {{ \"times\": Int(default: 1, min: 0, max: 5), \"fancy\": Bool(default: false) }},\n    \
             state: {{ \"old\": Buffer(items: 16), \"next\": Buffer(items: 16) }},\n    resources: {{\n{resources}        \
             \"resolved\": Texture(format: Rgba8Unorm, size: (16, 16)),\n    }},\n    passes: [\n{}    ],\n    outputs: [{}],\n)\n",
            self.text,
            outputs.join(", ")
        );
        Generated { graph, shaders: shaders(), passes: self.passes, times: self.times, fancy: self.fancy, roots }
    }
}

fn declaration(thing: &Thing) -> String {
    let about = match thing.what {
        What::Texture { format, size, layers, mips, auto } => {
            let mips = if auto { "Auto".to_owned() } else { mips.to_string() };
            format!("Texture(format: {}, size: {}, layers: {layers}, mips: {mips})", FORMATS[format], SIZES[size])
        }
        What::Depth { size } => format!("Texture(format: Depth32Float, size: {})", SIZES[size]),
        What::Samples { size } => format!("Texture(format: Rgba8Unorm, size: {}, samples: 4)", SIZES[size]),
        What::Buffer { items } => format!("Buffer(items: {items})"),
        What::Numbers => "Texture(format: R32Uint, size: (16, 16))".to_owned(),
        What::Volume => "Texture(format: Rgba16Float, size: (8, 6, 5), dimension: D3)".to_owned(),
        What::Stencil { size } => format!("Texture(format: Depth24PlusStencil8, size: {})", SIZES[size]),
        What::List => "Counted(capacity: 128)".to_owned(),
        What::Arguments => "Buffer(items: 4)".to_owned(),
    };
    format!("        \"{}\": {about},\n", thing.name)
}

fn shaders() -> Vec<(String, String)> {
    let thread = "@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>)";
    let mut all: Vec<(String, String)> = STORED
        .iter()
        .enumerate()
        .map(|(i, format)| {
            let text = format!(
                "var dst: texture_storage_2d<{format}, write>;\n@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
                 {{ textureStore(dst, i.xy, vec4<f32>(0.5)); }}"
            );
            (format!("image{i}.wgsl"), text)
        })
        .collect();
    let list = |count: &str| format!("struct List {{ count: {count}, items: array<u32> }}\n");
    let corner = "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> { \
                  return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0); }\n";
    let white = "@fragment fn main() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }";
    let at = "@fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32>";
    for (name, text) in [
        ("fill", format!("var<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] = i.x; }} }}")),
        ("add", format!("var<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] += 1u; }} }}")),
        (
            "copy",
            format!(
                "var<storage, read> src: array<u32>; var<storage, read_write> dst: array<u32>;\n\
                 {thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] = src[min(i.x, arrayLength(&src) - 1u)]; }} }}"
            ),
        ),
        ("paint", white.to_owned()),
        ("filter", format!("var src: texture_2d<f32>;\n{at} {{ return textureLoad(src, vec2<i32>(p.xy), 0); }}")),
        ("layers", format!("var src: texture_2d_array<f32>;\n{at} {{ return textureLoad(src, vec2<i32>(p.xy), 1, 0); }}")),
        (
            "sample",
            "var src: texture_2d<f32>; var linear_clamp: sampler;\n@fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> \
             { return textureSample(src, linear_clamp, uv * 4.0); }"
                .to_owned(),
        ),
        (
            "append",
            format!(
                "{}var<storage, read_write> list: List;\n{thread} {{ let at = atomicAdd(&list.count, 1u); \
                 if at < arrayLength(&list.items) {{ list.items[at] = i.x; }} }}",
                list("atomic<u32>")
            ),
        ),
        (
            "consume",
            format!(
                "{}var<storage, read> list: List; var<storage, read_write> dst: array<u32>;\n{thread} {{ \
                 if i.x < list.count {{ dst[i.x % arrayLength(&dst)] = list.items[i.x]; }} }}",
                list("u32")
            ),
        ),
        (
            "points",
            format!(
                "{}var<storage, read> list: List;\n@vertex fn corner(@builtin(instance_index) i: u32) -> @builtin(position) vec4<f32> \
                 {{ return vec4<f32>(f32(list.items[i]) / 100.0 - 1.0, 0.0, 0.5, 1.0); }}\n{white}",
                list("u32")
            ),
        ),
        (
            "arguments",
            "struct Arguments { vertices: u32, instances: u32, first_vertex: u32, first_instance: u32 }\n\
             var<storage, read_write> arguments: array<Arguments>;\n@compute @workgroup_size(1) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
             { arguments[i.x] = Arguments(3u * i.x, 1u, 0u, 0u); }"
                .to_owned(),
        ),
        ("triangle", format!("{corner}{white}")),
        (
            "volume",
            "var dst: texture_storage_3d<rgba16float, write>;\n@compute @workgroup_size(4, 4, 4) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
             { textureStore(dst, i, vec4<f32>(0.5)); }"
                .to_owned(),
        ),
        ("number", "@fragment fn main() -> @location(0) u32 { return 7u; }".to_owned()),
        (
            "slice",
            format!(
                "var volume: texture_3d<f32>; var numbers: texture_2d<u32>;\n{at} {{ return textureLoad(volume, vec3<i32>(p.xyx), 0) \
                 * f32(textureLoad(numbers, vec2<i32>(p.xy), 0).x); }}"
            ),
        ),
        (
            "two",
            "struct Out { @location(0) a: vec4<f32>, @location(1) b: vec4<f32> }\n@fragment fn main() -> Out { \
             return Out(vec4<f32>(1.0), vec4<f32>(2.0)); }"
                .to_owned(),
        ),
        (
            "values",
            format!(
                "struct Values {{ times: i32, fancy: u32, viewport: vec2<f32>, time: f32, turn: u32 }} var<uniform> values: Values;\n\
                 override factor: f32 = 1.0;\nvar<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ \
                 dst[i.x] += u32(values.times) + values.fancy + u32(values.viewport.x * factor) + u32(values.time) + values.turn; }} }}"
            ),
        ),
        (
            "group",
            format!(
                "{}var<storage, read> list: List; var<storage, read_write> few: array<u32>;\n\
                 @compute @workgroup_size(1) fn main(@builtin(workgroup_id) i: vec3<u32>) {{ few[0] += list.items[i.x]; }}",
                list("u32")
            ),
        ),
    ] {
        all.push((format!("{name}.wgsl"), text));
    }
    all
}
