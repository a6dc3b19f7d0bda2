//! Unique names for values.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::expr::Arena;
use crate::kernel::factor::Factoring;
use crate::kernel::plan::{Op, Plan};

/// Gives every value that needs one a unique name.
pub(in crate::kernel) struct Namer {
    /// Role names that the method gave.
    roles: FxHashMap<Op, String>,
    used: FxHashSet<String>,
}

/// Words that generated functions use for themselves, and the language's.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "state", "step", "unknown", "evaluation", "point", "costate", "through", "columns", "parameters", "time", "control", "self", "super", "crate", "as", "async", "await", "break",
    "const", "continue", "dyn", "else", "enum", "extern", "false", "fn", "for", "if", "impl", "in", "let", "loop", "match",
    "mod", "move", "mut", "pub", "ref", "return", "static", "struct", "trait", "true", "type", "unsafe", "use", "where",
    "while", "yield", "abstract", "become", "box", "do", "final", "gen", "macro", "override", "priv", "try", "typeof",
    "unsized", "virtual",
];

impl Namer {
    pub(in crate::kernel) fn new() -> Self {
        Self { roles: FxHashMap::default(), used: RESERVED.iter().map(|&word| word.to_owned()).collect() }
    }

    /// Takes over role names for the nodes its expressions became.
    pub(in crate::kernel) fn carry_over<'a>(
        &mut self,
        arena: &'a Arena,
        factoring: &Factoring<'a>,
        plan: &Plan<'a>,
    ) {
        for (id, name) in arena.roles() {
            // the name is for the value, not for its negative
            if let Some(signed) = plan.planned(factoring.known(id))
                && !signed.negative
                && !plan.operation(signed.op).is_leaf()
            {
                self.roles.entry(signed.op).or_insert(name);
            }
        }
    }

    /// The role name of a node, if it has one.
    pub(super) fn role(&self, op: Op) -> Option<&str> {
        self.roles.get(&op).map(String::as_str)
    }

    /// Gives a name back.
    pub(super) fn release(&mut self, name: &str) {
        self.used.remove(name);
    }

    /// The name, made unique.
    pub(super) fn claim(&mut self, mut name: String) -> String {
        while !self.used.insert(name.clone()) {
            name.push('_');
        }
        name
    }

    pub(super) fn numbered(&mut self, prefix: &str) -> String {
        let mut n = 0;
        while self.used.contains(&format!("{prefix}{n}")) {
            n += 1;
        }
        self.claim(format!("{prefix}{n}"))
    }
}
