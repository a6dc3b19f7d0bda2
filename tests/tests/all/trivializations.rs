//! The four trivializations: a discretization map on the left or on the right of the configuration, lifted to momenta in the body or in
//! space. Which of them are one map, from the definition of the cotangent lift with 71 digits.
//!
//! A discretization map is `D(ḡ, ξ) = (ḡ τ(−sη), ḡ τ((1−s)η))`, or on the right `(τ(−sω) ḡ, τ((1−s)ω) ḡ)` with `ω = Ad_ḡ η`, of the tangent
//! vector `ḡ η = ω ḡ`. The step with its cotangent lift is by definition
//!
//! ```text
//! ⟨p₁, δg₁⟩ − ⟨p₀, δg₀⟩ = ⟨μ̄, δη⟩   for all variations of ḡ and η, with (g₀, g₁) = D(ḡ, η)
//! ```
//!
//! where nothing but momentum has a part in the motion of a left-invariant system; of a right-invariant one with `ω` and its `δω` in space.
//! Momenta and variations pair the same in the body, `μ·g⁻¹δg`, and in space, `π·δg g⁻¹` with `π = Ad*_{g⁻¹} μ`.

use coadjoint_codegen::expr::{Arena, Vector};
use coadjoint_codegen::group::{Retraction, Semidirect, Side};
use coadjoint_codegen::method::family;
use coadjoint_codegen::model::System;
use coadjoint_codegen::scheme::Member;
use coadjoint_support::evaluate::Evaluate as _;
use coadjoint_support::precise::definition::{BlockDiagonal, SemidirectMatrices};
use coadjoint_support::precise::descriptions::{all_kinds, random_point};
use coadjoint_support::precise::matrix::{Column, Matrix, jacobian};
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;
use coadjoint_support::random::Random;

/// For comparisons with central differences.
const DIFFERENCES: f64 = 1e-46;
/// For what holds to the last digits.
const EXACT: f64 = 1e-69;

/// A discretization map with a retraction on one side, at `s`.
struct Discretization<'m> {
    matrices: &'m SemidirectMatrices<'m>,
    retraction: Retraction,
    side: Side,
    s: Real,
}

impl Discretization<'_> {
    /// The two ends, of the tangent vector with the velocity `eta` in the body, or `omega` in space as `seen` says.
    fn ends(&self, g: &BlockDiagonal, seen: Side, velocity: &Column) -> [BlockDiagonal; 2] {
        let adjoint = self.matrices.adjoint(&if seen == Side::Left { g.clone() } else { g.inverse() });
        let velocity = if seen == self.side { velocity.clone() } else { &adjoint * velocity };
        [-self.s.clone(), Real::from(1) - &self.s].map(|part| {
            let increment = self.matrices.retract(self.retraction, &velocity.scale(&part));
            if self.side == Side::Left { g.times(&increment) } else { increment.times(g) }
        })
    }
}

/// A step from numbers: its ends, with the momenta there in the body, and the intermediate point.
struct Taken {
    ends: [BlockDiagonal; 2],
    momenta: [Column; 2],
    g_bar: BlockDiagonal,
    /// On the side of the system.
    velocity: Column,
    mean: Column,
}

impl Taken {
    fn new(
        system: &System<'_>,
        matrices: &SemidirectMatrices<'_>,
        retraction: Retraction,
        s: Member,
    ) -> Self {
        let arena = system.time.arena();
        let step = family::step(arena, system, retraction, s);
        let mut point = random_point(system, 17);
        point.set(&Vector(vec![step.h]).symbols(), &Column(vec![Real::ratio(1, 5)]));
        let solver = Solver::new(&step);
        let solved = solver.solve(&point);
        let state = system.state_symbols();
        let next = point.with(&state, &solver.next(&solved));
        let factor = &system.factors[0];
        let by: Vec<Column> = step.increments.iter().map(|increment| solved.vector(&increment.by)).collect();
        let velocity = by.into_iter().reduce(|sum, by| &sum + &by).expect("a configuration moves");
        let stored = [&point, &next].map(|at| at.get(&factor.configuration.symbols()));
        let on_side = [&point, &next].map(|at| at.get(&factor.momentum.symbols()));
        let ends = stored.map(|g| matrices.group_element(&g));

        let early = matrices.retract(retraction, &velocity.scale(&-share(arena, s))).inverse();
        let g_bar = match system.side {
            Side::Left => ends[0].times(&early),
            Side::Right => early.times(&ends[0]),
        };
        // `η = t 𝕀⁻¹ μ̄`
        let momentum = system.momentum();
        let unit = |i| point.with(&momentum.symbols(), &Column::unit(momentum.len(), i));
        let columns: Vec<Column> = (0..momentum.len())
            .map(|i| unit(i).vector(&system.velocity()).scale(&Real::ratio(1, 5)))
            .collect();
        let mean = Matrix::from_columns(&columns).solve(&velocity);
        let in_body = |(g, m): (&BlockDiagonal, Column)| match system.side {
            Side::Left => m,
            Side::Right => matrices.coadjoint(g, &m),
        };
        let [before, after] = on_side;
        let momenta = [in_body((&ends[0], before)), in_body((&ends[1], after))];
        Self { ends, momenta, g_bar, velocity, mean }
    }

    /// How far the ends are from those of a discretization map at the intermediate point.
    fn off(&self, map: &Discretization<'_>, side: Side) -> Real {
        let ends = map.ends(&self.g_bar, side, &self.velocity);
        let off = |i: usize| (&ends[i].entries() - &self.ends[i].entries()).norm();
        let (a, b) = (off(0), off(1));
        if a > b { a } else { b }
    }

    /// `⟨p₁, δg₁⟩ − ⟨p₀, δg₀⟩` by each component of `ζ` with `δḡ = ḡ ζ` or `ζ ḡ` on the system's side, then of the velocity's variation; momenta
    /// in the body or in space as `lift` says.
    fn paired(&self, map: &Discretization<'_>, side: Side, lift: Side) -> Column {
        let matrices = map.matrices;
        let n = self.velocity.len();
        let pair = |end: usize| {
            let inverse = self.ends[end].inverse();
            let moved = |x: &Column| {
                let turn = matrices.retract(Retraction::Exponential, &x.part(0, n));
                let g_bar = match side {
                    Side::Left => self.g_bar.times(&turn),
                    Side::Right => turn.times(&self.g_bar),
                };
                let [before, after] = map.ends(&g_bar, side, &(&self.velocity + &x.part(n, n)));
                let there = if end == 0 { before } else { after };
                matrices.vee(&match lift {
                    Side::Left => inverse.times(&there),
                    Side::Right => there.times(&inverse),
                })
            };
            let momentum = match lift {
                Side::Left => self.momenta[end].clone(),
                Side::Right => matrices.coadjoint(&inverse, &self.momenta[end]),
            };
            &jacobian(&Column::zeros(2 * n), moved).transpose() * &momentum
        };
        &pair(1) - &pair(0)
    }
}

#[test]
fn which_trivializations_are_one_map() {
    let names = [
        "free body with a full inertia",
        "body in the plane",
        "body in a fluid",
        "spin",
        "free body in space coordinates",
    ];
    let mut residuals = Residuals::new();
    for description in all_kinds().iter().filter(|description| names.contains(&description.name)) {
        let arena = Arena::new();
        let system = description.system(&arena);
        let alone = Semidirect { group: system.group.factors[0].group, spaces: Vec::new() };
        let matrices = SemidirectMatrices::new(&alone);
        for retraction in Retraction::ALL {
            for (n, d) in [(0, 1), (1, 4), (1, 2), (3, 4), (1, 1)] {
                let s = Member::new(n, d).expect("between 0 and 1");
                let taken = Taken::new(&system, &matrices, retraction, s);
                let n = taken.velocity.len();
                let expected = Column::stack([&Column::zeros(n), &taken.mean]);
                for side in [Side::Left, Side::Right] {
                    let s = share(&arena, s);
                    let map = Discretization { matrices: &matrices, retraction, side, s };
                    if side != system.side && !retraction.is_equivariant() {
                        let what = format!("{}, {}, {side:?}", description.name, retraction.name());
                        assert!(taken.off(&map, system.side) > Real::ten_to(-9), "{what}");
                        continue;
                    }
                    residuals.vanish("(g₀, g₁) = D(ḡ, η)", &taken.off(&map, system.side), EXACT);
                    // LL and LR, RL and RR: the side of the lift makes no difference
                    for lift in [Side::Left, Side::Right] {
                        let lifted = taken.paired(&map, system.side, lift);
                        residuals.agree("⟨p₁, δg₁⟩ − ⟨p₀, δg₀⟩ = ⟨μ̄, δη⟩", &lifted, &expected, DIFFERENCES);
                    }
                }
            }
        }
    }
}

/// `s` as a number.
fn share(arena: &Arena, s: Member) -> Real {
    arena.number(s.s()).evaluate(&|_| Real::from(0))
}

/// With a retraction that is not equivariant the map on the right is not left-invariant, `D(hḡ, Ad_h ω) ≠ h D(ḡ, ω)`: with it a left-invariant
/// system has no reduced step. Inversion of the configuration makes it the map on the left with `τ̄(x) = τ(−x)⁻¹`, of a right-invariant
/// system.
#[test]
fn the_map_on_the_other_side_is_that_of_the_inverse() {
    let mut residuals = Residuals::new();
    let random = &mut Random::new(18);
    for &group in coadjoint_codegen::group::catalogue() {
        let alone = Semidirect { group, spaces: Vec::new() };
        let matrices = SemidirectMatrices::new(&alone);
        let n = matrices.dimension();
        let mut random = || Column::random(n, random);
        for retraction in Retraction::ALL {
            let s = Real::ratio(1, 4);
            let right = Discretization { matrices: &matrices, retraction, side: Side::Right, s: s.clone() };
            let left = Discretization {
                matrices: &matrices,
                retraction: retraction.reversed(),
                side: Side::Left,
                s,
            };
            let element = |x: &Column| matrices.retract(Retraction::Exponential, x);
            let (g, h, omega) = (element(&random()), element(&random()), random());
            let there = right.ends(&g, Side::Right, &omega);
            let inverted = left.ends(&g.inverse(), Side::Left, &-&omega);
            for (there, inverted) in there.iter().zip(&inverted) {
                residuals.agree(
                    "D(ḡ, ω)⁻¹ = D̄(ḡ⁻¹, −ω)",
                    &there.inverse().entries(),
                    &inverted.entries(),
                    EXACT,
                );
            }
            let moved = right.ends(&h.times(&g), Side::Right, &(&matrices.adjoint(&h) * &omega));
            let off = (&moved[1].entries() - &h.times(&there[1]).entries()).norm();
            let is_abelian = matrices.adjoint(&h) == Matrix::identity(n);
            let is_invariant = retraction.is_equivariant() || is_abelian;
            assert_eq!(off < Real::ten_to(-64), is_invariant, "{}, {}", group.name(), retraction.name());
        }
    }
}
