//! Cutting polygons into triangles.

use glam::{DVec2, DVec3, Vec3};

/// Polygons of more corners are cut as a fan, since looking for ears takes time that grows with
/// the cube of their number.
const MOST_FOR_EARS: usize = 64;

/// The triangles of a polygon, by the numbers of its corners. Concave polygons are cut along
/// diagonals inside them; those that cross themselves give some triangles.
pub(super) fn triangulate(corners: &[Vec3]) -> Vec<[usize; 3]> {
    match corners.len() {
        0..=2 => Vec::new(),
        3 => vec![[0, 1, 2]],
        4 => quad(corners),
        count if count <= MOST_FOR_EARS => ears(&flat(corners)).unwrap_or_else(|| fan(count)),
        count => fan(count),
    }
}

fn fan(count: usize) -> Vec<[usize; 3]> {
    (2..count).map(|at| [0, at - 1, at]).collect()
}

/// Cut at a corner that points inwards if there is one, else along the shorter diagonal.
fn quad(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let points = flat(corners);
    let reflex = (0..4).find(|&at| turn(points[(at + 3) % 4], points[at], points[(at + 1) % 4]) < 0.0);
    let is_second = match reflex {
        Some(at) => at % 2 == 1,
        None => corners[1].distance_squared(corners[3]) < corners[0].distance_squared(corners[2]),
    };
    if is_second { vec![[0, 1, 3], [1, 2, 3]] } else { vec![[0, 1, 2], [0, 2, 3]] }
}

/// The polygon as it is seen along its normal, counter-clockwise.
fn flat(corners: &[Vec3]) -> Vec<DVec2> {
    let points: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3()).collect();
    let pairs = points.iter().zip(points.iter().cycle().skip(1));
    let normal: DVec3 = pairs.map(|(a, b)| (*a - points[0]).cross(*b - points[0])).sum();
    let axis = (normal / normal.abs().max_element()).try_normalize().unwrap_or(DVec3::Z);
    let (right, up) = axis.any_orthonormal_pair();
    points.iter().map(|point| DVec2::new(right.dot(*point), up.dot(*point))).collect()
}

/// Positive for a turn to the left at `b`.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

/// Cuts off one corner after the other whose triangle holds no other corner; none if no such
/// corner is left, as in polygons that cross themselves.
fn ears(points: &[DVec2]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len() - 2);
    let mut start = 0;
    while left.len() > 3 {
        let count = left.len();
        // Going on behind the last ear spreads the cuts, which makes fewer thin triangles.
        let ear = (0..count).map(|step| (start + step) % count).find(|&at| is_ear(points, &left, at))?;
        triangles.push([left[(ear + count - 1) % count], left[ear], left[(ear + 1) % count]]);
        left.remove(ear);
        start = ear;
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
}

fn is_ear(points: &[DVec2], left: &[usize], at: usize) -> bool {
    let count = left.len();
    let [a, b, c] = [(at + count - 1) % count, at, (at + 1) % count].map(|corner| points[left[corner]]);
    if turn(a, b, c) < 0.0 {
        return false;
    }
    let inside = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    !left.iter().map(|index| points[*index]).any(|p| p != a && p != b && p != c && inside(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> f32 {
        let one = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|corner| corners[corner]);
            (b - a).cross(c - a).z / 2.0
        };
        // Triangles that are turned over would take from the sum.
        assert!(triangles.iter().all(|t| one(t) >= -1e-6), "{triangles:?}");
        triangles.iter().map(one).sum()
    }

    fn outline(points: &[(f32, f32)]) -> Vec<Vec3> {
        points.iter().map(|(x, y)| Vec3::new(*x, *y, 0.0)).collect()
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        let arrow = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (0.5, 1.0)];
        let comb = [
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 3.0),
            (4.0, 3.0),
            (4.0, 1.0),
            (3.0, 1.0),
            (3.0, 3.0),
            (2.0, 3.0),
            (2.0, 1.0),
            (0.0, 1.0),
        ];
        for (points, expected) in [(&arrow[..], 1.5), (&comb[..], 9.0)] {
            for shift in 0..points.len() {
                let mut turned = points.to_vec();
                turned.rotate_left(shift);
                let corners = outline(&turned);
                let triangles = triangulate(&corners);
                assert_eq!(triangles.len(), points.len() - 2);
                assert!((area(&corners, &triangles) - expected).abs() < 1e-5, "{shift}: {triangles:?}");
            }
        }
    }

    #[test]
    fn fifty_corners_and_more_become_triangles() {
        for count in [50, 64, 65, 400] {
            let at = |k: usize| k as f32 / count as f32 * std::f32::consts::TAU;
            let points: Vec<(f32, f32)> = (0..count).map(|k| (at(k).cos(), at(k).sin())).collect();
            let corners = outline(&points);
            let triangles = triangulate(&corners);
            let expected = count as f32 / 2.0 * at(1).sin();
            assert_eq!(triangles.len(), count - 2);
            assert!((area(&corners, &triangles) - expected).abs() < 1e-4, "{count}");
        }
    }

    #[test]
    fn polygons_that_are_none_do_no_harm() {
        assert!(triangulate(&[]).is_empty());
        assert_eq!(triangulate(&[Vec3::ZERO; 6]).len(), 4);
        assert_eq!(triangulate(&[Vec3::MAX, Vec3::MIN, Vec3::MAX, Vec3::ZERO, Vec3::MIN]).len(), 3);
        let bow = outline(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (0.5, 3.0)]);
        assert_eq!(triangulate(&bow).len(), 3);
    }
}
