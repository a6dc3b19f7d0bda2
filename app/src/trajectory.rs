//! Motions in memory as tables, plots and pages, from whatever computed them.

use std::path::Path;

use coadjoint::State;

use crate::conservation::ConservationReport;
use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::example::Example;
use crate::output::{Format, Guard, TrajectoryWriter};
use crate::page::{Heading, HtmlPlayer, Page};
use crate::plot::Figure;
use crate::provenance::Provenance;
use crate::run_plot::RunPlot;
use crate::simulation::{Job, Method, Order, Retraction, Sample, Setup};

/// States of a system at times: of a stepper, a [`Record`](coadjoint::Record), a filter, measurements.
///
/// ```
/// # use coadjoint::prelude::*;
/// # use coadjoint_app::{Example, Trajectory};
/// # #[lie_poisson_system(group = SO2, potential = -weight * length * angle.cos_angle())]
/// # struct Pendulum { #[inertia] inertia: f64, weight: f64, length: f64 }
/// # impl Example for Pendulum {
/// #     fn example() -> (Self, PendulumState) {
/// #         let pendulum = Pendulum { inertia: 0.1, weight: 9.81, length: 0.3 };
/// #         (pendulum, PendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.0] })
/// #     }
/// # }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let directory = std::env::temp_dir().join(format!("trajectory-{}", std::process::id()));
/// # std::fs::create_dir_all(&directory)?;
/// let (pendulum, mut state) = Pendulum::example();
/// let mut stepper = pendulum.stepper::<Cayley>(0.01)?;
/// let moments = (0..=500).map(|_| {
///     let moment = (stepper.time(), state);
///     stepper.step(&mut state).map(|_| moment)
/// });
/// let trajectory = Trajectory::new(&pendulum, "Cayley", moments.collect::<Result<Vec<_>, _>>()?);
/// trajectory.write(&directory.join("pendulum.csv"))?;
/// trajectory.plot().write(&directory.join("pendulum"))?; // .svg and .png
/// trajectory.page().write(&directory.join("pendulum.html"))?; // in three dimensions
/// # std::fs::remove_dir_all(&directory)?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Trajectory {
    entry: &'static Entry,
    setup: Setup,
    scheme: String,
    moments: Vec<Moment>,
}

#[derive(Debug)]
struct Moment {
    time: f64,
    state: Vec<f64>,
    energy: f64,
    casimirs: Vec<f64>,
}

impl Trajectory {
    /// The states of a system at these times, s, with a word on what computed them. The energy is that with the controls of the system's own law.
    pub fn new<S: Example>(
        system: &S,
        scheme: &str,
        moments: impl IntoIterator<Item = (f64, S::State)>,
    ) -> Self {
        let erased: &dyn coadjoint::erased::System = system;
        let entries = Catalogue::new([Entry::of::<S>()]).entries();
        let entry = &entries[0];
        let law = entry.law(&Setup { parameters: erased.parameters(), ..entry.example.clone() });
        let moment = |(time, state): (f64, S::State)| {
            let state = state.to_components().as_ref().to_vec();
            let energy = entry.energy(erased, law.as_ref(), (&state, time));
            Moment { time, energy, casimirs: erased.casimirs(&state), state }
        };
        let moments: Vec<Moment> = moments.into_iter().map(moment).collect();
        let state = moments.first().map_or_else(|| entry.example.state.clone(), |first| first.state.clone());
        let setup = Setup { parameters: erased.parameters(), state, ..entry.example.clone() };
        Self { entry, setup, scheme: scheme.to_owned(), moments }
    }

    /// Writes a table, in the format that the extension of its name says: `csv`, `json`, with the feature `parquet` also `parquet`. A file that
    /// is there is replaced.
    ///
    /// # Errors
    /// If there is no such format, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = Format::of_extension(&extension).ok_or_else(|| {
            Error::Input(format!("{}: there is no format of tables `{extension}`", path.display()))
        })?;
        let guard = Guard::new(self.provenance().origin(), true);
        let mut writer = TrajectoryWriter::create(path, format, self.entry, &guard)?;
        let mut conservation: Option<ConservationReport> = None;
        self.each(|sample| {
            conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
            let mut row = vec![sample.time];
            row.extend(sample.state);
            row.push(sample.energy);
            writer.row(&row)
        })?;
        let Some(conservation) = conservation else {
            return Err(Error::Input("a trajectory without a state is no table".to_owned()));
        };
        writer.finish(&conservation, None).map(|_| ())
    }

    /// What moves, and the errors of what is conserved, over time.
    pub fn plot(&self) -> Figure {
        let mut plot = RunPlot::new(self.entry, &self.job());
        // drawing does not fail
        let _ = self.each(|sample| {
            plot.push(self.entry, sample);
            Ok(())
        });
        plot.figure(self.entry, self.title())
    }

    /// The motion in three dimensions, to be opened in a browser.
    pub fn page(&self) -> Page {
        let mut player = HtmlPlayer::new(self.entry, &self.job());
        // recording does not fail
        let _ = self.each(|sample| {
            player.push(sample);
            Ok(())
        });
        let Job { step, steps, .. } = self.job();
        let parameters = &self.setup.parameters;
        // what acted on what was measured elsewhere is not known
        player.page(self.entry, &Heading { title: self.title(), parameters, step, steps, law: None })
    }

    fn title(&self) -> String {
        format!("{}, {}", self.entry.name, self.scheme)
    }

    fn each(&self, mut show: impl FnMut(&Sample<'_>) -> Result<(), Error>) -> Result<(), Error> {
        for (index, Moment { time, state, energy, casimirs }) in (0..).zip(&self.moments) {
            let (time, energy) = (*time, *energy);
            show(&Sample { index, time, state, energy, casimirs, snapshot: &Vec::new })?;
        }
        Ok(())
    }

    /// As many steps as there are states behind the first, of their mean size.
    fn job(&self) -> Job {
        let steps = (self.moments.len() as u64).saturating_sub(1);
        let span = match (self.moments.first(), self.moments.last()) {
            (Some(first), Some(last)) => last.time - first.time,
            _ => 0.0,
        };
        let (method, retraction, order) = (Method::Standard, Retraction::Exponential, Order::Two);
        Job { method, retraction, order, step: span / steps.max(1) as f64, steps }
    }

    /// What is known of what made it: no scheme of the program's.
    fn provenance(&self) -> Provenance {
        Provenance {
            method: self.scheme.clone(),
            retraction: None,
            order: 0,
            digest: String::new(),
            ..Provenance::of_run(self.entry, &self.setup, &self.job(), 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_systems::HeavyTop;

    #[test]
    fn a_table_a_plot_and_a_page_show_what_was_given() {
        let (top, start) = HeavyTop::example();
        let moments = (0..5).map(|k| (0.5 * f64::from(k), start));
        let trajectory = Trajectory::new(&top, "measured", moments);
        let path = std::env::temp_dir().join(format!("coadjoint-trajectory-{}.csv", std::process::id()));
        trajectory.write(&path).expect("writable");
        let table = std::fs::read_to_string(&path).expect("written");
        let _ = std::fs::remove_file(&path);
        let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!(rows.len(), 6);
        assert_eq!(rows[5].split(',').next(), Some("2.0"));
        assert!(table.contains("\"method\":\"measured\""), "{table}");
        assert!(trajectory.plot().svg().contains("heavy_top, measured"));
        let page = trajectory.page();
        assert_eq!((page.time.len(), page.time[4]), (5, 2.0));
        assert!(trajectory.write(Path::new("motion.txt")).is_err());
        let none = Trajectory::new(&top, "nothing", []);
        assert!(none.plot().svg().contains("svg") && none.page().time.is_empty());
    }
}
