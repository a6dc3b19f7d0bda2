//! Families of groups by name: `SO(4)`, `SL(2)`, `SE2(3)`, …, each from its basis.

use super::MatrixGroup;
use super::matrix::TERMS;

/// The largest matrices: beyond, code would take minutes to compile.
const LARGEST: usize = 6;

/// A matrix of a basis with the name of its coordinate.
type Named = (&'static str, Vec<i64>);

/// The group of a family, of this size; none if there is no such family, or none of this size.
///
/// `SO(n)` rotations, `SL(n)` matrices of determinant 1, `GL(n)` all that can be inverted, `SP(2n)` symplectic ones, `SU(n)` as real matrices of
/// `2n` rows, `SE(n)` rigid motions, `SE2(n)` a rotation with two vectors that it turns, `SGal(3)` Galilei's group, `SO21` Lorentz's group of the
/// plane, `Heisenberg` and `Aff(1)`.
pub fn family(name: &str) -> Option<&'static MatrixGroup> {
    family_with_terms(name, TERMS)
}

/// The same with so many terms of series that have no closed form.
pub fn family_with_terms(name: &str, terms: usize) -> Option<&'static MatrixGroup> {
    let two_vectors = name.strip_prefix("SE2").filter(|n| !n.is_empty());
    let digits = name.find(|letter: char| letter.is_ascii_digit());
    let (family, n) = match (two_vectors, digits) {
        (Some(n), _) => ("SE2", n.parse().ok()?),
        (None, Some(digits)) if name != "SO21" => (&name[..digits], name[digits..].parse().ok()?),
        _ => (name, 3),
    };
    let (size, basis) = match family {
        "SO" => (n, rotations(n, n)),
        "SE" => (n + 1, [rotations(n, n + 1), translations(n, &[n], n + 1)].concat()),
        "SE2" => (n + 2, [rotations(n, n + 2), translations(n, &[n, n + 1], n + 2)].concat()),
        "SGal" => {
            let size = n + 2;
            let boosts = [rotations(n, size), translations(n, &[n, n + 1], size)].concat();
            (size, [boosts, vec![("t", unit(size, &[(n, n + 1, 1)]))]].concat())
        }
        "GL" => (n, all(n)),
        "SL" => (n, traceless(n)),
        "SP" if n % 2 == 0 => (n, symplectic(n / 2)),
        "SU" => (2 * n, unitary(n)),
        "SO21" => (3, lorentz()),
        "Heisenberg" => (
            3,
            vec![("x", unit(3, &[(0, 1, 1)])), ("y", unit(3, &[(1, 2, 1)])), ("z", unit(3, &[(0, 2, 1)]))],
        ),
        "Aff" => (2, vec![("scale", unit(2, &[(0, 0, 1)])), ("shift", unit(2, &[(0, 1, 1)]))]),
        _ => return None,
    };
    let is_there = (1..=LARGEST).contains(&size) && n > 0;
    // the names live as long as the group, which is as long as the process
    let group =
        is_there.then(|| MatrixGroup::with_terms(name.to_owned().leak(), size, &basis, terms).ok()).flatten();
    group.map(MatrixGroup::leaked)
}

/// A matrix with these entries.
fn unit(size: usize, entries: &[(usize, usize, i64)]) -> Vec<i64> {
    let mut matrix = vec![0; size * size];
    for &(i, j, value) in entries {
        matrix[i * size + j] = value;
    }
    matrix
}

fn named(name: String, matrix: Vec<i64>) -> Named {
    (name.leak(), matrix)
}

/// In space `x`, `y`, `z` as `hat` has them; otherwise by the plane that turns.
fn rotations(n: usize, size: usize) -> Vec<Named> {
    if n == 3 {
        let planes = [("x", 2, 1), ("y", 0, 2), ("z", 1, 0)];
        return planes.map(|(name, i, j)| (name, unit(size, &[(i, j, 1), (j, i, -1)]))).to_vec();
    }
    let planes = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
    planes.map(|(i, j)| named(format!("r{}{}", i + 1, j + 1), unit(size, &[(j, i, 1), (i, j, -1)]))).collect()
}

/// A column for each vector.
fn translations(n: usize, columns: &[usize], size: usize) -> Vec<Named> {
    let places =
        columns.iter().zip(["v", "p"]).flat_map(|(&column, name)| (0..n).map(move |i| (i, column, name)));
    places.map(|(i, column, name)| named(format!("{name}{}", i + 1), unit(size, &[(i, column, 1)]))).collect()
}

fn all(n: usize) -> Vec<Named> {
    (0..n * n)
        .map(|k| (k / n, k % n))
        .map(|(i, j)| named(format!("e{}{}", i + 1, j + 1), unit(n, &[(i, j, 1)])))
        .collect()
}

fn traceless(n: usize) -> Vec<Named> {
    let mut basis: Vec<Named> =
        (0..n - 1).map(|i| named(format!("h{}", i + 1), unit(n, &[(i, i, 1), (i + 1, i + 1, -1)]))).collect();
    let off = (0..n * n).map(|k| (k / n, k % n)).filter(|(i, j)| i != j);
    basis.extend(off.map(|(i, j)| named(format!("e{}{}", i + 1, j + 1), unit(n, &[(i, j, 1)]))));
    basis
}

/// `[[A, B], [C, −Aᵀ]]` with symmetric `B` and `C`.
fn symplectic(n: usize) -> Vec<Named> {
    let size = 2 * n;
    let mut basis = Vec::new();
    for i in 0..n {
        for j in 0..n {
            basis.push(named(format!("a{}{}", i + 1, j + 1), unit(size, &[(i, j, 1), (n + j, n + i, -1)])));
        }
    }
    for (name, row, column) in [("b", 0, n), ("c", n, 0)] {
        for i in 0..n {
            for j in i..n {
                let entries = [(row + i, column + j, 1), (row + j, column + i, 1)];
                basis.push(named(format!("{name}{}{}", i + 1, j + 1), unit(size, &entries)));
            }
        }
    }
    basis
}

/// Antihermitean matrices without trace, a complex number `a + ib` as `[[a, −b], [b, a]]`: `s` symmetric imaginary, `a` antisymmetric real,
/// `d` diagonal.
fn unitary(n: usize) -> Vec<Named> {
    let size = 2 * n;
    let mut basis = Vec::new();
    let real = |i: usize, j: usize, value: i64| [(2 * i, 2 * j, value), (2 * i + 1, 2 * j + 1, value)];
    let imaginary = |i: usize, j: usize, value: i64| [(2 * i, 2 * j + 1, -value), (2 * i + 1, 2 * j, value)];
    for i in 0..n {
        for j in i + 1..n {
            let symmetric = [imaginary(i, j, 1), imaginary(j, i, 1)].concat();
            basis.push(named(format!("s{}{}", i + 1, j + 1), unit(size, &symmetric)));
            let antisymmetric = [real(i, j, 1), real(j, i, -1)].concat();
            basis.push(named(format!("a{}{}", i + 1, j + 1), unit(size, &antisymmetric)));
        }
    }
    for i in 0..n.saturating_sub(1) {
        let diagonal = [imaginary(i, i, 1), imaginary(i + 1, i + 1, -1)].concat();
        basis.push(named(format!("d{}", i + 1), unit(size, &diagonal)));
    }
    basis
}

/// A rotation of the plane and two boosts.
fn lorentz() -> Vec<Named> {
    vec![
        ("rotation", unit(3, &[(1, 0, 1), (0, 1, -1)])),
        ("boost_x", unit(3, &[(0, 2, 1), (2, 0, 1)])),
        ("boost_y", unit(3, &[(1, 2, 1), (2, 1, 1)])),
    ]
}
