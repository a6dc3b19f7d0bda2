//! The paper's figures, drawn with our steppers beside the classical ones, and five of our own.
//!
//! Each figure is a module with what it measures, as numbers that tests hold against the paper's claims, how that is drawn, and its caption. The
//! numbers of a caption are computed from the data that is drawn and written beside it, and from nothing else.
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
mod caption;
#[cfg(test)]
mod claims;
mod data;
mod each_step;
mod invariant_errors;
pub(crate) mod kepler;
mod methods;
pub(crate) mod oscillator;
pub(crate) mod pendulum;
pub(crate) mod quadrotor;
pub(crate) mod steps;
pub(crate) mod work;

use std::path::{Path, PathBuf};

pub(crate) use data::{Curve, Data};
pub(crate) use invariant_errors::{ErrorSeries, InvariantErrors};

use caption::Caption;
use coadjoint_app::Error;
use coadjoint_app::catalogue::suggest::did_you_mean;
use coadjoint_app::error::SetupError;
use coadjoint_app::files::{FileOrigin, OverwriteGuard, PlannedFile};
use coadjoint_app::picture::{Figure, Kind};

/// One figure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawing {
    /// Its number in the paper, or its name.
    pub(crate) name: &'static str,
    /// What it shows.
    pub(crate) about: &'static str,
    /// Makes the runs and draws it.
    pub(crate) draw: fn() -> Result<Figure, Error>,
    /// What is said of it: all that was measured comes from its data.
    pub(crate) caption: fn(&Data) -> Caption,
}

/// All figures, in the order in which they are drawn.
pub(crate) static DRAWINGS: &[Drawing] = &[
    Drawing {
        name: "1.1",
        about: "harmonic oscillator: phase plane and energy with four Euler methods",
        draw: || oscillator::Oscillator::measure().map(|measured| measured.figure()),
        caption: oscillator::caption,
    },
    Drawing {
        name: "1.2",
        about: "Kepler problem: orbit, energy and angular momentum, RK2 and Störmer–Verlet",
        draw: || kepler::Orbits::measure().map(|measured| measured.figure()),
        caption: kepler::caption,
    },
    Drawing {
        name: "1.3",
        about: "planar pendulum on its cylinder: RK2 with and without projection",
        draw: || pendulum::Swings::measure().map(|measured| measured.figure()),
        caption: pendulum::caption,
    },
    Drawing {
        name: "6.1",
        about: "free rigid body over 30 minutes: energy and Casimir",
        draw: || bodies::Bodies::free(bodies::STEPS).map(|measured| measured.figure()),
        caption: bodies::free_caption,
    },
    Drawing {
        name: "6.2",
        about: "heavy top over 30 minutes: energy and Casimirs",
        draw: || bodies::Bodies::top(bodies::STEPS).map(|measured| measured.figure()),
        caption: bodies::top_caption,
    },
    Drawing {
        name: "6.3",
        about: "quadrotor with the thrust of hover, over 30 minutes",
        draw: || quadrotor::Hover::measure(bodies::STEPS).map(|measured| measured.figure()),
        caption: quadrotor::caption,
    },
    Drawing {
        name: "work",
        about: "error against time, orders 2 to 10 and the classical methods",
        draw: || work::Work::measure(&work::Sampling::FULL).map(|measured| measured.figure()),
        caption: work::caption,
    },
    Drawing {
        name: "steps",
        about: "long runs at large steps: what each method still keeps",
        draw: || steps::Steps::measure(steps::DURATION).map(|measured| measured.figure()),
        caption: steps::caption,
    },
    Drawing {
        name: "identify",
        about: "a spacecraft's inertia from noisy gyroscopes, by exact derivatives of steps",
        draw: applications::identify,
        caption: applications::identify_caption,
    },
    Drawing {
        name: "steer",
        about: "a manoeuvre with few pulses and the least effort, by exact derivatives of steps",
        draw: applications::steer,
        caption: applications::steer_caption,
    },
    Drawing {
        name: "estimate",
        about: "attitude and momentum from stars: a Kalman filter with exact derivatives of steps",
        draw: applications::estimate,
        caption: applications::estimate_caption,
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
            let reason = format!("there is no figure `{name}`{hint} (figures: all, {known})");
            return Err(SetupError::new(reason).into());
        }
    }
    let is_all = names.is_empty() || names.iter().any(|name| name == "all");
    Ok(DRAWINGS.iter().filter(|drawing| is_all || names.iter().any(|name| name == drawing.name)).collect())
}

/// What comes of a figure.
#[derive(Debug)]
pub(crate) struct Drawn {
    /// Its files.
    pub(crate) written: Vec<PathBuf>,
    /// Its paragraphs.
    pub(crate) caption: Vec<String>,
}

impl Drawing {
    /// Looks at the places of its files before it is drawn: none takes the place of what is not the same figure, unless asked.
    ///
    /// # Errors
    /// If one would, or cannot be written.
    pub(crate) fn guard(&self, directory: &Path, force: bool) -> Result<OverwriteGuard, Error> {
        let guard = OverwriteGuard::new(FileOrigin::of_command(&format!("figures {}", self.name)), force);
        let extensions = Kind::ALL.iter().map(|kind| kind.extension()).chain(["csv", "txt"]);
        let claim = |extension| PlannedFile {
            what: "a figure",
            path: self.path(directory, extension),
            written: true,
        };
        guard.check_all(&extensions.map(claim).collect::<Vec<_>>())?;
        Ok(guard)
    }

    /// Makes the runs, and writes `figure-<name>.png`, `.svg`, `.csv` with its data and `.txt` with its caption.
    ///
    /// # Errors
    /// If a step cannot be taken, or a file not be written.
    pub(crate) fn write(&self, directory: &Path, guard: &OverwriteGuard) -> Result<Drawn, Error> {
        let figure = (self.draw)()?;
        let data = Data::of(&figure);
        let caption: Vec<String> = (self.caption)(&data).iter().map(ToString::to_string).collect();
        let mut contents = Vec::new();
        for kind in Kind::ALL {
            contents.push((self.path(directory, kind.extension()), figure.picture(*kind)));
        }
        contents.push((self.path(directory, "csv"), data.csv()));
        let text = format!("{}\n\n{}\n", figure.title, caption.join("\n"));
        contents.push((self.path(directory, "txt"), text.into_bytes()));
        guard.write_all(&contents)?;
        Ok(Drawn { written: contents.into_iter().map(|(path, _)| path).collect(), caption })
    }

    /// The caption of the figure that is in a directory; none if there is no figure with a picture.
    pub(crate) fn caption_in(&self, directory: &Path) -> Option<Vec<String>> {
        let text = std::fs::read_to_string(self.path(directory, "txt")).ok()?;
        // its title, and an empty line
        let caption = text.lines().skip(2).map(str::to_owned).collect();
        self.path(directory, Kind::Svg.extension()).is_file().then_some(caption)
    }

    fn path(&self, directory: &Path, extension: &str) -> PathBuf {
        directory.join(format!("figure-{}.{extension}", self.name))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use super::caption::Piece;
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

    /// The figures, with runs as short as tests can wait for.
    static DRAWN: LazyLock<Vec<(&Drawing, Figure)>> = LazyLock::new(|| {
        let sampling = work::Sampling { most: 1 << 12, reference: 1 << 11, seconds: 0.0 };
        let draw = |drawing: &'static Drawing| {
            let figure = match drawing.name {
                "6.1" => bodies::Bodies::free(2000).map(|measured| measured.figure()),
                "6.2" => bodies::Bodies::top(2000).map(|measured| measured.figure()),
                "6.3" => quadrotor::Hover::measure(2000).map(|measured| measured.figure()),
                "work" => work::Work::measure(&sampling).map(|mut measured| {
                    // What the clock says differs from run to run, and now and then it has the same two digits after
                    // every number is changed: here each method's steps take one time.
                    for (k, method) in measured.methods.iter_mut().enumerate() {
                        for cost in &mut method.costs {
                            cost.time = 1e-6 * (1 + k) as f64 * cost.steps as f64 / work::DURATION;
                        }
                    }
                    measured.figure()
                }),
                "steps" => steps::Steps::measure(200.0).map(|measured| measured.figure()),
                _ => (drawing.draw)(),
            };
            (drawing, figure.expect("the runs can be made"))
        };
        DRAWINGS.iter().map(draw).collect()
    });

    /// Captions come from the CSV alone, and have no number of their own.
    #[test]
    fn every_number_of_every_caption_comes_from_the_data_beside_it() {
        for (Drawing { name, caption, .. }, figure) in DRAWN.iter() {
            let data = Data::of(figure);
            let read = Data::from_csv(&String::from_utf8(data.csv()).expect("UTF-8"));
            // too long to be printed
            assert!(read == data, "{name}: numbers change on their way through the CSV");
            let mut names: Vec<_> = read.columns().map(|(panel, name, _)| (panel, name.to_owned())).collect();
            assert!(names.iter().all(|(_, name)| !name.is_empty()), "{name}: a series without a name");
            names.sort();
            names.dedup();
            assert_eq!(names.len(), read.columns().count(), "{name}: two series of the same name in a panel");
            let recomputed = caption(&read);
            assert_eq!(recomputed, caption(&data), "{name}");
            let pieces = || recomputed.iter().flat_map(|paragraph| &paragraph.0);
            assert!(
                pieces().any(|piece| matches!(piece, Piece::Measured(_))),
                "{name} says nothing measured"
            );
            for piece in pieces() {
                match piece {
                    Piece::Words(words) => {
                        let words = ["RK2", "RK4", "RKMK4"]
                            .iter()
                            .fold((*words).to_owned(), |words, method| words.replace(method, ""));
                        assert!(!words.contains(|letter: char| letter.is_ascii_digit()), "{name}: `{words}`");
                    }
                    Piece::Measured(text) => {
                        assert!(
                            !text.contains("NaN") && !text.contains("inf") && !text.is_empty(),
                            "{name}: {recomputed:?}"
                        );
                    }
                    Piece::Given(_) => {}
                }
            }
        }
    }

    /// A caption follows its data: where every number is another one, and there is a point less, every measured number changes.
    #[test]
    fn captions_change_with_the_data() {
        for (Drawing { name, caption, .. }, figure) in DRAWN.iter() {
            let mut changed = figure.clone();
            for series in changed.panels.iter_mut().flat_map(|panel| &mut panel.series) {
                series.points.truncate(series.points.len() - 1);
                for (k, (x, y)) in series.points.iter_mut().enumerate() {
                    // the powers with which something grows too
                    let power = y.abs().powf(1.4).copysign(*y);
                    (*x, *y) = (1.7 * *x, 3.7 * power * (1.0 + 0.05 * k as f64));
                }
            }
            let numbers = |figure: &Figure| {
                let pieces = caption(&Data::of(figure)).into_iter().flat_map(|paragraph| paragraph.0);
                let labels: Vec<&str> = figure
                    .panels
                    .iter()
                    .flat_map(|panel| panel.series.iter().map(|series| series.label.as_str()))
                    .collect();
                // the name of a method that did best has digits too
                let is_number = |text: &str| {
                    !labels.contains(&text) && text.contains(|letter: char| letter.is_ascii_digit())
                };
                let numbers = pieces.filter_map(|piece| match piece {
                    Piece::Measured(text) if is_number(&text) => Some(text),
                    _ => None,
                });
                numbers.collect::<Vec<String>>()
            };
            for (before, after) in numbers(figure).into_iter().zip(numbers(&changed)) {
                assert!(before != after || before == "100.0", "{name}: {before} comes from nowhere");
            }
        }
    }

    /// Every series of a figure has a colour of its own within its panel, or is told apart by its lines or marks.
    #[test]
    fn no_two_series_of_a_panel_look_the_same() {
        for (Drawing { name, .. }, figure) in DRAWN.iter() {
            for panel in &figure.panels {
                for (i, one) in panel.series.iter().enumerate() {
                    for other in &panel.series[..i] {
                        assert!(
                            one.color != other.color || one.style != other.style,
                            "{name}: {} and {}",
                            one.label,
                            other.label
                        );
                    }
                }
            }
        }
    }

    /// A name has one colour in all figures.
    #[test]
    fn a_method_has_one_colour() {
        let series = DRAWN.iter().flat_map(|(_, figure)| &figure.panels).flat_map(|panel| &panel.series);
        let mut colors = std::collections::BTreeMap::new();
        for series in series.filter(|series| !["error", "change"].contains(&series.label.as_str())) {
            let color = *colors.entry(series.label.clone()).or_insert(series.color);
            assert_eq!(color, series.color, "{}", series.label);
        }
    }
}
