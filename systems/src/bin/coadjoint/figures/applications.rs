//! What exact derivatives of steps are for: identification, steering and estimation of a spacecraft.

use coadjoint::prelude::*;
use coadjoint_systems::applications::{Failure, Spacecraft, estimation, identification, steering};

use super::Data;
use super::caption::{Caption, given, measured, paragraph, with_places};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Color, Figure, Key, Mark, Panel, Series, Style};

const AXES: [&str; 3] = ["x", "y", "z"];
const SEED: u64 = 1;
const TIME: &str = "time, s";

/// Names of series.
const GUESS: &str = "first guess";
const FOUND: &str = "with the inertia found";
const SAMPLES: &str = "gyroscopes, every fifth sample";
const DEVIATIONS: &str = "three standard deviations";
const TRUTH: &str = "truth";
const ERROR: &str = "error";
const CHANGE: &str = "change";

/// The inertia of a spacecraft from samples of its gyroscopes.
pub(crate) fn identify() -> Result<Figure, Error> {
    let truth = Spacecraft::small();
    let samples = identification::experiment(&truth, vector![0.4, -0.5, 0.3], SEED)?;
    let estimates = identification::identify(&samples, Matrix3::from_diagonal_element(2.0))?;
    let [first, .., last] = estimates.as_slice() else { return Err(Failure::Singular.into()) };
    let times: Vec<f64> = samples.iter().map(|(time, _)| *time).collect();
    let velocities = |inertia, momentum| -> Result<Vec<Vec<(f64, f64)>>, Error> {
        let velocities = identification::predicted(inertia, momentum)?;
        let trajectory = |axis: usize| times.iter().zip(&velocities).map(|(t, v)| (*t, v[axis])).collect();
        Ok((0..3).map(trajectory).collect())
    };
    let guessed = velocities(first.inertia, first.momentum)?;
    let found = velocities(last.inertia, last.momentum)?;
    let mut panels: Vec<Panel> = (0..3)
        .map(|axis| {
            // all of them would hide the lines
            let measured = samples.iter().step_by(5).map(|(t, v)| (*t, v[axis])).collect();
            let series = vec![
                Series::reference(GUESS, guessed[axis].clone()),
                Series::line(FOUND, Color::X, found[axis].clone()),
                Series::new(SAMPLES, Color::Y, Style::Marks(Mark::Dot), measured),
            ];
            let velocity = Axis::linear("angular velocity, rad/s");
            Panel::new(Axis::linear(TIME), velocity, series).titled(format!(
                "({}) ω{}",
                ["a", "b", "c"][axis],
                AXES[axis]
            ))
        })
        .collect();
    let changes = estimates.windows(2).map(|pair| (pair[1].inertia - pair[0].inertia).norm());
    let changes = (1..).map(f64::from).zip(changes).collect();
    panels.push(
        Panel::new(
            Axis::counts("iteration"),
            Axis::logarithmic("change of the inertia, kg m²"),
            vec![Series::new(CHANGE, Color::Z, Style::Marked(Mark::Dot), changes)],
        )
        .titled("(d) Gauss and Newton's iterations"),
    );
    panels.extend(entries(&truth, last));
    Ok(Figure {
        title: "Identification: the inertia of a spacecraft from noisy gyroscopes".to_owned(),
        columns: 3,
        cell: (340.0, 230.0),
        key: Key::Above,
        shared: (false, false),
        panels,
    })
}

/// The entries found, and how far they are from the truth.
fn entries(truth: &Spacecraft, estimate: &identification::Estimate) -> [Panel; 2] {
    const ENTRIES: [(&str, (usize, usize)); 6] = [
        ("Ixx", (0, 0)),
        ("Iyy", (1, 1)),
        ("Izz", (2, 2)),
        ("Ixy", (0, 1)),
        ("Ixz", (0, 2)),
        ("Iyz", (1, 2)),
    ];
    let along = |value: &dyn Fn(usize, (usize, usize)) -> f64| -> Vec<(f64, f64)> {
        (0..6).map(|k| (k as f64 + 1.0, value(k, ENTRIES[k].1))).collect()
    };
    let error = |at| 1e3 * (estimate.inertia[at] - truth.inertia[at]);
    let bar = |k: usize| 3e3 * estimate.covariance[(k, k)].sqrt();
    let names = || Axis::names(ENTRIES.map(|(name, _)| name));
    [
        Panel::new(
            names(),
            Axis::linear("entry, kg m²"),
            vec![
                Series::new(TRUTH, Color::Ink, Style::Marks(Mark::Ring), along(&|_, at| truth.inertia[at])),
                Series::new(
                    "inertia found",
                    Color::X,
                    Style::Marks(Mark::Dot),
                    along(&|_, at| estimate.inertia[at]),
                ),
            ],
        )
        .titled("(e) the inertia"),
        Panel::new(
            names(),
            Axis::linear("error of the entry, g m²"),
            vec![
                Series::reference("no error", vec![(0.5, 0.0), (6.5, 0.0)]),
                Series::bars(
                    DEVIATIONS,
                    Color::X,
                    along(&|k, at| error(at) - bar(k)),
                    along(&|k, at| error(at) + bar(k)),
                ),
                Series::new(ERROR, Color::X, Style::Marks(Mark::Dot), along(&|_, at| error(at))),
            ],
        )
        .titled("(f) found − true"),
    ]
}

/// How good the inertia is that was found.
pub(crate) fn identify_caption(data: &Data) -> Caption {
    let errors = data.curve(6, ERROR);
    let (lower, upper) = data.curve(6, DEVIATIONS).halves();
    let widths = lower.values().zip(upper.values()).map(|(low, high)| 0.5 * (high - low));
    // what is left between samples and the motion with the inertia found, at the samples that are drawn
    let left = (1..=3).flat_map(|panel| {
        let (samples, found) = (data.curve(panel, SAMPLES).points(), data.curve(panel, FOUND).points());
        samples.iter().filter_map(move |(time, value)| {
            let (_, expected) = found.iter().find(|point| point.0 == *time)?;
            Some(value - expected)
        })
    });
    let left: Vec<f64> = left.collect();
    let residual = (left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64).sqrt();
    vec![paragraph![
        "Gyroscopes with a noise of ",
        given(identification::NOISE),
        " rad/s are sampled ",
        with_places(data.curve(1, FOUND).points().len() as f64, 0),
        " times while known torques turn the spacecraft. After ",
        with_places(data.curve(4, CHANGE).points().len() as f64, 0),
        " iterations the six entries of the inertia are within ",
        measured(errors.largest()),
        " g m² of the truth; three standard deviations, by the fit itself, are up to ",
        measured(widths.fold(0.0, f64::max)),
        " g m². Between samples and motion ",
        measured(residual),
        " rad/s are left, which is the noise. The derivatives of the motion with respect to the inertia are those of the steps themselves."
    ]]
}

/// A manoeuvre from rest to rest.
pub(crate) fn steer() -> Result<Figure, Error> {
    let craft = Spacecraft::small();
    let target = UnitQuaternion::from_scaled_axis(vector![1.2, -0.8, 1.5]);
    let manoeuvres = steering::steer(&craft, &target)?;
    let Some(best) = manoeuvres.last() else { return Err(Failure::Singular.into()) };
    let length = steering::LENGTH as f64 * steering::STEP;
    let about =
        |axis: usize, points| Series::line(format!("about {}", AXES[axis]), Color::component(axis), points);
    let torque = |axis: usize| {
        let edges = best.pulses.iter().enumerate();
        let corners = edges.flat_map(|(k, pulse)| {
            [(k as f64 * length, pulse[axis]), ((k as f64 + 1.0) * length, pulse[axis])]
        });
        about(axis, corners.collect())
    };
    let trajectory = steering::trajectory(&craft, &target, &best.pulses)?;
    let left =
        |axis: usize| about(axis, trajectory.iter().map(|(t, left)| (*t, left[axis].to_degrees())).collect());
    let errors = (0..).map(f64::from).zip(manoeuvres.iter().map(|manoeuvre| manoeuvre.terminal_error.norm()));
    let errors = Series::new("terminal error", Color::Ink, Style::Marked(Mark::Dot), errors.collect());
    let time = || Axis::linear(TIME);
    Ok(Figure {
        title: "Steering: from rest to rest in another attitude".to_owned(),
        columns: 3,
        cell: (340.0, 300.0),
        key: Key::Above,
        shared: (false, false),
        panels: vec![
            Panel::new(time(), Axis::linear("torque, N m"), (0..3).map(torque).collect())
                .titled("(a) pulses, body axes"),
            Panel::new(time(), Axis::linear("rotation vector, degrees"), (0..3).map(left).collect())
                .titled("(b) rotation that is left"),
            Panel::new(Axis::counts("iteration"), Axis::logarithmic("|(δ, Π)|, rad and N m s"), vec![errors])
                .titled("(c) terminal error"),
        ],
    })
}

/// How far the manoeuvre goes, what it takes, and where it ends.
pub(crate) fn steer_caption(data: &Data) -> Caption {
    let about = |panel: usize, axis: &str| data.curve(panel, &format!("about {axis}"));
    let turn = AXES.map(|axis| about(2, axis).values().next().unwrap_or(f64::NAN));
    let turn = turn.iter().map(|part| part * part).sum::<f64>().sqrt();
    // each pulse has two points; it is held for as long as there is between them
    let pulses: Vec<f64> = AXES
        .iter()
        .flat_map(|axis| about(1, axis).values().step_by(2))
        .map(|torque| torque * torque)
        .collect();
    let length = about(1, "x").points().get(1).map_or(f64::NAN, |point| point.0);
    let errors = data.curve(3, "terminal error");
    vec![paragraph![
        "A turn by ",
        with_places(turn, 0),
        "° in ",
        with_places(length * (pulses.len() / AXES.len()) as f64, 0),
        " s, with pulses of ",
        with_places(length, 1),
        " s. After ",
        with_places(errors.points().len() as f64 - 1.0, 0),
        " iterations the terminal error, rotation and momentum together, is ",
        measured(errors.last()),
        ", and to first order no change of the pulses that keeps the end takes less effort. The effort is ½ ∫ |τ|² dt, half the square of the \
         torque over the time: ",
        measured(0.5 * length * pulses.iter().sum::<f64>()),
        " N² m² s. The derivatives of the end with respect to the pulses are those of the steps themselves, so that the last iterations \
         converge to rounding."
    ]]
}

/// From when on the filter has converged, s.
const SETTLED: f64 = 20.0;
/// What a filter that knows how good it is has on average of eᵀP⁻¹e: as many as there are errors.
const EXPECTED: [(&str, f64); 3] =
    [("attitude alone", 3.0), ("momentum alone", 3.0), ("attitude and momentum", 6.0)];
const NORMALIZED: &str = "normalized error eᵀP⁻¹e";
const EXPECTATION: &str = "expectation";

/// A simulated flight and its estimate by a Kalman filter.
pub(crate) fn estimate() -> Result<Figure, Error> {
    let updates = estimation::simulate(&Spacecraft::small(), SEED)?;
    let panel = |row: usize, label: &str, unit: f64| {
        let bar = |sign: f64| -> Vec<(f64, f64)> {
            updates.iter().map(|m| (m.time, unit * sign * 3.0 * m.covariance[(row, row)].sqrt())).collect()
        };
        let error = updates.iter().map(|update| (update.time, unit * update.error[row])).collect();
        // by what is so in the end, not by the beginning
        let height = updates.last().map_or(1.0, |last| 8.0 * last.covariance[(row, row)].sqrt());
        Panel::new(
            Axis::linear(TIME),
            Axis::linear(label).within(-unit * height, unit * height),
            vec![
                Series::band(DEVIATIONS, Color::X, 0.22, bar(-1.0), bar(1.0)),
                Series::line(ERROR, Color::X, error),
            ],
        )
    };
    let attitude = |i: usize| {
        panel(i, "attitude error, degrees", 1_f64.to_degrees()).titled(format!("about {}", AXES[i]))
    };
    let momentum = |i: usize| panel(3 + i, "momentum error, N m s", 1.0);
    Ok(Figure {
        title: "Estimation: attitude and momentum from two stars, by a Kalman filter".to_owned(),
        columns: 3,
        cell: (340.0, 180.0),
        key: Key::Above,
        shared: (true, true),
        panels: (0..3).map(attitude).chain((0..3).map(momentum)).chain(consistency(&updates)).collect(),
    })
}

/// The errors by what the filter believes them to be: of the attitude, of the momentum, and of both.
fn consistency(updates: &[estimation::FilterUpdate]) -> [Panel; 3] {
    let part = |update: &estimation::FilterUpdate, row: usize| {
        let error = update.error.fixed_rows::<3>(row).into_owned();
        let covariance = update.covariance.fixed_view::<3, 3>(row, row).into_owned();
        Some(error.dot(&covariance.cholesky()?.solve(&error)))
    };
    let end = updates.last().map_or(1.0, |last| last.time);
    let panel = |k: usize| {
        let squares = updates.iter().filter_map(|update| {
            let square = if k < 2 { part(update, 3 * k) } else { update.nees() };
            Some((update.time, square?))
        });
        let (title, expected) = EXPECTED[k];
        Panel::new(
            Axis::linear(TIME),
            Axis::linear("eᵀP⁻¹e, no unit").within(0.0, 25.0),
            vec![
                Series::line(NORMALIZED, Color::Z, squares.collect()),
                Series::reference(EXPECTATION, vec![(0.0, expected), (end, expected)]),
            ],
        )
        .titled(title)
    };
    [0, 1, 2].map(panel)
}

/// Whether the filter knows how good it is.
pub(crate) fn estimate_caption(data: &Data) -> Caption {
    let (mut inside, mut all) = (0.0, 0.0);
    for panel in 1..=6 {
        let errors = data.curve(panel, ERROR).points();
        let (_, upper) = data.curve(panel, DEVIATIONS).halves();
        for ((time, error), bar) in errors.iter().zip(upper.values()) {
            if *time >= SETTLED {
                all += 1.0;
                inside += if error.abs() < bar { 1.0 } else { 0.0 };
            }
        }
    }
    let mean = |panel: usize| {
        let points = data.curve(panel, NORMALIZED).points();
        let squares: Vec<f64> =
            points.iter().filter(|point| point.0 >= SETTLED).map(|point| point.1).collect();
        with_places(squares.iter().sum::<f64>() / squares.len() as f64, 1)
    };
    let [attitude, momentum] = [1..=3, 4..=6].map(|mut panels| {
        panels.by_ref().map(|panel| data.curve(panel, ERROR).largest()).fold(0.0, f64::max)
    });
    let [(_, three), _, (_, six)] = EXPECTED;
    vec![
        paragraph![
            "Two stars are measured each second, each with a noise of ",
            given(estimation::STAR_NOISE),
            "; a random torque of ",
            given(estimation::TORQUE_NOISE),
            " N m acts. Bands: three standard deviations, as the filter gives them; ",
            with_places(100.0 * inside / all, 1),
            " % of the errors are within from ",
            given(SETTLED),
            " s on. The mean of eᵀP⁻¹e over this time is ",
            mean(7),
            " for the attitude, ",
            mean(8),
            " for the momentum and ",
            mean(9),
            " for both; a filter that knows how good it is has ",
            given(three),
            ", ",
            given(three),
            " and ",
            given(six),
            "."
        ],
        paragraph![
            "The first seconds, with components of the errors up to ",
            measured(attitude),
            "° and ",
            measured(momentum),
            " N m s, are cut off at the edges."
        ],
    ]
}
