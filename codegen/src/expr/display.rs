//! Expressions as text, for documentation and messages.

use std::fmt;

use rustc_hash::{FxHashMap, FxHashSet};

use super::arena::Arena;
use super::expression::Expr;
use super::node::{Id, Node};

/// How many nodes `Display` writes of an expression before it leaves out the rest. Written as a tree, an expression can
/// be exponentially longer than its graph; [`Formulas`] writes large ones.
const DISPLAYED: usize = 1_000;

/// A subexpression of less than so many leaves is repeated rather than named.
const WORTH_A_NAME: usize = 5;

/// How tightly the surroundings bind.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Power,
}

/// What is still to be written.
enum Piece {
    Text(String),
    Node(Id, Binding),
}

impl Piece {
    fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl fmt::Display for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(self.arena, self.id, &FxHashMap::default(), DISPLAYED, f)
    }
}

/// Writes a node with `names` in the place of those that have one, and `…` after so many nodes. Without recursion, for
/// a chain of calls can be long.
fn write(
    arena: &Arena,
    id: Id,
    names: &FxHashMap<Id, String>,
    limit: usize,
    out: &mut dyn fmt::Write,
) -> fmt::Result {
    let mut pending = pieces(arena, id, Binding::Sum);
    pending.reverse();
    let mut written = 0;
    while let Some(piece) = pending.pop() {
        match piece {
            Piece::Text(text) => out.write_str(&text)?,
            Piece::Node(id, around) => {
                written += 1;
                if let Some(name) = names.get(&id) {
                    out.write_str(name)?;
                } else if written > limit {
                    out.write_str("…")?;
                } else {
                    pending.extend(pieces(arena, id, around).into_iter().rev());
                }
            }
        }
    }
    Ok(())
}

/// A node's text, with places for its operands.
fn pieces(arena: &Arena, id: Id, around: Binding) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let whole = |operand: Id| Piece::Node(operand, Binding::Sum);
    let parenthesized = match arena.node(id) {
        Node::Number(number) => {
            let text = number.to_string();
            let needed = around > Binding::Sum && (number.is_negative() || text.contains('/'));
            pieces.push(Piece::Text(text));
            needed
        }
        Node::Symbol(symbol) => {
            pieces.push(Piece::Text(arena.symbol_info(symbol).name));
            false
        }
        Node::Sum(sum) => {
            for (i, &(id, coefficient)) in sum.terms.iter().enumerate() {
                pieces.push(Piece::text(sign(i, coefficient.is_negative())));
                if !coefficient.abs().is_one() {
                    pieces.push(Piece::Text(format!("{} ", coefficient.abs())));
                }
                pieces.push(Piece::Node(id, Binding::Product));
            }
            if !sum.constant.is_zero() {
                let sign = sign(sum.terms.len(), sum.constant.is_negative());
                pieces.push(Piece::Text(format!("{sign}{}", sum.constant.abs())));
            }
            let lone = sum.is_scaled_term();
            around > if lone { Binding::Product } else { Binding::Sum }
                || (lone && around > Binding::Sum && sum.terms[0].1.is_negative())
        }
        Node::Product(factors) => {
            for (i, &(id, exponent)) in factors.iter().enumerate() {
                if i > 0 {
                    pieces.push(Piece::text(" "));
                }
                pieces.push(Piece::Node(id, Binding::Power));
                if exponent != 1 {
                    pieces.push(Piece::Text(format!("^{exponent}")));
                }
            }
            around > Binding::Product
        }
        Node::Held(inner) => {
            pieces.extend([Piece::text("["), whole(inner), Piece::text("]")]);
            false
        }
        Node::Function(function, argument) => {
            let name = Piece::Text(format!("{}(", function.name()));
            pieces.extend([name, whole(argument), Piece::text(")")]);
            false
        }
        Node::Power(base, exponent) => {
            let base = Piece::Node(base, Binding::Power);
            pieces.extend([base, Piece::text("^("), whole(exponent), Piece::text(")")]);
            false
        }
        Node::Atan2(y, x) => {
            pieces.extend([Piece::text("atan2("), whole(y), Piece::text(", "), whole(x), Piece::text(")")]);
            false
        }
        Node::Choice([x, y, z]) => {
            pieces.extend([Piece::text("if("), whole(x), Piece::text(" < 0, "), whole(y)]);
            pieces.extend([Piece::text(", "), whole(z), Piece::text(")")]);
            false
        }
    };
    if parenthesized {
        pieces.insert(0, Piece::text("("));
        pieces.push(Piece::text(")"));
    }
    pieces
}

/// The sign before an addend at this place of a sum.
pub(crate) fn sign(place: usize, negative: bool) -> &'static str {
    match (place, negative) {
        (0, false) => "",
        (0, true) => "-",
        (_, false) => " + ",
        (_, true) => " - ",
    }
}

/// Equations as text of the length of their graph: what occurs more than once gets a line and a name of its own, `s1`,
/// `s2`, …
pub struct Formulas<'a> {
    arena: &'a Arena,
    names: FxHashMap<Id, String>,
    equations: Vec<(String, Id)>,
}

impl<'a> Formulas<'a> {
    /// No equations yet. Each of `names` is what a symbol is called in the place of its own name.
    pub fn new(arena: &'a Arena, names: impl IntoIterator<Item = (Expr<'a>, String)>) -> Self {
        let names = names.into_iter().map(|(symbol, name)| (symbol.id, name)).collect();
        Self { arena, names, equations: Vec::new() }
    }

    /// Adds `name = expr`.
    pub fn push(&mut self, name: String, expr: Expr<'a>) {
        self.equations.push((name, expr.id));
    }

    /// The lines, each name before it is used; `None` if they have more than so many bytes together.
    pub fn lines(mut self, longest: usize) -> Option<Vec<String>> {
        let definitions = self.name_what_is_shared();
        let mut lines = Vec::new();
        let mut length = 0;
        let equations = std::mem::take(&mut self.equations).into_iter().map(|(name, id)| {
            let known = self.names.get(&id).cloned();
            (name, id, known)
        });
        let definitions = definitions.into_iter().map(|(name, id)| (name, id, None));
        for (name, id, known) in definitions.chain(equations) {
            let line = format!("{name} = {}", known.unwrap_or_else(|| self.text(id, longest)));
            length += line.len();
            if length > longest {
                return None;
            }
            lines.push(line);
        }
        Some(lines)
    }

    /// A node's formula, even if the node has a name; of a longer one the beginning.
    fn text(&self, id: Id, longest: usize) -> String {
        let mut text = String::new();
        let written = write(self.arena, id, &self.names, longest, &mut text);
        debug_assert!(written.is_ok(), "a string takes everything");
        text
    }

    /// Gives names to what is used more than once, each before it is used, and returns them.
    fn name_what_is_shared(&mut self) -> Vec<(String, Id)> {
        let outputs: Vec<Id> = self.equations.iter().map(|&(_, id)| id).collect();
        let nodes = self.arena.post_order(outputs.iter().copied(), |_| false);
        let mut uses: FxHashMap<Id, usize> = FxHashMap::default();
        let operands = nodes.iter().flat_map(|&id| self.arena.node(id).operands().collect::<Vec<_>>());
        operands.chain(outputs).for_each(|id| *uses.entry(id).or_default() += 1);
        let symbols = nodes.iter().filter_map(|&id| self.arena.expr(id).as_symbol());
        let mut taken: FxHashSet<String> =
            symbols.map(|symbol| self.arena.symbol_info(symbol).name).collect();
        taken.extend(self.names.values().cloned());

        let mut free = (1..).map(|i| format!("s{i}")).filter(|name| !taken.contains(name));
        let mut leaves: FxHashMap<Id, usize> = FxHashMap::default();
        let mut definitions = Vec::new();
        for id in nodes {
            let node = self.arena.node(id);
            let mut count = node.operands().map(|operand| leaves[&operand]).sum::<usize>().max(1);
            if count >= WORTH_A_NAME && uses[&id] > 1 {
                let name = free.next().unwrap_or_default();
                self.names.insert(id, name.clone());
                definitions.push((name, id));
                count = 1;
            }
            leaves.insert(id, count);
        }
        definitions
    }
}
