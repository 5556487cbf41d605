//! The shaders of random graphs. Those of images have the format's number behind their name.

/// Formats that can be stored, in the order of the generator's.
const STORED: [&str; 3] = ["rgba16float", "r32float", "rgba8unorm"];

/// Every shader by its file's name under `shaders/`.
pub fn all() -> Vec<(String, String)> {
    let thread = "@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) i: vec3<u32>)";
    let mut all: Vec<(String, String)> = STORED
        .iter()
        .enumerate()
        .map(|(i, format)| {
            let text = format!(
                "var dst: texture_storage_2d<{format}, write>;\n@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
                 {{ textureStore(dst, i.xy, vec4<f32>(0.5)); }}"
            );
            (format!("image{i}.wgsl"), text)
        })
        .collect();
    let list = |count: &str| format!("struct List {{ count: {count}, items: array<u32> }}\n");
    let corner = "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> { \
                  return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0); }\n";
    let white = "@fragment fn main() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }";
    let at = "@fragment fn main(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32>";
    for (name, text) in [
        ("fill", format!("var<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] = i.x; }} }}")),
        ("add", format!("var<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] += 1u; }} }}")),
        (
            "copy",
            format!(
                "var<storage, read> src: array<u32>; var<storage, read_write> dst: array<u32>;\n\
                 {thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] = src[min(i.x, arrayLength(&src) - 1u)]; }} }}"
            ),
        ),
        (
            "feed",
            format!(
                "var<storage, read> src: array<u32>; var<storage, read_write> dst: array<u32>;\n\
                 {thread} {{ if i.x < arrayLength(&dst) {{ dst[i.x] += src[min(i.x, arrayLength(&src) - 1u)]; }} }}"
            ),
        ),
        (
            "seen",
            "struct Eye { position: vec3<f32> } var<uniform> camera: Eye;\n@fragment fn main() -> @location(0) vec4<f32> \
             { return vec4<f32>(camera.position, 1.0); }"
                .to_owned(),
        ),
        ("paint", white.to_owned()),
        ("filter", format!("var src: texture_2d<f32>;\n{at} {{ return textureLoad(src, vec2<i32>(p.xy), 0); }}")),
        ("layers", format!("var src: texture_2d_array<f32>;\n{at} {{ return textureLoad(src, vec2<i32>(p.xy), 1, 0); }}")),
        (
            "sample",
            "var src: texture_2d<f32>; var linear_clamp: sampler;\n@fragment fn main(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> \
             { return textureSample(src, linear_clamp, uv * 4.0); }"
                .to_owned(),
        ),
        (
            "append",
            format!(
                "{}var<storage, read_write> list: List;\n{thread} {{ let at = atomicAdd(&list.count, 1u); \
                 if at < arrayLength(&list.items) {{ list.items[at] = i.x; }} }}",
                list("atomic<u32>")
            ),
        ),
        (
            "consume",
            format!(
                "{}var<storage, read> list: List; var<storage, read_write> dst: array<u32>;\n{thread} {{ \
                 if i.x < list.count {{ dst[i.x % arrayLength(&dst)] = list.items[i.x]; }} }}",
                list("u32")
            ),
        ),
        (
            "points",
            format!(
                "{}var<storage, read> list: List;\n@vertex fn corner(@builtin(instance_index) i: u32) -> @builtin(position) vec4<f32> \
                 {{ return vec4<f32>(f32(list.items[i]) / 100.0 - 1.0, 0.0, 0.5, 1.0); }}\n{white}",
                list("u32")
            ),
        ),
        (
            "arguments",
            "struct Arguments { vertices: u32, instances: u32, first_vertex: u32, first_instance: u32 }\n\
             var<storage, read_write> arguments: array<Arguments>;\n@compute @workgroup_size(1) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
             { arguments[i.x] = Arguments(3u * i.x, 1u, 0u, 0u); }"
                .to_owned(),
        ),
        ("triangle", format!("{corner}{white}")),
        (
            "volume",
            "var dst: texture_storage_3d<rgba16float, write>;\n@compute @workgroup_size(4, 4, 4) fn main(@builtin(global_invocation_id) i: vec3<u32>) \
             { textureStore(dst, i, vec4<f32>(0.5)); }"
                .to_owned(),
        ),
        ("number", "@fragment fn main() -> @location(0) u32 { return 7u; }".to_owned()),
        (
            "slice",
            format!(
                "var volume: texture_3d<f32>; var numbers: texture_2d<u32>;\n{at} {{ return textureLoad(volume, vec3<i32>(p.xyx), 0) \
                 * f32(textureLoad(numbers, vec2<i32>(p.xy), 0).x); }}"
            ),
        ),
        (
            "two",
            "struct Out { @location(0) a: vec4<f32>, @location(1) b: vec4<f32> }\n@fragment fn main() -> Out { \
             return Out(vec4<f32>(1.0), vec4<f32>(2.0)); }"
                .to_owned(),
        ),
        (
            "values",
            format!(
                "struct Values {{ times: i32, fancy: u32, viewport: vec2<f32>, time: f32, turn: u32 }} var<uniform> values: Values;\n\
                 override factor: f32 = 1.0;\nvar<storage, read_write> dst: array<u32>;\n{thread} {{ if i.x < arrayLength(&dst) {{ \
                 dst[i.x] += u32(values.times) + values.fancy + u32(values.viewport.x * factor) + u32(values.time) + values.turn; }} }}"
            ),
        ),
        (
            "group",
            format!(
                "{}var<storage, read> list: List; var<storage, read_write> few: array<u32>;\n\
                 @compute @workgroup_size(1) fn main(@builtin(workgroup_id) i: vec3<u32>) {{ few[0] += list.items[i.x]; }}",
                list("u32")
            ),
        ),
    ] {
        all.push((format!("{name}.wgsl"), text));
    }
    all
}
