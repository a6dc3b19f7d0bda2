//! The derivative of a step, in closed form: the implicit function theorem on the step's own equation.
//!
//! Where `left(x) = right(x)` defines the unknown, a perturbation of state, controls and parameters changes it by
//!
//! ```text
//! δx = −(∂F/∂x)⁻¹ δF,   F = left − right,
//! ```
//!
//! and the next state by what this makes of it. Configurations change by elements of the algebra, `g exp(δ)`, or
//! `exp(δ) g` where velocities are in space, whatever they are stored as; their part of the next state follows from the
//! increments of the step, not from its stored coordinates, so that no normalization is differentiated:
//!
//! ```text
//! g τ(x):  δ' = Ad_{τ(x)⁻¹} δ + dL τ_x δx,   Ad_{τ(x)⁻¹} δ = δ − dL τ_x [x, δ] where τ is equivariant
//! τ(x) g:  δ' = Ad_{τ(x)} δ + dR τ_x δx,     the same with τ̄ and −x in the places of τ and x
//! ```
//!
//! So does that of advected parameters, which these increments carry: `a' = Ad*_{τ(x)} a` changes by
//! `Ad*_{τ(x)} δa + ad*_ω a'`, `ω = dL τ_x δx`.

use super::step::{Increment, Step};
use crate::expr::{Arena, Derivative, Expr, Number, Stage, Symbol, Vector, gradient};
use crate::model::{Parts, System};
use crate::quantity::Kind;
use crate::scheme::Derivatives;

/// The perturbation of the next state with all that it depends on: linear in the perturbations, which are symbols.
pub struct Linearization<'a> {
    /// The perturbation of the unknown.
    pub unknown: Vector<'a>,
    /// Its value by the step's equation.
    pub solution: Vector<'a>,
    /// The perturbation of the next state, from that of the unknown and all others.
    pub partial: Vector<'a>,
    /// The perturbation of the state in the order of storage, with an element of the algebra in the place of each
    /// configuration.
    pub state: Vector<'a>,
    /// The perturbation of the controls.
    pub control: Vector<'a>,
    /// The perturbation of the parameters, the system's fields, if it is wanted.
    pub parameters: Vector<'a>,
    /// The perturbation of the next state, in the order of [`state`](Self::state).
    pub next: Vector<'a>,
}

impl<'a> Linearization<'a> {
    /// Of a step, by what is wanted.
    pub fn new(arena: &'a Arena, system: &System<'a>, step: &Step<'a>, wanted: Derivatives) -> Self {
        let state = Vector(system.tangent_names().iter().map(|name| perturbation(arena, name)).collect());
        let controls = system.control_symbols();
        let control = perturbations(arena, &controls);
        // fields may be many: to derive with respect to them takes its time
        let fields = if wanted.of_parameters() { &system.parameters[..] } else { &[] };
        let parameters = fields.iter().map(|field| perturbations(arena, &field.symbols));
        let parameters: Vec<Vector<'a>> = parameters.collect();
        let perturbed = system.split_tangent(&state);
        let mut direction = state_direction(system, &perturbed);
        direction.extend(controls.into_iter().zip(control.iter()));
        for (field, perturbation) in fields.iter().zip(&parameters) {
            let change = match field.kind {
                Kind::Symmetric(n) => symmetric_part(perturbation, n),
                _ => perturbation.clone(),
            };
            direction.extend(field.symbols.iter().copied().zip(change.0));
        }
        let parameters = Vector::concat(&parameters);

        // the implicit function theorem
        let symbols = step.unknown.symbols();
        let unknown = perturbations(arena, &symbols);
        let residual = &step.left - &step.right;
        let mut explicit = Derivative::along(arena, &direction).last();
        let shift = residual.map(|component| -explicit.of(component)).hold();
        let solution = residual.last_jacobian(&symbols).map(Expr::hold).solve(&shift).hold();
        direction.extend(symbols.into_iter().zip(unknown.iter()));

        let mut total = Derivative::along(arena, &direction).last();
        // both sides change alike, and the left one is simple
        for (left, right) in step.left.iter().zip(step.right.iter()) {
            let perturbation = total.of(left);
            total.know(right, perturbation);
        }
        let mut pushforward = Pushforward { system, step, total };
        let partial = system.join_tangent(&pushforward.of(perturbed));
        let found: Vec<_> = unknown.symbols().into_iter().zip(solution.iter()).collect();
        let next = partial.substitute(&found);
        Self { unknown, solution, partial, state, control, parameters, next }
    }
}

/// The symmetric part of a matrix, row by row: it is what steps are made of.
fn symmetric_part<'a>(matrix: &Vector<'a>, n: usize) -> Vector<'a> {
    let at = |i: usize, j: usize| matrix.0[i * n + j];
    let entry = |k: usize| {
        let (i, j) = (k / n, k % n);
        if i == j { at(i, i) } else { (at(i, j) + at(j, i)).scale(Number::ratio(1, 2)) }
    };
    Vector((0..n * n).map(entry).collect())
}

/// Symbols for the perturbations of symbols.
fn perturbations<'a>(arena: &'a Arena, symbols: &[Symbol]) -> Vector<'a> {
    let names = symbols.iter().map(|&symbol| arena.symbol_info(symbol).name);
    Vector(names.map(|name| perturbation(arena, &name)).collect())
}

fn perturbation<'a>(arena: &'a Arena, of: &str) -> Expr<'a> {
    arena.symbol(format!("d_{of}"), Stage::Perturbation)
}

/// The perturbation of every symbol of the state, stored coordinates of configurations included.
fn state_direction<'a>(system: &System<'a>, perturbed: &Parts<'a>) -> Vec<(Symbol, Expr<'a>)> {
    let configuration =
        system.group.stored_perturbation(system.side, &system.configuration(), &perturbed.configuration);
    let change = system.join_state(&Parts { configuration, ..perturbed.clone() });
    system.state_symbols().into_iter().zip(change.0).collect()
}

/// The image of a perturbation under a step.
struct Pushforward<'s, 'a> {
    system: &'s System<'a>,
    step: &'s Step<'a>,
    /// The derivative along the perturbations of state, controls, parameters and unknown.
    total: Derivative<'a>,
}

impl<'a> Pushforward<'_, 'a> {
    /// The perturbation of the next state, from that of the state.
    fn of(&mut self, perturbed: Parts<'a>) -> Parts<'a> {
        let next = self.system.split_state(&self.step.next);
        Parts {
            configuration: self.configuration(perturbed.configuration),
            momentum: self.along(&next.momentum),
            advected: self.advected(perturbed.advected),
        }
    }

    fn along(&mut self, vector: &Vector<'a>) -> Vector<'a> {
        vector.map(|component| self.total.of(component))
    }

    /// `δ' = Ad_{τ(x)⁻¹} δ + dL τ_x δx`, or `Ad_{τ(x)} δ + dR τ_x δx`, for one increment after the other.
    fn configuration(&mut self, perturbation: Vector<'a>) -> Vector<'a> {
        let Self { system, step, .. } = *self;
        let group = &system.group;
        let sign = step.h.arena().number(system.side.sign());
        step.increments.iter().fold(perturbation, |perturbation, Increment { retraction, by }| {
            let (retraction, x) = (system.side.carrying(*retraction), by.scale(sign));
            let inner = group.d_left(retraction, &x, &self.along(by));
            (&group.carried_back(retraction, &x, &perturbation) + &inner).hold()
        })
    }

    /// `δa' = Ad*_{τ(x)} δa + ad*_ω a'` with `a' = Ad*_{τ(x)} a`, `ω = dL τ_x δx`, for one increment after the other.
    fn advected(&mut self, perturbation: Vec<Vector<'a>>) -> Vec<Vector<'a>> {
        let Self { system, step, .. } = *self;
        let group = &system.group;
        let sign = step.h.arena().number(system.side.sign());
        let hold = |spaces: Vec<Vector<'a>>| spaces.iter().map(Vector::hold).collect::<Vec<_>>();
        let start = (system.advected_values(), perturbation);
        let (_, perturbation) = step.increments.iter().fold(start, |(a, perturbation), increment| {
            let retraction = system.side.carrying(increment.retraction);
            let x = increment.by.scale(sign);
            let omega = group.d_left(retraction, &x, &self.along(&increment.by).scale(sign));
            let a = hold(group.carry(retraction, &x, &a));
            let bracket = group.coadjoint_spaces(&omega.hold(), &a);
            let carried = group.carry(retraction, &x, &perturbation);
            let next = carried.iter().zip(&bracket).map(|(carried, bracket)| carried + bracket);
            (a, hold(next.collect()))
        });
        perturbation
    }
}

/// The transpose of a [`Linearization`]: how a linear function of the next state depends on all that this depends on.
pub struct Adjoint<'a> {
    /// The coefficients of the function: symbols, in the order of [`Linearization::next`].
    pub next: Vector<'a>,
    /// Its derivative with respect to the state.
    pub state: Vector<'a>,
    /// Its derivative with respect to the controls.
    pub control: Vector<'a>,
    /// Its derivative with respect to the parameters.
    pub parameters: Vector<'a>,
}

impl<'a> Linearization<'a> {
    /// The transpose, by the reverse mode: as many operations as the linearization itself has, or few more.
    pub fn adjoint(&self, arena: &'a Arena) -> Adjoint<'a> {
        let names = self.state.symbols().into_iter().map(|symbol| arena.symbol_info(symbol).name);
        let costate = |name: String| format!("wrt_{}", name.trim_start_matches("d_"));
        let next = Vector(names.map(|name| arena.symbol(costate(name), Stage::Perturbation)).collect());
        let perturbations = [&self.state, &self.control, &self.parameters];
        let symbols: Vec<Symbol> =
            perturbations.iter().flat_map(|perturbation| perturbation.symbols()).collect();
        let mut derivatives = gradient(self.next.dot(&next), &symbols).0.into_iter();
        let mut take =
            |perturbation: &Vector<'a>| Vector(derivatives.by_ref().take(perturbation.len()).collect());
        let [state, control, parameters] = perturbations.map(&mut take);
        Adjoint { next, state, control, parameters }
    }
}

/// A [`Linearization`] as matrices: `explicit + through · unknown` for each of the perturbations.
pub struct Matrices<'a> {
    /// The derivative of the next state with respect to the unknown, column by column; none if no matrix is wanted, or
    /// there is no unknown.
    pub through: Option<Vec<Vector<'a>>>,
    /// For state, controls and parameters and each of their components: the derivatives with respect to it of the next
    /// state with the unknown as it is, and of the unknown. None for those that are not wanted or have no components.
    pub columns: [Option<Vec<(Vector<'a>, Vector<'a>)>>; 3],
}

impl<'a> Linearization<'a> {
    /// As matrices, those that are wanted.
    pub fn matrices(&self, arena: &'a Arena, wanted: Derivatives) -> Matrices<'a> {
        let perturbations = [&self.unknown, &self.state, &self.control, &self.parameters];
        let all: Vec<Symbol> = perturbations.iter().flat_map(|perturbation| perturbation.symbols()).collect();
        let along = |one: Symbol| -> Vec<(Symbol, Expr<'a>)> {
            let component = |symbol| if symbol == one { arena.one() } else { arena.zero() };
            all.iter().map(|&symbol| (symbol, component(symbol))).collect()
        };
        let column = |one: Symbol| {
            let unit = along(one);
            (self.partial.substitute(&unit), self.solution.substitute(&unit))
        };
        let columns = |perturbation: &Vector<'a>, wanted: bool| {
            (wanted && !perturbation.is_empty())
                .then(|| perturbation.symbols().into_iter().map(column).collect::<Vec<_>>())
        };
        let any = wanted.state || wanted.controls || wanted.parameters;
        let through = columns(&self.unknown, any);
        Matrices {
            through: through.map(|columns| columns.into_iter().map(|(next, _)| next).collect()),
            columns: [
                columns(&self.state, wanted.state),
                columns(&self.control, wanted.controls),
                columns(&self.parameters, wanted.parameters),
            ],
        }
    }
}
