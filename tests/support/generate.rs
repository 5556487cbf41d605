//! Random graphs that are right by construction: what each pass reads was written before it.
//!
//! A graph grows from a list of numbers, so that proptest can shrink it and any generator of
//! numbers can make one.

#![allow(dead_code, reason = "each test program uses a part of it")]

#[path = "generate/passes.rs"]
mod passes;
#[path = "generate/shaders.rs"]
mod shaders;

use std::fmt::Write as _;

use meniscus::diagnostic::{Diagnostics, Sources};
use meniscus::files::MemoryFiles;
use meniscus::format::TextureFormat;
use meniscus::graph::value::Value;
use meniscus::plan::instantiate;
use meniscus::plan::model::{InputInfo, Plan, Request, Texture};
use meniscus::program;
use wgpu_types::{Features, Limits, TextureUsages};

const FORMATS: [&str; 3] = ["Rgba16Float", "R32Float", "Rgba8Unorm"];
const SIZES: [&str; 3] = ["\"viewport\"", "(16, 16)", "(7, 5)"];

/// Words that somebody may write in place of each other: how much is drawn and dispatched, what is cleared to, bound,
/// and computed. No word is part of another.
const EDITS: [(&str, &str); 13] = [
    ("vertices: 1, topology: PointList", "vertices: 2, topology: PointList"),
    ("vertices: 3, ", "vertices: 6, "),
    ("instances: 2", "instances: 5"),
    ("value: 3)", "value: 4)"),
    ("value: 0.25", "value: 0.75"),
    ("value: (0.1, ", "value: (0.9, "),
    ("clear: 0.0)", "clear: 0.125)"),
    ("2.5 * turn", "3.5 * turn"),
    ("region: (1, ", "region: (2, "),
    ("capacity: 128", "capacity: 120"),
    ("dst[i.x] += 1u", "dst[i.x] += 2u"),
    ("dst[i.x] = i.x;", "dst[i.x] = 9u * i.x;"),
    ("vec4<f32>(0.5)", "vec4<f32>(0.25)"),
];

/// A graph with its shaders.
#[derive(Clone, Debug)]
pub struct Generated {
    pub graph: String,
    shaders: Vec<(String, String)>,
    /// Passes that the graph contributes at the values of `times` and `fancy`.
    pub passes: usize,
    pub times: i64,
    pub fancy: bool,
    /// What somebody asks for besides the first output.
    pub roots: Vec<String>,
    /// Resources that hold something at the end.
    pub written: Vec<String>,
}

/// Pixels each way of the input `picture`.
pub const PICTURE: u32 = 8;
/// Items of the input `given`.
pub const GIVEN: u32 = 40;

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
            inputs: inputs(),
            capacities: Default::default(),
            roots: self.roots.clone(),
            stats: false,
            memory: Default::default(),
            features,
            limits,
        }
    }

    /// Somebody writes another word into one of the files; tells which. What was written once may be taken back.
    pub fn edit(&mut self, mut number: impl FnMut(u32) -> u32) -> Option<String> {
        let shaders = self.shaders.iter_mut().map(|(_, text)| text);
        let mut files: Vec<&mut String> = std::iter::once(&mut self.graph).chain(shaders).collect();
        let words = EDITS.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]);
        let places: Vec<(usize, usize, (&str, &str))> = words
            .flat_map(|(from, to)| {
                let of = |(file, text): (usize, &&mut String)| {
                    text.match_indices(from).map(|(at, _)| (file, at, (from, to))).collect::<Vec<_>>()
                };
                files.iter().enumerate().flat_map(of).collect::<Vec<_>>()
            })
            .collect();
        let (file, at, (from, to)) = *places.get(number(places.len().max(1) as u32) as usize)?;
        files[file].replace_range(at..at + from.len(), to);
        Some(format!("`{from}` -> `{to}` at {at} of file {file}"))
    }

    pub fn plan(&self, request: &Request) -> Result<Plan, (Diagnostics, Sources)> {
        let mut sources = Sources::new();
        let loaded = program::load(&self.files(), &mut sources, "graphs/test.ron", None);
        let Some(program) = loaded.program else { return Err((loaded.diagnostics, sources)) };
        instantiate(&program, request).map_err(|found| (found, sources))
    }
}

fn inputs() -> std::collections::BTreeMap<String, InputInfo> {
    let picture = Texture {
        format: TextureFormat::Rgba8Unorm,
        width: PICTURE,
        height: PICTURE,
        layers: 1,
        is_3d: false,
        mips: 1,
        samples: 1,
        usages: TextureUsages::empty(),
    };
    let given = InputInfo::Buffer { items: u64::from(GIVEN), stride: 4 };
    [("camera", InputInfo::Camera), ("picture", InputInfo::Texture(picture)), ("given", given)]
        .map(|(name, info)| (name.to_owned(), info))
        .into()
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
            "Graph(\n    inputs: {{ \"camera\": Camera, \"picture\": Texture, \"given\": Buffer }},\n    params: {{ \"times\": Int(default: 1, min: 0, max: 5), \"fancy\": Bool(default: false) }},\n    \
             state: {{ \"old\": Buffer(items: 16), \"next\": Buffer(items: 16) }},\n    resources: {{\n{resources}        \
             \"resolved\": Texture(format: Rgba8Unorm, size: (16, 16)),\n    }},\n    passes: [\n{}    ],\n    outputs: [{}],\n)\n",
            self.text,
            outputs.join(", ")
        );
        let (passes, times, fancy) = (self.passes, self.times, self.fancy);
        Generated { graph, shaders: shaders::all(), passes, times, fancy, roots, written }
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
