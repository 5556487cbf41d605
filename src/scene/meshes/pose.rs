//! Where the nodes of a model are at a time.

use glam::{Mat4, Quat, Vec3};

use super::model::{Animation, Bounds, Channel, Interpolation, Keys, Local, Model, Primitive};

/// Where a model's nodes are, with what it takes to find out.
#[derive(Clone, Debug, Default)]
pub struct Pose {
    locals: Vec<Local>,
    /// World from node, for each node.
    pub world: Vec<Mat4>,
}

impl Model {
    /// World from node, for each node, at a time of one of the animations. Before its first key
    /// and after its last a channel stands still; looping is the caller's choice.
    pub fn pose(&self, animation: Option<usize>, time_s: f64) -> Vec<Mat4> {
        let mut pose = Pose::default();
        self.pose_into(animation, time_s, &mut pose);
        pose.world
    }

    /// The same into memory that is there, for those who ask in every frame.
    pub fn pose_into(&self, animation: Option<usize>, time_s: f64, pose: &mut Pose) {
        let Pose { locals, world } = pose;
        locals.clear();
        locals.extend(self.nodes.iter().map(|node| node.local));
        if let Some(animation) = animation.and_then(|index| self.animations.get(index)) {
            animation.apply(time_s, locals);
        }
        world.clear();
        for (node, local) in self.nodes.iter().zip(&*locals) {
            let parent = node.parent.and_then(|parent| world.get(parent)).copied().unwrap_or(Mat4::IDENTITY);
            world.push(parent * local.matrix());
        }
    }

    /// The box around all triangles, with nodes where `world_from_node` says; none without any.
    pub fn bounds(&self, world_from_node: &[Mat4]) -> Option<Bounds> {
        let drawn = self.nodes.iter().zip(world_from_node).filter_map(|(node, world)| Some((node.mesh?, world)));
        let boxes = drawn.flat_map(|(mesh, world)| {
            self.meshes.get(mesh).into_iter().flat_map(|mesh| &mesh.primitives).filter_map(|p| p.bounds(*world))
        });
        boxes.reduce(|a, b| Bounds { min: a.min.min(b.min), max: a.max.max(b.max) })
    }

    /// Which animation bears a name.
    pub fn animation(&self, name: &str) -> Option<usize> {
        self.animations.iter().position(|animation| animation.name == name)
    }

    /// How many triangles its nodes draw.
    pub fn triangle_count(&self) -> usize {
        let meshes = self.nodes.iter().filter_map(|node| self.meshes.get(node.mesh?));
        meshes.flat_map(|mesh| &mesh.primitives).map(|primitive| primitive.indices.len() / 3).sum()
    }
}

impl Primitive {
    /// The box around its vertices in another space; none without vertices.
    pub fn bounds(&self, to: Mat4) -> Option<Bounds> {
        let points = self.positions.iter().map(|p| to.transform_point3(Vec3::from_array(*p)));
        points.map(|p| Bounds { min: p, max: p }).reduce(|a, b| Bounds { min: a.min.min(b.min), max: a.max.max(b.max) })
    }
}

/// Whether a transform turns counter-clockwise into clockwise, so that the other side is the front.
pub fn is_mirrored(world_from_node: Mat4) -> bool {
    world_from_node.determinant() < 0.0
}

impl Local {
    pub fn matrix(self) -> Mat4 {
        match self {
            Self::Parts { translation, rotation, scale } => {
                Mat4::from_scale_rotation_translation(scale, rotation, translation)
            }
            Self::Matrix(matrix) => matrix,
        }
    }
}

impl Animation {
    fn apply(&self, time_s: f64, locals: &mut [Local]) {
        for channel in &self.channels {
            let Some(Local::Parts { translation, rotation, scale }) = locals.get_mut(channel.node) else { continue };
            let Some(at) = channel.at(time_s) else { continue };
            match &channel.keys {
                Keys::Translation(keys) => {
                    at.vector(keys, channel.interpolation).into_iter().for_each(|v| *translation = v)
                }
                Keys::Scale(keys) => at.vector(keys, channel.interpolation).into_iter().for_each(|v| *scale = v),
                Keys::Rotation(keys) => {
                    at.rotation(keys, channel.interpolation).into_iter().for_each(|q| *rotation = q)
                }
            }
        }
    }
}

/// Between which keys a time lies.
struct At {
    first: usize,
    second: usize,
    /// From 0 to 1.
    part: f32,
    /// Seconds between both.
    span_s: f32,
}

impl Channel {
    fn at(&self, time_s: f64) -> Option<At> {
        let last = self.times_s.len().checked_sub(1)?;
        let after = self.times_s.partition_point(|t| f64::from(*t) <= time_s);
        let first = after.saturating_sub(1);
        let second = if after == 0 { 0 } else { after.min(last) };
        let (start, end) = (f64::from(self.times_s[first]), f64::from(self.times_s[second]));
        let span = end - start;
        let part = if span > 0.0 { ((time_s - start) / span).clamp(0.0, 1.0) } else { 0.0 };
        Some(At { first, second, part: part as f32, span_s: span as f32 })
    }
}

impl At {
    fn vector(&self, keys: &[Vec3], how: Interpolation) -> Option<Vec3> {
        match how {
            Interpolation::Step => keys.get(self.first).copied(),
            Interpolation::Linear => Some(keys.get(self.first)?.lerp(*keys.get(self.second)?, self.part)),
            Interpolation::Cubic => self.cubic(keys),
        }
    }

    fn rotation(&self, keys: &[Quat], how: Interpolation) -> Option<Quat> {
        match how {
            Interpolation::Step => keys.get(self.first).copied(),
            Interpolation::Linear => Some(keys.get(self.first)?.slerp(*keys.get(self.second)?, self.part)),
            Interpolation::Cubic => {
                let rotation = self.cubic(keys)?;
                // A spline may pass through zero, where there is no direction.
                (rotation.length_squared() > 1e-12).then(|| rotation.normalize())
            }
        }
    }

    /// The Hermite spline of glTF 2.0, appendix C.
    fn cubic<T>(&self, keys: &[T]) -> Option<T>
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let (t, t2) = (self.part, self.part * self.part);
        let t3 = t2 * t;
        let value = |key: usize, which: usize| keys.get(key * 3 + which).copied();
        let (start, leaving) = (value(self.first, 1)?, value(self.first, 2)?);
        let (end, arriving) = (value(self.second, 1)?, value(self.second, 0)?);
        Some(
            start * (2.0 * t3 - 3.0 * t2 + 1.0)
                + leaving * (self.span_s * (t3 - 2.0 * t2 + t))
                + end * (3.0 * t2 - 2.0 * t3)
                + arriving * (self.span_s * (t3 - t2)),
        )
    }
}
