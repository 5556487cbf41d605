//! `meshes:` of a scene: bodies, each a mesh file put somewhere, with tags and values.

use glam::{DMat4, DQuat, DVec3, EulerRot};

use super::Reader;
use crate::graph::value::Value;
use crate::scene::model::{Item, MeshEntry, Playing};
use crate::syntax::{Fields, Node, Sp};

const PLACE: &[&str] = &["position", "rotation", "scale"];
const BODY: &[&str] =
    &["file", "up", "position", "rotation", "scale", "tags", "values", "animation", "loop", "start", "instances"];

/// Where a scene puts something.
pub(super) struct Place {
    pub position: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Reader<'_> {
    /// A list of bodies, or one.
    pub(super) fn bodies(&mut self, node: &Node, what: &str) -> Option<Vec<MeshEntry>> {
        if !matches!(node.kind, crate::syntax::Kind::List(_)) {
            return self.body(node, what).map(|body| vec![body]);
        }
        let entries = self.decoder.list(node, what)?;
        let read: Vec<_> = entries.iter().map(|entry| self.body(entry, what)).collect();
        read.into_iter().collect()
    }

    /// `"file"` or `(file: "file", position: (0, 1, 0), ...)`.
    fn body(&mut self, node: &Node, what: &str) -> Option<MeshEntry> {
        if node.as_str().is_some() {
            return Some(MeshEntry::of(self.file_name(node, what)?));
        }
        let fields = self.decoder.fields(node, "a body", BODY)?;
        let file = fields.require(&mut self.decoder, "file").and_then(|n| self.file_name(n, "`file`"));
        let own = self.placement(&fields);
        let up = self.up(&fields);
        let tags = fields.get("tags").map_or(Some(Vec::new()), |n| self.tags(n));
        let values = self.body_values(&fields);
        let playing = self.playing(&fields);
        let instances = match fields.get("instances") {
            Some(node) => self.instances(node),
            None => Some(vec![DMat4::IDENTITY]),
        };
        let (own, up) = (own?, DMat4::from_mat3(up?.scene_from_file()));
        Some(MeshEntry {
            file: file?,
            world_from_body: instances?.into_iter().map(|instance| own * instance * up).collect(),
            tags: tags?,
            values: values?,
            playing: playing?,
        })
    }

    fn instances(&mut self, node: &Node) -> Option<Vec<DMat4>> {
        let entries = self.decoder.list(node, "`instances`")?;
        let read: Vec<_> = entries
            .iter()
            .map(|entry| {
                let fields = self.decoder.fields(entry, "an instance", PLACE)?;
                self.placement(&fields)
            })
            .collect();
        read.into_iter().collect()
    }

    pub(super) fn placement(&mut self, fields: &Fields<'_>) -> Option<DMat4> {
        let Place { position, rotation, scale } = self.place(fields)?;
        if scale.to_array().contains(&0.0) {
            let at = fields.get("scale").map_or(fields.head, |node| node.span);
            self.sound(Some("a scale of 0 leaves nothing of a body"), at)?;
        }
        Some(DMat4::from_scale_rotation_translation(scale, rotation, position))
    }

    /// Position in metres; rotation in degrees about x, then y, then z; scale one number or three.
    pub(super) fn place(&mut self, fields: &Fields<'_>) -> Option<Place> {
        let mut vector = |name: &str, default: DVec3| match fields.get(name) {
            Some(node) => self.decoder.floats::<3>(node, &format!("`{name}`")).map(DVec3::from_array),
            None => Some(default),
        };
        let (position, degrees) = (vector("position", DVec3::ZERO), vector("rotation", DVec3::ZERO));
        let scale = match fields.get("scale") {
            Some(node) if matches!(node.kind, crate::syntax::Kind::Int(_) | crate::syntax::Kind::Float(_)) => {
                self.decoder.float(node, "`scale`").map(DVec3::splat)
            }
            _ => vector("scale", DVec3::ONE),
        };
        let (position, degrees, scale) = (position?, degrees?, scale?);
        let turn = degrees.to_array().map(f64::to_radians);
        let rotation = DQuat::from_euler(EulerRot::ZYX, turn[2], turn[1], turn[0]);
        Some(Place { position, rotation, scale })
    }

    fn tags(&mut self, node: &Node) -> Option<Vec<String>> {
        let all: Vec<_> = self
            .decoder
            .list(node, "`tags`")?
            .iter()
            .map(|tag| self.decoder.text(tag, "a tag").map(|tag| tag.value))
            .collect();
        all.into_iter().collect()
    }

    fn body_values(&mut self, fields: &Fields<'_>) -> Option<Vec<Item<Value>>> {
        let Some(node) = fields.get("values") else { return Some(Vec::new()) };
        let entries = self.decoder.map(node, "`values`")?;
        let read: Vec<_> = entries
            .into_iter()
            .map(|(name, node)| {
                let value = self.value(node, &format!("`{}` of `values`", name.value))?;
                Some(Item { name, value, span: node.span })
            })
            .collect();
        read.into_iter().collect()
    }

    /// Which animation moves it, over and over unless `loop: false`, from `start` seconds on.
    pub(super) fn playing(&mut self, fields: &Fields<'_>) -> Option<Playing> {
        let animation = match fields.get("animation") {
            Some(node) if node.as_tagged().is_some_and(|t| t.name.as_ref().is_some_and(|n| n.value == "None")) => {
                return Some(Playing::Still);
            }
            Some(node) => {
                let text = self.decoder.text(node, "`animation`")?;
                Some(Sp { value: text.value, span: text.span })
            }
            None => None,
        };
        let loops = match fields.get("loop") {
            Some(node) => self.decoder.bool(node, "`loop`")?,
            None => true,
        };
        let start_s = match fields.get("start") {
            Some(node) => self.decoder.float(node, "`start`")?,
            None => 0.0,
        };
        Some(Playing::Plays { animation, loops, start_s })
    }
}
