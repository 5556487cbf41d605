//! Settling a counted buffer: one thread.

use super::{Encoding, compute_pipeline};
use crate::engine::pipeline::Pipeline;
use crate::plan::model::Pass;

pub(super) fn encode(
    encoding: &mut Encoding<'_, '_>,
    pass: &Pass,
    pipeline: Option<&Pipeline>,
    group: &wgpu::BindGroup,
) {
    let Some(pipeline) = compute_pipeline(pipeline) else { return };
    encoding.dispatches(pass, (true, true), |compute| {
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, group, &[]);
        compute.dispatch_workgroups(1, 1, 1);
    });
}
