//! Symbolic systems to test with: as users describe them, with numbers for their symbols.

use coadjoint_codegen::check;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::model::{InertiaField, InertiaShape, System};
use coadjoint_codegen::parse::{Attribute, Item};
use coadjoint_codegen::program::Program;
use proc_macro2::TokenStream;
use quote::quote;

use super::formula::{Formula, Point};
use super::matrix::Column;
use super::real::Real;
use crate::random::Random;

/// A description: what stands in the attribute, and the struct.
pub struct Description {
    /// For messages.
    pub name: &'static str,
    attribute: TokenStream,
    item: TokenStream,
}

/// Free bodies and heavy tops on SO(3): each shape of inertia, up to two advected vectors, linear and nonlinear potentials.
pub fn rigid_bodies() -> Vec<Description> {
    let describe = |name, attribute, item| Description { name, attribute, item };
    vec![
        describe(
            "free body",
            quote! { group = SO3 },
            quote! { struct Body { #[inertia] inertia: Vector3<f64> } },
        ),
        describe(
            "free body with a full inertia",
            quote! { group = SO3 },
            quote! { struct Body { #[inertia] inertia: Matrix3<f64> } },
        ),
        describe(
            "heavy top",
            quote! { group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi) },
            quote! { struct Top { #[inertia] inertia: Vector3<f64>, weight: f64, chi: Vector3<f64> } },
        ),
        describe(
            "nonlinear top with a full inertia",
            quote! { group = SO3, advected(gamma: R3), potential = gamma.dot(&chi) + gamma.dot(&chi).powi(2) / 2.0 },
            quote! { struct Top { #[inertia] inertia: Matrix3<f64>, chi: Vector3<f64> } },
        ),
        describe(
            "nonlinear top in two fields",
            quote! {
                group = SO3,
                advected(gamma: R3, field: R3),
                potential = gamma.dot(&chi) + (field.dot(&moment) * gamma.dot(&moment)).sin()
            },
            quote! {
                struct Top { #[inertia] inertia: Vector3<f64>, chi: Vector3<f64>, moment: Vector3<f64> }
            },
        ),
    ]
}

/// Systems with advected vectors on the other groups, and of several factors: of coupled energies, with an inertia for each and with one
/// that factors share whose unknowns have different scales.
fn other_tops() -> Vec<Description> {
    let describe = |name, attribute, item| Description { name, attribute, item };
    vec![
        describe(
            "vane",
            quote! { group = SO2, advected(wind: R2), potential = wind.dot(&chi) + wind.x * wind.y },
            quote! { struct Vane { #[inertia] inertia: f64, chi: Vector2<f64> } },
        ),
        describe(
            "plate in the plane",
            quote! { group = SE2, advected(gamma: R2), potential = gamma.dot(&chi) + gamma.x * gamma.y },
            quote! { struct Plate { #[inertia] inertia: Matrix3<f64>, chi: Vector2<f64> } },
        ),
        describe(
            "heavy body in a fluid",
            quote! { group = SE3, advected(gamma: R3), potential = gamma.dot(&chi) + gamma.x * gamma.y },
            quote! { struct Body { #[inertia] inertia: Matrix6<f64>, chi: Vector3<f64> } },
        ),
        describe(
            "two tops",
            quote! {
                group(first: SO3, second: SO3),
                advected(gamma: second::R3, delta: first::R3, eta: second::R3),
                potential = gamma.dot(&chi) * delta.dot(&chi) + eta.x * delta.y
            },
            quote! {
                struct Tops {
                    #[inertia(first)] first_inertia: Vector3<f64>,
                    #[inertia(second)] second_inertia: Matrix3<f64>,
                    chi: Vector3<f64>
                }
            },
        ),
        describe(
            "spin and top with one inertia",
            quote! { group(spin: SU2, top: SO3), advected(gamma: R3), potential = gamma.dot(&chi) },
            quote! { struct Coupled { #[inertia] inertia: Matrix6<f64>, chi: Vector3<f64> } },
        ),
    ]
}

/// Systems that are left-invariant, on every group that acts on a space and on products of groups.
pub fn left_invariant() -> Vec<Description> {
    rigid_bodies().into_iter().chain(other_tops()).collect()
}

/// One system of every kind that a step can be of: groups, sides, couplings, energies, forces, controls and time.
pub fn all_kinds() -> Vec<Description> {
    let describe = |name, attribute, item| Description { name, attribute, item };
    let mut all = left_invariant();
    all.extend([
        describe(
            "driven pendulum with a control",
            quote! {
                group = SO2,
                potential = -weight * angle.cos_angle(),
                force(angle = -friction * momentum + Vector1::new(drive * t.sin() + push)),
                control(push: f64)
            },
            quote! { struct Pendulum { #[inertia] inertia: f64, weight: f64, friction: f64, drive: f64 } },
        ),
        describe(
            "quadrotor",
            quote! {
                group(attitude: SO3, position: R3),
                control(moment: R3, thrust: f64),
                potential = mass * gravity * position.z,
                force(attitude = moment, position = attitude * (thrust * Vector3::z()))
            },
            quote! {
                struct Quadrotor { #[inertia(attitude)] inertia: Vector3<f64>, #[inertia(position)] mass: f64, gravity: f64 }
            },
        ),
        describe(
            "coupled bodies",
            quote! {
                group(first: SO3, second: SO3),
                potential = {
                    let between = first.inverse() * second;
                    2.0 * stiffness * (1.0 - between.w.powi(2))
                }
            },
            quote! {
                struct Coupled {
                    #[inertia(first)] first_inertia: Vector3<f64>,
                    #[inertia(second)] second_inertia: Vector3<f64>,
                    stiffness: f64
                }
            },
        ),
        describe("body in the plane", quote! { group = SE2 }, quote! { struct Disk { #[inertia] inertia: Matrix3<f64> } }),
        describe("body in a fluid", quote! { group = SE3 }, quote! { struct Fish { #[inertia] inertia: Matrix6<f64> } }),
        describe("spin", quote! { group = SU2 }, quote! { struct Spin { #[inertia] inertia: Vector3<f64> } }),
        describe(
            "free body in space coordinates",
            quote! { group = SO3, invariance = right },
            quote! { struct Body { #[inertia] inertia: Vector3<f64> } },
        ),
        describe(
            "general energy",
            quote! {
                group = SO3,
                hamiltonian = (momentum.dot(&momentum) / (2.0 * mass) + 1.0).sqrt() + momentum.x * momentum.y / 5.0
            },
            quote! { struct Fast { mass: f64 } },
        ),
    ]);
    all.extend(lagrangians());
    all
}

/// Systems described by a Lagrangian: of mass matrices that depend on the configuration, of both sides, with advected parameters, forces and
/// time, and one whose velocity has no closed form.
pub fn lagrangians() -> Vec<Description> {
    let describe = |name, attribute, item| Description { name, attribute, item };
    vec![
        describe(
            "top by its lagrangian",
            quote! {
                group = SO3,
                advected(gamma: R3),
                lagrangian = velocity.dot(&(inertia * velocity)) / 2.0 - gamma.dot(&chi) + velocity.z * gamma.x / 5.0
            },
            quote! { struct Top { #[inertia] inertia: Matrix3<f64>, chi: Vector3<f64> } },
        ),
        describe(
            "double pendulum",
            quote! {
                group(angles: R2),
                lagrangian = {
                    let w = angles_velocity;
                    w.x.powi(2) + w.y.powi(2) / 2.0 + ratio * w.x * w.y * (angles.x - angles.y).cos() / 3.0
                        + weight * (2.0 * angles.x.cos() + ratio * angles.y.cos())
                }
            },
            quote! { struct Double { ratio: f64, weight: f64 } },
        ),
        describe(
            "body with a moving mass",
            quote! {
                group(attitude: SO3, slider: R1),
                control(push: f64),
                lagrangian = {
                    let at = slider.x * direction;
                    let v = attitude_velocity.cross(&at) + slider_velocity.x * direction;
                    attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) / 2.0 + v.norm_squared()
                        - stiffness * slider.x.powi(2) * (1.0 + t.sin() / 4.0) + attitude.w
                },
                force(slider = vector![push - slider_velocity.x / 3.0])
            },
            quote! {
                struct Body { #[inertia] inertia: Vector3<f64>, direction: Vector3<f64>, stiffness: f64 }
            },
        ),
        describe(
            "body seen from space by its lagrangian",
            quote! {
                group = SO3,
                invariance = right,
                lagrangian = {
                    let inside = attitude.inverse() * velocity;
                    inside.dot(&inside.component_mul(&inertia)) / 2.0 - attitude.w
                }
            },
            quote! { struct Body { #[inertia] inertia: Vector3<f64> } },
        ),
        describe(
            "stiff point",
            quote! {
                group = R2,
                lagrangian = (2.0 + mass * mass) * velocity.norm_squared() * (1.0 + velocity.norm_squared() / 8.0)
                    - position.x.sin() * position.y
            },
            quote! { struct Stiff { mass: f64 } },
        ),
    ]
}

impl Description {
    /// A description of its own: a name for messages, what stands in the attribute, and the struct.
    pub fn new(name: &'static str, attribute: TokenStream, item: TokenStream) -> Self {
        Self { name, attribute, item }
    }

    /// What is computed for it.
    pub fn program(&self) -> Program {
        let program = coadjoint_codegen::program(self.attribute.clone(), self.item.clone());
        program.expect("the descriptions have no problems")
    }

    /// The symbolic system.
    pub fn system<'a>(&self, arena: &'a Arena) -> System<'a> {
        let mut diagnostics = Diagnostics::new();
        let attribute =
            Attribute::parse(self.attribute.clone(), &coadjoint_codegen::method::known(), &mut diagnostics);
        let system = Item::parse(self.item.clone(), &mut diagnostics).and_then(|item| {
            let description = check::resolve(&attribute, &item, &mut diagnostics);
            System::build(arena, &description, &mut diagnostics)
        });
        diagnostics.finish().expect("the descriptions have no problems");
        system.expect("a description without problems is a system")
    }
}

/// Random parameters with a positive definite inertia, and a random state on the group.
pub fn random_point(system: &System<'_>, seed: u64) -> Point {
    let random = &mut Random::new(seed);
    let mut point = Point::default();
    let given = [system.time_symbol(), system.control_symbols()].concat();
    for symbols in [system.parameter_symbols(), system.state_symbols(), given] {
        point.set(&symbols, &Column::random(symbols.len(), random));
    }

    for field in &system.inertias {
        positive_definite(&mut point, field);
    }
    for (factor, algebra) in system.factors.iter().zip(&system.group.factors) {
        let group = algebra.group;
        let arena = Arena::new();
        let retract = Formula::new(&arena, [group.dimension()], |[x]| group.retract(Retraction::Cayley, &x));
        let g = retract.at([&Column::random(group.dimension(), random)]);
        point.set(&factor.configuration.symbols(), &g);
    }
    point
}

/// Gives the symbols of an inertia values that are dominated by a diagonal of distinct moments.
fn positive_definite(point: &mut Point, field: &InertiaField<'_>) {
    // one number stands in all rows
    let rows = if field.described.shape == InertiaShape::Scalar { 1 } else { field.matrix.rows };
    for i in 0..rows {
        for j in 0..=i {
            let symbol = field.matrix.at(i, j).as_symbol();
            let Some(symbol) = symbol.filter(|_| i == j || field.described.shape == InertiaShape::Matrix)
            else {
                continue;
            };
            let scattered = point.value(symbol) / Real::from(4);
            let diagonal = if i == j { Real::from(i as i64 + 1) } else { Real::from(0) };
            point.set(&[symbol], &Column(vec![diagonal + scattered]));
        }
    }
}
