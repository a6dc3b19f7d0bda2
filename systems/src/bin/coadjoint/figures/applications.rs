//! What exact derivatives of steps are for: identification, steering and estimation of a spacecraft.

use coadjoint::prelude::*;
use coadjoint_systems::applications::{Failure, Spacecraft, estimation, identification, steering};

use super::figures;
use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};

const AXES: [&str; 3] = ["x", "y", "z"];
const SEED: u64 = 1;

/// The inertia of a spacecraft from samples of its gyroscopes.
pub(crate) fn identify() -> Result<Figure, Error> {
    let truth = Spacecraft::small();
    let samples = identification::experiment(&truth, vector![0.4, -0.5, 0.3], SEED)?;
    let estimates = identification::identify(&samples, Matrix3::from_diagonal_element(2.0))?;
    let [first, .., last] = estimates.as_slice() else { return Err(Failure::Singular.into()) };
    let times: Vec<f64> = samples.iter().map(|(time, _)| *time).collect();
    let velocity_series = |inertia, momentum| -> Result<Vec<Vec<(f64, f64)>>, Error> {
        let velocities = identification::predicted(inertia, momentum)?;
        let trajectory = |axis: usize| times.iter().zip(&velocities).map(|(t, v)| (*t, v[axis])).collect();
        Ok((0..3).map(trajectory).collect())
    };
    let (guessed, found) =
        (velocity_series(first.inertia, first.momentum)?, velocity_series(last.inertia, last.momentum)?);
    let mut panels: Vec<Panel> = (0..3)
        .map(|axis| {
            // all of them would hide the lines
            let measured = samples.iter().step_by(5).map(|(t, v)| (*t, v[axis])).collect();
            let series = vec![
                Series {
                    label: "first guess".to_owned(),
                    points: guessed[axis].clone(),
                    style: Style::Reference,
                },
                Series::line("with the inertia found", found[axis].clone()),
                Series {
                    label: "gyroscopes, every fifth sample".to_owned(),
                    points: measured,
                    style: Style::Marks,
                },
            ];
            Panel::new(Axis::linear("time, s"), Axis::linear(format!("ω{}, rad/s", AXES[axis])), series)
        })
        .collect();
    let error = |estimate: &identification::Estimate| (estimate.inertia - truth.inertia).norm();
    let change = estimates.windows(2).enumerate();
    let change =
        change.map(|(k, pair)| (k as f64 + 1.0, (pair[1].inertia - pair[0].inertia).norm())).collect();
    panels.push(Panel::new(
        Axis::linear("iteration"),
        Axis::logarithmic("change of the inertia, kg m²"),
        vec![Series { label: "change".to_owned(), points: change, style: Style::Marked }],
    ));
    let bars = last.covariance.diagonal().map(f64::sqrt);
    Ok(Figure {
        title: "Identification: the inertia of a spacecraft from noisy gyroscopes".to_owned(),
        caption: vec![format!(
            "{} samples with a noise of {} rad/s. After {} of Gauss and Newton's iterations the inertia tensor is within {} kg m² of \
             the true one, and its entries' own error bars are up to {} kg m²; what is left between samples and motion is {} rad/s. \
             The derivatives of the motion with respect to the inertia are those of the steps themselves.",
            samples.len(),
            figures(identification::NOISE),
            estimates.len() - 1,
            figures(error(last)),
            figures(bars.fixed_rows::<6>(0).max()),
            figures(last.residual),
        )],
        columns: 2,
        cell: (560.0, 300.0),
        key: Key::Below,
        panels,
    })
}

/// A manoeuvre from rest to rest.
pub(crate) fn steer() -> Result<Figure, Error> {
    let craft = Spacecraft::small();
    let target = UnitQuaternion::from_scaled_axis(vector![1.2, -0.8, 1.5]);
    let manoeuvres = steering::steer(&craft, &target)?;
    let Some(best) = manoeuvres.last() else { return Err(Failure::Singular.into()) };
    let length = steering::LENGTH as f64 * steering::STEP;
    let torque = |axis: usize| {
        let edges = best.pulses.iter().enumerate();
        let corners = edges.flat_map(|(k, pulse)| {
            [(k as f64 * length, pulse[axis]), ((k as f64 + 1.0) * length, pulse[axis])]
        });
        Series::line(format!("about {}", AXES[axis]), corners.collect())
    };
    let trajectory = steering::trajectory(&craft, &target, &best.pulses)?;
    let left = |axis: usize| {
        Series::line(
            format!("about {}", AXES[axis]),
            trajectory.iter().map(|(t, left)| (*t, left[axis])).collect(),
        )
    };
    let errors =
        manoeuvres.iter().enumerate().map(|(k, manoeuvre)| (k as f64, manoeuvre.terminal_error.norm()));
    let errors =
        Series { label: "terminal error".to_owned(), points: errors.collect(), style: Style::Marked };
    Ok(Figure {
        title: "Steering: from rest to rest in another attitude with eight pulses of torque".to_owned(),
        caption: vec![format!(
            "A turn by {} rad in {} s. After {} iterations the terminal error is {}, and to first order no change of the pulses that keeps the end takes \
             less effort, {} N² m². The derivatives of the end with respect to the pulses are those of the steps themselves, so that the last \
             iterations converge to rounding.",
            format_args!("{:.2}", target.angle()),
            length * best.pulses.len() as f64,
            manoeuvres.len() - 1,
            figures(best.terminal_error.norm()),
            figures(best.effort()),
        )],
        columns: 3,
        cell: (460.0, 340.0),
        key: Key::Below,
        panels: vec![
            Panel::new(Axis::linear("time, s"), Axis::linear("torque, N m"), (0..3).map(torque).collect())
                .titled("(a) pulses, body axes"),
            Panel::new(Axis::linear("time, s"), Axis::linear("rad"), (0..3).map(left).collect())
                .titled("(b) rotation that is left"),
            Panel::new(Axis::linear("iteration"), Axis::logarithmic("|e|"), vec![errors])
                .titled("(c) error of attitude and momentum"),
        ],
    })
}

/// A simulated flight and its estimate by a Kalman filter.
pub(crate) fn estimate() -> Result<Figure, Error> {
    let updates = estimation::simulate(&Spacecraft::small(), SEED)?;
    let panel = |row: usize, label: String| {
        let bar = |sign: f64| -> Vec<(f64, f64)> {
            updates.iter().map(|m| (m.time, sign * 3.0 * m.covariance[(row, row)].sqrt())).collect()
        };
        let error = updates.iter().map(|update| (update.time, update.error[row])).collect();
        // by what is so in the end, not by the beginning
        let height = updates.last().map_or(1.0, |last| 8.0 * last.covariance[(row, row)].sqrt());
        Panel::new(
            Axis::linear("time, s"),
            Axis::linear(label).within(-height, height),
            vec![Series::line("error", error), Series::band(bar(-1.0), bar(1.0))],
        )
    };
    let mut panels: Vec<Panel> = (0..3).map(|i| panel(i, format!("δ{}, rad", AXES[i]))).collect();
    panels.extend((0..3).map(|i| panel(3 + i, format!("δΠ{}, N m s", AXES[i]))));
    let (mut inside, mut all) = (0, 0);
    // once the filter has converged
    let settled = || updates.iter().filter(|update| update.time >= 20.0);
    for update in settled() {
        for row in 0..6 {
            all += 1;
            inside += usize::from(update.error[row].powi(2) < 9.0 * update.covariance[(row, row)]);
        }
    }
    let squares: Vec<f64> = settled().filter_map(estimation::FilterUpdate::nees).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    Ok(Figure {
        title: "Estimation: attitude and momentum from two stars, by an error-state Kalman filter".to_owned(),
        caption: vec![format!(
            "Two stars are measured each second, each with a noise of {}; a random torque of {} N m acts. Bands: three standard \
             deviations, as the filter gives them; {} % of the errors are within from 20 s on. The mean of eᵀP⁻¹e over this time is {}, where 6 is \
             what a filter should have that knows how good it is.",
            figures(estimation::STAR_NOISE),
            figures(estimation::TORQUE_NOISE),
            format_args!("{:.1}", 100.0 * inside as f64 / all as f64),
            format_args!("{mean:.1}"),
        )],
        columns: 3,
        cell: (460.0, 280.0),
        key: Key::First,
        panels,
    })
}
