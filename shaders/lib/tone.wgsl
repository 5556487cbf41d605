// Tone curves from scene-linear light to linear light in [0, 1].

/// Troy Sobotka's AgX, in Benjamin Wrensch's polynomial form, with a mild look: some contrast and saturation.
fn agx(color: vec3f) -> vec3f {
    let inset = mat3x3f(
        0.842479062253094, 0.0423282422610123, 0.0423756549057051,
        0.0784335999999992, 0.878468636469772, 0.0784336,
        0.0792237451477643, 0.0791661274605434, 0.879142973793104,
    );
    let outset = mat3x3f(
        1.19687900512017, -0.0528968517574562, -0.0529716355144438,
        -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
        -0.0990297440797205, -0.0989611768448433, 1.15107367264116,
    );
    let lowest = -12.47393;
    let highest = 4.026069;
    let stops = clamp(log2(max(inset * max(color, vec3f(0.0)), vec3f(1.0e-10))), vec3f(lowest), vec3f(highest));
    let x = (stops - lowest) / (highest - lowest);
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    let contrast = pow(max(curve, vec3f(0.0)), vec3f(1.2));
    let grey = dot(contrast, vec3f(0.2126, 0.7152, 0.0722));
    let look = mix(vec3f(grey), contrast, 1.3);
    // The curve gives display values; the host encodes, so back to linear light.
    return pow(clamp(outset * look, vec3f(0.0), vec3f(1.0)), vec3f(2.2));
}

/// Stephen Hill's fit of the ACES reference and output transforms.
fn aces(color: vec3f) -> vec3f {
    let inset = mat3x3f(
        0.59719, 0.07600, 0.02840,
        0.35458, 0.90834, 0.13383,
        0.04823, 0.01566, 0.83777,
    );
    let outset = mat3x3f(
        1.60475, -0.10208, -0.00327,
        -0.53108, 1.10813, -0.07276,
        -0.07367, -0.00605, 1.07602,
    );
    let x = inset * max(color, vec3f(0.0));
    let curve = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
    return clamp(outset * curve, vec3f(0.0), vec3f(1.0));
}

/// In the order of the parameter's words: agx, aces, none.
fn tone_mapped(color: vec3f, tone: u32) -> vec3f {
    switch tone {
        case 0u: { return agx(color); }
        case 1u: { return aces(color); }
        default: { return clamp(color, vec3f(0.0), vec3f(1.0)); }
    }
}
