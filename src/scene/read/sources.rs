//! Particle files and sequences of them.

use std::ops::RangeInclusive;
use std::path::Path;

use glam::DMat3;

use super::Reader;
use crate::diagnostic::{Code, Diagnostic};
use crate::scene::model::ParticleSource;
use crate::scene::particles::Taken;
use crate::scene::placement::{Placement, Up};
use crate::scene::sequence::{DEFAULT_RATE, Pattern, Sequence};
use crate::syntax::{Fields, Node, Sp};

const FIELDS: &[&str] =
    &["file", "radius", "up", "scale", "position", "rotation", "names", "frames", "rate", "min", "max"];

impl Reader<'_> {
    /// `"file"` or `(file: "file", radius: 0.025, ...)`; with `#` in the file's name also `frames` and `rate`.
    pub(super) fn particles(&mut self, node: &Node, what: &str) -> Option<ParticleSource> {
        let is_pattern = |file: &Sp<String>| Pattern::of(Path::new(&file.value)).is_some();
        if node.as_str().is_some() {
            let file = self.file_name(node, what)?;
            let sequence = is_pattern(&file).then(Sequence::default);
            return Some(ParticleSource { file, radius_m: None, taken: Taken::default(), sequence, bounds: None });
        }
        let fields = self.decoder.fields(node, "`Particles`", FIELDS)?;
        self.word(node, "Particles", what);
        let file = fields.require(&mut self.decoder, "file").and_then(|n| self.file_name(n, "`file`"));
        let radius_m = match fields.get("radius") {
            Some(n) => Some(Sp { value: self.decoder.float(n, "`radius`")?, span: n.span }),
            None => None,
        };
        if let Some(radius) = radius_m.as_ref().filter(|r| r.value <= 0.0) {
            self.sound(Some("a radius must be above 0"), radius.span)?;
        }
        let frames = match fields.get("frames") {
            Some(n) => Some(self.frames(n)?),
            None => None,
        };
        let rate = match fields.get("rate") {
            Some(n) => self.decoder.float(n, "`rate`")?,
            None => DEFAULT_RATE,
        };
        if let Some(n) = fields.get("rate").filter(|_| rate <= 0.0) {
            self.sound(Some("a rate must be above 0"), n.span)?;
        }
        let file = file?;
        if let (false, Some(n)) = (is_pattern(&file), fields.get("frames").or(fields.get("rate"))) {
            let message = format!("`{}` is one file, and has no frames", file.value);
            let hint = "a sequence has its numbers as `#` in the file's name: `frame_####.vtk`";
            self.decoder.push(Diagnostic::error(Code::WRONG_VALUE, message).at(n.span, "not here").hint(hint));
            return None;
        }
        let sequence = is_pattern(&file).then_some(Sequence { frames, rate });
        let taken = Taken { placement: self.stand(&fields)?, names: self.names(&fields)? };
        Some(ParticleSource { file, radius_m, taken, sequence, bounds: self.bounds(&fields)? })
    }

    /// Where the file's numbers stand in the scene.
    fn stand(&mut self, fields: &Fields<'_>) -> Option<Placement> {
        let up = self.up(fields)?;
        let place = self.place(fields)?;
        let [scale, y, z] = place.scale.to_array();
        let at = fields.get("scale").map_or(fields.head, |node| node.span);
        self.sound((scale != y || scale != z).then_some("particles scale alike along all axes"), at)?;
        self.sound((scale <= 0.0).then_some("a scale of particles must be above 0"), at)?;
        Some(Placement {
            scale,
            turn: DMat3::from_quat(place.rotation) * up.scene_from_file(),
            position: place.position,
        })
    }

    /// Which axis of a file points up.
    pub(super) fn up(&mut self, fields: &Fields<'_>) -> Option<Up> {
        fields.get("up").map_or(Some(Up::default()), |node| self.decoder.choice(node, "`up`", Up::WORDS))
    }

    /// What a graph calls attributes, and what the file calls them: `{"velocity": "v"}`.
    fn names(&mut self, fields: &Fields<'_>) -> Option<Vec<(String, String)>> {
        let Some(node) = fields.get("names") else { return Some(Vec::new()) };
        let mut names = Vec::new();
        for (name, node) in self.decoder.map(node, "`names`")? {
            let fixed = (name.value == "position").then_some("the position is found by itself, whatever its name");
            self.sound(fixed, name.span)?;
            names.push((name.value, self.decoder.text(node, "a name of the file's")?.value));
        }
        Some(names)
    }

    /// First and last, both of them frames.
    fn frames(&mut self, node: &Node) -> Option<RangeInclusive<u64>> {
        let items = self.decoder.items(node, "`frames`", "(first, last)", 2..=2)?;
        let [first, last] = items else { return None };
        let first = self.decoder.int_within(first, "`frames`", 0, i64::from(u32::MAX))?;
        let last = self.decoder.int_within(last, "`frames`", 0, i64::from(u32::MAX))?;
        self.sound((first > last).then_some("the first frame comes after the last"), node.span)?;
        Some(u64::try_from(first).ok()?..=u64::try_from(last).ok()?)
    }

    /// Both corners, or neither.
    fn bounds(&mut self, fields: &Fields<'_>) -> Option<Option<[[f32; 3]; 2]>> {
        let (Some(min), Some(max)) = (fields.get("min"), fields.get("max")) else {
            let one = fields.get("min").or(fields.get("max"));
            let fault = one.map(|_| "bounds have both `min` and `max`");
            self.sound(fault, one.map_or(fields.head, |n| n.span))?;
            return Some(None);
        };
        let low = self.decoder.floats::<3>(min, "`min`")?.map(|x| x as f32);
        let high = self.decoder.floats::<3>(max, "`max`")?.map(|x| x as f32);
        let is_box = low.iter().zip(high).all(|(low, high)| *low <= high);
        self.sound((!is_box).then_some("`min` is above `max`"), min.span)?;
        Some(Some([low, high]))
    }
}
