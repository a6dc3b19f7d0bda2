//! The plot of one run: the state, and the errors of the conserved quantities.

use serde::{Deserialize, Serialize};

use crate::entry::Entry;
use crate::plot::{Axis, Envelope, Figure, Key, Panel, Series};
use crate::report::with_unit;
use crate::setting::{laid_out, rotation};
use crate::simulation::{Job, Sample};

/// The plot shows the extremes in each of this many bins of the run.
const BINS: usize = 450;
const TIME: &str = "time, s";

/// Records the series of a run for its plot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct RunPlot {
    span: (f64, f64),
    /// Energy and Casimirs at the start.
    reference: Option<(f64, Vec<f64>)>,
    state: Vec<Envelope>,
    energy: Envelope,
    casimirs: Vec<Envelope>,
}

impl RunPlot {
    /// For a run that is about to start.
    pub(crate) fn new(entry: &Entry, job: &Job) -> Self {
        let envelope = Envelope::new(job.steps + 1, BINS);
        let components = entry.description.state.iter().map(|quantity| quantity.components.len()).sum();
        let end = job.steps as f64 * job.step;
        Self {
            span: (end.min(0.0), end.max(0.0)),
            reference: None,
            state: vec![envelope.clone(); components],
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.description.casimirs.len()],
        }
    }

    /// Whether it fits this system.
    pub(crate) fn is_of(&self, entry: &Entry) -> bool {
        self.state.len() == entry.example.state.len()
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, entry: &Entry, sample: &Sample<'_>) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        for (envelope, component) in self.state.iter_mut().zip(sample.state) {
            envelope.push(sample.index, sample.time, *component);
        }
        // where energy is not conserved, its value is shown
        let shown =
            if entry.description.autonomous { (sample.energy - *energy).abs() } else { sample.energy };
        self.energy.push(sample.index, sample.time, shown);
        for ((envelope, now), initially) in self.casimirs.iter_mut().zip(sample.casimirs).zip(casimirs) {
            envelope.push(sample.index, sample.time, (now - *initially).abs());
        }
    }

    /// A panel for each part of the state, one for energy, and one for each Casimir.
    pub(crate) fn figure(&self, entry: &Entry, title: String) -> Figure {
        let mut panels = Vec::new();
        for (quantity, slots) in laid_out(entry.description.state) {
            let series: Vec<Series> = quantity
                .components
                .iter()
                .zip(&self.state[slots])
                .map(|(component, envelope)| Series::line(*component, envelope.both()))
                .collect();
            let mut panel = |part: &str, series: &[Series]| {
                let label = format!("{}{part}", quantity.name.replace('_', " "));
                panels.push(Panel::new(Axis::linear(TIME), Axis::linear(label), series.to_vec()));
            };
            // a rigid motion is of two kinds
            match rotation(quantity) {
                Some((count, _)) if count < series.len() => {
                    panel(", rotation", &series[..count]);
                    panel(", translation", &series[count..]);
                }
                _ => panel("", &series),
            }
        }
        let mut alone = |axis: Axis, points| {
            panels.push(Panel::new(Axis::linear(TIME), axis, vec![Series::line("", points)]));
        };
        if entry.description.autonomous {
            alone(Axis::logarithmic("error of energy, J"), self.energy.upper());
        } else {
            alone(Axis::linear("energy, J"), self.energy.both());
        }
        for ((name, unit), envelope) in entry.casimirs().zip(&self.casimirs) {
            let label = with_unit(&format!("error of {}", symbols(name)), unit);
            alone(Axis::logarithmic(label), envelope.upper());
        }
        Figure::over_time(title, TIME, self.span, Key::Each, panels)
    }
}

/// Casimirs in the letters of the literature, which are also shorter.
pub(crate) fn symbols(name: &str) -> String {
    name.replace("angular_momentum", "Π")
        .replace("linear_momentum", "P")
        .replace("attitude_momentum", "Π")
        .replace("rotor_momentum", "ℓ")
        .replace("momentum", "Π")
        .replace("gamma", "Γ")
        .replace("field", "B")
        .replace("impulse", "P")
}
