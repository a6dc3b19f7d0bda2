//! Families of groups by name: `SO(4)`, `SL(2)`, `SE2(3)`, …, each from its basis.

use super::matrix::TERMS;
use super::{Basis, LARGEST_BASIS, MatrixGroup, NamedMatrix};

/// The largest matrices: beyond, code would take minutes to compile.
pub const LARGEST: usize = 7;

/// The families as people write them.
pub const FAMILIES: [&str; 11] = [
    "SO(n)",
    "SL(n)",
    "GL(n)",
    "SP(2n)",
    "SU(n)",
    "SE2(n)",
    "SE(n)",
    "SGal(n)",
    "Aff(1)",
    "SO(2, 1)",
    "Heisenberg",
];

/// A group's name in one word: `SO21` of `SO(2, 1)`.
pub fn one_word(name: &str) -> String {
    name.replace(['(', ',', ' ', ')'], "")
}

/// The family of many sizes that a name with a size means, whether or not there is a group of this size.
pub fn family_meant(name: &str) -> Option<&'static str> {
    FAMILIES.into_iter().filter(|family| family.ends_with("n)")).find(|family| {
        let size = family.split_once('(').and_then(|(stem, _)| name.strip_prefix(stem));
        size.is_some_and(|size| !size.is_empty() && size.bytes().all(|byte| byte.is_ascii_digit()))
    })
}

/// The groups of a family of many sizes, as people write them.
pub fn sizes(family: &str) -> Vec<String> {
    let stem = family.split_once('(').map_or(family, |(stem, _)| stem);
    let is_small = |basis: Basis| basis.dimension() <= LARGEST_BASIS;
    let known = (1..=LARGEST).filter(|n| basis(&format!("{stem}{n}")).is_some_and(is_small));
    known.map(|n| format!("{stem}({n})")).collect()
}

/// The group of a family, of this size; none if there is no such family, or none of this size.
///
/// `SO(n)` rotations, `SL(n)` matrices of determinant 1, `GL(n)` all that can be inverted, `SP(2n)` symplectic ones,
/// `SU(n)` as real matrices of `2n` rows, `SE(n)` rigid motions, `SE2(n)` a rotation with two vectors that it turns,
/// `SGal(3)` Galilei's group, `SO21` or `SO(2, 1)` Lorentz's group of the plane, `Heisenberg` and `Aff(1)`.
pub fn family(name: &str) -> Option<&'static MatrixGroup> {
    family_with_terms(name, TERMS)
}

/// The same with so many terms of series that have no closed form.
pub fn family_with_terms(name: &str, terms: usize) -> Option<&'static MatrixGroup> {
    MatrixGroup::with_terms(name, &basis(name)?, terms).ok()
}

/// The basis of a family, of this size.
pub(super) fn basis(name: &str) -> Option<Basis> {
    let two_vectors = name.strip_prefix("SE2").filter(|n| !n.is_empty());
    let digits = name.find(|letter: char| letter.is_ascii_digit());
    let (family, size) = match (two_vectors, digits) {
        (Some(n), _) => ("SE2", Some(n)),
        (None, Some(digits)) if name != "SO21" => (&name[..digits], Some(&name[digits..])),
        _ => (name, None),
    };
    let Some(size) = size else {
        return match family {
            "SO21" => Basis::new(3, &lorentz()).ok(),
            "Heisenberg" => Basis::new(3, &heisenberg()).ok().map(|basis| basis.with_blocks(vec![2, 1])),
            _ => None,
        };
    };
    // no matrices are smaller than the number in the name: what is too large is never made
    let n = size.parse().ok().filter(|n| (1..=LARGEST).contains(n))?;
    let turns = n * (n - 1) / 2;
    let (size, basis, blocks) = match family {
        "SO" => (n, rotations(n, n), vec![turns]),
        "R" => (n + 1, translations(n, &[n], n + 1), vec![n]),
        "SE" => (n + 1, [rotations(n, n + 1), translations(n, &[n], n + 1)].concat(), vec![turns, n]),
        "SE2" => {
            let size = n + 2;
            let vectors = translations(n, &[n, n + 1], size);
            (size, [rotations(n, size), vectors].concat(), vec![turns, n, n])
        }
        "SGal" => {
            let size = n + 2;
            let vectors = translations(n, &[n, n + 1], size);
            let time = vec![named("t", size, &[(n, n + 1, 1)])];
            (size, [rotations(n, size), vectors, time].concat(), vec![turns, n, n, 1])
        }
        "GL" => (n, units(n, |_| true), vec![n * n]),
        "SL" => (n, traceless(n), vec![n * n - 1]),
        "SP" if n % 2 == 0 => (n, symplectic(n / 2), vec![n * (n + 1) / 2]),
        "SU" => (2 * n, unitary(n), vec![n * n - 1]),
        "Aff" if n == 1 => (2, affine(), vec![1, 1]),
        _ => return None,
    };
    let is_there = size <= LARGEST && blocks.iter().all(|&length| length > 0);
    is_there.then(|| Basis::new(size, &basis).ok()).flatten().map(|basis| basis.with_blocks(blocks))
}

/// A matrix of this name with these entries.
fn named(name: impl Into<String>, size: usize, entries: &[(usize, usize, i64)]) -> NamedMatrix {
    let mut matrix = vec![0; size * size];
    for &(i, j, value) in entries {
        matrix[i * size + j] = value;
    }
    (name.into(), matrix)
}

/// In space `x`, `y`, `z` as `hat` has them; otherwise by the plane that turns.
fn rotations(n: usize, size: usize) -> Vec<NamedMatrix> {
    if n == 3 {
        let planes = [("x", 2, 1), ("y", 0, 2), ("z", 1, 0)];
        return planes.map(|(name, i, j)| named(name, size, &[(i, j, 1), (j, i, -1)])).to_vec();
    }
    let planes = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    planes.map(|(i, j)| named(format!("r{}{}", i + 1, j + 1), size, &[(j, i, 1), (i, j, -1)])).collect()
}

/// A column for each vector.
fn translations(n: usize, columns: &[usize], size: usize) -> Vec<NamedMatrix> {
    let places =
        columns.iter().zip(["v", "p"]).flat_map(|(&column, name)| (0..n).map(move |i| (i, column, name)));
    places.map(|(i, column, name)| named(format!("{name}{}", i + 1), size, &[(i, column, 1)])).collect()
}

/// Matrices of one entry each, of those places that are wanted.
fn units(n: usize, is_wanted: impl Fn(&(usize, usize)) -> bool) -> Vec<NamedMatrix> {
    let places = (0..n * n).map(|k| (k / n, k % n)).filter(is_wanted);
    places.map(|(i, j)| named(format!("e{}{}", i + 1, j + 1), n, &[(i, j, 1)])).collect()
}

fn traceless(n: usize) -> Vec<NamedMatrix> {
    let diagonal = |i: usize| named(format!("h{}", i + 1), n, &[(i, i, 1), (i + 1, i + 1, -1)]);
    (0..n - 1).map(diagonal).chain(units(n, |(i, j)| i != j)).collect()
}

/// `[[A, B], [C, −Aᵀ]]` with symmetric `B` and `C`.
fn symplectic(n: usize) -> Vec<NamedMatrix> {
    let size = 2 * n;
    let mut basis = Vec::new();
    for i in 0..n {
        for j in 0..n {
            basis.push(named(format!("a{}{}", i + 1, j + 1), size, &[(i, j, 1), (n + j, n + i, -1)]));
        }
    }
    for (name, row, column) in [("b", 0, n), ("c", n, 0)] {
        for i in 0..n {
            for j in i..n {
                let entries = [(row + i, column + j, 1), (row + j, column + i, 1)];
                basis.push(named(format!("{name}{}{}", i + 1, j + 1), size, &entries));
            }
        }
    }
    basis
}

/// Antihermitean matrices without trace, a complex number `a + ib` as `[[a, −b], [b, a]]`: `s` symmetric imaginary, `a`
/// antisymmetric real, `d` diagonal.
fn unitary(n: usize) -> Vec<NamedMatrix> {
    let size = 2 * n;
    let mut basis = Vec::new();
    let real = |i: usize, j: usize, value: i64| [(2 * i, 2 * j, value), (2 * i + 1, 2 * j + 1, value)];
    let imaginary = |i: usize, j: usize, value: i64| [(2 * i, 2 * j + 1, -value), (2 * i + 1, 2 * j, value)];
    for i in 0..n {
        for j in i + 1..n {
            let symmetric = [imaginary(i, j, 1), imaginary(j, i, 1)].concat();
            basis.push(named(format!("s{}{}", i + 1, j + 1), size, &symmetric));
            let antisymmetric = [real(i, j, 1), real(j, i, -1)].concat();
            basis.push(named(format!("a{}{}", i + 1, j + 1), size, &antisymmetric));
        }
    }
    for i in 0..n.saturating_sub(1) {
        let diagonal = [imaginary(i, i, 1), imaginary(i + 1, i + 1, -1)].concat();
        basis.push(named(format!("d{}", i + 1), size, &diagonal));
    }
    basis
}

/// A rotation of the plane and two boosts.
fn lorentz() -> Vec<NamedMatrix> {
    let boost = |name: &str, i: usize| named(name, 3, &[(i, 2, 1), (2, i, 1)]);
    let rotation = named("rotation", 3, &[(1, 0, 1), (0, 1, -1)]);
    vec![rotation, boost("boost_x", 0), boost("boost_y", 1)]
}

fn heisenberg() -> Vec<NamedMatrix> {
    let entry = |name: &str, i: usize, j: usize| named(name, 3, &[(i, j, 1)]);
    vec![entry("x", 0, 1), entry("y", 1, 2), entry("z", 0, 2)]
}

fn affine() -> Vec<NamedMatrix> {
    let entry = |name: &str, j: usize| named(name, 2, &[(0, j, 1)]);
    vec![entry("scale", 0), entry("shift", 1)]
}
