//! How many objects live on the device: for tests that nothing leaks, and for whoever wonders.

use super::gpu::Gpu;

/// Objects that wgpu keeps, by kind; what waits to be freed counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    pub buffers: usize,
    pub textures: usize,
    pub texture_views: usize,
    pub bind_groups: usize,
    pub layouts: usize,
    pub pipelines: usize,
    pub shader_modules: usize,
    pub others: usize,
}

impl Census {
    pub fn total(&self) -> usize {
        let memory = self.buffers + self.textures + self.texture_views;
        memory + self.bind_groups + self.layouts + self.pipelines + self.shader_modules + self.others
    }
}

impl Gpu {
    /// Counts what lives now. `None` for a device that an embedder handed in: its instance is theirs.
    pub fn census(&self) -> Option<Census> {
        let hub = self.opened_on()?.generate_report()?.hub;
        let live = |of: &[&wgpu::wgc::registry::RegistryReport]| of.iter().map(|r| r.num_allocated).sum();
        Some(Census {
            buffers: live(&[&hub.buffers]),
            textures: live(&[&hub.textures]),
            texture_views: live(&[&hub.texture_views]),
            bind_groups: live(&[&hub.bind_groups]),
            layouts: live(&[&hub.bind_group_layouts, &hub.pipeline_layouts]),
            pipelines: live(&[&hub.render_pipelines, &hub.compute_pipelines]),
            shader_modules: live(&[&hub.shader_modules]),
            others: live(&[&hub.samplers, &hub.query_sets, &hub.command_encoders, &hub.command_buffers]),
        })
    }
}
