use nalgebra::Matrix6;

use super::*;
use crate::error::RunError;
use crate::tests::catalogue;

fn set(assignments: &[&str]) -> Result<(Setup, Vec<String>), String> {
    set_in("heavy_top", assignments)
}

fn set_in(system: &str, assignments: &[&str]) -> Result<(Setup, Vec<String>), String> {
    let entry = catalogue().find(system).expect("it is there");
    let mut changes = Changes::of(entry);
    let assignments: Vec<String> = assignments.iter().map(|&a| a.to_owned()).collect();
    let finished = changes.apply(&assignments).map_err(RunError::from).and_then(|()| changes.finish());
    finished.map_err(|error| error.to_string())
}

#[test]
fn quantities_components_and_scalars_are_set() {
    let (setup, notes) =
        set(&["inertia=2, 3,4", "chi_y=-0.5", "weight=1e1", "momentum=1,2,3", "gamma_x=7"]).expect("valid");
    assert_eq!(setup.parameters, [2.0, 3.0, 4.0, 10.0, 0.0, -0.5, 1.0]);
    assert_eq!(setup.state, [1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 7.0, 0.0, 1.0]);
    assert_eq!(notes, ["`|gamma|²` is 50, in the example 1"]);
}

#[test]
fn an_attitude_is_normalised() {
    let (setup, notes) = set(&["attitude=0,3,0,4", "inertia=1,1,1"]).expect("valid");
    assert_eq!(setup.state[..4], [0.0, 0.6, 0.0, 0.8]);
    assert_eq!(notes[0], "`attitude` had length 5 and was normalised");
    // also where squares would overflow or vanish
    for scale in ["1e200", "1e-200"] {
        let (setup, _) = set(&[&format!("attitude=0,0,0,{scale}")]).expect("valid");
        assert_eq!(setup.state[..4], [0.0, 0.0, 0.0, 1.0]);
    }
    assert!(set(&["attitude=0,0,0,0"]).expect_err("no rotation").contains("cannot be zero"));
}

#[test]
fn rotations_in_the_plane_and_in_rigid_motions_are_normalised() {
    let (setup, notes) = set_in("planar_pendulum", &["angle=3,4"]).expect("valid");
    assert_eq!(setup.state, [0.6, 0.8, 0.0]);
    assert_eq!(notes, ["`angle` had length 5 and was normalised"]);
    let message = set_in("planar_pendulum", &["angle=0,0"]).expect_err("no rotation");
    assert!(message.contains("no rotation is 1,0"), "{message}");

    let (setup, notes) = set_in("rigid_body_in_space", &["pose=0,0,2,0,5,6,7"]).expect("valid");
    assert_eq!(setup.state[..7], [0.0, 0.0, 1.0, 0.0, 5.0, 6.0, 7.0]);
    assert_eq!(notes, ["`pose` had length 2 and was normalised"]);
    assert!(set_in("rigid_body_in_space", &["pose=0,0,0,0,1,2,3"]).is_err());
    // the first components of a momentum are none
    let (setup, notes) = set_in("kepler", &["momentum=1,2,3"]).expect("valid");
    assert_eq!((&setup.state[3..], notes.len()), (&[1.0, 2.0, 3.0][..], 0));
}

#[test]
fn mistakes_are_explained() {
    for (assignment, expected) in [
        ("wieght=1", "did you mean `weight`?"),
        ("weight", "has no `=`"),
        ("chi=1,2", "takes 3 numbers separated by commas, got 2"),
        ("weight=1,2", "takes one number, got 2"),
        ("chi=1,two,3", "`two` is not a number"),
        ("chi=1,,3", "`` is not a number"),
        (
            "attitude=rotvec:0,0,90deg",
            "`90deg` is not a number (in `attitude=rotvec:0,0,90deg`): angles are numbers, in rad",
        ),
        ("momentum=1,NaN,3", "must be finite, got `NaN`"),
        ("weight=inf", "must be finite"),
        ("inertia=1,-2,3", "not positive definite"),
    ] {
        let message = set(&[assignment]).expect_err(assignment);
        assert!(message.contains(expected), "{assignment}: {message}");
    }
}

/// The rotation matrix of turns about x, then y, then z of space, by hand.
fn euler_matrix([roll, pitch, yaw]: [f64; 3]) -> Matrix3<f64> {
    let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(f64::sin_cos);
    Matrix3::new(
        cy * cp,
        cy * sp * sr - sy * cr,
        cy * sp * cr + sy * sr,
        sy * cp,
        sy * sp * sr + cy * cr,
        sy * sp * cr - cy * sr,
        -sp,
        cp * sr,
        cp * cr,
    )
}

#[test]
fn rotations_are_read_and_written_in_their_forms() {
    let matrix = |q: &[f64]| {
        let rotation =
            nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
        rotation.to_rotation_matrix().into_inner()
    };
    let column = |column: Column, state: &[f64]| {
        let entry = catalogue().find("heavy_top").expect("it is there");
        let mut row = Vec::new();
        column.push((entry, &*entry.system(&entry.example.parameters)), (state, 0.0, &[]), &mut row);
        row
    };
    let near = |found: &[f64], expected: &[f64]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
    };
    let (setup, _) = set(&["attitude=euler: 0.3,-0.2,1.1"]).expect("valid");
    assert!((matrix(&setup.state) - euler_matrix([0.3, -0.2, 1.1])).amax() < 1e-15);
    near(&column(Column::Euler, &setup.state), &[0.3, -0.2, 1.1]);
    // a turn of 2 rad about (2, -1, 2)/3
    let (sin, cos) = 1.0_f64.sin_cos();
    let turned = [cos, sin * 2.0 / 3.0, -sin / 3.0, sin * 2.0 / 3.0];
    let (rotvec, mrp) = ([4.0 / 3.0, -2.0 / 3.0, 4.0 / 3.0], 0.5_f64.tan() / 3.0);
    for (form, numbers) in [("rotvec", rotvec), ("mrp", [2.0 * mrp, -mrp, 2.0 * mrp])] {
        let [x, y, z] = numbers;
        let (setup, _) = set(&[&format!("attitude={form}:{x},{y},{z}")]).expect("valid");
        near(&setup.state[..4], &turned);
        let is = if form == "mrp" { Column::Mrp } else { Column::Rotvec };
        near(&column(is, &setup.state), &numbers);
        // the other sign of the quaternion is the same rotation
        near(&column(is, &turned.map(|x| -x)), &numbers);
    }
    // of a rigid motion, with its position; in the plane by an angle
    let (setup, _) = set_in("rigid_body_in_space", &["pose=rotvec:0,0,2,5,6,7"]).expect("valid");
    near(&setup.state[..7], &[cos, 0.0, 0.0, sin, 5.0, 6.0, 7.0]);
    let (setup, _) = set_in("planar_pendulum", &["angle=1"]).expect("valid");
    near(&setup.state[..2], &[cos, sin]);
    for (assignment, expected) in [
        ("attitude=euler:1,2", "`attitude=euler:…` takes 3 numbers separated by commas, got 2 numbers"),
        ("attitude=1,2", "in other forms `attitude=euler:…`"),
        ("attitude=quat:1,2,3", "there is no form `quat`"),
        ("momentum=euler:1,2,3", "`momentum` is no rotation in space"),
        ("attitude_w=mrp:1,2,3", "is no rotation in space"),
    ] {
        let message = set(&[assignment]).expect_err(assignment);
        assert!(message.contains(expected), "{assignment}: {message}");
    }
}

#[test]
fn a_symmetric_matrix_is_its_triangle_or_its_diagonal() {
    let inertia = |of: &str| {
        set_in("rigid_body_in_space", &[&format!("inertia={of}")]).map(|(setup, _)| setup.parameters)
    };
    let diagonal = inertia("1,2,3,4,5,6").expect("six of six rows");
    assert_eq!(
        Matrix6::from_row_slice(&diagonal),
        Matrix6::from_diagonal(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0].into())
    );
    let triangle = "10,1,2,3,4,5, 20,6,7,8,9, 30,1,2,3, 40,4,5, 50,6, 60";
    let matrix = Matrix6::from_row_slice(&inertia(triangle).expect("positive definite"));
    assert_eq!(matrix, matrix.transpose());
    assert_eq!(
        [(0, 5), (1, 2), (2, 5), (3, 4), (4, 5), (5, 5)].map(|at| matrix[at]),
        [5.0, 6.0, 3.0, 4.0, 6.0, 60.0]
    );
    let message = inertia("1,2,3").expect_err("of three rows");
    assert!(
        message.contains("takes 36 numbers") && message.contains("21 are its upper triangle"),
        "{message}"
    );
}

#[test]
fn velocities_are_given_in_place_of_momenta() {
    let (setup, _) = set(&["velocity=3,0.5,-0.25", "inertia=2,3,4"]).expect("valid");
    assert_eq!(setup.state[4..7], [6.0, 1.5, -1.0]);
    // components that are not given keep their velocity: 1/1 and 1/100
    let (setup, _) = set(&["velocity_y=2"]).expect("valid");
    assert_eq!(setup.state[4..7], [1.0, 20.0, 1.0]);
    let message = set(&["velocity=1,2,3", "momentum_x=1"]).expect_err("both");
    assert!(message.contains("`momentum` and a velocity are given"), "{message}");
    assert!(set(&["velocty=1,2,3"]).expect_err("misspelt").contains("did you mean `velocity`?"));
    let entry = catalogue().find("heavy_top").expect("it is there");
    assert_eq!(
        Column::Velocity.names(entry).expect("it has one"),
        ["velocity_x", "velocity_y", "velocity_z"]
    );
    let mut row = Vec::new();
    let system = entry.system(&entry.example.parameters);
    Column::Velocity.push((entry, &*system), (&setup.state, 0.0, &[]), &mut row);
    assert_eq!(row, [1.0, 2.0, 0.01]);
    assert!(Column::Angle.names(entry).expect_err("none").to_string().contains("no rotation in the plane"));
}

#[test]
fn steps_lead_to_the_end_of_a_run() {
    for (duration, step, expected) in [
        (1.0, 0.25, (4, 0.0)),
        (1.0, -0.3, (3, 1.0 - 3.0 * 0.3)),
        (0.3, 0.1, (3, 0.0)),
        (0.7, 1.0, (0, 0.7)),
        (0.0, 1.0, (0, 0.0)),
        (1e9, 1e-3, (1_000_000_000_000, 0.0)),
    ] {
        assert_eq!(Job::steps_to(duration, step), Ok(expected));
        let (steps, rest) = expected;
        let (method, retraction, order) = (Method::Standard, Retraction::Cayley, Order::Two);
        let job = Job { method, retraction, order, step, steps, rest };
        // what is written down leads to the same steps
        assert_eq!(Job::steps_to(job.duration(), step), Ok(expected));
    }
}

#[test]
fn an_inertia_that_no_body_has_is_noted() {
    let (_, notes) = set(&["inertia=1,10,101"]).expect("valid all the same");
    assert!(notes[0].contains("the largest exceeds the sum of the others"), "{notes:?}");
    // but not where it is the example's
    assert_eq!(set(&["weight=2"]).expect("valid").1, [""; 0]);
}

/// A rigid body in space that sees a direction of space.
#[coadjoint::prelude::lie_poisson_system(
    group = SE3,
    advected(field: R3),
    potential = strength * field.z,
    retractions(Cayley)
)]
struct Floating {
    #[inertia]
    inertia: coadjoint::prelude::Matrix6<f64>,
    strength: f64,
}

/// A system of a plane that is described in space: displacements are from the other side.
#[coadjoint::prelude::lie_poisson_system(
    group = SO3,
    invariance = right,
    advected(field: R3),
    potential = strength * field.z,
    retractions(Cayley)
)]
struct InSpace {
    #[inertia]
    inertia: f64,
    strength: f64,
}

mod examples {
    use coadjoint::prelude::*;

    use super::{Floating, FloatingState, InSpace, InSpaceState};

    impl crate::Example for Floating {
        fn example() -> (Self, FloatingState) {
            let turn = vector![0.3, -0.2, 0.5];
            let start = FloatingState {
                pose: Isometry3::new(vector![1.0, 2.0, 3.0], turn),
                momentum: Vector6::zeros(),
                field: vector![0.6, 0.0, 0.8],
            };
            (Floating { inertia: Matrix6::identity(), strength: 1.0 }, start)
        }
    }

    impl crate::Example for InSpace {
        fn example() -> (Self, InSpaceState) {
            let attitude = UnitQuaternion::from_scaled_axis(vector![0.3, -0.2, 0.5]);
            let start =
                InSpaceState { attitude, momentum: vector![0.0, 0.0, 1.0], field: vector![0.6, 0.0, 0.8] };
            (InSpace { inertia: 1.0, strength: 1.0 }, start)
        }
    }
}

/// An advected vector is the image of one that is fixed in space: `γ = R⁻¹ v`.
#[test]
fn advected_vectors_turn_with_an_attitude_that_is_set() {
    use coadjoint::prelude::{UnitQuaternion, Vector3};
    let quaternion =
        |q: &[f64]| UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
    for attitude in ["0.6,0.8,0,0", "1,2,3,4", "-1,0,0,0.001", "0,1,0,0", "0.5,-0.5,0.5,-0.5"] {
        let (setup, notes) = set(&[&format!("attitude={attitude}"), "chi=0,0.5,1"]).expect("valid");
        // the third row of the rotation matrix: the vertical, with one rounding for each product
        let [w, x, y, z] = setup.state[..4] else { panic!("an attitude") };
        let gamma = 2.0 * Vector3::new(x * z - w * y, y * z + w * x, 0.5 - x * x - y * y);
        assert!(
            (gamma - Vector3::from_column_slice(&setup.state[7..])).norm() < 4e-16,
            "{attitude}: {setup:?}"
        );
        let is_turned = gamma.z < 1.0;
        let note = "`gamma` is fixed in space and turns with `attitude`: it is ";
        assert_eq!(notes.iter().any(|other| other.starts_with(note)), is_turned, "{notes:?}");
    }
    // from another attitude than none, with a position
    let entry = <Floating as crate::Example>::entry();
    let field = |state: &[f64]| Vector3::from_column_slice(&state[13..]);
    let fixed = quaternion(&entry.example.state[..4]) * field(&entry.example.state);
    for pose in [[0.6, 0.8, 0.0, 0.0, 7.0, 8.0, -9.0], [-0.6, 0.0, 0.8, 0.0, 1.0, 2.0, 3.0]] {
        let mut changes = Changes::of(&entry);
        changes.assign(Names::STATE, "pose", &pose).expect("valid");
        let (setup, _) = changes.finish().expect("valid");
        let expected = quaternion(&setup.state[..4]).inverse() * fixed;
        assert!((field(&setup.state) - expected).norm() < 1e-14, "{pose:?}: {setup:?}");
    }
    // described in space, vectors of the body are advected: `a = R v`
    let entry = <InSpace as crate::Example>::entry();
    let field = |state: &[f64]| Vector3::from_column_slice(&state[7..]);
    let fixed = quaternion(&entry.example.state[..4]).inverse() * field(&entry.example.state);
    let mut changes = Changes::of(&entry);
    changes.assign(Names::STATE, "attitude", &[0.1, 0.7, -0.1, 0.7]).expect("valid");
    let (setup, _) = changes.finish().expect("valid");
    let expected = quaternion(&setup.state[..4]) * fixed;
    assert!((field(&setup.state) - expected).norm() < 1e-14, "{setup:?} {expected}");
}

#[test]
fn what_is_given_stays_as_it_is_given() {
    let (setup, notes) = set(&["attitude=0.6,0.8,0,0", "gamma=0,0,1", "inertia=1,1,1"]).expect("valid");
    assert_eq!((&setup.state[7..], notes.len()), (&[0.0, 0.0, 1.0][..], 0));
    // that of the example
    let (setup, notes) = set(&["attitude=1,0,0,0", "inertia=1,1,1"]).expect("valid");
    assert_eq!((&setup.state[7..], notes.len()), (&[0.0, 0.0, 1.0][..], 0));
    let (_, notes) = set(&["gamma=0,0,2", "inertia=1,1,1"]).expect("valid");
    assert_eq!(notes, ["`|gamma|²` is 4, in the example 1"]);
    // which says nothing of a momentum
    let (_, notes) = set(&["momentum=0,0,2", "inertia=1,1,1"]).expect("valid");
    assert_eq!(notes, [""; 0]);
}

#[test]
fn rigid_motions_are_reached_by_a_turn_and_a_shift() {
    let entry = catalogue().find("rigid_body_in_space").expect("it is there");
    let system = entry.system(&entry.example.parameters);
    let from = &entry.example.state;
    let mut to = from.clone();
    to[..7].copy_from_slice(&[0.5, -0.5, 0.5, 0.5, 1.0, -2.0, 30.0]);
    let moved = transport::moved(&*system, from, &to).expect("there is a way");
    for (reached, wanted) in moved.iter().zip(&to) {
        assert!((reached - wanted).abs() < 1e-13, "{moved:?}");
    }
}

fn variation(system: &str, spreads: &[&str]) -> Result<(Variation, Setup), String> {
    let entry = catalogue().find(system).expect("it is there");
    let spreads: Vec<String> = spreads.iter().map(|&spread| spread.to_owned()).collect();
    let variation = Variation::parse(entry, &entry.example, &spreads).map_err(|error| error.to_string())?;
    Ok((variation, entry.example.clone()))
}

/// So many members, and the ranges drawn.
fn members(system: &str, spreads: &[&str], count: usize) -> (Vec<Setup>, Vec<SampledRange>) {
    let entry = catalogue().find(system).expect("it is there");
    let (variation, setup) = variation(system, spreads).expect("valid");
    let mut ranges = variation.ranges(entry, &setup);
    let members = (0..count).map(|member| ranges.member(7, member, &mut Vec::new())).collect();
    (members, ranges.finish())
}

#[test]
fn percents_are_of_each_component() {
    let (members, drawn) = members("heavy_top", &["inertia=1%", "momentum=2%"], 2000);
    // a hundredth of 1, 10, 100; the ends are reached but for a few thousandths
    for (i, size) in [1.0, 10.0, 100.0].into_iter().enumerate() {
        let off: Vec<f64> = members.iter().map(|member| (member.parameters[i] / size - 1.0) / 0.01).collect();
        let (least, greatest) = off.iter().fold((0.0, 0.0), |(a, b): (f64, f64), &x| (a.min(x), b.max(x)));
        assert!(
            (-1.0 - 1e-12..-0.99).contains(&least) && (0.99..1.0 + 1e-12).contains(&greatest),
            "{least} {greatest}"
        );
        // evenly: mean 0 and deviation 1/√3, within four standard errors
        let mean = off.iter().sum::<f64>() / 2000.0;
        let variance = off.iter().map(|x| x * x).sum::<f64>() / 2000.0;
        assert!(mean.abs() < 0.05 && (variance - 1.0 / 3.0).abs() < 0.03, "{mean} {variance}");
        assert_eq!(drawn[i].name, ["inertia_x", "inertia_y", "inertia_z"][i]);
        assert_eq!(drawn[i].unit, "kg m²");
        let (from, to) = drawn[i].range;
        assert!(
            (from - size * (1.0 + 0.01 * least)).abs() < 1e-12
                && (to - size * (1.0 + 0.01 * greatest)).abs() < 1e-12
        );
    }
    assert_eq!(drawn.len(), 6);
}

#[test]
fn members_are_the_same_however_many_there_are() {
    let spreads = ["inertia=1%", "attitude=5deg"];
    let (few, _) = members("heavy_top", &spreads, 3);
    let (many, _) = members("heavy_top", &spreads, 10);
    assert_eq!(few, many[..3]);
    // what else varies makes no difference
    let (alone, _) = members("heavy_top", &["attitude=5deg"], 3);
    assert_eq!(alone[2].state, many[2].state);
    assert_ne!(many[0], many[1]);
}

/// Rotation vectors fill a ball evenly: a part `r³` of them is within `r` of the width; gamma turns along.
#[test]
fn attitudes_are_turned_about_any_axis() {
    use coadjoint::prelude::Vector3;
    let (members, drawn) = members("heavy_top", &["attitude=10deg"], 2000);
    let width = 10_f64.to_radians();
    let (mut sum, mut within) = (Vector3::zeros(), 0);
    for member in &members {
        let [w, x, y, z] = member.state[..4] else { panic!("{member:?}") };
        assert!(((w * w + x * x + y * y + z * z).sqrt() - 1.0).abs() < 4.0 * f64::EPSILON);
        let attitude = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
        let turn = attitude.scaled_axis() / width;
        assert!(turn.norm() <= 1.0 + 1e-12, "{turn}");
        within += usize::from(turn.norm() < 0.5);
        sum += turn;
        let gamma = attitude.inverse() * Vector3::z();
        assert!((gamma - Vector3::from_column_slice(&member.state[7..])).norm() < 4e-16);
        assert_eq!(member.state[4..7], [1.0, 1.0, 1.0]);
    }
    // an eighth, and no direction before others
    assert!((within as f64 / 2000.0 - 0.125).abs() < 0.03, "{within}");
    assert!((sum / 2000.0).norm() < 0.04, "{sum}");
    let [SampledRange { name, unit: "°", range: (from, to) }] = &drawn[..] else { panic!("{drawn:?}") };
    assert!(name == "attitude" && *from < 2.0 && (9.9..=10.0 + 1e-12).contains(to), "{drawn:?}");
}

#[test]
fn rotations_of_the_plane_and_of_rigid_motions_are_turned() {
    let (members, drawn) = members("planar_pendulum", &["angle=0.1rad"], 500);
    let angles: Vec<f64> =
        members.iter().map(|member| member.state[1].atan2(member.state[0]) - 1.0).collect();
    let (least, greatest) = angles.iter().fold((0.0, 0.0), |(a, b): (f64, f64), &x| (a.min(x), b.max(x)));
    assert!(
        least < -0.098 && greatest > 0.098 && angles.iter().all(|angle| angle.abs() <= 0.1 + 1e-15),
        "{least} {greatest}"
    );
    assert_eq!(drawn[0].unit, "rad");
    let (members, _) = self::members("rigid_body_in_space", &["pose=20deg", "pose_px=0.5"], 100);
    for member in members {
        let length = member.state[..4].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 4.0 * f64::EPSILON && member.state[0] > 0.98);
        assert!(member.state[4].abs() <= 0.5 && member.state[5..7] == [0.0, 0.0]);
    }
}

#[test]
fn symmetric_matrices_stay_symmetric() {
    for spread in ["inertia=0.01", "inertia_angular_x_angular_y=0.01", "inertia=1%"] {
        let (_, setup) = variation("rigid_body_in_space", &[spread]).expect("valid");
        let (members, drawn) = members("rigid_body_in_space", &[spread], 50);
        for member in &members {
            for (i, j) in (0..6).flat_map(|i| (0..i).map(move |j| (i, j))) {
                assert_eq!(member.parameters[6 * i + j], member.parameters[6 * j + i]);
            }
            assert_ne!(member.parameters, setup.parameters, "{spread}");
        }
        let expected = [("inertia=0.01", 21), ("inertia_angular_x_angular_y=0.01", 1), ("inertia=1%", 6)];
        assert!(expected.contains(&(spread, drawn.len())), "{spread}: {drawn:?}");
    }
}

/// Last digits that are off, as those of single precision, are no reason to draw mirrored entries apart.
#[test]
fn inertias_that_are_nearly_symmetric_are_drawn_so() {
    let entry = catalogue().find("rigid_body_in_space").expect("it is there");
    let mut setup = entry.example.clone();
    setup.parameters[1] += 1e-9;
    let variation = Variation::parse(entry, &setup, &["inertia=0.01".to_owned()]).expect("valid");
    let member = variation.member(entry, &setup, 7, 0).parameters;
    assert_eq!(member[1], member[6]);
    assert!((member[1] - setup.parameters[1]).abs() > 1e-6);
}

#[test]
fn spreads_are_told_in_words() {
    let words =
        |system, spread: &str| variation(system, &[spread]).map(|(variation, _)| variation.words[0].clone());
    for (spread, expected) in [
        ("inertia=1%", "inertia ±1 % of each component"),
        ("weight=2 %", "weight ±2 %"),
        ("inertia=1,2,3%", "inertia ±(1, 2, 3) % of each component"),
        ("momentum=0.01", "momentum ±0.01 kg m²/s"),
        ("momentum_z=0.01 kg m²/s", "momentum_z ±0.01 kg m²/s"),
        ("chi=0,0,0.1m", "chi ±(0, 0, 0.1) m"),
        ("gamma=0.1", "gamma ±0.1"),
        ("attitude=5deg", "attitude turned by up to 5°"),
        ("attitude=5.7°", "attitude turned by up to 5.7°"),
        ("attitude=0.1 rad", "attitude turned by up to 0.1 rad"),
    ] {
        assert_eq!(words("heavy_top", spread).as_deref(), Ok(expected), "{spread}");
    }
    let (variation, _) = variation("planar_pendulum", &["momentum=1%"]).expect("valid");
    assert_eq!(variation.notes, ["`--spread momentum=1%` spreads nothing: `momentum` is zero"]);
    let (variation, _) = self::variation("heavy_top", &["momentum=0%"]).expect("valid");
    assert!(variation.notes.is_empty());
}

#[test]
fn spreads_that_mean_nothing_are_refused() {
    for (system, spread, expected) in [
        ("heavy_top", "momentum", "has no `=`"),
        ("heavy_top", "momentun=1", "did you mean `momentum`?"),
        ("heavy_top", "momentum=-1", "must be finite and not negative"),
        ("heavy_top", "momentum=inf", "must be finite and not negative"),
        ("heavy_top", "momentum=1,2", "takes 3 numbers separated by commas or one, got 2"),
        ("heavy_top", "momentum=x", "`x` is not a number"),
        ("heavy_top", "momentum=", "`` is not a number"),
        ("heavy_top", "chi=2mm", "`mm` is not the unit of `chi`, which is m"),
        ("heavy_top", "gamma=2mm", "`mm` is no unit of `gamma`, which is a pure number"),
        ("heavy_top", "momentum=2deg", "`deg` is not the unit of `momentum`, which is kg m²/s"),
        ("heavy_top", "attitude=1%", "write `attitude=5deg` or `attitude=0.1rad`"),
        ("heavy_top", "attitude=1", "write `attitude=5deg` or `attitude=0.1rad`"),
        ("heavy_top", "attitude=1,2,3deg", "write `attitude=5deg`"),
        ("heavy_top", "attitude_w=0.1", "cannot vary one by one; write `attitude=5deg`"),
        ("rigid_body_in_space", "pose_x=0.1", "cannot vary one by one; write `pose=5deg`"),
        ("planar_pendulum", "torque=1", "has no parameter or state quantity `torque`"),
    ] {
        let message = variation(system, &[spread]).expect_err(spread);
        assert!(message.contains(expected), "{spread}: {message}");
    }
}

#[test]
fn where_energy_is_no_number_nothing_starts() {
    for (system, assignment) in [("kepler", "position=0,0,0"), ("heavy_top", "momentum=1e200,1e200,1e200")] {
        let message = set_in(system, &[assignment]).expect_err(assignment);
        assert!(message.contains("the energy of the initial state is"), "{message}");
    }
}
