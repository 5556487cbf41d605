//! The neighbour grid by hand: which cell each particle lies in, and who is within reach of whom.

use std::collections::HashMap;

/// Numbers of cells along x, y, z, as `graphs/parts/neighbour_grid.ron` derives them.
pub fn sizes(count: usize, min: [f32; 3], max: [f32; 3], cell_size: f64) -> [u32; 3] {
    let wanted = |k: usize| ((f64::from(max[k]) - f64::from(min[k])) / cell_size).min(100_000.0).floor() + 3.0;
    let most = (8.0 * count as f64).clamp(65_536.0, 16_777_216.0);
    let columns = wanted(0).clamp(4.0, 512.0);
    let rows = wanted(1).min((most / (columns * 16.0)).floor()).max(4.0);
    let slices = wanted(2).min((most / (columns * rows)).floor()).max(4.0);
    [columns as u32, rows as u32, slices as u32]
}

/// The key of each particle's cell, in 32-bit floats like the shader, since a rounding decides on which side a point lies.
pub fn keys(positions: &[[f32; 3]], min: [f32; 3], cell_size: f32, sizes: [u32; 3]) -> Vec<u32> {
    let cell = |p: f32, low: f32| ((p - low) / cell_size).floor().clamp(0.0, 2.0e9) as u32 + 1;
    let key = |p: &[f32; 3]| {
        let at = [0, 1, 2].map(|k| cell(p[k], min[k]) % sizes[k]);
        (at[2] * sizes[1] + at[1]) * sizes[0] + at[0]
    };
    positions.iter().map(key).collect()
}

/// All particles nearer than `reach` to each one, itself left out, with the offset to them.
pub fn neighbours(positions: &[[f32; 3]], reach: f64) -> Vec<Vec<(usize, [f64; 3])>> {
    let cell = |p: &[f32; 3]| p.map(|x| (f64::from(x) / reach).floor() as i64);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for (i, p) in positions.iter().enumerate() {
        cells.entry(cell(p)).or_default().push(i);
    }
    let around = |i: usize| {
        let p = positions[i];
        let middle = cell(&p);
        let mut found = Vec::new();
        for step in 0..27 {
            let at = [middle[0] + step % 3 - 1, middle[1] + step / 3 % 3 - 1, middle[2] + step / 9 - 1];
            for &j in cells.get(&at).into_iter().flatten() {
                let offset = [0, 1, 2].map(|k| f64::from(positions[j][k]) - f64::from(p[k]));
                if j != i && offset.iter().map(|x| x * x).sum::<f64>() < reach * reach {
                    found.push((j, offset));
                }
            }
        }
        found
    };
    (0..positions.len()).map(around).collect()
}
