var picture: texture_3d<f32>;
@fragment fn main() -> @location(0) vec4<f32> { return textureLoad(picture, vec2<i32>(0, 0), 0); }
