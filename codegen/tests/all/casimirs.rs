//! Casimirs found from structure constants alone: of groups by a basis of matrices, whose numbers and degrees are known, and of every group of
//! the catalogue with advected parameters.

use std::collections::BTreeMap;

use coadjoint_codegen::group::casimirs::{Casimirs, Polynomial, casimirs, casimirs_of};
use coadjoint_codegen::group::{Basis, MatrixGroup, Semidirect, Structure, catalogue};
use num_rational::Ratio;

use crate::common::Random;

type Fraction = Ratio<i64>;
/// Rows of a square matrix.
type Matrix = Vec<Vec<i64>>;

/// The matrix with these entries, row, column and value.
fn matrix(n: usize, entries: &[(usize, usize, i64)]) -> Matrix {
    let mut matrix = vec![vec![0; n]; n];
    entries.iter().for_each(|&(i, j, value)| matrix[i][j] = value);
    matrix
}

/// The rows without what is left of each other.
fn reduced(mut rows: Vec<Vec<Fraction>>) -> Vec<Vec<Fraction>> {
    let zero = Fraction::from_integer(0);
    let columns = rows.first().map_or(0, Vec::len);
    let mut done = 0;
    for column in 0..columns {
        let Some(pivot) = (done..rows.len()).find(|&row| rows[row][column] != zero) else { continue };
        rows.swap(done, pivot);
        let scale = rows[done][column];
        rows[done].iter_mut().for_each(|x| *x /= scale);
        for row in (0..rows.len()).filter(|&row| row != done) {
            let factor = rows[row][column];
            let pivot = rows[done].clone();
            rows[row].iter_mut().zip(pivot).for_each(|(x, y)| *x -= factor * y);
        }
        done += 1;
    }
    rows.truncate(done);
    rows
}

/// The structure constants of a basis, by its commutators.
fn structure(basis: &[Matrix]) -> Structure {
    let n = basis[0].len();
    let product = |a: &Matrix, b: &Matrix, i: usize, j: usize| (0..n).map(|k| a[i][k] * b[k][j]).sum::<i64>();
    let coordinates = |a: &Matrix, b: &Matrix| {
        let entry = |i: usize, j: usize| product(a, b, i, j) - product(b, a, i, j);
        let row = |k: usize| {
            let (i, j) = (k / n, k % n);
            let of_basis = basis.iter().map(|e| Fraction::from_integer(e[i][j]));
            of_basis.chain([Fraction::from_integer(entry(i, j))]).collect()
        };
        let rows = reduced((0..n * n).map(row).collect());
        assert_eq!(rows.len(), basis.len(), "a basis is independent, and closed under the commutator");
        let coordinates = rows.iter().enumerate().map(|(k, row)| (k, row[basis.len()]));
        coordinates.filter(|(_, x)| *x.numer() != 0).collect::<Vec<_>>()
    };
    Structure::new(basis.len(), |i, j| coordinates(&basis[i], &basis[j]))
}

fn so(n: usize) -> Vec<Matrix> {
    let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    pairs.map(|(i, j)| matrix(n, &[(j, i, 1), (i, j, -1)])).collect()
}

fn sl(n: usize) -> Vec<Matrix> {
    let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|(i, j)| i != j);
    let off = pairs.map(|(i, j)| matrix(n, &[(i, j, 1)]));
    off.chain((0..n - 1).map(|i| matrix(n, &[(i, i, 1), (i + 1, i + 1, -1)]))).collect()
}

/// `[[A, B], [C, −Aᵀ]]` with symmetric `B` and `C`.
fn sp(n: usize) -> Vec<Matrix> {
    let mut basis = Vec::new();
    for i in 0..n {
        for j in 0..n {
            basis.push(matrix(2 * n, &[(i, j, 1), (n + j, n + i, -1)]));
        }
        for j in i..n {
            basis.push(matrix(2 * n, &[(i, n + j, 1), (j, n + i, 1)]));
            basis.push(matrix(2 * n, &[(n + i, j, 1), (n + j, i, 1)]));
        }
    }
    basis
}

/// Complex matrices as real ones of twice the size.
fn su(n: usize) -> Vec<Matrix> {
    let real = |entries: &[(usize, usize, i64)]| {
        let twice: Vec<_> = entries.iter().flat_map(|&(i, j, x)| [(i, j, x), (n + i, n + j, x)]).collect();
        matrix(2 * n, &twice)
    };
    let imaginary = |entries: &[(usize, usize, i64)]| {
        let twice: Vec<_> = entries.iter().flat_map(|&(i, j, x)| [(i, n + j, -x), (n + i, j, x)]).collect();
        matrix(2 * n, &twice)
    };
    let mut basis = Vec::new();
    for i in 0..n {
        for j in i + 1..n {
            basis.push(real(&[(i, j, 1), (j, i, -1)]));
            basis.push(imaginary(&[(i, j, 1), (j, i, 1)]));
        }
    }
    basis.extend((0..n - 1).map(|i| imaginary(&[(i, i, 1), (i + 1, i + 1, -1)])));
    basis
}

/// Rotations, and columns that they turn.
fn with_columns(n: usize, columns: usize) -> Vec<Matrix> {
    let size = n + columns;
    let wider = |m: Matrix| {
        let entry = |i: usize, j: usize| if i < n && j < n { m[i][j] } else { 0 };
        (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect()
    };
    let rotations = so(n).into_iter().map(wider);
    let columns = (0..columns).flat_map(|c| (0..n).map(move |i| (i, n + c)));
    rotations.chain(columns.map(|(i, j)| matrix(size, &[(i, j, 1)]))).collect()
}

/// With all variables in one block.
fn found(basis: &[Matrix]) -> Casimirs {
    casimirs(&structure(basis), std::slice::from_ref(&(0..basis.len())))
}

#[test]
fn of_matrix_groups_they_have_the_known_degrees() {
    let heisenberg = [matrix(3, &[(0, 1, 1)]), matrix(3, &[(1, 2, 1)]), matrix(3, &[(0, 2, 1)])];
    let affine = [matrix(2, &[(0, 0, 1)]), matrix(2, &[(0, 1, 1)])];
    let gl: Vec<Matrix> = (0..4).map(|k| matrix(2, &[(k / 2, k % 2, 1)])).collect();
    let lorentz = [
        matrix(3, &[(0, 1, 1), (1, 0, -1)]),
        matrix(3, &[(0, 2, 1), (2, 0, 1)]),
        matrix(3, &[(1, 2, 1), (2, 1, 1)]),
    ];
    let galilei = [with_columns(3, 2), vec![matrix(5, &[(3, 4, 1)])]].concat();
    let cases: [(&str, Vec<Matrix>, &[usize]); 15] = [
        ("so(3)", so(3), &[2]),
        ("so(4)", so(4), &[2, 2]),
        ("sl(2)", sl(2), &[2]),
        ("sl(3)", sl(3), &[2, 3]),
        ("sp(4)", sp(2), &[2, 4]),
        ("su(2)", su(2), &[2]),
        ("su(3)", su(3), &[2, 3]),
        ("se(2)", with_columns(2, 1), &[2]),
        ("se(3)", with_columns(3, 1), &[2, 2]),
        ("se_2(3)", with_columns(3, 2), &[2, 2, 2]),
        ("heisenberg", heisenberg.to_vec(), &[1]),
        ("aff(1)", affine.to_vec(), &[]),
        ("gl(2)", gl, &[1, 2]),
        ("so(2,1)", lorentz.to_vec(), &[2]),
        ("sgal(3)", galilei, &[2, 4]),
    ];
    for (name, basis, degrees) in cases {
        let Casimirs { found, missing } = found(&basis);
        let degree = |casimir: &Polynomial| casimir.keys().next().map_or(0, Vec::len);
        assert_eq!(found.iter().map(degree).collect::<Vec<_>>(), degrees, "{name}");
        assert_eq!(missing, 0, "{name}");
    }
}

#[test]
fn they_read_as_in_textbooks() {
    let polynomial = |terms: &[(&[usize], i64)]| -> Polynomial {
        terms.iter().map(|&(monomial, x)| (monomial.to_vec(), x)).collect()
    };
    // e f + h²/4 of e, f, h
    assert_eq!(found(&sl(2)).found, [polynomial(&[(&[0, 1], 4), (&[2, 2], 1)])]);
    // |p|², then L·p
    let [lengths, product] = <[Polynomial; 2]>::try_from(found(&with_columns(3, 1)).found).expect("two");
    assert_eq!(lengths, polynomial(&[(&[3, 3], 1), (&[4, 4], 1), (&[5, 5], 1)]));
    assert_eq!(product.len(), 3);
    assert!(product.keys().all(|monomial| monomial[0] < 3 && monomial[1] >= 3));
}

/// They do not depend on the basis that a group is given by, however large its entries are and however many of them there are.
#[test]
fn of_any_basis_they_are_found() {
    let flat = |matrix: &Matrix| matrix.concat();
    let group_of = |basis: &[Matrix]| {
        let named: Vec<_> = basis.iter().enumerate().map(|(i, e)| (format!("e{i}"), flat(e))).collect();
        MatrixGroup::new("matrices", &Basis::new(basis[0].len(), &named).expect("a basis")).expect("a group")
    };
    let casimirs_of = |basis: &[Matrix]| {
        let algebra = Semidirect { group: group_of(basis), spaces: Vec::new() };
        casimirs_of(&algebra, std::slice::from_ref(&(0..basis.len()))).expect("exact constants")
    };
    // h² + 40000 e f
    let steep = [matrix(2, &[(0, 0, 100), (1, 1, -100)]), matrix(2, &[(0, 1, 1)]), matrix(2, &[(1, 0, 1)])];
    let expected = Polynomial::from([(vec![0, 0], 1), (vec![1, 2], 40_000)]);
    let Casimirs { found, missing } = casimirs_of(&steep);
    assert_eq!((found, missing), (vec![expected], 0));
    // sums of all with coefficients up to 2 or 1
    let mut random = Random(11);
    let galilei = [with_columns(3, 2), vec![matrix(5, &[(3, 4, 1)])]].concat();
    for (name, basis, largest, degrees) in
        [("so(4)", so(4), 2, [2, 2]), ("sl(3)", sl(3), 1, [2, 3]), ("sgal(3)", galilei, 1, [2, 4])]
    {
        let n = basis[0].len();
        let mut sum = |_| {
            let mut sum = matrix(n, &[]);
            for e in &basis {
                let factor = i64::try_from(random.below(2 * largest + 1)).expect("small");
                let factor = factor - i64::try_from(largest).expect("small");
                (0..n * n).for_each(|k| sum[k / n][k % n] += factor * e[k / n][k % n]);
            }
            sum
        };
        let dense: Vec<Matrix> = (0..basis.len()).map(&mut sum).collect();
        let Casimirs { found, missing } = casimirs_of(&dense);
        let degree = |casimir: &Polynomial| casimir.keys().next().map_or(0, Vec::len);
        assert_eq!(found.iter().map(degree).collect::<Vec<_>>(), degrees, "{name}");
        assert_eq!(missing, 0, "{name}");
    }
}

/// One of degree 4 is the shortest that is left when the square of one of degree 2 may be taken off it.
#[test]
fn those_of_degree_four_are_short() {
    let galilei = [with_columns(3, 2), vec![matrix(5, &[(3, 4, 1)])]].concat();
    for (name, basis, terms) in [("sp(4)", sp(2), 17), ("sgal(3)", galilei, 9)] {
        let quartic = found(&basis).found.pop().expect("two");
        assert_eq!(quartic.len(), terms, "{name}");
    }
}

/// Of vectors in the plane, `a·b` and `a × b` are both kept, but `(a·b)² + (a × b)² = |a|²|b|²`: as people list them, inner products.
#[test]
fn those_that_depend_on_others_are_left_out() {
    let circle = catalogue().iter().find(|group| group.name() == "SO2").expect("it is there");
    let algebra = Semidirect { group: *circle, spaces: vec![circle.representations()[0]; 3] };
    let structure = Structure::of(&algebra).expect("exact constants");
    let Casimirs { found, missing } = casimirs(&structure, &[0..1, 1..3, 3..5, 5..7]);
    let inner = |a: usize, b: usize| Polynomial::from([(vec![a, b], 1), (vec![a + 1, b + 1], 1)]);
    assert_eq!(found, [inner(1, 1), inner(3, 3), inner(5, 5), inner(1, 3), inner(1, 5)]);
    assert_eq!(missing, 0);
}

/// The point at which they are counted lies on no line, or `p₁ − 2 p₂ + p₃` would vanish at it: of `[x, y] = p₁ − 2 p₂ + p₃` three are kept.
#[test]
fn they_are_counted_at_a_point_like_any_other() {
    let sum =
        |sign: i64| [(2, 1), (3, -2), (4, 1)].map(|(k, c)| (k, Fraction::from_integer(sign * c))).to_vec();
    let structure = Structure::new(5, |i, j| match (i, j) {
        (0, 1) => sum(1),
        (1, 0) => sum(-1),
        _ => Vec::new(),
    });
    let Casimirs { found, missing } = casimirs(&structure, std::slice::from_ref(&(0..5)));
    let linear = |k: usize| Polynomial::from([(vec![k], 1)]);
    assert_eq!((found, missing), (vec![linear(4), linear(3), linear(2)], 0));
}

/// Some transcendental or rational ones are out of reach: of `[h, x] = x`, `[h, y] = α y` there is `y/x^α`.
#[test]
fn those_that_are_no_polynomials_are_missing() {
    let scaled = |alpha: i64| {
        Structure::new(3, move |i, j| {
            let rate = |k: usize| Fraction::from_integer(if k == 1 { 1 } else { alpha });
            match (i, j) {
                (0, k) if k > 0 => vec![(k, rate(k))],
                (k, 0) if k > 0 => vec![(k, -rate(k))],
                _ => Vec::new(),
            }
        })
    };
    let with = |alpha| casimirs(&scaled(alpha), std::slice::from_ref(&(0..3)));
    assert_eq!((with(2).found.len(), with(2).missing), (0, 1));
    // x y
    assert_eq!((with(-1).found.len(), with(-1).missing), (1, 0));
    // x⁴ y, of degree 5
    assert_eq!((with(-4).found.len(), with(-4).missing), (0, 1));
}

/// The constants of a group of the catalogue are antisymmetric and obey Jacobi's identity, with as many spaces as there are.
#[test]
fn structures_are_lie_algebras() {
    for group in catalogue() {
        let spaces = group.representations().to_vec();
        let structure = Structure::of(&Semidirect { group: *group, spaces }).expect("exact constants");
        let n = structure.dimension;
        let bracket = |x: &BTreeMap<usize, Fraction>, j: usize| {
            let mut image: BTreeMap<usize, Fraction> = BTreeMap::new();
            for (&i, &value) in x {
                structure.bracket(i, j).iter().for_each(|&(k, c)| *image.entry(k).or_default() += value * c);
            }
            image
        };
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    // [[i, j], k] + [[j, k], i] + [[k, i], j]
                    let mut sum: BTreeMap<usize, Fraction> = BTreeMap::new();
                    for (a, b, c) in [(i, j, k), (j, k, i), (k, i, j)] {
                        let unit = BTreeMap::from([(a, Fraction::from_integer(1))]);
                        bracket(&bracket(&unit, b), c)
                            .into_iter()
                            .for_each(|(l, x)| *sum.entry(l).or_default() += x);
                    }
                    assert!(sum.values().all(|x| *x.numer() == 0), "{}: {i}, {j}, {k}", group.name());
                }
                let unit = |i| BTreeMap::from([(i, Fraction::from_integer(1))]);
                let (forth, mut back) = (bracket(&unit(i), j), bracket(&unit(j), i));
                back.values_mut().for_each(|x| *x = -*x);
                assert_eq!(forth, back, "{}: {i}, {j}", group.name());
            }
        }
    }
}
