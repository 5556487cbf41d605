//! What modules tell about themselves.

use meniscus::files::MemoryFiles;
use meniscus::format::{SampleKind, TextureFormat};
use meniscus::shader::reflect::{GlobalKind, Module, Scalar, Stage, TextureDimension, Type, Use};
use wgpu_types::Features;

use super::{entry, load_files, load_text, module};

const F32: Type = Type::Scalar(Scalar::F32);

fn vec(components: u32) -> Type {
    Type::Vector { components, scalar: Scalar::F32 }
}

fn usage<'a>(module: &'a Module, of: &str, global: &str) -> &'a Use {
    let index = module.global(global).unwrap().0;
    entry(module, of).uses.iter().find(|u| u.global == index).unwrap_or_else(|| panic!("{of} does not use {global}"))
}

fn is_used(module: &Module, of: &str, global: &str) -> bool {
    let index = module.global(global).unwrap().0;
    entry(module, of).uses.iter().any(|u| u.global == index)
}

fn flags(used: &Use) -> (bool, bool, bool, bool) {
    (used.read, used.write, used.atomic, used.atomic_result)
}

#[test]
fn globals_are_numbered_in_the_order_of_their_text() {
    let m = module(
        "@group(3) @binding(7) var<storage, read_write> late: array<f32>;
         var<private> mine: f32;
         @group(3) @binding(7) var picture: texture_2d<f32>;
         var<workgroup> shared_by_group: array<f32, 64>;
         var linear_clamp: sampler;
         var<uniform> values: vec4<f32>;
         @compute @workgroup_size(1) fn main() { late[0] = mine; }",
    );
    let names: Vec<(&str, u32)> = m.globals.iter().map(|g| (&*g.name, g.binding)).collect();
    assert_eq!(names, [("late", 0), ("picture", 1), ("linear_clamp", 2), ("values", 3)]);
    for (handle, variable) in m.naga.global_variables.iter() {
        let binding = variable.binding.map(|b| (b.group, b.binding));
        let expected = m.globals.iter().find(|g| Some(&*g.name) == variable.name.as_deref()).map(|g| (0, g.binding));
        assert_eq!(binding, expected, "{handle:?}");
    }
}

#[test]
fn kinds_of_globals() {
    let m = module(
        "var a: texture_2d<f32>; var b: texture_2d_array<u32>; var c: texture_depth_2d; var d: texture_3d<i32>;
         var e: texture_multisampled_2d<f32>; var f: texture_cube_array<f32>;
         var g: texture_storage_2d<rgba16float, write>; var h: texture_storage_3d<r32float, read_write>;
         var i: texture_storage_2d_array<rgba8unorm, read>; var j: sampler_comparison;
         var<storage, read> k: array<vec2<f32>>; var<storage, read_write> l: array<atomic<u32>>;",
    );
    let texture = |dimension, multisampled, sample| GlobalKind::Texture { dimension, multisampled, sample };
    let storage = |dimension, format, read, write| GlobalKind::StorageTexture { dimension, format, read, write };
    use TextureDimension as D;
    let expected = [
        ("a", texture(D::D2, false, SampleKind::Float)),
        ("b", texture(D::D2Array, false, SampleKind::Uint)),
        ("c", texture(D::D2, false, SampleKind::Depth)),
        ("d", texture(D::D3, false, SampleKind::Sint)),
        ("e", texture(D::D2, true, SampleKind::Float)),
        ("f", texture(D::CubeArray, false, SampleKind::Float)),
        ("g", storage(D::D2, TextureFormat::Rgba16Float, false, true)),
        ("h", storage(D::D3, TextureFormat::R32Float, true, true)),
        ("i", storage(D::D2Array, TextureFormat::Rgba8Unorm, true, false)),
        ("j", GlobalKind::Sampler { comparison: true }),
        (
            "k",
            GlobalKind::Storage {
                writable: false,
                ty: Type::Array { element: Box::new(vec(2)), count: None, stride: 8 },
            },
        ),
        (
            "l",
            GlobalKind::Storage {
                writable: true,
                ty: Type::Array { element: Box::new(Type::Atomic(Scalar::U32)), count: None, stride: 4 },
            },
        ),
    ];
    assert_eq!(m.globals.len(), expected.len());
    for (name, kind) in expected {
        assert_eq!(m.global(name).unwrap().1.kind, kind, "{name}");
    }
}

#[test]
fn layouts_have_offsets_strides_and_places() {
    let text = "struct Inner { a: vec3<f32>, b: f32 }
struct Outer {
    count: atomic<u32>,
    @align(16) inner: Inner,
    matrix: mat3x3<f32>,
    pair: array<vec2<f32>, 3>,
    items: array<Inner>,
}
var<storage, read_write> things: Outer;
@compute @workgroup_size(1) fn main() { things.items[0].b = 1.0; }";
    let (loaded, sources) = load_text(text);
    let m = loaded.module.unwrap();
    let (_, global) = m.global("things").unwrap();
    assert_eq!(sources.snippet(global.span), "things");
    let GlobalKind::Storage { writable: true, ty } = &global.kind else { panic!("{:?}", global.kind) };
    let Type::Struct { name, members, size } = ty else { panic!("{ty:?}") };
    assert_eq!((name.as_str(), *size), ("Outer", 128));
    let offsets: Vec<(&str, u32)> = members.iter().map(|m| (&*m.name, m.offset)).collect();
    assert_eq!(offsets, [("count", 0), ("inner", 16), ("matrix", 32), ("pair", 80), ("items", 112)]);
    assert_eq!(members[0].ty, Type::Atomic(Scalar::U32));
    assert_eq!(members[2].ty, Type::Matrix { columns: 3, rows: 3, scalar: Scalar::F32 });
    assert_eq!(members[3].ty, Type::Array { element: Box::new(vec(2)), count: Some(3), stride: 8 });
    assert_eq!(sources.snippet(members[1].span), "inner: Inner");
    assert_eq!(sources.snippet(members[4].span), "items: array<Inner>");
    let (offset, stride, element) = ty.runtime_array().unwrap();
    assert_eq!((offset, stride, element.wgsl().as_str()), (112, 16, "Inner"));
    let Type::Struct { members, size: 16, .. } = element else { panic!("{element:?}") };
    assert_eq!((members[0].ty.clone(), members[1].offset, members[1].ty.clone()), (vec(3), 12, F32));
}

#[test]
fn reads_and_writes_are_told_apart() {
    let m = module(
        "var<storage, read_write> a: array<u32>; var<storage, read_write> b: array<u32>;
         var<storage, read_write> c: array<u32>; var<storage, read> d: array<u32>;
         var picture: texture_storage_2d<r32float, read_write>; var target_: texture_storage_2d<r32float, write>;
         var<uniform> n: u32; var unused: texture_2d<f32>;
         fn bump() { c[1] += n; }
         fn through() { bump(); }
         @compute @workgroup_size(1) fn main() {
             a[0] = b[0];
             through();
             let length = arrayLength(&d);
             a[1] = length;
             textureStore(picture, vec2(0), textureLoad(picture, vec2(1)));
             textureStore(target_, vec2(0), vec4(1.0));
         }",
    );
    let expected = [
        ("a", (false, true)),
        ("b", (true, false)),
        ("c", (true, true)),
        ("d", (false, false)),
        ("picture", (true, true)),
        ("target_", (false, true)),
        ("n", (true, false)),
    ];
    for (name, access) in expected {
        let used = usage(&m, "main", name);
        assert_eq!((used.read, used.write), access, "{name}");
        assert!(!used.atomic, "{name}");
    }
    assert!(!is_used(&m, "main", "unused"));
    assert_eq!(entry(&m, "main").calls, ["bump", "through"]);
}

#[test]
fn uses_through_texture_arguments_are_seen() {
    let m = module(
        "var a: texture_storage_2d<r32float, read>; var b: texture_2d<f32>; var s: sampler; var c: texture_2d<f32>;
         fn fetch(from_: texture_storage_2d<r32float, read>) -> f32 { return textureLoad(from_, vec2(0)).x; }
         fn take(from_: texture_2d<f32>, by: sampler) -> f32 {
             return textureSampleLevel(from_, by, vec2(0.5), 0.0).x;
         }
         fn width(t: texture_2d<f32>) -> u32 { return textureDimensions(t).x; }
         @compute @workgroup_size(1) fn main() { let x = fetch(a) + take(b, s) + f32(width(c)); }",
    );
    assert_eq!(flags(usage(&m, "main", "a")), (true, false, false, false));
    assert_eq!(flags(usage(&m, "main", "b")), (true, false, false, false));
    assert_eq!(flags(usage(&m, "main", "c")), (false, false, false, false), "only its size is asked for");
    let index = |name| m.global(name).unwrap().0;
    assert_eq!(entry(&m, "main").sampled, [(index("b"), index("s"))]);
}

#[test]
fn atomics_tell_whether_their_order_shows() {
    let m = module(
        "var<storage, read_write> sum: atomic<u32>; var<storage, read_write> slot: atomic<u32>;
         var<storage, read_write> loaded: atomic<u32>; var<storage, read_write> both: atomic<u32>;
         var<storage, read_write> stored: atomic<u32>; var<storage, read_write> dropped: atomic<u32>;
         var<storage, read_write> swapped: atomic<u32>; var<storage, read_write> out: array<u32>;
         fn take() -> u32 { return atomicAdd(&slot, 1u); }
         @compute @workgroup_size(1) fn main() {
             atomicAdd(&sum, 1u);
             out[take()] = atomicLoad(&loaded);
             atomicMax(&both, 3u);
             out[1] = atomicLoad(&both);
             atomicStore(&stored, 0u);
             _ = atomicAdd(&dropped, 1u);
             atomicCompareExchangeWeak(&swapped, 0u, 1u);
         }",
    );
    let expected = [
        ("sum", (true, true, true, false)),
        ("slot", (true, true, true, true)),
        ("loaded", (true, false, true, false)),
        ("both", (true, true, true, true)),
        ("stored", (false, true, true, false)),
        ("dropped", (true, true, true, false)),
        ("swapped", (true, true, true, true)),
        ("out", (false, true, false, false)),
    ];
    for (name, expected) in expected {
        assert_eq!(flags(usage(&m, "main", name)), expected, "{name}: (read, write, atomic, result)");
    }
}

#[test]
fn workgroup_sizes_follow_overrides() {
    let m = module(
        "override wide: u32 = 32u; override tall: u32; @id(7) override deep: u32 = 1u; override flag: bool = false;
         @compute @workgroup_size(wide * 2u, tall, deep) fn sized() {}
         @compute @workgroup_size(8, 4) fn fixed() {}",
    );
    let keys: Vec<(&str, &str, Option<Scalar>, bool)> =
        m.overrides.iter().map(|o| (o.name.as_str(), o.key.as_str(), o.scalar, o.has_default)).collect();
    let u32_ = Some(Scalar::U32);
    assert_eq!(
        keys,
        [
            ("wide", "wide", u32_, true),
            ("tall", "tall", u32_, false),
            ("deep", "7", u32_, true),
            ("flag", "flag", None, true)
        ]
    );
    let (sized, fixed) = (entry(&m, "sized"), entry(&m, "fixed"));
    let given = |pairs: &[(&str, f64)]| pairs.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect::<Vec<_>>();
    assert_eq!(m.workgroup_size(fixed, &[]), Ok([8, 4, 1]));
    assert_eq!(m.workgroup_size(sized, &given(&[("tall", 3.0)])), Ok([64, 3, 1]));
    assert_eq!(m.workgroup_size(sized, &given(&[("tall", 3.0), ("wide", 8.0), ("7", 2.0)])), Ok([16, 3, 2]));
    let missing = m.workgroup_size(sized, &[]).unwrap_err();
    assert!(missing.contains("tall"), "{missing}");
    m.workgroup_size(sized, &given(&[("tall", 0.0)])).unwrap_err();
    m.workgroup_size(sized, &given(&[("tall", 1.0), ("unknown", 0.0)])).unwrap_err();
}

#[test]
fn interfaces_of_stages() {
    let text = "struct Between { @builtin(position) at: vec4<f32>, @location(0) uv: vec2<f32>,
    @location(2) @interpolate(flat) id: u32 }
struct Out { @location(1) color: vec4<f32>, @builtin(frag_depth) depth: f32, @location(0) z: f32 }
@vertex fn vertex(@location(3) position: vec3<f32>, @builtin(vertex_index) i: u32) -> Between {
    return Between(vec4(position, 1.0), vec2(0.0), i);
}
@fragment fn rich(in: Between, @builtin(front_facing) front: bool) -> Out {
    if !front { discard; }
    return Out(vec4(in.uv, 0.0, 1.0), 0.5, 1.0);
}
fn cut(x: f32) { if x < 0.5 { discard; } }
fn maybe(x: f32) { cut(x); }
@fragment fn plain(@location(0) uv: vec2<f32>) -> @location(0) vec4<f32> { maybe(uv.x); return vec4(1.0); }
@fragment fn depth_only(@location(0) uv: vec2<f32>) -> @builtin(frag_depth) f32 { return uv.x; }
@fragment fn nothing() {}";
    let (loaded, sources) = load_text(text);
    let m = loaded.module.unwrap();
    let stages: Vec<(&str, Stage)> = m.entries.iter().map(|e| (e.name.as_str(), e.stage)).collect();
    let f = Stage::Fragment;
    let expected = [("vertex", Stage::Vertex), ("rich", f), ("plain", f), ("depth_only", f), ("nothing", f)];
    assert_eq!(stages, expected);

    let vertex = entry(&m, "vertex");
    let io = |io: &[meniscus::shader::reflect::Io]| -> Vec<(u32, String, String, String)> {
        io.iter().map(|i| (i.location, i.name.clone(), i.ty.wgsl(), sources.snippet(i.span).to_owned())).collect()
    };
    let line = |l: u32, name: &str, ty: &str, span: &str| (l, name.to_owned(), ty.to_owned(), span.to_owned());
    assert_eq!(io(&vertex.inputs), [line(3, "position", "vec3<f32>", "position: vec3<f32>")]);
    let between = [line(0, "uv", "vec2<f32>", "uv: vec2<f32>"), line(2, "id", "u32", "id: u32")];
    assert_eq!(io(&vertex.outputs), between);
    assert_eq!(sources.snippet(vertex.span), "vertex");

    let rich = entry(&m, "rich");
    assert_eq!(io(&rich.inputs), between);
    assert_eq!(io(&rich.outputs), [line(1, "color", "vec4<f32>", "color: vec4<f32>"), line(0, "z", "f32", "z: f32")]);
    assert!(rich.discards && rich.writes_frag_depth);

    let plain = entry(&m, "plain");
    assert_eq!(io(&plain.outputs), [line(0, "", "vec4<f32>", "@location(0) vec4<f32>")]);
    assert!(plain.discards && !plain.writes_frag_depth);
    assert_eq!(plain.calls, ["cut", "maybe"]);
    assert!(entry(&m, "depth_only").writes_frag_depth && entry(&m, "depth_only").outputs.is_empty());
    assert!(!entry(&m, "nothing").discards);
}

#[test]
fn pairs_of_textures_and_samplers() {
    let m = module(
        "var a: texture_2d<f32>; var b: texture_2d<f32>; var s: sampler; var t: sampler; var c: texture_2d<f32>;
         @fragment fn f() -> @location(0) vec4<f32> {
             let p = textureSample(b, t, vec2(0.0)) + textureSample(a, s, vec2(0.0)) + textureSample(a, t, vec2(0.0));
             return p + textureLoad(c, vec2(0), 0);
         }",
    );
    assert_eq!(entry(&m, "f").sampled, [(0, 2), (0, 3), (1, 3)]);
}

#[test]
fn workgroup_memory_counts_what_the_entry_uses() {
    let m = module(
        "var<workgroup> a: array<f32, 65>; var<workgroup> b: u32; var<workgroup> c: array<vec3<f32>, 100>;
         var<storage, read_write> out: array<f32>;
         @compute @workgroup_size(64) fn one() { a[0] = 1.0; b = 2u; out[0] = a[0] + f32(b); }
         @compute @workgroup_size(64) fn none() { out[0] = 1.0; }
         @compute @workgroup_size(64) fn other() { out[0] = c[1].x; }",
    );
    // 260 bytes round up to 272, 4 to 16.
    assert_eq!(entry(&m, "one").workgroup_memory, 272 + 16);
    assert_eq!(entry(&m, "none").workgroup_memory, 0);
    assert_eq!(entry(&m, "other").workgroup_memory, 1600);
}

#[test]
fn workgroup_memory_follows_overrides() {
    let m = module(
        "override n: u32 = 100u; var<workgroup> a: array<f32, n * 2u>; var<workgroup> b: array<u32, 3>;
         @compute @workgroup_size(64) fn both() { a[0] = 1.0; b[0] = 2u; }
         @compute @workgroup_size(64) fn none() { }
         @compute @workgroup_size(64) fn fixed() { b[0] = 2u; }",
    );
    let given = |n: f64| vec![("n".to_owned(), n)];
    assert_eq!(m.workgroup_memory(entry(&m, "both"), &[]), Ok(800 + 16));
    assert_eq!(m.workgroup_memory(entry(&m, "both"), &given(5.0)), Ok(48 + 16));
    assert_eq!(m.workgroup_memory(entry(&m, "none"), &given(5.0)), Ok(0));
    assert_eq!(m.workgroup_memory(entry(&m, "fixed"), &given(5.0)), Ok(16));
    m.workgroup_memory(entry(&m, "both"), &given(-1.0)).unwrap_err();
}

#[test]
fn features_are_the_fewest_that_suffice() {
    let of = |text: &str| module(text).entries[0].features;
    let main = |body: &str| format!("@compute @workgroup_size(64) fn main() {{ {body} }}");
    assert_eq!(of(&main("")), Features::empty());
    assert_eq!(of(&format!("enable f16; {}", main("var a: f16 = 1.0h; a += a;"))), Features::SHADER_F16);
    let atomic = "var<storage, read_write> x: atomic<u64>;";
    assert_eq!(
        of(&format!("{atomic} {}", main("atomicMax(&x, 1lu);"))),
        Features::SHADER_INT64 | Features::SHADER_INT64_ATOMIC_MIN_MAX
    );
    assert_eq!(
        of(&format!("{atomic} {}", main("atomicAdd(&x, 1lu);"))),
        Features::SHADER_INT64 | Features::SHADER_INT64_ATOMIC_ALL_OPS
    );
    let float = "var<storage, read_write> x: atomic<f32>;";
    assert_eq!(of(&format!("{float} {}", main("atomicAdd(&x, 1.0);"))), Features::SHADER_FLOAT32_ATOMIC);
    let texture = "var x: texture_storage_2d<r32uint, atomic>;";
    assert_eq!(of(&format!("{texture} {}", main("textureAtomicMax(x, vec2(0), 1u);"))), Features::TEXTURE_ATOMIC);
    assert_eq!(of(&main("let a = subgroupAdd(1u);")), Features::SUBGROUP);
    assert_eq!(of(&format!("enable subgroups; {}", main("let a = subgroupAdd(1u);"))), Features::SUBGROUP);
    assert_eq!(
        of(&format!("enable f16, subgroups; {}", main("let a = subgroupAdd(1.0h);"))),
        Features::SUBGROUP | Features::SHADER_F16
    );
    assert_eq!(of(&format!("enable subgroups, f16; {}", main("var a = 1.0h; a += a;"))), Features::SHADER_F16);
}

#[test]
fn entry_points_count_in_the_named_file_only() {
    let files = MemoryFiles::default()
        .with("main.wgsl", "#import \"lib.wgsl\"\n@compute @workgroup_size(1) fn main() { out[0] = two(); }")
        .with("lib.wgsl", "var<storage, read_write> out: array<f32>; fn two() -> f32 { return 2.0; }\n@compute @workgroup_size(1) fn other() {}");
    let (loaded, sources) = load_files(files);
    let m = loaded.module.unwrap();
    assert_eq!(m.entries.iter().map(|e| e.name.as_str()).collect::<Vec<_>>(), ["main"]);
    assert_eq!(m.entries[0].calls, ["two"]);
    let span = m.global("out").unwrap().1.span;
    assert_eq!((sources.path(span.file), sources.snippet(span)), ("lib.wgsl", "out"));
}

#[test]
fn equal_texts_have_equal_hashes() {
    let text = "@compute @workgroup_size(1) fn main() {}";
    assert_eq!(module(text).hash, module(text).hash);
    assert_ne!(module(text).hash, module(&format!("{text} ")).hash);
}
