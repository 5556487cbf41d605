//! Arguments as people type them. What can be told wrong without reading a file is told here.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::plan::model::Policy;
use crate::scene::placement::Up;

/// Data-driven render graphs: checked, planned, run and reloaded.
#[derive(Debug, Parser)]
#[command(name = "meniscus", version, about, propagate_version = true, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open a window: camera, parameters, passes with their times, errors, reload at each save
    View(ViewArgs),
    /// Render one picture, or with --frames a numbered sequence
    Render(RenderArgs),
    /// Render again at each change of what was read, and print each reload's time
    Watch(WatchArgs),
    /// Check graphs, scenes or shaders, without a GPU
    Check(CheckArgs),
    /// Print the compiled plan of a graph
    Plan(PlanArgs),
    /// Measure each pass on the GPU, encoding on the CPU, and memory
    Bench(BenchArgs),
    /// Draw declared cases and hold what comes out against what they expect
    Test(TestArgs),
    /// Adapters, features and limits, and what each shipped graph needs; with files, what they hold
    Info(InfoArgs),
    /// A diagnostic, at length
    Explain(ExplainArgs),
    /// Make a new graph, shader and scene that run
    New(NewArgs),
}

/// What `render`, `watch` and `bench` share.
#[derive(Args, Clone, Debug)]
pub struct SceneArgs {
    /// A scene (.ron), or a particle file, a numbered sequence of them (dd_####.bgeo) or a mesh file (.glb, .gltf, .obj,
    /// .ply and .vtk with faces), which then gets a default camera, light and graph
    #[arg(value_name = "SCENE|FILE")]
    pub scene: PathBuf,
    /// The graph to use in place of the scene's
    #[arg(long, value_name = "GRAPH")]
    pub graph: Option<String>,
    /// The particle file to use in place of the scene's; NAME=FILE where the graph takes several
    #[arg(long, value_name = "FILE")]
    pub particles: Option<String>,
    /// Radius of a particle in metres, in place of the file's or the estimated one
    #[arg(long, value_name = "METRES", value_parser = radius, allow_negative_numbers = true)]
    pub radius: Option<f64>,
    /// Which axis points up in the particle or mesh file that is named here
    #[arg(long, value_enum, value_name = "AXIS")]
    pub up: Option<UpArg>,
    /// Metres to a unit of that file: 0.001 for millimetres
    #[arg(long, value_name = "METRES", value_parser = scale, allow_negative_numbers = true)]
    pub scale: Option<f64>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// A parameter's value, by its instance path; may be given many times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    /// Where the camera stands, in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub eye: Option<[f64; 3]>,
    /// Where the camera looks, in metres
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub target: Option<[f64; 3]>,
    /// The camera's vertical field of view, in degrees
    #[arg(long, value_name = "DEGREES", value_parser = fov, allow_negative_numbers = true)]
    pub fov: Option<f64>,
    /// A place in metres that the pointer holds pressed, seen from the camera
    #[arg(long, value_name = "X,Y,Z", value_parser = triple, allow_hyphen_values = true)]
    pub pointer: Option<[f64; 3]>,
    #[command(flatten)]
    pub memory: MemoryArgs,
    /// The graphics interface to use
    #[arg(long, value_name = "NAME", value_parser = ["vulkan", "metal", "dx12", "gl"])]
    pub backend: Option<String>,
}

/// How resources share memory.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct MemoryArgs {
    /// How resources share memory: `keep` what skipping needs, `share` if every pass runs in each frame,
    /// `smallest` if the frame waits besides to give memory back; `auto` goes by what changes, and by the budget
    #[arg(long, value_enum, value_name = "POLICY", default_value_t = PolicyArg::Auto)]
    pub policy: PolicyArg,
    /// The most that textures and buffers may take: bytes, or with KiB, MiB or GiB behind
    #[arg(long, value_name = "BYTES", value_parser = byte_count)]
    pub memory_budget: Option<u64>,
}

impl MemoryArgs {
    pub fn policy(&self) -> Option<Policy> {
        match self.policy {
            PolicyArg::Auto => None,
            PolicyArg::Keep => Some(Policy::Keep),
            PolicyArg::Share => Some(Policy::Share),
            PolicyArg::Smallest => Some(Policy::Smallest),
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PolicyArg {
    #[default]
    Auto,
    Keep,
    Share,
    Smallest,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UpArg {
    Y,
    Z,
}

impl UpArg {
    pub fn axis(self) -> Up {
        match self {
            Self::Y => Up::Y,
            Self::Z => Up::Z,
        }
    }
}

#[derive(Args, Clone, Debug)]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture to write: .png as a screen shows it, .exr linear as the graph made it
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub when: WhenArgs,
    /// Numbered pictures of frames A to B; FILE may hold {} or #### where the number goes
    #[arg(long, value_name = "A..B", value_parser = frames, conflicts_with_all = ["frame", "time"])]
    pub frames: Option<FrameRange>,
    /// Write any texture (.png, .exr) or buffer (.ply, .obj, .csv, .json, .bin) by its instance path
    #[arg(long, value_name = "PATH=FILE", value_parser = assignment)]
    pub dump: Vec<(String, String)>,
    /// Keep the graph's coverage as alpha in place of a backdrop
    #[arg(long)]
    pub transparent: bool,
    /// Print each pass's time on the GPU
    #[arg(long)]
    pub timings: bool,
}

#[derive(Args, Clone, Debug)]
pub struct TestArgs {
    /// Files of cases; without any, all below `tests/` that begin with `Tests(`
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Only cases with this in their names; may be given many times
    #[arg(long, value_name = "NAME")]
    pub case: Vec<String>,
    /// Write the pictures that come out in place of the expected ones
    #[arg(long)]
    pub bless: bool,
    /// The graphics interface to use
    #[arg(long, value_name = "NAME", value_parser = ["vulkan", "metal", "dx12", "gl"])]
    pub backend: Option<String>,
}

/// The moment that a picture shows.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct WhenArgs {
    /// The frame's number, at 60 frames a second; of a sequence of files, the file's number
    #[arg(long, value_name = "N", conflicts_with = "time")]
    pub frame: Option<u64>,
    /// Seconds since the start
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    pub time: Option<f64>,
}

#[derive(Args, Clone, Debug)]
pub struct WatchArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The picture to write anew after each good change (.png or .exr)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub when: WhenArgs,
    /// Keep the graph's coverage as alpha in place of a backdrop
    #[arg(long)]
    pub transparent: bool,
}

#[derive(Args, Clone, Debug)]
#[command(mut_arg("scene", |scene| scene.required(false).default_value(super::view::HERE).hide_default_value(true)))]
pub struct ViewArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Say at the end how long the interface's frames took
    #[arg(long)]
    pub timings: bool,
}

#[derive(Args, Clone, Debug)]
pub struct CheckArgs {
    /// Graphs, scenes (.ron) and shaders (.wgsl)
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub format: CheckFormat,
    /// Warnings are findings too
    #[arg(long)]
    pub deny_warnings: bool,
    /// A device that all of it must run on: `core` is what every browser has, `native` what desktops
    /// have; a FILE is what `info --format json` wrote elsewhere
    #[arg(long, value_name = "core|native|FILE")]
    pub device: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// For people, on the error stream
    Text,
    /// For editors: one array on the output stream
    Json,
}

#[derive(Args, Clone, Debug)]
pub struct PlanArgs {
    /// A graph, or a scene with its inputs
    #[arg(value_name = "GRAPH")]
    pub graph: PathBuf,
    /// Why a pass runs, and with what it shares a pass of the device, or where a resource's memory lies and why
    /// there; of all of them without a name
    #[arg(long, value_name = "PASS|RESOURCE", num_args = 0..=1, default_missing_value = "")]
    pub explain: Option<String>,
    #[arg(long, value_enum, default_value_t = PlanFormat::Text)]
    pub format: PlanFormat,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// A parameter's value, by its instance path; may be given many times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    pub set: Vec<(String, String)>,
    #[command(flatten)]
    pub memory: MemoryArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PlanFormat {
    Text,
    Json,
    /// For Graphviz
    Dot,
    Svg,
}

#[derive(Args, Clone, Debug)]
pub struct BenchArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Frames to measure, after two that warm up
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    #[arg(long, value_enum, default_value_t = BenchFormat::Table)]
    pub format: BenchFormat,
    /// Compare with an earlier measurement, as `--format json` wrote it
    #[arg(long, value_name = "FILE")]
    pub compare: Option<PathBuf>,
    /// Compare with another scene, frame by frame in turn: tells smaller differences
    #[arg(long, value_name = "SCENE", conflicts_with = "compare")]
    pub against: Option<PathBuf>,
    /// Exit with 1 if the comparison says slower
    #[arg(long)]
    pub deny_slower: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BenchFormat {
    Table,
    Json,
    Csv,
}

#[derive(Args, Clone, Debug)]
pub struct InfoArgs {
    /// Particle files, sequences of them (dd_####.bgeo), mesh files, pictures, scenes and graphs: what they hold
    #[arg(value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub format: CheckFormat,
}

#[derive(Args, Clone, Debug)]
pub struct ExplainArgs {
    /// The id that stands in brackets behind `error` or `warning`; without one, all are listed
    #[arg(value_name = "ID")]
    pub id: Option<String>,
}

#[derive(Args, Clone, Debug)]
pub struct NewArgs {
    /// A short name: small letters, digits and underscores
    #[arg(value_name = "NAME", value_parser = new_name)]
    pub name: String,
    /// One whose passes happen over time: steps with state, stirred by the pointer
    #[arg(long)]
    pub state: bool,
}

/// Frames A to B, both included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameRange(pub RangeInclusive<u64>);

/// Pictures beyond this are refused before anything is read; devices may allow less.
pub const LARGEST_SIDE: u32 = 32_768;

pub fn size(text: &str) -> Result<[u32; 2], String> {
    let expected = "expected WIDTHxHEIGHT in pixels, such as 1024x768";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |text: &str| text.trim().parse::<u64>().map_err(|_| expected.to_owned());
    let (width, height) = (side(width)?, side(height)?);
    if width == 0 || height == 0 {
        return Err("a picture has at least 1 pixel each way".into());
    }
    if width > LARGEST_SIDE.into() || height > LARGEST_SIDE.into() {
        return Err(format!("a picture has at most {LARGEST_SIDE} pixels each way"));
    }
    Ok([width as u32, height as u32])
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected two words with `=` between them".into()),
    }
}

fn triple(text: &str) -> Result<[f64; 3], String> {
    let expected = || "expected three numbers in metres, such as 1.5,0.8,-2".to_owned();
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse::<f64>()).collect();
    let triple: [f64; 3] = numbers.map_err(|_| expected())?.try_into().map_err(|_| expected())?;
    if triple.iter().all(|x| x.is_finite()) { Ok(triple) } else { Err("the numbers must be finite".into()) }
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "expected a number".to_owned())
}

fn radius(text: &str) -> Result<f64, String> {
    let radius = number(text)?;
    if radius.is_finite() && radius > 0.0 { Ok(radius) } else { Err("a radius is finite and above 0".into()) }
}

fn scale(text: &str) -> Result<f64, String> {
    let scale = number(text)?;
    if scale.is_finite() && scale > 0.0 { Ok(scale) } else { Err("a scale is finite and above 0".into()) }
}

fn fov(text: &str) -> Result<f64, String> {
    let fov = number(text)?;
    if fov > 0.0 && fov < 180.0 { Ok(fov) } else { Err("a field of view is above 0 and below 180 degrees".into()) }
}

fn seconds(text: &str) -> Result<f64, String> {
    let time = number(text)?;
    if time.is_finite() && time >= 0.0 { Ok(time) } else { Err("a time is finite and not below 0".into()) }
}

/// `1048576`, `64 MiB`, `1.5GiB`.
fn byte_count(text: &str) -> Result<u64, String> {
    let expected = || "expected a number of bytes, such as 1048576, 64MiB or 1.5GiB".to_owned();
    let text = text.trim();
    let end = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let scale = match unit.to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err(expected()),
    };
    let bytes = number.trim().parse::<f64>().map_err(|_| expected())? * scale;
    if bytes.is_finite() && bytes >= 1.0 { Ok(bytes as u64) } else { Err(expected()) }
}

fn frames(text: &str) -> Result<FrameRange, String> {
    let expected = || "expected two frame numbers, such as 0..24; both are rendered".to_owned();
    let (from, to) = text.split_once("..").ok_or_else(expected)?;
    let frame = |text: &str| text.trim().trim_start_matches('=').parse::<u64>().map_err(|_| expected());
    let (from, to) = (frame(from)?, frame(to)?);
    if from > to { Err("the first frame comes after the last".into()) } else { Ok(FrameRange(from..=to)) }
}

fn new_name(text: &str) -> Result<String, String> {
    let starts = text.starts_with(|c: char| c.is_ascii_lowercase());
    let fits = text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if starts && fits && text.len() <= 64 {
        Ok(text.to_owned())
    } else {
        Err("expected small letters, digits and underscores, a letter first, at most 64".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        use clap::CommandFactory as _;
        Cli::command().debug_assert();
    }

    #[test]
    fn sizes_are_told_apart() {
        assert_eq!(size("1024x768"), Ok([1024, 768]));
        for wrong in ["", "1024", "0x0", "12x0", "40000x2", "99999999999999999999x2", "-1x2", "axb", "1x2x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn ranges_triples_and_numbers_are_told_apart() {
        assert_eq!(frames("3..7"), Ok(FrameRange(3..=7)));
        assert!(["7..3", "a..b", "3", "..", "-1..2"].iter().all(|text| frames(text).is_err()));
        assert_eq!(triple("1,-2, 3.5"), Ok([1.0, -2.0, 3.5]));
        assert!(["1,2", "1,2,x", "1,2,3,4", "nan,0,0"].iter().all(|text| triple(text).is_err()));
        assert!(["0", "-1", "nan", "inf", "x"].iter().all(|text| radius(text).is_err()));
        assert!(["0", "180", "nan"].iter().all(|text| fov(text).is_err()));
        assert_eq!(assignment("a.b=1,2"), Ok(("a.b".into(), "1,2".into())));
        assert!(["a", "=1", "a="].iter().all(|text| assignment(text).is_err()));
    }
}
