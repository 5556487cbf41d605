// größe → 流体の大きさ, 🌊
@fragment fn main() -> @location(0) f32 {
    /* 流体 🌊 */ let größe = 1.0; return größ;
}
