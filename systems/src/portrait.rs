//! The picture of one run: what moves, and how well what should stay does.

use crate::catalogue::Entry;
use crate::plot::{Envelope, Figure, Key, Panel, Scale, Series};
use crate::report::with_unit;
use crate::setting::{laid_out, rotation};
use crate::simulation::{Job, Sample};

/// The picture shows the extremes in each of this many parts of the run.
const PARTS: usize = 450;

/// Gathers a run's courses as it goes.
pub struct Portrait {
    entry: &'static Entry,
    span: (f64, f64),
    /// Energy and Casimirs at the start.
    reference: Option<(f64, Vec<f64>)>,
    state: Vec<Envelope>,
    energy: Envelope,
    casimirs: Vec<Envelope>,
}

impl Portrait {
    /// Of a run that is about to start.
    pub fn new(entry: &'static Entry, job: &Job) -> Self {
        let envelope = Envelope::new(job.steps + 1, PARTS);
        let components = entry.state.iter().map(|quantity| quantity.components.len()).sum();
        let end = job.steps as f64 * job.step;
        Self {
            entry,
            span: (end.min(0.0), end.max(0.0)),
            reference: None,
            state: vec![envelope.clone(); components],
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.casimirs.len()],
        }
    }

    /// Takes in a moment of the run.
    pub fn push(&mut self, sample: &Sample<'_>) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        for (envelope, component) in self.state.iter_mut().zip(sample.state) {
            envelope.push(sample.index, sample.time, *component);
        }
        // where energy changes, that is part of the motion
        let shown = if self.entry.autonomous { (sample.energy - *energy).abs() } else { sample.energy };
        self.energy.push(sample.index, sample.time, shown);
        for ((envelope, now), initially) in self.casimirs.iter_mut().zip(sample.casimirs).zip(casimirs) {
            envelope.push(sample.index, sample.time, (now - *initially).abs());
        }
    }

    /// A panel for each part of the state, one for energy, and one for each Casimir.
    pub fn figure(&self, title: String) -> Figure {
        let mut panels = Vec::new();
        for (quantity, slots) in laid_out(self.entry.state) {
            let courses: Vec<Series> = quantity
                .components
                .iter()
                .zip(&self.state[slots])
                .map(|(component, envelope)| Series {
                    label: (*component).to_owned(),
                    points: envelope.both(),
                })
                .collect();
            let mut panel = |part: &str, series: &[Series]| {
                panels.push(Panel {
                    label: format!("{}{part}", quantity.name.replace('_', " ")),
                    scale: Scale::Linear,
                    series: series.to_vec(),
                });
            };
            // a rigid motion is of two kinds
            match rotation(quantity) {
                Some((count, _)) if count < courses.len() => {
                    panel(", rotation", &courses[..count]);
                    panel(", translation", &courses[count..]);
                }
                _ => panel("", &courses),
            }
        }
        let alone = |points| vec![Series { label: String::new(), points }];
        panels.push(if self.entry.autonomous {
            let series = alone(self.energy.upper());
            Panel { label: "error of energy, J".to_owned(), scale: Scale::Logarithmic, series }
        } else {
            Panel { label: "energy, J".to_owned(), scale: Scale::Linear, series: alone(self.energy.both()) }
        });
        let names = self.entry.casimirs.iter().zip(self.entry.casimir_units);
        for ((name, unit), envelope) in names.zip(&self.casimirs) {
            panels.push(Panel {
                label: with_unit(&format!("error of {}", symbols(name)), unit),
                scale: Scale::Logarithmic,
                series: alone(envelope.upper()),
            });
        }
        Figure { title, time: "time, s".to_owned(), span: self.span, key: Key::Each, panels }
    }
}

impl std::fmt::Debug for Portrait {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Portrait").field("system", &self.entry.name).finish_non_exhaustive()
    }
}

/// Casimirs in the letters of the literature, which are also shorter.
pub fn symbols(name: &str) -> String {
    name.replace("momentum.angular", "Π")
        .replace("momentum.linear", "P")
        .replace("attitude_momentum", "Π")
        .replace("rotor_momentum", "ℓ")
        .replace("momentum", "Π")
        .replace("gamma", "Γ")
        .replace("field", "B")
        .replace("impulse", "P")
}
