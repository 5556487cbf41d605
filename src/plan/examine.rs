//! Planning for what it finds: everything that can be wrong or odd is found without an order of
//! the passes, their units and their memory, and checking asks for some dozen plans.

use std::collections::BTreeSet;

use super::lower::Lowering;
use super::model::{Culled, Needs, Param, Plan, Request};
use super::{Lowered, insert, lowered, needs, state, units};
use crate::diagnostic::{Diagnostics, Span};
use crate::program::Program;

/// What checking wants to know of a plan.
#[derive(Clone, Debug)]
pub struct Findings {
    pub warnings: Diagnostics,
    pub culled: Vec<Culled>,
    /// Where the passes that run are declared.
    pub passes: BTreeSet<Span>,
    pub needs: Needs,
    pub params: Vec<Param>,
    /// As those of a plan.
    pub structural: BTreeSet<String>,
    pub arithmetic: BTreeSet<String>,
}

impl From<Plan> for Findings {
    fn from(plan: Plan) -> Self {
        Self {
            passes: plan.passes.iter().map(|pass| pass.span).collect(),
            warnings: plan.warnings,
            culled: plan.culled,
            needs: plan.needs,
            params: plan.params,
            structural: plan.structural,
            arithmetic: plan.arithmetic,
        }
    }
}

/// What [`super::instantiate_stand_in`] finds, without making the plan.
///
/// # Errors
/// As it.
pub fn examine(program: &Program, request: &Request) -> Result<Findings, Diagnostics> {
    let Lowered { mut lowering, culled, mut warnings, .. } = lowered(program, request, true)?;
    if !lowering.steps.is_empty() {
        seal(&mut lowering);
    }
    if lowering.diagnostics.has_errors() {
        return Err(lowering.diagnostics);
    }
    let (needs, lacking) = needs::needs(&lowering, &touched(&lowering));
    if lacking.has_errors() {
        lowering.diagnostics.extend(lacking);
        return Err(lowering.diagnostics);
    }
    std::mem::take(&mut lowering.diagnostics).0.into_iter().for_each(|diagnostic| warnings.push(diagnostic));
    Ok(Findings {
        warnings,
        culled,
        passes: lowering.flat.iter().map(|flat| flat.pass.span).collect(),
        needs,
        structural: lowering.causes.params(&lowering.structural),
        arithmetic: lowering.causes.params(&lowering.arithmetic),
        params: lowering.params.into_values().collect(),
    })
}

/// The rules of state, some of which hang on what passes are made from.
fn seal(lowering: &mut Lowering<'_>) {
    insert::insert(lowering);
    insert::cover_steps(lowering);
    let (_, made_from) = units::units(lowering);
    state::seal(lowering, &made_from);
}

/// Which objects any pass has to do with.
fn touched(lowering: &Lowering<'_>) -> Vec<bool> {
    let mut touched = vec![false; lowering.objects.len()];
    for access in lowering.flat.iter().flat_map(|flat| &flat.pass.accesses) {
        lowering.object_ids(access.object).for_each(|id| touched[id] = true);
    }
    touched
}
