//! A radius from the spacing of particles.
//!
//! The tree of boxes splits where the particles are, so a thin sheet, a few drops far away or
//! particles at the same place cost nothing extra, as they would with cells of one size.

/// Particles whose nearest neighbour is looked for.
const SAMPLES: usize = 2_000;
/// Particles in a box that is not split further.
const LEAF: usize = 24;
/// Particles whose middle one tells where a box is split.
const PIVOTS: usize = 31;

/// Halvings by the middle of a few. Points in an order that makes these uneven are halved by the
/// middle of all from there on, which takes longer, so that no order makes the tree deep.
const DEEPEST: usize = 64;

/// Neighbours whose room tells the spacing: enough to even out how they lie, few enough to be
/// all around a particle inside.
const NEIGHBOURS: usize = 32;

/// Half of the edge of the cube that a particle has to itself amid others, in the unit of the
/// positions. None with fewer than two distinct finite positions.
///
/// That is the radius of particles that started on a lattice of twice the radius, as solvers
/// have it; the distance to the nearest one alone would be up to a fifth less, since particles
/// come closer than the lattice while they move. Up to 2,000 particles, spread evenly over the
/// list, are asked; each searches among all. At the surface, and in thin layers,
/// neighbours are further away, so the twentieth that has them nearest counts. With few particles it is half of the median distance to the nearest.
pub fn estimate_radius(positions: &[[f32; 3]]) -> Option<f32> {
    let finite = |p: &&[f32; 3]| p.iter().all(|v| v.is_finite());
    let mut points: Vec<[f32; 3]> = positions.iter().filter(finite).copied().collect();
    let samples = points.len().min(SAMPLES);
    let asked: Vec<[f32; 3]> = (0..samples).map(|i| points[i * points.len() / samples]).collect();
    let tree = Tree::new(&mut points, DEEPEST)?;
    let enough = positions.len() >= 8 * NEIGHBOURS;
    let many = enough.then(|| points_amid(&tree, &asked, NEIGHBOURS)).flatten();
    let spacing = match many {
        Some(mut squared) => {
            let rank = squared.len() / 20;
            let (_, ranked, _) = squared.select_nth_unstable_by(rank, f64::total_cmp);
            // The ball that just reaches the last neighbour holds the particle, the others, and half of that one.
            ranked.sqrt() * (4.0 / 3.0 * std::f64::consts::PI / (NEIGHBOURS as f64 + 0.5)).cbrt()
        }
        None => {
            let mut squared = points_amid(&tree, &asked, 1)?;
            let middle = squared.len() / 2;
            let (_, median, _) = squared.select_nth_unstable_by(middle, f64::total_cmp);
            median.sqrt()
        }
    };
    let radius = (spacing * 0.5) as f32;
    (radius > 0.0 && radius.is_finite()).then_some(radius)
}

/// Squares of the distances to the `wanted`th nearest, of those points that have so many others.
fn points_amid(tree: &Tree<'_>, asked: &[[f32; 3]], wanted: usize) -> Option<Vec<f64>> {
    let all: Vec<f64> = asked.iter().map(|p| tree.furthest_of_nearest(*p, wanted)).filter(|d| d.is_finite()).collect();
    (!all.is_empty()).then_some(all)
}

/// Bounds of some points, and which they are.
struct Node {
    min: [f32; 3],
    max: [f32; 3],
    start: usize,
    end: usize,
    /// The second of the two halves; the first is the next node. None if the box is not split.
    second: Option<usize>,
}

struct Tree<'a> {
    points: &'a [[f32; 3]],
    nodes: Vec<Node>,
}

impl<'a> Tree<'a> {
    /// Sorts finite points into boxes; none without a point.
    fn new(points: &'a mut [[f32; 3]], deepest: usize) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let mut nodes = Vec::with_capacity(4 * points.len() / LEAF + 1);
        split(points, 0, &mut nodes, deepest);
        Some(Self { points, nodes })
    }

    /// The square of the distance to the `wanted`th nearest point that is elsewhere; infinite if
    /// there are not so many.
    fn furthest_of_nearest(&self, from: [f32; 3], wanted: usize) -> f64 {
        // Ascending, at most `wanted` of them.
        let mut nearest: Vec<f64> = Vec::with_capacity(wanted + 1);
        let mut best = f64::INFINITY;
        // Boxes that are still to be looked at, with their distances.
        let mut open = vec![(0.0, 0)];
        while let Some((distance, index)) = open.pop() {
            if distance >= best {
                continue;
            }
            let node = &self.nodes[index];
            let Some(second) = node.second else {
                for &point in &self.points[node.start..node.end] {
                    let squared = squared(from, point);
                    if squared > 0.0 && squared < best {
                        nearest.insert(nearest.partition_point(|d| *d < squared), squared);
                        nearest.truncate(wanted);
                        best = if nearest.len() == wanted { nearest[wanted - 1] } else { best };
                    }
                }
                continue;
            };
            let near = (self.nodes[index + 1].squared(from), index + 1);
            let far = (self.nodes[second].squared(from), second);
            let (near, far) = if near.0 <= far.0 { (near, far) } else { (far, near) };
            open.extend([far, near]);
        }
        best
    }
}

impl Node {
    fn squared(&self, from: [f32; 3]) -> f64 {
        squared(from, std::array::from_fn(|axis| from[axis].clamp(self.min[axis], self.max[axis])))
    }
}

fn squared(a: [f32; 3], b: [f32; 3]) -> f64 {
    let along = |axis: usize| f64::from(a[axis]) - f64::from(b[axis]);
    let (x, y, z) = (along(0), along(1), along(2));
    x * x + y * y + z * z
}

/// Appends the boxes of `points`, of which `start` others are before them. `few` more halvings are by
/// the middle of a few.
fn split(points: &mut [[f32; 3]], start: usize, nodes: &mut Vec<Node>, few: usize) {
    let (min, max) = bounds(points);
    let this = nodes.len();
    let same_place = min == max;
    let kept = if same_place && points.len() > LEAF { 1 } else { points.len() };
    nodes.push(Node { min, max, start, end: start + kept, second: None });
    if same_place || points.len() <= LEAF {
        return;
    }
    let axis = widest(min, max);
    let middle = if few > 0 { partition(points, axis, min[axis], max[axis]) } else { halve(points, axis) };
    let few = few.saturating_sub(1);
    let (first, second) = points.split_at_mut(middle);
    split(first, start, nodes, few);
    nodes[this].second = Some(nodes.len());
    split(second, start + middle, nodes, few);
}

fn bounds(points: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let mut min = [f32::INFINITY; 3];
    let mut max = [f32::NEG_INFINITY; 3];
    for point in points {
        for axis in 0..3 {
            min[axis] = if point[axis] < min[axis] { point[axis] } else { min[axis] };
            max[axis] = if point[axis] > max[axis] { point[axis] } else { max[axis] };
        }
    }
    (min, max)
}

fn widest(min: [f32; 3], max: [f32; 3]) -> usize {
    let extent = |axis: usize| f64::from(max[axis]) - f64::from(min[axis]);
    let wider = if extent(1) > extent(0) { 1 } else { 0 };
    if extent(2) > extent(wider) { 2 } else { wider }
}

/// Moves the lower points of an axis along which they differ to the front; how many those are,
/// at least one and not all.
fn partition(points: &mut [[f32; 3]], axis: usize, min: f32, max: f32) -> usize {
    let count = points.len();
    let mut pivots: [f32; PIVOTS] = std::array::from_fn(|i| points[i * count / PIVOTS][axis]);
    let (_, &mut pivot, _) = pivots.select_nth_unstable_by(PIVOTS / 2, f32::total_cmp);
    // Points that do not exceed the highest but one value make a half that is not all of them.
    let pivot = if pivot < max { pivot } else { ((f64::from(min) + f64::from(max)) / 2.0) as f32 };
    let pivot = if pivot < max { pivot } else { min };
    let mut front = 0;
    for at in 0..count {
        let lower = points[at][axis] <= pivot;
        points.swap(at, front);
        front += usize::from(lower);
    }
    front
}

/// Moves the lower half along an axis to the front; how many that is.
fn halve(points: &mut [[f32; 3]], axis: usize) -> usize {
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a line in an order in which each halving cuts off only 16 of them: where it looks
    /// for a middle, the 16 lowest of all stand.
    fn worst_order(count: usize) -> Vec<[f32; 3]> {
        let mut places: Vec<usize> = (0..count).collect();
        let mut points = vec![[f32::MAX, 0.0, 0.0]; count];
        let mut next = 0.0;
        let mut rest = places.as_mut_slice();
        while rest.len() > 4 * PIVOTS {
            let count = rest.len();
            for at in (0..=PIVOTS / 2).map(|i| i * count / PIVOTS) {
                points[rest[at]][0] = next;
                next += 1.0;
            }
            // As a partition moves them.
            let mut front = 0;
            for at in 0..rest.len() {
                let is_lower = points[rest[at]][0] < next;
                rest.swap(at, front);
                front += usize::from(is_lower);
            }
            rest = &mut rest[front..];
        }
        for &place in rest.iter() {
            points[place][0] = next;
            next += 1.0;
        }
        points
    }

    fn depth(tree: &Tree<'_>) -> usize {
        let mut deepest = 0;
        let mut open = vec![(0, 1)];
        while let Some((index, depth)) = open.pop() {
            deepest = deepest.max(depth);
            open.extend(tree.nodes[index].second.into_iter().flat_map(|n| [(index + 1, depth + 1), (n, depth + 1)]));
        }
        deepest
    }

    #[test]
    fn no_order_makes_the_tree_deep() {
        let mut points = worst_order(16_000);
        let boundless = depth(&Tree::new(&mut points.clone(), usize::MAX).expect("points"));
        assert!(boundless > 900, "the order is none of the worst: {boundless}");
        let bounded = depth(&Tree::new(&mut points, DEEPEST).expect("points"));
        assert!(bounded <= DEEPEST + 12, "{bounded}");
        // Points on a line, one apart: of those inside, 16 on either side.
        let radius = estimate_radius(&worst_order(16_000)).expect("a radius");
        let mut sorted: Vec<[f32; 3]> = (0..16_000_u16).map(|x| [f32::from(x), 0.0, 0.0]).collect();
        assert_eq!(Some(radius), estimate_radius(&sorted));
        sorted.reverse();
        assert_eq!(Some(radius), estimate_radius(&sorted));
    }
}
