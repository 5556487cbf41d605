//! The smallest policy: the frame in parts, between which memory that is over is given back.
//!
//! wgpu puts no texture where one of another description was, so that sharing by lifetimes alone
//! holds the largest live set of each description. Where that is much more than what is live at
//! once, the frame is cut: what was recorded up to there is handed over, and when the device is done
//! with it, memory that is over is let go and what comes next is made. Each cut makes the frame wait,
//! so there are as few as keep below the limit; each lies as late as it can, when most is over.
//!
//! The picture is there all the time; what else is looked at after the frame is there until the next
//! begins. Draws that share a render pass and the passes of one `Steps` are not parted.

use std::collections::HashMap;
use std::ops::Range;

use super::memory::{Life, class, lives, total};
use super::merge;
use super::model::{Apart, Cut, Memory, ObjectId, Plan, Slot, Texture};

/// What the parts of a frame may hold, in tenths of the largest live set, where nobody says: a cut
/// costs more than memory that is there anyway.
const ROOM: u64 = 13;

/// A cut that gives back less than this part of the limit is not worth its wait, unless that is
/// enough to keep to the limit.
const WORTH: u64 = 16;

/// How many limits are tried.
const LIMITS: u64 = 7;

/// The memory of the smallest policy.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Parted {
    pub slots: Vec<Slot>,
    pub cuts: Vec<Cut>,
    /// Bytes that are held in each part of the frame.
    pub held: Vec<u64>,
}

impl Parted {
    /// Makes it that of the plan, and gives what was there before.
    pub fn put(self, memory: &mut Memory) -> Parted {
        Parted {
            slots: std::mem::replace(&mut memory.smallest, self.slots),
            cuts: std::mem::replace(&mut memory.cuts, self.cuts),
            held: std::mem::replace(&mut memory.parts, self.held),
        }
    }

    fn peak(&self) -> u64 {
        self.held.iter().copied().max().unwrap_or(0)
    }
}

/// As few cuts as keep to `room` bytes for the frame, or to a little more than the largest live set;
/// none where sharing by lifetimes alone does.
pub(super) fn parted(plan: &Plan, room: Option<u64>) -> Parted {
    let memory = &plan.memory;
    let whole = total(&memory.share);
    let least = memory.lower_bound;
    let wanted = room.unwrap_or(least / 10 * ROOM).max(least);
    let mut best = Parted { slots: memory.share.clone(), cuts: Vec::new(), held: vec![whole] };
    if whole <= wanted {
        return best;
    }
    let scene = Scene::new(plan);
    let rank = |parted: &Parted| (parted.peak().max(wanted), parted.cuts.len(), parted.peak());
    // What lies unused between what lives may exceed a limit, which a lower one then keeps to.
    for n in (0..LIMITS).rev() {
        let packed = scene.pack(least + (wanted - least) / (LIMITS - 1) * n);
        if packed.peak() < whole && rank(&packed) < rank(&best) {
            best = packed;
        }
    }
    best
}

/// What is packed, the same for every limit.
struct Scene<'p> {
    plan: &'p Plan,
    /// In order of first use.
    lives: Vec<Life>,
    /// Of each life, which can share memory: the same number for textures that are described alike,
    /// and for all buffers.
    classes: Vec<usize>,
    /// Of each life, whether it is the picture.
    is_picture: Vec<bool>,
    /// Passes between which no cut lies, in order.
    blocks: Vec<Range<usize>>,
}

impl<'p> Scene<'p> {
    fn new(plan: &'p Plan) -> Self {
        let is_looked_at = |id: ObjectId| plan.memory.apart.get(&id) == Some(&Apart::LookedAt);
        let picture = plan.outputs.first().map(|output| merge::candidates(plan, output.object)).unwrap_or_default();
        let lives = lives(&plan.objects, plan.passes.len(), &is_looked_at);
        let mut numbers: HashMap<Option<Texture>, usize> = HashMap::new();
        let number = |life: &Life| {
            let next = numbers.len();
            *numbers.entry(class(&plan.objects[life.id].kind)).or_insert(next)
        };
        let classes = lives.iter().map(number).collect();
        let is_picture = lives.iter().map(|life| picture.contains(&life.id)).collect();
        Self { plan, lives, classes, is_picture, blocks: blocks(plan) }
    }

    fn pack(&self, limit: u64) -> Parted {
        let mut packing = Packing::start(self, limit);
        let mut at = 0;
        for block in &self.blocks {
            let end = at + self.lives[at..].partition_point(|life| life.first < block.end);
            packing.block(block.start, at..end);
            at = end;
        }
        packing.end(self.plan)
    }
}

/// Ranges of passes that no cut parts.
fn blocks(plan: &Plan) -> Vec<Range<usize>> {
    // Without shared memory the most draws share a render pass.
    let leaders = merge::leaders(plan, &|id| id);
    let mut starts: Vec<bool> = leaders.iter().enumerate().map(|(pass, leader)| pass == *leader).collect();
    for steps in &plan.steps {
        starts[steps.passes.clone()].iter_mut().skip(1).for_each(|start| *start = false);
        // A render pass may not go on behind steps.
        [steps.passes.start, steps.passes.end]
            .iter()
            .for_each(|at| starts.get_mut(*at).into_iter().for_each(|s| *s = true));
    }
    let mut at: Vec<usize> = (0..starts.len()).filter(|pass| starts[*pass]).collect();
    at.push(starts.len());
    at.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// Memory that objects lie in, one after another.
#[derive(Clone)]
struct Place {
    objects: Vec<ObjectId>,
    bytes: u64,
    /// From this pass on nobody lies in it.
    free_at: usize,
    /// The picture, and the pass from which on it lies here: such memory is there all the time.
    picture: Option<(ObjectId, usize)>,
    /// The parts of the frame in which it is there.
    parts: Range<usize>,
}

/// What a block did, to take it back.
enum Done {
    New { class: usize },
    Taken { place: usize, bytes: u64, free_at: usize, end: usize },
}

struct Packing<'s> {
    scene: &'s Scene<'s>,
    limit: u64,
    places: Vec<Place>,
    /// Of each class the places that may take an object of this part.
    open: Vec<Vec<usize>>,
    cuts: Vec<usize>,
    /// Bytes that are held in the part at hand.
    held: u64,
}

impl<'s> Packing<'s> {
    fn start(scene: &'s Scene<'s>, limit: u64) -> Self {
        let classes = scene.classes.iter().max().map_or(0, |last| last + 1);
        let mut packing =
            Self { scene, limit, places: Vec::new(), open: vec![Vec::new(); classes], cuts: Vec::new(), held: 0 };
        for (at, life) in scene.lives.iter().enumerate().filter(|(at, _)| scene.is_picture[*at]) {
            let picture = Some((life.id, life.first));
            packing.add(scene.classes[at], Place { picture, ..Place::new(life.bytes, 0) });
        }
        packing
    }

    fn add(&mut self, class: usize, place: Place) {
        self.held += place.bytes;
        self.open[class].push(self.places.len());
        self.places.push(place);
    }

    /// Finds memory for what begins in a block of passes, after a cut if there is not enough.
    fn block(&mut self, start: usize, lives: Range<usize>) {
        let held = self.held;
        let mut done = Vec::new();
        for at in lives.clone() {
            done.extend(self.place(at));
        }
        let (excess, over) = (self.held.saturating_sub(self.limit), self.over(start));
        let is_worth = over > 0 && (over >= excess || over >= self.limit / WORTH);
        if excess == 0 || self.held == held || !is_worth {
            return;
        }
        while let Some(done) = done.pop() {
            self.take_back(&done);
        }
        self.held = held;
        self.cut(start);
        lives.for_each(|at| _ = self.place(at));
    }

    /// Bytes that a cut before a pass would give back.
    fn over(&self, pass: usize) -> u64 {
        let part = self.cuts.len();
        let is_over = |p: &&Place| p.picture.is_none() && p.free_at <= pass && p.parts.end > part;
        self.places.iter().filter(is_over).map(|place| place.bytes).sum()
    }

    fn cut(&mut self, before: usize) {
        self.cuts.push(before);
        let part = self.cuts.len();
        self.held = 0;
        for place in &mut self.places {
            if place.picture.is_some() || (place.free_at > before && place.parts.end == part) {
                place.parts.end = part + 1;
                self.held += place.bytes;
            }
        }
        // What was there in the part before may go on.
        let places = &self.places;
        self.open.iter_mut().for_each(|open| open.retain(|place| places[*place].parts.end >= part));
    }

    /// Finds memory for one object.
    fn place(&mut self, at: usize) -> Option<Done> {
        let scene = self.scene;
        if scene.is_picture[at] {
            return None;
        }
        let (life, class, part) = (scene.lives[at], scene.classes[at], self.cuts.len());
        let free =
            |place: &Place| place.free_at <= life.first && place.picture.is_none_or(|(_, from)| life.last < from);
        let is_there = |place: &Place| place.parts.end == part + 1;
        let candidates = || self.open[class].iter().copied().filter(|place| free(&self.places[*place]));
        let enough = candidates()
            .filter(|place| is_there(&self.places[*place]) && self.places[*place].bytes >= life.bytes)
            .min_by_key(|place| (self.places[*place].bytes, *place));
        // What was over before the cut is kept for its like.
        let goes_on = || candidates().find(|p| !is_there(&self.places[*p]) && self.places[*p].bytes == life.bytes);
        // What was made for this part may be made larger.
        let grows = || {
            let new =
                candidates().filter(|place| is_there(&self.places[*place]) && self.places[*place].parts.start == part);
            new.filter(|place| self.places[*place].picture.is_none()).max_by_key(|place| self.places[*place].bytes)
        };
        let found = enough.or_else(goes_on).or_else(grows);
        let Some(found) = found else {
            let mut place = Place::new(life.bytes, part);
            (place.objects, place.free_at) = (vec![life.id], life.last + 1);
            self.add(class, place);
            return Some(Done::New { class });
        };
        let place = &mut self.places[found];
        let was = Done::Taken { place: found, bytes: place.bytes, free_at: place.free_at, end: place.parts.end };
        let before = if place.parts.end == part + 1 { place.bytes } else { 0 };
        place.bytes = place.bytes.max(life.bytes);
        self.held += place.bytes - before;
        (place.free_at, place.parts.end) = (life.last + 1, part + 1);
        place.objects.push(life.id);
        Some(was)
    }

    fn take_back(&mut self, done: &Done) {
        match *done {
            Done::New { class } => {
                self.places.pop();
                self.open[class].pop();
            }
            Done::Taken { place, bytes, free_at, end } => {
                let place = &mut self.places[place];
                (place.bytes, place.free_at, place.parts.end) = (bytes, free_at, end);
                place.objects.pop();
            }
        }
    }

    fn end(mut self, plan: &Plan) -> Parted {
        for place in &mut self.places {
            place.objects.extend(place.picture.map(|(id, _)| id));
        }
        self.places.sort_by_key(|place| place.objects.first().map(|id| (plan.objects[*id].lifetime, *id)));
        let of = |wanted: &dyn Fn(&Place) -> bool| -> Vec<usize> {
            (0..self.places.len()).filter(|place| wanted(&self.places[*place])).collect()
        };
        let cuts = (1..).zip(&self.cuts).map(|(part, before)| Cut {
            before: *before,
            gives: of(&|place| place.parts.end == part),
            makes: of(&|place| place.parts.start == part),
        });
        let held = (0..=self.cuts.len())
            .map(|part| self.places.iter().filter(|place| place.parts.contains(&part)).map(|place| place.bytes).sum());
        Parted {
            cuts: cuts.collect(),
            held: held.collect(),
            slots: self
                .places
                .iter()
                .map(|place| Slot { objects: place.objects.clone(), bytes: place.bytes })
                .collect(),
        }
    }
}

impl Place {
    fn new(bytes: u64, part: usize) -> Self {
        Self { objects: Vec::new(), bytes, free_at: 0, picture: None, parts: part..part + 1 }
    }
}
