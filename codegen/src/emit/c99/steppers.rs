//! Steppers: a step, or several composed, with what they remember.

use super::kernel::Kernel;
use super::names::snake_case;
use super::template::Words;
use crate::program::{Interface, Quantity};

const STEPPER: &str = include_str!("text/stepper.c");
const KERNELS: &str = include_str!("text/kernels.c");

/// A stepper, and the names in it.
pub(super) struct Stepper<'k> {
    /// The prefix of all that belongs to it, without an underscore at the end.
    pub(super) prefix: String,
    /// What it is, in a line.
    pub(super) about: String,
    /// The kernels of a step of order 2 or less, each with its share of it.
    pub(super) parts: Vec<&'k Kernel<'k>>,
    /// The coefficients of a composition; one alone stands for none.
    pub(super) gamma: Vec<f64>,
    /// Whether time has a part in any step.
    pub(super) is_timed: bool,
}

impl Stepper<'_> {
    /// All of it.
    pub(super) fn emit(&self, words: &Words, number: &dyn Fn(f64) -> String) -> String {
        let [first, last] = [self.parts[0], self.parts[self.parts.len() - 1]];
        let is_pair = self.parts.len() == 2;
        let is_composed = self.gamma.len() > 1;
        let part = |(kernel, nth): (&&Kernel<'_>, &str)| {
            Words::default()
                .with("NTH", nth)
                .with("SHARE", if is_pair { "p->half" } else { "step_size" })
                .prefix("L_", format!("{}_", kernel.prefix))
        };
        let parts = self.parts.iter().zip(["first", "second"]).map(part);
        let mut done = 0.0;
        let starts = self.gamma.iter().map(|gamma| {
            let start = number(done);
            done += gamma;
            start
        });
        let starts: Vec<String> = starts.collect();
        let gamma: Vec<String> = self.gamma.iter().map(|gamma| number(*gamma)).collect();
        let timed = |text: &str| if self.is_timed { text.to_owned() } else { String::new() };
        let is_fast = !is_composed && self.parts.iter().all(|kernel| kernel.is_fast());
        let count = if is_fast { "done + (unsigned long)steps" } else { "done" };
        let clock = format!("{}_clock(s, time, {count})", self.prefix);
        let words = words
            .clone()
            .prefix("X_", format!("{}_", self.prefix))
            .prefix("L1_", format!("{}_", first.prefix))
            .prefix("L2_", format!("{}_", last.prefix))
            .with("SIZE_1", first.size().to_string())
            .with("SIZE_2", last.size().to_string())
            .with("COUNT", self.gamma.len().to_string())
            .with("GAMMA", gamma.join(", "))
            .with("DONE", starts.join(", "))
            .with("ABOUT", &self.about)
            .with("TITLE", if is_composed { "of the composed steps" } else { "step" })
            .with("TIMED_HALF", timed(", time + p->half"))
            .with("TIMED_PART", timed(", time + done[i] * s->step_size"))
            .with("TIMED_NOW", timed(&format!(", {clock}")))
            .with("TIMED_THEN", timed(&format!(", {clock} + p->half")))
            .with("STARTS", if self.is_timed { ", which starts at this time" } else { "" })
            .holds("pair", is_pair)
            .holds("composed", is_composed)
            .holds("timed", self.is_timed)
            .with("TIMED_STAGE", timed(", from"))
            .with("TIMED_STAGE_HALF", timed(", from + p->half"))
            .holds("fast", is_fast)
            .each("part", parts.collect());
        words.fill(STEPPER)
    }

    /// The kernel that takes steps of many members on a GPU.
    pub(super) fn ensemble(&self, interface: &Interface, words: &Words) -> String {
        let count = |quantities: &[Quantity]| {
            quantities.iter().map(|quantity| quantity.components.len()).sum::<usize>()
        };
        let [parameters, state, control] =
            [&interface.parameters, &interface.state, &interface.controls].map(|all| count(all));
        let real = format!("{}_real", snake_case(&interface.name));
        let chunk = format!(", {}_clock(&s, time, done)", self.prefix);
        words
            .clone()
            .prefix("X_", format!("{}_", self.prefix))
            .with("ABOUT", &self.about)
            .with("MOST", parameters.max(state).max(control).to_string())
            .with("PARAMETER_COUNT", parameters.to_string())
            .with("STATE_COUNT", state.to_string())
            .with("CONTROL_COUNT", control.to_string())
            .with(
                "CONTROL_ARRAY",
                if control > 0 {
                    format!(", const {real} *controls, unsigned long intervals")
                } else {
                    String::new()
                },
            )
            .with("CONTROL_POINTER", if control > 0 { ", &control" } else { "" })
            .with("TIMED_CHUNK", if self.is_timed { chunk } else { String::new() })
            .holds("control", control > 0)
            .holds("parameters", parameters > 0)
            .holds("timed", self.is_timed)
            .fill(KERNELS)
    }
}
