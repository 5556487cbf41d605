//! What functions do to globals, through calls.
//!
//! naga's own analysis knows reads and writes, but neither which accesses are atomic nor what is
//! done with a texture that is passed as an argument (it counts as read), so functions are walked
//! here: each once, callees first, with what a callee does to its arguments carried over to what
//! the caller passes.

use std::collections::{BTreeMap, BTreeSet};

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{AtomicFunction, Block, Expression, Handle, Statement, TypeInner};

/// What an expression leads back to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Root {
    /// Index in naga's arena of global variables.
    Global(usize),
    Argument(u32),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Access {
    pub read: bool,
    pub write: bool,
    pub atomic: bool,
    /// An `atomicLoad` is among the reads.
    atomic_load: bool,
    /// An atomic operation other than `atomicLoad` is among the accesses.
    atomic_change: bool,
    /// An atomic's old value is used.
    result: bool,
}

impl Access {
    const READ: Access =
        Access { read: true, write: false, atomic: false, atomic_load: false, atomic_change: false, result: false };
    const WRITE: Access = Access { read: false, write: true, ..Access::READ };
    const QUERY: Access = Access { read: false, ..Access::READ };
    const ATOMIC_LOAD: Access = Access { atomic: true, atomic_load: true, ..Access::READ };
    const ATOMIC_STORE: Access = Access { atomic: true, atomic_change: true, ..Access::WRITE };
    const ATOMIC: Access = Access { write: true, atomic: true, atomic_change: true, ..Access::READ };

    /// The order of threads may show in what the accesses yield.
    pub fn shows_order(self) -> bool {
        self.result || (self.atomic_load && self.atomic_change)
    }

    fn add(&mut self, other: Access) {
        self.read |= other.read;
        self.write |= other.write;
        self.atomic |= other.atomic;
        self.atomic_load |= other.atomic_load;
        self.atomic_change |= other.atomic_change;
        self.result |= other.result;
    }
}

/// What a function does, its callees' doings included.
#[derive(Clone, Debug, Default)]
pub(super) struct Doings {
    accesses: BTreeMap<Root, Access>,
    /// Names of the functions it calls.
    pub calls: BTreeSet<String>,
    pub discards: bool,
}

impl Doings {
    /// What is done to a global, if anything, by its index in naga's arena.
    pub fn of(&self, global: usize) -> Option<Access> {
        self.accesses.get(&Root::Global(global)).copied()
    }
}

/// All functions of a module, in naga's order.
pub(super) fn functions(module: &naga::Module, info: &ModuleInfo) -> Vec<Doings> {
    let mut known = Vec::with_capacity(module.functions.len());
    for (handle, function) in module.functions.iter() {
        known.push(doings(module, function, &info[handle], &known));
    }
    known
}

/// One function, given those that it may call.
pub(super) fn doings(
    module: &naga::Module,
    function: &naga::Function,
    info: &FunctionInfo,
    known: &[Doings],
) -> Doings {
    let mut walk = Walk { module, function, info, known, out: Doings::default() };
    for (_, expression) in function.expressions.iter() {
        walk.expression(expression);
    }
    walk.block(&function.body);
    walk.out
}

struct Walk<'a> {
    module: &'a naga::Module,
    function: &'a naga::Function,
    info: &'a FunctionInfo,
    known: &'a [Doings],
    out: Doings,
}

impl Walk<'_> {
    fn root(&self, mut at: Handle<Expression>) -> Option<Root> {
        loop {
            match self.function.expressions[at] {
                Expression::GlobalVariable(handle) => return Some(Root::Global(handle.index())),
                Expression::FunctionArgument(index) => return Some(Root::Argument(index)),
                Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => at = base,
                _ => return None,
            }
        }
    }

    fn note(&mut self, expression: Handle<Expression>, access: Access) {
        if let Some(root) = self.root(expression) {
            self.out.accesses.entry(root).or_insert(Access::QUERY).add(access);
        }
    }

    fn points_to_atomic(&self, pointer: Handle<Expression>) -> bool {
        match self.info[pointer].ty.inner_with(&self.module.types) {
            TypeInner::Pointer { base, .. } => matches!(self.module.types[*base].inner, TypeInner::Atomic(_)),
            _ => false,
        }
    }

    fn expression(&mut self, expression: &Expression) {
        match *expression {
            Expression::Load { pointer } if self.points_to_atomic(pointer) => self.note(pointer, Access::ATOMIC_LOAD),
            Expression::Load { pointer } => self.note(pointer, Access::READ),
            Expression::ImageSample { image, sampler, .. } => {
                self.note(image, Access::READ);
                self.note(sampler, Access::READ);
            }
            Expression::ImageLoad { image, .. } => self.note(image, Access::READ),
            Expression::ImageQuery { image, .. } => self.note(image, Access::QUERY),
            Expression::ArrayLength(array) => self.note(array, Access::QUERY),
            Expression::CooperativeLoad { data, .. } => self.note(data.pointer, Access::READ),
            _ => {}
        }
    }

    fn block(&mut self, block: &Block) {
        for statement in block {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Block(block) => self.block(block),
            Statement::If { accept, reject, .. } => {
                self.block(accept);
                self.block(reject);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    self.block(&case.body);
                }
            }
            Statement::Loop { body, continuing, .. } => {
                self.block(body);
                self.block(continuing);
            }
            Statement::Kill => self.out.discards = true,
            Statement::Call { function, arguments, .. } => self.call(*function, arguments),
            _ => self.access(statement),
        }
    }

    fn access(&mut self, statement: &Statement) {
        match *statement {
            Statement::Store { pointer, .. } if self.points_to_atomic(pointer) => {
                self.note(pointer, Access::ATOMIC_STORE);
            }
            Statement::Store { pointer, .. } => self.note(pointer, Access::WRITE),
            Statement::ImageStore { image, .. } => self.note(image, Access::WRITE),
            Statement::ImageAtomic { image, .. } => self.note(image, Access::ATOMIC),
            Statement::Atomic { pointer, fun, result, .. } => {
                let used = result.is_some_and(|result| self.info[result].ref_count > 0);
                // Whether a compared exchange happens is itself a matter of order.
                let compared = matches!(fun, AtomicFunction::Exchange { compare: Some(_) });
                self.note(pointer, Access { result: used || compared, ..Access::ATOMIC });
            }
            Statement::CooperativeStore { data, .. } => self.note(data.pointer, Access::WRITE),
            _ => {}
        }
    }

    fn call(&mut self, function: Handle<naga::Function>, arguments: &[Handle<Expression>]) {
        let Some(callee) = self.known.get(function.index()) else { return };
        for (root, access) in &callee.accesses {
            match root {
                Root::Global(_) => self.out.accesses.entry(*root).or_insert(Access::QUERY).add(*access),
                Root::Argument(index) => {
                    if let Some(argument) = arguments.get(*index as usize) {
                        self.note(*argument, *access);
                    }
                }
            }
        }
        self.out.discards |= callee.discards;
        self.out.calls.extend(callee.calls.iter().cloned());
        self.out.calls.extend(self.module.functions[function].name.clone());
    }
}
