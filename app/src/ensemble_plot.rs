//! The plot of an ensemble: how its members spread over time.

use coadjoint::ensemble::Spread;

use crate::ensemble::{EnsembleSpec, EnsembleSummary, Observable};
use crate::entry::Entry;
use crate::plot::{Axis, Figure, Key, Panel, Series};
use crate::report::grouped;

/// A panel for each quantity: the median in bands that hold more and more members.
pub(crate) fn figure(
    entry: &Entry,
    named: &[(String, Observable)],
    summary: &EnsembleSummary,
    spec: &EnsembleSpec,
    spread: &[String],
) -> Figure {
    let panel = |((name, _), spreads): (&(String, Observable), &Vec<Spread>)| {
        let edge = |k: usize| {
            let points = spreads.iter().filter(|spread| spread.members > 0);
            points.map(|spread| (spread.time, spread.quantiles[k])).collect::<Vec<_>>()
        };
        let bands = [(0, 6), (1, 5), (2, 4)].map(|(low, high)| Series::band(edge(low), edge(high)));
        let series = bands.into_iter().chain([Series::line("median", edge(3))]).collect();
        Panel::new(Axis::linear(""), Axis::linear(name), series)
    };
    let panels: Vec<Panel> = named.iter().zip(&summary.spreads).map(panel).collect();
    let times = |of: fn(f64, f64) -> f64| {
        let times = summary.spreads.iter().flatten().map(|spread| spread.time);
        times.reduce(of).unwrap_or(0.0)
    };
    let title = format!("{} of {}", grouped(spec.members as u64), entry.name);
    let mut figure =
        Figure::over_time(title, "time / s", (times(f64::min), times(f64::max)), Key::Below, panels);
    let mut caption = format!(
        "Members differ by {}, uniformly distributed. Line: the median; bands, from dark to light: a half, nine tenths, all of the members.",
        spread.join(", ")
    );
    if !summary.failed.is_empty() {
        caption += &format!(
            " {} failed on the way and are no longer counted.",
            grouped(summary.failed.len() as u64)
        );
    }
    figure.caption = vec![caption];
    figure
}
