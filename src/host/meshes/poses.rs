//! Where bodies stand at a time: the animation that each file of a scene plays.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Mat4, Vec3};

use super::Meshes;
use crate::diagnostic::{Code, Diagnostic};
use crate::plan::meshes::INSTANCE_BYTES;
use crate::scene::meshes::{Model, Pose};
use crate::scene::{MeshEntry, Playing};

/// At how many times of its animation a body is looked at for its bounds.
const POSES: u32 = 64;

/// Where bodies that move stand, with the memory that it takes to tell.
#[derive(Debug, Default)]
pub(in crate::host) struct Standing {
    /// The time in seconds at which they stand on the device.
    pub at_s: Option<f64>,
    poses: Vec<Pose>,
    /// Items of `x.instances`.
    pub bytes: Vec<u8>,
    /// How far from the eye the middle of each blended instance's box is, in metres.
    pub away_m: BTreeMap<u32, f32>,
}

/// A mesh file of the scene, and what moves its nodes.
#[derive(Debug)]
pub(in crate::host) struct Entry {
    pub model: Arc<Model>,
    pub animation: Option<usize>,
    pub loops: bool,
    pub start_s: f64,
}

impl Meshes {
    /// Items of `x.instances` at a time in seconds.
    pub(in crate::host) fn instances(&self, time_s: f64) -> Vec<u8> {
        let mut standing = Standing::default();
        self.instances_into(time_s, &mut standing);
        standing.bytes
    }

    /// The same into memory that is there.
    pub(in crate::host) fn instances_into(&self, time_s: f64, standing: &mut Standing) {
        self.pose_into(time_s, standing);
        let Standing { poses, bytes, .. } = standing;
        bytes.clear();
        bytes.reserve(self.instances.len() * INSTANCE_BYTES as usize);
        for instance in &self.instances {
            let matrix = poses[instance.entry].world[instance.node].to_cols_array();
            bytes.extend_from_slice(bytemuck::bytes_of(&matrix));
            let words = [instance.body, instance.first_triangle, instance.triangles, instance.material];
            bytes.extend_from_slice(bytemuck::bytes_of(&words));
        }
    }

    /// How far blended instances are from an eye at a time in seconds.
    pub(in crate::host) fn away_into(&self, eye: Vec3, time_s: f64, standing: &mut Standing) {
        self.pose_into(time_s, standing);
        for (at, middle) in &self.blended {
            let instance = self.instances[*at as usize];
            let world = self.bodies[instance.body as usize] * standing.poses[instance.entry].world[instance.node];
            standing.away_m.insert(*at, world.transform_point3(*middle).distance(eye));
        }
    }

    fn pose_into(&self, time_s: f64, standing: &mut Standing) {
        let poses = &mut standing.poses;
        if poses.len() < self.entries.len() {
            poses.resize_with(self.entries.len(), Pose::default);
        }
        for (entry, pose) in self.entries.iter().zip(poses) {
            entry.pose_into(time_s, pose);
        }
    }
}

impl Entry {
    /// Even times of its animation, all through it.
    pub fn times_s(&self) -> impl Iterator<Item = f64> + use<> {
        let animation = self.animation.and_then(|a| self.model.animations.get(a));
        let duration_s = animation.map_or(0.0, |a| f64::from(a.duration_s));
        (0..=if animation.is_some() { POSES } else { 0 }).map(move |i| duration_s * f64::from(i) / f64::from(POSES))
    }

    /// Body from node, for each node, at a time of the scene.
    pub fn pose(&self, time_s: f64) -> Vec<Mat4> {
        let mut pose = Pose::default();
        self.pose_into(time_s, &mut pose);
        pose.world
    }

    fn pose_into(&self, time_s: f64, pose: &mut Pose) {
        let duration_s = self.animation.and_then(|a| self.model.animations.get(a)).map_or(0.0, |a| a.duration_s);
        let mut at_s = time_s + self.start_s;
        if self.loops && duration_s > 0.0 {
            at_s = at_s.rem_euclid(f64::from(duration_s));
        }
        self.model.pose_into(self.animation, at_s, pose);
    }
}

/// Which animation an entry plays, whether over and over, and from where.
pub(in crate::host) fn animation(entry: &MeshEntry, model: &Model) -> Result<(Option<usize>, bool, f64), Diagnostic> {
    let Playing::Plays { animation, loops, start_s } = &entry.playing else { return Ok((None, false, 0.0)) };
    let Some(name) = animation else {
        return Ok(((!model.animations.is_empty()).then_some(0), *loops, *start_s));
    };
    if let Some(found) = model.animation(&name.value) {
        return Ok((Some(found), *loops, *start_s));
    }
    let names: Vec<&str> = model.animations.iter().map(|a| a.name.as_str()).collect();
    let message = format!("`{}` has no animation `{}`", entry.file.value, name.value);
    let error = Diagnostic::error(Code::UNKNOWN_NAME, message).at(name.span, "asked for here");
    Err(match names.as_slice() {
        [] => error.hint("the file has no animations"),
        names => error.nearest(&name.value, names.iter().copied()).hint(format!("it has {}", names.join(", "))),
    })
}

/// What is worth saying of an entry that does not say which of several animations it plays.
pub(in crate::host) fn choice(entry: &MeshEntry, model: &Model) -> Option<Diagnostic> {
    let Playing::Plays { animation: None, .. } = entry.playing else { return None };
    let names: Vec<String> = model.animations.iter().map(|a| format!("`{}`", a.name)).collect();
    let [first, others @ ..] = names.as_slice() else { return None };
    if others.is_empty() {
        return None;
    }
    let message = format!("`{}`: of its {} animations the first is played, {first}", entry.file.value, names.len());
    let (most, others) = (others.len().min(8), others.len());
    let more = if others > most { " and more" } else { "" };
    let hint = format!("`animation:` of a body chooses; there are also {}{more}", names[1..=most].join(", "));
    Some(Diagnostic::note(Code::ASSET_NOTE, message).at(entry.file.span, "named here").hint(hint))
}
