//! The attribute macro of `coadjoint`: one call into `coadjoint-codegen`.

use proc_macro::TokenStream;

/// The description of a mechanical system stands above a struct whose fields are the parameters, before any `#[derive(…)]`, and takes these
/// keys, of which only `group` must be there:
///
/// | key | meaning |
/// |---|---|
/// | `group = SO3` | where the configuration lives: `R1` … `R6`, `SO2`, `SO3`, `SE2`, `SE3`, `SU2`, families such as `SL(2)` and `SE2(3)`, `product(…)`, `semidirect(…)` and `tangent(…)` of them, `matrices { … }` with a basis of your own, or a group that `lie_group!` defines |
/// | `group(attitude: SO3, position: R3)` | several factors, each with a configuration and a momentum of its own; equal ones as an array, `group(spins: [SO3; 4])` |
/// | `advected(gamma: R3)` | vectors that are fixed in space, in body coordinates; or `adjoint`, `coadjoint`, `dual(R3)`, `matrices { … }` |
/// | `potential = weight * gamma.z` | the potential energy; the kinetic energy is that of the field marked `#[inertia]` |
/// | `hamiltonian = …` | any smooth energy, of the momentum too, in place of inertia and potential |
/// | `lagrangian = …` | any smooth Lagrangian of configuration and velocity, in place of inertia and potential; nothing is inverted by hand |
/// | `control(moment: R3, thrust: f64)` | inputs you pass to each step; constant during it |
/// | `force = moment`, `force(attitude = moment)` | forces and torques; of rigid motions also a pair, `(moment, push)`; on one of an array, `force(spins[0] = moment)`, or on all |
/// | `invariance = right` | momentum and velocity in space, in place of the body |
/// | `event(apogee = position.dot(&momentum), falling)` | events: quantities that may become zero, for `Run::on("apogee", …)`; behind each `rising`, `falling` or `both` |
/// | `methods(Midpoint, HamiltonJacobi(6), Family(1, 4), TangentLift)` | schemes to generate beside the standard ones |
/// | `retractions(Cayley)` | the retractions to generate steps with: `Exponential`, `Cayley`, `SecondKind`; without it the first two, on some groups of matrices one of them |
/// | `derivatives`, `derivatives(state, controls, parameters, tangent, adjoint)` | the derivatives of steps to generate, all or those named |
/// | `taylor` | power series of the motion, for Taylor steps to a tolerance: `top.adaptive(1e-12)` |
/// | `units(momentum = "N m s")` | the units of state and controls, for tables, plots and pages; of a parameter by `#[unit("kg m²")]` on its field |
/// | `scalar = f32` | the numbers of a system whose fields do not tell: `f64` otherwise |
/// | `crate = path::to::coadjoint` | where `coadjoint` is, if renamed or re-exported |
///
/// `#[inertia]` on a field, or `#[inertia(attitude)]` for some of the factors: a number, principal moments, or a symmetric positive definite
/// matrix. One field for several factors is their joint inertia, or that of each if it is only as long as one and all move on the same group; an
/// array has one for each.
/// Beside `hamiltonian` or `lagrangian` it is a parameter that is checked to be positive definite.
///
/// Expressions are ordinary Rust in the fields, the configuration (`attitude`, `position`, `angle`, `pose`, `spin`, or the names of factors), the
/// momentum (`momentum`, `attitude_momentum`; of rigid motions `angular_momentum` and `linear_momentum`), advected parameters, controls and the time `t`; in
/// forces also velocities; in a Lagrangian velocities in place of momenta. `coadjoint::guide::language` lists everything they may contain.
///
/// Beside the struct there are then its state, `…State`, its controls, `…Control`, indices of components for derivatives, `…Indices`, methods for
/// your expressions, `potential`, `hamiltonian`, `lagrangian` and `force`, and implementations of `coadjoint`'s traits, with `stepper`, `energy`, `casimirs` and
/// `validate`.
///
/// Mistakes are errors at your own tokens, all at once. A field, inertia or control that nothing depends on is a warning,
/// `PARAMETER_WITHOUT_EFFECT` or `CONTROL_WITHOUT_EFFECT`, which `#[allow(deprecated)]` on the field or the struct silences.
#[proc_macro_attribute]
pub fn lie_poisson_system(attribute: TokenStream, item: TokenStream) -> TokenStream {
    coadjoint_codegen::lie_poisson_system(attribute.into(), item.into()).into()
}

/// Lie groups of your own, for the systems of a crate: what `group = …` says, under a name.
///
/// ```text
/// lie_group! {
///     /// Maps of the plane that keep areas.
///     pub Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] };
///     /// The motions of a vehicle that carries a rotor.
///     Carrier = product(vehicle: SE3, rotor: SO2);
///     Shaped = semidirect(shape: Areas!, offset: R2);
///     Rates = tangent(SO3)
/// }
///
/// #[lie_poisson_system(group = Areas!, advected(v: dual(R2)), potential = v.norm_squared())]
/// ```
///
/// * `matrices { … }`: a basis of the Lie algebra, each matrix with the name of its coordinate; closed under the commutator.
/// * `product(name: group, …)`: the direct product.
/// * `semidirect(name: group, name: space, …)`: the group with vectors that it moves, `(g, v)(h, w) = (g h, v + g w)`.
/// * `tangent(group)`: the group of its positions and velocities, `TG`.
///
/// A name stands for a macro: `Areas!` is the group, elsewhere `groups::Areas!` by its path, and in other crates if it is `pub`. Elements are stored as matrices, of which
/// the rows of a product's factors are blocks. Mistakes in a basis are errors at its matrices. `coadjoint::assert_group_laws!(Areas!)` in a test holds what is
/// generated on the group to its laws.
#[proc_macro]
pub fn lie_group(input: TokenStream) -> TokenStream {
    coadjoint_codegen::lie_group(input.into()).into()
}

/// A function that expressions may call, of numbers, vectors and matrices.
///
/// ```text
/// #[expression]
/// fn density(height: f64) -> f64 {
///     SEA_LEVEL * (-height / SCALE).exp()
/// }
///
/// #[lie_poisson_system(group = R3, force = -drag * density(position.z) * velocity.norm() * velocity)]
/// ```
///
/// Its body is an expression as those of a description, in its arguments alone. It is differentiated as if it was written out where it is called.
/// A function without it is an error of the compiler's, "cannot find macro `density`". None is called `cos`, or as another method of numbers.
#[proc_macro_attribute]
pub fn expression(attribute: TokenStream, item: TokenStream) -> TokenStream {
    coadjoint_codegen::expression(attribute.into(), item.into()).into()
}

#[doc(hidden)]
#[proc_macro]
pub fn lie_poisson_system_with(input: TokenStream) -> TokenStream {
    coadjoint_codegen::lie_poisson_system_with(input.into()).into()
}

/// Calls a macro with the generator's table of retractions: of it the libraries make their types.
#[doc(hidden)]
#[proc_macro]
pub fn retractions(callback: TokenStream) -> TokenStream {
    coadjoint_codegen::library::retractions(callback.into()).into()
}

/// Calls a macro with the generator's table of methods.
#[doc(hidden)]
#[proc_macro]
pub fn methods(callback: TokenStream) -> TokenStream {
    coadjoint_codegen::library::methods(callback.into()).into()
}
