//! `meniscus plan`: what would run, in what order, on what memory, and why.

use std::collections::BTreeMap;

use super::args::{PlanArgs, PlanFormat};
use super::check::{FileKind, kind, name};
use super::report::{Exit, print, report};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, Sources};
use crate::files::DiskFiles;
use crate::host::params::{Given, Raw, resolve};
use crate::host::{Cache, Job, load};
use crate::plan::model::Plan;
use crate::plan::print as printed;
use crate::{check, plan, program};

pub fn run(args: &PlanArgs) -> Exit {
    let mut sources = Sources::new();
    match make(args, &mut sources) {
        Ok((plan, found)) => {
            let exit = report(&found, &sources);
            let text = match text(args, &plan, &sources) {
                Ok(text) => text,
                Err(refused) => return report(&(*refused).into(), &sources),
            };
            match print(&text) {
                Exit::Done => exit,
                failed => failed,
            }
        }
        Err(found) => report(&found, &sources),
    }
}

fn text(args: &PlanArgs, plan: &Plan, sources: &Sources) -> Result<String, Box<Diagnostic>> {
    let Some(name) = &args.explain else {
        return Ok(match args.format {
            PlanFormat::Text => printed::text(plan),
            PlanFormat::Json => printed::json(plan),
            PlanFormat::Dot => printed::dot(plan),
            PlanFormat::Svg => printed::svg(plan),
        });
    };
    let all = plan::explain::explain(plan, sources, Some(name.as_str()).filter(|name| !name.is_empty()))?;
    match args.format {
        PlanFormat::Text => Ok(printed::explained(&all)),
        PlanFormat::Json => Ok(printed::explained_json(&all)),
        PlanFormat::Dot | PlanFormat::Svg => {
            let message = "explanations are text or JSON";
            Err(Box::new(Diagnostic::error(Code::USAGE, message).hint("leave `--format` out, or say `--format json`")))
        }
    }
}

fn make(args: &PlanArgs, sources: &mut Sources) -> Result<(Plan, Diagnostics), Diagnostics> {
    match kind(&args.graph)? {
        FileKind::Graph => of_graph(args, sources),
        FileKind::Scene => of_scene(args, sources),
        FileKind::Shader => {
            let message = format!("`{}` is a shader, and only graphs have plans", args.graph.display());
            Err(Diagnostic::error(Code::USAGE, message).into())
        }
    }
}

/// The plan of a graph by itself, for a stand-in scene.
fn of_graph(args: &PlanArgs, sources: &mut Sources) -> Result<(Plan, Diagnostics), Diagnostics> {
    // Also one that the program carries, by its name alone.
    let loaded = program::load(&DiskFiles, sources, &name(&args.graph), None);
    let mut found = loaded.diagnostics;
    let Some(program) = loaded.program else { return Err(found) };
    let typed = |(path, value): &(String, String)| Given {
        path: path.clone(),
        raw: Raw::Text(value.clone()),
        span: None,
        of_another_graph: false,
    };
    let given: Vec<Given> = args.set.iter().map(typed).collect();
    let mut request = check::stand_in(&program);
    request.params = resolve(&given, &program, &mut found);
    request.viewport = args.size.unwrap_or(request.viewport);
    request.memory.policy = args.memory.policy();
    request.memory.budget = args.memory.memory_budget;
    if found.has_errors() {
        return Err(found);
    }
    match plan::instantiate_stand_in(&program, &request) {
        Ok(plan) => {
            found.extend(of_this_plan(&plan));
            Ok((plan, found))
        }
        Err(errors) => {
            found.extend(errors);
            Err(found)
        }
    }
}

/// What one plan does not use may be used by another, at other parameters: `check` compares them.
fn of_this_plan(plan: &Plan) -> Diagnostics {
    Diagnostics(plan.warnings.iter().filter(|warning| warning.id != Code::UNUSED).cloned().collect())
}

/// The plan of a scene's graph, for what the scene has.
fn of_scene(args: &PlanArgs, sources: &mut Sources) -> Result<(Plan, Diagnostics), Diagnostics> {
    let job = Job { source: args.graph.clone(), size: args.size, set: args.set.clone(), ..Job::default() };
    let job = Job { policy: args.memory.policy(), memory_budget: args.memory.memory_budget, ..job };
    let loaded = load(&DiskFiles, sources, &job, &mut Cache::default());
    let mut found = loaded.diagnostics;
    let Some(content) = loaded.content else { return Err(found) };
    let stand_in = check::stand_in(&content.program);
    let (plan, _) = content.plans(stand_in.features, stand_in.limits, &BTreeMap::new())?;
    found.extend(of_this_plan(&plan));
    Ok((plan, found))
}
