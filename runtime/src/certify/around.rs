//! What lies around a state, for those who draw other states there.

use std::vec::Vec;

use super::frame::Frame;
use crate::erased::System;
use crate::retraction::Map;

/// The places of a state's numbers, and how far each leads to something else entirely.
#[derive(Clone, Debug)]
pub struct Around {
    /// One over the time in which the motion leads to something else entirely; 0 at rest.
    pub rate: f64,
    /// How far a component of a tangent vector leads to something else entirely.
    pub scale: Vec<f64>,
    /// The places of the configurations' components in tangent vectors.
    pub configuration: Vec<usize>,
    /// The places of momenta, then of advected parameters: in tangent vectors, and in the state's array.
    pub linear: Vec<[usize; 2]>,
    /// The places of the state's numbers, by blocks that have a unit in common.
    pub blocks: Vec<Vec<usize>>,
}

impl Around {
    /// What lies around this state. None if the displacements there make no local coordinates.
    pub fn state(system: &dyn System, state: &[f64], time: f64, control: &[f64]) -> Option<Self> {
        let frame = Frame::new(system, state, control, time)?;
        let blocks = frame.blocks();
        let Frame { rate, scale, configuration, linear, .. } = frame;
        let linear = linear.iter().map(|linear| [linear.tangent, linear.component]).collect();
        Some(Self { rate, scale, configuration, linear, blocks })
    }

    /// The state with its configurations displaced by multiples of their scales.
    pub fn moved(&self, system: &dyn System, state: &[f64], by: impl FnMut(usize) -> f64) -> Vec<f64> {
        let mut tangent = std::vec![0.0; self.scale.len()];
        let by = (0..self.configuration.len()).map(by);
        for (&i, by) in self.configuration.iter().zip(by) {
            tangent[i] = by * self.scale[i];
        }
        system.displace(state, Map::Exponential, &tangent)
    }
}
