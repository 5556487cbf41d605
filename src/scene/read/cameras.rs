//! `camera:` of a scene: one that the scene describes, or one of a mesh file.

use glam::{DMat4, DVec3};

use super::{DEFAULT_FOV_DEGREES, Reader};
use crate::scene::camera::Camera;
use crate::scene::model::{CameraFile, MeshEntry};
use crate::syntax::{Body, Node, Sp};

const OF_FILE: &[&str] = &["file", "name", "up", "position", "rotation", "scale", "animation", "loop", "start"];

/// What `camera:` may be.
pub(super) enum Said {
    Here(Sp<Camera>),
    InFile(Sp<CameraFile>),
}

impl Said {
    /// Both ways to say it apart.
    pub fn apart(said: Option<Self>) -> (Option<Sp<Camera>>, Option<Sp<CameraFile>>) {
        match said {
            Some(Said::Here(camera)) => (Some(camera), None),
            Some(Said::InFile(file)) => (None, Some(file)),
            None => (None, None),
        }
    }
}

impl Reader<'_> {
    /// `Camera(eye:, target:)` or `Camera(file: "boat.glb", name: "bow")`.
    pub(super) fn camera(&mut self, node: &Node) -> Option<Said> {
        let has_file =
            |body: &Body| matches!(body, Body::Fields(all) if all.iter().any(|(name, _)| name.value == "file"));
        if node.as_tagged().is_some_and(|tagged| has_file(&tagged.body)) {
            return self.camera_of_file(node).map(Said::InFile);
        }
        self.camera_here(node).map(Said::Here)
    }

    /// A camera of a mesh file, which is put somewhere as a body is.
    fn camera_of_file(&mut self, node: &Node) -> Option<Sp<CameraFile>> {
        let fields = self.decoder.fields(node, "`Camera` of a file", OF_FILE)?;
        self.word(node, "Camera", "`camera`");
        let file = fields.require(&mut self.decoder, "file").and_then(|n| self.file_name(n, "`file`"));
        let name = match fields.get("name") {
            Some(node) => Some(self.decoder.text(node, "`name`")?),
            None => None,
        };
        let (own, up, playing) = (self.placement(&fields), self.up(&fields), self.playing(&fields));
        let world_from_file = own? * DMat4::from_mat3(up?.scene_from_file());
        let entry = MeshEntry { world_from_body: vec![world_from_file], playing: playing?, ..MeshEntry::of(file?) };
        Some(Sp { value: CameraFile { entry, name }, span: fields.head })
    }

    fn camera_here(&mut self, node: &Node) -> Option<Sp<Camera>> {
        let fields = self.decoder.fields(node, "`Camera`", &["eye", "target", "up", "fov", "near"])?;
        self.word(node, "Camera", "`camera`");
        let eye = fields.require(&mut self.decoder, "eye").and_then(|n| self.decoder.floats::<3>(n, "`eye`"));
        let target = fields.require(&mut self.decoder, "target").and_then(|n| self.decoder.floats::<3>(n, "`target`"));
        let up = match fields.get("up") {
            Some(n) => self.decoder.floats::<3>(n, "`up`"),
            None => Some(DVec3::Y.to_array()),
        };
        let fov_degrees = match fields.get("fov") {
            Some(n) => self.decoder.float(n, "`fov`"),
            None => Some(DEFAULT_FOV_DEGREES),
        };
        let near_m = fields.get("near").and_then(|n| self.decoder.float(n, "`near`"));
        let camera = Camera {
            eye: DVec3::from_array(eye?),
            target: DVec3::from_array(target?),
            up: DVec3::from_array(up?),
            fov_degrees: fov_degrees?,
            near_m,
        };
        self.sound(camera.fault(), fields.head)?;
        Some(Sp { value: camera, span: fields.head })
    }
}
