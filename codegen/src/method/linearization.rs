//! The derivative of a step, in closed form: the implicit function theorem on the step's own equation.
//!
//! Where `left(x) = right(x)` defines the unknown, a change of state, controls and parameters changes it by
//!
//! ```text
//! δx = −(∂F/∂x)⁻¹ δF,   F = left − right,
//! ```
//!
//! and the next state by what this makes of it. Configurations change by elements of the algebra, `g exp(δ)`, whatever they are stored as;
//! their part of the next state follows from the turns of the step, not from its stored coordinates, so that no normalization is
//! differentiated:
//!
//! ```text
//! g τ(x):  δ' = Ad_{τ(x)⁻¹} δ + dL τ_x δx = δ + dR τ_{−x} (δx − [x, δ])
//! τ(x) g:  δ' = δ + Ad_{g⁻¹} dL τ_x δx
//! ```

use super::Step;
use crate::expr::{Arena, Derivative, Expr, Stage, Symbol, Vector, gradient};
use crate::group::{Group, Retraction, d_right, placeholders};
use crate::model::{Factor, Side, System};

/// The change of the next state with all that it depends on: linear in the changes, which are symbols.
pub struct Linearization<'a> {
    /// The change of the state in the order of storage, with an element of the algebra in the place of each configuration.
    pub state: Vector<'a>,
    /// The change of the controls.
    pub control: Vector<'a>,
    /// The change of the parameters, constants included.
    pub parameters: Vector<'a>,
    /// The change of the next state, in the order of [`state`](Self::state).
    pub next: Vector<'a>,
}

impl<'a> Linearization<'a> {
    /// Of a step with this retraction.
    pub fn new(arena: &'a Arena, system: &System<'a>, retraction: Retraction, step: &Step<'a>) -> Self {
        let changes = |name: &str, count: usize| {
            let symbol = |k: usize| arena.symbol(format!("{name}_{}", k + 1), Stage::Iteration);
            Vector((0..count).map(symbol).collect())
        };
        let rows: Vec<Row<'_, 'a>> = rows(system);
        let state = changes("state_change", rows.iter().map(Row::len).sum());
        let control = changes("control_change", system.control_symbols().len());
        let parameters = changes("parameter_change", system.parameter_symbols().len());

        let mut direction: Vec<(Symbol, Expr<'a>)> = Vec::new();
        let mut starts = state.0.clone().into_iter();
        for row in &rows {
            let change = Vector(starts.by_ref().take(row.len()).collect());
            match row {
                Row::Configuration(_, factor) => {
                    let stored = tangent(factor.algebra.group, &factor.configuration, &change);
                    direction.extend(factor.configuration.symbols().into_iter().zip(stored.iter()));
                }
                Row::Linear(symbols) => direction.extend(symbols.iter().copied().zip(change.iter())),
            }
        }
        direction.extend(system.control_symbols().into_iter().zip(control.iter()));
        direction.extend(system.parameter_symbols().into_iter().zip(parameters.iter()));

        // what the unknown does
        let unknown = step.unknown.symbols();
        if !unknown.is_empty() {
            let residual = &step.left - &step.right;
            let mut explicit = Derivative::along(arena, &direction);
            let shift = residual.map(|component| -explicit.of(component));
            let change = residual.jacobian(&unknown).map(Expr::hold).solve(&shift.hold()).hold();
            direction.extend(unknown.into_iter().zip(change.iter()));
        }

        let mut total = Derivative::along(arena, &direction);
        let mut along = |vector: &Vector<'a>| vector.map(|component| total.of(component));
        let stored = system.state_symbols();
        let mut next = Vec::new();
        let mut starts = state.0.clone().into_iter();
        for row in &rows {
            let change = Vector(starts.by_ref().take(row.len()).collect());
            match row {
                Row::Configuration(index, factor) => {
                    let group = factor.algebra.group;
                    let moved = step.turns[*index].iter().fold(change, |change, turn| {
                        let by = along(&turn.by);
                        let backwards = turn.by.scale(-arena.one());
                        match system.side {
                            Side::Left => {
                                let inner = &by - &group.bracket(&turn.by, &change);
                                &change + &d_right(group, retraction, &backwards, &inner)
                            }
                            Side::Right => {
                                let inner = d_right(group, retraction, &backwards, &by);
                                &change + &to_body(group, &turn.from, &inner)
                            }
                        }
                        .hold()
                    });
                    next.extend(moved.0);
                }
                Row::Linear(symbols) => {
                    let of = |symbol: &Symbol| stored.iter().position(|known| known == symbol);
                    let values = symbols.iter().filter_map(of).map(|k| step.next.0[k]);
                    next.extend(along(&Vector(values.collect())).0);
                }
            }
        }
        Self { state, control, parameters, next: Vector(next) }
    }
}

/// The transpose of a [`Linearization`]: how a linear function of the next state depends on all that this depends on.
pub struct Adjoint<'a> {
    /// The coefficients of the function: symbols, in the order of [`Linearization::next`].
    pub next: Vector<'a>,
    /// Its derivative by the state.
    pub state: Vector<'a>,
    /// Its derivative by the controls.
    pub control: Vector<'a>,
    /// Its derivative by the parameters.
    pub parameters: Vector<'a>,
}

impl<'a> Linearization<'a> {
    /// The transpose, by the reverse mode: as many operations as the linearization itself has, or few more.
    pub fn adjoint(&self, arena: &'a Arena) -> Adjoint<'a> {
        let costate = |k: usize| arena.symbol(format!("costate_{}", k + 1), Stage::Iteration);
        let next = Vector((0..self.next.len()).map(costate).collect());
        let changes = [&self.state, &self.control, &self.parameters];
        let symbols: Vec<Symbol> = changes.iter().flat_map(|change| change.symbols()).collect();
        let mut derivatives = gradient(self.next.dot(&next), &symbols).0.into_iter();
        let mut take = |change: &Vector<'a>| Vector(derivatives.by_ref().take(change.len()).collect());
        let [state, control, parameters] = changes.map(&mut take);
        Adjoint { next, state, control, parameters }
    }
}

/// A part of the state, in the order of storage.
enum Row<'s, 'a> {
    /// The configuration of a factor.
    Configuration(usize, &'s Factor<'a>),
    /// A momentum or an advected parameter.
    Linear(Vec<Symbol>),
}

impl Row<'_, '_> {
    /// How many numbers its change is.
    fn len(&self) -> usize {
        match self {
            Self::Configuration(_, factor) => factor.algebra.group.dimension(),
            Self::Linear(symbols) => symbols.len(),
        }
    }
}

fn rows<'s, 'a>(system: &'s System<'a>) -> Vec<Row<'s, 'a>> {
    let factors = system.factors.iter().enumerate();
    let of_factors = factors.flat_map(|(index, factor)| {
        [Row::Configuration(index, factor), Row::Linear(factor.momentum.symbols())]
    });
    let advected = system.advected_places();
    let advected = advected.map(|(factor, place)| Row::Linear(factor.advected[place].value.symbols()));
    of_factors.chain(advected).collect()
}

/// The change of the stored coordinates where `g` becomes `g exp(δ)`.
fn tangent<'a>(group: &dyn Group, g: &Vector<'a>, change: &Vector<'a>) -> Vector<'a> {
    let arena = g.0[0].arena();
    let delta = placeholders(arena, "d", change.len());
    let moved = group.compose(g, &group.retract(Retraction::Exponential, &delta));
    let zero: Vec<_> = delta.symbols().into_iter().map(|symbol| (symbol, arena.zero())).collect();
    moved.derivative_along(&delta.symbols(), change).substitute(&zero)
}

/// `Ad_{g⁻¹} x`, from its dual.
fn to_body<'a>(group: &dyn Group, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
    let m = placeholders(g.0[0].arena(), "m", x.len());
    gradient(group.to_space(g, &m).dot(x), &m.symbols())
}
