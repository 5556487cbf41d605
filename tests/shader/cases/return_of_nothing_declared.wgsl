fn f(x: f32) {
    return x;
}
@fragment fn main() { f(1.0); }
