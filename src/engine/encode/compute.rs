//! Dispatches. None of zero workgroups is made.

use super::{Encoding, compute_pipeline};
use crate::engine::pipeline::Pipeline;
use crate::plan::model::{Dispatch, Pass};

pub(super) fn encode(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    dispatch: &Dispatch,
    pipeline: Option<&Pipeline>,
    group: Option<&wgpu::BindGroup>,
) {
    let Some(pipeline) = compute_pipeline(pipeline) else { return };
    let arguments = &encoding.fixed.arguments;
    encoding.dispatches(pass, (true, true), |compute| {
        compute.set_pipeline(pipeline);
        if group.is_some() {
            compute.set_bind_group(0, group, &[]);
        }
        match dispatch {
            Dispatch::Groups([x, y, z]) if ![x, y, z].contains(&&0) => compute.dispatch_workgroups(*x, *y, *z),
            Dispatch::Groups(_) => {}
            Dispatch::Indirect { slot } => compute.dispatch_workgroups_indirect(arguments, u64::from(*slot) * 32),
        }
    });
}
