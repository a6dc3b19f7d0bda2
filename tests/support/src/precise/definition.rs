//! What a group *is*: matrices. Everything here is a definition — commutators, power series, differences — and knows no closed form,
//! so that the generator's closed forms can be held against it.

use std::sync::OnceLock;

use coadjoint_codegen::group::Basis as LieBasis;
use coadjoint_codegen::group::{
    self, Dual, Group, MatrixGroup, Representation, Retraction, Semidirect, family,
};

use super::matrix::{Column, Matrix, jacobian};
use super::real::Real;

/// A group of the catalogue as matrices.
pub trait Realization: Sync {
    /// The matrix of an element of the algebra.
    fn hat(&self, x: &Column) -> Matrix;
    /// The coordinates of a matrix of the algebra.
    fn vee(&self, matrix: &Matrix) -> Column;
    /// The matrix of stored coordinates.
    fn matrix(&self, g: &Column) -> Matrix;
    /// What vanishes for stored coordinates that are on the group.
    fn defect(&self, g: &Column) -> Column;
    /// The action `ρ_x` on a space of that name.
    fn representation(&self, name: &str, x: &Column) -> Matrix;
    /// The action on a space of that name, or on the algebra, or on what is dual to one of them.
    fn action(&self, name: &str, x: &Column) -> Matrix {
        if name == "adjoint" {
            let hat = self.hat(x);
            let commutator = |y: &Column| &(&hat * &self.hat(y)) - &(&self.hat(y) * &hat);
            return Matrix::of_linear(x.len(), |y| self.vee(&commutator(y)));
        }
        let of = match name {
            "coadjoint" => Some("adjoint"),
            _ => name.strip_prefix("dual(").and_then(|name| name.strip_suffix(')')),
        };
        match of {
            Some(of) => self.action(of, x).transpose().scale(&Real::from(-1)),
            None => self.representation(name, x),
        }
    }
    /// What `f(x)` does to a space of that name: `f(ρ_x)`.
    fn transport(&self, retraction: Retraction, name: &str, x: &Column) -> Matrix {
        retract(retraction, x, |x| self.action(name, x))
    }
    /// `P(x)`: `φ₁(ρ_x)`, `(1 − ρ_x/2)⁻¹`, `τ(x)` or 1
    fn translation(&self, retraction: Retraction, name: &str, x: &Column) -> Matrix {
        let rho = self.action(name, x);
        let one = Matrix::identity(rho.rows());
        match retraction {
            Retraction::Exponential | Retraction::Coarse => rho.phi1(),
            Retraction::Cayley => (&one - &rho.scale(&Real::ratio(1, 2))).inverse(),
            Retraction::SecondKind => self.transport(retraction, name, x),
            Retraction::ReversedSecondKind => one,
        }
    }
}

/// The realization of a group of the catalogue. A group that comes to the catalogue comes here too.
pub fn realization(group: &dyn Group) -> &'static dyn Realization {
    match group.name() {
        "SO3" => &Rotations,
        "SO2" => &PlaneRotations,
        "SU2" => &Quaternions,
        "SE3" => &Motions { rotations: &Rotations, dimension: 3, angular: 3, stored: 4 },
        "SE2" => &Motions { rotations: &PlaneRotations, dimension: 2, angular: 1, stored: 2 },
        "R1" | "R2" | "R3" | "R4" | "R5" | "R6" => &Translations,
        other => {
            let composed = composed().iter().find(|(group, _)| group.name() == other);
            match composed
                .map(|(_, definition)| *definition)
                .or_else(|| Some(Box::leak(Box::new(Basis(family(other)?)))))
            {
                Some(definition) => definition,
                None => panic!("give {other} its definition by matrices"),
            }
        }
    }
}

/// Terms of series that have no closed form: enough for 71 digits.
pub const TERMS: usize = 140;

/// Groups made of others, each with its definition by theirs.
pub fn composed() -> &'static [(&'static MatrixGroup, &'static dyn Realization)] {
    static GROUPS: OnceLock<Vec<(&'static MatrixGroup, &'static dyn Realization)>> = OnceLock::new();
    GROUPS.get_or_init(|| {
        let group = |name: &str| family(name).expect("there is one");
        let basis = |name: &str| group(name).basis().expect("made of one");
        let new = |name: &str, basis: &LieBasis, definition: Box<dyn Realization>| {
            let group = MatrixGroup::with_terms(name, basis, TERMS).expect("a group");
            (group, &*Box::leak(definition) as &dyn Realization)
        };
        let product = |names: [&str; 2]| {
            let factors = names.map(|name| (name.to_lowercase(), basis(name)));
            let parts = names.map(|name| Basis(group(name)));
            new(
                &format!("{} x {}", names[0], names[1]),
                &LieBasis::product(&factors).expect("small enough"),
                Box::new(Product(parts)),
            )
        };
        let tangent = |name: &str| {
            let doubled = basis(name).tangent().expect("small enough");
            new(&format!("T {name}"), &doubled, Box::new(Tangent(Basis(group(name)))))
        };
        let plane = group("SL2").representations()[0];
        let spaces = [("v".to_owned(), plane), ("w".to_owned(), Dual::of(plane))];
        let planes = basis("SL2").semidirect("turn", &spaces).expect("exact");
        vec![
            product(["SO3", "SL2"]),
            product(["SO4", "Heisenberg"]),
            tangent("SO3"),
            tangent("SE2"),
            new("SL2 with planes", &planes, Box::new(Planes(Basis(group("SL2"))))),
        ]
    })
}

/// Of two groups, block by block.
struct Product([Basis; 2]);

impl Product {
    fn split(&self, x: &Column) -> [Column; 2] {
        let first = self.0[0].0.dimension();
        [x.part(0, first), x.part(first, x.len() - first)]
    }

    fn blocks(&self, whole: &Matrix) -> [Matrix; 2] {
        let n = self.0[0].0.size();
        let block =
            |from: usize, n: usize| Matrix::from_fn(n, n, |i, j| whole.at(from + i, from + j).clone());
        [block(0, n), block(n, whole.rows() - n)]
    }
}

impl Realization for Product {
    fn hat(&self, x: &Column) -> Matrix {
        let [x, y] = self.split(x);
        beside(&self.0[0].hat(&x), &self.0[1].hat(&y))
    }

    fn vee(&self, matrix: &Matrix) -> Column {
        let [x, y] = self.blocks(matrix);
        Column::stack([&self.0[0].vee(&x), &self.0[1].vee(&y)])
    }

    fn matrix(&self, g: &Column) -> Matrix {
        let n = g.len().isqrt();
        Matrix::from_fn(n, n, |i, j| g[i * n + j].clone())
    }

    fn defect(&self, g: &Column) -> Column {
        let whole = self.matrix(g);
        let [x, y] = self.blocks(&whole);
        let apart = &whole - &beside(&x, &y);
        let defects = [self.0[0].defect(&x.entries()), self.0[1].defect(&y.entries())];
        Column::stack([&apart.entries(), &defects[0], &defects[1]])
    }

    /// The standard one.
    fn representation(&self, _: &str, x: &Column) -> Matrix {
        self.hat(x)
    }
}

fn beside(first: &Matrix, second: &Matrix) -> Matrix {
    let (m, n) = (first.rows(), second.rows());
    Matrix::from_fn(m + n, m + n, |i, j| match (i < m, j < m) {
        (true, true) => first.at(i, j).clone(),
        (false, false) => second.at(i - m, j - m).clone(),
        _ => Real::from(0),
    })
}

/// `[[X, Y], [0, X]]`
struct Tangent(Basis);

impl Tangent {
    /// The block in this row and column.
    fn block(&self, whole: &Matrix, row: usize, column: usize) -> Matrix {
        let n = self.0.0.size();
        Matrix::from_fn(n, n, |i, j| whole.at(row * n + i, column * n + j).clone())
    }
}

impl Realization for Tangent {
    fn hat(&self, x: &Column) -> Matrix {
        let d = self.0.0.dimension();
        let (x, y) = (self.0.hat(&x.part(0, d)), self.0.hat(&x.part(d, d)));
        let n = x.rows();
        Matrix::from_fn(2 * n, 2 * n, |i, j| match (i / n, j / n) {
            (0, 1) => y.at(i, j - n).clone(),
            (1, 0) => Real::from(0),
            _ => x.at(i % n, j % n).clone(),
        })
    }

    fn vee(&self, matrix: &Matrix) -> Column {
        Column::stack([&self.0.vee(&self.block(matrix, 0, 0)), &self.0.vee(&self.block(matrix, 0, 1))])
    }

    fn matrix(&self, g: &Column) -> Matrix {
        let n = g.len().isqrt();
        Matrix::from_fn(n, n, |i, j| g[i * n + j].clone())
    }

    /// `[[g, g Y], [0, g]]` with a `Y` of the algebra.
    fn defect(&self, g: &Column) -> Column {
        let whole = self.matrix(g);
        let block = |row, column| self.block(&whole, row, column);
        let y = block(0, 0).solve_all(&block(0, 1));
        let outside = &y - &self.0.hat(&self.0.vee(&y));
        let same = &block(0, 0) - &block(1, 1);
        Column::stack([
            &self.0.defect(&block(0, 0).entries()),
            &same.entries(),
            &block(1, 0).entries(),
            &outside.entries(),
        ])
    }

    /// The standard one.
    fn representation(&self, _: &str, x: &Column) -> Matrix {
        self.hat(x)
    }
}

/// SL(2) with the plane and its dual: `diag([[X, v], [0, 0]], [[−Xᵀ, w], [0, 0]])`.
struct Planes(Basis);

impl Realization for Planes {
    fn hat(&self, x: &Column) -> Matrix {
        let turn = self.0.hat(&x.part(0, 3));
        Matrix::from_fn(6, 6, |i, j| match (i, j) {
            (0 | 1, 0 | 1) => turn.at(i, j).clone(),
            (0 | 1, 2) => x[3 + i].clone(),
            (3 | 4, 3 | 4) => -turn.at(j - 3, i - 3),
            (3 | 4, 5) => x[2 + i].clone(),
            _ => Real::from(0),
        })
    }

    fn vee(&self, m: &Matrix) -> Column {
        let turn = Matrix::from_fn(2, 2, |i, j| m.at(i, j).clone());
        let rest = [(0, 2), (1, 2), (3, 5), (4, 5)].map(|(i, j)| m.at(i, j).clone());
        Column::stack([&self.0.vee(&turn), &Column(rest.to_vec())])
    }

    fn matrix(&self, g: &Column) -> Matrix {
        Matrix::from_fn(6, 6, |i, j| g[i * 6 + j].clone())
    }

    fn defect(&self, g: &Column) -> Column {
        let whole = self.matrix(g);
        let turn = Matrix::from_fn(2, 2, |i, j| whole.at(i, j).clone());
        let dual = turn.inverse().transpose();
        let differences = (0..36).map(|k| (k / 6, k % 6)).map(|(i, j)| match (i, j) {
            (0 | 1, 0..=2) | (3 | 4, 5) => Real::from(0),
            (3 | 4, 3 | 4) => whole.at(i, j) - dual.at(i - 3, j - 3),
            _ => whole.at(i, j) - &Real::from(i64::from(i == j)),
        });
        Column::stack([&self.0.defect(&turn.entries()), &Column(differences.collect())])
    }

    /// The standard one.
    fn representation(&self, _: &str, x: &Column) -> Matrix {
        self.hat(x)
    }
}

/// A group of matrices, stored as what they are.
struct Basis(&'static MatrixGroup);

impl Basis {
    fn matrix_of(&self, axis: usize) -> Matrix {
        let n = self.0.size();
        let entry = |i: usize, j: usize| {
            let (numerator, denominator) = self.0.basis_entry(axis, i, j);
            let part = |part: i128| Real::from(i64::try_from(part).expect("small"));
            part(numerator) / part(denominator)
        };
        Matrix::from_fn(n, n, entry)
    }
}

impl Realization for Basis {
    fn hat(&self, x: &Column) -> Matrix {
        let n = self.0.size();
        let zero = Matrix::from_fn(n, n, |_, _| Real::from(0));
        (0..x.len()).fold(zero, |sum, axis| &sum + &self.matrix_of(axis).scale(&x[axis]))
    }

    /// By the method of least squares, which is exact for what is in the algebra.
    fn vee(&self, m: &Matrix) -> Column {
        let d = self.0.dimension();
        let basis: Vec<Column> = (0..d).map(|axis| self.matrix_of(axis).entries()).collect();
        let products = Matrix::from_fn(d, d, |i, j| basis[i].dot(&basis[j]));
        let right = Column(basis.iter().map(|e| e.dot(&m.entries())).collect());
        products.solve(&right)
    }

    fn matrix(&self, g: &Column) -> Matrix {
        let n = self.0.size();
        Matrix::from_fn(n, n, |i, j| g[i * n + j].clone())
    }

    fn defect(&self, g: &Column) -> Column {
        let (g, n) = (self.matrix(g), self.0.size());
        let zero = || Real::from(0);
        // what a form has on the diagonal of rotations and boosts, and beside it for symplectic matrices
        let kept = |form: &Matrix| (&(&(&g * form) * &g.transpose()) - form).entries();
        let first = |count: usize| Matrix::from_fn(n, n, |i, j| Real::from(i64::from(i == j && i < count)));
        let below = |from: usize| {
            let entries = (from..n).flat_map(|i| (0..n).map(move |j| (i, j)));
            Column(entries.map(|(i, j)| g.at(i, j) - &Real::from(i64::from(i == j))).collect())
        };
        let block = |count: usize| {
            let rotation = Matrix::from_fn(count, count, |i, j| g.at(i, j).clone());
            (&(&rotation * &rotation.transpose()) - &Matrix::identity(count)).entries()
        };
        match self.0.name() {
            "SL3" => {
                let m = |i: usize, j: usize| g.at(i % 3, j % 3);
                let cofactor = |j: usize| m(1, j + 1) * m(2, j + 2) - m(1, j + 2) * m(2, j + 1);
                let determinant = (0..3).fold(zero(), |sum, j| sum + m(0, j) * &cofactor(j));
                Column(vec![determinant - Real::from(1)])
            }
            "SU3" => {
                let blocks = (0..n * n).map(|k| (k / n, k % n)).filter(|(i, j)| i % 2 == 0 && j % 2 == 0);
                let complex = blocks
                    .flat_map(|(i, j)| [g.at(i, j) - g.at(i + 1, j + 1), g.at(i + 1, j) + g.at(i, j + 1)]);
                Column::stack([&kept(&first(n)), &Column(complex.collect())])
            }
            "SL2" | "SP4" => {
                let half = n / 2;
                kept(&Matrix::from_fn(n, n, |i, j| {
                    Real::from(i64::from(j == i + half) - i64::from(i == j + half))
                }))
            }
            "SO21" => kept(&Matrix::from_fn(3, 3, |i, j| {
                Real::from(i64::from(i == j) * (1 - 2 * i64::from(i == 2)))
            })),
            "SE2" => Column::stack([&block(2), &below(2)]),
            "SE23" => Column::stack([&block(3), &below(3)]),
            "SGal3" => Column::stack([
                &block(3),
                &below(4),
                &Column((0..3).map(|j| g.at(3, j).clone()).chain([g.at(3, 3) - &Real::from(1)]).collect()),
            ]),
            "Heisenberg" => Column(vec![
                g.at(1, 0).clone(),
                g.at(2, 0).clone(),
                g.at(2, 1).clone(),
                g.at(0, 0) - &Real::from(1),
                g.at(1, 1) - &Real::from(1),
                g.at(2, 2) - &Real::from(1),
            ]),
            "Aff1" => below(1),
            name if name.starts_with("SO") => kept(&first(n)),
            name if name.starts_with("GL") => Column(vec![zero()]),
            other => panic!("say what vanishes on {other}"),
        }
    }

    /// The standard one.
    fn representation(&self, _: &str, x: &Column) -> Matrix {
        self.hat(x)
    }
}

/// `τ(x)` in a representation `hat` of the algebra: the series of the exponential, the quotient of Cayley, or the product of the series
/// along the axes, one after the other.
pub fn retract(retraction: Retraction, x: &Column, hat: impl Fn(&Column) -> Matrix) -> Matrix {
    let one = Matrix::identity(hat(x).rows());
    let along = |axis: usize| hat(&Column::unit(x.len(), axis).scale(&x[axis])).exp();
    let axes = 0..x.len();
    match retraction {
        Retraction::Exponential | Retraction::Coarse => hat(x).exp(),
        Retraction::Cayley => hat(x).cayley(),
        Retraction::SecondKind => axes.fold(one, |product, axis| &product * &along(axis)),
        Retraction::ReversedSecondKind => axes.fold(one, |product, axis| &along(axis) * &product),
    }
}

/// SO(3): rotation matrices, stored as unit quaternions.
struct Rotations;

impl Realization for Rotations {
    fn hat(&self, x: &Column) -> Matrix {
        let zero = || Real::from(0);
        Matrix::from_rows([
            [zero(), -&x[2], x[1].clone()],
            [x[2].clone(), zero(), -&x[0]],
            [-&x[1], x[0].clone(), zero()],
        ])
    }

    fn vee(&self, m: &Matrix) -> Column {
        Column([(2, 1), (0, 2), (1, 0)].map(|(i, j)| m.at(i, j).clone()).to_vec())
    }

    /// `v ↦ q v q̄` for unit quaternions: `(w² − |u|²) + 2 u uᵀ + 2 w û`.
    fn matrix(&self, q: &Column) -> Matrix {
        let (w, u) = (&q[0], q.part(1, 3));
        let two = Real::from(2);
        let outer = Matrix::from_fn(3, 3, |i, j| &two * &u[i] * &u[j]);
        let turn = self.hat(&u).scale(&(&two * w));
        &(&Matrix::identity(3).scale(&(w * w - u.dot(&u))) + &outer) + &turn
    }

    fn defect(&self, q: &Column) -> Column {
        Column(vec![q.dot(q) - Real::from(1)])
    }

    fn representation(&self, name: &str, x: &Column) -> Matrix {
        match name {
            "R3" => self.hat(x),
            other => panic!("give {other} its definition by matrices"),
        }
    }
}

/// SO(2): rotation matrices of the plane, stored as unit complex numbers.
struct PlaneRotations;

impl Realization for PlaneRotations {
    fn hat(&self, x: &Column) -> Matrix {
        let zero = || Real::from(0);
        Matrix::from_rows([[zero(), -&x[0]], [x[0].clone(), zero()]])
    }

    fn vee(&self, m: &Matrix) -> Column {
        Column(vec![m.at(1, 0).clone()])
    }

    fn matrix(&self, g: &Column) -> Matrix {
        Matrix::from_rows([[g[0].clone(), -&g[1]], [g[1].clone(), g[0].clone()]])
    }

    fn defect(&self, g: &Column) -> Column {
        Column(vec![g.dot(g) - Real::from(1)])
    }

    fn representation(&self, name: &str, x: &Column) -> Matrix {
        match name {
            "R2" => self.hat(x),
            other => panic!("give {other} its definition by matrices"),
        }
    }
}

/// SU(2): quaternions as the matrices of their multiplication from the left.
struct Quaternions;

impl Realization for Quaternions {
    fn hat(&self, x: &Column) -> Matrix {
        let half = |i: usize| &x[i] / Real::from(2);
        self.matrix(&Column(vec![Real::from(0), half(0), half(1), half(2)]))
    }

    fn vee(&self, m: &Matrix) -> Column {
        Column((1..4).map(|i| m.at(i, 0) * Real::from(2)).collect())
    }

    fn matrix(&self, q: &Column) -> Matrix {
        let [w, x, y, z] = std::array::from_fn(|i| q[i].clone());
        Matrix::from_rows([
            [w.clone(), -&x, -&y, -&z],
            [x.clone(), w.clone(), -&z, y.clone()],
            [y.clone(), z.clone(), w.clone(), -&x],
            [z, -&y, x, w],
        ])
    }

    fn defect(&self, q: &Column) -> Column {
        Column(vec![q.dot(q) - Real::from(1)])
    }

    fn representation(&self, name: &str, _: &Column) -> Matrix {
        panic!("give {name} its definition by matrices")
    }
}

/// R(n): `[[1, p], [0, 1]]`.
struct Translations;

/// `[[block, column], [0, corner]]`
fn bordered(block: &Matrix, column: &Column, corner: i64) -> Matrix {
    let n = column.len();
    Matrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
        (true, true) => block.at(i, j).clone(),
        (true, false) => column[i].clone(),
        (false, true) => Real::from(0),
        (false, false) => Real::from(corner),
    })
}

impl Realization for Translations {
    fn hat(&self, x: &Column) -> Matrix {
        let zero = Matrix::from_fn(x.len(), x.len(), |_, _| Real::from(0));
        bordered(&zero, x, 0)
    }

    fn vee(&self, m: &Matrix) -> Column {
        let n = m.rows() - 1;
        Column((0..n).map(|i| m.at(i, n).clone()).collect())
    }

    fn matrix(&self, g: &Column) -> Matrix {
        bordered(&Matrix::identity(g.len()), g, 1)
    }

    fn defect(&self, _: &Column) -> Column {
        Column(vec![Real::from(0)])
    }

    fn representation(&self, name: &str, _: &Column) -> Matrix {
        panic!("give {name} its definition by matrices")
    }
}

/// SE(n): `[[R, p], [0, 1]]`.
struct Motions {
    rotations: &'static dyn Realization,
    dimension: usize,
    /// Coordinates of the rotations' algebra.
    angular: usize,
    /// Stored coordinates of a rotation.
    stored: usize,
}

impl Realization for Motions {
    fn hat(&self, x: &Column) -> Matrix {
        let angular = self.rotations.hat(&x.part(0, self.angular));
        bordered(&angular, &x.part(self.angular, self.dimension), 0)
    }

    fn vee(&self, m: &Matrix) -> Column {
        let n = self.dimension;
        let block = Matrix::from_fn(n, n, |i, j| m.at(i, j).clone());
        let linear = Column((0..n).map(|i| m.at(i, n).clone()).collect());
        Column::stack([&self.rotations.vee(&block), &linear])
    }

    fn matrix(&self, g: &Column) -> Matrix {
        let rotation = self.rotations.matrix(&g.part(0, self.stored));
        bordered(&rotation, &g.part(self.stored, self.dimension), 1)
    }

    fn defect(&self, g: &Column) -> Column {
        self.rotations.defect(&g.part(0, self.stored))
    }

    /// Directions: translations leave them alone.
    fn representation(&self, name: &str, x: &Column) -> Matrix {
        self.rotations.representation(name, &x.part(0, self.angular))
    }
}

/// `G ⋉ (V₁ ⊕ …)` as block matrices: for each space `[[ρ_x, w], [0, 0]]` in the algebra, beside the group's own block.
///
/// Elements of the algebra and its dual are columns `(x, w₁, …)`.
pub struct SemidirectMatrices<'s> {
    algebra: &'s Semidirect,
    realization: &'static dyn Realization,
}

/// Block diagonal: the group's own matrix and one for each space.
#[derive(Clone)]
pub struct BlockDiagonal(Vec<Matrix>);

impl BlockDiagonal {
    fn map(&self, f: impl Fn(&Matrix) -> Matrix) -> Self {
        Self(self.0.iter().map(f).collect())
    }

    fn zip(&self, other: &Self, f: impl Fn(&Matrix, &Matrix) -> Matrix) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(a, b)| f(a, b)).collect())
    }

    /// `self · other`
    pub fn times(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    /// All entries, block by block.
    pub fn entries(&self) -> Column {
        Column::stack(self.0.iter().map(Matrix::entries).collect::<Vec<_>>().iter())
    }

    /// `self⁻¹`
    pub fn inverse(&self) -> Self {
        self.map(Matrix::inverse)
    }
}

impl<'s> SemidirectMatrices<'s> {
    /// The definition of a semidirect product.
    pub fn new(algebra: &'s Semidirect) -> Self {
        Self { algebra, realization: realization(algebra.group) }
    }

    /// The element of the group with these stored coordinates; for the group without spaces.
    pub fn group_element(&self, g: &Column) -> BlockDiagonal {
        assert!(self.algebra.spaces.is_empty());
        BlockDiagonal(vec![self.realization.matrix(g)])
    }

    /// The dimension of the algebra.
    pub fn dimension(&self) -> usize {
        let spaces = self.algebra.spaces.iter().map(|space| space.coordinates().len());
        self.algebra.group.dimension() + spaces.sum::<usize>()
    }

    /// The parts of a column: of the group's algebra, then of each space.
    pub fn split(&self, xi: &Column) -> Vec<Column> {
        let dimensions = std::iter::once(self.algebra.group.dimension())
            .chain(self.algebra.spaces.iter().map(|space| space.coordinates().len()));
        let mut start = 0;
        dimensions
            .map(|dimension| {
                start += dimension;
                xi.part(start - dimension, dimension)
            })
            .collect()
    }

    /// The matrices of an element of the algebra.
    pub fn hat(&self, xi: &Column) -> BlockDiagonal {
        let parts = self.split(xi);
        let space = |(space, w): (&&'static dyn Representation, &Column)| {
            let rho = self.realization.action(space.name(), &parts[0]);
            let n = w.len();
            Matrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
                (true, true) => rho.at(i, j).clone(),
                (true, false) => w[i].clone(),
                _ => Real::from(0),
            })
        };
        let spaces = self.algebra.spaces.iter().zip(&parts[1..]).map(space);
        BlockDiagonal(std::iter::once(self.realization.hat(&parts[0])).chain(spaces).collect())
    }

    /// The element of the algebra that matrices belong to.
    pub fn vee(&self, blocks: &BlockDiagonal) -> Column {
        let base = self.realization.vee(&blocks.0[0]);
        let spaces = blocks.0[1..].iter().map(|block| {
            let n = block.rows() - 1;
            block.column(n).part(0, n)
        });
        Column::stack(std::iter::once(base).chain(spaces).collect::<Vec<_>>().iter())
    }

    /// `[x, y]`
    pub fn bracket(&self, x: &Column, y: &Column) -> Column {
        let (x, y) = (self.hat(x), self.hat(y));
        self.vee(&x.times(&y).zip(&y.times(&x), |xy, yx| xy - yx))
    }

    /// `τ(x)`
    pub fn retract(&self, retraction: Retraction, x: &Column) -> BlockDiagonal {
        let blocks = 0..=self.algebra.spaces.len();
        BlockDiagonal(
            blocks.map(|block| retract(retraction, x, |x| self.hat(x).0.swap_remove(block))).collect(),
        )
    }

    /// The matrix of `dR τ_x`, `dR τ_x y = Dτ(x)y τ(x)⁻¹`, by central differences.
    pub fn d_right(&self, retraction: Retraction, x: &Column) -> Matrix {
        let inverse = self.retract(retraction, x).inverse();
        jacobian(x, |x| self.vee(&self.retract(retraction, x).times(&inverse)))
    }

    /// The matrix of `dL τ_x`, `dL τ_x y = τ(x)⁻¹ Dτ(x)y`, by central differences.
    pub fn d_left(&self, retraction: Retraction, x: &Column) -> Matrix {
        let inverse = self.retract(retraction, x).inverse();
        jacobian(x, |x| self.vee(&inverse.times(&self.retract(retraction, x))))
    }

    /// The matrix of `Ad_g`, `Ad_g y = g y g⁻¹`.
    pub fn adjoint(&self, g: &BlockDiagonal) -> Matrix {
        let inverse = g.inverse();
        Matrix::of_linear(self.dimension(), |y| self.vee(&g.times(&self.hat(y)).times(&inverse)))
    }

    /// `Ad*_g m`, the transpose of `Ad_g`.
    pub fn coadjoint(&self, g: &BlockDiagonal, m: &Column) -> Column {
        &self.adjoint(g).transpose() * m
    }

    /// `(dR τ_x)* m`
    pub fn d_right_dual(&self, retraction: Retraction, x: &Column, m: &Column) -> Column {
        &self.d_right(retraction, x).transpose() * m
    }

    /// `ad*_x m`, the transpose of the bracket with `x`.
    pub fn infinitesimal_coadjoint(&self, x: &Column, m: &Column) -> Column {
        &Matrix::of_linear(m.len(), |y| self.bracket(x, y)).transpose() * m
    }

    /// The Poisson tensor `P(m)` of `m' = ad*_{dh} m = P(m) dh`.
    pub fn poisson_tensor(&self, m: &Column) -> Matrix {
        Matrix::of_linear(m.len(), |x| self.infinitesimal_coadjoint(x, m))
    }
}

/// A direct product of semidirect products, one for each factor of a system: columns are those of the factors, one below the other.
pub struct ProductMatrices<'s>(Vec<SemidirectMatrices<'s>>);

impl<'s> ProductMatrices<'s> {
    /// Of this product.
    pub fn new(group: &'s group::Product) -> Self {
        Self(group.factors.iter().map(SemidirectMatrices::new).collect())
    }

    /// What a column has for each factor.
    pub fn split(&self, column: &Column) -> Vec<Column> {
        let mut start = 0;
        let part = |matrices: &SemidirectMatrices<'_>| {
            start += matrices.dimension();
            column.part(start - matrices.dimension(), matrices.dimension())
        };
        self.0.iter().map(part).collect()
    }

    /// What a column has for each factor: of the group's algebra, then of each space.
    pub fn split_all(&self, column: &Column) -> Vec<Vec<Column>> {
        let parts = self.split(column);
        self.0.iter().zip(&parts).map(|(matrices, part)| matrices.split(part)).collect()
    }

    /// A function of two columns, factor by factor.
    fn each(
        &self,
        x: &Column,
        m: &Column,
        f: impl Fn(&SemidirectMatrices<'s>, &Column, &Column) -> Column,
    ) -> Column {
        let (xs, ms) = (self.split(x), self.split(m));
        let parts = self.0.iter().zip(xs.iter().zip(&ms)).map(|(matrices, (x, m))| f(matrices, x, m));
        Column::stack(parts.collect::<Vec<_>>().iter())
    }

    /// `Ad*_{τ(x)} m`
    pub fn coadjoint(&self, retraction: Retraction, x: &Column, m: &Column) -> Column {
        self.each(x, m, |matrices, x, m| matrices.coadjoint(&matrices.retract(retraction, x), m))
    }

    /// `Ad*_{τ(x)⁻¹} m`
    pub fn coadjoint_back(&self, retraction: Retraction, x: &Column, m: &Column) -> Column {
        self.each(x, m, |matrices, x, m| matrices.coadjoint(&matrices.retract(retraction, x).inverse(), m))
    }

    /// `(dR τ_x)* m`
    pub fn d_right_dual(&self, retraction: Retraction, x: &Column, m: &Column) -> Column {
        self.each(x, m, |matrices, x, m| matrices.d_right_dual(retraction, x, m))
    }

    /// `ad*_x m`
    pub fn infinitesimal_coadjoint(&self, x: &Column, m: &Column) -> Column {
        self.each(x, m, SemidirectMatrices::infinitesimal_coadjoint)
    }

    /// The Poisson tensor `P(m)` of `m' = ad*_{dh} m = P(m) dh`.
    pub fn poisson_tensor(&self, m: &Column) -> Matrix {
        Matrix::of_linear(m.len(), |x| self.infinitesimal_coadjoint(x, m))
    }
}
