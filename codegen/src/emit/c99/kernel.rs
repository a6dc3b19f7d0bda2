//! The kernel of one step: its functions, and the solver of its equation.

use std::fmt::Write as _;

use super::code::{Arithmetic, Spelling, uses};
use super::names::{places, value};
use super::template::Words;
use crate::program::{Function, FunctionRole as _, Input, Module, RecordKind, StepProgram, StepRole, Term};

/// The solver of an equation, and what takes the place of it where there is nothing to solve for.
const NORMS: &str = include_str!("text/norms.c");
const SOLVER: &str = include_str!("text/solver.c");
const COMPACT: &str = include_str!("text/compact.c");
const EXPLICIT: &str = include_str!("text/explicit.c");

/// A kernel and the names in it.
pub(super) struct Kernel<'k> {
    pub(super) spelling: Spelling<'k>,
    pub(super) step: &'k StepProgram,
    /// The prefix of all that belongs to it, without an underscore at the end.
    pub(super) prefix: String,
    /// Whether time has a part in any step.
    pub(super) is_timed: bool,
    /// Whether it is solved in few lines.
    pub(super) is_compact: bool,
}

/// How many solutions are remembered where it is solved in few lines, and how many corrections there are then at most.
const REMEMBERED: usize = 3;
const CORRECTIONS: usize = 20;

impl Kernel<'_> {
    /// How many unknowns there are.
    pub(super) fn size(&self) -> usize {
        self.step.blocks.iter().sum()
    }

    /// Whether there is a fast path.
    pub(super) fn is_fast(&self) -> bool {
        self.has_update() && !self.is_compact
    }

    /// Whether there is a fixed-point iteration. In few lines Newton's method needs none.
    fn has_update(&self) -> bool {
        self.size() > 0 && !(self.is_compact && self.is_quadratic())
    }

    /// Whether that is Newton's method.
    fn is_quadratic(&self) -> bool {
        self.step.is_newton && self.step.has_true_jacobian
    }

    fn has_controls(&self) -> bool {
        !self.spelling.interface.controls.is_empty()
    }

    /// All of it.
    pub(super) fn emit(&self, words: &Words) -> String {
        let module = &self.step.module;
        let mut text = format!("/* ==== {} ==== */\n\n", self.step.scheme.type_name());
        text += &self.records(words);
        for function in &module.functions {
            let is_needed = match function.role {
                StepRole::Start | StepRole::Correction | StepRole::FixedPointUpdate => self.size() > 0,
                _ => true,
            };
            if is_needed {
                text += &self.function(module, function);
            }
        }
        let words = self.words(words);
        match (self.size(), self.is_compact) {
            (0, _) => text += &words.fill(EXPLICIT),
            (_, true) => text += &(words.fill(NORMS) + &words.fill(COMPACT)),
            (_, false) => {
                text += &(self.roundoff(module) + &self.are_finite());
                text += &(words.fill(NORMS) + &words.fill(SOLVER));
            }
        }
        text
    }

    /// Structs of what functions hand on to others.
    fn records(&self, words: &Words) -> String {
        let values = &self.step.module.values;
        let fields =
            |kind| -> Vec<String> { values.fields(kind).iter().map(|field| value(values, *field)).collect() };
        let structure = |doc: &str, name: &str, before: &str, fields: &[String]| {
            let mut text = format!("/* {doc} */\ntypedef struct {{\n{before}");
            for field in fields {
                _ = writeln!(text, "    REAL {field};");
            }
            if fields.is_empty() && before.is_empty() {
                text += "    char none;\n";
            }
            text + &format!("}} K_{name};\n\n")
        };
        let n = self.size();
        let arrays = if n > 0 { "    REAL residual[SIZE], right[SIZE];\n" } else { "" };
        let memory = match n {
            0 => "    int iterations;\n    REAL residual;\n",
            _ if self.is_compact => {
                "    REAL differences[REMEMBERED][SIZE], rate; /* of the latest, and how fixed-point iterations contract */\n    int count;\n    int iterations; /* of the last step, and what they left */\n    REAL residual;\n"
            }
            _ => {
                "    REAL ring[U_WINDOW][SIZE], next[SIZE]; /* the latest, and where they point */\n//if newton\n    REAL solution[SIZE]; /* the latest by itself: the others are apart from first approximations */\n//end\n    REAL rate, tolerance; /* of fixed-point iterations: how they contract, and the change of the last one */\n    unsigned oldest;\n    int count, due, interval, is_ready;\n    int iterations; /* of the last step, and what they left */\n    REAL residual;\n"
            }
        };
        let text = [
            structure(
                "What depends on parameters and step size alone.",
                "constants",
                "",
                &fields(RecordKind::Constants),
            ),
            structure("What depends on the state too.", "begun", "", &fields(RecordKind::Step)),
            structure(
                "The equation of a step, at a state.",
                "equation",
                "    const K_constants *constants;\n    const S_state *state;\n    K_begun begun;\n",
                &[],
            ),
            structure(
                "The equation at a value of the unknown, left - right, and what is needed again.",
                "evaluation",
                arrays,
                &fields(RecordKind::Iterate),
            ),
            structure("Solutions of earlier equations.", "memory", memory, &[]),
        ];
        self.words(words).fill(&text.concat())
    }

    /// What fills the templates.
    fn words(&self, words: &Words) -> Words {
        let spelling = &self.spelling;
        let mut begin = 0;
        let blocks = self.step.blocks.iter().map(|length| {
            let block =
                Words::default().with("BEGIN", begin.to_string()).with("END", (begin + length).to_string());
            begin += length;
            block
        });
        let unknowns = (0..self.size()).map(|k| Words::default().with("INDEX", k.to_string()));
        let reciprocals: Vec<String> = (1..=8).map(|j| spelling.number(1.0 / f64::from(j))).collect();
        let given = match (self.is_timed, self.has_controls()) {
            (true, true) => "S_is_finite(time) && S_control_is_finite(control)",
            (true, false) => "S_is_finite(time)",
            (false, true) => "S_control_is_finite(control)",
            (false, false) => "1",
        };
        let filled = |name: &str| words.fill(name).trim_end().to_owned();
        let is_strong = self.step.is_newton && !self.is_quadratic();
        let shows = match self.is_quadratic() {
            true => "U_SMALL * U_EPSILON < last * last",
            false => "U_SHARP * U_EPSILON < last",
        };
        let first_weight = match self.step.is_newton {
            true => "U_BINOMIAL_0",
            false if self.step.is_long => "K_weights(m->count > U_WINDOW)[0]",
            false => "U_WEIGHTS_0",
        };
        words
            .clone()
            .prefix("K_", format!("{}_", self.prefix))
            .with("SIZE", self.size().to_string())
            .with("RECIPROCALS", reciprocals.join(", "))
            .with("LEAST_RATE", spelling.number(if is_strong { 2.0 / 1e8 } else { 1.0 / 256.0 }))
            .with("SHOWS", filled(shows))
            .with("FIRST_WEIGHT", filled(first_weight).replace("K_", &format!("{}_", self.prefix)))
            .with("FULL", filled(if self.step.is_newton { "U_THROUGH" } else { "U_WINDOW" }))
            .with("FAST_FROM", if self.is_quadratic() { "1".to_owned() } else { filled("U_THROUGH") })
            .with("ITERATION", if self.step.is_newton { "an iteration or a few" } else { "one iteration" })
            .with("TAKEN", if self.step.is_newton { "1 + path->more" } else { "1" })
            .with("COMPACT_STALL", spelling.number(spelling.stall()))
            .with("REMEMBERED", REMEMBERED.to_string())
            .with("CORRECTIONS", CORRECTIONS.to_string())
            .holds("full", !self.is_compact)
            .with("GIVEN", filled(given))
            .with("SURELY", self.surely())
            .with("SLOW", filled(if self.has_update() { "U_OUT_OF_LINE" } else { "U_FN" }))
            .holds("update", self.has_update())
            .holds("newton", self.step.is_newton)
            .holds("finds_any", self.step.is_newton && !self.step.is_chord)
            .holds("long", self.step.is_long && !self.step.is_newton)
            .holds("quadratic", self.is_quadratic())
            .holds("true_jacobian", self.step.has_true_jacobian)
            .holds("domain", self.step.module.function(StepRole::Domain).is_some())
            .each("block", blocks.collect())
            .each("unknown", unknowns.collect())
    }

    /// A sum that is finite if the next state and the controls are, of what is not bounded anyway: four sums, for each has to wait for itself.
    fn surely(&self) -> String {
        let interface = self.spelling.interface;
        let state = places(&interface.state).into_iter().map(|place| format!("next->{place}"));
        let open =
            state.zip(&self.step.bounded).filter(|(_, is_bounded)| !**is_bounded).map(|(place, _)| place);
        let controls = places(&interface.controls).into_iter().map(|place| format!("control->{place}"));
        four_sums(&open.chain(controls).collect::<Vec<_>>())
    }

    /// A function of a step.
    fn function(&self, module: &Module<StepRole>, function: &Function<StepRole>) -> String {
        let (spelling, k, s) = (&self.spelling, &self.prefix, self.spelling.prefix);
        let (real, upper) = (format!("{s}_real"), s.to_uppercase());
        let equation = format!("const {k}_equation *equation");
        let unknown = format!("const {real} *unknown");
        let evaluation = format!("const {k}_evaluation *evaluation");
        let result = format!("{real} *result");
        let mut begin = vec![format!("{k}_equation *equation")];
        begin.extend(self.is_timed.then(|| format!("{real} time")));
        begin.extend(self.has_controls().then(|| format!("const {s}_control *control")));
        let (kind, arguments) = match function.role {
            StepRole::New => (
                "void",
                vec![
                    format!("{k}_constants *constants"),
                    format!("const {s}_parameters *parameters"),
                    format!("{real} step_size"),
                ],
            ),
            StepRole::Begin => ("void", begin),
            StepRole::Start => ("void", vec![equation, result]),
            StepRole::Evaluate => ("void", vec![equation, unknown, format!("{k}_evaluation *evaluation")]),
            StepRole::Correction | StepRole::FixedPointUpdate => {
                ("void", vec![equation, unknown, evaluation, result])
            }
            StepRole::Domain => (real.as_str(), vec![equation, unknown, evaluation]),
            StepRole::Finish => ("void", vec![equation, unknown, evaluation, format!("{s}_state *next")]),
        };
        let arrays: Vec<&[Term]> = function.results.iter().map(Vec::as_slice).collect();
        let mut body = spelling.body(&module.values, function, Arithmetic::Plain, &arrays);
        if uses(function, Input::State) {
            body = format!("    const {s}_state *const state = equation->state;\n{body}");
        }
        let term = |term: &Term| spelling.term(&module.values, term, Arithmetic::Plain);
        let mut store = |to: &str, record: RecordKind| {
            for field in module.values.fields(record) {
                let name = value(&module.values, *field);
                _ = writeln!(body, "    {to}{name} = {name};");
            }
        };
        match function.role {
            StepRole::New => store("constants->", RecordKind::Constants),
            StepRole::Begin => store("equation->begun.", RecordKind::Step),
            StepRole::Evaluate => store("evaluation->", RecordKind::Iterate),
            _ => {}
        }
        let mut fill = |places: &[String], array: &[Term]| {
            for (place, result) in places.iter().zip(array) {
                _ = writeln!(body, "    {place} = {};", term(result));
            }
        };
        let numbered =
            |name: &str| -> Vec<String> { (0..self.size()).map(|i| format!("{name}[{i}]")).collect() };
        match function.role {
            StepRole::Evaluate => {
                for (name, array) in
                    ["evaluation->residual", "evaluation->right"].iter().zip(&function.results)
                {
                    fill(&numbered(name), array);
                }
            }
            StepRole::Finish => {
                let next: Vec<String> =
                    places(&spelling.interface.state).iter().map(|place| format!("next->{place}")).collect();
                function.results.iter().for_each(|array| fill(&next, array));
            }
            StepRole::Domain => {
                let margins = function.results.iter().flatten().map(term);
                let margin = margins.reduce(|a, b| format!("{s}_min({a}, {b})")).unwrap_or_default();
                _ = writeln!(body, "    return {margin};");
            }
            _ => function.results.iter().for_each(|array| fill(&numbered("result"), array)),
        }
        let hot = matches!(
            function.role,
            StepRole::Begin
                | StepRole::Evaluate
                | StepRole::FixedPointUpdate
                | StepRole::Finish
                | StepRole::Domain
        );
        let before = if hot { "HOT" } else { "FN" };
        let doc = format!("/* {}: {}. */", function.role.signature().purpose, function.operations());
        format!(
            "{doc}\n{upper}_{before} {kind} {k}_{}({})\n{{\n{}{body}}}\n\n",
            function.role.name(),
            arguments.join(", "),
            unused(&arguments, &body),
        )
    }

    /// What rounding leaves of the residual: the equation over numbers that carry their errors. What depends on the state alone counts as exact.
    fn roundoff(&self, module: &Module<StepRole>) -> String {
        let Some(function) = module.function(StepRole::Evaluate) else { return String::new() };
        let (spelling, k, s) = (&self.spelling, &self.prefix, self.spelling.prefix);
        let upper = s.to_uppercase();
        let residual = function.results.first().map_or(&[][..], Vec::as_slice);
        let mut body = spelling.body(&module.values, function, Arithmetic::Bounded, &[residual]);
        if body.contains("(state->") {
            body = format!("    const {s}_state *const state = equation->state;\n{body}");
        }
        for (i, term) in residual.iter().enumerate() {
            let term = spelling.term(&module.values, term, Arithmetic::Bounded);
            _ = writeln!(body, "    bound[{i}] = {upper}_EPSILON * ({term}).error;");
        }
        let arguments = [
            format!("const {k}_equation *equation"),
            format!("const {s}_real *unknown"),
            format!("{s}_real *bound"),
        ];
        format!(
            "/* A bound of what rounding leaves of the residual. */\n{upper}_COLD void {k}_roundoff({})\n{{\n{}{body}}}\n\n",
            arguments.join(", "),
            unused(&arguments, &body),
        )
    }

    fn are_finite(&self) -> String {
        let (k, s) = (&self.prefix, self.spelling.prefix);
        let upper = s.to_uppercase();
        let all: Vec<String> = (0..self.size()).map(|i| format!("{s}_is_finite(x[{i}])")).collect();
        format!(
            "{upper}_FN int {k}_are_finite(const {s}_real *x)\n{{\n    return {};\n}}\n\n",
            all.join(" && ")
        )
    }
}

/// `(void)unknown;` for each argument that a body makes no use of.
pub(super) fn unused(arguments: &[String], body: &str) -> String {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words: std::collections::BTreeSet<&str> = body.split(|c| !is_part(c)).collect();
    let name = |argument: &String| argument.rsplit(|c| !is_part(c)).next().unwrap_or_default().to_owned();
    let unused = arguments.iter().map(name).filter(|name| !words.contains(name.as_str()));
    unused.map(|name| format!("    (void){name};\n")).collect()
}

/// The sum of these, in four sums.
pub(super) fn four_sums(terms: &[String]) -> String {
    let sum = |k: usize| terms.iter().skip(k).step_by(4).cloned().collect::<Vec<_>>().join(" + ");
    match terms.len() {
        0 => "0".to_owned(),
        1 => terms[0].clone(),
        2 => format!("({}) + ({})", sum(0), sum(1)),
        3 => format!("(({}) + ({})) + ({})", sum(0), sum(1), sum(2)),
        _ => format!("(({}) + ({})) + (({}) + ({}))", sum(0), sum(1), sum(2), sum(3)),
    }
}
