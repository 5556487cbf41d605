//! Where the nodes of a model are at a time.

use glam::{Mat4, Quat, Vec3};

use super::model::{Animation, Bounds, Channel, Interpolation, Keys, Local, Mesh, Model, Node, Primitive};

/// Vertices that are looked at one by one for a box, before the boxes of meshes have to do.
const MOST_EXACT: usize = 1 << 24;

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

    /// The box around all triangles, with nodes where `world_from_node` says; none without any. Where
    /// many nodes share large meshes it is that around the boxes of those.
    pub fn bounds(&self, world_from_node: &[Mat4]) -> Option<Bounds> {
        let own: Vec<Option<Bounds>> = self.meshes.iter().map(|mesh| mesh.bounds(Mat4::IDENTITY)).collect();
        let is_exact = self.drawn_vertices() <= MOST_EXACT;
        let boxes = self.nodes.iter().zip(world_from_node).filter_map(|(node, world)| match node.mesh? {
            mesh if is_exact => self.meshes.get(mesh)?.bounds(*world),
            mesh => Some((*own.get(mesh)?)?.moved(*world)),
        });
        boxes.reduce(Bounds::with)
    }

    /// Vertices of all nodes, those of a mesh as often as it is shown.
    fn drawn_vertices(&self) -> usize {
        let of = |mesh: &Mesh| mesh.primitives.iter().map(|primitive| primitive.positions.len()).sum::<usize>();
        let of: Vec<usize> = self.meshes.iter().map(of).collect();
        self.nodes.iter().filter_map(|node| of.get(node.mesh?)).fold(0, |sum, count| sum.saturating_add(*count))
    }

    /// The first node that reaches further than `most` along an axis, or to numbers that are none.
    pub(super) fn beyond(&self, most: f32, world_from_node: &[Mat4]) -> Option<usize> {
        let own: Vec<Option<Bounds>> = self.meshes.iter().map(|mesh| mesh.bounds(Mat4::IDENTITY)).collect();
        let is_beyond = |node: &Node, world: &Mat4| {
            let own = node.mesh.and_then(|mesh| *own.get(mesh)?);
            own.is_some_and(|own| !own.stays_within(most, *world))
        };
        self.nodes.iter().zip(world_from_node).position(|(node, world)| is_beyond(node, world))
    }

    /// Which nodes an animation may turn inside out on its way, with those below them.
    pub fn turning(&self, animation: Option<usize>) -> Vec<bool> {
        let mut turning = vec![false; self.nodes.len()];
        let channels = animation.and_then(|index| self.animations.get(index)).map_or(&[][..], |a| &a.channels);
        for channel in channels {
            if let Some(turns) = turning.get_mut(channel.node) {
                *turns |= channel.turns();
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            turning[index] |= node.parent.is_some_and(|parent| turning[parent]);
        }
        turning
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

impl Bounds {
    /// The box around both.
    pub fn with(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box around this one in another space.
    pub fn moved(self, to: Mat4) -> Self {
        let corners = self.corners(to).map(|p| Self { min: p, max: p });
        corners.into_iter().fold(corners[0], Self::with)
    }

    /// Where its corners are in another space.
    pub fn corners(self, to: Mat4) -> [Vec3; 8] {
        let part = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
        std::array::from_fn(|n| to.transform_point3(Vec3::new(part(n, 0), part(n, 1), part(n, 2))))
    }

    /// Whether it reaches no further than `most` along each axis in another space, and leads to numbers there.
    pub fn stays_within(self, most: f32, to: Mat4) -> bool {
        self.corners(to).iter().flat_map(|corner| corner.to_array()).all(|x| x.abs() <= most)
    }
}

impl Mesh {
    /// The box around its vertices in another space; none without vertices.
    fn bounds(&self, to: Mat4) -> Option<Bounds> {
        self.primitives.iter().filter_map(|primitive| primitive.bounds(to)).reduce(Bounds::with)
    }
}

impl Primitive {
    /// The box around its vertices in another space; none without vertices.
    pub fn bounds(&self, to: Mat4) -> Option<Bounds> {
        let points = self.positions.iter().map(|p| to.transform_point3(Vec3::from_array(*p)));
        points.map(|p| Bounds { min: p, max: p }).reduce(Bounds::with)
    }
}

/// Whether a transform turns counter-clockwise into clockwise, so that the other side is the front.
pub fn is_mirrored(world_from_node: Mat4) -> bool {
    // A scale of 1e-15 has a cube that single precision cannot tell from 0.
    world_from_node.as_dmat4().determinant() < 0.0
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
    /// Whether it scales by what is positive, or none, and by what is negative. Splines are taken
    /// at their keys and not between them.
    fn turns(&self) -> bool {
        let Keys::Scale(keys) = &self.keys else { return false };
        let is_cubic = self.interpolation == Interpolation::Cubic;
        let values = || keys.iter().enumerate().filter(|(at, _)| !is_cubic || at % 3 == 1).map(|(_, key)| key);
        (0..3).any(|axis| values().any(|key| key[axis] < 0.0) && values().any(|key| key[axis] >= 0.0))
    }

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
