//! Tableaux of Runge–Kutta methods, and what follows from them exactly: order, symplecticity, symmetry.

use std::collections::BTreeSet;

use super::exact::{Exact, Rational};

/// The coefficients `a_ij` and `b_i` of a Runge–Kutta method, 1.2.2 of the paper, as exact numbers `r + s √D`:
///
/// ```text
/// x_{k+1} = x_k + h Σ b_i k_i,   k_i = f(t_k + c_i h, x_k + h Σ a_ij k_j),   c_i = Σ a_ij
/// ```
///
/// What it says of the method, it finds by exact arithmetic.
///
/// ```
/// use coadjoint_classical::Tableau;
///
/// let (rk4, gauss) = (Tableau::rk4(), Tableau::gauss2());
/// assert!(rk4.order() == 4 && rk4.is_explicit() && !rk4.is_symplectic());
/// assert!(gauss.order() == 4 && gauss.is_symplectic() && gauss.is_symmetric());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tableau<const D: u32 = 1> {
    name: &'static str,
    a: Vec<Vec<Exact<D>>>,
    b: Vec<Exact<D>>,
}

/// A pair of tableaux with as many stages: the first for positions `q`, the second, in capitals, for momenta `p`. 1.2.2 of the paper:
///
/// ```text
/// q_{k+1} = q_k + h Σ b_i k_i,   k_i = f₁(Q_i, P_i),   Q_i = q_k + h Σ a_ij k_j
/// p_{k+1} = p_k + h Σ B_i l_i,   l_i = f₂(Q_i, P_i),   P_i = p_k + h Σ A_ij l_j
/// ```
///
/// Time goes with the positions: both are asked at `t_k + c_i h`, `c_i = Σ a_ij`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartitionedTableau<const D: u32 = 1> {
    name: &'static str,
    positions: Tableau<D>,
    momenta: Tableau<D>,
}

/// The highest order whose conditions are looked at tree by tree.
const TREES: u32 = 4;

impl<const D: u32> Tableau<D> {
    /// With these coefficients, row by row.
    pub fn new<const S: usize>(name: &'static str, a: [[Exact<D>; S]; S], b: [Exact<D>; S]) -> Self {
        Self { name, a: a.iter().map(|row| row.to_vec()).collect(), b: b.to_vec() }
    }

    /// The method's usual name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// `a`, row by row.
    pub fn a(&self) -> &[Vec<Exact<D>>] {
        &self.a
    }

    /// `b`.
    pub fn b(&self) -> &[Exact<D>] {
        &self.b
    }

    /// `c_i = Σ a_ij`: when the stages are.
    pub fn c(&self) -> Vec<Exact<D>> {
        self.a.iter().map(|row| row.iter().copied().sum()).collect()
    }

    /// The number of stages.
    pub fn stages(&self) -> usize {
        self.b.len()
    }

    /// Whether each stage follows from those before it: `a_ij = 0` for `j ≥ i`.
    pub fn is_explicit(&self) -> bool {
        self.a.iter().enumerate().all(|(i, row)| row.iter().skip(i).all(Exact::is_zero))
    }

    /// The order: that up to which all conditions hold, one for each rooted tree, up to order 4. Above, it is what follows from Butcher's
    /// simplifying assumptions, [`assumptions`](Self::assumptions), and may be too low.
    pub fn order(&self) -> u32 {
        match order(&[self]) {
            TREES => self.assured_order().max(TREES),
            lower => lower,
        }
    }

    /// Whether it keeps the symplectic form, and with it quadratic invariants: `b_i a_ij + b_j a_ji = b_i b_j`. HLW, VI.4.
    pub fn is_symplectic(&self) -> bool {
        symplectic(self, self)
    }

    /// Whether it is its own adjoint: `a_{s+1−i,s+1−j} + a_ij = b_j`, with its stages in the order of their times. HLW, V.2.
    pub fn is_symmetric(&self) -> bool {
        let last = self.stages() - 1;
        self.b.iter().eq(self.b.iter().rev())
            && self.pairs().all(|(i, j)| self.a[last - i][last - j] + self.a[i][j] == self.b[j])
    }

    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let stages = self.stages();
        (0..stages).flat_map(move |i| (0..stages).map(move |j| (i, j)))
    }

    /// The most for which Butcher's simplifying assumptions hold: `B(p)`, `C(η)`, `D(ζ)`. HNW, II.7.
    pub fn assumptions(&self) -> [u32; 3] {
        let (stages, c) = (self.stages(), self.c());
        let one = Exact::fraction(1, 1);
        // no method of s stages has more
        let most = 2 * stages as u32;
        let up_to = |holds: &dyn Fn(u32) -> bool| (1..=most).take_while(|&k| holds(k)).last().unwrap_or(0);
        let b = up_to(&|k| {
            let sum: Exact<D> = (0..stages).map(|i| self.b[i] * c[i].power(k - 1)).sum();
            sum == one / i64::from(k)
        });
        let eta = up_to(&|k| {
            (0..stages).all(|i| {
                let sum: Exact<D> = (0..stages).map(|j| self.a[i][j] * c[j].power(k - 1)).sum();
                sum == c[i].power(k) / i64::from(k)
            })
        });
        let zeta = up_to(&|k| {
            (0..stages).all(|j| {
                let sum: Exact<D> = (0..stages).map(|i| self.b[i] * c[i].power(k - 1) * self.a[i][j]).sum();
                sum == self.b[j] * (one - c[j].power(k)) / i64::from(k)
            })
        });
        [b, eta, zeta]
    }

    /// The order that Butcher's theorem gives: `p` with `B(p)`, `p ≤ η + ζ + 1` and `p ≤ 2η + 2`. HNW, II.7, theorem 7.4.
    fn assured_order(&self) -> u32 {
        let [b, eta, zeta] = self.assumptions();
        b.min(eta + zeta + 1).min(2 * eta + 2)
    }
}

impl<const D: u32> PartitionedTableau<D> {
    /// The pair; none if they have not as many stages.
    pub fn new(name: &'static str, positions: Tableau<D>, momenta: Tableau<D>) -> Option<Self> {
        (positions.stages() == momenta.stages()).then_some(Self { name, positions, momenta })
    }

    /// The method's usual name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// That of the positions: `a`, `b`.
    pub fn positions(&self) -> &Tableau<D> {
        &self.positions
    }

    /// That of the momenta: `A`, `B`.
    pub fn momenta(&self) -> &Tableau<D> {
        &self.momenta
    }

    /// Whether each stage of a system with `q' = f₁(p)`, `p' = f₂(q)` follows from those before it: whether no stage value depends on itself.
    pub fn is_explicit(&self) -> bool {
        // Q_i needs all P_j with a_ij, P_i needs all Q_j with A_ij: take away what depends on nothing that is left
        let tables = [&self.positions.a, &self.momenta.a];
        let mut left: BTreeSet<(usize, usize)> =
            (0..2).flat_map(|part| (0..self.positions.stages()).map(move |i| (part, i))).collect();
        loop {
            let depends = |&(part, i): &(usize, usize)| {
                left.iter().any(|&(other, j)| other != part && !tables[part][i][j].is_zero())
            };
            let rest: BTreeSet<_> = left.iter().filter(|stage| depends(stage)).copied().collect();
            if rest.len() == left.len() {
                return rest.is_empty();
            }
            left = rest;
        }
    }

    /// The order up to which all conditions hold, one for each rooted tree with vertices of two colours; at most 4. HLW, III.2.
    pub fn order(&self) -> u32 {
        order(&[&self.positions, &self.momenta])
    }

    /// Whether it is symplectic for every Hamiltonian: `b_i A_ij + B_j a_ji = b_i B_j` and `b = B`, 1.2.2. HLW, VI.4.
    pub fn is_symplectic(&self) -> bool {
        self.positions.b == self.momenta.b && symplectic(&self.positions, &self.momenta)
    }

    /// Whether it is its own adjoint: both are.
    pub fn is_symmetric(&self) -> bool {
        self.positions.is_symmetric() && self.momenta.is_symmetric()
    }
}

/// `b_i A_ij + B_j a_ji = b_i B_j`
fn symplectic<const D: u32>(plain: &Tableau<D>, hat: &Tableau<D>) -> bool {
    plain.pairs().all(|(i, j)| plain.b[i] * hat.a[i][j] + hat.b[j] * plain.a[j][i] == plain.b[i] * hat.b[j])
}

/// A rooted tree whose vertices have colours: a product of derivatives of the field. A vertex is a derivative of the components of its colour
/// by those of its children's.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Tree {
    color: usize,
    children: Vec<Tree>,
}

impl Tree {
    fn leaf(color: usize) -> Self {
        Self { color, children: Vec::new() }
    }

    /// All trees with one leaf more.
    fn grown(&self, colors: usize) -> Vec<Tree> {
        let attached = (0..colors).map(|color| {
            let mut tree = self.clone();
            tree.children.push(Self::leaf(color));
            tree
        });
        let above = self.children.iter().enumerate().flat_map(|(place, child)| {
            child.grown(colors).into_iter().map(move |child| {
                let mut tree = self.clone();
                tree.children[place] = child;
                tree
            })
        });
        let mut grown: Vec<Tree> = attached.chain(above).collect();
        // the order of children does not matter
        grown.iter_mut().for_each(|tree| tree.children.sort());
        grown
    }

    fn vertices(&self) -> i64 {
        1 + self.children.iter().map(Tree::vertices).sum::<i64>()
    }

    /// `γ`: the number of vertices, times that of all trees that are left when the root is taken away.
    fn density(&self) -> i64 {
        self.vertices() * self.children.iter().map(Tree::density).product::<i64>()
    }

    /// `Φ_i`, for each stage: the product over the children of `Σ_j a_ij Φ_j`, with the coefficients of each child's colour.
    fn stages<const D: u32>(&self, tables: &[&Tableau<D>]) -> Vec<Exact<D>> {
        let mut products = vec![Exact::fraction(1, 1); tables[self.color].stages()];
        for child in &self.children {
            let below = child.stages(tables);
            for (product, row) in products.iter_mut().zip(&tables[child.color].a) {
                *product = *product * row.iter().zip(&below).map(|(a, stage)| *a * *stage).sum();
            }
        }
        products
    }

    /// Its condition: `Σ b_i Φ_i = 1/γ`.
    fn holds<const D: u32>(&self, tables: &[&Tableau<D>]) -> bool {
        let sum: Exact<D> =
            tables[self.color].b.iter().zip(self.stages(tables)).map(|(b, stage)| *b * stage).sum();
        sum == Exact::fraction(1, self.density())
    }
}

/// All trees with so many vertices.
fn trees(colors: usize, vertices: u32) -> BTreeSet<Tree> {
    let first: BTreeSet<Tree> = (0..colors).map(Tree::leaf).collect();
    (1..vertices).fold(first, |trees, _| trees.iter().flat_map(|tree| tree.grown(colors)).collect())
}

/// The order up to which all conditions hold, at most [`TREES`].
fn order<const D: u32>(tables: &[&Tableau<D>]) -> u32 {
    let holds = |order: &u32| trees(tables.len(), *order).iter().all(|tree| tree.holds(tables));
    (1..=TREES).take_while(holds).last().unwrap_or(0)
}

/// `numerator/denominator`
fn r<const D: u32>(numerator: i64, denominator: i64) -> Exact<D> {
    Exact::fraction(numerator, denominator)
}

/// `a + b √D`, both over one denominator.
fn surd<const D: u32>(a: i64, b: i64, denominator: i64) -> Exact<D> {
    r(a, denominator) + Exact::root(b, denominator)
}

/// Zero, one and a half: most coefficients.
fn usual() -> [Rational; 3] {
    [r(0, 1), r(1, 1), r(1, 2)]
}

impl Tableau {
    /// Explicit Euler, (1.7) for the oscillator. Order 1.
    pub fn explicit_euler() -> Self {
        let [o, l, _] = usual();
        Self::new("explicit Euler", [[o]], [l])
    }

    /// Implicit Euler, (1.8) for the oscillator. Order 1.
    pub fn implicit_euler() -> Self {
        let [_, l, _] = usual();
        Self::new("implicit Euler", [[l]], [l])
    }

    /// RK2 as most people write it: the explicit midpoint rule of C. Runge (1895). Order 2.
    pub fn rk2() -> Self {
        let [o, l, half] = usual();
        Self::new("RK2", [[o, o], [half, o]], [o, l])
    }

    /// RK2 as K. Heun (1900) has it: the explicit trapezoidal rule. Order 2.
    pub fn heun() -> Self {
        let [o, l, half] = usual();
        Self::new("Heun's RK2", [[o, o], [l, o]], [half, half])
    }

    /// RK2 with the least bound of its error, by A. Ralston (1962). Order 2.
    pub fn ralston() -> Self {
        let [o, ..] = usual();
        Self::new("Ralston's RK2", [[o, o], [r(2, 3), o]], [r(1, 4), r(3, 4)])
    }

    /// RK4: the classical method of W. Kutta (1901). Order 4.
    pub fn rk4() -> Self {
        let [o, l, half] = usual();
        let a = [[o, o, o, o], [half, o, o, o], [o, half, o, o], [o, o, l, o]];
        Self::new("RK4", a, [r(1, 6), r(1, 3), r(1, 3), r(1, 6)])
    }

    /// The 3/8 rule, also Kutta's. Order 4.
    pub fn three_eighths() -> Self {
        let [o, l, _] = usual();
        let a = [[o, o, o, o], [r(1, 3), o, o, o], [r(-1, 3), l, o, o], [l, -l, l, o]];
        Self::new("3/8 rule", a, [r(1, 8), r(3, 8), r(3, 8), r(1, 8)])
    }

    /// The implicit midpoint rule: Gauss's method of one stage. Order 2, symplectic, symmetric.
    pub fn implicit_midpoint() -> Self {
        let [_, l, half] = usual();
        Self::new("implicit midpoint", [[half]], [l])
    }
}

impl Tableau<3> {
    /// Gauss's method of two stages. Order 4, symplectic, symmetric. HNW, II.7.
    pub fn gauss2() -> Self {
        let quarter = r(1, 4);
        let a = [[quarter, surd(3, -2, 12)], [surd(3, 2, 12), quarter]];
        Self::new("Gauss, order 4", a, [r(1, 2), r(1, 2)])
    }
}

impl Tableau<15> {
    /// Gauss's method of three stages. Order 6, symplectic, symmetric. HNW, II.7.
    pub fn gauss3() -> Self {
        let (outer, middle) = (r(5, 36), r(2, 9));
        let a = [
            [outer, surd(10, -3, 45), surd(25, -6, 180)],
            [surd(10, 3, 72), middle, surd(10, -3, 72)],
            [surd(25, 6, 180), surd(10, 3, 45), outer],
        ];
        Self::new("Gauss, order 6", a, [r(5, 18), r(4, 9), r(5, 18)])
    }
}

impl PartitionedTableau {
    /// A pair of tableaux that are written below with as many stages.
    fn pair<const S: usize>(name: &'static str, b: [Rational; S], tables: [[[Rational; S]; S]; 2]) -> Self {
        let [positions, momenta] = tables.map(|a| Tableau::new(name, a, b));
        Self { name, positions, momenta }
    }

    /// Symplectic Euler A, (1.9): the momentum first, and the position with the new momentum. Order 1, symplectic.
    ///
    /// ```text
    /// p_{k+1} = p_k − h ∇V(t_k, q_k),   q_{k+1} = q_k + h ∇T(p_{k+1})
    /// ```
    pub fn symplectic_euler_a() -> Self {
        let [o, l, _] = usual();
        Self::pair("symplectic Euler A", [l], [[[o]], [[l]]])
    }

    /// Symplectic Euler B, (1.10), the adjoint of A: the position first, and the momentum with the new position. Order 1, symplectic.
    ///
    /// ```text
    /// q_{k+1} = q_k + h ∇T(p_k),   p_{k+1} = p_k − h ∇V(t_k + h, q_{k+1})
    /// ```
    pub fn symplectic_euler_b() -> Self {
        let [o, l, _] = usual();
        Self::pair("symplectic Euler B", [l], [[[l]], [[o]]])
    }

    /// Störmer–Verlet: half a step of A, then half a step of B. Order 2, symplectic, symmetric. HLW, I.1.4.
    ///
    /// ```text
    /// p_{k+½} = p_k − (h/2) ∇V(t_k, q_k)
    /// q_{k+1} = q_k + h ∇T(p_{k+½})
    /// p_{k+1} = p_{k+½} − (h/2) ∇V(t_k + h, q_{k+1})
    /// ```
    ///
    /// The paper prints `a = [[0, 0], [1, 0]]` for the positions, which breaks its own condition of symplecticity; it is
    /// `[[0, 0], [½, ½]]`.
    pub fn stormer_verlet() -> Self {
        let [o, _, half] = usual();
        let tables = [[[o, o], [half, half]], [[half, o], [half, o]]];
        Self::pair("Störmer–Verlet", [half, half], tables)
    }

    /// Lobatto IIIA for the positions, IIIB for the momenta, with three stages: what [Störmer–Verlet](Self::stormer_verlet) is with two.
    /// Implicit, order 4, symplectic, symmetric. HLW, II.1.4.
    pub fn lobatto3() -> Self {
        let [o, ..] = usual();
        let (sixth, third) = (r(1, 6), r(1, 3));
        let positions = [[o, o, o], [r(5, 24), third, r(-1, 24)], [sixth, r(2, 3), sixth]];
        let momenta = [[sixth, r(-1, 6), o], [sixth, third, o], [sixth, r(5, 6), o]];
        Self::pair("Lobatto IIIA–IIIB, order 4", [sixth, r(2, 3), sixth], [positions, momenta])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trees_are_as_many_as_there_are() {
        // A000081, and with vertices of two colours A000151
        let counts = |colors| [1, 2, 3, 4, 5].map(|vertices| trees(colors, vertices).len());
        assert_eq!(counts(1), [1, 1, 2, 4, 9]);
        assert_eq!(counts(2), [2, 4, 14, 52, 214]);
        // those of order 4: 4, 8, 12, 24
        let mut densities: Vec<i64> = trees(1, 4).iter().map(Tree::density).collect();
        densities.sort_unstable();
        assert_eq!(densities, [4, 8, 12, 24]);
    }

    #[test]
    fn surds_are_numbers() {
        let x: Exact<3> = surd(3, -2, 12);
        assert_eq!(x.to_string(), "1/4 - 1/6 √3");
        assert!((x.to_f64() - (0.25 - 3_f64.sqrt() / 6.0)).abs() < 1e-17);
        // (1/4 − √3/6)(1/4 + √3/6) = 1/16 − 1/12
        assert_eq!(x * surd(3, 2, 12), r(-1, 48));
        assert_eq!(x.power(3), x * x * x);
        assert!((x - x).is_zero() && !x.is_zero());
    }

    /// Order, explicit, symplectic, symmetric.
    type Known = (u32, bool, bool, bool);

    fn known<const D: u32>(tableau: &Tableau<D>) -> Known {
        (tableau.order(), tableau.is_explicit(), tableau.is_symplectic(), tableau.is_symmetric())
    }

    fn known_pair(tableau: &PartitionedTableau) -> Known {
        (tableau.order(), tableau.is_explicit(), tableau.is_symplectic(), tableau.is_symmetric())
    }

    #[test]
    fn tableaux_know_what_the_books_say_of_them() {
        assert_eq!(known(&Tableau::explicit_euler()), (1, true, false, false));
        assert_eq!(known(&Tableau::implicit_euler()), (1, false, false, false));
        assert_eq!(known(&Tableau::rk2()), (2, true, false, false));
        assert_eq!(known(&Tableau::heun()), (2, true, false, false));
        assert_eq!(known(&Tableau::ralston()), (2, true, false, false));
        assert_eq!(known(&Tableau::rk4()), (4, true, false, false));
        assert_eq!(known(&Tableau::three_eighths()), (4, true, false, false));
        assert_eq!(known(&Tableau::implicit_midpoint()), (2, false, true, true));
        assert_eq!(known(&Tableau::gauss2()), (4, false, true, true));
        assert_eq!(known(&Tableau::gauss3()), (6, false, true, true));
        assert_eq!(Tableau::gauss3().assumptions(), [6, 3, 3]);

        assert_eq!(known_pair(&PartitionedTableau::symplectic_euler_a()), (1, true, true, false));
        assert_eq!(known_pair(&PartitionedTableau::symplectic_euler_b()), (1, true, true, false));
        assert_eq!(known_pair(&PartitionedTableau::stormer_verlet()), (2, true, true, true));
        assert_eq!(known_pair(&PartitionedTableau::lobatto3()), (4, false, true, true));
    }

    /// The paper's conditions for the orders 1 to 3, as they stand there.
    #[test]
    fn the_conditions_of_the_trees_are_the_papers() {
        let sum_of = |terms: &mut dyn Iterator<Item = Rational>| -> Rational { terms.sum() };
        for tableau in [Tableau::rk2(), Tableau::heun(), Tableau::rk4(), Tableau::three_eighths()] {
            let (a, b, c) = (tableau.a(), tableau.b(), tableau.c());
            let stages = 0..tableau.stages();
            let first = sum_of(&mut b.iter().copied()) == r(1, 1);
            let second = sum_of(&mut stages.clone().map(|i| b[i] * c[i])) == r(1, 2);
            let third = sum_of(&mut stages.clone().map(|i| b[i] * c[i] * c[i])) == r(1, 3);
            let products = tableau.pairs().map(|(i, j)| b[i] * a[i][j] * c[j]);
            let third = third && sum_of(&mut { products }) == r(1, 6);
            let order = [first, second, third].iter().take_while(|holds| **holds).count();
            assert_eq!(tableau.order().min(3) as usize, order, "{}", tableau.name());
        }
    }

    /// What the paper prints for Störmer–Verlet breaks its own condition, and with it the order: ½·½ + ½·0 is not ½·½ for i = 1, j = 2 of
    /// `b_i A_ij + B_j a_ji = b_i B_j`, nor for the other pairs.
    #[test]
    fn the_printed_tableau_of_stormer_and_verlet_is_not_symplectic() {
        let [o, l, half] = usual();
        let right = PartitionedTableau::stormer_verlet();
        let positions = Tableau::new("printed", [[o, o], [l, o]], [half, half]);
        let printed =
            PartitionedTableau::new("printed", positions, right.momenta().clone()).expect("two stages");
        assert!(!printed.is_symplectic() && !printed.is_symmetric());
        let (b, hat) = (printed.positions().b(), printed.momenta().a());
        let defect =
            |i: usize, j: usize| b[i] * hat[i][j] + b[j] * printed.positions().a()[j][i] - b[i] * b[j];
        // the first stage with the second
        assert_eq!((defect(0, 1), defect(1, 1)), (r(1, 4), r(-1, 4)));
    }

    #[test]
    fn partitioned_orders_are_not_those_of_the_parts() {
        // two methods of order 2 that make none of order 2 together
        let pair = PartitionedTableau::new("mixed", Tableau::rk2(), Tableau::heun()).expect("two stages");
        assert_eq!((pair.positions().order(), pair.momenta().order(), pair.order()), (2, 2, 1));
        assert!(PartitionedTableau::new("none", Tableau::rk2(), Tableau::rk4()).is_none());
    }
}
