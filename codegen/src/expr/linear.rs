//! Small vectors and matrices of expressions, lowered to scalars as they are built.

use std::ops::Range;

use super::arena::Arena;
use super::entries::Entries;
use super::expression::Expr;
use super::node::Symbol;
use super::number::Number;

/// A column of expressions.
#[derive(Clone, PartialEq, Debug)]
pub struct Vector<'a>(pub Vec<Expr<'a>>);

/// A matrix of expressions.
pub type Matrix<'a> = Entries<Expr<'a>>;

impl<'a> Vector<'a> {
    /// The zero vector.
    pub fn zeros(arena: &'a Arena, dimension: usize) -> Self {
        Self(vec![arena.zero(); dimension])
    }

    /// The components of all vectors, one after the other.
    pub fn concat<'v>(vectors: impl IntoIterator<Item = &'v Self>) -> Self
    where
        'a: 'v,
    {
        Self(vectors.into_iter().flat_map(Self::iter).collect())
    }

    /// The number of components.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is no component.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The components.
    pub fn iter(&self) -> impl Iterator<Item = Expr<'a>> + '_ {
        self.0.iter().copied()
    }

    /// The image of each entry.
    pub fn map(&self, f: impl FnMut(Expr<'a>) -> Expr<'a>) -> Self {
        Self(self.iter().map(f).collect())
    }

    /// Those components.
    pub fn part(&self, range: Range<usize>) -> Self {
        Self(self.0[range].to_vec())
    }

    /// Combines components in the same places.
    pub fn zip(&self, other: &Self, f: impl Fn(Expr<'a>, Expr<'a>) -> Expr<'a>) -> Self {
        debug_assert_eq!(self.len(), other.len());
        Self(self.iter().zip(other.iter()).map(|(a, b)| f(a, b)).collect())
    }

    /// `factor · self`
    pub fn scale(&self, factor: Expr<'a>) -> Self {
        self.map(|x| factor * x)
    }

    /// Dot product, or the pairing of a vector with a covector.
    pub fn dot(&self, other: &Self) -> Expr<'a> {
        // of what is zero there is nothing to make
        let pairs = self.iter().zip(other.iter()).enumerate();
        let pairs = pairs.filter(|(i, (a, b))| *i == 0 || !a.is_zero() && !b.is_zero());
        let mut products = pairs.map(|(_, (a, b))| a * b);
        // no description can make an empty one: types, parts of vectors, `vector![]` and bases have one entry at least
        let first = products.next().expect("a vector has at least one component");
        products.fold(first, |sum, product| sum + product)
    }

    /// `Σ xᵢ²`; a number that all components are multiples by stands in front.
    pub fn squared_norm(&self) -> Expr<'a> {
        let split: Vec<_> = self.iter().map(Expr::split_number).collect();
        let factor = split.first().map_or(Number::ONE, |(number, _)| number.abs());
        if split.iter().any(|(number, _)| number.abs() != factor) {
            return self.dot(self);
        }
        let rest = Self(split.into_iter().map(|(_, x)| x).collect());
        let square = rest.dot(&rest);
        square * square.arena().number(factor * factor)
    }

    /// Cross product in R³.
    pub fn cross(&self, other: &Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        Self(vec![a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
    }

    /// Each component kept whole.
    pub fn hold(&self) -> Self {
        self.map(Expr::hold)
    }

    /// Each component named after the vector.
    pub fn named(&self, name: &str, suffixes: &[impl AsRef<str>]) -> Self {
        let named = |(component, suffix): (Expr<'a>, &_)| {
            component.named(format!("{name}_{}", AsRef::<str>::as_ref(suffix)))
        };
        Self(self.iter().zip(suffixes).map(named).collect())
    }

    /// The symbols the components are; the vector must have been made of symbols.
    pub fn symbols(&self) -> Vec<Symbol> {
        self.iter().filter_map(Expr::as_symbol).collect()
    }

    /// Whether any of the symbols occurs in any component.
    pub fn depends_on(&self, symbols: &[Symbol]) -> bool {
        let nodes = self.iter().map(|component| component.id);
        let first = self.0.first();
        first.is_some_and(|first| first.arena.any_symbol(nodes, |symbol| symbols.contains(&symbol)))
    }
}

impl<'a> std::ops::Add for &Vector<'a> {
    type Output = Vector<'a>;
    fn add(self, other: Self) -> Vector<'a> {
        self.zip(other, |a, b| a + b)
    }
}

impl<'a> std::ops::Sub for &Vector<'a> {
    type Output = Vector<'a>;
    fn sub(self, other: Self) -> Vector<'a> {
        self.zip(other, |a, b| a - b)
    }
}

impl<'a> std::ops::Neg for &Vector<'a> {
    type Output = Vector<'a>;
    fn neg(self) -> Vector<'a> {
        self.map(|x| -x)
    }
}

impl<'a> Matrix<'a> {
    /// A diagonal matrix.
    pub fn diagonal(entries: &Vector<'a>) -> Self {
        let entry = |i: usize, j: usize| if i == j { entries.0[i] } else { entries.0[i].arena.zero() };
        Self::from_fn(entries.len(), entries.len(), entry)
    }

    /// The identity of `n` rows.
    pub fn identity(arena: &'a Arena, n: usize) -> Self {
        Self::diagonal(&Vector(vec![arena.one(); n]))
    }

    /// A matrix of these columns, at least one, all of one length.
    pub fn from_columns(columns: &[Vector<'a>]) -> Self {
        Self::from_fn(columns.first().map_or(0, Vector::len), columns.len(), |i, j| columns[j].0[i])
    }

    /// `factor · self`
    pub fn scale(&self, factor: Expr<'a>) -> Self {
        self.map(|x| factor * x)
    }

    /// A row.
    pub fn row(&self, i: usize) -> Vector<'a> {
        Vector((0..self.columns).map(|j| self.at(i, j)).collect())
    }

    /// A column.
    pub fn column(&self, j: usize) -> Vector<'a> {
        Vector((0..self.rows).map(|i| self.at(i, j)).collect())
    }

    /// `self · vector`
    pub fn times(&self, vector: &Vector<'a>) -> Vector<'a> {
        Vector((0..self.rows).map(|i| self.row(i).dot(vector)).collect())
    }

    /// `self · other`
    pub fn times_matrix(&self, other: &Self) -> Self {
        Self::from_fn(self.rows, other.columns, |i, j| self.row(i).dot(&other.column(j)))
    }

    /// The solution of `self · x = right` for at most three unknowns, by the adjugate: no pivots, one division. None if
    /// the determinant is zero as an expression.
    fn solve_small(&self, right: &Vector<'a>) -> Option<Vector<'a>> {
        let m = |i: usize, j: usize| self.at(i % self.rows, j % self.columns);
        let adjugate: Vec<Expr<'a>> = match self.rows {
            1 => vec![right.0[0].arena.one()],
            2 => vec![m(1, 1), -m(0, 1), -m(1, 0), m(0, 0)],
            // cyclic cofactors: adj_ij = m_{j+1,i+1} m_{j+2,i+2} − m_{j+1,i+2} m_{j+2,i+1}
            _ => {
                let cofactor = |i: usize, j: usize| {
                    m(j + 1, i + 1) * m(j + 2, i + 2) - m(j + 1, i + 2) * m(j + 2, i + 1)
                };
                Self::from_fn(3, 3, cofactor).entries
            }
        };
        let adjugate = Self::new(self.rows, self.rows, adjugate);
        let determinant = self.row(0).dot(&adjugate.column(0));
        (!determinant.is_zero()).then(|| adjugate.times(right).scale(determinant.recip()))
    }

    /// The solution of `self · x = right` with few operations: each set of unknowns that no equation couples with
    /// others by itself, by the adjugate if there are at most three, by elimination if more. Neither looks for pivots:
    /// for matrices near a positive definite one, as a step's are.
    pub fn solve(&self, right: &Vector<'a>) -> Vector<'a> {
        self.try_solve(right).unwrap_or_else(|| right.map(|x| x / x.arena.zero()))
    }

    /// The same, or none if the matrix is singular whatever the values of its symbols are.
    pub fn try_solve(&self, right: &Vector<'a>) -> Option<Vector<'a>> {
        let mut x = right.clone();
        let coupled = |i: usize, j: usize| !self.at(i, j).is_zero() || !self.at(j, i).is_zero();
        for unknowns in uncoupled(self.rows, coupled) {
            let block = self.block(&unknowns);
            let part = Vector(unknowns.iter().map(|&i| right.0[i]).collect());
            let solution =
                if unknowns.len() <= 3 { block.solve_small(&part) } else { block.eliminate(&part) };
            for (&i, value) in unknowns.iter().zip(solution?.iter()) {
                x.0[i] = value;
            }
        }
        Some(x)
    }

    /// The same, where unknowns whose equations have no other one of them are found behind all others, without a division.
    pub fn solve_apart(&self, right: &Vector<'a>) -> Vector<'a> {
        let (mut last, mut first): (Vec<usize>, Vec<usize>) = Default::default();
        for k in (0..self.rows).rev() {
            let is_apart = last.iter().all(|&l| self.at(k, l).is_zero() && self.at(l, k).is_zero());
            let is_one = self.at(k, k).as_number().is_some_and(Number::is_one);
            if is_apart && is_one { last.push(k) } else { first.insert(0, k) }
        }
        if last.is_empty() || first.is_empty() {
            return self.solve(right);
        }
        let rest = |i: usize, start: Expr<'a>, of: &dyn Fn(usize) -> Expr<'a>| {
            last.iter().fold(start, |sum, &k| sum - self.at(i, k) * of(k)).hold()
        };
        let entry =
            |i: usize, j: usize| rest(first[i], self.at(first[i], first[j]), &|k| self.at(k, first[j]));
        let small = Self::from_fn(first.len(), first.len(), entry);
        let found =
            small.solve(&Vector(first.iter().map(|&i| rest(i, right.0[i], &|k| right.0[k])).collect()));
        let mut x = right.clone();
        first.iter().zip(found.hold().iter()).for_each(|(&i, value)| x.0[i] = value);
        for &k in &last {
            x.0[k] = first.iter().fold(right.0[k], |sum, &j| sum - self.at(k, j) * x.0[j]);
        }
        x
    }

    /// The matrix for these unknowns alone, where the right sides of the others' equations are zero.
    pub fn reduced_to(&self, kept: &[usize]) -> Self {
        let mut m = self.clone();
        let others: Vec<usize> = (0..self.rows).filter(|k| !kept.contains(k)).collect();
        for (done, &k) in others.iter().enumerate() {
            let open = |i: &usize| !others[..=done].contains(i);
            let pivot = m.at(k, k).recip();
            for i in (0..self.rows).filter(open) {
                let factor = (m.at(i, k) * pivot).hold();
                for j in (0..self.rows).filter(open) {
                    m.entries[i * self.columns + j] = m.at(i, j) - factor * m.at(k, j);
                }
            }
        }
        m.block(kept)
    }

    /// The inverse of a matrix that needs no pivots.
    pub fn inverse(&self) -> Self {
        let one = Self::identity(self.entries[0].arena, self.rows);
        Self::from_columns(&(0..self.rows).map(|j| self.solve(&one.column(j))).collect::<Vec<_>>())
    }

    /// The determinant, expanded along the first row, and so on.
    pub fn determinant(&self) -> Expr<'a> {
        let all: Vec<usize> = (0..self.rows).collect();
        self.minor(&all, &all)
    }

    /// The determinant of these rows and columns. Those that occur several times are one expression.
    pub fn minor(&self, rows: &[usize], columns: &[usize]) -> Expr<'a> {
        let arena = self.entries[0].arena;
        let Some((&row, others)) = rows.split_first() else { return arena.one() };
        let terms = columns.iter().enumerate().filter(|(_, column)| !self.at(row, **column).is_zero());
        terms.fold(arena.zero(), |sum, (k, &column)| {
            let rest: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
            let term = self.at(row, column) * self.minor(others, &rest);
            if k % 2 == 0 { sum + term } else { sum - term }
        })
    }

    /// Gaussian elimination without pivots. None where a pivot is zero as an expression.
    fn eliminate(&self, right: &Vector<'a>) -> Option<Vector<'a>> {
        let n = self.rows;
        let (mut m, mut x) = (self.entries.clone(), right.0.clone());
        for k in 0..n {
            if m[k * n + k].is_zero() {
                return None;
            }
            let pivot = m[k * n + k].recip().hold();
            for i in k + 1..n {
                let factor = (m[i * n + k] * pivot).hold();
                if factor.is_zero() {
                    continue;
                }
                for j in k + 1..n {
                    m[i * n + j] = (m[i * n + j] - factor * m[k * n + j]).hold();
                }
                x[i] = (x[i] - factor * x[k]).hold();
            }
            m[k * n + k] = pivot;
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                x[i] = x[i] - m[i * n + j] * x[j];
            }
            x[i] = (x[i] * m[i * n + i]).hold();
        }
        Some(Vector(x))
    }

    /// The solution of `self · x = right` for a symmetric positive definite matrix, by the factorization `L D Lᵀ`.
    pub fn solve_symmetric(&self, right: &Vector<'a>) -> Vector<'a> {
        let n = self.rows;
        let (l, d) = self.ldl();
        let mut x = l.substituted(right).0;
        for i in (0..n).rev() {
            x[i] = x[i] / d.0[i];
            for k in i + 1..n {
                x[i] = x[i] - l.at(k, i) * x[k];
            }
        }
        Vector(x)
    }

    /// The solution of `self · x = right` for a unit lower triangular matrix.
    pub fn substituted(&self, right: &Vector<'a>) -> Vector<'a> {
        let mut x = right.0.clone();
        for i in 0..x.len() {
            for k in 0..i {
                x[i] = x[i] - self.at(i, k) * x[k];
            }
        }
        Vector(x)
    }

    /// `L` (unit lower triangular) and the pivots `d` of `self = L diag(d) Lᵀ`, for a symmetric matrix, of which only
    /// the lower triangle is read. Stable without pivoting where all `d` are positive, and the test that they are.
    pub fn ldl(&self) -> (Self, Vector<'a>) {
        let n = self.rows;
        let arena = self.entries[0].arena;
        let mut l = Self::identity(arena, n);
        let mut d = Vec::with_capacity(n);
        for j in 0..n {
            let reduced = |l: &Self, d: &[Expr<'a>], i: usize| {
                (0..j).fold(self.at(i, j), |x, k| x - l.at(i, k) * l.at(j, k) * d[k])
            };
            let pivot = reduced(&l, &d, j);
            for i in j + 1..n {
                l.entries[i * n + j] = reduced(&l, &d, i) / pivot;
            }
            d.push(pivot);
        }
        (l, Vector(d))
    }
}

/// The numbers below a bound in sets that nothing couples: unknowns that share no equation, rows that no matrix mixes.
pub(crate) fn uncoupled(bound: usize, are_coupled: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for i in 0..bound {
        let (touched, mut apart): (Vec<_>, Vec<_>) =
            sets.into_iter().partition(|set: &Vec<usize>| set.iter().any(|&j| are_coupled(i, j)));
        let mut set: Vec<usize> = touched.concat();
        set.push(i);
        set.sort_unstable();
        apart.push(set);
        sets = apart;
    }
    sets.sort_unstable();
    sets
}
