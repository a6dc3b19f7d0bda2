//! Documentation of a system, on the user's struct.

use proc_macro2::TokenStream;

use super::docs;
use super::names::Names;
use crate::diagnostics::list;
use crate::program::{Documentation, Input, Interface, Program, StepRole};

/// Documentation for the user's struct: equations of motion, invariants, what a step costs.
pub(super) fn description(program: &Program, names: &Names) -> TokenStream {
    let Documentation { coordinates, equations, .. } = &program.interface.documentation;
    let mut lines = vec![
        String::new(),
        "# Derived".to_owned(),
        String::new(),
        format!("State: [`{}`]. Equations of motion, {}:", names.state, coordinates),
        String::new(),
        "```text".to_owned(),
    ];
    lines.extend(equations.iter().cloned());
    lines.push("```".to_owned());
    lines.push(String::new());
    lines.extend(invariants(&program.interface));
    lines.push("What a step computes, once and for each Newton iteration:".to_owned());
    lines.push(String::new());
    for step in &program.steps {
        let of = |role| step.module.operations(role);
        let once = of(StepRole::Begin) + of(StepRole::Finish);
        let evaluate = step.module.function(StepRole::Evaluate);
        let is_explicit = evaluate.is_none_or(|function| function.length(Input::Unknown) == 0);
        let (once, iteration) = match is_explicit {
            true => (once + of(StepRole::Evaluate), "it is explicit".to_owned()),
            false => (once, format!("each iteration {}", of(StepRole::Evaluate) + of(StepRole::Correction))),
        };
        lines.push(format!("* `{}`: {once}; {iteration}.", step.scheme.type_name()));
        for alias in &step.aliases {
            lines.push(format!("* `{}`: the same map.", alias.type_name()));
        }
    }
    docs::lines(lines)
}

/// The invariants of the motion, as a paragraph; nothing if it keeps nothing that is known.
fn invariants(interface: &Interface) -> Vec<String> {
    let Interface { casimirs, missing_casimirs, is_autonomous, controls, .. } = interface;
    let mut invariants = Vec::new();
    if !casimirs.is_empty() {
        invariants.push(format!(
            "{}, Casimirs or momenta of symmetries, up to accumulated rounding",
            list(casimirs)
        ));
    }
    if *missing_casimirs > 0 {
        let more = if casimirs.is_empty() { "" } else { "more " };
        // one may be such a polynomial whose coefficients were too large to be told
        let which = match missing_casimirs {
            1 => "Casimir that is no polynomial",
            _ => "Casimirs that are no polynomials",
        };
        invariants.push(format!("{missing_casimirs} {more}{which} of a low degree with small coefficients"));
    }
    if *is_autonomous {
        let held = if controls.is_empty() { "" } else { " as long as the controls are the same" };
        invariants.push(format!("the energy{held}, up to a bounded error of the scheme's order in the step"));
    }
    match invariants.is_empty() {
        true => Vec::new(),
        false => vec![format!("Invariants: {}.", invariants.join("; ")), String::new()],
    }
}
