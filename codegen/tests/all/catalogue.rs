//! What is made of every description in the repository, in a line each: what the code of steps costs, what tells it from other code, and what is
//! said of descriptions that do not compile.
//!
//! After a change that is meant, accept with `INSTA_UPDATE=always cargo test --package coadjoint-codegen --test all catalogue`, and read
//! which lines are others: a step that takes more operations than before, a step that was not to change, another message.

#[path = "../../../fuzz/src/description.rs"]
#[expect(unreachable_pub, reason = "it belongs to another crate")]
mod description;

use std::fmt::Debug;
use std::path::{Path, PathBuf};

use coadjoint_codegen::emit::{Expansion, StepExpansion};
use coadjoint_codegen::expand;
use coadjoint_codegen::program::Function;
use coadjoint_codegen::scheme::{Parameter, Scheme};
use proc_macro2::{TokenStream, TokenTree};
use quote::quote;

use description::{Description, descriptions};

/// The files in a folder of the repository, by name.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut files: Vec<_> = paths.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// The name of a file without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().expect("a name").to_string_lossy().into_owned()
}

/// All descriptions in the Rust files of a folder, with the name of the file.
fn described(folder: &str) -> Vec<(String, Description)> {
    let sources = files(folder).into_iter().filter(|path| path.extension().is_some_and(|it| it == "rs"));
    sources
        .flat_map(|path| {
            let source = std::fs::read_to_string(&path).expect("text");
            descriptions(&source).into_iter().map(move |description| (stem(&path), description))
        })
        .collect()
}

/// How many tokens there are, those within parentheses included.
fn count(stream: TokenStream) -> usize {
    let of = |tree: TokenTree| match tree {
        TokenTree::Group(group) => 2 + count(group.stream()),
        _ => 1,
    };
    stream.into_iter().map(of).sum()
}

/// The Fowler–Noll–Vo hash of a text: almost every other text has another one.
fn fingerprint(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// The size of some code, and what tells it from other code.
fn size(tokens: TokenStream) -> String {
    let hash = fingerprint(&tokens.to_string());
    format!("{} tokens, {hash:08x}", count(tokens))
}

fn name(Scheme { rule, retraction }: &Scheme) -> String {
    let name = match (rule.name(), rule.parameter) {
        (Some(name), _) if rule.method.name == "Family" => name.to_owned(),
        (_, Parameter::Share(member)) if rule.method.name == "Family" => {
            format!("Family{}Over{}", member.numerator, member.denominator)
        }
        (_, Parameter::Share(member)) => format!("{}({member:?})", rule.method.name),
        (_, Parameter::Order(order)) => format!("{}({order})", rule.method.name),
    };
    format!("{name}<{retraction:?}>")
}

/// What does not depend on a scheme, then each step with the operations of its functions.
fn lines(file: &str, expansion: &Expansion) -> Vec<String> {
    let Expansion { declaration, state, expressions, system, geometry, tangents, taylor, steps, schemes } =
        expansion;
    let rest = quote! { #declaration #state #expressions #system #geometry #tangents #taylor #schemes };
    let mut lines = vec![format!("{file}: {}", size(rest))];
    for StepExpansion { program, tokens, derivative } in steps {
        fn operations<R: Debug>(function: &Function<R>) -> String {
            format!("{:?} {}", function.role, function.operations().total())
        }
        let mut functions: Vec<String> = program.module.functions.iter().map(operations).collect();
        let derivatives = program.derivative.iter().flat_map(|module| &module.functions);
        functions.extend(derivatives.map(operations));
        let size = size(quote! { #tokens #derivative });
        lines.push(format!("    {}: {}; {size}", name(&program.scheme), functions.join(", ")));
    }
    lines
}

fn assert_snapshot(name: &str, lines: &[String]) {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, lines.join("\n")));
}

/// What the catalogue costs to compile, as far as that can be counted. The generator runs unoptimised while users' crates compile, and what it
/// emits is compiled once for each kind of number that steps are taken with. `.ci/build-cost` measures the seconds.
#[test]
fn the_catalogue_keeps_to_its_budget() {
    let (mut systems, mut kernels, mut tokens, mut all) = (0, 0, 0, Vec::new());
    for (file, Description { attribute, item }) in described("systems/src") {
        let expansion = expand(attribute, item).expect("a valid description");
        all.extend(lines(&file, &expansion));
        systems += 1;
        kernels += expansion.steps.len();
        tokens += count(expansion.into_tokens());
    }
    all.push(format!("{systems} systems, {kernels} kernels, {tokens} tokens"));
    assert!(kernels <= 114 && tokens <= 700_000, "{kernels} kernels, {tokens} tokens");
    assert_snapshot("catalogue", &all);
}

/// The same of all descriptions in some files.
fn assert_same(snapshot: &str, descriptions: impl IntoIterator<Item = (String, Description)>) {
    let mut all = Vec::new();
    for (file, Description { attribute, item }) in descriptions {
        // groups of users' own are known once their macros have run
        let Ok(expansion) = expand(attribute, item) else { continue };
        all.extend(lines(&file, &expansion));
    }
    assert!(!all.is_empty());
    assert_snapshot(snapshot, &all);
}

/// Every construct of the language.
#[test]
fn what_may_be_written_makes_what_it_made() {
    assert_same("language", described("tests/ui/ok"));
}

/// Methods, sides, forces and controls, as the library's tests have them; and a velocity that has no closed form, in methods that need it.
#[test]
fn what_the_library_is_tested_with_makes_what_it_made() {
    let implicit = descriptions(
        "#[lie_poisson_system(
            group = SO3,
            hamiltonian = momentum.norm_squared().powi(2) / 4.0 + weight * (attitude * axis).z,
            methods(TangentLift, TangentMidpoint),
            retractions(Cayley),
        )]
        struct Stiff { weight: f64, axis: Vector3<f64> }
        #[lie_poisson_system(
            group = R2,
            lagrangian = velocity.norm_squared() / 2.0 + velocity.x.powi(4) - stiffness * position.norm_squared(),
            methods(TangentLift),
        )]
        struct Hardening { stiffness: f64 }",
    );
    let implicit = implicit.into_iter().map(|description| ("implicit".to_owned(), description));
    let tested = ["tests/tests/library", "tests/tests/taylor"].into_iter().flat_map(described);
    assert_same("library", tested.chain(implicit));
}

/// Derivatives, as their tests have them, and where not all of them are asked for.
#[test]
fn derivatives_are_what_they_were() {
    let some = ["state", "controls", "parameters", "tangent", "adjoint"].map(|asked| {
        let source = format!(
            "#[lie_poisson_system(
                group = SO3,
                advected(gamma: R3),
                potential = weight * gamma.z,
                control(moment: R3),
                force = moment,
                retractions(Cayley),
                derivatives({asked}),
            )]
            struct Top {{ #[inertia] inertia: Vector3<f64>, weight: f64 }}"
        );
        let description = descriptions(&source).pop().expect("one");
        (format!("derivatives({asked})"), description)
    });
    let of_tests = described("tests/tests/derivatives").into_iter().filter(|(file, _)| file == "derivatives");
    assert_same("derivatives", some.into_iter().chain(of_tests));
}

/// What nobody asked for is not there.
#[test]
fn an_expansion_has_what_was_asked_for() {
    let size = |asked: &str| {
        let attribute: TokenStream = asked.parse().expect("tokens");
        let item = "struct Body { #[inertia] inertia: Vector3<f64>, mass: f64 }".parse().expect("tokens");
        let expansion = expand(attribute, item).expect("a valid description");
        (expansion.steps.len(), count(expansion.into_tokens()))
    };
    let (both, all) = size("group = SO3");
    let (one, half) = size("group = SO3, retractions(Cayley)");
    assert_eq!((both, one), (2, 1));
    assert!(half < all);
    // each map of the derivative adds to the expansion, and all of them are the most
    let (_, every) = size("group = SO3, derivatives");
    for map in ["state", "parameters", "tangent", "adjoint"] {
        let (_, some) = size(&format!("group = SO3, derivatives({map})"));
        assert!(all < some && some < every, "{map}: {all} < {some} < {every}");
    }
    // where there are no controls, nothing is generated for them but the word that it was
    let (_, wrt_state) = size("group = SO3, derivatives(state)");
    let (_, with_controls) = size("group = SO3, derivatives(state, controls)");
    assert!(with_controls <= wrt_state + 32, "{wrt_state} and {with_controls}");
}

/// What fuzzing has found reaches most of the generator: nothing of it brings it down, and it makes what it made.
#[test]
fn what_fuzzing_found_makes_what_it_made() {
    let (mut all, mut sound) = (Vec::new(), 0);
    for path in files("fuzz/corpus") {
        let Ok(text) = String::from_utf8(std::fs::read(&path).expect("a readable file")) else { continue };
        for Description { attribute, item } in descriptions(&text) {
            let made = match expand(attribute, item) {
                Ok(expansion) => {
                    sound += 1;
                    size(expansion.into_tokens())
                }
                Err(errors) => {
                    let messages: Vec<String> = errors
                        .into_iter()
                        .map(|error| format!("{:?} {error}", error.span().start()))
                        .collect();
                    format!("{} problems, {:08x}", messages.len(), fingerprint(&messages.join("\n")))
                }
            };
            all.push(format!("{}: {made}", stem(&path)));
        }
    }
    assert!(sound > 5, "{sound} of {} descriptions have no problem", all.len());
    assert_snapshot("corpus", &all);
}

/// Compile-fail tests compare all that the compiler shows; here every message is found in it, at the place that it underlines.
#[test]
fn messages_are_those_that_the_compiler_shows() {
    let mut found = 0;
    for path in
        files("tests/ui/fail").into_iter().filter(|path| path.extension().is_some_and(|it| it == "rs"))
    {
        let shown = std::fs::read_to_string(path.with_extension("snap")).expect("text");
        let shown: Vec<&str> = shown.lines().collect();
        for Description { attribute, item } in descriptions(&std::fs::read_to_string(&path).expect("text")) {
            // what is found by rustc alone, and warnings
            let Err(errors) = expand(attribute, item) else { continue };
            for error in errors {
                let start = error.span().start();
                let message = format!("error: {error}");
                let place = format!("fail/{}.rs:{}:{}", stem(&path), start.line, start.column + 1);
                let is_shown =
                    |pair: &[&str]| pair[0] == message && pair[1].trim_start() == format!("--> {place}");
                // the attribute's own place, and the macros that define groups and functions, are known to rustc alone
                let of_macros = ["is not defined by `lie_group!`", "this function is not known here"];
                let elsewhere = of_macros.iter().any(|of| message.contains(of)) || start.line == 1;
                assert!(elsewhere || shown.windows(2).any(is_shown), "{place}: {message}");
                found += usize::from(!elsewhere);
            }
        }
    }
    assert!(found > 100, "{found} messages");
}

/// A name of a type that a user's crate may have for something else.
fn bare_types(stream: TokenStream) -> Vec<String> {
    let trees: Vec<TokenTree> = stream.into_iter().collect();
    let of = |(place, tree): (usize, &TokenTree)| match tree {
        TokenTree::Group(group) => bare_types(group.stream()),
        TokenTree::Ident(name) => {
            let name = name.to_string();
            let before: String =
                trees[place.saturating_sub(3)..place].iter().map(ToString::to_string).collect();
            let is_path = before.ends_with("primitive::") || before.ends_with("core::");
            let is_type = ["f64", "f32", "usize", "bool", "u32", "str"].contains(&name.as_str());
            if is_type && !is_path { vec![name] } else { Vec::new() }
        }
        _ => Vec::new(),
    };
    trees.iter().enumerate().flat_map(of).collect()
}

#[test]
fn types_of_the_language_have_their_paths() {
    for (file, Description { attribute, item }) in described("systems/src") {
        let expansion = expand(attribute, item).expect("a valid description");
        let Expansion { state, system, geometry, tangents, taylor, steps, schemes, .. } = &expansion;
        let steps =
            steps.iter().map(|StepExpansion { tokens, derivative, .. }| quote! { #tokens #derivative });
        let all = quote! { #state #system #geometry #tangents #taylor #schemes #(#steps)* };
        assert_eq!(bare_types(all), [""; 0], "{file}");
    }
}
