//! Which policy a plan's memory follows, and whether it keeps to a budget (rule 38).
//!
//! Keeping is for pictures of which little changes from one to the next. Where inputs change in
//! each frame and at least half of the passes run for them anyway, sharing by lifetimes holds. A
//! budget that keeping exceeds makes it sharing too, or the smallest policy with as few cuts of the
//! frame as it takes; one that even that exceeds is told.

use super::cuts;
use super::memory;
use super::model::{Causes, MemoryRequest, ObjectId, ObjectKind, Origin, Plan, Policy, Why};
use super::print::bytes;
use crate::diagnostic::{Code, Diagnostic};

/// How many of the largest resources are named where a budget is too small.
const NAMED: usize = 4;

impl Plan {
    /// Chooses the policy that is asked for, or what fits what changes and the budget.
    ///
    /// # Errors
    /// If no policy that may be chosen keeps to the budget. The plan is then as it was.
    pub fn choose_memory(&mut self, request: &MemoryRequest) -> Result<(), Box<Diagnostic>> {
        let (mut policy, mut why) = match request.policy {
            Some(asked) => (asked, Why::Asked),
            None => by_change(self, request),
        };
        let before = self.part(None);
        let held = |plan: &Plan, policy: Policy| plan.memory.held(policy).saturating_add(request.elsewhere);
        let within = |plan: &Plan, policy: Policy| request.budget.is_none_or(|budget| held(plan, policy) <= budget);
        if !within(self, policy) && request.policy.is_none() {
            why = Why::Budget { keeping: self.memory.held(policy) };
            policy = if within(self, Policy::Share) { Policy::Share } else { Policy::Smallest };
        }
        if let Some(budget) = request.budget.filter(|_| policy == Policy::Smallest) {
            self.part(Some(budget.saturating_sub(self.memory.outside + request.elsewhere)));
        }
        if let Some(budget) = request.budget.filter(|_| !within(self, policy)) {
            let found = too_small(self, request, budget);
            before.put(&mut self.memory);
            return Err(found);
        }
        self.memory.policy = policy;
        self.memory.why = why;
        self.memory.budget = request.budget;
        Ok(())
    }

    /// Parts the frame for the smallest policy, and gives what was there before.
    fn part(&mut self, room: Option<u64>) -> cuts::Parted {
        let parted = cuts::parted(self, room);
        parted.put(&mut self.memory)
    }
}

fn by_change(plan: &Plan, request: &MemoryRequest) -> (Policy, Why) {
    if request.moving.is_empty() {
        return (Policy::Keep, Why::Still);
    }
    let of = plan.passes.iter().filter(|pass| pass.steps.is_none()).count();
    let moves = |causes: &Causes| {
        !causes.inputs.is_disjoint(&request.moving)
            || ["time", "delta", "frame", "step"].iter().any(|name| causes.live.contains(*name))
    };
    let is_run = |pass: &&super::model::Pass| pass.steps.is_none() && moves(&plan.units[pass.unit].causes);
    let passes = plan.passes.iter().filter(is_run).count();
    let policy = if passes * 2 >= of { Policy::Share } else { Policy::Keep };
    (policy, Why::Moving { passes, of })
}

/// What the least is that the plan can do with, where most is live, and what takes the most there.
fn too_small(plan: &Plan, request: &MemoryRequest, budget: u64) -> Box<Diagnostic> {
    let memory = &plan.memory;
    let least = request.policy.unwrap_or(Policy::Smallest);
    let needed = memory.held(least) + request.elsewhere;
    let mut parts = vec![format!("{} of the frame", bytes(memory.of_frame(least)))];
    if memory.outside > 0 {
        parts.push(format!("{} of inputs and state", bytes(memory.outside)));
    }
    if request.elsewhere > 0 {
        parts.push(format!("{} of what shows the picture and of materials", bytes(request.elsewhere)));
    }
    let message = format!(
        "the memory budget is {}, and under the policy \"{}\" {} are held: {}",
        bytes(budget),
        least.name(),
        bytes(needed),
        parts.join(", "),
    );
    let mut diagnostic = Diagnostic::error(Code::MEMORY_BUDGET, message);
    let live = live(plan);
    if let Some(pass) = plan.passes.get(memory.largest_at) {
        let resources = if live.len() == 1 { "1 resource".to_owned() } else { format!("{} resources", live.len()) };
        let most = format!("here {} are live at once, in {resources}", bytes(memory.lower_bound));
        diagnostic = diagnostic.at(pass.span, most);
    }
    for id in live.into_iter().take(NAMED) {
        let object = &plan.objects[id];
        let takes = format!("`{}` takes {}", object.path, bytes(memory::bytes(&object.kind)));
        diagnostic = diagnostic.see(object.span, takes);
    }
    Box::new(diagnostic.hint(hint(plan, request, budget)))
}

fn hint(plan: &Plan, request: &MemoryRequest, budget: u64) -> String {
    let held = |policy: Policy| plan.memory.held(policy) + request.elsewhere;
    if let Some(less) = Policy::ALL.into_iter().find(|policy| held(*policy) <= budget) {
        let waits = match plan.memory.cuts(less).len() {
            0 => String::new(),
            1 => ", and waits for the device once in it".into(),
            n => format!(", and waits for the device {n} times in it"),
        };
        let (name, held) = (less.name(), bytes(held(less)));
        return format!("the policy \"{name}\" holds {held}, and has every pass run in each frame{waits}");
    }
    let is_of_picture = |id: &ObjectId| match &plan.objects[*id].kind {
        ObjectKind::Texture(texture) => [texture.width, texture.height] == plan.viewport,
        ObjectKind::Buffer(_) => false,
    };
    match live(plan).first().is_some_and(is_of_picture) {
        true => "a smaller picture takes less, or smaller resources".into(),
        false => "smaller resources take less".into(),
    }
}

/// What is live where most is, the largest first.
fn live(plan: &Plan) -> Vec<ObjectId> {
    let at = plan.memory.largest_at;
    let mut live: Vec<ObjectId> = (plan.objects.iter().enumerate())
        .filter(|(_, object)| object.origin == Origin::Frame)
        .filter(|(id, object)| {
            let is_output = || plan.outputs.iter().any(|output| super::print::object_id(plan, output.object) == *id);
            object.lifetime.is_some_and(|(first, last)| first <= at && (at <= last || is_output()))
        })
        .map(|(id, _)| id)
        .collect();
    live.sort_by_key(|id| (std::cmp::Reverse(memory::bytes(&plan.objects[*id].kind)), *id));
    live
}
