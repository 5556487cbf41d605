//! What is read was written before: program order over subresources, and conflicts inside a pass.

use super::lower::{FlatPass, Lowering, Place, fault, traced};
use super::model::{Access, Bound, ObjectId, ObjectKind, ObjectRef, Origin, Output, PassKind};
use super::state;
use crate::diagnostic::{Code, Diagnostic};

/// For each object, which (mip, layer) something wrote.
struct Written(Vec<Vec<bool>>);

/// Checks the flat list in program order.
pub(super) fn check(lowering: &mut Lowering<'_>, outputs: &[Output]) {
    let mut faults: Vec<Diagnostic> = Vec::new();
    let mut written = Written::at_start(lowering);
    let mut before_steps: Option<(usize, Vec<Vec<bool>>)> = None;
    for flat in &lowering.flat {
        // A frame may run no step: what only steps write counts as not written after them.
        match (&before_steps, flat.pass.steps) {
            (None, Some(steps)) => before_steps = Some((steps, written.0.clone())),
            (Some((open, saved)), now) if now != Some(*open) => {
                written.0.clone_from(saved);
                before_steps = now.map(|steps| (steps, written.0.clone()));
            }
            _ => {}
        }
        let conflict = conflict(lowering, flat);
        for (access, place) in flat.pass.accesses.iter().zip(&flat.places) {
            let in_conflict = conflict.as_ref().is_some_and(|(object, _)| *object == access.object);
            if access.read
                && !in_conflict
                && let Some(fault) = written.missing(lowering, flat, access, place)
            {
                faults.push(*fault);
            }
        }
        for access in flat.pass.accesses.iter().filter(|a| a.write) {
            written.mark(lowering, access);
        }
        faults.extend(conflict.map(|(_, fault)| *fault));
    }
    if let Some((_, saved)) = before_steps {
        written.0 = saved;
    }
    faults.extend(outputs.iter().filter_map(|output| written.missing_output(lowering, output)).map(|fault| *fault));
    faults.extend(hidden_writes(lowering, outputs));
    faults.extend(state::check(lowering));
    for fault in faults {
        lowering.diagnostics.push(fault);
    }
}

impl Written {
    fn at_start(lowering: &Lowering<'_>) -> Self {
        let count = |kind: &ObjectKind| match kind {
            ObjectKind::Texture(t) => (t.mips * if t.is_3d { 1 } else { t.layers }) as usize,
            ObjectKind::Buffer(_) => 1,
        };
        let known = |o: &Origin| *o != Origin::Frame;
        Self(lowering.objects.iter().map(|b| vec![known(&b.object.origin); count(&b.object.kind)]).collect())
    }

    fn missing(
        &self,
        lowering: &Lowering<'_>,
        flat: &FlatPass,
        access: &Access,
        place: &Place,
    ) -> Option<Box<Diagnostic>> {
        let id = lowering.object_id(access.object);
        let missing = subresources(lowering, id, access, place.samples_mips).find(|sub| !self.0[id][*sub])?;
        let building = &lowering.objects[id];
        let layers = layer_count(&building.object.kind);
        let (mip, layer) = (missing / layers, missing % layers);
        let part = match (&building.object.kind, access.mips.len() > 1 || mip > 0, layers > 1) {
            (ObjectKind::Buffer(_), ..) | (_, false, false) => String::new(),
            (_, true, false) => format!("mip {mip} of "),
            (_, false, true) => format!("layer {layer} of "),
            (_, true, true) => format!("mip {mip}, layer {layer} of "),
        };
        let name = &building.object.path;
        let also = if access.write { "reads or keeps what is in" } else { "reads" };
        let message = format!("the pass {also} {part}`{name}`, which nothing wrote before");
        let mut diagnostic = fault(Code::NEVER_WRITTEN, message, place.graph, "read here");
        if let Some(span) = place.shader {
            diagnostic = diagnostic.see(span, "the shader's variable");
        }
        diagnostic = diagnostic.see(building.object.span, "declared here");
        let is_target = matches!(&flat.pass.kind, PassKind::Draw(_)) && place.shader.is_none();
        let in_steps = lowering.flat.iter().any(|other| {
            other.pass.steps.is_some()
                && flat.pass.steps != other.pass.steps
                && other.pass.accesses.iter().any(|a| a.write && lowering.object_id(a.object) == id)
        });
        let hint = if in_steps {
            format!("a frame may run no step: declare `{name}` under `state:`")
        } else if is_target {
            "say `clear: 0.0` on the target, or put a pass before that writes it".to_owned()
        } else if access.write {
            format!("put `Clear(\"{name}\")` before")
        } else {
            "put a pass before that writes it".to_owned()
        };
        Some(traced(diagnostic.hint(hint), &flat.trace))
    }

    /// An output that holds nothing at the end.
    fn missing_output(&self, lowering: &Lowering<'_>, output: &Output) -> Option<Box<Diagnostic>> {
        let id = lowering.object_id(output.object);
        if self.0[id].iter().any(|written| *written) {
            return None;
        }
        let object = &lowering.objects[id].object;
        let message = format!("nothing writes the output `{}`", output.name);
        let mut diagnostic = fault(Code::NEVER_WRITTEN, message, output.span, "put out here");
        if object.span != output.span {
            diagnostic = diagnostic.see(object.span, "declared here");
        }
        let steps = lowering.flat.iter().find(|flat| {
            flat.pass.accesses.iter().any(|access| access.write && lowering.object_id(access.object) == id)
        });
        Some(Box::new(match steps {
            Some(flat) => diagnostic
                .see(flat.word, "written only in `Steps`")
                .hint(format!("a frame may run no step: declare `{}` under `state:`", object.path)),
            None => diagnostic.hint("put a pass that writes it, or drop the output"),
        }))
    }

    fn mark(&mut self, lowering: &Lowering<'_>, access: &Access) {
        for id in lowering.object_ids(access.object) {
            for sub in subresources(lowering, id, access, false) {
                self.0[id][sub] = true;
            }
        }
    }
}

fn layer_count(kind: &ObjectKind) -> usize {
    match kind {
        ObjectKind::Texture(t) if !t.is_3d => t.layers as usize,
        _ => 1,
    }
}

/// Indices of the subresources that an access touches. Of automatic mips only the first counts:
/// the planner makes the others.
pub(super) fn subresources(
    lowering: &Lowering<'_>,
    id: ObjectId,
    access: &Access,
    only_first_mip: bool,
) -> impl Iterator<Item = usize> + use<> {
    let layers = layer_count(&lowering.objects[id].object.kind);
    let mips = if only_first_mip { 0..1 } else { access.mips.clone() };
    let range = access.layers.clone();
    mips.flat_map(move |mip| range.clone().map(move |layer| mip as usize * layers + layer as usize))
}

/// One subresource cannot be written and used otherwise in one pass.
fn conflict(lowering: &Lowering<'_>, flat: &FlatPass) -> Option<(ObjectRef, Box<Diagnostic>)> {
    let accesses = &flat.pass.accesses;
    for (i, a) in accesses.iter().enumerate() {
        for (j, b) in accesses.iter().enumerate().skip(i + 1) {
            let overlap = a.object == b.object && overlap(&a.mips, &b.mips) && overlap(&a.layers, &b.layers);
            if overlap && (a.write || b.write || writable(flat, i) || writable(flat, j)) {
                return Some((a.object, report_conflict(lowering, flat, i, j)));
            }
        }
    }
    None
}

/// Whether the access is a variable declared `read_write`, whatever the shader does with it.
fn writable(flat: &FlatPass, access: usize) -> bool {
    let shader = match &flat.pass.kind {
        PassKind::Compute { shader, .. } => shader,
        PassKind::Draw(draw) => &draw.shader,
        _ => return false,
    };
    let (access, place) = (&flat.pass.accesses[access], &flat.places[access]);
    shader.bindings.iter().any(|b| {
        b.name == place.name
            && matches!(&b.bound, Bound::Storage { buffer, writable: true } if *buffer == access.object)
    })
}

fn report_conflict(lowering: &Lowering<'_>, flat: &FlatPass, i: usize, j: usize) -> Box<Diagnostic> {
    let (a, b) = (&flat.places[i], &flat.places[j]);
    let name = &lowering.object(flat.pass.accesses[i].object).object.path;
    let both_write = flat.pass.accesses[i].write && flat.pass.accesses[j].write;
    let message = match both_write {
        true => format!("the pass writes `{name}` twice"),
        false => format!("the pass uses `{name}` twice, and one of the uses writes it"),
    };
    let mut diagnostic = fault(Code::READ_WRITE_CONFLICT, message, a.graph, format!("as `{}`", a.name));
    if a.graph != b.graph {
        diagnostic = diagnostic.at(b.graph, format!("as `{}`", b.name));
    }
    for place in [a, b] {
        if let Some(span) = place.shader {
            diagnostic = diagnostic.see(span, "the shader's variable");
        }
    }
    let hint = match both_write {
        true => "give each of them a resource of its own, or a layer of its own",
        false => "write to another resource of the same kind (`Like(...)`), and swap them in a `Repeat` if it goes on",
    };
    traced(diagnostic.hint(hint), &flat.trace)
}

fn overlap(a: &std::ops::Range<u32>, b: &std::ops::Range<u32>) -> bool {
    a.start < b.end && b.start < a.end
}

/// A part tells its users what it writes: an input that it writes is among its outputs.
fn hidden_writes(lowering: &Lowering<'_>, outputs: &[Output]) -> Vec<Diagnostic> {
    let mut faults = Vec::new();
    for (id, building) in lowering.objects.iter().enumerate() {
        let Origin::Input(name) = &building.object.origin else { continue };
        if outputs.iter().any(|output| lowering.object_id(output.object) == id) {
            continue;
        }
        let writes =
            |flat: &&FlatPass| flat.pass.accesses.iter().any(|a| a.write && lowering.object_id(a.object) == id);
        let Some(flat) = lowering.flat.iter().find(writes) else { continue };
        let message = format!("the graph writes its input `{name}` and does not put it out");
        let diagnostic = fault(Code::BAD_PASS, message, flat.word, "written by this pass")
            .see(building.object.span, "declared here")
            .hint(format!("add \"{name}\" to `outputs`, or copy it to a resource first"));
        faults.push(*traced(diagnostic, &flat.trace));
    }
    faults
}
