//! What was measured.

use core::fmt;

use crate::schemes::Properties;

/// Certificates of the steps of one scheme for one system, or of the [laws](super::group_laws) of its group.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// The system's name.
    pub system: &'static str,
    /// The scheme's type; none where the group is measured, as in the next two.
    pub scheme: Option<String>,
    /// What the scheme promises.
    pub properties: Option<Properties>,
    /// The step; the smallest, where the samples' motions ask for different ones.
    pub step: Option<f64>,
    /// What was measured.
    pub certificates: Vec<Certificate>,
}

/// A claim, measured.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// What was measured.
    pub name: String,
    /// The worst figure of all sample states; not a number if there is none.
    pub figure: f64,
    /// Which of the states it belongs to, from 0.
    pub state: usize,
    /// What the figure must keep to; none if the scheme claims nothing of it.
    pub bound: Option<Bound>,
    /// Whether it does.
    pub verdict: Verdict,
}

/// What a figure must keep to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Bound {
    /// It must not be larger.
    AtMost(f64),
    /// It must not be smaller.
    AtLeast(f64),
}

/// What a certificate says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum Verdict {
    /// The claim holds.
    Passed,
    /// The claim is wrong.
    Failed,
    /// The scheme does not claim it.
    NotClaimed,
    /// Nothing could be measured: there is nothing to compare with, or the samples show nothing but roundoff.
    NotMeasured,
}

impl Certificate {
    /// A figure against its bound, with the state that it belongs to; none if there was nothing to measure.
    pub(super) fn new(name: &str, worst: Option<(f64, usize)>, bound: Option<Bound>) -> Self {
        let verdict = match (worst, bound) {
            (None, _) => Verdict::NotMeasured,
            (_, None) => Verdict::NotClaimed,
            (Some((figure, _)), Some(bound)) if bound.holds(figure) => Verdict::Passed,
            _ => Verdict::Failed,
        };
        let (figure, state) = worst.unwrap_or((f64::NAN, 0));
        Self { name: name.to_owned(), figure, state, bound, verdict }
    }
}

impl Bound {
    /// Whether a figure keeps to it; what is not a number does not.
    pub fn holds(self, figure: f64) -> bool {
        match self {
            Self::AtMost(bound) => figure <= bound,
            Self::AtLeast(bound) => figure >= bound,
        }
    }
}

impl Report {
    /// Whether no claim is wrong.
    pub fn passed(&self) -> bool {
        self.certificates.iter().all(|certificate| certificate.verdict != Verdict::Failed)
    }

    /// The claims that are wrong.
    pub fn failures(&self) -> impl Iterator<Item = &Certificate> {
        self.certificates.iter().filter(|certificate| certificate.verdict == Verdict::Failed)
    }

    /// The certificate of this name.
    pub fn certificate(&self, name: &str) -> Option<&Certificate> {
        self.certificates.iter().find(|certificate| certificate.name == name)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Passed => "passed",
            Self::Failed => "FAILED",
            Self::NotClaimed => "not claimed",
            Self::NotMeasured => "not measured",
        })
    }
}

/// What fits beside the figures in 80 columns.
const WIDEST: usize = 44;

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.scheme, self.step) {
            (Some(scheme), Some(step)) => writeln!(f, "{}, {scheme}, step {step:.3e}", self.system)?,
            _ => writeln!(f, "{}, its group", self.system)?,
        }
        let width = self.certificates.iter().map(|c| c.name.chars().count()).max().unwrap_or_default();
        let width = width.min(WIDEST);
        write!(f, "{:width$}  {:>9}  {:>9}  verdict", "certificate", "figure", "bound")?;
        for Certificate { name, figure, bound, verdict, .. } in &self.certificates {
            // orders are numbers of the size of 1, all others small ones
            let number = |x: f64| match x {
                x if x.is_nan() && *verdict == Verdict::NotMeasured => "—".to_owned(),
                x if x == 0.0 || (0.1..100.0).contains(&x.abs()) => format!("{x:.2}"),
                x => format!("{x:.1e}"),
            };
            let bound = match bound {
                Some(Bound::AtMost(bound)) => format!("≤ {}", number(*bound)),
                Some(Bound::AtLeast(bound)) => format!("≥ {}", number(*bound)),
                None => String::new(),
            };
            // the Casimirs of some groups are polynomials of a hundred terms
            let name = match name.chars().count() > WIDEST {
                true => name.chars().take(WIDEST - 1).chain(['…']).collect(),
                false => name.clone(),
            };
            write!(f, "\n{name:width$}  {:>9}  {bound:>9}  {verdict}", number(*figure))?;
        }
        Ok(())
    }
}
