var picture: texture_storage_2d<r32float, write>;
@fragment fn main() -> @location(0) f32 { return textureLoad(picture, vec2<i32>(0)).x; }
