//! The derivative of a step, in closed form: the implicit function theorem on the step's own equation.
//!
//! Where `left(x) = right(x)` defines the unknown, a perturbation of state, controls and parameters changes it by
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
//! g τ(x):  δ' = Ad_{τ(x)⁻¹} δ + dL τ_x δx = δ − dL τ_x [x, δ] + dL τ_x δx
//! τ(x) g:  δ' = δ + Ad_{g⁻¹} dL τ_x δx
//! ```
//!
//! So does that of advected parameters, which these turns carry: `a' = Ad*_{τ(x)} a` changes by `Ad*_{τ(x)} δa + ad*_ω a'`, `ω = dL τ_x δx`.

use super::Step;
use crate::derivatives::Derivatives;
use crate::expr::{Arena, Derivative, Expr, Stage, Symbol, Vector, gradient};
use crate::group::{Group, Retraction, Side, d_right, placeholders};
use crate::identifiers::plain;
use crate::model::{Advected, Factor, System};

/// The perturbation of the next state with all that it depends on: linear in the perturbations, which are symbols.
pub struct Linearization<'a> {
    /// The perturbation of the unknown.
    pub unknown: Vector<'a>,
    /// What this is, by the step's equation.
    pub solution: Vector<'a>,
    /// The perturbation of the next state, from that of the unknown and all others.
    pub partial: Vector<'a>,
    /// The perturbation of the state in the order of storage, with an element of the algebra in the place of each configuration.
    pub state: Vector<'a>,
    /// The perturbation of the controls, if it is wanted.
    pub control: Vector<'a>,
    /// The perturbation of the parameters, the system's fields, if it is wanted.
    pub parameters: Vector<'a>,
    /// The perturbation of the next state, in the order of [`state`](Self::state).
    pub next: Vector<'a>,
}

impl<'a> Linearization<'a> {
    /// Of a step with this retraction, by what is wanted.
    pub fn new(
        arena: &'a Arena,
        system: &System<'a>,
        retraction: Retraction,
        step: &Step<'a>,
        wanted: Derivatives,
    ) -> Self {
        let perturbation = |of: String| arena.symbol(format!("d_{of}"), Stage::Perturbation);
        let perturbations = |symbols: &[Symbol]| {
            Vector(symbols.iter().map(|&symbol| perturbation(arena.symbol_info(symbol).name)).collect())
        };
        let rows: Vec<Row<'_, 'a>> = rows(system);
        let state = rows.iter().flat_map(|row| match row {
            Row::Configuration(_, factor) => {
                let axes = factor.algebra.group.axes().iter();
                axes.map(|axis| perturbation(format!("{}_{axis}", plain(&factor.name)))).collect()
            }
            Row::Momentum(symbols) => perturbations(symbols).0,
            Row::Advected(_, factor, place) => perturbations(&factor.advected[*place].value.symbols()).0,
        });
        let state = Vector(state.collect());
        let controls = if wanted.of_controls() { system.control_symbols() } else { Vec::new() };
        let control = perturbations(&controls);
        let fields = if wanted.of_parameters() { system.field_symbols() } else { Vec::new() };
        let parameters = perturbations(&fields);

        let mut direction: Vec<(Symbol, Expr<'a>)> = Vec::new();
        let mut starts = state.0.clone().into_iter();
        for row in &rows {
            let perturbation = Vector(starts.by_ref().take(row.len()).collect());
            match row {
                Row::Configuration(_, factor) => {
                    let stored = tangent(factor.algebra.group, &factor.configuration, &perturbation);
                    direction.extend(factor.configuration.symbols().into_iter().zip(stored.iter()));
                }
                Row::Momentum(symbols) => direction.extend(symbols.iter().copied().zip(perturbation.iter())),
                Row::Advected(_, factor, place) => {
                    direction
                        .extend(factor.advected[*place].value.symbols().into_iter().zip(perturbation.iter()));
                }
            }
        }
        direction.extend(controls.into_iter().zip(control.iter()));
        direction.extend(fields.into_iter().zip(parameters.iter()));

        // what the unknown does
        let symbols = step.unknown.symbols();
        let unknown = perturbations(&symbols);
        let residual = &step.left - &step.right;
        let mut explicit = Derivative::along(arena, &direction);
        let shift = residual.map(|component| -explicit.of(component)).hold();
        let solution = residual.jacobian(&symbols).map(Expr::hold).solve(&shift).hold();
        direction.extend(symbols.into_iter().zip(unknown.iter()));

        let mut total = Derivative::along(arena, &direction);
        // both sides change alike, and the left one is simple
        for (left, right) in step.left.iter().zip(step.right.iter()) {
            let perturbation = total.of(left);
            total.know(right, perturbation);
        }
        let mut along = |vector: &Vector<'a>| vector.map(|component| total.of(component));
        let stored = system.state_symbols();
        let mut partial = Vec::new();
        let mut starts = state.0.clone().into_iter();
        for row in &rows {
            let perturbation = Vector(starts.by_ref().take(row.len()).collect());
            let turned = match row {
                Row::Configuration(index, factor) => {
                    let group = factor.algebra.group;
                    step.turns[*index].iter().fold(perturbation, |perturbation, turn| {
                        let by = along(&turn.by);
                        match system.side {
                            Side::Left => {
                                let carried = group.bracket(&turn.by, &perturbation);
                                let carried = d_left(group, retraction, &turn.by, &carried);
                                &(&perturbation - &carried) + &d_left(group, retraction, &turn.by, &by)
                            }
                            Side::Right => {
                                let inner = d_left(group, retraction, &turn.by, &by);
                                &perturbation + &to_body(group, &turn.from, &inner)
                            }
                        }
                        .hold()
                    })
                }
                Row::Momentum(symbols) => {
                    let of = |symbol: &Symbol| stored.iter().position(|known| known == symbol);
                    let values = symbols.iter().filter_map(of).map(|k| step.next.0[k]);
                    along(&Vector(values.collect()))
                }
                Row::Advected(index, factor, place) => {
                    let algebra = &factor.algebra;
                    let sign = arena.number(system.side.sign());
                    let one = |a: &Vector<'a>| -> Vec<Vector<'a>> {
                        let none = |other: &Advected<'a>| other.value.scale(arena.zero());
                        let mut all: Vec<_> = factor.advected.iter().map(none).collect();
                        all[*place] = a.clone();
                        all
                    };
                    let carry = |x: &Vector<'a>, a: &Vector<'a>| {
                        let mean = algebra.d_right_dual_spaces(retraction, x, &one(a));
                        a + &algebra.coadjoint_spaces(x, &mean)[*place]
                    };
                    let start = (factor.advected[*place].value.clone(), perturbation);
                    let turns = step.turns[*index].iter();
                    let (_, perturbation) = turns.fold(start, |(a, perturbation), turn| {
                        let x = turn.by.scale(sign);
                        let turned = d_left(algebra.group, retraction, &x, &along(&turn.by).scale(sign));
                        let a = carry(&x, &a).hold();
                        let turned = &algebra.coadjoint_spaces(&turned.hold(), &one(&a))[*place];
                        let perturbation = &carry(&x, &perturbation) + turned;
                        (a, perturbation.hold())
                    });
                    perturbation
                }
            };
            partial.extend(turned.0);
        }
        let partial = Vector(partial);
        let found: Vec<_> = unknown.symbols().into_iter().zip(solution.iter()).collect();
        let next = partial.substitute(&found);
        Self { unknown, solution, partial, state, control, parameters, next }
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
        let next = Vector(
            names
                .map(|name| {
                    arena.symbol(format!("wrt_{}", name.trim_start_matches("d_")), Stage::Perturbation)
                })
                .collect(),
        );
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
    /// The derivative of the next state with respect to the unknown, column by column; none if no matrix is wanted, or there is no unknown.
    pub through: Option<Vec<Vector<'a>>>,
    /// For state, controls and parameters and each of their components: the derivatives with respect to it of the next state with the unknown as it
    /// is, and of the unknown. None for those that are not wanted or have no components.
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

/// A part of the state, in the order of storage.
enum Row<'s, 'a> {
    /// The configuration of a factor, the so-and-so-many-th.
    Configuration(usize, &'s Factor<'a>),
    /// Its momentum.
    Momentum(Vec<Symbol>),
    /// One of its advected parameters.
    Advected(usize, &'s Factor<'a>, usize),
}

impl Row<'_, '_> {
    /// How many numbers its perturbation has.
    fn len(&self) -> usize {
        match self {
            Self::Configuration(_, factor) => factor.algebra.group.dimension(),
            Self::Momentum(symbols) => symbols.len(),
            Self::Advected(_, factor, place) => factor.advected[*place].value.len(),
        }
    }
}

fn rows<'s, 'a>(system: &'s System<'a>) -> Vec<Row<'s, 'a>> {
    let factors = system.factors.iter().enumerate();
    let of_factors = factors.flat_map(|(index, factor)| {
        [Row::Configuration(index, factor), Row::Momentum(factor.momentum.symbols())]
    });
    let advected = system.advected_places().map(|(factor, place)| {
        let index = system.factors.iter().position(|other| std::ptr::eq(other, factor));
        // it is one of them
        Row::Advected(index.unwrap_or_default(), factor, place)
    });
    of_factors.chain(advected).collect()
}

/// `dL τ_x y = dR τ_{−x} y`
fn d_left<'a>(group: &dyn Group, retraction: Retraction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
    d_right(group, retraction, &-x, y)
}

/// The perturbation of the stored coordinates where `g` becomes `g exp(δ)`.
fn tangent<'a>(group: &dyn Group, g: &Vector<'a>, perturbation: &Vector<'a>) -> Vector<'a> {
    let arena = g.0[0].arena();
    let delta = placeholders(arena, "d", perturbation.len());
    let moved = group.compose(g, &group.retract(Retraction::Exponential, &delta));
    let zero: Vec<_> = delta.symbols().into_iter().map(|symbol| (symbol, arena.zero())).collect();
    moved.derivative_along(&delta.symbols(), perturbation).substitute(&zero)
}

/// `Ad_{g⁻¹} x`, from its dual.
fn to_body<'a>(group: &dyn Group, g: &Vector<'a>, x: &Vector<'a>) -> Vector<'a> {
    let m = placeholders(g.0[0].arena(), "m", x.len());
    gradient(group.to_space(g, &m).dot(x), &m.symbols())
}
