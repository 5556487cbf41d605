var picture: texture_storage_2d<r32float, write>;
fn put(into: texture_storage_2d<r32float, write>) { textureStore(into, vec2<i32>(0), vec4<f32>(1.0)); }
@compute @workgroup_size(1) fn main() { put(picture); }
