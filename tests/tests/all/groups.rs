//! The laws of every group of the catalogue, from its own symbolic forms, held against definitions by matrices with 71 digits.

mod spaces;

use std::sync::LazyLock;

use coadjoint_codegen::expr::{Arena, Stage, Vector};
use coadjoint_codegen::group::{
    Group, MatrixGroup, Retraction, Semidirect, Side, catalogue, family, family_with_terms,
};
use coadjoint_support::precise::definition::{
    Realization, SemidirectMatrices, TERMS, composed, realization, retract,
};
use coadjoint_support::precise::formula::{Formula, Point, symbols};
use coadjoint_support::precise::matrix::{Column, Matrix, derivative};
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;
use coadjoint_support::random::Random;

/// For what holds to the last digits: elements of groups that are not compact have large entries.
const EXACT: f64 = 2e-67;
/// For comparisons with central differences.
const DIFFERENCES: f64 = 5e-46;

/// All retractions, and what the one that is not odd is backwards.
const RETRACTIONS: [Retraction; 4] =
    [Retraction::Exponential, Retraction::Cayley, Retraction::SecondKind, Retraction::ReversedSecondKind];

/// Each group's closed forms as functions of numbers, beside its definition.
struct Subject<'a> {
    group: &'static dyn Group,
    definition: &'static dyn Realization,
    arena: &'a Arena,
}

/// Groups from their bases alone.
const FAMILIES: [&str; 11] =
    ["SO4", "SO21", "SL2", "SL3", "SP4", "SU3", "SE23", "SGal3", "Heisenberg", "Aff1", "GL2"];

/// The groups of the catalogue, those from their bases, and those that are made of others.
fn groups() -> &'static [&'static dyn Group] {
    static GROUPS: LazyLock<Vec<&'static dyn Group>> = LazyLock::new(|| {
        let family =
            |name: &&str| -> &'static dyn Group { family_with_terms(name, TERMS).expect("there is one") };
        let composed = composed().iter().map(|&(group, _)| group as &'static dyn Group);
        catalogue().iter().copied().chain(FAMILIES.iter().map(family)).chain(composed).collect()
    });
    &GROUPS
}

/// Checks every group.
fn for_each_group(check: impl Fn(&Subject<'_>, &mut Residuals)) {
    for &group in groups() {
        let arena = Arena::new();
        let mut residuals = Residuals::new();
        check(&Subject { group, definition: realization(group), arena: &arena }, &mut residuals);
    }
}

/// Checks every group with every retraction.
fn for_each_retraction(check: impl Fn(&Subject<'_>, Retraction, &mut Residuals)) {
    for_each_group(|subject, residuals| {
        for retraction in subject.retractions() {
            check(subject, retraction, residuals);
        }
    });
}

impl<'a> Subject<'a> {
    /// Those that there are steps with, and the exponential, which there are forms of even where steps would be too much code.
    fn retractions(&self) -> impl Iterator<Item = Retraction> {
        let group = self.group;
        RETRACTIONS
            .into_iter()
            .filter(move |&retraction| retraction == Retraction::Exponential || group.has(retraction))
    }

    fn dimension(&self) -> usize {
        self.group.dimension()
    }

    fn coordinates(&self) -> usize {
        self.group.coordinates().len()
    }

    /// `τ`
    fn retract(&self, retraction: Retraction) -> Formula<'a> {
        Formula::new(self.arena, [self.dimension()], |[x]| self.group.retract(retraction, &x))
    }

    /// The product.
    fn compose(&self) -> Formula<'a> {
        let n = self.coordinates();
        Formula::new(self.arena, [n, n], |[g, h]| self.group.compose(&g, &h))
    }

    /// The group without any space: what is defined for semidirect products is defined for it.
    fn alone(&self) -> Semidirect {
        Semidirect { group: self.group, spaces: Vec::new() }
    }

    /// Elements of the algebra: zero, tiny, small, and large.
    fn points(&self) -> Vec<Column> {
        let random = &mut Random::new(21);
        let mut of_size = |size: Real| Column::random(self.dimension(), random).scale(&size);
        vec![
            Column::zeros(self.dimension()),
            of_size(Real::ten_to(-30)),
            of_size(Real::ten_to(-3)),
            of_size(Real::from(1)),
            // elements grow exponentially where the group is not compact
            of_size(Real::from(if self.is_compact() { 3 } else { 1 })),
        ]
    }

    /// Elements of the group, with both retractions.
    fn elements(&self) -> Vec<Column> {
        let points = self.points();
        self.retractions()
            .filter(|retraction| Retraction::ALL.contains(retraction))
            .flat_map(|retraction| {
                let retract = self.retract(retraction);
                points[3..].iter().map(|x| retract.at([x])).collect::<Vec<_>>()
            })
            .collect()
    }

    /// `τ(x)` by definition.
    fn defined(&self, retraction: Retraction, x: &Column) -> Matrix {
        retract(retraction, x, |x| self.definition.hat(x))
    }

    /// Whether commutators commute with everything: then the axes of coordinates of the second kind are as good as any others.
    fn is_two_step_nilpotent(&self) -> bool {
        self.is_abelian() || self.group.name() == "Heisenberg"
    }

    /// Whether a retraction is summed up as a power series.
    fn is_summed(&self, retraction: Retraction) -> bool {
        let summed = ["SL3", "SP4", "SU3", "SL2 with planes"];
        retraction == Retraction::Exponential && summed.contains(&self.group.name())
    }

    /// Whether rays of the algebra end in the group where they began, or nearly so; with translations beside the rotations it counts too.
    fn is_compact(&self) -> bool {
        !["SO21", "SL2", "SL3", "SP4", "GL2", "Aff1", "SO3 x SL2", "SL2 with planes"]
            .contains(&self.group.name())
    }

    /// Whether no two elements fail to commute: then all that differs between retractions is how far they go.
    fn is_abelian(&self) -> bool {
        let random = &mut Random::new(29);
        let [x, y] = std::array::from_fn(|_| self.definition.hat(&Column::random(self.dimension(), random)));
        (&(&x * &y) - &(&y * &x)).norm() == Real::from(0)
    }
}

#[test]
fn retractions_are_what_they_are_called() {
    for_each_retraction(|subject, retraction, residuals| {
        let retract = subject.retract(retraction);
        for x in subject.points() {
            let g = retract.at([&x]);
            residuals.vanish("τ(x) is on the group", &subject.definition.defect(&g).norm(), EXACT);
            let (matrix, defined) = (subject.definition.matrix(&g), subject.defined(retraction, &x));
            residuals.agree("τ(x) is its definition", &matrix.entries(), &defined.entries(), EXACT);
        }
    });
}

#[test]
fn retractions_start_at_the_unit_with_unit_speed_and_are_what_they_are_backwards() {
    for_each_retraction(|subject, retraction, residuals| {
        let (retract, compose) = (subject.retract(retraction), subject.compose());
        let reversed = subject.retract(retraction.reversed());
        assert_eq!(retraction.reversed().reversed(), retraction);
        let zero = Column::zeros(subject.dimension());
        let unit = retract.at([&zero]);
        let matrix = |x: &Column| subject.definition.matrix(&retract.at([x])).entries();
        let one = Matrix::identity(subject.definition.hat(&zero).rows());
        residuals.agree("τ(0) = e", &matrix(&zero), &one.entries(), EXACT);
        for x in subject.points() {
            let hat = subject.definition.hat(&x).entries();
            residuals.agree("τ'(0) = id", &derivative(&zero, &x, matrix), &hat, DIFFERENCES);
            let product = compose.at([&retract.at([&x]), &reversed.at([&-&x])]);
            residuals.agree("τ(x) τ̄(−x) = e", &product, &unit, EXACT);
        }
        // not odd where it does not say so, unless the order of the axes makes no difference
        let x = subject.points().pop().expect("there are some");
        let product = compose.at([&retract.at([&x]), &retract.at([&-&x])]);
        let is_odd = (&product - &unit).norm() < Real::ten_to(-64);
        assert_eq!(is_odd, retraction.is_odd() || subject.is_abelian(), "{}", subject.group.name());
    });
}

/// `τ(Ad_g x) = g τ(x) g⁻¹`, where it is said to be so and nowhere else.
#[test]
fn functions_of_a_matrix_are_equivariant() {
    for_each_retraction(|subject, retraction, residuals| {
        let matrix = |x: &Column| subject.definition.matrix(&subject.retract(retraction).at([x]));
        let x = Column::random(subject.dimension(), &mut Random::new(30));
        for g in subject.elements() {
            let g = subject.definition.matrix(&g);
            let turned = |m: &Matrix| &(&g * m) * &g.inverse();
            let there = matrix(&subject.definition.vee(&turned(&subject.definition.hat(&x))));
            let carried = turned(&matrix(&x));
            if retraction.is_equivariant() || subject.is_two_step_nilpotent() {
                residuals.agree("τ(Ad_g x) = g τ(x) g⁻¹", &there.entries(), &carried.entries(), EXACT);
            } else {
                assert!((&there - &carried).norm() > Real::ratio(1, 1000), "{}", subject.group.name());
            }
        }
    });
}

#[test]
fn the_product_is_that_of_a_group() {
    for_each_group(|subject, residuals| {
        let compose = subject.compose();
        let unit = subject.retract(Retraction::Cayley).at([&Column::zeros(subject.dimension())]);
        let matrix = |g: &Column| subject.definition.matrix(g);
        let elements = subject.elements();
        for (i, g) in elements.iter().enumerate() {
            let (h, k) = (&elements[(i + 1) % elements.len()], &elements[(i + 2) % elements.len()]);
            let product = compose.at([g, h]);
            residuals.agree(
                "g h as matrices",
                &matrix(&product).entries(),
                &(&matrix(g) * &matrix(h)).entries(),
                EXACT,
            );
            residuals.vanish("g h is on the group", &subject.definition.defect(&product).norm(), EXACT);
            let (left, right) = (compose.at([&product, k]), compose.at([g, &compose.at([h, k])]));
            residuals.agree("(g h) k = g (h k)", &left, &right, EXACT);
            residuals.agree("e g = g", &compose.at([&unit, g]), g, EXACT);
            residuals.agree("g e = g", &compose.at([g, &unit]), g, EXACT);
        }
    });
}

#[test]
fn inverses_are_those_of_the_matrices() {
    for_each_group(|subject, residuals| {
        let inverse = Formula::new(subject.arena, [subject.coordinates()], |[g]| subject.group.inverse(&g));
        for g in subject.elements() {
            let closed = subject.definition.matrix(&inverse.at([&g]));
            let defined = subject.definition.matrix(&g).inverse();
            residuals.agree("g⁻¹ as a matrix", &closed.entries(), &defined.entries(), EXACT);
        }
    });
}

#[test]
fn normalization_takes_the_error_of_a_product_away() {
    for_each_group(|subject, residuals| {
        let n = subject.coordinates();
        let normalize = Formula::new(subject.arena, [n], |[g]| subject.group.normalize(&g));
        let random = &mut Random::new(22);
        for g in subject.elements() {
            residuals.agree("what is on the group stays", &normalize.at([&g]), &g, EXACT);
            let off = &g + &Column::random(n, random).scale(&Real::ten_to(-30));
            let back = normalize.at([&off]);
            let defect = subject.definition.defect(&back).norm();
            residuals.vanish("what is off by 1e-30 comes back to 1e-58", &defect, 1e-58);
            residuals.vanish("and no farther than it was off", &(&back - &g).norm(), 1e-28);
        }
    });
}

/// What moves an element along a retraction at once is the product, normalized.
#[test]
fn elements_move_along_retractions() {
    for_each_retraction(|subject, retraction, residuals| {
        let (n, group) = (subject.dimension(), subject.group);
        let random = &mut Random::new(24);
        for side in [Side::Left, Side::Right] {
            let moved = Formula::new(subject.arena, [subject.coordinates(), n], |[g, x]| {
                group.moved(side, retraction, &g, &x).next
            });
            let product = Formula::new(subject.arena, [subject.coordinates(), n], |[g, x]| {
                side.compose(group, &g, &group.retract(retraction, &x))
            });
            for g in subject.elements() {
                let x = Column::random(n, random);
                residuals.agree("g τ(x)", &moved.at([&g, &x]), &product.at([&g, &x]), EXACT);
                let off = &g + &Column::random(subject.coordinates(), random).scale(&Real::ten_to(-30));
                let back = moved.at([&off, &x]);
                let defect = subject.definition.defect(&back).norm();
                residuals.vanish("what is off by 1e-30 comes back to 1e-58", &defect, 1e-58);
            }
        }
    });
}

#[test]
fn the_bracket_is_the_commutator() {
    for_each_group(|subject, residuals| {
        let n = subject.dimension();
        let bracket = Formula::new(subject.arena, [n, n], |[x, y]| subject.group.bracket(&x, &y));
        let of = |x: &Column, y: &Column| bracket.at([x, y]);
        let random = &mut Random::new(23);
        for _ in 0..5 {
            let [x, y, z] = std::array::from_fn(|_| Column::random(n, random));
            let hat = |x: &Column| subject.definition.hat(x);
            let commutator = &(&hat(&x) * &hat(&y)) - &(&hat(&y) * &hat(&x));
            residuals.agree("[x, y] as matrices", &hat(&of(&x, &y)).entries(), &commutator.entries(), EXACT);
            residuals.vanish("[x, y] = −[y, x]", &(&of(&x, &y) + &of(&y, &x)).norm(), EXACT);
            let cyclic = &(&of(&x, &of(&y, &z)) + &of(&y, &of(&z, &x))) + &of(&z, &of(&x, &y));
            residuals.vanish("Jacobi's identity", &cyclic.norm(), EXACT);
        }
    });
}

/// The matrix of `dR τ_x` from the closed form of its dual.
fn d_right(subject: &Subject<'_>, retraction: Retraction) -> impl Fn(&Column) -> Matrix {
    let n = subject.dimension();
    let dual = Formula::new(subject.arena, [n, n], |[x, m]| subject.group.d_right_dual(retraction, &x, &m));
    move |x| dual.matrix(x).transpose()
}

#[test]
fn logarithmic_derivatives_are_those_of_the_retraction() {
    for_each_retraction(|subject, retraction, residuals| {
        let (d_right, backwards) = (d_right(subject, retraction), d_right(subject, retraction.reversed()));
        let alone = subject.alone();
        let matrices = SemidirectMatrices::new(&alone);
        for x in subject.points() {
            let closed = d_right(&x);
            let right = matrices.d_right(retraction, &x);
            let left = matrices.d_left(retraction, &x);
            residuals.agree("dR τ_x y = Dτ(x)y τ(x)⁻¹", &closed.entries(), &right.entries(), DIFFERENCES);
            residuals.agree("dL τ_x = dR τ̄_−x", &backwards(&-&x).entries(), &left.entries(), DIFFERENCES);
            let adjoint = matrices.adjoint(&matrices.retract(retraction, &x));
            let turned = &adjoint * &backwards(&-&x);
            residuals.agree("dR = Ad dL", &closed.entries(), &turned.entries(), EXACT);
        }
    });
}

/// The derivative of `(dR τ_x)* m` by `x` and `m`, which Newton's matrix is made of: it may be known in closed form.
#[test]
fn logarithmic_derivatives_change_as_differences_say() {
    for_each_retraction(|subject, retraction, residuals| {
        if subject.is_summed(retraction) {
            return;
        }
        let n = subject.dimension();
        let dual =
            Formula::new(subject.arena, [n, n], |[x, m]| subject.group.d_right_dual(retraction, &x, &m));
        let change = Formula::new(subject.arena, [n, n, n, n], |[x, m, y, p]| {
            // of arguments that are no symbols, as those of a step are not
            let half = x.map(|x| x / 2);
            let symbols = [x.symbols(), m.symbols()].concat();
            let mean = subject.group.d_right_dual(retraction, &half, &(&m + &x));
            mean.derivative_along(&symbols, &Vector::concat([&y, &p]))
        });
        let random = &mut Random::new(31);
        for x in &subject.points()[2..4] {
            let [m, y, p] = std::array::from_fn(|_| Column::random(n, random));
            let at = |both: &Column| {
                let (x, m) = (both.part(0, n), both.part(n, n));
                dual.at([&x.scale(&Real::ratio(1, 2)), &(&m + &x)])
            };
            let defined = derivative(&Column::stack([x, &m]), &Column::stack([&y, &p]), at);
            residuals.agree("D((dR τ_x)* m)", &change.at([x, &m, &y, &p]), &defined, DIFFERENCES);
        }
    });
}

#[test]
fn the_domain_ends_where_the_retraction_is_singular() {
    for_each_retraction(|subject, retraction, residuals| {
        let d_right = d_right(subject, retraction);
        let x = symbols(subject.arena, "x", subject.dimension(), Stage::Step);
        let random = &mut Random::new(24);
        let directions: Vec<_> = (0..4).map(|_| Column::random(subject.dimension(), random)).collect();
        let margins = subject.group.domain(retraction, &x);
        if margins.is_empty() {
            // regular everywhere
            for direction in directions {
                let far = direction.scale(&Real::from(100));
                assert!(d_right(&far).determinant_magnitude() > Real::ten_to(-40));
            }
            return;
        }
        let margin = |at: &Column| {
            let mut point = Point::default();
            point.set(&x.symbols(), at);
            let margins = margins.iter().map(|&margin| point.scalar(margin));
            margins.reduce(|least, margin| if margin < least { margin } else { least }).expect("there is one")
        };
        for direction in directions {
            // the first zero on a ray, by bisection between where it is positive and where it is negative
            let is_within = |far: &Real| margin(&direction.scale(far)) > Real::from(0);
            assert!(is_within(&Real::from(0)));
            let farthest = if subject.is_compact() { 200 } else { 20 };
            let mut distances = (1..=farthest).map(|part| Real::ratio(part, 2));
            if subject.is_summed(retraction) {
                // it is known within a ball
                let edge = direction.scale(&(Real::ratio(3, 2) / direction.norm()));
                assert!(d_right(&edge).determinant_magnitude() > Real::ten_to(-9));
                continue;
            }
            let Some(mut outside) = distances.find(|far| !is_within(far)) else {
                // on groups that are not compact some rays are regular everywhere
                assert!(!subject.is_compact(), "{}", subject.group.name());
                assert!(d_right(&direction.scale(&Real::from(3))).determinant_magnitude() > Real::ten_to(-9));
                continue;
            };
            let mut inside = &outside - &Real::ratio(1, 2);
            for _ in 0..270 {
                let middle = (&inside + &outside) / Real::from(2);
                let within = margin(&direction.scale(&middle)) > Real::from(0);
                if within { inside = middle } else { outside = middle }
            }
            // the edge is a double: 1e-16 remains, and its square where the determinant has a double zero
            let at_edge = d_right(&direction.scale(&inside)).determinant_magnitude();
            // the Cayley map itself ends where 1 − X/2 is singular
            let ends = retraction == Retraction::Cayley && at_edge > Real::from(1);
            let at_edge = if ends { Real::from(1) / at_edge } else { at_edge };
            // boosts beside the rotation stretch it exponentially
            let before = d_right(&direction.scale(&(&inside * &Real::ratio(9, 10)))).determinant_magnitude();
            let stretch = if subject.is_compact() || ends { Real::from(1) } else { before };
            let at_edge = at_edge / stretch;
            let rounding = match (retraction.is_equivariant(), subject.is_compact()) {
                (true, true) => 1e-32,
                (true, false) => 1e-30,
                _ => 1e-15,
            };
            residuals.vanish("dR is singular at the edge", &at_edge, rounding);
            for part in 1..=9 {
                let regular = d_right(&direction.scale(&(&inside * Real::ratio(part, 10))));
                // on SE(3) the square of what it is on SO(3), on SE2(3) the cube
                assert!(regular.determinant_magnitude() > Real::ten_to(-6), "dR is regular within");
            }
        }
    });
}

#[test]
fn momentum_in_space_is_the_coadjoint_action_of_the_inverse() {
    for_each_group(|subject, residuals| {
        let (n, coordinates) = (subject.dimension(), subject.coordinates());
        let to_space = Formula::new(subject.arena, [coordinates, n], |[g, m]| subject.group.to_space(&g, &m));
        let compose = subject.compose();
        let random = &mut Random::new(25);
        let elements = subject.elements();
        for (g, h) in elements.iter().zip(elements.iter().rev()) {
            let [m, y] = std::array::from_fn(|_| Column::random(n, random));
            // ⟨Ad*_{g⁻¹} m, y⟩ = ⟨m, g⁻¹ y g⟩
            let matrix = subject.definition.matrix(g);
            let turned = &(&matrix.inverse() * &subject.definition.hat(&y)) * &matrix;
            let pairing = m.dot(&subject.definition.vee(&turned)) - to_space.at([g, &m]).dot(&y);
            residuals.vanish("⟨to_space m, y⟩ = ⟨m, Ad_{g⁻¹} y⟩", &pairing, EXACT);
            let both = to_space.at([&compose.at([g, h]), &m]);
            let after_each_other = to_space.at([g, &to_space.at([h, &m])]);
            residuals.agree("Ad*_{(g h)⁻¹} = Ad*_{g⁻¹} Ad*_{h⁻¹}", &both, &after_each_other, EXACT);
        }
    });
}

/// A closed form of the catalogue beside what follows from a basis whose axes are those of the catalogue over `stretch`: what has the
/// coordinates `x` there has `stretch x` here, and a momentum `m` is `m / stretch`.
fn agrees(
    (closed, derived): (&'static dyn Group, &'static MatrixGroup),
    stretch: &Real,
    matrix: impl Fn(&Column) -> Matrix,
) {
    let (arena, n) = (Arena::new(), closed.dimension());
    assert_eq!(derived.dimension(), n);
    let (mut residuals, random) = (Residuals::new(), &mut Random::new(31));
    let [x, y] = std::array::from_fn(|_| Column::random(n, random));
    let of_algebra = |x: &Column| x.scale(stretch);
    let of_dual = |m: &Column| m.scale(&(&Real::from(1) / stretch));
    let bracket = |group: &dyn Group, x: &Column, y: &Column| {
        Formula::new(&arena, [n, n], |[x, y]| group.bracket(&x, &y)).at([x, y])
    };
    let expected = of_algebra(&bracket(closed, &x, &y));
    residuals.agree("[x, y]", &expected, &bracket(derived, &of_algebra(&x), &of_algebra(&y)), EXACT);
    for retraction in [Retraction::Exponential, Retraction::Cayley] {
        assert!(derived.has(retraction), "{}", closed.name());
        let dual = |group: &dyn Group, x: &Column, m: &Column| {
            Formula::new(&arena, [n, n], |[x, m]| group.d_right_dual(retraction, &x, &m)).at([x, m])
        };
        let expected = of_dual(&dual(closed, &x, &y));
        residuals.agree("(dR τ_x)* m", &expected, &dual(derived, &of_algebra(&x), &of_dual(&y)), EXACT);
        let element = |group: &dyn Group, x: &Column| {
            Formula::new(&arena, [n], |[x]| group.retract(retraction, &x)).at([x])
        };
        // the matrix of the one is what is stored of the other
        let expected = matrix(&element(closed, &x)).entries();
        residuals.agree("τ(x)", &expected, &element(derived, &of_algebra(&x)), EXACT);
    }
}

fn of_catalogue(name: &str) -> &'static dyn Group {
    *catalogue().iter().find(|group| group.name() == name).expect("in the catalogue")
}

#[test]
fn closed_forms_are_those_that_follow_from_the_basis() {
    for &closed in catalogue() {
        let basis = closed.basis().expect("each has one");
        let derived = MatrixGroup::new(closed.name(), &basis).expect("a group");
        agrees((closed, derived), &Real::from(1), |g| realization(closed).matrix(g));
    }
}

/// SU(2) also by matrices of two complex rows, of which its algebra has `−iσ/2`, and the family of its name `iσ`.
#[test]
fn spins_are_those_that_follow_from_the_family() {
    let spins = of_catalogue("SU2");
    let derived = family("SU2").expect("a family");
    agrees((spins, derived), &Real::ratio(-1, 2), |q| {
        let [w, x, y, z] = std::array::from_fn(|i| q[i].clone());
        // w − i(x σ₁ + y σ₂ + z σ₃), with a + ib as [[a, −b], [b, a]]
        Matrix::from_rows([
            [w.clone(), z.clone(), -&y, x.clone()],
            [-&z, w.clone(), -&x, -&y],
            [y.clone(), x.clone(), w.clone(), -&z],
            [-&x, y, z, w],
        ])
    });
}
