//! What was measured against what is allowed.

use std::collections::BTreeMap;

use super::matrix::Column;
use super::real::Real;
use super::trees::relative;

/// Checks differences against bounds, and prints the largest of each kind at the end (`--nocapture` shows them).
#[derive(Default)]
pub struct Residuals(BTreeMap<String, (f64, f64)>);

impl Residuals {
    /// Nothing measured so far.
    pub fn new() -> Self {
        Self::default()
    }

    /// `a = b` within a bound relative to their size where that exceeds one.
    pub fn agree(&mut self, what: &str, a: &Column, b: &Column, bound: f64) {
        self.vanish(what, &relative(a, b), bound);
    }

    /// `residual = 0` within a bound.
    pub fn vanish(&mut self, what: &str, residual: &Real, bound: f64) {
        let residual = residual.abs().to_f64();
        assert!(residual <= bound, "{what}: {residual:e} exceeds {bound:e}");
        let (worst, _) = self.0.entry(what.to_owned()).or_insert((0.0, bound));
        *worst = worst.max(residual);
    }
}

impl Drop for Residuals {
    fn drop(&mut self) {
        for (what, (worst, bound)) in &self.0 {
            println!("{what}: at most {worst:.1e}, bound {bound:e}");
        }
    }
}
