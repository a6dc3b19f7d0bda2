//! Derivatives of steps, as matrices.

use std::fmt::Write as _;

use super::code::{Arithmetic, Spelling};
use super::kernel::{Kernel, unused};
use super::names::value;
use super::template::Words;
use crate::program::{
    DerivativeRole, Function, FunctionRole as _, Interface, Module, Program, RecordKind, Term,
};

const DERIVATIVE: &str = include_str!("text/derivative.c");
const FOLLOW: &str = include_str!("text/follow.c");

/// Whether a program has matrices.
pub(super) fn is_there(program: &Program) -> bool {
    program.steps.iter().all(|step| has(step.derivative.as_ref(), DerivativeRole::WrtState))
        && !program.steps.is_empty()
}

fn has(module: Option<&Module<DerivativeRole>>, role: DerivativeRole) -> bool {
    module.is_some_and(|module| module.function(role).is_some())
}

/// What fills places of matrices.
fn words(interface: &Interface, module: &Module<DerivativeRole>, words: &Words) -> Words {
    let module = Some(module);
    words
        .clone()
        .with("PERTURBATIONS", interface.state_perturbation().to_string())
        .with("CONTROLS", interface.control_length().to_string())
        .with("PARAMETERS", interface.field_length().to_string())
        .with("DISPLACED", interface.side.displaced("d"))
        .holds("wrt_control", has(module, DerivativeRole::WrtControl) && interface.control_length() > 0)
        .holds("wrt_parameters", has(module, DerivativeRole::WrtParameters) && interface.field_length() > 0)
}

/// The struct of all matrices.
pub(super) fn structure(program: &Program, all: &Words) -> String {
    let Some(module) = program.steps.iter().find_map(|step| step.derivative.as_ref()) else {
        return String::new();
    };
    let perturbed = program.interface.state.iter().map(|part| {
        let (start, end) = (part.tangent.start, part.tangent.end);
        let range = if end == start + 1 {
            start.to_string()
        } else {
            format!("{start} to {}", end.saturating_sub(1))
        };
        Words::default().with("QUANTITY", &part.name).with("RANGE", range)
    });
    words(&program.interface, module, all).each("perturbed", perturbed.collect()).fill(DERIVATIVE)
}

/// The functions of one kernel.
pub(super) fn kernel(kernel: &Kernel<'_>, all: &Words) -> String {
    let Some(module) = &kernel.step.derivative else { return String::new() };
    let interface = kernel.spelling.interface;
    let maps = Maps { kernel, module };
    let mut text = maps.point();
    for role in [
        DerivativeRole::Through,
        DerivativeRole::WrtState,
        DerivativeRole::WrtControl,
        DerivativeRole::WrtParameters,
    ] {
        let Some(function) = module.function(role).filter(|function| !function.results.is_empty()) else {
            continue;
        };
        text += &maps.map(function);
    }
    let through = maps.through();
    let solution = match (kernel.size(), kernel.is_compact) {
        (0, _) => "0".to_owned(),
        (_, true) => "m->differences[0]".to_owned(),
        (_, false) if kernel.step.is_newton => "m->solution".to_owned(),
        (_, false) => format!("{}_row(m, m->oldest, 1)", kernel.prefix),
    };
    let words = words(interface, module, all)
        .prefix("K_", format!("{}_", kernel.prefix))
        .with("THROUGH", through.to_string())
        .with("THROUGH_CALL", if through > 0 { ", through" } else { "" })
        .with("SOLUTION", solution)
        .holds("through", through > 0);
    text + &words.fill(FOLLOW)
}

struct Maps<'k> {
    kernel: &'k Kernel<'k>,
    module: &'k Module<DerivativeRole>,
}

impl Maps<'_> {
    fn spelling(&self) -> &Spelling<'_> {
        &self.kernel.spelling
    }

    /// How many columns the derivative with respect to the unknown has, as far as matrices need it.
    fn through(&self) -> usize {
        self.module.function(DerivativeRole::Through).map_or(0, |function| function.results.len())
    }

    /// The point, and what makes it.
    fn point(&self) -> String {
        let (k, s) = (&self.kernel.prefix, self.spelling().prefix);
        let (real, upper) = (format!("{s}_real"), s.to_uppercase());
        let values = &self.module.values;
        let fields: Vec<String> =
            values.fields(RecordKind::Point).iter().map(|field| value(values, *field)).collect();
        let mut text = "/* What the derivative of a step is made of. */\ntypedef struct {\n".to_owned();
        for field in &fields {
            _ = writeln!(text, "    {real} {field};");
        }
        text += if fields.is_empty() { "    char none;\n" } else { "" };
        _ = writeln!(text, "}} {k}_point;\n");
        let Some(function) = self.module.function(DerivativeRole::Point) else { return text };
        let mut arguments = vec![
            format!("{k}_point *point"),
            format!("const {s}_parameters *parameters"),
            format!("{real} step_size"),
            format!("const {s}_state *state"),
        ];
        arguments.extend(self.kernel.is_timed.then(|| format!("{real} time")));
        arguments.extend(
            (!self.spelling().interface.controls.is_empty()).then(|| format!("const {s}_control *control")),
        );
        arguments.push(format!("const {real} *unknown"));
        let mut body = self.spelling().body(values, function, Arithmetic::Plain, &[]);
        for field in &fields {
            _ = writeln!(body, "    point->{field} = {field};");
        }
        let doc = format!("/* {}: {}. */", function.role.signature().purpose, function.operations());
        text + &format!(
            "{doc}\n{upper}_FN void {k}_point_at({})\n{{\n{}{body}}}\n\n",
            arguments.join(", "),
            unused(&arguments, &body)
        )
    }

    /// A matrix, column by column: `explicit + through · unknown`, or the columns themselves.
    fn map(&self, function: &Function<DerivativeRole>) -> String {
        let (k, s) = (&self.kernel.prefix, self.spelling().prefix);
        let (real, upper) = (format!("{s}_real"), s.to_uppercase());
        let n = self.spelling().interface.state_perturbation();
        let values = &self.module.values;
        let is_through = function.role == DerivativeRole::Through;
        let through = if is_through { 0 } else { self.through() };
        let mut arguments = vec![format!("const {k}_point *point")];
        if through > 0 {
            arguments.push(format!("{real} through[{through}][{n}]"));
        }
        let columns = if is_through { function.results.len() } else { function.results.len() / 2 };
        arguments.push(format!("{real} result[{columns}][{n}]"));
        let arrays: Vec<&[Term]> = function.results.iter().map(Vec::as_slice).collect();
        let mut body = self.spelling().body(values, function, Arithmetic::Plain, &arrays);
        let term = |term: &Term| self.spelling().term(values, term, Arithmetic::Plain);
        let is_zero = |term: &Term| matches!(term, Term::Number(number) if number.is_zero());
        for j in 0..columns {
            let (explicit, unknown): (&[Term], &[Term]) = match is_through {
                true => (arrays[j], &[]),
                false => (arrays[2 * j], arrays[2 * j + 1]),
            };
            for (i, entry) in explicit.iter().enumerate() {
                _ = writeln!(body, "    result[{j}][{i}] = {};", term(entry));
            }
            if unknown.iter().all(is_zero) {
                continue;
            }
            let coefficients: Vec<String> = unknown.iter().map(term).collect();
            _ = writeln!(
                body,
                "    {{\n        const {real} by[{}] = {{ {} }};\n        int a, b;\n        for (a = 0; a < {}; a++)\n            for (b = 0; b < {n}; b++)\n                result[{j}][b] += through[a][b] * by[a];\n    }}",
                unknown.len(),
                coefficients.join(", "),
                unknown.len().min(through.max(unknown.len())),
            );
        }
        let doc = format!("/* {}: {}. */", function.role.signature().purpose, function.operations());
        format!(
            "{doc}\n{upper}_FN void {k}_{}({})\n{{\n{}{body}}}\n\n",
            function.role.name(),
            arguments.join(", "),
            unused_arrays(&arguments, &body)
        )
    }
}

/// As [`unused`], for arguments that may be arrays.
fn unused_arrays(arguments: &[String], body: &str) -> String {
    let names: Vec<String> =
        arguments.iter().map(|argument| argument.split('[').next().unwrap_or_default().to_owned()).collect();
    unused(&names, body)
}
