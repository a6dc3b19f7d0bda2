//! Motions in memory as tables, plots and pages, from whatever computed them.

use std::path::Path;

use coadjoint::State;
use serde_json::json;

use super::overwrite::OverwriteGuard;
use super::run_json::{FileOrigin, Status, by_name};
use super::table::TrajectoryWriter;
use crate::catalogue::{Entry, Example, Observables, Setup};
use crate::error::{Error, SetupError};
use crate::page::{Page, PageHeading, page};
use crate::picture::{Figure, run_figure};
use crate::record::{ConservationReport, Curves, PageRecorder, RecordedSample, Recorders, Sample, Samples};
use crate::setup::Format;

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
    entry: Entry,
    setup: Setup,
    scheme: String,
    samples: Samples,
}

impl Trajectory {
    /// Collects the states of a system at these times, s, with a word on what computed them. The energy is that with
    /// the controls of the system's own law.
    pub fn new<S: Example>(
        system: &S,
        scheme: &str,
        moments: impl IntoIterator<Item = (f64, S::State)>,
    ) -> Self {
        let erased: &dyn coadjoint::erased::System = system;
        // what acted on what was measured elsewhere is not known
        let entry = Entry::of::<S>().without_controls();
        let setup = Setup { parameters: erased.parameters(), ..entry.example.clone() };
        let law = entry.law(&setup);
        let sample = |(index, (time, state)): (u64, (f64, S::State))| {
            let state = state.to_components().as_ref().to_vec();
            let energy = entry.energy(erased, law.as_ref(), (&state, time));
            let (casimirs, angles) = (erased.casimirs(&state), Vec::new());
            RecordedSample { index, time, numbers: state, energy, casimirs, angles }
        };
        let samples = Samples((0..).zip(moments).map(sample).collect());
        let first = samples.0.first().map(|first| first.numbers.clone());
        let setup = Setup { state: first.unwrap_or_else(|| entry.example.state.clone()), ..setup };
        Self { entry, setup, scheme: scheme.to_owned(), samples }.observed()
    }

    /// Adds quantities to those of [`Example::observables`], with the controls of the system's own law.
    #[must_use]
    pub fn observing<S: Example>(mut self, own: Observables<S>) -> Self {
        self.entry = self.entry.with_observables(own.erased());
        self.observed()
    }

    /// Evaluates the quantities at each sample.
    fn observed(mut self) -> Self {
        let (system, law) = (self.entry.system(&self.setup.parameters), self.entry.law(&self.setup));
        for RecordedSample { time, numbers, .. } in &mut self.samples.0 {
            numbers.truncate(self.setup.state.len());
            let control = law.as_ref().map(|law| self.entry.chosen(law, (numbers, *time)));
            *numbers = self.entry.shown(&*system, (numbers, *time), &control.unwrap_or_default());
        }
        self
    }

    /// Writes a table, in the format that the extension of its name says: `csv`, `json`, with the feature `parquet`
    /// also `parquet`; beside it `NAME.run.json` says what it is of. A file that is there is replaced.
    ///
    /// # Errors
    /// If there is no such format, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = Format::of_extension(&extension).ok_or_else(|| {
            SetupError::new(format!("{}: there is no format of tables `{extension}`", path.display()))
        })?;
        let format = format.checked()?;
        let Some(first) = self.samples.0.first() else {
            return Err(SetupError::new("a trajectory without a state is no table").into());
        };
        let origin = self.origin();
        let mut writer = TrajectoryWriter::create(path, format, self.entry.columns(), &origin)?;
        let mut conservation = ConservationReport::at(first.time, first.energy, &first.casimirs);
        let mut written = Ok(());
        self.replay(|sample| {
            conservation.push(sample);
            written =
                std::mem::replace(&mut written, Ok(())).and_then(|()| writer.row(&sample.row(&self.entry)));
        });
        written?;
        let file = writer.finish(&self.entry, &conservation, None)?;
        OverwriteGuard::new(origin, true).put(vec![file], Status::Complete)?;
        Ok(())
    }

    /// Draws what moves, and the errors of what is conserved, over time.
    pub fn plot(&self) -> Figure {
        let recorded = self.recorded(Some(Curves::new(&self.entry, self.step())), None);
        let curves = recorded.curves.unwrap_or_else(|| Curves::new(&self.entry, self.step()));
        run_figure(&curves, &self.entry, self.title())
    }

    /// Shows the motion in three dimensions, to be opened in a browser.
    pub fn page(&self) -> Page {
        let (step, steps) = self.step();
        let recorder = self.recorded(None, Some(PageRecorder::new(steps))).page.unwrap_or_default();
        let heading = PageHeading { title: self.title(), parameters: &self.setup.parameters, step, steps };
        page(&recorder, &self.entry, &heading)
    }

    /// Shows all samples to these recorders.
    fn recorded(&self, curves: Option<Curves>, page: Option<PageRecorder>) -> Recorders {
        let mut recorders = Recorders::of(curves, page);
        let system = self.entry.system(&self.setup.parameters);
        self.replay(|sample| recorders.push(&self.entry, &*system, sample));
        recorders
    }

    fn replay(&self, observe: impl FnMut(&Sample<'_>)) {
        self.samples.replay(self.setup.state.len(), observe);
    }

    fn title(&self) -> String {
        format!("{}, {}", self.entry.name, self.scheme)
    }

    /// Counts the states behind the first as steps of their mean size.
    fn step(&self) -> (f64, u64) {
        let samples = &self.samples.0;
        let steps = (samples.len() as u64).saturating_sub(1);
        let span = samples.last().zip(samples.first()).map_or(0.0, |(last, first)| last.time - first.time);
        (span / steps.max(1) as f64, steps)
    }

    fn origin(&self) -> FileOrigin {
        let origin = FileOrigin::of_command("Trajectory::write").with("system", json!(self.entry.name));
        let description = &self.entry.description;
        let parameters = by_name(description.parameters, &self.setup.parameters);
        let state = by_name(description.state, &self.setup.state);
        origin
            .with("parameters", parameters.into())
            .with("state", state.into())
            .with("scheme", json!(self.scheme))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::HeavyTop;

    #[test]
    fn a_table_a_plot_and_a_page_show_what_was_given() {
        let (top, start) = HeavyTop::example();
        let moments = (0..5).map(|k| (0.5 * f64::from(k), start));
        let trajectory = Trajectory::new(&top, "measured", moments);
        let path = std::env::temp_dir().join(format!("coadjoint-trajectory-{}.csv", std::process::id()));
        trajectory.write(&path).expect("writable");
        let table = std::fs::read_to_string(&path).expect("written");
        let made = std::fs::read_to_string(path.with_extension("run.json")).expect("written");
        let _ = std::fs::remove_file(path.with_extension("run.json"));
        let _ = std::fs::remove_file(path);
        let rows: Vec<&str> = table.lines().collect();
        assert_eq!(rows.len(), 6);
        assert!(rows[0].starts_with("time,attitude_w,"), "{}", rows[0]);
        assert_eq!(rows[5].split(',').next(), Some("2.0"));
        assert!(
            made.contains("\"scheme\": \"measured\"") && made.contains("\"system\": \"heavy_top\""),
            "{made}"
        );
        assert!(trajectory.plot().svg().contains("heavy_top, measured"));
        assert!(trajectory.write(Path::new("motion.txt")).is_err());
        let page = trajectory.page();
        assert_eq!((page.time.len(), page.time[4]), (5, 2.0));
        let page = trajectory
            .observing(Observables::<HeavyTop>::default().with("late", "s", |_, _, time, _| time - 1.0))
            .page();
        let late = page.runs[0].plots.iter().find(|plot| plot.name == "late").expect("it is there");
        assert_eq!((late.unit.as_str(), &late.series[0].values[..]), ("s", &[-1.0, -0.5, 0.0, 0.5, 1.0][..]));
        let none = Trajectory::new(&top, "nothing", []);
        assert!(none.plot().svg().contains("svg") && none.page().time.is_empty());
    }
}
