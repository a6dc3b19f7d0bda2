//! Programs as C99: one header for a system and some schemes, that needs nothing but `math.h`.
//!
//! It has structs of parameters, state and controls, steppers with the solver of their equations, and the system's functions. The solver follows
//! the library's line by line, so that its steps are those of Rust to the last bit, where the compiler does not contract products and sums.

mod code;
mod derivative;
mod kernel;
mod names;
mod special;
mod steppers;
mod system;
mod template;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use code::{Special, Spelling};
use kernel::Kernel;
use names::{ident, snake_case};
use steppers::Stepper;
use template::Words;

use crate::expr::Number;
use crate::program::{Input, Interface, Program, Quantity, StepProgram, StepRole, solver};
use crate::quantity::ScalarType;
use crate::scheme::{Retraction, Scheme};

const BEGINNING: &str = include_str!("text/beginning.c");
const END: &str = include_str!("text/end.c");

/// What a header is to have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The steps, each with a stepper of its own. If there are none, the standard steps on the usual retractions.
    pub steps: Vec<Steps>,
    /// The numbers to compute with, if not those of the description.
    pub scalar: Option<ScalarType>,
    /// Whether equations are solved in few lines, for machines with little memory: with fewer earlier solutions, and without a second search
    /// where Newton's method does not converge. The steps are the same, to rounding.
    pub compact: bool,
    /// Whether there are functions for CUDA and HIP that take steps of many members, a thread each.
    pub kernels: bool,
    /// The values of the [constants](crate::program::Interface::constants) that the description names, as [`derived`](crate::derived) finds them.
    pub constants: Vec<f64>,
}

/// Steps of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// The step as Rust names its scheme, or the one that others are composed of: `Cayley` for the standard step, `Midpoint<Cayley>`,
    /// `StormerVerlet<Cayley>`.
    pub scheme: String,
    /// The coefficients of a symmetric composition: of which each step takes so much of the whole one. None of a step that is not composed.
    pub gamma: Vec<f64>,
}

/// Why there is no header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// The description names constants of its own crate, whose values were not given.
    Constants(Vec<String>),
    /// No such step was generated.
    NoStep {
        /// The step.
        step: String,
        /// Those that there are.
        known: Vec<String>,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constants(paths) => write!(
                f,
                "C does not know constants of a Rust crate: {}; make parameters of them, or write their values into the description",
                paths.join(", ")
            ),
            Self::NoStep { step, known } => {
                write!(f, "there is no step `{step}`: the description asks for {}", known.join(", "))
            }
        }
    }
}

impl std::error::Error for Error {}

impl Steps {
    /// Steps that are not composed.
    pub fn of(scheme: impl Into<String>) -> Self {
        Self { scheme: scheme.into(), gamma: Vec::new() }
    }

    /// The parts of the step by their places in a program.
    fn parts(&self, program: &Program) -> Result<Vec<usize>, Error> {
        let plain = |name: &str| name.replace(' ', "");
        let name = plain(&self.scheme);
        let retraction =
            |name: &str| Retraction::ALL.into_iter().find(|retraction| retraction.name() == name);
        let halves = || retraction(name.strip_prefix("StormerVerlet<")?.strip_suffix('>')?);
        let parts = match (retraction(&name), halves()) {
            (Some(retraction), _) => program.standard(retraction),
            (None, Some(retraction)) => program.stormer_verlet(retraction),
            (None, None) => {
                let is_it = |scheme: &Scheme| plain(&scheme.type_name()) == name;
                let step = program
                    .steps
                    .iter()
                    .position(|step| is_it(&step.scheme) || step.aliases.iter().any(is_it));
                step.map(|place| vec![(place, Number::ONE)])
            }
        };
        let names = |step: &StepProgram| {
            let aliases = step.aliases.iter().map(|alias| alias.type_name());
            std::iter::once(step.scheme.type_name()).chain(aliases).collect::<Vec<_>>()
        };
        let known = || program.steps.iter().flat_map(names).collect();
        let parts = parts.ok_or_else(|| Error::NoStep { step: self.scheme.clone(), known: known() })?;
        Ok(parts.into_iter().map(|(place, _)| place).collect())
    }

    /// What the names of the stepper and its functions begin with, behind the system's: `cayley_midpoint`.
    fn suffix(&self) -> String {
        let words = self.scheme.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
        let words: Vec<String> = words.map(snake_case).collect();
        match self.gamma.len() {
            0 | 1 => words.join("_"),
            n => format!("{}_composed_{n}", words.join("_")),
        }
    }
}

impl Options {
    /// What the names of the steppers and their functions begin with, of a system of this name: `heavy_top`, or where there are several,
    /// `heavy_top_midpoint_cayley`.
    pub fn prefixes(&self, system: &str) -> Vec<String> {
        let system = snake_case(system);
        match self.steps.as_slice() {
            [_] => vec![system],
            steps => steps.iter().map(|steps| format!("{system}_{}", steps.suffix())).collect(),
        }
    }
}

/// A header.
///
/// # Errors
/// If a step is asked for that the program does not have, or the description names constants of its own crate whose values are not given.
pub fn header(program: &Program, options: &Options) -> Result<String, Error> {
    let interface = &program.interface;
    if interface.constants.len() != options.constants.len() {
        return Err(Error::Constants(
            interface.constants.iter().map(|constant| constant.path.clone()).collect(),
        ));
    }
    let prefix = snake_case(&interface.name);
    let mut options = options.clone();
    if options.steps.is_empty() {
        options.steps = standard(program);
    }
    let parts = options.steps.iter().map(|steps| steps.parts(program)).collect::<Result<Vec<_>, _>>()?;
    let used = |place: &usize| parts.iter().flatten().any(|part| part == place);
    let mut special = special_functions(program, (0..program.steps.len()).filter(used));
    let mut family = None;
    if options.compact {
        family = special.families.last().copied();
        special.families = family.into_iter().collect();
    }
    let scalar = options.scalar.unwrap_or(interface.scalar);
    let spelling = Spelling { prefix: &prefix, scalar, interface, family, constants: &options.constants };
    let is_timed = |place: usize| {
        let begin = program.steps[place].module.function(StepRole::Begin);
        begin.is_some_and(|begin| code::uses(begin, Input::Time))
    };
    let is_timed = parts.iter().flatten().any(|place| is_timed(*place));
    let kernel = |place: usize| {
        let step = &program.steps[place];
        Kernel {
            spelling,
            step,
            prefix: format!("{prefix}_{}_kernel", snake_case(&step.scheme.name())),
            is_timed,
            is_compact: options.compact,
        }
    };
    let kernels: BTreeMap<usize, Kernel<'_>> =
        (0..program.steps.len()).filter(used).map(|place| (place, kernel(place))).collect();
    let all = options.steps.iter().zip(&parts).zip(options.prefixes(&interface.name));
    let steppers: Vec<Stepper<'_>> = all
        .map(|((steps, places), prefix)| {
            stepper(steps, places.iter().map(|place| &kernels[place]).collect(), prefix, is_timed)
        })
        .collect();

    let has_derivative = derivative::is_there(program);
    let words = words(&spelling, is_timed).holds("derivative", has_derivative);
    let mut text = about(interface, &steppers);
    let solved = kernels.values().any(|kernel| kernel.size() > 0);
    text += &beginning(interface, &spelling, (solved, options.compact), &words);
    let is_bounded = !options.compact && solved;
    text += &special::special(&spelling, &special, is_bounded, &words);
    text += &system::system(program, &spelling, &words);
    if has_derivative {
        text += &derivative::structure(program, &words);
    }
    for kernel in kernels.values() {
        text += &kernel.emit(&words);
        if has_derivative {
            text += &derivative::kernel(kernel, &words);
        }
    }
    let number = |x| spelling.number(x);
    steppers.iter().for_each(|stepper| text += &stepper.emit(&words, &number));
    if options.kernels {
        steppers.iter().for_each(|stepper| text += &stepper.ensemble(interface, &words));
    }
    text += &words.fill(END);
    Ok(text)
}

/// The special functions of a program with these steps.
fn special_functions(program: &Program, steps: impl Iterator<Item = usize>) -> Special {
    let mut special = Special::default();
    for step in steps.map(|place| &program.steps[place]) {
        step.module.functions.iter().for_each(|function| special.note(function));
        let derivative = step.derivative.iter().flat_map(|module| &module.functions);
        derivative.for_each(|function| special.note(function));
    }
    for role in system::roles(program) {
        program.function(role).into_iter().for_each(|(_, function)| special.note(function));
    }
    special
}

/// The standard steps on the retractions that the program has steps with.
fn standard(program: &Program) -> Vec<Steps> {
    let of = Retraction::ALL.into_iter().filter(|retraction| program.standard(*retraction).is_some());
    of.map(|retraction| Steps::of(retraction.name())).collect()
}

fn stepper<'k>(steps: &Steps, parts: Vec<&'k Kernel<'k>>, prefix: String, is_timed: bool) -> Stepper<'k> {
    let about = match steps.gamma.len() {
        0 | 1 => format!("Steps with {}", steps.scheme),
        n => format!("Steps that are each composed of {n} with {}", steps.scheme),
    };
    let gamma = if steps.gamma.is_empty() { vec![1.0] } else { steps.gamma.clone() };
    Stepper { prefix, about, parts, gamma, is_timed }
}

/// What fills all templates.
fn words(spelling: &Spelling<'_>, is_timed: bool) -> Words {
    let upper = spelling.prefix.to_uppercase();
    let real = format!("{}_real", spelling.prefix);
    let number = |x: f64| spelling.number(x);
    let [epsilon, largest, least] = match spelling.scalar {
        ScalarType::F64 => [f64::EPSILON, f64::MAX, f64::MIN_POSITIVE],
        ScalarType::F32 => [f32::EPSILON, f32::MAX, f32::MIN_POSITIVE].map(f64::from),
    };
    let root = match spelling.scalar {
        ScalarType::F64 => f64::EPSILON.sqrt(),
        ScalarType::F32 => f64::from(f32::EPSILON.sqrt()),
    };
    let has_controls = !spelling.interface.controls.is_empty();
    let timed = |text: String| if is_timed { text } else { String::new() };
    let controlled = |text: String| if has_controls { text } else { String::new() };
    let mut words = Words::default()
        .prefix("S_", format!("{}_", spelling.prefix))
        .prefix("U_", format!("{upper}_"))
        .with("REAL", &real)
        .with("SCALAR", system::scalar(spelling.scalar))
        .with("EPSILON_VALUE", number(epsilon))
        .with("LARGEST_VALUE", number(largest))
        .with("LARGEST_DOUBLE_VALUE", format!("{:?}", f64::MAX))
        .with("FLOOR_VALUE", number(least / epsilon))
        .with("ROOT_EPSILON", number(root))
        .with("NOT_A_NUMBER", format!("({real})NAN"))
        .with("TIMED_ARGUMENT", timed(format!(", {real} time")))
        .with("TIMED_CALL", timed(", time".to_owned()))
        .with("CONTROL_ARGUMENT", controlled(format!(", const {}_control *control", spelling.prefix)))
        .with("CONTROL_CALL", controlled(", control".to_owned()));
    for (word, value) in [("ZERO", 0.0), ("ONE", 1.0), ("TWO", 2.0), ("HALF", 0.5), ("QUARTER", 0.25)] {
        words = words.with(word, number(value));
    }
    for (word, name) in [
        ("FABS", "fabs"),
        ("SQRT", "sqrt"),
        ("SIN", "sin"),
        ("COS", "cos"),
        ("EXP", "exp"),
        ("LOG", "log"),
        ("ACOS", "acos"),
        ("SINH", "sinh"),
        ("COSH", "cosh"),
        ("POW", "pow"),
        ("ATAN2", "atan2"),
    ] {
        words = words.with(word, spelling.math(name));
    }
    words
}

/// What a header is for.
fn about(interface: &Interface, steppers: &[Stepper<'_>]) -> String {
    let prefix = snake_case(&interface.name);
    let upper = prefix.to_uppercase();
    let mut lines = vec![
        format!("{prefix}.h: the motion of a {}, in steps that keep what it keeps.", interface.name),
        String::new(),
        "Generated by coadjoint; not to be edited. C99 and C++, for GPUs too; nothing is allocated, nothing of the standard library is used but".to_owned(),
        "math.h, and each step ends after a bounded number of iterations.".to_owned(),
        String::new(),
        format!("Equations of motion, {}:", interface.documentation.coordinates),
    ];
    lines.extend(interface.documentation.equations.iter().map(|equation| format!("    {equation}")));
    if !interface.casimirs.is_empty() {
        lines.push(format!("Kept to rounding: {}.", interface.casimirs.join(", ")));
    }
    lines.extend(interface.documentation.conventions.iter().cloned());
    if let Some(stepper) = steppers.first() {
        let time = if stepper.is_timed { ", time" } else { "" };
        let control = if interface.controls.is_empty() { "" } else { ", &control" };
        let x = &stepper.prefix;
        lines.extend([
            String::new(),
            format!("    {x}_stepper stepper;"),
            format!("    if ({x}_init(&stepper, &parameters, 0.01) != {upper}_OK) ..."),
            format!("    if ({x}_step(&stepper, &state{time}{control}) != {upper}_OK) ..."),
        ]);
    }
    let mut text = "/*".to_owned();
    for (place, line) in lines.iter().enumerate() {
        // what ends a comment is not to stand within
        let line = line.replace("*/", "* /");
        text += &if place == 0 {
            format!(" {line}\n")
        } else {
            format!(" * {line}").trim_end().to_owned() + "\n"
        };
    }
    text + " */\n"
}

/// Macros, status codes, and structs of quantities.
fn beginning(
    interface: &Interface,
    spelling: &Spelling<'_>,
    (is_solved, is_compact): (bool, bool),
    words: &Words,
) -> String {
    let mut structs = vec![
        structure("The parameters.", "parameters", &interface.parameters),
        structure("The state: configuration, momentum and advected parameters.", "state", &interface.state),
    ];
    if !interface.controls.is_empty() {
        structs.push(structure("The controls, held constant over a step.", "control", &interface.controls));
    }
    words
        .clone()
        .each("constant", if is_solved { constants(spelling, is_compact) } else { Vec::new() })
        .holds("solved", is_solved)
        .each("struct", structs)
        .fill(BEGINNING)
}

/// The solver's numbers that are counts, and those that errors are measured with, which are always doubles.
const COUNTS: &[&str] = &[
    "WINDOW",
    "THROUGH",
    "LOW",
    "FEW",
    "ITERATIONS",
    "INTERVALS",
    "REGULAR",
    "DAMPED",
    "PARTS",
    "EVALUATIONS",
    "WANDERING",
];
const DOUBLES: &[&str] = &["NEARLY", "SHORTEST", "STRIDE", "ON_THE_WAY"];
/// Those of equations that are solved in few lines.
const COMPACT: &[&str] =
    &["STRONG", "FAR", "ITERATIONS", "HARDLY", "TOLERANCE", "NEWTON", "SHARP", "RESIDUAL", "PROGRESS"];

fn constants(spelling: &Spelling<'_>, is_compact: bool) -> Vec<Words> {
    let spelled = |name: &str, value: f64| {
        let text = match () {
            () if COUNTS.contains(&name) => format!("{value}"),
            () if DOUBLES.contains(&name) => format!("{value:?}"),
            () => spelling.number(value),
        };
        if value < 0.0 { format!("({text})") } else { text }
    };
    let mut constants = Vec::new();
    for constant in
        solver::CONSTANTS.iter().filter(|constant| !is_compact || COMPACT.contains(&constant.name))
    {
        for (place, value) in constant.values.iter().enumerate() {
            let name = match constant.values.len() {
                1 => constant.name.to_owned(),
                _ => format!("{}_{place}", constant.name),
            };
            let purpose = if place == 0 { constant.purpose } else { "likewise" };
            let words = Words::default().with("NAME", name).with("VALUE", spelled(constant.name, *value));
            constants.push(words.with("PURPOSE", purpose));
        }
    }
    constants
}

/// A struct of quantities.
fn structure(summary: &str, name: &'static str, quantities: &[Quantity]) -> Words {
    let mut fields: Vec<Words> = Vec::new();
    let mut arrays = BTreeSet::new();
    for quantity in quantities {
        if quantity.element.is_some() && !arrays.insert(quantity.field()) {
            continue;
        }
        let mut declared = ident(quantity.field());
        if let Some(element) = &quantity.element {
            declared += &format!("[{}]", element.length);
        }
        let components = match quantity.components.as_slice() {
            [_] => String::new(),
            all => {
                declared += &format!("[{}]", all.len());
                format!("{}; ", all.join(" "))
            }
        };
        let unit = match &quantity.unit {
            Some(unit) if !quantity.doc.contains(unit.as_str()) && !unit.is_empty() => format!(" [{unit}]"),
            _ => String::new(),
        };
        let doc = format!("{components}{}{unit}", quantity.doc.trim()).replace("*/", "* /");
        let doc = doc.trim().trim_end_matches(';').to_owned();
        fields.push(Words::default().holds("doc", !doc.is_empty()).with("DOC", doc).with("FIELD", declared));
    }
    if fields.is_empty() {
        fields
            .push(Words::default().holds("doc", true).with("DOC", "there is nothing").with("FIELD", "none"));
    }
    Words::default().with("SUMMARY", summary).with("STRUCT", name).each("field", fields)
}
