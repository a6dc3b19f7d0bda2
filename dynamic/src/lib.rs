//! Systems of [`coadjoint`] that are made at run time, from their descriptions as text.
//!
//! The text is what the macro takes: a struct below its attribute, in the same grammar, with all checks. The equations are derived as the
//! program runs, and an interpreter takes the place of compiled code, so that no compiler is needed on the machine. The runtime's solver drives
//! it: steps are those of the macro's stepper, bit for bit.
//!
//! ```
//! use coadjoint::erased;
//! use coadjoint_dynamic::Model;
//! use std::sync::Arc;
//!
//! let model = Model::from_text(
//!     "#[lie_poisson_system(
//!          group = SO3,
//!          advected(gamma: R3),
//!          potential = weight * gamma.dot(&chi),
//!      )]
//!      struct HeavyTop {
//!          #[inertia]
//!          inertia: Vector3<f64>,
//!          weight: f64,
//!          chi: Vector3<f64>,
//!      }",
//! )?;
//! // inertia, weight, chi
//! let top = Arc::new(model.system(&[1.0, 10.0, 100.0, 1.0, 0.0, 0.0, 1.0]));
//! let mut stepper = erased::Stepper::new(top, &"Cayley".parse()?, 0.01)?;
//! // attitude (w, x, y, z), momentum, gamma
//! let mut state = [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
//! let energy = stepper.system().energy(&state, 0.0, &[]);
//! stepper.steps(&mut state, &[], 1_000)?;
//! assert!((stepper.system().energy(&state, 0.0, &[]) - energy).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What is wrong with a text is told at its place, everything at once:
//!
//! ```
//! let error = coadjoint_dynamic::Model::from_text(
//!     "#[lie_poisson_system(group = SO3, potential = wait * attitude.w)]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//!     weight: f64,
//! }",
//! )
//! .unwrap_err();
//! assert_eq!(
//!     error.to_string().lines().skip(1).collect::<Vec<_>>().join("\n"),
//!     " --> description:1:47
//!   |
//! 1 | #[lie_poisson_system(group = SO3, potential = wait * attitude.w)]
//!   |                                               ^^^^"
//! );
//! ```
//!
//! # What a text may have
//!
//! A whole file that the compiler would take, as the catalogue's are: what is no description is passed over. Beside the struct may stand
//! `lie_group!`, functions below `#[expression]`, and `const NAME: f64 = …;`. A constant that stands nowhere in the text is known to a
//! compiler alone, and is refused at its place.
//!
//! # What is different
//!
//! Numbers are `f64`. There are no steps with compensated sums or fused operations: these are compiled for each system. A step takes about ten
//! times as long as a compiled one; of an [ensemble](coadjoint::erased::Ensemble), whose members go through each operation side by side, any
//! scheme can be taken.
//!
//! # Machine code
//!
//! With the feature `jit` steps are compiled as the program runs, where the processor is known and memory may be executed: they take one and a half
//! times as long as the macro's then, with the same bits. Members of an ensemble are stepped four at a time, which takes about twice as long as one alone.
//! [`Model::interpreted`] asks for the interpreter.

/// The guide's page, whose code is compiled here.
#[cfg(doctest)]
#[doc = include_str!("../../runtime/src/guide/at_run_time.md")]
mod at_run_time {}

mod assembler;
mod definition;
mod derivative;
mod in_one_frame;
mod intern;
mod interpreter;
#[cfg(feature = "jit")]
mod machine;
#[cfg(not(feature = "jit"))]
#[path = "no_machine.rs"]
mod machine;
mod series;
mod text;

use std::sync::Arc;

use coadjoint::erased::Description;
use coadjoint::erased::dynamic::Definition;
use coadjoint_codegen::program::Program;
use coadjoint_codegen::quantity::ScalarType;
use coadjoint_codegen::source::Source;
use proc_macro2::TokenStream;

pub use coadjoint::erased::dynamic::DynamicSystem;
pub use text::{DescriptionError, Place, Problem};

/// Room for what reads and derives a description, however deep that goes: within its bounds the generator needs less than 2 MB.
const STACK: usize = 16 << 20;

/// A description that was read and derived: systems with any parameters can be made of it.
#[derive(Clone, Debug)]
pub struct Model {
    definition: Arc<Definition>,
    program: Arc<Program>,
    about: String,
    file: String,
    warnings: Vec<Problem>,
}

impl Model {
    /// The model of the only description in a text.
    ///
    /// # Errors
    /// If there is not one alone, or something is wrong with it: all that is wrong.
    pub fn from_text(text: &str) -> Result<Self, DescriptionError> {
        Self::from_file(text, "description", None)
    }

    /// The model of the description of this name in the text of a file, or of the only one; `file` is what problems call the text.
    ///
    /// # Errors
    /// If there is none, or something is wrong with it: all that is wrong.
    pub fn from_file(text: &str, file: &str, name: Option<&str>) -> Result<Self, DescriptionError> {
        // in a thread of its own: what is noted of a text, where it has which words, goes with that, and the stack is large enough
        let made = std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().name("description".to_owned()).stack_size(STACK);
            thread.spawn_scoped(scope, || derived(text, file, name)).map(std::thread::ScopedJoinHandle::join)
        });
        match made {
            Ok(Ok(made)) => made,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            // where there are no threads
            Err(_) => derived(text, file, name),
        }
    }

    /// The struct's name.
    pub fn name(&self) -> &'static str {
        self.description().name
    }

    /// The first line of the struct's documentation, without a full stop; empty if there is none.
    pub fn about(&self) -> &str {
        &self.about
    }

    /// What the system is.
    pub fn description(&self) -> Description {
        self.definition.description
    }

    /// What systems are made of.
    #[doc(hidden)]
    pub fn definition(&self) -> &Arc<Definition> {
        &self.definition
    }

    /// The same model, whose systems are interpreted even where there could be machine code: with the feature `jit`, on processors that it is for.
    #[must_use]
    pub fn interpreted(&self) -> Self {
        let definition = definition::definition(&self.program, self.definition.constants.clone(), true);
        Self { definition: Arc::new(definition), ..self.clone() }
    }

    /// What is no error, but worth knowing.
    pub fn warnings(&self) -> &[Problem] {
        &self.warnings
    }

    /// The warnings as they are shown, each at its place in the text.
    pub fn shown_warnings(&self) -> impl Iterator<Item = String> + '_ {
        self.warnings.iter().map(|warning| text::Warned(warning, &self.file).to_string())
    }

    /// The system with these parameters, in the order of its [description](Self::description); those that are missing are zero.
    pub fn system(&self, parameters: &[f64]) -> DynamicSystem {
        DynamicSystem::new(self.definition.clone(), parameters)
    }
}

/// The names of the structs that a text describes.
///
/// # Errors
/// If it is no text of tokens.
pub fn names(text: &str, file: &str) -> Result<Vec<String>, DescriptionError> {
    let source = source(text, file)?;
    Ok(source.described().iter().map(|one| one.name.to_string()).collect())
}

fn source(text: &str, file: &str) -> Result<Source, DescriptionError> {
    let wrong = |error: proc_macro2::LexError| {
        let start = error.span().start();
        let line = text.split('\n').nth(start.line.saturating_sub(1));
        let sign = line.and_then(|line| line.chars().nth(start.column));
        let message = match sign.and_then(meant) {
            Some((sign, meant)) => format!("`{sign}` is no sign of Rust: write {meant}"),
            None => {
                "this is no text of Rust: a bracket or a quote is not closed, or was not opened".to_owned()
            }
        };
        DescriptionError::new(file, vec![Problem::at(text, error.span(), message)])
    };
    Ok(Source::find(text.parse::<TokenStream>().map_err(wrong)?))
}

/// A sign as books print it, and what is written in its place.
fn meant(sign: char) -> Option<(char, &'static str)> {
    let meant = match sign {
        '−' | '–' | '—' => "`-`",
        '×' | '·' | '⋅' | '∙' => "`*`",
        '÷' | '∕' => "`/`",
        '²' => "`.powi(2)`",
        '³' => "`.powi(3)`",
        '√' => "`.sqrt()`",
        '“' | '”' | '„' | '‘' | '’' => "a straight quote",
        _ => return None,
    };
    Some((sign, meant))
}

fn derived(text: &str, file: &str, name: Option<&str>) -> Result<Model, DescriptionError> {
    let failed = |error| DescriptionError::of(file, text, error);
    let source = source(text, file)?;
    let coadjoint_codegen::Derived { program, constants, warnings } =
        coadjoint_codegen::derived(&source, name).map_err(failed)?;
    let program = Arc::new(program);
    if program.interface.scalar == ScalarType::F32 {
        let message = "systems that are made at run time compute with `f64`: write that in the place of `f32`, and leave out `scalar = f32`";
        return Err(DescriptionError::new(file, vec![Problem::without_place(message)]));
    }
    let about = source.description(name).map(|described| documentation(&described.item)).map_err(failed)?;
    let warnings = warnings.into_iter().map(|(span, message)| Problem::at(text, span, message));
    Ok(Model {
        definition: Arc::new(definition::definition(&program, constants, false)),
        program,
        about,
        file: file.to_owned(),
        warnings: warnings.collect(),
    })
}

/// The first line of an item's documentation.
fn documentation(item: &TokenStream) -> String {
    let item: Result<syn::ItemStruct, _> = syn::parse2(item.clone());
    let attributes = item.map(|item| item.attrs).unwrap_or_default();
    let line = attributes.iter().find_map(|attribute| match &attribute.meta {
        syn::Meta::NameValue(syn::MetaNameValue {
            path,
            value: syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(line), .. }),
            ..
        }) if path.is_ident("doc") => Some(line.value().trim().trim_end_matches('.').to_owned()),
        _ => None,
    });
    line.unwrap_or_default()
}
