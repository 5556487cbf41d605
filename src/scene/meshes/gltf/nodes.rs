//! The tree of nodes of a glTF file, and the cameras and lights that stand in it.

use glam::{Mat4, Quat, Vec3};

use super::document::{self, Document, LightKind};
use crate::scene::meshes::model::{Lamp, LampKind, Lens, LensKind, Local, Model, Node};
use crate::scene::meshes::report::{Report, shown};

/// Where each node of the document stands in the model; absent outside of the scene.
pub type Placed = Vec<Option<usize>>;

/// Fills in the nodes of the file's scene, parents before children; none if they are no tree.
pub fn read(document: &Document, model: &mut Model, report: &mut Report) -> Option<Placed> {
    let parents = parents(document, report)?;
    let roots = roots(document, &parents, report)?;
    let order = order(document, &roots);
    cycles(document, &parents, &order, report)?;
    let mut placed = vec![None; document.nodes.len()];
    for (place, index) in order.iter().enumerate() {
        placed[*index] = Some(place);
    }
    let mut world: Vec<Mat4> = Vec::with_capacity(order.len());
    for index in order {
        let from = &document.nodes[index];
        let place = name_of(document, index);
        let node = Node {
            name: from.name.clone(),
            local: local(from, &place, report)?,
            parent: parents[index].and_then(|parent| placed[parent]),
            children: from.children.iter().filter_map(|child| *placed.get(*child)?).collect(),
            mesh: existing(from.mesh, model.meshes.len(), "mesh", &place, report),
            camera: existing(from.camera, model.cameras.len(), "camera", &place, report),
            light: light(from, model.lights.len(), &place, report),
        };
        if from.skin.is_some() {
            report.warn(&place, "skins are not read: the mesh stands as it was before it was bent");
        }
        let above = node.parent.and_then(|parent| world.get(parent)).copied().unwrap_or(Mat4::IDENTITY);
        let here = above * node.local.matrix();
        // What stands below one that was said would say it again.
        if above.is_finite() && !here.is_finite() {
            report.error(&place, "with the transforms of the nodes above it, its own leads to numbers without end");
        }
        world.push(here);
        model.nodes.push(node);
    }
    model.roots = (0..model.nodes.len()).filter(|index| model.nodes[*index].parent.is_none()).collect();
    Some(placed)
}

fn name_of(document: &Document, index: usize) -> String {
    match document.nodes.get(index) {
        Some(node) if !node.name.is_empty() => format!("node {index} ({})", shown(&node.name)),
        _ => format!("node {index}"),
    }
}

fn existing(index: Option<usize>, count: usize, what: &str, place: &str, report: &mut Report) -> Option<usize> {
    let index = index?;
    if index < count {
        return Some(index);
    }
    report.error(place, format!("there is no {what} {index}"));
    None
}

fn light(node: &document::Node, count: usize, place: &str, report: &mut Report) -> Option<usize> {
    existing(node.extensions.light.as_ref().map(|light| light.light), count, "light", place, report)
}

/// The parent of each node.
fn parents(document: &Document, report: &mut Report) -> Option<Vec<Option<usize>>> {
    let mut parents: Vec<Option<usize>> = vec![None; document.nodes.len()];
    let mut is_whole = true;
    for (index, node) in document.nodes.iter().enumerate() {
        for child in &node.children {
            let message = match parents.get_mut(*child) {
                None => format!("there is no node {child} to be its child"),
                Some(Some(other)) => {
                    format!("node {child} is a child of it and of node {other}; a node has one parent at most")
                }
                Some(parent) => {
                    *parent = Some(index);
                    continue;
                }
            };
            report.error(name_of(document, index), message);
            is_whole = false;
        }
    }
    is_whole.then_some(parents)
}

/// The nodes that the file's scene begins with; without scenes, all that have no parent.
fn roots(document: &Document, parents: &[Option<usize>], report: &mut Report) -> Option<Vec<usize>> {
    if document.scenes.is_empty() {
        return Some((0..parents.len()).filter(|index| parents[*index].is_none()).collect());
    }
    let number = document.scene.unwrap_or(0);
    let Some(scene) = document.scenes.get(number) else {
        report.error("scene", format!("there is no scene {number}"));
        return None;
    };
    let mut roots = Vec::with_capacity(scene.nodes.len());
    let mut is_root = vec![false; parents.len()];
    for index in &scene.nodes {
        let message = match (parents.get(*index), is_root.get_mut(*index)) {
            (Some(None), Some(known)) => {
                if !std::mem::replace(known, true) {
                    roots.push(*index);
                }
                continue;
            }
            (Some(Some(parent)), _) => format!("node {index} is no root: it is a child of node {parent}"),
            _ => format!("there is no node {index}"),
        };
        report.error(format!("scene {number}"), message);
    }
    if document.scenes.len() > 1 {
        report.note("scenes", format!("scene {number} of {} is read", document.scenes.len()));
    }
    (!report.has_errors()).then_some(roots)
}

/// Everything below the roots, parents first. Each node has one parent, so that none comes twice.
fn order(document: &Document, roots: &[usize]) -> Vec<usize> {
    let mut order = roots.to_vec();
    let mut next = 0;
    while let Some(index) = order.get(next) {
        order.extend(&document.nodes[*index].children);
        next += 1;
    }
    order
}

/// Reports nodes that are their own ancestors. No root leads to them.
fn cycles(document: &Document, parents: &[Option<usize>], order: &[usize], report: &mut Report) -> Option<()> {
    let mut is_seen = vec![false; parents.len()];
    for index in order {
        is_seen[*index] = true;
    }
    for start in 0..parents.len() {
        let mut walk = Vec::new();
        let mut at = start;
        while !std::mem::replace(&mut is_seen[at], true) {
            walk.push(at);
            match parents[at] {
                Some(parent) => at = parent,
                None => break,
            }
        }
        if let Some(begin) = walk.iter().position(|index| *index == at).filter(|_| parents[at].is_some()) {
            const MOST: usize = 8;
            let cycle: Vec<String> = walk[begin..].iter().rev().take(MOST).map(usize::to_string).collect();
            let more = if walk.len() - begin > MOST { " and so on" } else { "" };
            let message = format!("the node is its own ancestor, through nodes {}{more}", cycle.join(", "));
            report.error(name_of(document, at), message);
        }
    }
    (!report.has_errors()).then_some(())
}

fn local(node: &document::Node, place: &str, report: &mut Report) -> Option<Local> {
    let parts = [
        node.matrix.as_ref().map(|m| m.as_slice()),
        node.translation.as_ref().map(|t| t.as_slice()),
        node.rotation.as_ref().map(|r| r.as_slice()),
        node.scale.as_ref().map(|s| s.as_slice()),
    ];
    if parts.into_iter().flatten().flatten().any(|x| !x.is_finite()) {
        report.error(place, "its transform has a number that is not finite");
        return None;
    }
    if let Some(matrix) = &node.matrix {
        return Some(Local::Matrix(Mat4::from_cols_array(matrix)));
    }
    let rotation = node.rotation.map_or(Quat::IDENTITY, Quat::from_array);
    let length = rotation.length_squared();
    if !(length > 1e-12 && length.is_finite()) {
        report.error(place, "its rotation is a quaternion of no length");
        return None;
    }
    Some(Local::Parts {
        translation: node.translation.map_or(Vec3::ZERO, Vec3::from_array),
        rotation: rotation.normalize(),
        scale: node.scale.map_or(Vec3::ONE, Vec3::from_array),
    })
}

/// The cameras of a document. Those that make no picture are warned of, since most files are drawn
/// and not looked through.
pub fn cameras(document: &Document, report: &mut Report) -> Vec<Lens> {
    let cameras = document.cameras.iter().enumerate().map(|(index, camera)| {
        let (kind, fault) = match (&camera.perspective, &camera.orthographic) {
            (Some(p), _) => {
                (LensKind::Perspective { yfov: p.yfov, aspect: p.aspect_ratio, znear: p.znear, zfar: p.zfar }, None)
            }
            (None, Some(o)) => {
                (LensKind::Orthographic { xmag: o.xmag, ymag: o.ymag, znear: o.znear, zfar: o.zfar }, None)
            }
            (None, None) => (
                LensKind::Perspective { yfov: 0.8, aspect: None, znear: 0.01, zfar: None },
                Some("it has neither `perspective` nor `orthographic`"),
            ),
        };
        let fault = fault.or_else(|| fault_of(kind));
        if let Some(fault) = fault {
            let name = if camera.name.is_empty() { String::new() } else { format!(" ({})", shown(&camera.name)) };
            report.warn(format!("camera {index}{name}"), format!("{fault}: nobody can look through it"));
        }
        Lens { name: camera.name.clone(), kind, fault }
    });
    cameras.collect()
}

fn fault_of(kind: LensKind) -> Option<&'static str> {
    let is_positive = |x: f32| x > 0.0 && x.is_finite();
    match kind {
        LensKind::Perspective { yfov, .. } if !(is_positive(yfov) && yfov < std::f32::consts::PI) => {
            Some("its `yfov` is not between 0 and pi")
        }
        LensKind::Perspective { znear, .. } if !is_positive(znear) => Some("its `znear` is not above 0"),
        LensKind::Orthographic { xmag, ymag, .. } if !(is_positive(xmag.abs()) && is_positive(ymag.abs())) => {
            Some("its `xmag` or `ymag` is 0")
        }
        LensKind::Perspective { znear, zfar: Some(zfar), .. } | LensKind::Orthographic { znear, zfar, .. }
            if zfar.is_nan() || zfar <= znear =>
        {
            Some("its `zfar` is not beyond its `znear`")
        }
        _ => None,
    }
}

pub fn lights(document: &Document) -> Vec<Lamp> {
    let lights = document.extensions.lights.iter().flat_map(|lights| &lights.lights).map(|light| {
        let kind = match light.kind {
            LightKind::Directional => LampKind::Directional,
            LightKind::Point => LampKind::Point,
            LightKind::Spot => LampKind::Spot {
                inner_cone_angle: light.spot.inner_cone_angle,
                outer_cone_angle: light.spot.outer_cone_angle,
            },
        };
        Lamp { name: light.name.clone(), kind, color: light.color, intensity: light.intensity, range: light.range }
    });
    lights.collect()
}
