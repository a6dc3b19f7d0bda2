//! The output is a function of the input, byte for byte: whatever was expanded before, on whatever thread, and however it is laid out.

use coadjoint_codegen::expand;
use proc_macro2::TokenStream;

const ATTRIBUTE: &str = "group = SO3, advected(gamma: R3, field: R3), \
                         potential = weight * gamma.dot(&chi) + (response * field).norm_squared().sin()";
const ITEM: &str = "struct Top { #[inertia] inertia: Matrix3<f64>, weight: f64, chi: Vector3<f64>, \
                    response: Matrix3<f64> }";

fn tokens(text: &str) -> TokenStream {
    text.parse().expect("tokens")
}

/// The code and its intermediate representations, as text.
fn output(attribute: &str, item: &str) -> String {
    let expansion = expand(tokens(attribute), tokens(item)).expect("an expansion");
    let kernels: String = expansion.steps.iter().map(|step| step.program.module.to_string()).collect();
    kernels + &expansion.into_tokens().to_string()
}

#[test]
fn the_same_input_gives_the_same_output() {
    let first = output(ATTRIBUTE, ITEM);
    assert!(first.len() > 10_000, "{first}");
    assert!(first == output(ATTRIBUTE, ITEM), "a second expansion differs");
    output("group = SO3", "struct Other { #[inertia] gamma: Vector3<f32> }");
    assert!(first == output(ATTRIBUTE, ITEM), "an expansion in between leaves traces");
}

#[test]
fn threads_do_not_matter() {
    let first = output(ATTRIBUTE, ITEM);
    let threads: Vec<_> = (0..3).map(|_| std::thread::spawn(|| output(ATTRIBUTE, ITEM))).collect();
    for thread in threads {
        assert!(first == thread.join().expect("no panic"), "another thread's expansion differs");
    }
}

#[test]
fn layout_and_comments_do_not_matter() {
    let spread = |text: &str| text.replace(", ", " /* a comment */ ,\n\n    ");
    assert!(output(ATTRIBUTE, ITEM) == output(&spread(ATTRIBUTE), &spread(ITEM)));
}

/// What the macro emits is what `expand` says.
#[test]
fn the_macro_emits_the_expansion() {
    let expansion = expand(tokens(ATTRIBUTE), tokens(ITEM)).expect("an expansion");
    let emitted = coadjoint_codegen::lie_poisson_system(tokens(ATTRIBUTE), tokens(ITEM));
    assert_eq!(emitted.to_string(), expansion.into_tokens().to_string());
}
