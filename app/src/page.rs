//! An HTML page that animates a run: one self-contained file.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use coadjoint::system::{Quantity, Role};

use crate::entry::{Entry, component_name};
use crate::run_plot::symbols;
use crate::session::{Plan, title};
use crate::setting::{laid_out, rotation};
use crate::simulation::{Job, Sample};

/// The page; the data go where [`PLACE`] stands.
const PAGE: &str = include_str!("page.html");
const PLACE: &str = "__COADJOINT_DATA__";

/// At most so many frames: more than a screen shows.
const FRAMES: u64 = 2000;

/// Evenly spaced samples of a run, and the page that animates them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct HtmlPlayer {
    every: u64,
    last: u64,
    times: Vec<f64>,
    states: Vec<Vec<f64>>,
    energies: Vec<f64>,
    casimirs: Vec<Vec<f64>>,
}

impl HtmlPlayer {
    /// For a run that is about to start.
    pub(crate) fn new(_: &Entry, job: &Job) -> Self {
        let (times, states, energies, casimirs) = Default::default();
        Self { every: job.steps.div_ceil(FRAMES).max(1), last: job.steps, times, states, energies, casimirs }
    }

    /// Whether it fits this system.
    pub(crate) fn is_of(&self, entry: &Entry) -> bool {
        let (numbers, casimirs) = (entry.example.state.len(), entry.description.casimirs.len());
        self.states.iter().all(|state| state.len() == numbers)
            && self.casimirs.iter().all(|values| values.len() == casimirs)
    }

    /// Adds a sample of the run.
    pub(crate) fn push(&mut self, sample: &Sample<'_>) {
        if sample.index.is_multiple_of(self.every) || sample.index == self.last {
            self.times.push(sample.time);
            self.states.push(sample.state.to_vec());
            self.energies.push(sample.energy);
            self.casimirs.push(sample.casimirs.to_vec());
        }
    }

    /// The page.
    pub(crate) fn html(&self, entry: &Entry, plan: &Plan) -> String {
        // a `<` inside a script could end it
        let data = self.data(entry, plan).to_string().replace('<', "\\u003c");
        let (before, after) = PAGE.split_once(PLACE).unwrap_or((PAGE, ""));
        [before, &data, after].concat()
    }

    fn data(&self, entry: &Entry, plan: &Plan) -> Value {
        let mut columns = Vec::new();
        let mut rows = serde_json::Map::new();
        let mut frames: Vec<(&str, Option<Value>, Option<Value>)> = Vec::new();
        let (mut points, mut vectors) = (Vec::new(), Vec::new());
        for (quantity, slots) in laid_out(entry.description.state) {
            for (component, slot) in quantity.components.iter().zip(slots.clone()) {
                let name = component_name(quantity, component);
                columns.push(json!({ "name": name }));
                rows.insert(name, self.states.iter().map(|state| state[slot]).collect());
            }
            let start = slots.start;
            match (quantity.role, rotation(quantity)) {
                (Role::Configuration, Some((count, _))) => {
                    let turns = self.path(|state| in_space(&state[start..start + count]));
                    let rest = slots.len() - count;
                    let place = (rest > 0)
                        .then(|| self.path(|state| padded(&state[start + count..start + count + rest])));
                    frames.push((quantity.name, Some(turns), place));
                }
                (Role::Configuration, None) if slots.len() <= 3 => {
                    let path = self.path(|state| padded(&state[slots.clone()]));
                    points.push((quantity, path));
                }
                (Role::Advected, _) if slots.len() == 3 => {
                    let path = self.path(|state| padded(&state[slots.clone()]));
                    vectors.push(json!({
                        "name": quantity.name,
                        "label": format!("{} seen from the body", symbols(quantity.name)),
                        "path": path,
                    }));
                }
                _ => {}
            }
        }
        // a body with a rotation and a position as factors of their own is one body
        if let ([(_, Some(_), place @ None)], [_]) = (&mut frames[..], &points[..]) {
            *place = points.pop().map(|(_, path)| path);
        }
        let bodies: Vec<Value> = frames
            .into_iter()
            .map(|(name, turns, place)| json!({ "name": name, "rotation": turns, "position": place }))
            .collect();
        let points: Vec<Value> = points
            .into_iter()
            .map(|(quantity, path): (&Quantity, Value)| {
                json!({ "name": quantity.name, "label": quantity.name, "path": path, "rod": false })
            })
            .collect();
        let difference =
            |values: Vec<f64>| values.iter().map(|value| value - values[0]).collect::<Vec<f64>>();
        let mut errors = Vec::new();
        if entry.description.autonomous && !self.energies.is_empty() {
            errors.push(json!({
                "name": "energy", "unit": "J", "kind": "energy", "values": difference(self.energies.clone()),
            }));
        }
        for (i, (name, unit)) in entry.casimirs().enumerate() {
            let values = difference(self.casimirs.iter().map(|casimirs| casimirs[i]).collect());
            errors.push(json!({ "name": symbols(name), "unit": unit, "kind": "casimir", "values": values }));
        }
        json!({
            "title": entry.name,
            "about": entry.about,
            "subtitle": format!("{}, {} steps", title(entry, &plan.job), plan.job.steps),
            "time": self.times,
            "columns": columns,
            "rows": rows,
            "bodies": bodies,
            "points": points,
            "vectors": vectors,
            "errors": errors,
        })
    }

    fn path<const N: usize>(&self, of: impl Fn(&[f64]) -> [f64; N]) -> Value {
        self.states.iter().map(|state| of(state).to_vec()).collect()
    }
}

/// The quaternion of a rotation in space, or of one in the plane, which turns about the third axis.
fn in_space(rotation: &[f64]) -> [f64; 4] {
    match *rotation {
        [w, x, y, z] => [w, x, y, z],
        [re, im] => {
            let half = 0.5 * im.atan2(re);
            [half.cos(), 0.0, 0.0, half.sin()]
        }
        _ => [1.0, 0.0, 0.0, 0.0],
    }
}

/// A vector in space of one that may have fewer components.
fn padded(vector: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| vector.get(i).copied().unwrap_or(0.0))
}
