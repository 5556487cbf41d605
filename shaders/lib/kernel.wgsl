// The density of a particle (Iwasaki et al. 2006, equation 1, after Wyvill): printed constant, exponents 6, 4 and 2.

/// The bracket of equation 1 by a² = (r / h)²: 1 in the middle, 0 from the effective radius on.
fn bracket(a_2: f32) -> f32 {
    let a = min(a_2, 1.0);
    return 1.0 + a * (-22.0 / 9.0 + a * (17.0 / 9.0 - a * (4.0 / 9.0)));
}
