//! A plan as a drawing: passes and resources are nodes in rows, from top to bottom as one hangs on the
//! other. Plain numbers, so that it is tested without a window.

use std::collections::BTreeMap;

use crate::plan::model::{ObjectId, ObjectRef, Origin, Plan};

/// Width and height of a node, and the room between neighbours and between rows.
pub const NODE: [f32; 2] = [164.0, 32.0];
const GAP: [f32; 2] = [20.0, 16.0];
/// How often nodes are moved towards those that they hang on.
const SWEEPS: usize = 24;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// Index into the plan's.
    Pass(usize),
    /// Of a ring, its first object.
    Object(ObjectId),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub item: Item,
    pub row: usize,
    /// Its middle.
    pub at: [f32; 2],
}

/// What joins a pass and a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// From the resource to the pass.
    Reads,
    /// From the pass to the resource, which has nothing before.
    Makes,
    /// From the resource to a pass that goes on writing it.
    GoesOn,
    /// From the pass back to the state that it makes for the next step.
    Returns,
}

/// By index of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub how: How,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    pub nodes: Vec<Node>,
    pub edges: Vec<Edge>,
    /// From 0, 0.
    pub size: [f32; 2],
}

/// What a pass does with an object.
#[derive(Clone, Copy, Debug, Default)]
struct Touch {
    reads: bool,
    writes: bool,
}

impl Drawing {
    pub fn of(plan: &Plan) -> Self {
        let touches: Vec<BTreeMap<ObjectId, Touch>> = (0..plan.passes.len()).map(|pass| touched(plan, pass)).collect();
        let rows = rows(plan, &touches);
        let mut nodes: Vec<Node> =
            rows.iter().map(|(item, row)| Node { item: *item, row: *row, at: [0.0; 2] }).collect();
        let index: BTreeMap<Item, usize> = nodes.iter().enumerate().map(|(at, node)| (node.item, at)).collect();
        let mut edges = Vec::new();
        for (pass, touched) in touches.iter().enumerate() {
            for (object, touch) in touched {
                let (pass, object) = (index[&Item::Pass(pass)], index[&Item::Object(*object)]);
                let is_made_here = nodes[object].row == nodes[pass].row + 1 && touch.writes;
                let is_before = nodes[object].row < nodes[pass].row;
                match (is_before, touch.writes) {
                    (false, _) if is_made_here => edges.push(Edge { from: pass, to: object, how: How::Makes }),
                    (true, false) => edges.push(Edge { from: object, to: pass, how: How::Reads }),
                    (true, true) if is_state(plan, nodes[object].item) => {
                        if touch.reads {
                            edges.push(Edge { from: object, to: pass, how: How::Reads });
                        }
                        edges.push(Edge { from: pass, to: object, how: How::Returns });
                    }
                    (true, true) => edges.push(Edge { from: object, to: pass, how: How::GoesOn }),
                    (false, _) => edges.push(Edge { from: pass, to: object, how: How::Returns }),
                }
            }
        }
        place(&mut nodes, &edges);
        let end = |axis: usize| nodes.iter().map(|n| n.at[axis] + NODE[axis] * 0.5).fold(0.0, f32::max);
        let size = [end(0), end(1)];
        Self { nodes, edges, size }
    }

    /// The node at a place.
    pub fn hit(&self, at: [f32; 2]) -> Option<usize> {
        let within = |node: &Node| (0..2).all(|axis| (node.at[axis] - at[axis]).abs() <= NODE[axis] * 0.5);
        self.nodes.iter().position(within)
    }

    /// The nodes that edges join with this one.
    pub fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> {
        self.edges.iter().filter_map(move |edge| match (edge.from == node, edge.to == node) {
            (true, _) => Some(edge.to),
            (_, true) => Some(edge.from),
            _ => None,
        })
    }
}

fn touched(plan: &Plan, pass: usize) -> BTreeMap<ObjectId, Touch> {
    let mut found: BTreeMap<ObjectId, Touch> = BTreeMap::new();
    for access in &plan.passes[pass].accesses {
        let object = match access.object {
            ObjectRef::Fixed(id) => Some(id),
            ObjectRef::Ring { ring, .. } => plan.rings.get(ring).and_then(|ring| ring.objects.first()).copied(),
        };
        if let Some(object) = object {
            let touch = found.entry(object).or_default();
            touch.reads |= access.read;
            touch.writes |= access.write;
        }
    }
    found
}

fn is_state(plan: &Plan, item: Item) -> bool {
    matches!(item, Item::Object(id) if matches!(plan.objects[id].origin, Origin::State(_)))
}

/// Whether an object is there before any pass runs.
fn is_source(plan: &Plan, object: ObjectId) -> bool {
    plan.objects[object].origin != Origin::Frame
}

/// A row for each node: passes in odd ones, behind all that they need; resources right behind the pass
/// that makes them. What needs nothing stands right before who needs it.
fn rows(plan: &Plan, touches: &[BTreeMap<ObjectId, Touch>]) -> BTreeMap<Item, usize> {
    // Of each object, where it was written and where it was touched last.
    let mut written: BTreeMap<ObjectId, usize> = BTreeMap::new();
    let mut touched_last: BTreeMap<ObjectId, usize> = BTreeMap::new();
    let mut passes = vec![1; touches.len()];
    for (pass, touched) in touches.iter().enumerate() {
        let before = touched.iter().filter_map(|(object, touch)| match touch.writes {
            true => touched_last.get(object),
            false => written.get(object),
        });
        passes[pass] = before.max().map_or(1, |row| row + 2);
        for (object, touch) in touched {
            let last = touched_last.entry(*object).or_default();
            *last = passes[pass].max(*last);
            if touch.writes {
                written.insert(*object, passes[pass]);
            }
        }
    }
    for pass in (0..touches.len()).rev() {
        let later = (pass + 1..touches.len()).filter(|other| must_follow(&touches[pass], &touches[*other]));
        if let Some(next) = later.map(|other| passes[other]).min() {
            passes[pass] = passes[pass].max(next - 2);
        }
    }
    let mut rows: BTreeMap<Item, usize> =
        passes.iter().enumerate().map(|(pass, row)| (Item::Pass(pass), *row)).collect();
    for object in touches.iter().flat_map(BTreeMap::keys) {
        let of = |wanted: &dyn Fn(&Touch) -> bool| {
            let touching = touches.iter().zip(&passes).filter(|(t, _)| t.get(object).is_some_and(wanted));
            touching.map(|(_, row)| *row).min()
        };
        let row = match is_source(plan, *object) {
            true => of(&|_| true).map_or(0, |first| first - 1),
            // Nothing of a frame is read before it is written.
            false => of(&|touch| touch.writes).map_or(0, |first| first + 1),
        };
        rows.insert(Item::Object(*object), row);
    }
    rows
}

/// Whether two passes may not change places.
fn must_follow(first: &BTreeMap<ObjectId, Touch>, second: &BTreeMap<ObjectId, Touch>) -> bool {
    first.iter().any(|(object, a)| second.get(object).is_some_and(|b| a.writes || b.writes))
}

/// Across: each node near those that it hangs on, none over another.
fn place(nodes: &mut [Node], edges: &[Edge]) {
    let mut by_row: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (at, node) in nodes.iter_mut().enumerate() {
        let row = by_row.entry(node.row).or_default();
        node.at = [row.len() as f32 * (NODE[0] + GAP[0]), 0.0];
        row.push(at);
    }
    // Rows in which nothing stands take no room.
    for (row, members) in by_row.values().enumerate() {
        let y = NODE[1] * 0.5 + row as f32 * (NODE[1] + GAP[1]);
        members.iter().for_each(|node| nodes[*node].at[1] = y);
    }
    let mut joined: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for edge in edges {
        joined[edge.from].push(edge.to);
        joined[edge.to].push(edge.from);
    }
    let order: Vec<usize> = by_row.keys().copied().collect();
    for sweep in 0..SWEEPS {
        for turn in 0..order.len() {
            let row = if sweep % 2 == 0 { order[turn] } else { order[order.len() - 1 - turn] };
            let members = &by_row[&row];
            let mut wanted: Vec<(f32, usize)> = members
                .iter()
                .map(|node| {
                    let all = &joined[*node];
                    let sum: f32 = all.iter().map(|other| nodes[*other].at[0]).sum();
                    (if all.is_empty() { nodes[*node].at[0] } else { sum / all.len() as f32 }, *node)
                })
                .collect();
            wanted.sort_by(|a, b| a.0.total_cmp(&b.0).then(nodes[a.1].item.cmp(&nodes[b.1].item)));
            for (x, (_, node)) in spread(&wanted).into_iter().zip(&wanted) {
                nodes[*node].at[0] = x;
            }
        }
    }
    let left = nodes.iter().map(|node| node.at[0]).fold(f32::INFINITY, f32::min);
    nodes.iter_mut().for_each(|node| node.at[0] += NODE[0] * 0.5 - left);
}

/// Places as near to the wanted ones as they can be without touching, on the whole neither more to the left nor
/// to the right.
fn spread(wanted: &[(f32, usize)]) -> Vec<f32> {
    let step = NODE[0] + GAP[0];
    let mut places: Vec<f32> = Vec::with_capacity(wanted.len());
    for (x, _) in wanted {
        let least = places.last().map_or(f32::NEG_INFINITY, |last| last + step);
        places.push(x.max(least));
    }
    let count = wanted.len().max(1) as f32;
    let shift = wanted.iter().zip(&places).map(|((want, _), x)| want - x).sum::<f32>() / count;
    places.iter().map(|x| x + shift).collect()
}
