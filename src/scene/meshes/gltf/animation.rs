//! Animations of a glTF file. What moves something other than nodes is read over and said.

use glam::{Quat, Vec3};

use super::accessor::{Data, Elements};
use super::document;
use super::nodes::Placed;
use crate::scene::meshes::model::{Animation, Channel, Interpolation, Keys, Local, Node};
use crate::scene::meshes::report::{Report, shown};

pub fn read(data: &Data<'_>, placed: &Placed, nodes: &[Node], report: &mut Report) -> Vec<Animation> {
    let animations = data.document.animations.iter().enumerate();
    animations
        .map(|(index, animation)| {
            let channels = animation.channels.iter().enumerate();
            let channels: Vec<Channel> = channels
                .filter_map(|(number, from)| {
                    let place = format!("animation {index}, channel {number}");
                    channel(data, animation, from, placed, nodes, &place, report)
                })
                .collect();
            let duration_s = channels.iter().filter_map(|c| c.times_s.last().copied()).fold(0.0, f32::max);
            let name = if animation.name.is_empty() { index.to_string() } else { animation.name.clone() };
            Animation { name, duration_s, channels }
        })
        .collect()
}

fn channel(
    data: &Data<'_>,
    animation: &document::Animation,
    channel: &document::Channel,
    placed: &Placed,
    nodes: &[Node],
    place: &str,
    report: &mut Report,
) -> Option<Channel> {
    let target = &channel.target;
    if target.path == "weights" {
        report.warn(place, "morph targets are not read: what moves them is left out");
        return None;
    }
    if target.path == "pointer" {
        report.note(place, "it moves something other than a node, and is left out");
        return None;
    }
    let Some(sampler) = animation.samplers.get(channel.sampler) else {
        report.error(place, format!("there is no sampler {}", channel.sampler));
        return None;
    };
    // Without a node an extension would have to say what moves.
    let node = target.node?;
    let Some(node) = placed.get(node) else {
        report.error(place, format!("there is no node {node}"));
        return None;
    };
    let node = (*node)?;
    if matches!(nodes.get(node)?.local, Local::Matrix(_)) {
        report.warn(place, "its node has a matrix, which cannot be animated: the channel is left out");
        return None;
    }
    let interpolation = match sampler.interpolation {
        document::Interpolation::Linear => Interpolation::Linear,
        document::Interpolation::Step => Interpolation::Step,
        document::Interpolation::CubicSpline => Interpolation::Cubic,
    };
    let times_s = times(data, sampler.input, place, report)?;
    let shape = match target.path.as_str() {
        "translation" | "scale" => "VEC3",
        "rotation" => "VEC4",
        other => {
            report.error(place, format!("{} is no path: expected translation, rotation or scale", shown(other)));
            return None;
        }
    };
    let values = data.elements(sampler.output, &[shape], &place, report)?;
    let expected = if interpolation == Interpolation::Cubic { times_s.len().checked_mul(3)? } else { times_s.len() };
    if values.count != expected {
        report.error(place, format!("{expected} values are expected for its times, there are {}", values.count));
        return None;
    }
    if !report.take(expected.saturating_mul(16), place) {
        return None;
    }
    let keys = keys(&values, &target.path, interpolation, place, report)?;
    Some(Channel { node, times_s, interpolation, keys })
}

fn times(data: &Data<'_>, accessor: usize, place: &str, report: &mut Report) -> Option<Vec<f32>> {
    let elements = data.elements(accessor, &["SCALAR"], &format!("{place}, times"), report)?;
    if elements.count == 0 {
        report.error(place, "there are no keys");
        return None;
    }
    if !report.take(elements.count.saturating_mul(4), place) {
        return None;
    }
    let times: Vec<f32> = (0..elements.count).map(|index| elements.get::<1>(index)[0]).collect();
    let wrong = (0..times.len()).find(|&at| !times[at].is_finite() || (at > 0 && times[at] < times[at - 1]));
    match wrong {
        None => Some(times),
        Some(at) => {
            report.error(place, format!("time {at} is {}: times must be finite and must not fall", times[at]));
            None
        }
    }
}

fn keys(
    values: &Elements<'_>,
    path: &str,
    interpolation: Interpolation,
    place: &str,
    report: &mut Report,
) -> Option<Keys> {
    let all = 0..values.count;
    let keys = match path {
        "translation" => Keys::Translation(all.map(|at| Vec3::from_array(values.get(at))).collect()),
        "scale" => Keys::Scale(all.map(|at| Vec3::from_array(values.get(at))).collect()),
        _ => Keys::Rotation(all.map(|at| Quat::from_array(values.get(at))).collect()),
    };
    let is_value = |at: usize| interpolation != Interpolation::Cubic || at % 3 == 1;
    let wrong = match &keys {
        Keys::Translation(keys) | Keys::Scale(keys) => keys.iter().position(|key| !key.is_finite()),
        Keys::Rotation(keys) => keys.iter().enumerate().position(|(at, key)| {
            let length = key.length_squared();
            !length.is_finite() || is_value(at) && length < 1e-12
        }),
    };
    if let Some(at) = wrong {
        report.error(place, format!("value {at} is not finite, or is a rotation of no length"));
        return None;
    }
    Some(match keys {
        Keys::Rotation(mut keys) if interpolation != Interpolation::Cubic => {
            keys.iter_mut().for_each(|key| *key = key.normalize());
            Keys::Rotation(keys)
        }
        keys => keys,
    })
}
