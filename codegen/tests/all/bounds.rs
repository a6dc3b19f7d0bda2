//! Whatever is described, the answer comes soon: code or an error at its tokens, and documentation of the length of the formulas' graph.

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::expand;
use coadjoint_codegen::expr::{Arena, Expr, Function, Number, Stage, Vector};
use coadjoint_codegen::kernel::{self, Inputs};
use coadjoint_codegen::program::{Input, SystemRole};
use proc_macro2::{TokenStream, TokenTree};

/// Tokens, and what is wrong with them.
type Problem = (String, String);

/// What a thread has if nobody asks for more.
const STACK: usize = 2 << 20;

/// What the generator says to a description.
fn answer(attribute: String, item: String) -> Result<String, Vec<Problem>> {
    let run = move || {
        let tokens =
            |text: &str| text.parse::<TokenStream>().unwrap_or_else(|error| panic!("{error}: {text}"));
        let expansion = expand(tokens(&attribute), tokens(&item)).map_err(|errors| {
            let at = |error: &syn::Error| error.span().source_text().unwrap_or_default();
            errors.into_iter().map(|error| (at(&error), error.to_string())).collect::<Vec<_>>()
        })?;
        Ok(expansion.into_tokens().to_string())
    };
    let thread =
        std::thread::Builder::new().stack_size(STACK).spawn(run).expect("there is memory for a stack");
    thread.join().expect("the generator does not panic")
}

/// To a heavy top with this potential.
fn of_potential(potential: &str) -> Result<String, Vec<Problem>> {
    let attribute = format!("group = SO3, advected(gamma: R3), potential = {potential}");
    let item = "struct Top { #[inertia] inertia: Vector3<f64>, chi: Vector3<f64>, w: f64, x: f64, y: f64 }";
    answer(attribute, item.to_owned())
}

fn code(potential: &str) -> String {
    of_potential(potential).unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// The one problem with a potential.
fn problem(potential: &str) -> Problem {
    let problems = of_potential(potential).expect_err("there is a problem");
    <[Problem; 1]>::try_from(problems)
        .unwrap_or_else(|problems| panic!("{problems:?}"))
        .into_iter()
        .collect::<Vec<_>>()
        .remove(0)
}

/// The documentation of the items in some code, line by line.
fn documentation(code: &str) -> Vec<String> {
    let tokens: TokenStream = code.parse().expect("code is made of tokens");
    let line = |token: TokenTree| match token {
        TokenTree::Group(group) => syn::parse2::<syn::MetaNameValue>(group.stream()).ok(),
        _ => None,
    };
    let text = |line: syn::MetaNameValue| match line.value {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value().trim().to_owned()),
        _ => None,
    };
    tokens.into_iter().filter_map(line).filter(|line| line.path.is_ident("doc")).filter_map(text).collect()
}

/// Statements again and again.
fn block(first: &str, again: &str, times: usize, last: &str) -> String {
    format!("{{ {first} {} {last} }}", again.repeat(times))
}

/// Documentation gets longer by the same with each statement: written as a tree, it would get several times as long.
fn documentation_grows_linearly(text: impl Fn(usize) -> String) {
    let length = |times| documentation(&code(&text(times))).iter().map(String::len).sum::<usize>();
    let [few, more, many] = [2, 4, 6].map(length);
    assert!(few < more && more < many, "{few}, {more}, {many}");
    assert!(many - more < 2 * (more - few), "{few}, {more}, {many}");
}

#[test]
fn documentation_names_what_occurs_again() {
    documentation_grows_linearly(|times| {
        block("let v = gamma;", "let v = v.cross(&chi).normalize();", times, "v.dot(&chi)")
    });
    documentation_grows_linearly(|times| {
        block("let a = gamma.x;", "let a = 3.9 * a * (1.0 - a);", times, "a")
    });
    documentation_grows_linearly(|times| block("let a = gamma.x;", "let a = a.sin() * a.cos();", times, "a"));
}

/// Arrays of arrays of arrays, and copies of copies, are an error before they take time or the stack.
#[test]
fn arrays_within_arrays_have_a_bound() {
    for (again, times) in [
        ("let x = [x];", 900),
        ("let x = (x,);", 900),
        ("let x = [x, x];", 900),
        ("let x = [x].map(|x| [x, x]);", 300),
    ] {
        let (_, message) = problem(&block("let x = gamma;", again, times, "w"));
        assert!(message.starts_with("up to here, expressions make sums and products"), "{again}: {message}");
    }
    let pairs = "(0..64).map(|i| (0..i).map(|j| gamma.x * i as f64 + j as f64).sum::<f64>()).sum::<f64>()";
    assert!(!code(pairs).is_empty());
}

#[test]
fn documentation_reads_like_formulas() {
    let lines = documentation(&code("w * (gamma.x * gamma.y + gamma.z * x * y).sin()"));
    let of_energy: Vec<&str> = lines
        .iter()
        .map(String::as_str)
        .filter(|line| line.starts_with("∂V") || line.starts_with('s'))
        .collect();
    assert_eq!(
        of_energy,
        [
            "s1 = cos(gamma_x gamma_y + x y gamma_z)",
            "∂V/∂gamma_x = w gamma_y s1",
            "∂V/∂gamma_y = w gamma_x s1",
            "∂V/∂gamma_z = w x y s1",
        ]
    );
}

#[test]
fn constants_are_written_by_their_paths() {
    let lines = documentation(&code("GRAVITY * gamma.x + G * gamma.y + <f64 as A>::B * gamma.z"));
    for line in ["∂V/∂gamma_x = GRAVITY", "∂V/∂gamma_y = G", "∂V/∂gamma_z = <f64 as A>::B"] {
        assert!(lines.iter().any(|known| known == line), "{line} is not in {lines:?}");
    }
}

#[test]
fn very_long_documentation_is_left_out() {
    let term = |i| format!("let a = a + (gamma.x * {i}.5).sin() * (gamma.y * {i}.5).cos();");
    let terms: Vec<String> = (0..200).map(term).collect();
    let lines = documentation(&code(&format!("{{ let a = 0.0; {} a }}", terms.concat())));
    assert!(
        lines.iter().any(|line| line == "The derivatives of V are too long for this place."),
        "{lines:?}"
    );
    assert!(lines.iter().all(|line| line.len() < 1_000));
}

/// Text of an expression is short even where its tree is exponentially larger than its graph.
#[test]
fn messages_show_no_trees() {
    let arena = Arena::new();
    let x = arena.symbol("x", Stage::Step);
    let text = (0..60).fold(x, |x, _| x.apply(Function::Sin) * x).to_string();
    assert!(text.len() < 20_000, "{}", text.len());
    assert!(text.contains('…'));
}

/// Each statement nests and chains for itself, however many there are.
#[test]
fn statements_are_counted_one_by_one() {
    let sum = vec!["w"; 60].join(" + ");
    let block = format!("{{ let a = x; {} a * gamma.z }}", format!("let a = a * ({sum}); ").repeat(40));
    assert!(code(&block).contains("impl"));
}

#[test]
fn long_computations() {
    code(&block("let v = gamma;", "let v = v.cross(&chi).normalize();", 6, "v.dot(&chi)"));
    code(&block("let a = gamma.x;", "let a = 3.9 * a * (1.0 - a);", 14, "a"));
    code(&block("let a = gamma.x;", "let a = a.sin() * a.cos();", 16, "a"));
    code("((1.0 + w + gamma.x).powi(1024) + gamma.y).powi(1024)");
}

#[test]
fn long_chains() {
    code(&format!("w{}", " + gamma.x * gamma.y".repeat(200)));
    code(&format!("gamma.x{}", ".powi(2)".repeat(5)));
    let chains = [
        format!("gamma.x{}", " + gamma.x".repeat(2_000)),
        format!("gamma.x{}", ".sin()".repeat(3_000)),
        format!("gamma.x{}", " as f64".repeat(300)),
        format!("gamma{}", "[0]".repeat(300)),
        "(".repeat(20) + "gamma.x" + &(".sin()".repeat(20) + ")").repeat(20),
    ];
    for chain in chains {
        let (_, message) = problem(&chain);
        assert_eq!(
            message, "this chain has more than 256 operators and methods; split it with `let`",
            "{chain}"
        );
    }
}

/// A graph may be much deeper than an expression.
#[test]
fn deep_graphs() {
    let arena = Arena::new();
    let x = arena.symbol("x", Stage::Step);
    let deep = (0..100_000).fold(x, |deep, _| deep.apply(Function::Sin) + x);
    let symbol = x.as_symbol().expect("a symbol");
    assert!(deep.substitute(&[(symbol, arena.zero())]).is_zero());
    assert!(!deep.derivative(symbol).is_zero());
    assert_eq!(deep.evaluate(&|_| 0.0), 0.0);
    assert!(deep.depends_on(&[symbol]));
    assert_eq!(deep.stage(), Stage::Step);
    assert!(deep.to_string().contains('…'));
}

/// So may the code that is made of it, on the smallest stack that rustc has: sums, products, quotients, powers and angles.
#[test]
fn deep_code() {
    let made = std::thread::Builder::new().stack_size(STACK).spawn(|| {
        let arena = Arena::new();
        let x = arena.symbol("x", Stage::Step);
        let symbols = vec![x.as_symbol().expect("a symbol")];
        let next: [for<'a> fn(Expr<'a>, Expr<'a>) -> Expr<'a>; 5] = [
            |deep, x| -(deep.apply(Function::Sin) + x),
            |deep, x| (deep * x).hold() * 2,
            |deep, x| x / (deep + 1),
            |deep, x| deep.pow(x),
            |deep, x| deep.atan2(x),
        ];
        let deep = (0..30_000).fold(x, |deep, i| next[i % next.len()](deep, x));
        let inputs = Inputs::default().with(Input::State, symbols);
        let module = kernel::function(&arena, SystemRole::Energy, &Vector(vec![deep]), inputs);
        module.functions[0].operations().total()
    });
    let operations = made.expect("a thread").join().expect("code");
    assert!(operations > 30_000, "{operations}");
    // as a description within all bounds
    let chain = format!("let a = a{};", ".sin()".repeat(200));
    problem(&block("let a = gamma.x;", &chain, 16, "a"));
}

#[test]
fn more_than_can_be_derived() {
    let potential = block("let a = gamma.x;", "let a = a.sin();", 400, "a");
    let (at, message) = problem(&potential);
    assert_eq!(at, potential);
    let bound = "deriving the steps of this system takes sums and products of more than 5000000 operands, the bound of what compiles \
                 in seconds; ";
    let rest = "take one retraction, `retractions(Cayley)`, or simplify its expressions, or describe a system of fewer dimensions";
    assert_eq!(message, format!("{bound}{rest}"));
    let attribute =
        format!("group = SO3, advected(gamma: R3), potential = {potential}, derivatives, methods(Midpoint)");
    let item = "struct Top { #[inertia] inertia: Vector3<f64> }";
    let problems = answer(attribute, item.to_owned()).expect_err("even more");
    let ways = "leave out `derivatives`, or name those that you need, or leave out `methods`, as the standard steps are there without it";
    assert_eq!(problems[0].1, format!("{bound}{ways}, or {rest}"));
}

/// It runs out while a step is linearized, of which there is a part then.
#[test]
fn matrices_that_cannot_be_derived() {
    let attribute = "group = SL(3), advected(b: R3), potential = b[0] * b[1], force = 0.1 * momentum, derivatives(state), \
                     retractions(Exponential), methods(Midpoint)";
    let item = "struct Sheared { #[inertia] inertia: SVector<f64, 8> }";
    let problems = answer(attribute.to_owned(), item.to_owned()).expect_err("it takes too much");
    assert!(problems[0].1.contains("of more than 5000000 operands"), "{}", problems[0].1);
}

#[test]
fn orders_that_are_too_high_name_one_that_fits() {
    let attribute = "group(first: SO3, second: SO3), potential = 1.0 - (first.inverse() * second).w.powi(2), \
                     retractions(Exponential), methods(HamiltonJacobi(10))";
    let item = "struct Bodies { #[inertia(first)] first_inertia: Vector3<f64>, #[inertia(second)] second_inertia: Vector3<f64> }";
    let problems = answer(attribute.to_owned(), item.to_owned()).expect_err("order 10 takes too much");
    let message = &problems[0].1;
    assert!(
        message.contains("in seconds; take `HamiltonJacobi(8)`, the highest order that fits, or "),
        "{message}"
    );
    let attribute = attribute.replace("HamiltonJacobi(10)", "HamiltonJacobi(8)");
    answer(attribute, item.to_owned()).expect("order 8 does not");
    // one after the other, by both retractions: it fits with all that is asked for
    let bodies = "group(first: SO3, second: SO3), potential = 1.0 - (first.inverse() * second).w.powi(2)";
    let body = "group = SE3, potential = b * pose.translation.z + c * pose.transform_vector(&Vector3::z()).z";
    let thrown = "struct Thrown { #[inertia] inertia: Vector6<f64>, b: f64, c: f64 }";
    for (attribute, item, asked) in [(bodies, item, 10), (body, thrown, 8)] {
        let of_order =
            |order: u32| answer(format!("{attribute}, methods(HamiltonJacobi({order}))"), item.to_owned());
        let message = of_order(asked).expect_err("it takes too much").remove(0).1;
        let named = message.split("take `HamiltonJacobi(").nth(1).and_then(|rest| rest.split(')').next());
        let named: u32 = named.and_then(|order| order.parse().ok()).unwrap_or_else(|| panic!("{message}"));
        of_order(named).expect("what is named fits");
        assert!(named + 2 == asked || of_order(named + 2).is_err(), "{named} is not the highest: {message}");
    }
}

#[test]
fn more_than_can_be_read() {
    let potential = block(
        "let m = SMatrix::<f64, 32, 32>::repeat(gamma.x) + SMatrix::<f64, 32, 32>::identity() * w;",
        "let m = m * m;",
        3,
        "m[0]",
    );
    let (at, message) = problem(&potential);
    assert_eq!(at, "m * m");
    assert!(
        message.starts_with("up to here, expressions make sums and products of more than 200000"),
        "{message}"
    );
}

#[test]
fn many_parts() {
    let names = |f: &dyn Fn(usize) -> String| (0..100).map(f).collect::<Vec<_>>();
    let advected = names(&|i| format!("a{i}: R3")).join(", ");
    let potential = names(&|i| format!("let v = v + a{i}.dot(&chi);")).concat();
    let attribute =
        format!("group = SO3, advected({advected}), potential = {{ let v = 0.0; {potential} v }}");
    let item = "struct A { #[inertia] inertia: Vector3<f64>, chi: Vector3<f64> }";
    answer(attribute, item.to_owned()).unwrap_or_else(|problems| panic!("{problems:?}"));

    let factors = names(&|i| format!("a{i}: SE3")).join(", ");
    let problems = answer(format!("group({factors})"), "struct A { #[inertia] inertia: f64 }".to_owned());
    let (at, message) = problems.expect_err("a step has 600 unknowns").remove(0);
    let bound = "the factors of a system may have dimension 96 together; up to here they have 102";
    assert_eq!((at.as_str(), message.as_str()), ("a16", bound));

    let fields: String = (0..100).map(|i| format!("a{i}: SMatrix<f64, 32, 32>, ")).collect();
    let problems =
        answer("group = R3".to_owned(), format!("struct A {{ #[inertia] inertia: f64, {fields} }}"));
    let (at, message) = problems.expect_err("there are 102,401 numbers").remove(0);
    assert_eq!(at, "a9");
    assert_eq!(message, "fields and controls may have 10000 numbers together at most");

    let methods = names(&|i| format!("Family(1, {})", i + 2)).join(", ");
    let problems =
        answer(format!("group = R3, methods({methods})"), "struct A { #[inertia] inertia: f64 }".to_owned());
    let (at, message) = problems.expect_err("there are 100 methods").remove(0);
    assert_eq!((at.as_str(), message.as_str()), ("methods", "a system may have 16 methods at most"));
}

#[test]
fn large_numbers() {
    // as many characters as there may be
    let longest = format!("group = R1, potential = 0.{} * position.x", "3".repeat(998));
    answer(longest, "struct A { #[inertia] inertia: f64 }".to_owned()).expect("a long number");
    let (at, message) = problem(&format!("0.{} * gamma.x", "3".repeat(40_000)));
    assert_eq!((at.len(), message.as_str()), (40_002, "a name or number may have 1000 characters at most"));
    let family = |s: &str| {
        let attribute = format!("group = SO3, methods(Family({s}))");
        answer(attribute, "struct A { #[inertia] inertia: Vector3<f64> }".to_owned())
    };
    assert!(family("2147483647, 4294967295").is_ok());
    assert!(family("4294967294, 4294967295").is_ok());
    // the smallest integer has no magnitude among integers
    code("gamma.x * f64::from(-9223372036854775807 - 1)");
    code("1e300 * gamma.x.powi(1024)");
    let (at, message) = problem("1e308 * gamma.x.powi(10)");
    assert_eq!(at, "1e308 * gamma.x.powi(10)");
    assert_eq!(message, "the derivatives of this have constants that are too large; choose other units");
}

#[test]
fn numbers_do_not_overflow() {
    let smallest = Number::from(i64::MIN);
    assert_eq!(smallest.to_f64(), -(2f64.powi(63)));
    let product = Number::from(1 << 31) * Number::from(-(1 << 32));
    assert_eq!(product.to_f64(), -(2f64.powi(63)));
    assert_eq!(Number::ratio(2, 3).powi(-3).fraction(), Some((27, 8)));
    assert_eq!(Number::ratio(-2, 3).powi(-3).fraction(), Some((-27, 8)));
    assert_eq!(Number::from(3).powi(i32::MIN).to_f64(), 0.0);
    assert_eq!(Number::from(-1).powi(i32::MAX).fraction(), Some((-1, 1)));
    assert_eq!(Number::parse("1.5e-2147483648").map(Number::to_f64), None);
}

#[test]
fn names_of_groups_have_no_sign() {
    let problems = answer("group = R(-3)".to_owned(), "struct A { #[inertia] inertia: f64 }".to_owned());
    let (at, message) = problems.expect_err("no group is called `R-3`").remove(0);
    assert_eq!(
        (at.as_str(), message.as_str()),
        ("R", "write the name of the group in one word, such as `R3`")
    );
}

/// How many `let`s there are in a block at most.
fn most_lets(stream: TokenStream) -> usize {
    let (mut here, mut within) = (0, 0);
    for tree in stream {
        match tree {
            TokenTree::Ident(word) if word == "let" => here += 1,
            TokenTree::Group(group) => within = within.max(most_lets(group.stream())),
            _ => {}
        }
    }
    within.max(here)
}

/// Each is a scope within the one before, which rustc goes into by recursion: ten thousand are too many.
#[test]
fn no_function_has_more_scopes_than_rustc_can_go_into() {
    let expanded = |attribute: &str, item: &str| {
        let [attribute, item] = [attribute, item].map(|text| text.parse().expect("tokens"));
        expand(attribute, item).expect("a valid description").into_tokens()
    };
    let large = expanded(
        "group = SU(3), retractions(Exponential), derivatives(state)",
        "struct Body { #[inertia] inertia: SVector<f64, 8> }",
    );
    let lets = most_lets(large);
    assert!((200..2_000).contains(&lets), "{lets}");
    // of what is smaller, each value has a `let` of its own
    let small =
        expanded("group = SO3, derivatives(state)", "struct Body { #[inertia] inertia: Vector3<f64> }");
    assert!(most_lets(small) > 20);
}
