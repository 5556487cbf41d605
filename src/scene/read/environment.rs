//! The sun by time and place, and environments that are cubes.

use super::Reader;
use crate::scene::camera::Light;
use crate::scene::model::{CubeFiles, Item};
use crate::scene::sun::Sun;
use crate::syntax::{Body, Fields, Node, Sp};

impl Reader<'_> {
    /// `Sun(time: 17.5, latitude: 45.0, day: 172.0, north: 0.0, intensity: 4.0)`.
    pub(super) fn sun(&mut self, node: &Node) -> Option<Light> {
        let known = ["time", "latitude", "day", "north", "intensity"];
        let fields = self.decoder.fields(node, "`Sun`", &known)?;
        let usual = Sun::default();
        let time = fields.require(&mut self.decoder, "time");
        let time_h = time.and_then(|n| self.decoder.float(n, "`time`"));
        let mut number = |name: &str, usual: f64| match fields.get(name) {
            Some(n) => self.decoder.float(n, &format!("`{name}`")),
            None => Some(usual),
        };
        let (latitude, day) = (number("latitude", usual.latitude), number("day", usual.day));
        let (north, intensity) = (number("north", usual.north), number("intensity", usual.intensity));
        let sun = Sun { time_h: time_h?, latitude: latitude?, day: day?, north: north?, intensity: intensity? };
        self.sound(sun.fault(), fields.head)?;
        Some(sun.light())
    }

    /// `Cross("file")` or `Faces(px: "file", ...)` as the environment.
    pub(super) fn cube(&mut self, fields: &Fields<'_>) -> Option<Item<CubeFiles>> {
        let (name, node) = fields.entry("environment")?;
        let tagged = node.as_tagged()?;
        let value = match (tagged.name.as_ref().map(|word| word.value.as_str()), &tagged.body) {
            (Some("Cross"), Body::Items(items)) if items.len() == 1 => {
                CubeFiles::Cross(self.file_name(&items[0], "`Cross`")?)
            }
            (Some("Faces"), _) => CubeFiles::Faces(Box::new(self.faces(node)?)),
            _ => {
                self.decoder.wrong(
                    node,
                    "`environment`",
                    "a picture's file, `Cross(\"file\")` or `Faces(px: \"file\", ...)`",
                );
                return None;
            }
        };
        Some(Item { name: name.clone(), value, span: node.span })
    }

    fn faces(&mut self, node: &Node) -> Option<[Sp<String>; 6]> {
        const NAMES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];
        let fields = self.decoder.fields(node, "`Faces`", &NAMES)?;
        let files = NAMES.map(|name| {
            let face = fields.require(&mut self.decoder, name)?;
            self.file_name(face, &format!("`{name}`"))
        });
        files.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
    }
}
