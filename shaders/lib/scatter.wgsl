// Numbers without order that are the same in each run, from whole numbers (PCG, Jarzynski and Olano 2020).

fn scrambled(v: vec3u) -> vec3u {
    var x = v * 1664525u + 1013904223u;
    x.x += x.y * x.z;
    x.y += x.z * x.x;
    x.z += x.x * x.y;
    x ^= x >> vec3u(16u);
    x.x += x.y * x.z;
    x.y += x.z * x.x;
    x.z += x.x * x.y;
    return x;
}

/// Three numbers in [0, 1).
fn scattered(v: vec3u) -> vec3f {
    return vec3f(scrambled(v) >> vec3u(8u)) / 16777216.0;
}
