//! The paper's figures, drawn with our steppers beside the classical ones, and five of our own.
//!
//! Each figure is a module with what it measures, as numbers that tests hold against the paper's claims, and how that is drawn. Captions
//! carry the measured numbers: they are set when the figure is drawn.
//!
//! | figure | what it shows |
//! |---|---|
//! | [1.1](oscillator) | the harmonic oscillator: explicit and implicit Euler spiral, the symplectic ones do not |
//! | [1.2](kepler) | the Kepler problem: RK2 loses energy's and angular momentum's constancy, Störmer–Verlet keeps both in bounds |
//! | [1.3](pendulum) | the pendulum on its cylinder: projection keeps the constraint, and not the energy |
//! | [6.1](bodies) | the free rigid body over 30 minutes: energy and Casimir with four methods |
//! | [6.2](bodies) | the heavy top over 30 minutes |
//! | [6.3](quadrotor) | the quadrotor with the thrust of hover, over 30 minutes |
//! | [work](work) | what accuracy costs: error against time, orders 2 to 10 and the classical methods |
//! | [steps](steps) | large steps for long times: what each method still keeps |
//! | [identify](applications::identify) | derivatives of steps: a spacecraft's inertia from noisy gyroscopes |
//! | [steer](applications::steer) | derivatives of steps: a manoeuvre with few pulses and the least effort |
//! | [estimate](applications::estimate) | derivatives of steps: attitude and momentum from stars, by a Kalman filter |
//!
//! What of it differs from the paper's text, and when a structure-preserving step pays, is in the crate's guide.

pub(crate) mod applications;
pub(crate) mod bodies;
#[cfg(test)]
mod claims;
mod invariant_errors;
pub(crate) mod kepler;
pub(crate) mod oscillator;
pub(crate) mod pendulum;
pub(crate) mod quadrotor;
pub(crate) mod steps;
pub(crate) mod work;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

pub(crate) use invariant_errors::{ErrorSeries, InvariantErrors};

use coadjoint_app::Error;
use coadjoint_app::output::{make_directory, write_text};
use coadjoint_app::plot::Figure;
use coadjoint_app::suggest::did_you_mean;

/// One figure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawing {
    /// Its number in the paper, or its name.
    pub(crate) name: &'static str,
    /// What it shows.
    pub(crate) about: &'static str,
    /// Makes the runs and draws it.
    pub(crate) draw: fn() -> Result<Figure, Error>,
}

/// All figures, in the order in which they are drawn.
pub(crate) static DRAWINGS: &[Drawing] = &[
    Drawing {
        name: "1.1",
        about: "harmonic oscillator: phase plane and energy with four Euler methods",
        draw: || oscillator::Oscillator::measure().map(|measured| measured.figure()),
    },
    Drawing {
        name: "1.2",
        about: "Kepler problem: orbit, energy and angular momentum, RK2 and Störmer–Verlet",
        draw: || kepler::Orbits::measure().map(|measured| measured.figure()),
    },
    Drawing {
        name: "1.3",
        about: "planar pendulum on its cylinder: RK2 with and without projection",
        draw: || pendulum::Swings::measure().map(|measured| measured.figure()),
    },
    Drawing {
        name: "6.1",
        about: "free rigid body over 30 minutes: energy and Casimir",
        draw: || bodies::Bodies::free(bodies::STEPS).map(|measured| measured.figure()),
    },
    Drawing {
        name: "6.2",
        about: "heavy top over 30 minutes: energy and Casimirs",
        draw: || bodies::Bodies::top(bodies::STEPS).map(|measured| measured.figure()),
    },
    Drawing {
        name: "6.3",
        about: "quadrotor with the thrust of hover, over 30 minutes",
        draw: || quadrotor::Hover::measure(bodies::STEPS).map(|measured| measured.figure()),
    },
    Drawing {
        name: "work",
        about: "error against time, orders 2 to 10 and the classical methods",
        draw: || work::Work::measure(&work::Sampling::FULL).map(|measured| measured.figure()),
    },
    Drawing {
        name: "steps",
        about: "long runs at large steps: what each method still keeps",
        draw: || steps::Steps::measure(steps::DURATION).map(|measured| measured.figure()),
    },
    Drawing {
        name: "identify",
        about: "a spacecraft's inertia from noisy gyroscopes, by exact derivatives of steps",
        draw: applications::identify,
    },
    Drawing {
        name: "steer",
        about: "a manoeuvre with few pulses and the least effort, by exact derivatives of steps",
        draw: applications::steer,
    },
    Drawing {
        name: "estimate",
        about: "attitude and momentum from stars: a Kalman filter with exact derivatives of steps",
        draw: applications::estimate,
    },
];

/// The figures asked for, in the order of the list; all if none or `all` is.
///
/// # Errors
/// If there is no figure of a name.
pub(crate) fn chosen(names: &[String]) -> Result<Vec<&'static Drawing>, Error> {
    let all = || DRAWINGS.iter().map(|drawing| drawing.name);
    for name in names {
        if name != "all" && all().all(|known| known != name) {
            let hint = did_you_mean(name, all());
            let known = all().collect::<Vec<_>>().join(", ");
            return Err(Error::Input(format!("there is no figure `{name}`{hint} (figures: all, {known})")));
        }
    }
    let is_all = names.is_empty() || names.iter().any(|name| name == "all");
    Ok(DRAWINGS.iter().filter(|drawing| is_all || names.iter().any(|name| name == drawing.name)).collect())
}

impl Drawing {
    /// Makes the runs, and writes `figure-<name>.png`, `.svg` and `.csv`; the answer is their paths and the caption.
    ///
    /// # Errors
    /// If a step cannot be taken, or a file not be written.
    pub(crate) fn write(&self, directory: &Path) -> Result<(Vec<PathBuf>, Vec<String>), Error> {
        make_directory(directory)?;
        let figure = (self.draw)()?;
        let stem = directory.join(format!("figure-{}", self.name));
        let mut written = figure.write(&stem)?.to_vec();
        let csv = directory.join(format!("figure-{}.csv", self.name));
        write_text(&csv, &table(&figure))?;
        written.push(csv);
        Ok((written, figure.caption))
    }
}

/// The figure's data: a line for each point of each series.
fn table(figure: &Figure) -> String {
    let mut text = String::from("panel,horizontal,vertical,series,x,y\n");
    for (i, panel) in figure.panels.iter().enumerate() {
        for series in &panel.series {
            for (x, y) in &series.points {
                let quoted = |text: &str| text.replace('"', "\"\"");
                // writing to a string does not fail
                let _ = writeln!(
                    text,
                    "{},\"{}\",\"{}\",\"{}\",{x:?},{y:?}",
                    i + 1,
                    quoted(&panel.x.label),
                    quoted(&panel.y.label),
                    quoted(&series.label)
                );
            }
        }
    }
    text
}

/// Two digits of a magnitude: `3.1·10⁻⁹`.
pub(crate) fn figures(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let text = format!("{value:.1e}");
    match text.split_once('e') {
        Some((digits, exponent)) => {
            let exponent: f64 = exponent.parse().unwrap_or(0.0);
            format!("{digits}·{}", coadjoint_app::plot::power_of_ten(exponent))
        }
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_found_by_name() {
        let names = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            chosen(&names).map(|drawings| drawings.iter().map(|d| d.name).collect::<Vec<_>>())
        };
        assert_eq!(names(&[]).expect("all").len(), DRAWINGS.len());
        assert_eq!(names(&["6.1", "all"]).expect("all").len(), DRAWINGS.len());
        assert_eq!(names(&["6.2", "1.1"]).expect("there"), ["1.1", "6.2"]);
        let message = names(&["6.4"]).expect_err("there is none").to_string();
        assert!(message.contains("there is no figure `6.4`") && message.contains("1.1"), "{message}");
    }

    #[test]
    fn numbers_of_captions_are_short() {
        assert_eq!(figures(3.14e-9), "3.1·10⁻⁹");
        assert_eq!(figures(-250.0), "-2.5·10²");
        assert_eq!(figures(0.0), "0");
    }
}
