//! Axes: where values lie along them, and where their ticks are.

use super::number::{power_of_ten, short, with_minus};
use crate::units::range;

/// One axis of a panel.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The quantity, with its unit.
    pub label: String,
    /// How its values are spread.
    pub scale: Scale,
    /// From where to where; by the values where nothing is said.
    pub range: Option<(f64, f64)>,
}

/// How values are spread over an axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// Evenly, with ticks at whole numbers only.
    Counts,
    /// By powers of ten, for magnitudes; what is exactly zero lies on the lower edge.
    Logarithmic,
    /// These names at 1, 2, 3…
    Names(Vec<String>),
}

impl Axis {
    /// Of evenly spread values.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// Of whole numbers.
    pub fn counts(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Counts, range: None }
    }

    /// Of magnitudes, by powers of ten.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic, range: None }
    }

    /// Of names, which are at 1, 2, 3…
    pub fn names(names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let end = names.len() as f64 + 0.5;
        Self { label: String::new(), scale: Scale::Names(names), range: Some((0.5, end)) }
    }

    /// From `low` to `high`: values, also of a logarithmic axis.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }
}

/// The part of a linear axis that is free beyond the values at either end.
const MARGIN: f64 = 0.05;
/// More ticks with a number than this are not easier to read.
const TICKS: f64 = 7.0;
/// With more powers of ten than this, the numbers between them have no ticks.
const DECADES: f64 = 6.0;

/// Where values lie along an axis: at a part of its length, and its ticks.
#[derive(Clone, Debug)]
pub(super) struct Placement {
    scale: Scale,
    /// The ends; their logarithms of a logarithmic axis.
    pub(super) ends: (f64, f64),
}

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// As part of the axis.
    pub(super) at: f64,
    /// Nothing at a minor one.
    pub(super) label: Option<String>,
}

impl Placement {
    /// For these values. They reach to the very ends of a horizontal axis, where a line goes on to the edge.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, margin: bool) -> Self {
        let ends = match (&axis.scale, axis.range) {
            (Scale::Logarithmic, Some((low, high))) => (low.log10(), high.log10()),
            (Scale::Logarithmic, None) => decades(values),
            (_, Some(range)) => range,
            (_, None) => extent(values, margin),
        };
        let ends = if ends.0 < ends.1 && (ends.1 - ends.0).is_finite() { ends } else { (0.0, 1.0) };
        Self { scale: axis.scale.clone(), ends }
    }

    /// With other ends.
    pub(super) fn over(&self, ends: (f64, f64)) -> Self {
        Self { scale: self.scale.clone(), ends }
    }

    /// As part of the axis; beyond 0 and 1 outside of it.
    pub(super) fn place(&self, value: f64) -> f64 {
        let (low, high) = self.ends;
        let value = match self.scale {
            // the logarithm of zero is −∞, which lies on the edge
            Scale::Logarithmic if value == 0.0 => low,
            Scale::Logarithmic => value.abs().log10(),
            _ => value,
        };
        (value - low) / (high - low)
    }

    /// The ticks, with room for so many numbers.
    pub(super) fn ticks(&self, room: f64) -> Vec<Tick> {
        let most = room.clamp(2.0, TICKS);
        match &self.scale {
            Scale::Linear => self.linear(most, 0.0),
            Scale::Counts => self.linear(most, 1.0),
            Scale::Logarithmic => self.logarithmic(most),
            Scale::Names(names) => {
                let ticks = names.iter().zip(1..);
                let tick = |(name, k): (&String, i32)| Tick {
                    at: self.part(f64::from(k)),
                    label: Some(name.clone()),
                };
                ticks.map(tick).collect()
            }
        }
    }

    fn part(&self, place: f64) -> f64 {
        (place - self.ends.0) / (self.ends.1 - self.ends.0)
    }

    fn linear(&self, most: f64, least: f64) -> Vec<Tick> {
        let (low, high) = self.ends;
        let step = step((high - low) / most).max(least);
        let label = label(step, low.abs().max(high.abs()));
        let tick = |k: f64| Tick { at: self.part(k * step), label: Some(label(k * step)) };
        // an end may be a tick up to roundoff
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        (0..=100).map(|k| first + f64::from(k)).take_while(|k| *k <= last).map(tick).collect()
    }

    fn logarithmic(&self, most: f64) -> Vec<Tick> {
        let (low, high) = self.ends;
        let within = |place: f64| (low - 1e-9..=high + 1e-9).contains(&place);
        let decades = (low.floor() as i32..=high.ceil() as i32).map(f64::from);
        // every so many powers of ten
        let stride = step((high - low) / most).max(1.0);
        let is_narrow = high - low < 1.5;
        let mut ticks = Vec::new();
        for decade in decades {
            for digit in 1..10 {
                let place = decade + f64::from(digit).log10();
                if !within(place) {
                    continue;
                }
                let text = match digit {
                    1 if is_narrow => Some(short(10_f64.powf(decade))),
                    2 | 5 if is_narrow => Some(short(f64::from(digit) * 10_f64.powf(decade))),
                    1 if decade.rem_euclid(stride) == 0.0 => Some(power_of_ten(decade)),
                    _ => None,
                };
                if text.is_some() || digit == 1 || high - low <= DECADES {
                    ticks.push(Tick { at: self.part(place), label: text });
                }
            }
        }
        ticks
    }
}

/// How a tick's number is written, of ticks at this distance up to this magnitude: all with as many digits, and with
/// the same power of ten.
fn label(step: f64, largest: f64) -> impl Fn(f64) -> String {
    let power = if largest < 1e5 && step >= 1e-4 { 0.0 } else { largest.log10().floor() };
    let unit = 10.0_f64.powf(power);
    let places = ((unit / step).log10() - 1e-9).ceil().clamp(0.0, 9.0) as usize;
    move |value| {
        // none is −0
        if value.abs() < 1e-9 * step {
            let zeros = if power == 0.0 { places } else { 0 };
            return format!("{:.zeros$}", 0.0);
        }
        let digits = with_minus(&format!("{:.places$}", value / unit));
        if power == 0.0 { digits } else { format!("{digits}·{}", power_of_ten(power)) }
    }
}

/// The least round number that is not below this.
fn step(rough: f64) -> f64 {
    let decade = 10.0_f64.powf(rough.log10().floor());
    let digit = [1.0, 2.0, 5.0].into_iter().find(|digit| digit * decade >= rough * 0.999);
    digit.unwrap_or(10.0) * decade
}

/// From the least value to the greatest, with a margin or without.
fn extent(values: impl Iterator<Item = f64>, margin: bool) -> (f64, f64) {
    let (low, high) = range(values.filter(|value| value.is_finite()));
    if low > high {
        return (0.0, 1.0);
    }
    // what varies by roundoff alone is a straight line
    if high - low <= 1e-13 * high.abs().max(low.abs()) {
        let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
        return (low - half, high + half);
    }
    let free = if margin { MARGIN * (high - low) } else { 0.0 };
    (low - free, high + free)
}

/// Whole powers of ten around the magnitudes, as logarithms.
fn decades(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (least, greatest) = range(values.map(f64::abs).filter(|x| *x > 0.0 && x.is_finite()));
    // nothing but zeros: the place where roundoff would be
    if least > greatest {
        return (-17.0, -16.0);
    }
    let low = (least.log10() - 0.02).floor();
    (low, (greatest.log10() + 0.02).ceil().max(low + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let placement = Placement::new(axis, values.iter().copied(), false);
        placement.ticks(6.0).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn errors_below_1e_10_keep_their_place_and_zero_lies_on_the_edge() {
        let axis = Axis::logarithmic("error");
        let placement = Placement::new(&axis, [0.0, 3e-15, -2e-3].into_iter(), true);
        assert_eq!(placement.ends, (-15.0, -2.0));
        assert!((placement.place(3e-15) * 13.0 - 0.477_121_254_719_662).abs() < 1e-12);
        assert_eq!(placement.place(0.0), 0.0);
        assert_eq!(Placement::new(&axis, [0.0, 0.0].into_iter(), true).ends, (-17.0, -16.0));
        assert!(Placement::new(&axis.within(1e-3, 1e2), [1e7].into_iter(), true).place(1e7) > 1.0);
    }

    #[test]
    fn ticks_have_the_same_number_of_digits() {
        assert_eq!(labels(&Axis::linear("x").within(-0.5, 0.5), &[]), ["−0.4", "−0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(labels(&Axis::linear("x").within(0.0, 1800.0), &[]), ["0", "500", "1000", "1500"]);
        assert_eq!(
            labels(&Axis::linear("x"), &[0.0, 2e7]),
            ["0", "0.5·10⁷", "1.0·10⁷", "1.5·10⁷", "2.0·10⁷"]
        );
    }

    #[test]
    fn counts_are_whole_numbers_and_names_are_names() {
        assert_eq!(labels(&Axis::counts("iteration"), &[0.0, 3.0]), ["0", "1", "2", "3"]);
        assert_eq!(labels(&Axis::counts("iteration"), &[1.0, 2.0]), ["1", "2"]);
        assert_eq!(labels(&Axis::names(["I₁₁", "I₂₂"]), &[]), ["I₁₁", "I₂₂"]);
    }

    #[test]
    fn logarithmic_axes_have_minor_ticks() {
        let axis = Axis::logarithmic("error").within(1e-3, 1e0);
        let ticks = Placement::new(&axis, std::iter::empty(), true).ticks(6.0);
        assert_eq!(ticks.len(), 3 * 9 + 1);
        assert_eq!(labels(&axis, &[]), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        // within little more than a decade, numbers between too
        assert_eq!(labels(&Axis::logarithmic("H").within(0.5, 2.0), &[]), ["0.5", "1", "2"]);
        // over many decades, only powers of ten, and not all of them with a number
        let wide = Placement::new(&axis.within(1e-16, 1e0), std::iter::empty(), true).ticks(6.0);
        assert_eq!(wide.len(), 17);
        assert!(wide.iter().filter(|tick| tick.label.is_some()).count() <= 7);
    }

    #[test]
    fn values_that_do_not_vary_have_an_axis() {
        for values in [&[][..], &[0.0], &[3.0, 3.0], &[f64::NAN], &[1.0, 1.0 + 1e-15]] {
            for axis in [Axis::linear("x"), Axis::logarithmic("x"), Axis::counts("x")] {
                let placement = Placement::new(&axis, values.iter().copied(), true);
                assert!(placement.ends.0 < placement.ends.1, "{values:?}");
                assert!(placement.ticks(6.0).iter().all(|tick| tick.at.is_finite()));
            }
        }
    }
}
