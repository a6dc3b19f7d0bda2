//! Casimirs, found: the polynomials `C` that every Hamiltonian keeps, `Σ_i ∂C/∂m_i {m_i, m_j} = 0` for all `j`, with
//! the Lie–Poisson bracket `{m_i, m_j} = Σ_k c_ij^k m_k`.
//!
//! Degree by degree, they are the common kernel of the derivations `{·, m_j}` on the polynomials of that degree: of one
//! derivation after the other, as the kernel of the first ones is small. The number of independent ones is that of the
//! columns of `{m_i, m_j}` less its rank at a generic point; the search ends there, or behind the largest degree.
//! Elimination is modulo a prime; what is found has small coefficients, which are read back as fractions, and checked
//! exactly. Where the constants of a basis are many or large, the coefficients are too: the search is in a simpler
//! basis then, and what it finds is expanded.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::{Add, Mul, Range};

use num_rational::Ratio;

use super::exact::Rational;
use super::{Semidirect, Structure};
use crate::expr::modular::{Echelon, PRIME, Sparse, residue};

/// The largest degree that is searched.
const DEGREE: usize = 4;
/// How many monomials a part of the search may have.
const MONOMIALS: usize = 1_000;

/// Indices of variables, sorted, each as often as its exponent.
type Monomial = Vec<usize>;

/// The degree in each block: blocks, sorted, each as often as its degree.
type Part = Vec<usize>;

/// A polynomial with whole coefficients without a common divisor.
pub type Polynomial = BTreeMap<Monomial, i64>;

/// The Casimirs found, as polynomials or as something made of these, and how many are missing.
#[derive(Clone, Debug)]
pub struct Casimirs<T = Polynomial> {
    /// Independent ones, those of a lower degree first.
    pub found: Vec<T>,
    /// How many more there are: of a higher degree, with large coefficients, or no polynomials at all.
    pub missing: usize,
}

/// The Casimirs that are functions of these variables alone. These are given in blocks: a Casimir is searched for among
/// the polynomials of one degree in each block, so that what is scaled apart stays apart.
pub fn casimirs(structure: &Structure, blocks: &[Range<usize>]) -> Casimirs {
    let point = generic_point(structure.dimension);
    let all = number(structure, blocks, &point);
    let acting: Vec<BTreeSet<usize>> = blocks.iter().map(|block| acting_on(structure, block)).collect();
    let mut independent = Echelon::default();
    let mut found: Vec<(Part, Polynomial)> = Vec::new();
    for degree in 1..=DEGREE {
        if found.len() == all {
            break;
        }
        for part in parts(blocks.len(), degree) {
            if found.len() == all {
                break;
            }
            let Some(monomials) = monomials(blocks, &part) else { continue };
            let derivations = part.iter().flat_map(|&block| acting[block].iter().copied()).collect();
            let products = products(&found, &part).into_iter().map(modular);
            for kept in kernel(structure, &derivations, monomials, products) {
                let Some(polynomial) = exact(&kept).filter(|exact| is_kept(structure, exact)) else {
                    continue;
                };
                if found.len() < all && independent.insert(gradient(&kept, &point)) {
                    found.push((part.clone(), polynomial));
                }
            }
        }
    }
    let missing = all - found.len();
    Casimirs { found: found.into_iter().map(|(_, polynomial)| polynomial).collect(), missing }
}

/// The same of a semidirect algebra, whose constants are these if they are exact: in a simpler basis of the group's
/// algebra if there is one.
pub fn casimirs_of(algebra: &Semidirect, blocks: &[Range<usize>]) -> Option<Casimirs> {
    let structure = Structure::of(algebra)?;
    let simple = algebra.group.simple_basis().and_then(|basis| Some((structure.in_basis(&basis)?, basis)));
    // what is found in another basis reads less well, so that this one has to be much simpler
    let Some((simple, basis)) = simple.filter(|(simple, _)| 2 * simple.digits() < structure.digits()) else {
        return Some(casimirs(&structure, blocks));
    };
    let Casimirs { found, missing } = casimirs(&simple, blocks);
    let all = found.len() + missing;
    let found: Vec<Polynomial> = found.iter().filter_map(|casimir| expanded(casimir, &basis)).collect();
    Some(Casimirs { missing: all - found.len(), found })
}

/// The polynomial with a sum of the first variables instead of each of these, its row; none if coefficients grow too
/// large.
fn expanded(polynomial: &Polynomial, rows: &[Vec<Ratio<i64>>]) -> Option<Polynomial> {
    let sum = |variable: &usize| -> BTreeMap<Monomial, Rational> {
        let Some(row) = rows.get(*variable) else {
            return BTreeMap::from([(vec![*variable], Rational::one())]);
        };
        let row = row.iter().map(|&x| Rational::from(x)).enumerate().filter(|(_, x)| !x.is_zero());
        row.map(|(variable, x)| (vec![variable], x)).collect()
    };
    let mut terms: BTreeMap<Monomial, Rational> = BTreeMap::new();
    for (monomial, &coefficient) in polynomial {
        let coefficient = BTreeMap::from([(Monomial::new(), Rational::from(i128::from(coefficient)))]);
        let product = monomial.iter().fold(coefficient, |product, variable| times(&product, &sum(variable)));
        for (monomial, coefficient) in product {
            let entry = terms.entry(monomial).or_insert_with(Rational::zero);
            *entry = *entry + coefficient;
        }
    }
    terms.retain(|_, coefficient| !coefficient.is_zero());
    let terms = terms.into_iter().map(|(monomial, coefficient)| Some((monomial, coefficient.parts()?)));
    primitive(terms.collect::<Option<_>>()?, i128::MAX)
}

/// The multiple of a polynomial, of which numerators and denominators are given, with whole coefficients that have no
/// common divisor; the last one is positive. None if coefficients grow too large, or their denominators' multiple.
fn primitive(terms: Vec<(Monomial, (i128, i128))>, largest: i128) -> Option<Polynomial> {
    let parts = || terms.iter().map(|&(_, parts)| parts);
    // of the numerators the divisor, of the denominators the multiple, with the sign of the last one
    let divisor = parts().fold(0, |divisor, (numerator, _)| greatest_common_divisor(divisor, numerator));
    let multiple = parts().try_fold(1_i128, |multiple, (_, denominator)| {
        let next = multiple.checked_mul(denominator / greatest_common_divisor(multiple, denominator))?;
        (next < largest).then_some(next)
    })?;
    let sign = parts().next_back()?.0.signum();
    let whole = terms.into_iter().map(|(monomial, (numerator, denominator))| {
        let whole = (sign * numerator / divisor).checked_mul(multiple / denominator)?;
        Some((monomial, i64::try_from(whole).ok()?))
    });
    whole.collect()
}

/// Numbers modulo the prime at which no polynomial of low degree vanishes by chance, the same each time.
fn generic_point(dimension: usize) -> Vec<u64> {
    let next = |x: &u64| Some((x * 1_103_515_245 + 12_345) % PRIME);
    std::iter::successors(Some(17_u64), next).skip(3).take(dimension).collect()
}

/// How many independent functions of these variables all derivations leave alone: there are as many as variables, less
/// the rank of the derivations at a generic point.
fn number(structure: &Structure, blocks: &[Range<usize>], point: &[u64]) -> usize {
    let mut rank = Echelon::default();
    let variables = || blocks.iter().cloned().flatten();
    for j in 0..structure.dimension {
        let value = |i: usize| {
            let constants = structure.bracket(i, j).iter();
            constants.fold(0, |sum, &(k, constant)| (sum + residue(constant) * point[k]) % PRIME)
        };
        rank.insert(variables().map(|i| (i, value(i))).filter(|&(_, value)| value != 0).collect());
    }
    variables().count() - rank.rows.len()
}

/// The `j` with derivations `{·, m_j}` that change any of these variables.
fn acting_on(structure: &Structure, variables: &Range<usize>) -> BTreeSet<usize> {
    let all = 0..structure.dimension;
    all.filter(|&j| variables.clone().any(|i| !structure.bracket(i, j).is_empty())).collect()
}

/// The ways to share a degree among blocks: squares first, then products of the first blocks, as people list them.
fn parts(blocks: usize, degree: usize) -> Vec<Part> {
    let mut parts = vec![Vec::new()];
    for _ in 0..degree {
        let longer = |part: Vec<usize>| {
            let first = part.last().copied().unwrap_or(0);
            (first..blocks).map(move |block| [part.clone(), vec![block]].concat())
        };
        parts = parts.into_iter().flat_map(longer).collect();
        if parts.len() > MONOMIALS * MONOMIALS {
            return Vec::new();
        }
    }
    parts.sort_by_key(|part| part.windows(2).filter(|pair| pair[0] != pair[1]).count());
    parts
}

/// The monomials with one variable of each of these blocks; none if there are too many.
fn monomials(blocks: &[Range<usize>], part: &[usize]) -> Option<Vec<Monomial>> {
    let mut monomials = vec![Monomial::new()];
    for &block in part {
        let longer = |monomial: Monomial| {
            let first = monomial.last().copied().unwrap_or(0).max(blocks[block].start);
            (first..blocks[block].end).map(move |variable| [monomial.clone(), vec![variable]].concat())
        };
        monomials = monomials.into_iter().flat_map(longer).collect();
        if monomials.len() > MONOMIALS {
            return None;
        }
    }
    Some(monomials)
}

/// The products of polynomials that have this degree in each block.
fn products(factors: &[(Part, Polynomial)], part: &[usize]) -> Vec<Polynomial> {
    let mut products = Vec::new();
    let one = Polynomial::from([(Monomial::new(), 1)]);
    let mut open = vec![(one, part.to_vec(), 0)];
    while let Some((product, left, first)) = open.pop() {
        if left.is_empty() {
            products.push(product);
            continue;
        }
        for (place, (own, factor)) in factors.iter().enumerate().skip(first) {
            if let Some(left) = without(&left, own) {
                open.push((times(&product, factor), left, place));
            }
        }
    }
    products
}

/// The rest of some blocks when these are taken, each once; nothing if one is not among them.
fn without(blocks: &[usize], taken: &[usize]) -> Option<Part> {
    taken.iter().try_fold(blocks.to_vec(), |mut left, block| {
        let place = left.iter().position(|other| other == block)?;
        left.remove(place);
        Some(left)
    })
}

fn times<T: Copy + Add<Output = T> + Mul<Output = T>>(
    a: &BTreeMap<Monomial, T>,
    b: &BTreeMap<Monomial, T>,
) -> BTreeMap<Monomial, T> {
    let mut product = BTreeMap::new();
    for (m, &x) in a {
        for (n, &y) in b {
            let mut monomial = [m.clone(), n.clone()].concat();
            monomial.sort_unstable();
            product.entry(monomial).and_modify(|sum| *sum = *sum + x * y).or_insert(x * y);
        }
    }
    product
}

fn modular(polynomial: Polynomial) -> Sparse<Monomial> {
    let coefficient = |x: i64| residue(Ratio::from_integer(x));
    polynomial.into_iter().map(|(monomial, x)| (monomial, coefficient(x))).collect()
}

/// The polynomials in these monomials that these derivations annul and that do not follow from products, in reduced
/// echelon form: the one with the last monomial first.
fn kernel(
    structure: &Structure,
    derivations: &BTreeSet<usize>,
    monomials: Vec<Monomial>,
    products: impl Iterator<Item = Sparse<Monomial>>,
) -> Vec<Sparse<Monomial>> {
    let mut space: Vec<Sparse<Monomial>> =
        monomials.into_iter().map(|monomial| Sparse::from([(monomial, 1)])).collect();
    for &j in derivations {
        // images, each with what it is the image of before it: where the image is gone, that is in the kernel
        let mut images = Echelon::default();
        let of_image = |polynomial: Sparse<Monomial>| {
            let image =
                derived(structure, &polynomial, j).into_iter().map(|(monomial, x)| ((true, monomial), x));
            let source = polynomial.into_iter().map(|(monomial, x)| ((false, monomial), x));
            let rest = images.reduce(source.chain(image).collect());
            match rest.last_key_value() {
                Some(((true, _), _)) => {
                    images.push(rest);
                    None
                }
                _ => Some(rest.into_iter().map(|((_, monomial), x)| (monomial, x)).collect()),
            }
        };
        space = space.into_iter().filter_map(of_image).collect();
    }
    let mut known = Echelon::default();
    products.for_each(|product| _ = known.insert(product));
    let old = known.rows.len();
    space.into_iter().for_each(|polynomial| _ = known.insert(polynomial));
    known.reduced(old)
}

/// `Σ_i ∂C/∂m_i {m_i, m_j}`, modulo the prime.
fn derived(structure: &Structure, polynomial: &Sparse<Monomial>, j: usize) -> Sparse<Monomial> {
    let mut image = Sparse::new();
    for (monomial, coefficient, constant) in derivation(structure, polynomial, j) {
        let entry = image.entry(monomial).or_insert(0);
        *entry = (*entry + coefficient * residue(constant)) % PRIME;
    }
    image.retain(|_, coefficient| *coefficient != 0);
    image
}

/// The terms of `Σ_i ∂C/∂m_i {m_i, m_j}`: a monomial, a coefficient, and the constant that it is multiplied by.
fn derivation<'p, T: Copy>(
    structure: &'p Structure,
    polynomial: &'p BTreeMap<Monomial, T>,
    j: usize,
) -> impl Iterator<Item = (Monomial, T, Ratio<i64>)> + 'p {
    polynomial.iter().flat_map(move |(monomial, &coefficient)| {
        let constants = monomial.iter().enumerate().flat_map(move |(place, &i)| {
            structure.bracket(i, j).iter().map(move |&(k, constant)| (place, k, constant))
        });
        constants.map(move |(place, k, constant)| {
            let mut changed = monomial.clone();
            changed[place] = k;
            changed.sort_unstable();
            (changed, coefficient, constant)
        })
    })
}

/// Numerator and denominator, both small, of the fraction that is `x` modulo the prime.
fn fraction(x: u64) -> Option<(i128, i128)> {
    let bound = (PRIME as f64 / 2.0).sqrt() as i64;
    let (mut a, mut b, mut s, mut t) = (PRIME as i64, x as i64, 0, 1);
    while b > bound {
        let quotient = a / b;
        (a, b, s, t) = (b, a - quotient * b, t, s - quotient * t);
    }
    let is_small = t != 0 && t.abs() <= bound;
    is_small.then(|| Ratio::new(i128::from(b), i128::from(t)).into_raw())
}

/// With whole coefficients that have no common divisor; the last one is positive.
fn exact(polynomial: &Sparse<Monomial>) -> Option<Polynomial> {
    let coefficients = polynomial.iter().map(|(monomial, &x)| Some((monomial.clone(), fraction(x)?)));
    primitive(coefficients.collect::<Option<_>>()?, PRIME.into())
}

fn greatest_common_divisor(mut a: i128, mut b: i128) -> i128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.abs()
}

/// Whether all derivations annul a polynomial, exactly.
fn is_kept(structure: &Structure, polynomial: &Polynomial) -> bool {
    (0..structure.dimension).all(|j| {
        let mut image: BTreeMap<Monomial, Ratio<i64>> = BTreeMap::new();
        for (monomial, coefficient, constant) in derivation(structure, polynomial, j) {
            *image.entry(monomial).or_default() += constant * coefficient;
        }
        image.values().all(|coefficient| *coefficient.numer() == 0)
    })
}

/// The gradient at a point.
fn gradient(polynomial: &Sparse<Monomial>, point: &[u64]) -> Sparse<usize> {
    let mut gradient = Sparse::new();
    for (monomial, &coefficient) in polynomial {
        for (place, &variable) in monomial.iter().enumerate() {
            let others = monomial.iter().enumerate().filter(|&(other, _)| other != place);
            let product = others.fold(coefficient, |product, (_, &other)| product * point[other] % PRIME);
            let entry = gradient.entry(variable).or_insert(0);
            *entry = (*entry + product) % PRIME;
        }
    }
    gradient.retain(|_, value| *value != 0);
    gradient
}
