//! A camera of a mesh file, which stands where its node does and moves as that does.

use std::sync::Arc;

use glam::{DMat4, DVec3, Mat4};

use super::meshes::{Entry, animation};
use crate::diagnostic::{Code, Diagnostic};
use crate::scene::meshes::{LensKind, Model};
use crate::scene::{Camera, CameraFile};

/// What somebody looks through.
#[derive(Clone, Debug)]
pub struct Viewpoint {
    entry: Arc<Entry>,
    node: usize,
    world_from_file: DMat4,
    /// Vertical.
    pub fov_degrees: f64,
    near_m: f64,
    /// What is looked at, where that matters: the middle of all that the file shows.
    middle: DVec3,
}

impl Viewpoint {
    /// The camera that a scene asks for.
    ///
    /// # Errors
    /// If the file has no such camera, or one that cannot be looked through.
    pub(super) fn new(asked: &CameraFile, model: &Arc<Model>) -> Result<Self, Diagnostic> {
        let file = &asked.entry.file.value;
        let node = find(asked, model)?;
        let lens = model.nodes[node].camera.and_then(|camera| model.cameras.get(camera));
        let span = asked.name.as_ref().map_or(asked.entry.file.span, |name| name.span);
        let refused = |why: &str| {
            let message = format!("`{file}`: its camera `{}` {why}", name_of(model, node));
            Diagnostic::error(Code::ASSET, message).at(span, "asked for here")
        };
        let (yfov, znear) = match lens.map(|lens| (lens.fault, lens.kind)) {
            Some((None, LensKind::Perspective { yfov, znear, .. })) => (f64::from(yfov), f64::from(znear)),
            Some((None, LensKind::Orthographic { .. })) => {
                let hint = "cameras are perspective: make it so in the file, or say `Camera(eye:, target:)`";
                return Err(refused("is orthographic, which is not drawn").hint(hint));
            }
            Some((Some(why), _)) => return Err(refused(&format!("cannot be looked through: {why}"))),
            None => return Err(refused("is not there")),
        };
        let (animation, loops, start_s) = animation(&asked.entry, model)?;
        let entry = Arc::new(Entry { model: Arc::clone(model), animation, loops, start_s });
        let world_from_file = asked.entry.world_from_body.first().copied().unwrap_or(DMat4::IDENTITY);
        let own = model.bounds(&entry.pose(0.0)).map_or(DVec3::ZERO, |b| (b.min + b.max).as_dvec3() * 0.5);
        let view = Self {
            entry,
            node,
            world_from_file,
            fov_degrees: yfov.to_degrees(),
            near_m: znear * world_from_file.determinant().abs().cbrt(),
            middle: world_from_file.transform_point3(own),
        };
        if view.at(0.0).is_none() {
            return Err(refused("stands nowhere: its node has no size, or is too far away"));
        }
        Ok(view)
    }

    /// Where it is at a time of the scene; none where its node has no direction.
    pub fn at(&self, time_s: f64) -> Option<Camera> {
        let node = self.entry.pose(time_s).get(self.node).map(Mat4::as_dmat4)?;
        let world = self.world_from_file * node;
        let eye = world.w_axis.truncate();
        // A node's scale is none of its camera's.
        let (forward, up) = ((-world.z_axis.truncate()).try_normalize()?, world.y_axis.truncate().try_normalize()?);
        let ahead_m = (self.middle - eye).dot(forward).max(self.near_m * 10.0);
        let near_m = Some(self.near_m);
        let camera = Camera { eye, target: eye + forward * ahead_m, up, fov_degrees: self.fov_degrees, near_m };
        camera.fault().is_none().then_some(camera)
    }
}

/// The node of the camera that is asked for by its name or its node's; the first where none is.
fn find(asked: &CameraFile, model: &Model) -> Result<usize, Diagnostic> {
    let file = &asked.entry.file;
    let all: Vec<usize> = (0..model.nodes.len()).filter(|node| model.nodes[*node].camera.is_some()).collect();
    let Some(name) = &asked.name else {
        return all.first().copied().ok_or_else(|| {
            let message = format!("`{}` has no camera", file.value);
            Diagnostic::error(Code::UNKNOWN_NAME, message).at(file.span, "asked for here")
        });
    };
    let lens = |node: usize| model.nodes[node].camera.and_then(|camera| model.cameras.get(camera));
    let by_node = all.iter().find(|node| model.nodes[**node].name == name.value);
    let found = by_node.or_else(|| all.iter().find(|node| lens(**node).is_some_and(|lens| lens.name == name.value)));
    found.copied().ok_or_else(|| {
        let message = format!("`{}` has no camera `{}`", file.value, name.value);
        let error = Diagnostic::error(Code::UNKNOWN_NAME, message).at(name.span, "asked for here");
        let names: Vec<&str> = all.iter().map(|node| name_of(model, *node)).collect();
        match names.as_slice() {
            [] => error.hint("the file has no cameras"),
            names => error.nearest(&name.value, names.iter().copied()).hint(format!("it has {}", names.join(", "))),
        }
    })
}

/// What a person calls the camera of a node.
fn name_of(model: &Model, node: usize) -> &str {
    let lens = model.nodes[node].camera.and_then(|camera| model.cameras.get(camera));
    let own = &model.nodes[node].name;
    if own.is_empty() { lens.map_or("", |lens| &lens.name) } else { own }
}
