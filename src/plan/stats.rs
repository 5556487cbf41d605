//! The values of statistics, from the bytes that a frame left in buffers.
//!
//! This is done on the processor: whole numbers add up exactly and floats in double precision, in the
//! order of the items, so that a value is the same on every device; and any item that a shader can
//! declare can be looked at. Buffers are copied only where somebody asks.

use super::model::{Buffer, Leaf, ObjectKind, ObjectRef, Plan, Probe, ProbeKind, Stat};
use crate::graph::eval::eval_live;
use crate::graph::value::Value;
use crate::shader::reflect::Scalar;

/// A statistic with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// Instance path.
    pub path: String,
    /// Absent where there is none: no items, a division by zero, a buffer that nothing writes. NaN if
    /// there is one among what is added up.
    pub value: Option<f64>,
}

/// Every buffer that statistics read, once.
pub fn buffers(plan: &Plan) -> Vec<ObjectRef> {
    let mut all: Vec<ObjectRef> = plan.stats.iter().flat_map(|stat| &stat.probes).map(|probe| probe.object).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The values of all statistics. `content` has the bytes of a buffer, with the header of a counted one.
pub fn values<'a>(plan: &Plan, content: &dyn Fn(ObjectRef) -> Option<&'a [u8]>) -> Vec<Statistic> {
    plan.stats.iter().map(|stat| Statistic { path: stat.path.clone(), value: value(plan, stat, content) }).collect()
}

fn value<'a>(plan: &Plan, stat: &Stat, content: &dyn Fn(ObjectRef) -> Option<&'a [u8]>) -> Option<f64> {
    if stat.missing.is_some() {
        return None;
    }
    let found: Vec<Option<Value>> =
        stat.probes.iter().map(|probe| look(probe, buffer(plan, probe.object)?, content(probe.object)?)).collect();
    let named = |name: &str| found.get(name.strip_prefix('#')?.parse::<usize>().ok()?)?.clone();
    match eval_live(&stat.value, &named)? {
        Value::Bool(holds) => Some(f64::from(u8::from(holds))),
        value => value.as_f64(),
    }
}

fn buffer(plan: &Plan, object: ObjectRef) -> Option<&Buffer> {
    match &plan.objects.get(super::print::object_id(plan, object))?.kind {
        ObjectKind::Buffer(buffer) => Some(buffer),
        ObjectKind::Texture(_) => None,
    }
}

fn look(probe: &Probe, buffer: &Buffer, bytes: &[u8]) -> Option<Value> {
    let counted = || Some(u64::from(u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?)));
    let count = if buffer.counted { counted()?.min(buffer.items) } else { buffer.items };
    let items = bytes.get(buffer.header as usize..)?.chunks_exact(buffer.stride.max(1) as usize).take(count as usize);
    let leaf = || probe.leaves.first().copied();
    match probe.kind {
        ProbeKind::Count => i64::try_from(count).ok().map(Value::Int),
        ProbeKind::Item(at) => number(items.clone().nth(at as usize)?, leaf()?),
        ProbeKind::Nans => {
            let is_nan = |item: &[u8], leaf: &Leaf| matches!(number(item, *leaf), Some(Value::Float(x)) if x.is_nan());
            let nans = items.map(|item| probe.leaves.iter().filter(|leaf| is_nan(item, leaf)).count());
            i64::try_from(nans.sum::<usize>()).ok().map(Value::Int)
        }
        kind => over_all(kind, items.map(|item| number(item, leaf()?)).collect::<Option<Vec<Value>>>()?),
    }
}

fn over_all(kind: ProbeKind, values: Vec<Value>) -> Option<Value> {
    let count = values.len();
    let whole: Option<Vec<i64>> = values.iter().map(|v| if let Value::Int(i) = v { Some(*i) } else { None }).collect();
    let floats = || values.iter().filter_map(Value::as_f64);
    match (kind, whole) {
        (ProbeKind::Min, Some(whole)) => whole.into_iter().min().map(Value::Int),
        (ProbeKind::Max, Some(whole)) => whole.into_iter().max().map(Value::Int),
        (ProbeKind::Sum, Some(whole)) => Some(Value::Int(whole.into_iter().sum())),
        (ProbeKind::Min, None) => floats().filter(|x| !x.is_nan()).min_by(f64::total_cmp).map(Value::Float),
        (ProbeKind::Max, None) => floats().filter(|x| !x.is_nan()).max_by(f64::total_cmp).map(Value::Float),
        (ProbeKind::Sum, None) => Some(Value::Float(floats().sum())),
        (ProbeKind::Mean, _) if count > 0 => Some(Value::Float(floats().sum::<f64>() / count as f64)),
        _ => None,
    }
}

fn number(item: &[u8], leaf: Leaf) -> Option<Value> {
    let at = leaf.offset as usize;
    let word: [u8; 4] = item.get(at..at + 4)?.try_into().ok()?;
    match leaf.scalar {
        Scalar::F32 => Some(Value::Float(f64::from(f32::from_le_bytes(word)))),
        Scalar::I32 => Some(Value::Int(i64::from(i32::from_le_bytes(word)))),
        Scalar::U32 => Some(Value::Int(i64::from(u32::from_le_bytes(word)))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Items of a whole number and a float behind a header.
    fn bytes(count: u32, items: &[(u32, f32)]) -> Vec<u8> {
        let words = items.iter().flat_map(|(n, x)| [*n, x.to_bits()]);
        [count].into_iter().chain(words).flat_map(u32::to_le_bytes).collect()
    }

    fn looked(kind: ProbeKind, float: bool, bytes: &[u8]) -> Option<Value> {
        let leaf =
            if float { Leaf { offset: 4, scalar: Scalar::F32 } } else { Leaf { offset: 0, scalar: Scalar::U32 } };
        let usages = wgpu_types::BufferUsages::empty();
        let buffer = Buffer { stride: 8, items: 4, header: 4, counted: true, item: None, usages };
        look(&Probe { object: ObjectRef::Fixed(0), kind, leaves: vec![leaf] }, &buffer, bytes)
    }

    #[test]
    fn only_items_that_are_there_count_and_whole_numbers_stay_whole() {
        let bytes = bytes(3, &[(u32::MAX, 1.5), (7, -2.0), (u32::MAX, 0.0), (1000, 99.0)]);
        assert_eq!(looked(ProbeKind::Count, false, &bytes), Some(Value::Int(3)));
        assert_eq!(looked(ProbeKind::Sum, false, &bytes), Some(Value::Int(2 * i64::from(u32::MAX) + 7)));
        assert_eq!(looked(ProbeKind::Min, false, &bytes), Some(Value::Int(7)));
        assert_eq!(looked(ProbeKind::Max, true, &bytes), Some(Value::Float(1.5)));
        assert_eq!(looked(ProbeKind::Item(1), true, &bytes), Some(Value::Float(-2.0)));
        assert_eq!(looked(ProbeKind::Item(3), true, &bytes), None, "it is beyond the count");
        let raw = self::bytes(9, &[(1, 1.0); 4]);
        assert_eq!(looked(ProbeKind::Count, false, &raw), Some(Value::Int(4)), "no more than there is room for");
    }

    #[test]
    fn what_is_no_number_is_counted_and_spoils_sums_alone() {
        let bytes = bytes(3, &[(0, 2.0), (0, f32::NAN), (0, -4.0)]);
        assert_eq!(looked(ProbeKind::Nans, true, &bytes), Some(Value::Int(1)));
        assert_eq!(looked(ProbeKind::Min, true, &bytes), Some(Value::Float(-4.0)));
        assert_eq!(looked(ProbeKind::Max, true, &bytes), Some(Value::Float(2.0)));
        let mean = looked(ProbeKind::Mean, true, &bytes).and_then(|value| value.as_f64());
        assert!(mean.is_some_and(f64::is_nan));
    }

    #[test]
    fn nothing_has_no_mean() {
        let bytes = bytes(0, &[]);
        assert_eq!(looked(ProbeKind::Mean, true, &bytes), None);
        assert_eq!(looked(ProbeKind::Min, false, &bytes), None);
        assert_eq!(looked(ProbeKind::Sum, false, &bytes), Some(Value::Int(0)));
    }
}
