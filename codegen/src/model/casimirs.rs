//! The Casimirs of a system by names that people know.

use std::ops::Range;

use super::{Factor, System, parts};
use crate::expr::{Expr, Number, Vector};
use crate::group::casimirs::{self, Polynomial, casimirs_of};
use crate::group::{Group, Semidirect, consecutive};

/// What a system's bracket keeps, with names.
pub type Casimirs<'a> = casimirs::Casimirs<(String, Expr<'a>)>;

/// Components that have a name in common, and a unit.
struct Block<'a> {
    name: String,
    axes: Vec<&'static str>,
    value: Vector<'a>,
}

impl<'a> System<'a> {
    /// The Casimirs of the bracket: those functions of momenta and advected parameters that the motion keeps whatever
    /// the energy's dependence on them. Of a momentum that a force or the energy's dependence on the configuration
    /// changes none is a function.
    pub fn casimirs(&self) -> &Casimirs<'a> {
        self.casimirs.get_or_init(|| {
            let mut all = Casimirs { found: Vec::new(), missing: 0 };
            // those of a product are those of its factors
            for (factor, algebra) in self.factors.iter().zip(&self.group.factors) {
                let Casimirs { found, missing } = of_factor(factor, algebra, self.is_kicked(factor));
                all.found.extend(found);
                all.missing += missing;
            }
            all
        })
    }
}

fn of_factor<'a>(factor: &Factor<'a>, algebra: &Semidirect, is_moved: bool) -> Casimirs<'a> {
    let mut blocks = momenta(factor, algebra.group);
    let momenta = blocks.len();
    let spaces = factor.advected.iter().zip(&algebra.spaces);
    blocks.extend(spaces.map(|(advected, space)| Block {
        name: advected.name.plain(),
        axes: space.coordinates().to_vec(),
        value: advected.value.clone(),
    }));
    // the momentum is one block: its parts are not scaled apart
    let lengths = std::iter::once(factor.momentum.len());
    let lengths = lengths.chain(blocks[momenta..].iter().map(|block| block.value.len()));
    let ranges = consecutive(lengths);
    let variables = if is_moved { &ranges[1..] } else { &ranges[..] };
    let Some(found) = casimirs_of(algebra, variables) else {
        return Casimirs { found: Vec::new(), missing: 0 };
    };
    let named = found.found.iter().map(|polynomial| named(polynomial, &blocks));
    Casimirs { found: named.collect(), missing: found.missing }
}

/// The parts of a factor's momentum.
fn momenta<'a>(factor: &Factor<'a>, group: &dyn Group) -> Vec<Block<'a>> {
    let name = &factor.momentum_name;
    let block = |name, rows: Range<usize>| Block {
        name,
        axes: group.axes()[rows.clone()].to_vec(),
        value: factor.momentum.part(rows),
    };
    match parts(group, &name.ident) {
        parts if parts.is_empty() => vec![block(name.plain(), 0..group.dimension())],
        parts => parts.into_iter().map(|part| block(name.with(&part.momentum), part.rows)).collect(),
    }
}

/// A polynomial of the components of these blocks: an inner product of two of them, or its terms.
fn named<'a>(polynomial: &Polynomial, blocks: &[Block<'a>]) -> (String, Expr<'a>) {
    let inner = (0..blocks.len()).flat_map(|i| (i..blocks.len()).map(move |j| (i, j)));
    let rows = consecutive(blocks.iter().map(|block| block.value.len()));
    for (i, j) in inner {
        let (a, b) = (&blocks[i], &blocks[j]);
        let length = a.value.len();
        let product = (0..length).map(|k| (vec![rows[i].start + k, rows[j].start + k], 1));
        if length > 1 && length == b.value.len() && *polynomial == product.collect::<Polynomial>() {
            let name = if i == j { format!("|{}|²", a.name) } else { format!("{}·{}", a.name, b.name) };
            return (name, a.value.dot(&b.value));
        }
    }
    let components: Vec<(String, Expr<'a>)> = blocks.iter().flat_map(components).collect();
    let mut text = String::new();
    let mut sum: Option<Expr<'a>> = None;
    for (monomial, &coefficient) in polynomial {
        let (name, value) = term(monomial, coefficient, &components);
        text = match (text.is_empty(), name.strip_prefix('−')) {
            (true, _) => name,
            (false, Some(name)) => format!("{text} − {name}"),
            (false, None) => format!("{text} + {name}"),
        };
        sum = Some(sum.map_or(value, |sum| sum + value));
    }
    (text, sum.unwrap_or_else(|| blocks[0].value.0[0]))
}

/// `momentum.x`; `momentum` where there is only one.
fn components<'a>(block: &Block<'a>) -> Vec<(String, Expr<'a>)> {
    let name = |axis: &str| match block.axes.len() {
        1 => block.name.clone(),
        _ => format!("{}.{axis}", block.name),
    };
    block.axes.iter().map(|axis| name(axis)).zip(block.value.iter()).collect()
}

/// `4 momentum.e momentum.f`
fn term<'a>(monomial: &[usize], coefficient: i64, components: &[(String, Expr<'a>)]) -> (String, Expr<'a>) {
    let arena = components[0].1.arena();
    let mut value = arena.number(Number::ratio(coefficient.into(), 1));
    let mut factors = match coefficient {
        1 => Vec::new(),
        -1 => vec!["−".to_owned()],
        _ => vec![coefficient.to_string().replace('-', "−")],
    };
    let mut rest = monomial;
    while let Some(&first) = rest.first() {
        let exponent = rest.iter().take_while(|&&variable| variable == first).count();
        rest = &rest[exponent..];
        let (name, component) = &components[first];
        let power = ["", "²", "³", "⁴"][exponent.min(4) - 1];
        factors.push(format!("{name}{power}"));
        (0..exponent).for_each(|_| value = value * *component);
    }
    (factors.join(" ").replacen("− ", "−", 1), value)
}
