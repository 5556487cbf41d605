//! Scene files from RON. All mistakes of a file are reported at once; what could be read stands.

mod bodies;
mod cameras;
mod environment;
mod sources;

use std::path::Path;

use glam::DVec3;

use super::camera::Light;
use super::model::{Item, Scene};
use super::pointer::{PointerPath, Pointing};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources, Span};
use crate::graph::rows::{self, Row};
use crate::graph::value::Value;
use crate::syntax::{self, Decoder, Fields, Node, Sp, Tagged};

const FIELDS: &[&str] = &[
    "about",
    "graph",
    "camera",
    "lights",
    "pointers",
    "environment",
    "particles",
    "meshes",
    "tables",
    "textures",
    "params",
    "present",
    "size",
];

/// Vertical, in degrees, where a scene's camera does not say.
pub const DEFAULT_FOV_DEGREES: f64 = 40.0;
const LARGEST_SIDE: i64 = 32_768;
/// How far above what it points at a pointer is, where nobody says.
const POINTER_HEIGHT_M: f64 = 10.0;

/// Reads the bytes of a scene file and registers them under `path`. `None` if nothing of it could
/// be made out; with errors the scene holds what was sound.
pub fn read(path: &Path, bytes: &[u8], sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Scene> {
    let file = match syntax::add_bytes(sources, path, bytes) {
        Ok(file) => file,
        Err(unreadable) => {
            diagnostics.push(unreadable);
            return None;
        }
    };
    let node = syntax::parse(sources, file, diagnostics)?;
    let mut reader = Reader { decoder: Decoder { diagnostics } };
    let tagged = reader.root(&node)?;
    let fields = reader.decoder.body_fields(tagged, "`Scene`", FIELDS)?;
    let about = fields.get("about").and_then(|n| reader.decoder.text(n, "`about`")).map(|s| s.value);
    let graph = fields.get("graph").and_then(|n| reader.file_name(n, "`graph`"));
    let (camera, camera_file) = cameras::Said::apart(fields.get("camera").and_then(|n| reader.camera(n)));
    let scene = Scene {
        path: path.to_owned(),
        file,
        span: tagged.head,
        about,
        graph,
        camera,
        camera_file,
        lights: reader.items(&fields, "lights", Reader::light),
        pointers: reader.items(&fields, "pointers", Reader::pointer),
        particles: reader.items(&fields, "particles", Reader::particles),
        meshes: reader.items(&fields, "meshes", Reader::bodies),
        textures: reader.textures(&fields),
        cube: reader.cube(&fields),
        tables: reader.items(&fields, "tables", Reader::table),
        params: reader.items(&fields, "params", Reader::value),
        present: reader.items(&fields, "present", Reader::value),
        size: fields.get("size").and_then(|n| reader.size(n)),
    };
    reader.same_names(&scene);
    Some(scene)
}

struct Reader<'d> {
    decoder: Decoder<'d>,
}

impl Reader<'_> {
    fn root<'n>(&mut self, node: &'n Node) -> Option<&'n Tagged> {
        let found = node.as_tagged().filter(|t| t.name.as_ref().is_none_or(|name| name.value == "Scene"));
        if found.is_none() {
            self.decoder.wrong(node, "a scene file", "`Scene(...)`");
        }
        found
    }

    /// The entries of a field that is a map of names; each is read from its own value, so that one
    /// bad entry hides no other.
    fn items<T>(
        &mut self,
        fields: &Fields<'_>,
        field: &str,
        read: fn(&mut Self, &Node, &str) -> Option<T>,
    ) -> Vec<Item<T>> {
        let what = format!("`{field}`");
        let entries = fields.get(field).and_then(|node| self.decoder.map(node, &what)).unwrap_or_default();
        let mut items = Vec::with_capacity(entries.len());
        for (name, node) in entries {
            let what = format!("`{}` of {what}", name.value);
            if let Some(value) = read(self, node, &what) {
                items.push(Item { name, value, span: node.span });
            }
        }
        items
    }

    /// Pictures; the environment is one of them, unless it is a cube.
    fn textures(&mut self, fields: &Fields<'_>) -> Vec<Item<Sp<String>>> {
        let mut textures = self.items(fields, "textures", Reader::file_name);
        if let Some((name, node)) = fields.entry("environment")
            && node.as_tagged().is_none()
            && let Some(file) = self.file_name(node, "`environment`")
        {
            textures.push(Item { name: name.clone(), value: file, span: node.span });
        }
        textures
    }

    fn light(&mut self, node: &Node, what: &str) -> Option<Light> {
        if node.as_tagged().and_then(|t| t.name.as_ref()).is_some_and(|word| word.value == "Sun") {
            return self.sun(node);
        }
        let fields = self.decoder.fields(node, "`Light`", &["direction", "color", "intensity"])?;
        self.words(node, &["Light", "Sun"], what);
        let direction = fields.require(&mut self.decoder, "direction");
        let direction = direction.and_then(|n| self.decoder.floats::<3>(n, "`direction`"));
        let color = match fields.get("color") {
            Some(n) => self.decoder.floats::<3>(n, "`color`"),
            None => Some([1.0; 3]),
        };
        let intensity = match fields.get("intensity") {
            Some(n) => self.decoder.float(n, "`intensity`"),
            None => Some(1.0),
        };
        let light =
            Light { direction: DVec3::from_array(direction?), color: DVec3::from_array(color?), intensity: intensity? };
        self.sound(light.fault(), fields.head)?;
        Some(light)
    }

    /// Keys `(time: 0.5, at: (x, y, z))`, with `from` and `pressed`: the ray goes through `at`.
    fn pointer(&mut self, node: &Node, what: &str) -> Option<PointerPath> {
        let nodes = self.decoder.list(node, what)?;
        let keys: Vec<_> = nodes.iter().map(|key| self.pointing(key)).collect();
        let keys = keys.into_iter().collect::<Option<Vec<Pointing>>>()?;
        if let Some(early) = (1..keys.len()).find(|i| keys[*i].time_s <= keys[i - 1].time_s) {
            self.sound(Some("the times of a pointer's keys must rise"), nodes[early].span)?;
        }
        Some(PointerPath::authored(keys))
    }

    fn pointing(&mut self, node: &Node) -> Option<Pointing> {
        let fields = self.decoder.fields(node, "a key of a pointer", &["time", "at", "from", "pressed"])?;
        let time_s = fields.require(&mut self.decoder, "time").and_then(|n| self.decoder.float(n, "`time`"));
        let at = fields.require(&mut self.decoder, "at").and_then(|n| self.decoder.floats::<3>(n, "`at`"));
        let at = at.map(DVec3::from_array);
        let origin = match fields.get("from") {
            Some(n) => self.decoder.floats::<3>(n, "`from`").map(DVec3::from_array),
            // Straight down.
            None => at.map(|at| at + POINTER_HEIGHT_M * DVec3::Y),
        };
        let is_pressed = match fields.get("pressed") {
            Some(n) => self.decoder.bool(n, "`pressed`")?,
            None => true,
        };
        let (origin, at) = (origin?, at?);
        let key = Pointing { time_s: time_s?, origin, direction: at - origin, is_pressed };
        self.sound(key.fault(), node.span)?;
        Some(key)
    }

    /// Rows, each `(name: value, ...)` or `{"name": value, ...}`.
    fn table(&mut self, node: &Node, what: &str) -> Option<Vec<Row>> {
        rows::rows(&mut self.decoder, node, what)
    }

    fn value(&mut self, node: &Node, what: &str) -> Option<Value> {
        rows::value(&mut self.decoder, node, what)
    }

    fn file_name(&mut self, node: &Node, what: &str) -> Option<Sp<String>> {
        let text = self.decoder.text(node, what)?;
        if text.value.trim().is_empty() {
            let message = format!("{what}: expected the name of a file, found an empty string");
            self.decoder.push(Diagnostic::error(Code::WRONG_VALUE, message).at(node.span, "this names nothing"));
            return None;
        }
        Some(text)
    }

    fn size(&mut self, node: &Node) -> Option<[u32; 2]> {
        let items = self.decoder.items(node, "`size`", "(width, height) in pixels", 2..=2)?;
        let [width, height] = items else { return None };
        let width = self.decoder.int_within(width, "`size`", 1, LARGEST_SIDE);
        let height = self.decoder.int_within(height, "`size`", 1, LARGEST_SIDE);
        Some([u32::try_from(width?).ok()?, u32::try_from(height?).ok()?])
    }

    /// The word before a bracket may be left out, but must not be another.
    fn word(&mut self, node: &Node, expected: &str, what: &str) {
        self.words(node, &[expected], what);
    }

    fn words(&mut self, node: &Node, expected: &[&str], what: &str) {
        let word = node.as_tagged().and_then(|t| t.name.as_ref());
        if let Some(word) = word.filter(|word| !expected.contains(&word.value.as_str())) {
            self.decoder.unknown_word(word, what, expected);
        }
    }

    fn sound(&mut self, fault: Option<&'static str>, span: Span) -> Option<()> {
        let Some(fault) = fault else { return Some(()) };
        self.decoder.push(Diagnostic::error(Code::OUT_OF_RANGE, fault).at(span, "here"));
        None
    }

    /// Inputs take items by name, whatever their kind: a name that two items bear is a mistake.
    fn same_names(&mut self, scene: &Scene) {
        let items = scene.items();
        for (at, (kind, name)) in items.iter().enumerate() {
            if let Some((other, first)) = items[..at].iter().find(|(_, n)| n.value == name.value) {
                let message = match kind {
                    kind if kind == other => format!("`{}` is given twice", name.value),
                    _ => format!("`{}` names both {} and {}", name.value, article(other), article(kind)),
                };
                let twice = Diagnostic::error(Code::DUPLICATE, message)
                    .at(name.span, "the second time")
                    .see(first.span, "the first time");
                self.decoder.push(twice);
            }
        }
    }
}

fn article(kind: &str) -> String {
    if matches!(kind, "particles" | "meshes") { kind.to_owned() } else { format!("a {kind}") }
}
