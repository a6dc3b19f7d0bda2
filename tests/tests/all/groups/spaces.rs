//! The spaces that groups act on, semidirect products with them, and what is kept on their duals.

use coadjoint_codegen::expr::{Arena, Number, Stage, Vector, gradient};
use coadjoint_codegen::group::casimirs::{Casimirs, Polynomial, casimirs};
use coadjoint_codegen::group::{
    Acted, Adjoint, Dual, Group, MatrixFunction, Representation, Semidirect, SemidirectVector, Structure,
    Translation, catalogue,
};
use coadjoint_support::precise::definition::{SemidirectMatrices, retract};
use coadjoint_support::precise::formula::{Formula, Point, symbols};
use coadjoint_support::precise::matrix::{Column, Matrix};
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;
use coadjoint_support::random::Random;

use super::{DIFFERENCES, EXACT, RETRACTIONS, Subject, for_each_group};

/// Those of its own, its algebra, and what is dual to these.
fn spaces(group: &'static dyn Group) -> Vec<&'static dyn Representation> {
    let own = group.representations().iter().copied().chain([Adjoint::of(group)]);
    own.flat_map(|space| [space, Dual::of(space)]).collect()
}

/// Checks every space of every group.
fn for_each_space(check: impl Fn(&Subject<'_>, &'static dyn Representation, &mut Residuals)) {
    for_each_group(|subject, residuals| {
        for space in spaces(subject.group) {
            check(subject, space, residuals);
        }
    });
}

#[test]
fn spaces_are_representations() {
    for_each_space(|subject, space, residuals| {
        let (n, v) = (subject.dimension(), space.coordinates().len());
        assert_eq!(space.algebra_dimension(), n);
        let act = Formula::new(subject.arena, [n, v], |[x, u]| space.act_infinitesimally(&x, &u));
        let bracket = Formula::new(subject.arena, [n, n], |[x, y]| subject.group.bracket(&x, &y));
        let rho = |x: &Column| act.matrix(x);
        let random = &mut Random::new(26);
        for _ in 0..5 {
            let [x, y] = std::array::from_fn(|_| Column::random(n, random));
            let defined = subject.definition.action(space.name(), &x);
            residuals.agree("ρ_x is its definition", &rho(&x).entries(), &defined.entries(), EXACT);
            let commutator = &(&rho(&x) * &rho(&y)) - &(&rho(&y) * &rho(&x));
            let of_bracket = rho(&bracket.at([&x, &y]));
            residuals.agree("ρ_[x,y] = [ρ_x, ρ_y]", &of_bracket.entries(), &commutator.entries(), EXACT);
        }
    });
}

#[test]
fn retractions_move_spaces() {
    for_each_space(|subject, space, residuals| {
        let (n, v) = (subject.dimension(), space.coordinates().len());
        let acted = Acted { group: subject.group, space };
        for retraction in subject.retractions().filter(|&retraction| space.has(retraction)) {
            let transport = Formula::new(subject.arena, [n, v], |[x, u]| acted.transport(retraction, &x, &u));
            let translate = Formula::new(subject.arena, [n, v], |[x, w]| {
                let Translation { body_part, rotated_part, .. } = acted.translation(retraction, &x, &w);
                let by_x = rotated_part.jacobian(&x.symbols());
                assert!(
                    by_x.entries.iter().all(|entry| entry.is_zero()),
                    "what is rotated depends on w alone"
                );
                &body_part + &acted.transport(retraction, &x, &rotated_part)
            });
            for x in subject.points() {
                let turn = subject.definition.transport(retraction, space.name(), &x);
                let shift = subject.definition.translation(retraction, space.name(), &x);
                let moved = &Matrix::identity(v) + &(&subject.definition.action(space.name(), &x) * &shift);
                if retraction.is_equivariant() {
                    residuals.agree("τ(x) = 1 + ρ_x P(x)", &moved.entries(), &turn.entries(), EXACT);
                }
                let closed = transport.matrix(&x);
                residuals.agree("transport is τ(x) on the space", &closed.entries(), &turn.entries(), EXACT);
                let closed = translate.matrix(&x);
                residuals.agree(
                    "translation is φ₁, (1 − ρ/2)⁻¹, τ(x) or 1",
                    &closed.entries(),
                    &shift.entries(),
                    EXACT,
                );
            }
        }
    });
}

#[test]
fn elements_act_on_spaces_as_retractions_do() {
    for_each_space(|subject, space, residuals| {
        let (n, v) = (subject.coordinates(), space.coordinates().len());
        // what its elements do to vectors is what it does to the space that it brings
        if !subject.group.representations().iter().any(|own| own.name() == space.name()) {
            return;
        }
        let act = Formula::new(subject.arena, [n, v], |[g, u]| {
            subject.group.act(&g, &u).expect("elements act on what stands for itself")
        });
        for retraction in subject.retractions() {
            let retracted = subject.retract(retraction);
            for x in subject.points() {
                let defined = retract(retraction, &x, |x| subject.definition.representation(space.name(), x));
                let g = retracted.at([&x]);
                let closed = act.matrix(&g);
                residuals.agree("τ(x) on the space", &closed.entries(), &defined.entries(), EXACT);
            }
        }
    });
}

#[test]
fn a_space_said_to_be_tangent_is_the_algebra_and_moves_by_the_derivative() {
    for_each_space(|subject, space, residuals| {
        let n = subject.dimension();
        for f in [MatrixFunction::Exponential, MatrixFunction::Cayley] {
            if !subject.retractions().any(|retraction| retraction == f.into()) || !space.has(f.into()) {
                continue;
            }
            let x = symbols(subject.arena, "x", n, Stage::Step);
            let w = symbols(subject.arena, "w", space.coordinates().len(), Stage::Step);
            if !space.translation(f, &x, &w).is_tangent_group {
                continue;
            }
            assert_eq!(w.len(), n);
            assert_eq!(space.act_infinitesimally(&x, &w), subject.group.bracket(&x, &w), "ρ = ad");
            let translate = Formula::new(subject.arena, [n, n], |[x, w]| {
                let Translation { body_part, rotated_part, .. } = space.translation(f, &x, &w);
                &body_part + &space.transport(f, &x, &rotated_part)
            });
            let alone = subject.alone();
            for x in subject.points() {
                let shift = translate.matrix(&x);
                let d_right = SemidirectMatrices::new(&alone).d_right(f.into(), &x);
                residuals.agree("P(x) = dR τ_x", &shift.entries(), &d_right.entries(), DIFFERENCES);
            }
        }
    });
}

/// Every group with up to `most` copies of each of its spaces.
fn semidirect_products(most: usize) -> Vec<Semidirect> {
    catalogue()
        .iter()
        .flat_map(|&group| {
            let is_own = move |space: &dyn Representation| {
                group.representations().iter().any(|own| own.name() == space.name())
            };
            let most = move |space: &dyn Representation| if is_own(space) { most } else { 1 };
            let copies = spaces(group).into_iter();
            let copies = copies.flat_map(move |space| (1..=most(space)).map(move |k| vec![space; k]));
            std::iter::once(Vec::new()).chain(copies).map(move |spaces| Semidirect { group, spaces })
        })
        .collect()
}

/// The element with these components.
fn element<'a>(algebra: &Semidirect, components: &Vector<'a>) -> SemidirectVector<'a> {
    let mut rest = components.0.clone();
    let mut take = |count: usize| Vector(rest.drain(..count).collect());
    SemidirectVector {
        base: take(algebra.group.dimension()),
        spaces: algebra.spaces.iter().map(|space| take(space.coordinates().len())).collect(),
    }
}

/// The components of an element.
fn components<'a>(element: &SemidirectVector<'a>) -> Vector<'a> {
    let spaces = element.spaces.iter().flat_map(|space| space.0.clone());
    Vector(element.base.0.iter().copied().chain(spaces).collect())
}

#[test]
fn semidirect_products_derive_their_logarithmic_derivatives_and_coadjoint_actions() {
    let mut residuals = Residuals::new();
    for algebra in semidirect_products(2) {
        let matrices = SemidirectMatrices::new(&algebra);
        let n = matrices.dimension();
        let arena = Arena::new();
        let coadjoint = Formula::new(&arena, [n, n], |[xi, mu]| {
            components(&algebra.coadjoint(&element(&algebra, &xi), &element(&algebra, &mu)))
        });
        let random = &mut Random::new(27);
        for retraction in RETRACTIONS.into_iter().filter(|&retraction| algebra.has(retraction)) {
            let carried = Formula::new(&arena, [n, n], |[xi, mu]| {
                let (xi, mu) = (element(&algebra, &xi), element(&algebra, &mu));
                let mean = algebra.d_right_dual(retraction, &xi, &mu);
                components(&algebra.carry_momentum(retraction, &xi, &mu, &mean))
            });
            let spaces = |mu: &Column| mu.part(algebra.group.dimension(), n - algebra.group.dimension());
            let carried_spaces = Formula::new(&arena, [n, n], |[xi, mu]| {
                let (x, a) = (element(&algebra, &xi).base, element(&algebra, &mu).spaces);
                Vector::concat(&algebra.carry(retraction, &x, &a))
            });
            let dual = Formula::new(&arena, [n, n], |[xi, mu]| {
                components(&algebra.d_right_dual(
                    retraction,
                    &element(&algebra, &xi),
                    &element(&algebra, &mu),
                ))
            });
            for size in [Real::ten_to(-20), Real::from(2)] {
                let xi = Column::random(n, random).scale(&size);
                let mu = Column::random(n, random);
                let closed = dual.matrix(&xi);
                let defined = matrices.d_right(retraction, &xi).transpose();
                residuals.agree("(dR τ_x)* on G ⋉ V", &closed.entries(), &defined.entries(), DIFFERENCES);

                let bar = dual.at([&xi, &mu]);
                let defined = matrices.infinitesimal_coadjoint(&xi, &bar);
                residuals.agree("ad*_x m on G ⋉ V", &coadjoint.at([&xi, &bar]), &defined, EXACT);

                let moved = matrices.coadjoint(&matrices.retract(retraction, &xi), &mu);
                residuals.agree("Ad*_τ(x) m", &carried.at([&xi, &mu]), &moved, EXACT);
                residuals.agree("Ad*_τ(x) a", &carried_spaces.at([&xi, &mu]), &spaces(&moved), EXACT);
                if retraction.is_equivariant() {
                    let by_bar = &mu + &coadjoint.at([&xi, &bar]);
                    residuals.agree("Ad*_τ(x) m = m + ad*_x (dR τ_x)* m", &moved, &by_bar, EXACT);
                }
            }
        }
    }
}

#[test]
fn casimirs_are_all_that_is_kept_whatever_the_hamiltonian() {
    let mut residuals = Residuals::new();
    for algebra in semidirect_products(3) {
        let matrices = SemidirectMatrices::new(&algebra);
        let n = matrices.dimension();
        let arena = Arena::new();
        let mu = symbols(&arena, "m", n, Stage::Step);
        let structure = Structure::of(&algebra).expect("exact constants");
        let spaces = algebra.spaces.iter().map(|space| space.coordinates().len());
        let mut end = 0;
        let block = |length: usize| {
            end += length;
            end - length..end
        };
        let blocks: Vec<_> = std::iter::once(algebra.group.dimension()).chain(spaces).map(block).collect();
        let Casimirs { found, missing } = casimirs(&structure, &blocks);
        assert_eq!(missing, 0);
        let value = |polynomial: &Polynomial| {
            let term = |(monomial, &coefficient): (&Vec<usize>, &i64)| {
                let coefficient = arena.number(Number::ratio(coefficient.into(), 1));
                monomial.iter().fold(coefficient, |product, &variable| product * mu.0[variable])
            };
            polynomial.iter().map(term).fold(arena.zero(), |sum, term| sum + term)
        };
        let casimirs: Vec<_> = found.iter().map(|casimir| (format!("{casimir:?}"), value(casimir))).collect();
        let gradients: Vec<_> = casimirs.iter().map(|(_, c)| gradient(*c, &mu.symbols())).collect();

        let random = &mut Random::new(28);
        for _ in 0..3 {
            let mut point = Point::default();
            let at = Column::random(n, random);
            point.set(&mu.symbols(), &at);
            let poisson = matrices.poisson_tensor(&at);
            let mut columns = Vec::new();
            for ((name, _), gradient) in casimirs.iter().zip(&gradients) {
                let gradient = point.vector(gradient);
                residuals.vanish(&format!("{{{name}, h}}"), &(&poisson * &gradient).norm(), EXACT);
                columns.push(gradient);
            }
            // none is missing, and none follows from others
            let threshold = Real::ten_to(-40);
            let independent = Matrix::from_columns(&columns).rank(&threshold);
            assert_eq!(independent, casimirs.len(), "independent Casimirs");
            assert_eq!(poisson.rank(&threshold) + independent, n, "as many as there can be");
        }
    }
}
