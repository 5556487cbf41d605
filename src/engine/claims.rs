//! Who writes to an embedder's memory. Two graphs that write to the same texture would each find
//! there what the other left, depending on which ran last.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::pool::Memory;

#[derive(Debug)]
struct Claim {
    memory: Memory,
    owner: Weak<()>,
    /// The graph and its object, for messages.
    graph: String,
    object: String,
}

/// What the runners of a device write to that is not theirs.
#[derive(Clone, Debug, Default)]
pub(super) struct Claims(Arc<Mutex<Vec<Claim>>>);

/// A runner, and those that follow it.
#[derive(Clone, Debug)]
pub(super) struct Claimant {
    claims: Claims,
    me: Arc<()>,
}

impl Claimant {
    pub fn new(claims: &Claims) -> Self {
        Self { claims: claims.clone(), me: Arc::new(()) }
    }

    /// Notes that an object is written to this memory, in place of what it was written to before.
    ///
    /// # Errors
    /// With the graph and the object that write to it already.
    pub fn claim(&self, memory: &Memory, graph: &str, object: &str) -> Result<(), (String, String)> {
        let mut claims = self.claims.0.lock().unwrap_or_else(PoisonError::into_inner);
        claims.retain(|claim| {
            let is_mine = Weak::as_ptr(&claim.owner) == Arc::as_ptr(&self.me);
            claim.owner.strong_count() > 0 && !(is_mine && claim.object == object)
        });
        if let Some(other) = claims.iter().find(|claim| claim.memory == *memory) {
            return Err((other.graph.clone(), other.object.clone()));
        }
        claims.push(self.claimed(memory, graph, object));
        Ok(())
    }

    /// Notes that these objects are written, and no others.
    ///
    /// # Errors
    /// With the object of which the memory is written already, and the graph and the object that do; nothing has
    /// changed then.
    pub fn claim_only(&self, written: &[(&str, &Memory)], graph: &str) -> Result<(), [String; 3]> {
        let mut claims = self.claims.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_mine = |claim: &Claim| Weak::as_ptr(&claim.owner) == Arc::as_ptr(&self.me);
        for (object, memory) in written {
            let others = claims.iter().filter(|claim| claim.owner.strong_count() > 0 && !is_mine(claim));
            if let Some(other) = others.into_iter().find(|claim| claim.memory == **memory) {
                return Err([(*object).to_owned(), other.graph.clone(), other.object.clone()]);
            }
        }
        claims.retain(|claim| claim.owner.strong_count() > 0 && !is_mine(claim));
        claims.extend(written.iter().map(|(object, memory)| self.claimed(memory, graph, object)));
        Ok(())
    }

    fn claimed(&self, memory: &Memory, graph: &str, object: &str) -> Claim {
        Claim {
            memory: memory.clone(),
            owner: Arc::downgrade(&self.me),
            graph: graph.to_owned(),
            object: object.to_owned(),
        }
    }
}
