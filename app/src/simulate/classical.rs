//! Classical methods for any system, by its vector field: for comparison, not for speed.

use std::sync::Arc;

use coadjoint::erased::{self, At};
use coadjoint::system::{Quantity, Role};
use coadjoint::{ParameterError, StepError};
use coadjoint_classical::Diverged;

use crate::catalogue::Input;
use crate::catalogue::quantities::tangent_length;
use crate::setup::Classical;

/// Builds a stepper that takes the steps of a classical method of any system, by its vector field, driven by an input if there is one.
///
/// # Errors
/// If parameters or step are not valid.
pub fn stepper(
    system: Arc<dyn erased::System>,
    classical: Classical,
    input: Option<Arc<Input>>,
    step: f64,
) -> Result<erased::Stepper, ParameterError> {
    let scheme = classical.runge_kutta();
    let algebra = (classical == Classical::Rkmk4).then(|| Algebra::of(&*system));
    // each stage asks for the input at its own time
    let control = move |time: f64, at: &At<'_>| {
        let mut control = at.control.to_vec();
        input.iter().for_each(|input| input.write(time, &mut control));
        control
    };
    erased::Stepper::from_fn(system, step, move |system, at: &At<'_>, next| {
        let Some(algebra) = &algebra else {
            // for the numbers of the state as they are stored
            let mut field = |time: f64, x: &[f64], rate: &mut [f64]| {
                rate.copy_from_slice(&system.vector_field(x, time, &control(time, at)));
            };
            let (end, iterations) =
                scheme.advance(&mut field, at.time, at.state, at.step).map_err(failure)?;
            next.copy_from_slice(&end);
            return Ok(iterations);
        };
        // in exponential coordinates about the start of the step, in which configurations stay on their groups: the
        // unknown is the displacement `z` from there, with `z' = (dL exp_z)⁻¹ ξ` for configurations
        let moved = |z: &[f64]| system.displace(at.state, erased::RetractionKind::Exponential, z);
        let mut field = |time: f64, z: &[f64], rate: &mut [f64]| {
            rate.copy_from_slice(&system.motion(&moved(z), time, &control(time, at)));
            algebra.correct(z, rate);
        };
        let start = vec![0.0; algebra.length];
        let (end, iterations) = scheme.advance(&mut field, at.time, &start, at.step).map_err(failure)?;
        next.copy_from_slice(&moved(&end));
        Ok(iterations)
    })
}

fn failure(error: Diverged) -> StepError {
    match error {
        Diverged::NoConvergence { iterations, correction } => {
            StepError::NoConvergence { iterations, residual: correction }
        }
        _ => StepError::NotFinite,
    }
}

/// The brackets of the configurations' algebras, in tangent vectors.
struct Algebra {
    /// `(i, j, k, c)`: the bracket of the directions `i` and `j` has `c` along `k`.
    constants: Vec<(usize, usize, usize, f64)>,
    /// The length of tangent vectors.
    length: usize,
}

impl Algebra {
    /// From the Poisson structure: `⟨ad*_ξ μ, η⟩ = ⟨μ, [ξ, η]⟩` where there is nothing but a momentum `μ`. Where
    /// displacements are from the left (`invariance = right`) its sign, and that of the bracket, is the one that the
    /// series wants there.
    fn of(system: &dyn erased::System) -> Self {
        let quantities = system.description().state;
        let length = tangent_length(quantities);
        let stored: usize = quantities.iter().map(|quantity| quantity.components.len()).sum();
        let mut constants = Vec::new();
        for ((momentum, slots), before) in Quantity::with_ranges(quantities).skip(1).zip(quantities) {
            if (before.role, momentum.role) != (Role::Configuration, Role::Momentum) {
                continue;
            }
            let (turns, momenta) = (before.tangent(), momentum.tangent());
            for (k, i) in turns.clone().enumerate().flat_map(|(k, _)| momenta.clone().map(move |i| (k, i))) {
                let mut state = vec![0.0; stored];
                state[slots.start + k] = 1.0;
                let mut covector = vec![0.0; length];
                covector[i] = 1.0;
                let coadjoint = system.hamiltonian_vector(&state, &covector);
                let i = i - momenta.start + turns.start;
                for (j, c) in turns.clone().zip(&coadjoint[momenta.clone()]).filter(|(_, c)| **c != 0.0) {
                    constants.push((i, j, turns.start + k, *c));
                }
            }
        }
        Self { constants, length }
    }

    /// Adds the bracket of two tangent vectors, times a number, to a third.
    fn add_bracket(&self, xi: &[f64], eta: &[f64], times: f64, to: &mut [f64]) {
        for &(i, j, k, c) in &self.constants {
            to[k] += times * c * xi[i] * eta[j];
        }
    }

    /// Turns `ξ` into `(dL exp_z)⁻¹ ξ`: into `ξ + ½ [z, ξ] + 1/12 [z, [z, ξ]]`, which leaves an order of 4.
    fn correct(&self, z: &[f64], rate: &mut [f64]) {
        let mut once = vec![0.0; self.length];
        self.add_bracket(z, rate, 1.0, &mut once);
        self.add_bracket(z, &once, 1.0 / 12.0, rate);
        rate.iter_mut().zip(&once).for_each(|(rate, once)| *rate += 0.5 * once);
    }
}
