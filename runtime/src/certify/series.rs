//! How far a Hamilton–Jacobi step goes along its series.

use super::frame::{Frame, larger};

/// How much of its series' reach a step may use. Of bodies, tops, pendulums, orbits and a quadrotor, with steps of the orders 4 to 10, the slope of
/// the error is that of the order up to 0.2 or 0.35, and less by one or more from 0.25 or 0.5 on.
pub const REACH: f64 = 0.35;

impl Frame<'_> {
    /// What share of its series' reach a step of this order uses, and of which [block](Self::blocks). In a power series each term is a power of
    /// that share: it is the root of what the last ones change, which is what two steps of half the length change of one, as a part of their way.
    pub fn share(&self, order: u32, states: [&[f64]; 4]) -> (f64, usize) {
        let [start, middle, end, whole] = states;
        let mut most = (0.0, 0);
        for (index, block) in self.blocks().iter().enumerate() {
            let apart =
                |a: &[f64], b: &[f64]| block.iter().map(|&i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
            let size = block.iter().map(|&i| end[i] * end[i]).sum::<f64>().sqrt();
            let (off, way) = (apart(whole, end), apart(start, middle) + apart(middle, end));
            // of what rests, rounding is all that changes
            if !(off <= 1e-12 * size) {
                let share = (off / way).powf(1.0 / f64::from(order));
                most = if larger(most.0, share) == most.0 { most } else { (share, index) };
            }
        }
        most
    }
}
