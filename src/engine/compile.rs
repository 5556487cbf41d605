//! Making pipelines, also on another thread than the one that draws: a plan whose pipelines were
//! compiled aside is prepared without waiting for the driver's compiler.

use std::sync::Arc;

use super::errors;
use super::gpu::Gpu;
use super::meshes::{self, ByFaces};
use super::pipeline::{Pipeline, Recipe, Shelf};
use super::prepare::recipe;
use crate::diagnostic::Diagnostics;
use crate::plan::model::Plan;

/// Makes the pipelines of plans for an [`super::Engine`], which finds them there. Clones share
/// what they made.
#[derive(Clone, Debug)]
pub struct Compiler {
    gpu: Gpu,
    shelf: Arc<Shelf>,
}

/// The pipeline of each pass, for those that need one.
pub(super) type Pipelines = Vec<Option<Arc<Pipeline>>>;

/// How many pipelines a plan had to have made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compiled {
    pub built: usize,
    pub reused: usize,
}

impl Compiler {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), shelf: Arc::default() }
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Compiles what a plan needs and is not there yet.
    ///
    /// # Errors
    /// With every pipeline that the device refuses.
    pub fn compile(&self, plan: &Plan) -> Result<Compiled, Diagnostics> {
        self.gpu.check()?;
        self.pipelines(plan).map(|(_, _, compiled)| compiled)
    }

    /// The pipeline of each pass that needs one.
    pub(super) fn pipelines(&self, plan: &Plan) -> Result<(Pipelines, Vec<Option<ByFaces>>, Compiled), Diagnostics> {
        self.shelf.cache().begin_round();
        let mut found = Diagnostics::new();
        let mut compiled = Compiled::default();
        let mut pipelines = Vec::with_capacity(plan.passes.len());
        let mut by_faces = Vec::with_capacity(plan.passes.len());
        for pass in &plan.passes {
            let made = recipe(&self.gpu, plan, pass).and_then(|recipe| {
                let Some(recipe) = recipe else { return Ok((None, None)) };
                let mut get = |recipe: &Recipe| self.get(recipe, &pass.path, &mut compiled);
                Ok((Some(get(&recipe)?), meshes::by_faces(&recipe, pass, &mut get)?))
            });
            match made {
                Ok((pipeline, faces)) => {
                    pipelines.push(pipeline);
                    by_faces.push(faces);
                }
                Err(error) => found.push(errors::refused("the pipeline of", &pass.path, pass.span, &error)),
            }
        }
        if found.is_empty() { Ok((pipelines, by_faces, compiled)) } else { Err(found) }
    }

    /// A pipeline of the engine's own, outside any preparation.
    pub(super) fn kernel(&self, recipe: &Recipe, label: &str) -> Result<Arc<Pipeline>, String> {
        self.get(recipe, label, &mut Compiled::default())
    }

    fn get(&self, recipe: &Recipe, label: &str, compiled: &mut Compiled) -> Result<Arc<Pipeline>, String> {
        match errors::scoped(&self.gpu, || self.shelf.get(&self.gpu, recipe, label)) {
            Ok((pipeline, is_new)) => {
                let count = if is_new { &mut compiled.built } else { &mut compiled.reused };
                *count += 1;
                Ok(pipeline)
            }
            Err(error) => {
                self.shelf.cache().forget(recipe);
                Err(error)
            }
        }
    }
}
