//! Groups of matrices from their bases, in doubles against definitions by matrices: the fast form of what the tests of the workspace do with 77
//! digits.

use std::sync::LazyLock;

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::expr::{Arena, Stage, Vector};
use coadjoint_codegen::group::{
    Adjoint, Basis, BasisError, Group, MatrixFunction, MatrixGroup, Retraction, Semidirect, Side,
    Translation, catalogue, family,
};
use coadjoint_codegen::quantity::Kind;
use nalgebra::{DMatrix, DVector};

use crate::common::Random;

type Matrix = DMatrix<f64>;
type Column = DVector<f64>;

/// A matrix of a basis as it is given: by the name of its coordinate, and by rows.
type Named = (&'static str, Vec<i64>);

/// The group of a basis.
fn group(size: usize, basis: &[Named]) -> Result<&'static MatrixGroup, BasisError> {
    let named: Vec<_> = basis.iter().map(|(name, rows)| ((*name).to_owned(), rows.clone())).collect();
    MatrixGroup::new("matrices", &Basis::new(size, &named)?)
}

/// What is known of a family: its name, rows, coordinates and their first name, whether its Cayley map stays on it, and whether there are steps with
/// its exponential.
type Known = (&'static str, usize, usize, &'static str, bool, bool);

const FAMILIES: [Known; 17] = [
    ("SO2", 2, 1, "r12", true, true),
    ("SO3", 3, 3, "x", true, true),
    ("SO4", 4, 6, "r12", true, true),
    ("SO5", 5, 10, "r12", true, true),
    ("SE2", 3, 3, "r12", true, true),
    ("SE3", 4, 6, "x", true, true),
    ("SE23", 5, 9, "x", true, true),
    ("SGal3", 5, 10, "x", true, true),
    ("SL2", 2, 3, "h1", true, true),
    ("SL3", 3, 8, "h1", false, true),
    ("GL2", 2, 4, "e11", true, true),
    ("SP2", 2, 3, "a11", true, true),
    ("SP4", 4, 10, "a11", true, true),
    ("SU3", 6, 8, "s12", false, true),
    ("SO21", 3, 3, "rotation", true, true),
    ("Heisenberg", 3, 3, "x", true, true),
    ("Aff1", 2, 2, "scale", true, true),
];

/// Bases of no family: fractions among the structure constants, entries that tell several coordinates, forms that are not the unit, and each way in
/// which power series end or do not.
fn bases() -> Vec<(usize, Vec<Named>)> {
    vec![
        (
            3,
            vec![
                ("a", vec![0, 0, 0, 0, 0, -1, 0, 1, 0]),
                ("b", vec![0, 0, 1, 0, 0, -1, -1, 1, 0]),
                ("c", vec![0, -2, 0, 2, 0, 1, 0, -1, 0]),
            ],
        ),
        (2, vec![("a", vec![3, 0, 0, -3]), ("b", vec![1, 2, 0, -1]), ("c", vec![0, 1, 5, 0])]),
        // its ideals have an eigenvalue of the centroid that is not looked for
        (
            2,
            vec![
                ("a", vec![1, 0, 0, 5]),
                ("b", vec![0, 1, 0, 0]),
                ("c", vec![0, 0, 1, 0]),
                ("d", vec![1, 0, 0, 0]),
            ],
        ),
        (2, vec![("turn", vec![0, 1, -2, 0])]),
        (2, vec![("boost", vec![0, 1, 1, 0])]),
        (2, vec![("spiral", vec![1, -1, 1, 1])]),
        (2, vec![("scale", vec![1, 0, 0, 2])]),
        (4, vec![("a", vec![0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0])]),
        (4, vec![("a", vec![0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 2, 0, 0, -2, 0])]),
        (4, vec![("a", vec![0, 1, 1, 0, -1, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0])]),
    ]
}

/// The families, then those of the other bases: what is found of them takes longer than what is asked.
static GROUPS: LazyLock<Vec<&'static MatrixGroup>> = LazyLock::new(|| {
    let families = FAMILIES.iter().map(|known| family(known.0).expect(known.0));
    let own = |(size, basis): &(usize, Vec<_>)| group(*size, basis).expect("a basis");
    families.chain(bases().iter().map(own)).collect()
});

/// The family of this name.
fn of(name: &str) -> &'static MatrixGroup {
    GROUPS.iter().find(|group| group.name() == name).expect(name)
}

/// The vector that a formula makes of these.
fn value<const N: usize>(
    arguments: [&Column; N],
    formula: impl for<'a> Fn([Vector<'a>; N]) -> Vector<'a>,
) -> Column {
    let arena = Arena::new();
    let name = |k: usize, i: usize| format!("argument{k}_{i}");
    let vectors = std::array::from_fn(|k| {
        let symbol = |i| arena.symbol(name(k, i), Stage::Step);
        Vector((0..arguments[k].len()).map(symbol).collect())
    });
    let symbols = vectors.each_ref().map(Vector::symbols);
    let result = formula(vectors).evaluate(&|symbol| {
        let place = |k: usize| symbols[k].iter().position(|known| *known == symbol);
        let (k, i) = (0..N).find_map(|k| Some((k, place(k)?))).expect("an argument's");
        arguments[k][i]
    });
    Column::from_vec(result)
}

/// Numbers between −size and size, different for each seed.
fn random(n: usize, seed: u64, size: f64) -> Column {
    let mut random = Random(seed);
    Column::from_fn(n, |_, _| (2.0 * random.unit() - 1.0) * size)
}

fn basis(group: &MatrixGroup) -> Vec<Matrix> {
    let n = group.size();
    let entry = |axis: usize, i: usize, j: usize| {
        let (numerator, denominator) = group.basis_entry(axis, i, j);
        numerator as f64 / denominator as f64
    };
    (0..group.dimension()).map(|axis| Matrix::from_fn(n, n, |i, j| entry(axis, i, j))).collect()
}

fn hat(group: &MatrixGroup, x: &Column) -> Matrix {
    let n = group.size();
    basis(group).iter().zip(x.iter()).fold(Matrix::zeros(n, n), |sum, (e, x)| sum + e * *x)
}

/// The coordinates of a matrix, and how far it is from the algebra.
fn vee(group: &MatrixGroup, matrix: &Matrix) -> (Column, f64) {
    let columns: Vec<Column> = basis(group).iter().map(|e| Column::from_column_slice(e.as_slice())).collect();
    let (columns, entries) = (Matrix::from_columns(&columns), Column::from_column_slice(matrix.as_slice()));
    let x = columns.clone().svd(true, true).solve(&entries, 1e-12).expect("computed");
    let rest = (&columns * &x - entries).norm();
    (x, rest)
}

/// As it is stored.
fn by_rows(matrix: &Matrix) -> Column {
    Column::from_column_slice(matrix.transpose().as_slice())
}

fn one(n: usize) -> Matrix {
    Matrix::identity(n, n)
}

fn inverse(matrix: &Matrix) -> Matrix {
    matrix.clone().try_inverse().expect("regular")
}

/// `Σ Aᵏ / (k + shift)!`
fn series(matrix: &Matrix, shift: u32) -> Matrix {
    let factorial = f64::from((1..=shift).product::<u32>());
    let (mut term, mut sum) = (one(matrix.nrows()) / factorial, one(matrix.nrows()) / factorial);
    for k in 1..40 {
        term = &term * matrix / f64::from(k + shift);
        sum += &term;
    }
    sum
}

/// `τ(x)` by definition.
fn defined(group: &MatrixGroup, f: MatrixFunction, x: &Column) -> Matrix {
    let (matrix, n) = (hat(group, x), group.size());
    match f {
        MatrixFunction::Exponential | MatrixFunction::Coarse => series(&matrix, 0),
        MatrixFunction::Cayley => inverse(&(one(n) - &matrix * 0.5)) * (one(n) + &matrix * 0.5),
    }
}

const FUNCTIONS: [(MatrixFunction, Retraction); 2] =
    [(MatrixFunction::Exponential, Retraction::Exponential), (MatrixFunction::Cayley, Retraction::Cayley)];

/// Calls with each group, with each of its retractions, and a small element of the algebra.
fn for_each_retraction(check: impl Fn(&'static MatrixGroup, MatrixFunction, &Column)) {
    for group in GROUPS.iter().copied() {
        for (f, retraction) in FUNCTIONS {
            // the exponential has a form even where it would be too much code for steps
            if retraction == Retraction::Exponential || group.has(retraction) {
                check(group, f, &random(group.dimension(), 1, 0.5));
            }
        }
    }
}

#[track_caller]
fn assert_close(found: &Column, expected: &Column, what: &str, group: &MatrixGroup) {
    let size = 1.0 + expected.norm();
    assert!((found - expected).norm() < 1e-12 * size, "{what} of {group:?}: {found} {expected}");
}

#[test]
fn families_are_what_they_are_called() {
    for (name, rows, dimension, axis, _, _) in FAMILIES {
        let group = of(name);
        assert_eq!((group.size(), group.dimension(), group.axes()[0]), (rows, dimension, axis), "{name}");
        assert_eq!((group.name(), group.matrix_rows()), (name, Some(rows)));
        assert_eq!(group.names().kind, Kind::Matrix(rows, rows));
        assert_eq!(group.coordinates().len(), rows * rows);
        assert_eq!((group.coordinates()[0], group.coordinates()[1]), ("11", "12"));
        let mut names = group.axes().to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), dimension, "{name}: {:?}", group.axes());
        assert_eq!(vee(group, &one(rows)).0.len(), dimension);
        for (i, e) in basis(group).iter().enumerate() {
            let off = defect_of_the_algebra(name, e);
            assert!(off.norm() < 1e-14, "{name}, {}: {off}", group.axes()[i]);
        }
    }
    // as `hat` has them, and where rotations and translations stand
    let axes = |name: &str| of(name).axes();
    assert_eq!(axes("SE23"), ["x", "y", "z", "v1", "v2", "v3", "p1", "p2", "p3"]);
    assert_eq!(axes("SGal3")[9], "t");
    let turned = hat(of("SO3"), &Column::from_vec(vec![1.0, 2.0, 3.0]));
    assert_eq!(turned.transpose().as_slice(), [0.0, -3.0, 2.0, 3.0, 0.0, -1.0, -2.0, 1.0, 0.0]);
    assert_eq!(hat(of("SO2"), &Column::from_vec(vec![1.0]))[(1, 0)], 1.0);
}

/// Zero for matrices of the algebra of that name, of which there are as many as the family has coordinates.
fn defect_of_the_algebra(name: &str, e: &Matrix) -> Matrix {
    let n = e.nrows();
    let kept = |form: &Matrix| e * form + form * e.transpose();
    let first = |rows: usize| e.view((0, 0), (rows, rows)).into_owned();
    let below = |rows: usize| e.rows(rows, n - rows).into_owned();
    let skew = |matrix: Matrix| &matrix + matrix.transpose();
    let both = |a: Matrix, b: Matrix| Matrix::from_element(1, 1, a.norm() + b.norm());
    match name {
        "SE2" => both(skew(first(2)), below(2)),
        "SE3" => both(skew(first(3)), below(3)),
        "SE23" => both(skew(first(3)), below(3)),
        "SGal3" => {
            let time = Matrix::from_fn(n, n, |i, j| if (i, j) == (3, 4) { e[(3, 4)] } else { 0.0 });
            both(skew(first(3)), (e - time).rows(3, 2).into_owned())
        }
        "SO21" => kept(&Matrix::from_diagonal(&Column::from_vec(vec![1.0, 1.0, -1.0]))),
        "SP2" | "SP4" => kept(&symplectic_form(n)),
        "SU3" => {
            let sign = |i: usize, j: usize| f64::from(i8::from(i == j + 1) - i8::from(j == i + 1));
            let i = Matrix::from_fn(6, 6, |r, c| if r / 2 == c / 2 { sign(r, c) } else { 0.0 });
            let trace = (e * &i).trace();
            both(skew(e.clone()), e * &i - &i * e) + Matrix::from_element(1, 1, trace)
        }
        "SL2" | "SL3" => Matrix::from_element(1, 1, e.trace()),
        "Heisenberg" => e.lower_triangle(),
        "Aff1" => below(1),
        "GL2" => Matrix::zeros(1, 1),
        _ => skew(e.clone()),
    }
}

fn symplectic_form(n: usize) -> Matrix {
    Matrix::from_fn(n, n, |i, j| f64::from(i8::from(i + n / 2 == j) - i8::from(j + n / 2 == i)))
}

#[test]
fn retractions_are_what_they_are_called() {
    for_each_retraction(|group, f, x| {
        let found = value([x], |[x]| group.closed_form(f, &x));
        assert_close(&found, &by_rows(&defined(group, f, x)), f_name(f), group);
    });
}

fn f_name(f: MatrixFunction) -> &'static str {
    match f {
        MatrixFunction::Exponential | MatrixFunction::Coarse => "exponential",
        MatrixFunction::Cayley => "Cayley map",
    }
}

#[test]
fn there_are_retractions_where_they_stay_on_the_group() {
    for group in GROUPS.iter().copied() {
        // to second order in x it is in the algebra anyway
        let [x, y] = [2, 3].map(|seed| random(group.dimension(), seed, 1.0));
        let half = hat(group, &x) * 0.5;
        let moved =
            inverse(&(one(group.size()) - &half)) * hat(group, &y) * inverse(&(one(group.size()) + &half));
        assert_eq!(group.has(Retraction::Cayley), vee(group, &moved).1 < 1e-12, "{group:?}");
        assert!(!group.has(Retraction::SecondKind) && !group.has(Retraction::ReversedSecondKind));
    }
    for (name, _, _, _, cayley, exponential) in FAMILIES {
        let group = of(name);
        let found = (group.has(Retraction::Cayley), group.has(Retraction::Exponential));
        assert_eq!(found, (cayley, exponential), "{name}");
    }
}

/// `⟨(dR τ_x)* m, y⟩ = ⟨m, Dτ(x)y τ(x)⁻¹⟩`, with `φ₁(ad_x) y` of the exponential as a series and `(1 − X/2)⁻¹ Y (1 + X/2)⁻¹` of the Cayley map.
#[test]
fn logarithmic_derivatives_are_those_of_the_retraction() {
    for_each_retraction(|group, f, x| {
        let (n, m) = (group.dimension(), random(group.dimension(), 4, 1.0));
        let found = value([x, &m], |[x, m]| group.closed_d_right_dual(f, &x, &m));
        let matrix = hat(group, x);
        let half = &matrix * 0.5;
        let moved = |y: &Matrix| match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let (mut term, mut sum) = (y.clone(), y.clone());
                for k in 2..40 {
                    term = (&matrix * &term - &term * &matrix) / f64::from(k);
                    sum += &term;
                }
                sum
            }
            MatrixFunction::Cayley => {
                inverse(&(one(group.size()) - &half)) * y * inverse(&(one(group.size()) + &half))
            }
        };
        let basis = basis(group);
        let expected = Column::from_fn(n, |j, _| m.dot(&vee(group, &moved(&basis[j])).0));
        assert_close(&found, &expected, f_name(f), group);
    });
}

/// Of the groups with closed forms of their own, by the stored coordinates: `τ(x + εy) τ(x)⁻¹` leaves the unit as `τ(ε dR τ_x y)` does.
#[test]
fn logarithmic_derivatives_of_the_catalogue_are_those_of_the_retraction() {
    /// How `τ(at + ε direction) τ(at)⁻¹` leaves the unit.
    fn leaves<'a>(
        group: &dyn Group,
        f: MatrixFunction,
        at: &Vector<'a>,
        direction: &Vector<'a>,
    ) -> Vector<'a> {
        let arena = direction.0[0].arena();
        let symbol = |i| arena.symbol(format!("p{i}"), Stage::Step);
        let p = Vector((0..direction.len()).map(symbol).collect());
        let near = group.compose(&group.closed_form(f, &p), &group.inverse(&group.closed_form(f, at)));
        let there: Vec<_> = p.symbols().into_iter().zip(at.iter()).collect();
        near.derivative_along(&p.symbols(), direction).substitute(&there)
    }
    for group in catalogue() {
        let n = group.dimension();
        let (x, y) = (random(n, 31, 1.0), random(n, 32, 1.0));
        for f in [MatrixFunction::Exponential, MatrixFunction::Cayley] {
            let expected = value([&x, &y], |[x, y]| leaves(*group, f, &x, &y));
            let found = value([&x, &y], |[x, y]| {
                let zero = x.map(|component| component - component);
                leaves(*group, f, &zero, &group.closed_d_right(f, &x, &y))
            });
            assert!((&found - &expected).amax() < 5e-15, "{}, {f:?}: {found} {expected}", group.name());
        }
    }
}

/// What is made of a group of the catalogue, and what acts beside it, goes by its basis: that has the axes of the group itself.
#[test]
fn bases_of_the_catalogue_have_its_brackets() {
    for group in catalogue() {
        let basis = group.basis().unwrap_or_else(|| panic!("{} has a basis", group.name()));
        let derived = MatrixGroup::new("derived", &basis).expect("a basis");
        let n = group.dimension();
        assert_eq!((derived.dimension(), derived.blocks()), (n, group.blocks()), "{}", group.name());
        let (x, y) = (random(n, 41, 1.0), random(n, 42, 1.0));
        let expected = value([&x, &y], |[x, y]| group.bracket(&x, &y));
        let found = value([&x, &y], |[x, y]| derived.bracket(&x, &y));
        assert!((&found - &expected).amax() < 1e-15, "{}: {found} {expected}", group.name());
        // the bracket of plane rotations is zero for an axis of any length, their retraction is not
        let expected = value([&x, &y], |[x, y]| group.closed_d_right(MatrixFunction::Cayley, &x, &y));
        let found = value([&x, &y], |[x, y]| derived.closed_d_right(MatrixFunction::Cayley, &x, &y));
        assert!((&found - &expected).amax() < 5e-15, "{}: {found} {expected}", group.name());
    }
}

/// The derivative of `(dR τ_x)* m` by `x` and `m`, whether it is differentiated or known in closed form; of arguments that are not symbols
/// themselves, and of those that are put in their places later.
#[test]
fn logarithmic_derivatives_change_as_differences_say() {
    for_each_retraction(|group, f, x| {
        let n = group.dimension();
        let [m, y, p] = [11, 12, 13].map(|seed| random(n, seed, 1.0));
        let found = value([x, &m, &y, &p], |[x, m, y, p]| {
            let arena = x.0[0].arena();
            let symbol = |i: usize| arena.symbol(format!("at{i}"), Stage::Step);
            let at = Vector((0..2 * n).map(symbol).collect());
            let (first, second) = at.0.split_at(n);
            let dual = group.closed_d_right_dual(f, &Vector(first.to_vec()), &Vector(second.to_vec()));
            let half = x.map(|x| x / 2);
            let there: Vec<_> = at.symbols().into_iter().zip(half.iter().chain((&m + &x).iter())).collect();
            let (symbols, changes) = ([x.symbols(), m.symbols()].concat(), Vector::concat([&y, &p]));
            dual.substitute(&there).derivative_along(&symbols, &changes)
        });
        let at = |t: f64| {
            let (x, m) = (x + &y * t, &m + &p * t);
            value([&(&x * 0.5), &(&m + &x)], |[x, m]| group.closed_d_right_dual(f, &x, &m))
        };
        let (near, far) = ((at(1e-3) - at(-1e-3)) / 2e-3, (at(2e-3) - at(-2e-3)) / 4e-3);
        let (expected, n) = ((near * 4.0 - far) / 3.0, 1.0 + found.norm());
        assert!((&found - &expected).norm() < 1e-10 * n, "{} of {group:?}: {found} {expected}", f_name(f));
    });
}

#[test]
fn brackets_products_and_inverses_are_those_of_matrices() {
    for group in GROUPS.iter().copied() {
        let n = group.dimension();
        let [x, y, m] = [5, 6, 7].map(|seed| random(n, seed, 0.5));
        let [a, b] = [&x, &y].map(|x| hat(group, x));
        let (bracket, off) = vee(group, &(&a * &b - &b * &a));
        assert!(off < 1e-12);
        assert_close(&value([&x, &y], |[x, y]| group.bracket(&x, &y)), &bracket, "bracket", group);
        let [g, h] = [&a, &b].map(|x| series(x, 0));
        let [stored, other] = [&g, &h].map(by_rows);
        let product = value([&stored, &other], |[g, h]| group.compose(&g, &h));
        assert_close(&product, &by_rows(&(&g * &h)), "product", group);
        let back = value([&stored], |[g]| group.inverse(&g));
        assert_close(&back, &by_rows(&inverse(&g)), "inverse", group);
        // ⟨Ad*_{g⁻¹} m, y⟩ = ⟨m, g⁻¹ y g⟩
        let in_space = value([&stored, &m], |[g, m]| group.to_space(&g, &m));
        let basis = basis(group);
        let turned = |j: usize| m.dot(&vee(group, &(inverse(&g) * &basis[j] * &g)).0);
        assert_close(&in_space, &Column::from_fn(n, |j, _| turned(j)), "momentum in space", group);
        let near = value([&stored, &y], |[g, y]| group.near(Side::Left, &g, &y));
        assert_close(&near, &by_rows(&(&g * (one(group.size()) + &b))), "what is near", group);
    }
}

/// What roundoff has moved off the group comes back with its square as the error; where nothing is known of the group it stays.
#[test]
fn normalization_takes_small_errors_away() {
    for (name, rows, _, _, _, _) in FAMILIES {
        let group = of(name);
        let g = series(&hat(group, &random(group.dimension(), 8, 0.5)), 0);
        let normalized = |g: &Matrix| {
            let stored = value([&by_rows(g)], |[g]| group.normalize(&g));
            Matrix::from_row_slice(rows, rows, stored.as_slice())
        };
        assert_close(&by_rows(&normalized(&g)), &by_rows(&g), "what is on the group", group);
        let off = &g + Matrix::from_vec(rows, rows, random(rows * rows, 9, 1e-6).as_slice().to_vec());
        let back = normalized(&off);
        let defect = defect(name, &back);
        assert!(defect < 1e-10, "{name}: {defect}");
        assert!((&back - &g).norm() < 1e-4, "{name}");
    }
}

/// Unit quaternions and complex numbers too.
#[test]
fn normalization_makes_lengths_one() {
    for (name, n) in [("SO2", 2), ("SO3", 4), ("SU2", 4)] {
        let group = catalogue().iter().find(|group| group.name() == name).expect(name);
        let unit = random(n, 3, 1.0).normalize();
        let back = value([&(&unit * (1.0 + 1e-6))], |[g]| group.normalize(&g));
        assert!((&back - &unit).norm() < 1e-11, "{name}: {back} {unit}");
    }
}

/// Along `x` a vector of the algebra and of its dual is moved by `φ₁(ρ(x)) w`, with `ρ` as matrices.
#[test]
fn translations_of_the_algebra_and_its_dual_are_their_series() {
    for_each_retraction(|group, f, x| {
        if f != MatrixFunction::Exponential {
            return;
        }
        let n = group.dimension();
        let adjoint = Adjoint::of(group);
        for space in [adjoint, adjoint.dual().expect("it has one")] {
            let column = |j: usize| {
                let unit = Column::from_fn(n, |i, _| f64::from(i == j));
                value([x, &unit], |[x, w]| space.act_infinitesimally(&x, &w))
            };
            let rho = Matrix::from_columns(&(0..n).map(column).collect::<Vec<_>>());
            let w = random(n, 11, 1.0);
            let shift = value([x, &w], |[x, w]| {
                let Translation { body_part, rotated_part, .. } = space.translation(f, &x, &w);
                &body_part + &space.transport(f, &x, &rotated_part)
            });
            assert_close(&shift, &(series(&rho, 1) * &w), space.name(), group);
            let moved = value([x, &w], |[x, w]| space.transport(f, &x, &w));
            assert_close(&moved, &(series(&rho, 0) * &w), space.name(), group);
        }
    });
}

/// Series that are summed are shorter for Newton's matrix; finite sums are not.
#[test]
fn what_is_summed_has_fewer_terms_for_newton() {
    for group in GROUPS.iter().copied() {
        let whole = Semidirect { group, spaces: Vec::new() };
        let is_summed = group.is_summed(Retraction::Exponential);
        assert_eq!(whole.is_summed(Retraction::Exponential), is_summed, "{group:?}");
        let x = random(group.dimension(), 13, 1.0);
        let [exponential, coarse] = [MatrixFunction::Exponential, MatrixFunction::Coarse]
            .map(|f| value([&x], |[x]| group.closed_form(f, &x)));
        assert_eq!(exponential != coarse, is_summed, "{group:?}");
        let families = ["SO5", "SL3", "SP4", "SU3"];
        assert!(group.name() == "matrices" || is_summed == families.contains(&group.name()), "{group:?}");
    }
}

/// A basis, its matrices carried over to other coordinates.
fn conjugated(basis: &[Matrix], by: &Matrix) -> Vec<Matrix> {
    basis.iter().map(|e| by * e * inverse(by)).collect()
}

/// The group of these matrices, which are of whole numbers.
fn of_matrices(basis: &[Matrix]) -> &'static MatrixGroup {
    let named: Vec<(String, Vec<i64>)> = (0..basis.len())
        .map(|k| (format!("e{k}"), by_rows(&basis[k]).iter().map(|&x| x.round() as i64).collect()))
        .collect();
    let basis = Basis::new(basis[0].nrows(), &named).expect("a basis");
    MatrixGroup::new("matrices", &basis).expect("a group")
}

/// A block on the diagonal of a larger matrix.
fn placed(block: &Matrix, from: usize, size: usize) -> Matrix {
    let mut whole = Matrix::zeros(size, size);
    whole.view_mut((from, from), block.shape()).copy_from(block);
    whole
}

/// A determinant that is 1, be it of a block or of complex numbers, is told where it is not, and comes back to 1: what is multiplied by
/// `1 + ε c`, for each `c` by which it would change.
#[test]
fn determinants_are_told_and_corrected() {
    let unit = |n: usize, i: usize, j: usize| Matrix::from_fn(n, n, |r, c| f64::from((r, c) == (i, j)));
    let (sl3, so3, su3) = (basis(of("SL3")), basis(of("SO3")), basis(of("SU3")));
    let i = Matrix::from_fn(6, 6, |r, c| match (r / 2 == c / 2, r % 2, c % 2) {
        (true, 1, 0) => 1.0,
        (true, 0, 1) => -1.0,
        _ => 0.0,
    });
    let padded = |basis: &[Matrix], from: usize, size: usize| -> Vec<Matrix> {
        basis.iter().map(|e| placed(e, from, size)).collect()
    };
    let triangular = [&sl3[..2], &[unit(3, 0, 1), unit(3, 0, 2), unit(3, 1, 2)]].concat();
    let translations = [unit(4, 0, 3), unit(4, 1, 3), unit(4, 2, 3)];
    let affine = [padded(&sl3, 0, 4), translations.to_vec()].concat();
    let both = [padded(&so3, 0, 6), padded(&sl3, 3, 6)].concat();
    let complex = [su3.clone(), su3.iter().map(|e| e * &i).collect()].concat();
    let mut sheared = one(6);
    (sheared[(0, 3)], sheared[(4, 1)], sheared[(5, 0)]) = (1.0, 2.0, -1.0);
    let turned = &sheared * &i * inverse(&sheared);
    let cases = [
        (triangular, vec![one(3)]),
        (affine, vec![placed(&one(3), 0, 4)]),
        (both, vec![placed(&one(3), 3, 6)]),
        (complex, vec![one(6), i.clone()]),
        (conjugated(&su3, &sheared), vec![turned]),
        (su3, vec![i]),
    ];
    for (basis, directions) in cases {
        let (group, n) = (of_matrices(&basis), basis[0].nrows());
        let stored = |g: &Matrix| by_rows(g);
        let deviation = |g: &Matrix| value([&stored(g)], |[g]| group.deviation(&g).expect("bounded")).norm();
        let g = series(&hat(group, &random(basis.len(), 8, 0.3)), 0);
        assert!(deviation(&g) < 1e-14, "{group:?}: {:e}", deviation(&g));
        assert_close(&value([&stored(&g)], |[g]| group.normalize(&g)), &stored(&g), "on the group", group);
        for direction in directions {
            let off = (one(n) + &direction * 1e-6) * &g;
            // three times that is what a determinant of three rows is off by
            assert!(deviation(&off) > 2.9e-6, "{group:?}: {:e}", deviation(&off));
            let back = value([&stored(&off)], |[g]| group.normalize(&g));
            let error = (&back - stored(&g)).norm();
            assert!(error < 2e-11, "{group:?}: {error:e}");
        }
    }
    // as far off as can be
    let deviation = |name: &str, g: &Matrix| {
        value([&by_rows(g)], |[g]| of(name).deviation(&g).expect("it has one")).norm()
    };
    assert!(deviation("SU3", &-one(6)) > 1.0);
    assert!(deviation("SO4", &Matrix::from_diagonal(&Column::from_vec(vec![-1.0, 1.0, 1.0, 1.0]))) > 1.0);
}

/// Elements whose products are off by their rounding are the same after a step that does not move them, to the last bit.
#[test]
fn what_is_at_rest_stays() {
    for name in ["SO4", "SO21", "SL2", "SL3", "SP4", "SU3", "SE23"] {
        let (group, arena) = (of(name), Arena::new());
        let symbols = |name: &str, n: usize| {
            Vector((0..n).map(|k| arena.symbol(format!("{name}{k}"), Stage::Step)).collect())
        };
        let (g, x) = (symbols("g", group.coordinates().len()), symbols("x", group.dimension()));
        let (places, normalized) = (g.symbols(), group.normalize(&g));
        let retraction =
            if group.has(Retraction::Cayley) { Retraction::Cayley } else { Retraction::Exponential };
        for side in [Side::Left, Side::Right] {
            let next = group.moved(side, retraction, &g, &x).next;
            let mut corrected = 0;
            for seed in 50..90 {
                let size = f64::from(u32::try_from(seed % 4).expect("small")) * 0.5 + 0.5;
                let start = by_rows(&series(&hat(group, &random(group.dimension(), seed, size)), 0));
                let there = |vector: &Vector<'_>, element: &[f64]| {
                    let entry = |symbol| places.iter().position(|place| *place == symbol);
                    vector.evaluate(&|symbol| entry(symbol).map_or(0.0, |k| element[k]))
                };
                let start = there(&normalized, start.as_slice());
                assert_eq!(there(&next, &start), start, "{name}, {seed}");
                corrected += usize::from(there(&normalized, &start) != start);
            }
            // there is something to correct
            assert!(corrected > 5, "{name}: {corrected}");
        }
    }
}

/// How far a matrix is from the group of that name.
fn defect(name: &str, g: &Matrix) -> f64 {
    let n = g.nrows();
    let keeps = |form: &Matrix| (g * form * g.transpose() - form).norm();
    let rigid = |rows: usize| {
        let rotation = g.view((0, 0), (rows, rows)).into_owned();
        let rest = g.rows(rows, n - rows) - one(n).rows(rows, n - rows);
        (&rotation * rotation.transpose() - one(rows)).norm() + rest.norm()
    };
    match name {
        "SE2" => rigid(2),
        "SE3" | "SE23" => rigid(3),
        "SGal3" => {
            let mut still = g.clone();
            still[(3, 4)] = 0.0;
            let rotation = g.view((0, 0), (3, 3)).into_owned();
            (&rotation * rotation.transpose() - one(3)).norm() + (still.rows(3, 2) - one(5).rows(3, 2)).norm()
        }
        "SO21" => keeps(&Matrix::from_diagonal(&Column::from_vec(vec![1.0, 1.0, -1.0]))),
        "SP2" | "SP4" => keeps(&symplectic_form(n)),
        "SL2" | "SL3" => (g.determinant() - 1.0).abs(),
        "GL2" => 0.0,
        "Heisenberg" => (g.lower_triangle() - one(3)).norm(),
        "Aff1" => (g.rows(1, 1) - one(2).rows(1, 1)).norm(),
        _ => (g * g.transpose() - one(n)).norm(),
    }
}

/// The edge is where `dR` is singular or `1 − X/2` is, or that of the ball within which series are summed.
#[test]
fn domains_end_where_retractions_are_singular() {
    let edge = |name: &str, retraction: Retraction, x: &[f64]| {
        let x = Column::from_column_slice(x);
        let group = of(name);
        let arena = Arena::new();
        let symbols: Vec<_> = (0..x.len()).map(|i| arena.symbol(format!("x{i}"), Stage::Step)).collect();
        let symbols = Vector(symbols);
        let known = symbols.symbols();
        let place = |symbol| known.iter().position(|known| *known == symbol).expect("one of them");
        let edges = group.domain(retraction, &symbols);
        edges.into_iter().map(|edge| edge.evaluate(&|symbol| x[place(symbol)])).reduce(f64::min)
    };
    let turn = std::f64::consts::TAU;
    let exponential = |name, x: &[f64]| edge(name, Retraction::Exponential, x).expect("an edge");
    for inside in [0.99, 1.01] {
        let is_inside = inside < 1.0;
        assert_eq!(exponential("SO3", &[0.0, 0.0, turn * inside]) > 0.0, is_inside);
        assert_eq!(
            exponential("SE23", &[0.0, turn * inside, 0.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0]) > 0.0,
            is_inside
        );
        // sl(2) turns twice as fast in its algebra: e − f by an angle φ has the eigenvalues ±2iφ there
        assert_eq!(exponential("SL2", &[0.0, turn / 2.0 * inside, -turn / 2.0 * inside]) > 0.0, is_inside);
        // both ideals turn by as much as a plane of four dimensions
        assert_eq!(exponential("SO4", &[turn * inside, 0.0, 0.0, 0.0, 0.0, 0.0]) > 0.0, is_inside);
        // |ad_x|² + |X|² is 6 + 2 where one plane of five dimensions turns
        let size = (9.0_f64 / 4.0 / 8.0).sqrt();
        let mut plane = [0.0; 10];
        plane[0] = size * inside;
        assert_eq!(exponential("SO5", &plane) > 0.0, is_inside);
        let cayley = edge("SL2", Retraction::Cayley, &[2.0 * inside, 0.0, 0.0]).expect("an edge");
        assert_eq!(cayley > 0.0, is_inside);
    }
    // nothing turns, and boosts never come back
    assert_eq!(edge("Heisenberg", Retraction::Exponential, &[1.0, 2.0, 3.0]), None);
    assert!(exponential("SL2", &[50.0, 0.0, 0.0]) > 0.0);
    for name in ["SO4", "SE23", "Heisenberg", "SO3", "SO5"] {
        let n = of(name).dimension();
        assert_eq!(edge(name, Retraction::Cayley, &vec![1.0; n]), None, "{name}");
    }
    for name in ["SL2", "GL2", "SO21", "SP4", "Aff1"] {
        let n = of(name).dimension();
        assert!(edge(name, Retraction::Cayley, &vec![0.1; n]).is_some(), "{name}");
    }
}

#[test]
fn spaces_are_columns_that_matrices_act_on() {
    for_each_retraction(|group, f, x| {
        let n = group.size();
        let [space] = group.representations() else { panic!("one space") };
        assert_eq!((space.name(), space.coordinates().len()), (&*format!("R{n}"), n));
        assert_eq!((space.coordinates().len(), space.algebra_dimension()), (n, group.dimension()));
        assert_eq!(space.coordinates()[0], if n <= 4 { "x" } else { "1" });
        let (v, matrix, g) = (random(n, 10, 1.0), hat(group, x), defined(group, f, x));
        let moved = value([x, &v], |[x, v]| space.act_infinitesimally(&x, &v));
        assert_close(&moved, &(&matrix * &v), "X v", group);
        let moved = value([&by_rows(&g), &v], |[g, v]| group.act(&g, &v).expect("columns"));
        assert_close(&moved, &(&g * &v), "g v", group);
        let moved = value([x, &v], |[x, v]| space.transport(f, &x, &v));
        assert_close(&moved, &(&g * &v), "τ(x) v", group);
        let shift = value([x, &v], |[x, w]| {
            let Translation { body_part, rotated_part, is_tangent_group } = space.translation(f, &x, &w);
            assert!(!is_tangent_group);
            &body_part + &space.transport(f, &x, &rotated_part)
        });
        let expected = match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => series(&matrix, 1) * &v,
            MatrixFunction::Cayley => inverse(&(one(n) - &matrix * 0.5)) * &v,
        };
        assert_close(&shift, &expected, "the way of a translation", group);
    });
}

/// The ideals of GL(2) are told by eigenvalues that depend on the basis.
#[test]
fn any_basis_makes_a_group() {
    // one of two is enough to tell both, and each has a closed exponential
    let one_is_found = [("a", vec![1, 0, 0, 5]), ("b", vec![0, 1, 0, 0]), ("c", vec![0, 0, 1, 0])];
    let all = [&one_is_found[..], &[("d", vec![1, 0, 0, 0])]].concat();
    assert!(!group(2, &all).expect("a basis").is_summed(Retraction::Exponential));
    let mut random = Random(5);
    for _ in 0..40 {
        let mut entry = |_| i64::try_from(random.below(13)).expect("small") - 6;
        let matrices = ["a", "b", "c", "d"].map(|name| (name, (0..4).map(&mut entry).collect()));
        match group(2, &matrices) {
            Ok(group) => assert_eq!(group.dimension(), 4),
            Err(error) => assert!(matches!(error, BasisError::Dependent(_)), "{matrices:?}: {error:?}"),
        }
    }
}

#[test]
fn what_is_no_basis_is_told() {
    let told = |size: usize, basis: &[Named]| group(size, basis).expect_err("no basis");
    assert_eq!(told(2, &[]), BasisError::Shape);
    assert_eq!(told(0, &[("a", vec![])]), BasisError::Shape);
    assert_eq!(told(2, &[("a", vec![0, 1, 0])]), BasisError::Shape);
    let (e, h) = (vec![0, 1, 0, 0], vec![1, 0, 0, -1]);
    assert_eq!(told(2, &[("a", vec![0; 4])]), BasisError::Dependent(0));
    assert_eq!(
        told(2, &[("h", h.clone()), ("e", e.clone()), ("c", vec![2, 3, 0, -2])]),
        BasisError::Dependent(2)
    );
    assert_eq!(told(2, &[("h", h), ("e", e.clone()), ("f", e)]), BasisError::Dependent(2));
    assert_eq!(told(2, &[("e", vec![0, 1, 0, 0]), ("f", vec![0, 0, 1, 0])]), BasisError::NotClosed(0, 1));
    let unit = |k: usize| ("a", (0..25).map(|i| i64::from(i == k)).collect::<Vec<_>>());
    assert_eq!(told(5, &(0..17).map(unit).collect::<Vec<_>>()), BasisError::TooLarge);
    assert_eq!(told(13, &[("a", vec![1; 169])]), BasisError::TooLarge);
    let large: Vec<i64> = (0..36).map(|k| i64::MAX / (k + 1) - k).collect();
    assert_eq!(told(6, &[("a", large)]), BasisError::TooLarge);
}
