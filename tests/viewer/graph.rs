//! The drawing of plans: of every shipped graph.

use std::collections::BTreeSet;
use std::path::Path;

use meniscus::check;
use meniscus::diagnostic::Sources;
use meniscus::files::DiskFiles;
use meniscus::plan::instantiate_stand_in;
use meniscus::plan::model::{ObjectRef, Plan};
use meniscus::program;
use meniscus::viewer::graph::{Drawing, How, Item, NODE};

fn plans() -> Vec<(String, Plan)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("graphs");
    let mut found = Vec::new();
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "ron") {
            continue;
        }
        let mut sources = Sources::new();
        let program = program::load(&DiskFiles, &mut sources, path.to_str().unwrap(), None).program.unwrap();
        found.push((path.display().to_string(), instantiate_stand_in(&program, &check::stand_in(&program)).unwrap()));
    }
    assert!(found.iter().any(|(_, plan)| plan.passes.len() > 40), "none is large");
    found
}

fn object(plan: &Plan, found: ObjectRef) -> usize {
    match found {
        ObjectRef::Fixed(id) => id,
        ObjectRef::Ring { ring, .. } => plan.rings[ring].objects[0],
    }
}

#[test]
fn each_access_is_an_edge_and_nothing_lies_over_another() {
    for (name, plan) in plans() {
        let drawing = Drawing::of(&plan);
        let mut wanted = BTreeSet::new();
        for (pass, about) in plan.passes.iter().enumerate() {
            wanted.extend(about.accesses.iter().map(|access| (pass, object(&plan, access.object))));
        }
        let item = |node: usize| drawing.nodes[node].item;
        let drawn: BTreeSet<(usize, usize)> = drawing
            .edges
            .iter()
            .map(|edge| match (item(edge.from), item(edge.to)) {
                (Item::Pass(pass), Item::Object(object)) | (Item::Object(object), Item::Pass(pass)) => (pass, object),
                other => panic!("{name}: {other:?}"),
            })
            .collect();
        assert_eq!(drawn, wanted, "{name}");

        for edge in drawing.edges.iter().filter(|edge| edge.how != How::Returns) {
            let [from, to] = [edge.from, edge.to].map(|node| drawing.nodes[node].row);
            assert!(from < to, "{name}: {:?} to {:?}", item(edge.from), item(edge.to));
        }
        for (a, one) in drawing.nodes.iter().enumerate() {
            assert_eq!(drawing.hit(one.at), Some(a), "{name}");
            for other in &drawing.nodes[a + 1..] {
                let apart = (0..2).any(|axis| (one.at[axis] - other.at[axis]).abs() > NODE[axis] + 1.0);
                assert!(apart, "{name}: {one:?} lies over {other:?}");
            }
            assert!((0..2).all(|axis| (0.0..=drawing.size[axis]).contains(&one.at[axis])), "{name}: {one:?}");
        }
    }
}

#[test]
fn passes_that_hang_on_each_other_keep_their_order() {
    for (name, plan) in plans() {
        let drawing = Drawing::of(&plan);
        let row = |pass: usize| drawing.nodes.iter().find(|node| node.item == Item::Pass(pass)).unwrap().row;
        for (b, later) in plan.passes.iter().enumerate() {
            for (a, earlier) in plan.passes[..b].iter().enumerate() {
                let meets = earlier.accesses.iter().any(|x| {
                    later
                        .accesses
                        .iter()
                        .any(|y| object(&plan, x.object) == object(&plan, y.object) && (x.write || y.write))
                });
                assert!(!meets || row(a) < row(b), "{name}: {} and {}", earlier.path, later.path);
            }
        }
    }
}
