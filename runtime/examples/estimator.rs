//! Where does a spacecraft point, and how does it turn? `cargo run --example estimator`
//!
//! A Kalman filter sees two stars with noise, once a second. The error is `(δ, δΠ)`: the true attitude is the estimated one times `exp(δ)`, the
//! true momentum the estimated one plus `δΠ`. These are the coordinates of the Jacobian of a step.

use coadjoint::derivative::WrtState;
use coadjoint::ensemble::normal;
use coadjoint::prelude::*;

/// A spacecraft on which nothing acts.
#[lie_poisson_system(group = SO3, retractions(Cayley), derivatives(state))]
struct Spacecraft {
    /// Principal moments of inertia, kg m².
    #[inertia]
    inertia: Vector3<f64>,
}

/// Standard deviations: of the first guess, rad and kg m²/s, and of each component of a measured direction.
const GUESS: [f64; 2] = [0.1, 0.2];
const STAR: f64 = 5e-3;

/// What the filter knows: an estimate, and the covariance of its error.
struct Filter {
    state: SpacecraftState,
    covariance: Matrix6<f64>,
}

impl Filter {
    /// Takes in a direction measured in the body, of a star in a known direction in space.
    fn update(&mut self, star: &Vector3<f64>, seen: &Vector3<f64>) -> Option<()> {
        // a small turn δ of the body changes the direction by `expected × δ`
        let expected = self.state.attitude.inverse() * star;
        let mut sensitivity = coadjoint::nalgebra::Matrix3x6::zeros();
        sensitivity.fixed_columns_mut::<3>(0).copy_from(&expected.cross_matrix());
        let noise = Matrix3::from_diagonal_element(STAR * STAR);
        let innovation = sensitivity * self.covariance * sensitivity.transpose() + noise;
        let gain = self.covariance * sensitivity.transpose() * innovation.try_inverse()?;
        let correction = gain * (seen - expected);
        self.state.attitude *= UnitQuaternion::new(correction.fixed_rows::<3>(0).into_owned());
        self.state.momentum += correction.fixed_rows::<3>(3);
        // Joseph's form: it stays positive definite
        let kept = Matrix6::identity() - gain * sensitivity;
        self.covariance = kept * self.covariance * kept.transpose() + gain * noise * gain.transpose();
        Some(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let craft = Spacecraft { inertia: vector![1.0, 2.0, 2.5] };
    let attitude = UnitQuaternion::new(vector![0.4, -0.2, 0.7]);
    let mut truth = SpacecraftState { attitude, momentum: vector![0.2, -0.3, 0.15] };
    let deviations = [GUESS[0], GUESS[0], GUESS[0], GUESS[1], GUESS[1], GUESS[1]];
    let state = normal(&craft, truth, deviations, 1)(0);
    let variances = Vector6::from(deviations).map(|deviation| deviation.powi(2));
    let mut filter = Filter { state, covariance: Matrix6::from_diagonal(&variances) };
    // random numbers for the measurements: the momenta of random states about rest
    let rest = SpacecraftState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    let mut noise = (0..).map(normal(&craft, rest, [STAR; 6], 2)).map(|state| state.momentum);

    let (mut true_stepper, mut stepper) = (craft.stepper::<Cayley>(0.1)?, craft.stepper::<Cayley>(0.1)?);
    println!("   time    attitude error    momentum error   (error / its deviation)² of 6 numbers");
    let (mut attitude_error, mut momentum_error, mut normalized) = (f64::NAN, f64::NAN, f64::NAN);
    for step in 0..=600 {
        if step % 10 == 0 {
            for star in [Vector3::x(), vector![0.0, 0.6, 0.8]] {
                let seen = truth.attitude.inverse() * star + noise.next().unwrap_or_default();
                filter.update(&star, &seen).ok_or("a singular covariance")?;
            }
            let turn = (filter.state.attitude.inverse() * truth.attitude).scaled_axis();
            let change = truth.momentum - filter.state.momentum;
            let error = vector![turn.x, turn.y, turn.z, change.x, change.y, change.z];
            (attitude_error, momentum_error) = (turn.norm().to_degrees(), change.norm());
            normalized = error.dot(&(filter.covariance.try_inverse().ok_or("singular")? * error));
        }
        if step % 100 == 0 {
            let time = stepper.time();
            println!("{time:5.0} s {attitude_error:15.3}° {momentum_error:10.5} kg m²/s {normalized:12.1}");
        }
        // the truth and the estimate move alike; the covariance moves by the exact Jacobian of the step
        true_stepper.step(&mut truth)?;
        let jacobian = stepper.step_with_jacobian(&mut filter.state, &NoControl::default(), WrtState)?.0;
        filter.covariance = jacobian * filter.covariance * jacobian.transpose();
    }
    assert!(attitude_error < 0.2 && momentum_error < 2e-3);
    assert!(normalized < 20.0, "the error is as large as the filter says: 6 on average");
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
