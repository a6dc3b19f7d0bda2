//! The plot of an ensemble: how its members spread over time.

use coadjoint::ensemble::Spread;

use super::{Axis, Color, Figure, Key, Panel, Series};
use crate::catalogue::{Entry, Observable};
use crate::simulate::ensemble::{EnsembleSpec, EnsembleSummary};
use crate::units::{grouped, range, with_unit};

/// Between which quantiles the bands lie, from the widest, how they are called, and how they cover what is below.
const BANDS: [(usize, usize, &str, f64); 3] =
    [(0, 6, "all members", 0.18), (1, 5, "nine tenths", 0.25), (2, 4, "half", 0.35)];

/// A panel for each quantity: the median in bands that hold more and more members.
pub(crate) fn figure(
    entry: &Entry,
    observables: &[Observable],
    summary: &EnsembleSummary,
    spec: &EnsembleSpec,
    spread: &[String],
) -> Figure {
    const TIME: &str = "time, s";
    let panel = |(Observable { name, unit, .. }, spreads): (&Observable, &Vec<Spread>)| {
        let edge = |k: usize| {
            let points = spreads.iter().filter(|spread| spread.members > 0);
            points.map(|spread| (spread.time, spread.quantiles[k])).collect::<Vec<_>>()
        };
        let bands = BANDS
            .map(|(low, high, label, opacity)| Series::band(label, Color::X, opacity, edge(low), edge(high)));
        let series = bands.into_iter().chain([Series::line("median", Color::X, edge(3))]).collect();
        let label = with_unit(&name.replace('_', " "), unit);
        Panel::new(Axis::linear(TIME), Axis::linear(label), series)
    };
    let panels: Vec<Panel> = observables.iter().zip(&summary.spreads).map(panel).collect();
    let span = range(summary.spreads.iter().flatten().map(|spread| spread.time));
    let mut title = format!(
        "{} of {}, {}",
        grouped(spec.members as u64),
        entry.name,
        spread.iter().map(|spread| spread.replacen('=', " ± ", 1)).collect::<Vec<_>>().join(", ")
    );
    if summary.failures > 0 {
        title += &format!("; {} failed on the way", grouped(summary.failures));
    }
    Figure::over_time(title, TIME, span, Key::Above, panels).in_columns()
}
