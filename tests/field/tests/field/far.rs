//! Forces that balance and are large, or small beside the numbers that they are computed from: stiff springs, and what
//! happens far from the origin.

use coadjoint::Discretized;
use coadjoint::prelude::*;

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, walk};

/// Two craft on a tether, in orbit: the earth is at the origin.
#[lie_poisson_system(
    group(a: R3, b: R3),
    potential = {
        let stretch = (a - b).norm() - rest;
        -mu * mass * (1.0 / a.norm() + 1.0 / b.norm()) + stiffness * stretch.powi(2) / 2.0
    },
    methods(Midpoint),
)]
struct Tether {
    #[inertia(a, b)]
    mass: f64,
    mu: f64,
    stiffness: f64,
    rest: f64,
}

/// The same by its Lagrangian.
#[lie_poisson_system(
    group(a: R3, b: R3),
    lagrangian = {
        let stretch = (a - b).norm() - rest;
        mass * (a_velocity.norm_squared() + b_velocity.norm_squared()) / 2.0
            + mu * mass * (1.0 / a.norm() + 1.0 / b.norm()) - stiffness * stretch.powi(2) / 2.0
    },
    methods(Midpoint),
)]
struct Linked {
    mass: f64,
    mu: f64,
    stiffness: f64,
    rest: f64,
}

/// A body whose eye is held by a spring, with one pose.
#[lie_poisson_system(
    group = SE3,
    potential = {
        let away = pose.transform_point(&Point3::from(eye)).coords - hold;
        stiffness * away.norm_squared() / 2.0
    },
    methods(Midpoint),
)]
struct Held {
    #[inertia]
    inertia: Vector6<f64>,
    eye: Vector3<f64>,
    hold: Vector3<f64>,
    stiffness: f64,
}

/// The same with an attitude and a place.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    potential = {
        let away = position + attitude * eye - hold;
        stiffness * away.norm_squared() / 2.0
    },
    methods(Midpoint),
)]
struct HeldApart {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    eye: Vector3<f64>,
    hold: Vector3<f64>,
    stiffness: f64,
}

/// Of the earth, m³/s².
const MU: f64 = 3.986004418e14;

/// The momentum of 100 kg at this place that goes round the earth once in the time of an orbit of this radius.
fn round(place: Vector3<f64>, radius: f64) -> Vector3<f64> {
    100.0 * (MU / radius.powi(3)).sqrt() * Vector3::z().cross(&place)
}

/// Ten minutes at 7000 km, a kilometre apart and askew: the tether stays as long as it is, and turns.
fn on_a_tether<M>(runs: &mut Runs, stiffness: f64, step: f64, (length, angle): (f64, f64), bounds: (f64, f64))
where
    Tether: Discretized<M>,
{
    let what = format!("{}, {stiffness:e} N/m, step {step}", scheme::<M>());
    let (radius, half) = (7e6, 500.0 * vector![0.3_f64.cos(), 0.3_f64.sin(), 0.0]);
    let tether = Tether { mass: 100.0, mu: MU, stiffness, rest: 1_000.0 };
    let (a, b) = (radius * Vector3::x() + half, radius * Vector3::x() - half);
    let start = TetherState { a, a_momentum: round(a, radius), b, b_momentum: round(b, radius) };
    let end = walk::<M, _>(&tether, &start, step, (600.0 / step).round() as u64);
    let Some(end) = runs.end(&what, end) else { return };
    let along = end.a - end.b;
    runs.close(format!("{what}, length"), along.norm(), length, bounds.0);
    runs.close(format!("{what}, angle"), along.y.atan2(along.x), angle, bounds.1);
    let turning =
        |state: &TetherState| (state.a.cross(&state.a_momentum) + state.b.cross(&state.b_momentum)).z;
    let off = (turning(&end) - turning(&start)) / turning(&start);
    runs.close(format!("{what}, angular momentum"), off, 0.0, 1e-12);
}

/// Lengths and angles are those of the centre and the difference, each integrated by itself, so that nothing cancels.
#[test]
fn two_craft_on_a_tether() {
    let mut runs = Runs::default();
    let steel = (1_000.000_002_7, 0.785_015_429);
    on_a_tether::<Exponential>(&mut runs, 1e5, 0.01, steel, (1e-5, 2e-9));
    on_a_tether::<Midpoint>(&mut runs, 1e5, 0.01, steel, (1e-5, 2e-9));
    on_a_tether::<Midpoint>(&mut runs, 1e5, 0.1, steel, (1e-4, 2e-8));
    let rope = (999.999_782, 0.785_013_927);
    on_a_tether::<Midpoint>(&mut runs, 100.0, 0.01, rope, (1e-4, 2e-8));
    on_a_tether::<Midpoint>(&mut runs, 100.0, 0.1, rope, (1e-2, 2e-7));
    on_a_tether::<Midpoint>(&mut runs, 1.0, 0.1, (1_000.289_295, 0.784_865_064), (1e-3, 1e-6));
    runs.assert();
}

/// Ten metres apart along the radius: it stays so, but for what the tide of `3 n² ℓ` stretches the spring.
fn far_from_the_earth<M>(runs: &mut Runs)
where
    Linked: Discretized<M>,
{
    for radius in [7e6, 4.2e7, 1.5e11] {
        for stiffness in [1.0, 100.0, 1e4, 1e6] {
            for step in [1e-3, 0.01, 0.1] {
                let rate = (2.0 * stiffness / 100.0_f64).sqrt();
                // what the default can take
                if step * rate > 1.5 {
                    continue;
                }
                let what = format!("{}, radius {radius:e}, {stiffness:e} N/m, step {step}", scheme::<M>());
                let linked = Linked { mass: 100.0, mu: MU, stiffness, rest: 10.0 };
                let [a, b] = [radius + 5.0, radius - 5.0].map(|x| x * Vector3::x());
                let start = LinkedState { a, a_momentum: round(a, radius), b, b_momentum: round(b, radius) };
                let Some(end) = runs.end(&what, walk::<M, _>(&linked, &start, step, 1_000)) else { continue };
                let tide = 3.0 * MU / radius.powi(3) * 10.0;
                let stretch = tide * (2.0 / rate.powi(2)).min((1e3 * step).powi(2) / 2.0);
                // places are rounded in every step, and momenta with them; on the ring of the earth's orbit by 30 µm
                let rounding =
                    0.5 * f64::EPSILON * radius * 1e3_f64.sqrt() * (1.0 + step * rate * 1e3_f64.sqrt());
                runs.close(what, (end.a - end.b).norm(), 10.0, 1.5 * stretch + 8.0 * rounding);
            }
        }
    }
}

#[test]
fn craft_on_a_spring_far_from_the_origin() {
    let mut runs = Runs::default();
    far_from_the_earth::<Exponential>(&mut runs);
    far_from_the_earth::<Midpoint>(&mut runs);
    runs.assert();
}

/// Whatever holds it may be anywhere: from the same place beside it, a body moves as at the origin, but for the
/// rounding of its place.
fn held_far_away<M>(runs: &mut Runs)
where
    Held: Discretized<M>,
    HeldApart: Discretized<M>,
{
    let (eye, steps) = (vector![0.5, 0.2, 0.0], 1_000);
    let (turned, beside) = (vector![0.1, 0.2, 0.0], vector![-0.4, -0.1, 0.05]);
    for stiffness in [10.0, 1e4] {
        let mut near: Option<[UnitQuaternion<f64>; 2]> = None;
        for far in [0.0, 1e3, 7e6] {
            let what = format!("{}, {far:e} m away, {stiffness:e} N/m", scheme::<M>());
            let hold = far * Vector3::x();
            let held = Held { inertia: vector![1.0, 2.0, 3.0, 100.0, 100.0, 100.0], eye, hold, stiffness };
            let start = HeldState { pose: Isometry3::new(hold + beside, turned), momentum: Vector6::zeros() };
            let together = runs.end(&what, walk::<M, _>(&held, &start, 0.01, steps));
            let held = HeldApart { inertia: vector![1.0, 2.0, 3.0], mass: 100.0, eye, hold, stiffness };
            let start = HeldApartState {
                attitude: UnitQuaternion::new(turned),
                attitude_momentum: Vector3::zeros(),
                position: hold + beside,
                position_momentum: Vector3::zeros(),
            };
            let apart = runs.end(&what, walk::<M, _>(&held, &start, 0.01, steps));
            let (Some(together), Some(apart)) = (together, apart) else { continue };
            let ends = [together.pose.rotation, apart.attitude];
            for (end, near) in ends.iter().zip(near.get_or_insert(ends)) {
                let bound = 1e-10 + 50.0 * f64::EPSILON * far * stiffness;
                runs.close(&what, end.angle_to(near), 0.0, bound);
            }
        }
    }
}

#[test]
fn a_body_that_is_held_far_away() {
    let mut runs = Runs::default();
    held_far_away::<Exponential>(&mut runs);
    held_far_away::<Midpoint>(&mut runs);
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![Subject::of(
        Tether { mass: 100.0, mu: MU, stiffness: 10.0, rest: 1_000.0 },
        &TetherState {
            a: vector![7e6, 0.0, 0.0],
            a_momentum: vector![0.0, 7.5e5, 0.0],
            b: vector![7.001e6, 0.0, 0.0],
            b_momentum: vector![0.0, 7.5e5, 10.0],
        },
    )]
}
