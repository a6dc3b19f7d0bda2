//! The laws of a system's group, from definitions.
//!
//! Of the generated code this takes displacements, the Poisson structure and the kernels of steps, at elements of the algebra that no motion chose: a
//! kernel says of any unknown what `(dR τ_x)* m` and `Ad*_{τ(x)} m` are. Held against them are power series, matrices where elements are stored as such,
//! and differences.

use nalgebra::{DMatrix, DVector};

use super::CertifyError;
use super::frame::{Degenerate, exponential, larger, relative, worst};
use super::neighbourhood::{
    Basis, Carried, EvaluateKernel, Neighbourhood, Unknown, combined, function, is_defined,
};
use super::report::{Bound, Certificate, Report};
use crate::erased::array;
use crate::retraction::RetractionKind;
use crate::scheme::Rule;
use crate::system::{Control, Geometry, Kind, Role, Schemes, State, System};

/// What differences leave of a law.
const DIFFERENCES: Bound = Bound::AtMost(1e-10);
/// What rounding leaves of one.
const ROUNDING: Bound = Bound::AtMost(1e-12);

/// Asserts that a group obeys the laws of Lie groups: the test of a group of your own, in one line.
///
/// ```
/// use coadjoint::prelude::*;
///
/// lie_group! {
///     /// Maps of the plane that keep areas.
///     Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }
/// }
///
/// // in a test
/// coadjoint::assert_group_laws!(Areas!);
/// // with columns and rows that the group acts on
/// coadjoint::assert_group_laws!(Areas!, advected(v: R2, w: dual(R2)));
/// ```
///
/// What stands in the parentheses is what stands behind `group =` in a description. A free body on it is generated, and
/// [`group_laws`](crate::certify::group_laws) are measured on that code.
///
/// # Panics
/// If a law does not hold, with the table of all of them.
#[macro_export]
macro_rules! assert_group_laws {
    ($($group:tt)+) => {{
        #[$crate::lie_poisson_system(group = $($group)+)]
        struct Body {
            #[inertia]
            inertia: f64,
        }
        match $crate::certify::group_laws_of(&Body { inertia: 1.0 }) {
            Ok(laws) => ::core::assert!(laws.passed(), "{}: {laws}", ::core::stringify!($($group)+)),
            Err(error) => ::core::panic!("{}: {error}", ::core::stringify!($($group)+)),
        }
    }};
}

/// Measures the laws of the group that a system is on, and of the spaces of its advected parameters, about a state: those of the code that was
/// generated for the system.
///
/// | law | figure |
/// |---|---|
/// | antisymmetry, Jacobi identity | of the bracket, and of the semidirect one with advected parameters: then the group acts on these |
/// | commutators | `E_i E_j − E_j E_i` less `[e_i, e_j]`, where elements are matrices |
/// | definition | `g τ(x)` less `g exp X` as a power series, or less `g (1 − X/2)⁻¹(1 + X/2)`, where elements are matrices; less `g exp(x₁E₁) exp(x₂E₂) ⋯` |
/// | on the group | how far `g τ(x)` is off it |
/// | inverse | `τ(−x) τ(x)` less `e`; of exponential and Cayley |
/// | series | `dR τ_x` by differences, less `φ₁(ad_x)` as a power series; of the exponential |
/// | derivative | `(dR τ_x)* m` of the steps, less that by differences |
/// | adjoint action | `Ad_{τ(x)}` by differences, less `exp ad_z`, where `τ(x) = exp z` |
/// | coadjoint action | `Ad*_{τ(x)} m` of the steps, less that by differences, and, of exponential and Cayley, less `m + ad*_x (dR τ_x)* m` |
/// | spaces | advected parameters after `τ(x)`, less those after `exp ρ_z` as a power series |
/// | Casimirs | their change by `Ad*_{τ(x)}` |
///
/// All but the first three are measured with each retraction that there are steps with, at two `x` of about half a radian. Figures count relative to the size of what is compared, and hold up to 1e-10 where they are of differences, 1e-12 otherwise. What the steps have
/// is not measured where their unknown is not the velocity alone, as for a general Hamiltonian.
///
/// [`assert_group_laws!`](crate::assert_group_laws) does this for a group by itself.
///
/// # Errors
/// If the parameters or the state are not valid.
pub fn group_laws<S>(system: &S, state: &S::State) -> Result<Report, CertifyError>
where
    S: Geometry<Scalar = f64> + Schemes,
{
    System::validate(system)?;
    let parameters = system.to_parameters();
    let kernel = |map, state: &[f64], unknown: &[f64]| {
        let rule = Rule::Family(0, 1);
        S::visit(map, rule, EvaluateKernel { parameters: parameters.as_ref(), state, unknown })
    };
    let state = state.to_components();
    let control = S::Control::default().to_components();
    let about = Neighbourhood::new(system, state.as_ref(), control.as_ref(), &kernel)?;
    let certificates = certificates(&about);
    Ok(Report { system: S::NAME, scheme: None, properties: None, step: None, certificates })
}

/// The laws of the group of a free body, whose elements are displaced from the unit.
#[doc(hidden)]
pub fn group_laws_of<S>(body: &S) -> Result<Report, CertifyError>
where
    S: Geometry<Scalar = f64> + Schemes,
{
    let mut unit = Vec::new();
    for quantity in S::State::QUANTITIES {
        let start = unit.len();
        let number = |i: usize| match (quantity.role, quantity.kind) {
            (Role::Configuration, Kind::Matrix(_, columns)) => f64::from(i.is_multiple_of(columns + 1)),
            (Role::Configuration, Kind::Scalar | Kind::Vector(_)) => 0.0,
            // a rotation begins with the real part
            (Role::Configuration, _) => f64::from(i == 0),
            _ => 0.3 * (1.7 * (start + i) as f64 + 0.4).sin(),
        };
        unit.extend((0..quantity.components.len()).map(number));
    }
    group_laws(body, &S::State::from_components(&array(&unit)))
}

/// What measures a law of a retraction at an element of the algebra; nothing if there is nothing to measure.
type Law<'a> = fn(&Neighbourhood<'a>, RetractionKind, &DVector<f64>) -> Result<Option<f64>, Degenerate>;

/// The laws of the algebra, then those of each retraction that there are steps with.
fn certificates(about: &Neighbourhood<'_>) -> Vec<Certificate> {
    let mut certificates = vec![
        law("antisymmetry", ROUNDING, Ok(Some(about.antisymmetry()))),
        law("Jacobi identity", ROUNDING, Ok(Some(about.jacobi()))),
        law("commutators", DIFFERENCES, about.commutators()),
    ];
    let laws: [(&str, Bound, Law<'_>); 9] = [
        ("definition", DIFFERENCES, Neighbourhood::definition),
        ("on the group", ROUNDING, Neighbourhood::on_the_group),
        ("inverse", ROUNDING, Neighbourhood::inverse),
        ("series", DIFFERENCES, Neighbourhood::series),
        ("derivative", DIFFERENCES, Neighbourhood::derivative),
        ("adjoint action", DIFFERENCES, Neighbourhood::adjoint_action),
        ("coadjoint action", DIFFERENCES, Neighbourhood::coadjoint_action),
        ("spaces", DIFFERENCES, Neighbourhood::spaces),
        ("Casimirs", ROUNDING, Neighbourhood::casimirs),
    ];
    for map in RetractionKind::ALL {
        if about.has(map) {
            let name = map.spoken();
            certificates.extend(laws.iter().map(|(of, bound, measure)| {
                let worst = worst(about.points.iter().map(|x| measure(about, map, x)));
                law(&format!("{name}: {of}"), *bound, worst)
            }));
        }
    }
    certificates
}

/// A figure against its bound; what cannot be measured breaks the law.
fn law(name: &str, bound: Bound, figure: Result<Option<f64>, Degenerate>) -> Certificate {
    let figure = figure.unwrap_or(Some(f64::NAN));
    Certificate::new(name, figure.map(|figure| (figure, 0)), Some(bound))
}

impl Neighbourhood<'_> {
    fn antisymmetry(&self) -> f64 {
        let [x, y, _] = self.general();
        let (one, other) = (self.bracket(&x, &y), self.bracket(&y, &x));
        relative((&one + other).amax(), one.amax())
    }

    /// With advected parameters the algebra is the semidirect one: then it says that the group acts on them, `ρ_[x,y] = [ρ_x, ρ_y]`, too.
    fn jacobi(&self) -> f64 {
        let [x, y, z] = self.general();
        let cyclic = [(&x, &y, &z), (&y, &z, &x), (&z, &x, &y)];
        let terms = cyclic.map(|(x, y, z)| self.bracket(x, &self.bracket(y, z)));
        let size = terms.iter().fold(0.0, |size: f64, term| size.max(term.amax()));
        relative(terms.iter().sum::<DVector<f64>>().amax(), size)
    }

    /// `E_i E_j − E_j E_i` is `[e_i, e_j]`, where elements are matrices.
    fn commutators(&self) -> Result<Option<f64>, Degenerate> {
        let mut errors = Vec::new();
        for stored in self.matrices() {
            let Basis { basis, sign, off } = self.basis(&stored)?;
            errors.push(off);
            for i in 0..basis.len() {
                for j in 0..i {
                    let product = &basis[i] * &basis[j];
                    let commutator = (&product - &basis[j] * &basis[i]) * sign;
                    let bracket = self.bracket(
                        &self.zero_padded(&self.axis(i, 1.0)),
                        &self.zero_padded(&self.axis(j, 1.0)),
                    );
                    let error = (commutator - combined(&basis, &bracket)).amax();
                    errors.push(error / product.amax().max(1.0));
                }
            }
        }
        Ok(errors.into_iter().reduce(larger))
    }

    /// `g τ(x)` of a kernel is that of displacements, and `g f(X)` where elements are matrices. In coordinates of the second kind it is that of the
    /// exponential along one axis after the other.
    fn definition(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let there = self.frame.moved(&self.state, map, x);
        let mut errors = Vec::new();
        if let Some(Unknown::Of { unknown, .. }) = self.unknown(map, x)? {
            let next = self.value(map, &self.state, &unknown)?.next;
            let next = self.frame.with_linear_part(&next, &self.frame.linear_part(&there));
            errors.push(self.frame.distance(&next, &there));
        }
        if !is_defined(map) {
            return Ok(errors.into_iter().reduce(larger));
        }
        if !map.is_matrix_function() {
            let along = |state: Vec<f64>, i: usize| {
                self.frame.moved(&state, RetractionKind::Exponential, &self.axis(i, x[i]))
            };
            let (first, last) = (0..x.len(), (0..x.len()).rev());
            // what stands last in `τ` acts first where the group acts from the other side
            let [first, last] = [first.fold(self.state.clone(), along), last.fold(self.state.clone(), along)]
                .map(|axes| self.frame.distance(&axes, &there));
            errors.push(first.min(last));
            return Ok(errors.into_iter().reduce(larger));
        }
        for stored in self.matrices() {
            let Basis { basis, sign, .. } = self.basis(&stored)?;
            let (g, f) = (stored.matrix(&self.state), function(map, &combined(&basis, x))?);
            let expected = if sign > 0.0 { g * f } else { f * g };
            errors.push((stored.matrix(&there) - &expected).amax() / expected.amax());
        }
        Ok(errors.into_iter().reduce(larger))
    }

    fn on_the_group(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        Ok(Some(self.frame.system.deviation(&self.frame.moved(&self.state, map, x))))
    }

    /// `τ(−x) = τ(x)⁻¹`, of what is odd.
    fn inverse(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        if !map.is_matrix_function() {
            return Ok(None);
        }
        Ok(Some(self.frame.not_inverse(&self.state, map, x)))
    }

    /// `dR exp_x = φ₁(ad_x)`
    fn series(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        if map != RetractionKind::Exponential {
            return Ok(None);
        }
        let [measured, expected] = self.frame.d_right_exponential(&self.state, x)?;
        Ok(Some(relative((measured - &expected).amax(), expected.amax())))
    }

    /// `(dR τ_x)* m` of a kernel is that of the differences of displacements.
    fn derivative(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let Some(Unknown::Of { factor, unknown }) = self.unknown(map, x)? else { return Ok(None) };
        let right = |state: &[f64]| Ok(DVector::from_vec(self.value(map, state, &unknown)?.right));
        let inverse = factor.transpose().try_inverse().ok_or(Degenerate)?;
        let (found, expected) = (inverse * self.by_momentum(&right)?, self.d_right(map, x)?.transpose());
        Ok(Some(relative((found - &expected).amax(), expected.amax())))
    }

    /// `Ad_{τ(x)} = exp ad_z`, where `τ(x) = exp z`.
    fn adjoint_action(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let n = self.dimension();
        let ad = self.frame.coadjoint(&self.state, &self.zero_padded(&self.logarithm(map, x)?)).transpose();
        let expected = exponential(&ad.view((0, 0), (n, n)).into_owned())?;
        Ok(Some(relative((self.adjoint(map, x)? - &expected).amax(), expected.amax())))
    }

    /// `Ad*_{τ(x)} m` of a kernel is dual to `Ad_{τ(x)}`, and `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m` where `τ` is equivariant.
    fn coadjoint_action(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let n = self.dimension();
        let Some(Carried { x, before, after }) = self.carried(map, x)? else { return Ok(None) };
        let expected = self.adjoint(map, &x)?.transpose();
        let off = |carry: &DMatrix<f64>| (&after - carry * &before).amax();
        let mut error = off(&expected);
        if map.is_matrix_function() {
            let ad =
                self.frame.coadjoint(&self.state, &self.zero_padded(&x)).view((0, 0), (n, n)).into_owned();
            error = larger(error, off(&(DMatrix::identity(n, n) + ad * self.d_right(map, &x)?.transpose())));
        }
        Ok(Some(relative(error, expected.amax() * before.amax())))
    }

    /// Advected parameters are carried along by the exponential of the action of `z`, where `τ(x) = exp z`.
    fn spaces(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let (n, all) = (self.dimension(), self.frame.linear.len());
        let Some(Unknown::Of { unknown, .. }) = self.unknown(map, x)? else { return Ok(None) };
        if all == n {
            return Ok(None);
        }
        let next = self.value(map, &self.state, &unknown)?.next;
        let ad = self.frame.coadjoint(&self.state, &self.zero_padded(&self.logarithm(map, x)?));
        let carry = exponential(&ad.view((n, n), (all - n, all - n)).into_owned())?;
        let advected = |state: &[f64]| self.frame.linear_part(state).rows(n, all - n).into_owned();
        let expected = carry * advected(&self.state);
        Ok(Some(relative((advected(&next) - &expected).amax(), expected.amax())))
    }

    /// Casimirs are constant along the coadjoint action.
    fn casimirs(&self, map: RetractionKind, x: &DVector<f64>) -> Result<Option<f64>, Degenerate> {
        let next = match self.unknown(map, x)? {
            Some(Unknown::Of { unknown, .. }) if self.is_invariant => {
                self.value(map, &self.state, &unknown)?.next
            }
            Some(Unknown::None { next }) if self.is_invariant => next,
            _ => return Ok(None),
        };
        let (before, after) = (self.frame.system.casimirs(&self.state), self.frame.system.casimirs(&next));
        let change = |(before, after): (&f64, &f64)| (before - after).abs() / (1.0 + before.abs());
        Ok(before.iter().zip(&after).map(change).reduce(larger))
    }
}
