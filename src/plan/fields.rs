//! Fields that inputs have, by kind. `docs/language.md` shows the same tables.

/// Type of a field, as far as planning needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldType {
    Int,
    Float,
    Vec2,
    Vec3,
    Mat4,
}

impl FieldType {
    pub fn name(self) -> &'static str {
        match self {
            FieldType::Int => "Int",
            FieldType::Float => "Float",
            FieldType::Vec2 => "Vec2",
            FieldType::Vec3 => "Vec3",
            FieldType::Mat4 => "4 x 4 matrix",
        }
    }
}

/// Fields of a camera: matrices both ways, position and the projection's terms. Eye space is
/// right-handed and looks along -z; depth is reversed.
pub const CAMERA: &[(&str, FieldType)] = &[
    ("clip_from_world", FieldType::Mat4),
    ("world_from_clip", FieldType::Mat4),
    ("view_from_world", FieldType::Mat4),
    ("world_from_view", FieldType::Mat4),
    ("clip_from_view", FieldType::Mat4),
    ("view_from_clip", FieldType::Mat4),
    ("position", FieldType::Vec3),
    ("near", FieldType::Float),
    ("far", FieldType::Float),
    ("tan_half_fov", FieldType::Vec2),
    ("viewport", FieldType::Vec2),
    ("pixel_m", FieldType::Float),
    ("orthographic", FieldType::Int),
];

/// Fields of a light: `direction` goes from the light into the scene.
pub const LIGHT: &[(&str, FieldType)] =
    &[("direction", FieldType::Vec3), ("color", FieldType::Vec3), ("intensity", FieldType::Float)];

/// Fields of a pointer, in world space.
pub const POINTER: &[(&str, FieldType)] =
    &[("origin", FieldType::Vec3), ("direction", FieldType::Vec3), ("pressed", FieldType::Int)];

/// Scalars of particles, besides their attributes; known when planning.
pub const PARTICLES: &[(&str, FieldType)] =
    &[("count", FieldType::Int), ("radius", FieldType::Float), ("min", FieldType::Vec3), ("max", FieldType::Vec3)];

/// Scalars of meshes, besides their buffers; known when planning.
pub const MESHES: &[(&str, FieldType)] =
    &[("count", FieldType::Int), ("blended", FieldType::Int), ("min", FieldType::Vec3), ("max", FieldType::Vec3)];

/// Scalars that every graph has while a frame runs.
pub const FRAME: &[(&str, FieldType)] =
    &[("time", FieldType::Float), ("delta", FieldType::Float), ("frame", FieldType::Int), ("step", FieldType::Int)];

/// Samplers with reserved names.
pub const SAMPLERS: &[&str] =
    &["linear_clamp", "linear_repeat", "linear_mirror", "nearest_clamp", "nearest_repeat", "depth_compare"];
