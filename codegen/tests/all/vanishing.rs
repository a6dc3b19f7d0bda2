//! Derivatives where a root is zero: those that exist are right, the others are not finite.

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::expr::{Arena, Expr, Function, Number, Stage, Vector, gradient};
use coadjoint_codegen::group::{self, ComponentValue, Group as _};

/// An energy of `x, y, z` and `w`, which is one where the others are zero.
type Energy = for<'a> fn([Expr<'a>; 4]) -> Expr<'a>;

fn norm<'a>(components: &[Expr<'a>]) -> Expr<'a> {
    let vector = Vector(components.to_vec());
    vector.dot(&vector).sqrt()
}

/// A constant.
fn number<'a>(like: Expr<'a>, value: f64) -> Expr<'a> {
    like.arena().number(Number::ratio((value * 20.0) as i128, 20))
}

/// `|(x, y, z)|^exponent`
fn power<'a>([x, y, z, _]: [Expr<'a>; 4], exponent: f64) -> Expr<'a> {
    norm(&[x, y, z]).pow(number(x, exponent))
}

/// The angle of the rotation of the quaternion `w + x i + y j + z k`.
fn angle<'a>([x, y, z, w]: [Expr<'a>; 4]) -> Expr<'a> {
    norm(&[x, y, z]).atan2(w) * 2
}

/// Without a derivative at zero.
const ROUGH: [(&str, Energy); 9] = [
    ("|v|", |v| power(v, 1.0)),
    ("√|v|", |v| power(v, 0.5)),
    ("|v| exp x", |v| power(v, 1.0) * v[0].apply(Function::Exp)),
    ("|x|", |[x, ..]| norm(&[x])),
    ("angle", angle),
    ("(|v| − 1)²", |v| (power(v, 1.0) - 1).powi(2)),
    ("1/|v|", |v| power(v, -1.0)),
    ("exp |v| − 1", |v| power(v, 1.0).apply(Function::Exp) - 1),
    ("|v| cos |v|", |v| power(v, 1.0) * power(v, 1.0).apply(Function::Cos)),
];

/// With a derivative, but without a second one.
const ONCE: [(&str, Energy); 8] = [
    ("|v| x", |v| power(v, 1.0) * v[0]),
    ("|v| (x − 2 y)", |v| power(v, 1.0) * (v[0] - v[1] * 2)),
    ("|v| sin x exp y", |v| power(v, 1.0) * v[0].apply(Function::Sin) * v[1].apply(Function::Exp)),
    ("|x| x", |[x, ..]| norm(&[x]) * x),
    ("|v|^1.5", |v| power(v, 1.5)),
    ("√|x| x y", |[x, y, ..]| norm(&[x]).sqrt() * x * y * x.apply(Function::Cos)),
    ("angle x", |v| angle(v) * v[0]),
    ("sin(|v|) y", |v| power(v, 1.0).apply(Function::Sin) * v[1]),
];

/// With two derivatives, or all of them.
const SMOOTH: [(&str, Energy); 36] = [
    ("|v|²", |v| power(v, 2.0)),
    ("|v|³", |v| power(v, 3.0)),
    ("|v|⁵", |v| power(v, 5.0)),
    ("|v|^2.5", |v| power(v, 2.5)),
    ("|v|^3.5", |v| power(v, 3.5)),
    ("|v|^2.3", |v| power(v, 2.3)),
    ("(v²)^1.25", |[x, y, z, _]| (x * x + y * y + z * z).pow(number(x, 1.25))),
    ("|v| x y", |v| power(v, 1.0) * v[0] * v[1]),
    ("|v| x sin y", |v| power(v, 1.0) * v[0] * v[1].apply(Function::Sin)),
    ("|v|² |v|", |v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * power(v, 1.0)),
    ("|v| (v·a)²", |v| power(v, 1.0) * (v[0] - v[1] * 3 + v[2]).powi(2)),
    ("|x|³", |[x, ..]| norm(&[x]).powi(3)),
    ("|x| x²", |[x, ..]| norm(&[x]) * x * x),
    ("|x|^2.5", |[x, ..]| (x * x).pow(number(x, 1.25))),
    ("|x|³ + |y|³", |[x, y, ..]| norm(&[x]).powi(3) + norm(&[y]).powi(3)),
    ("|v|³ |x|³", |v| power(v, 3.0) * norm(&[v[0]]).powi(3)),
    ("|v − (1 − w) e|³", |[x, y, z, w]| norm(&[x + w - 1, y, z]).powi(3)),
    ("|(x + y, y − z)|³", |[x, y, z, _]| norm(&[x + y, y - z]).powi(3)),
    ("cos |v|", |v| power(v, 1.0).apply(Function::Cos)),
    ("cosh |v|", |v| power(v, 1.0).apply(Function::Cosh)),
    ("|v| sin |v|", |v| power(v, 1.0) * power(v, 1.0).apply(Function::Sin)),
    ("|v| tan |v|", |v| power(v, 1.0) * power(v, 1.0).apply(Function::Tan)),
    ("|v| sinh |v|", |v| power(v, 1.0) * power(v, 1.0).apply(Function::Sinh)),
    ("tanh² |v|", |v| power(v, 1.0).apply(Function::Tanh).powi(2)),
    ("atan² |v|", |v| power(v, 1.0).apply(Function::Atan).powi(2)),
    ("|v| asin |v|", |v| power(v, 1.0) * power(v, 1.0).apply(Function::Asin)),
    ("angle²", |v| angle(v).powi(2)),
    ("angle² + 3 angle⁴", |v| angle(v).powi(2) + angle(v).powi(4) * 3),
    ("cos angle", |v| angle(v).apply(Function::Cos)),
    ("angle sin angle", |v| angle(v) * angle(v).apply(Function::Sin)),
    ("sin²(angle + angle³/50)", |v| (angle(v) + angle(v).powi(3) / 50).apply(Function::Sin).powi(2)),
    ("angle |v| exp x", |v| angle(v) * power(v, 1.0) * v[0].apply(Function::Exp)),
    ("angle³", |v| angle(v).powi(3)),
    ("(1 + |v|) exp(−|v|)", |v| (power(v, 1.0) + 1) * (-power(v, 1.0)).apply(Function::Exp)),
    ("(v · v/|v|)²", |[x, y, z, w]| {
        let r = power([x, y, z, w], 1.0);
        (x * x / r + y * y / r + z * z / r).powi(2).with_limits()
    }),
    ("(|v|²)²^½", |v| power(v, 2.0).powi(2).sqrt()),
];

/// With a derivative that is known, and a second one that is not.
const BEGUN: [(&str, Energy); 5] = [
    ("|v| − sin |v|", |v| power(v, 1.0) - power(v, 1.0).apply(Function::Sin)),
    ("|v| − ln(1 + |v|)", |v| power(v, 1.0) - (power(v, 1.0) + 1).apply(Function::Ln)),
    ("|v| (1 − exp(−|v|))", |v| power(v, 1.0) * (-(-power(v, 1.0)).apply(Function::Exp) + 1)),
    ("(√(1 + |v|) − 1) |v|", |v| ((power(v, 1.0) + 1).sqrt() - 1) * power(v, 1.0)),
    ("(exp |v| − 1) y", |v| (power(v, 1.0).apply(Function::Exp) - 1) * v[1]),
];

/// A function with its derivatives, of numbers.
struct Derived {
    value: Box<dyn Fn([f64; 4]) -> f64>,
    gradient: Box<dyn Fn([f64; 4]) -> Vec<f64>>,
    /// The same by the forward mode.
    forward: Box<dyn Fn([f64; 4]) -> Vec<f64>>,
    hessian: Box<dyn Fn([f64; 4]) -> Vec<f64>>,
}

fn derived(energy: Energy) -> Derived {
    let arena: &'static Arena = Box::leak(Box::new(Arena::new()));
    let symbols = ["x", "y", "z", "w"].map(|name| arena.symbol(name, Stage::Step));
    let value = energy(symbols);
    let symbols = Vector(symbols.to_vec()).symbols();
    let gradient = gradient(value, &symbols);
    let forward = Vector(Vector(vec![value]).jacobian(&symbols).entries);
    let hessian = Vector(gradient.jacobian(&symbols).entries);
    let places = symbols.clone();
    let at = move |vector: &Vector<'static>, at: [f64; 4]| {
        vector.evaluate(&|symbol| at[places.iter().position(|other| *other == symbol).expect("one of them")])
    };
    let (of_value, of_gradient, of_forward) = (at.clone(), at.clone(), at.clone());
    Derived {
        value: Box::new(move |v| of_value(&Vector(vec![value]), v)[0]),
        gradient: Box::new(move |v| of_gradient(&gradient, v)),
        forward: Box::new(move |v| of_forward(&forward, v)),
        hessian: Box::new(move |v| at(&hessian, v)),
    }
}

const ORIGIN: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// A point near the origin, or one component changed.
fn near(by: f64, along: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|k| ORIGIN[k] + by * along[k])
}

fn axis(k: usize) -> [f64; 4] {
    std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 })
}

/// The derivative of a vector along the axes, by central differences.
fn differences(of: impl Fn([f64; 4]) -> Vec<f64>, at: [f64; 4], h: f64) -> Vec<f64> {
    let columns: Vec<Vec<f64>> = (0..4)
        .map(|k| {
            let shifted = |by: f64| of(std::array::from_fn(|i| at[i] + by * axis(k)[i]));
            shifted(h).iter().zip(shifted(-h)).map(|(a, b)| (a - b) / (2.0 * h)).collect()
        })
        .collect();
    (0..columns[0].len())
        .flat_map(|i| columns.iter().map(move |column| column[i]).collect::<Vec<_>>())
        .collect()
}

#[track_caller]
fn assert_close(what: &str, found: &[f64], expected: &[f64], bound: f64) {
    assert_eq!(found.len(), expected.len());
    let is_close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= bound * b.abs().max(1.0));
    assert!(is_close, "{what}: {found:?} for {expected:?}");
}

const DIRECTIONS: [[f64; 4]; 6] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, -1.0, 0.0, 0.0],
    [0.0, 0.6, -0.8, 0.0],
    [0.3, -0.7, 0.2, 0.0],
    [1.0, 1.0, 0.0, 0.0],
    [-1e-9, 0.0, 1.0, 0.0],
];

const DISTANCES: [f64; 13] =
    [1e-300, 1e-200, 1e-170, 1e-162, 1e-160, 1e-155, 1e-150, 1e-120, 1e-103, 1e-80, 1e-50, 1e-30, 1e-20];

#[test]
fn derivatives_that_exist_are_there_at_zero() {
    for (what, energy) in ONCE.into_iter().chain(BEGUN).chain(SMOOTH) {
        let Derived { value, gradient, forward, .. } = derived(energy);
        // of what has one derivative, the difference is off by as much as the root of the step
        let expected = differences(|v| vec![value(v)], ORIGIN, 1e-7);
        assert_close(what, &gradient(ORIGIN), &expected, 1e-3);
        assert_close(what, &forward(ORIGIN), &gradient(ORIGIN), 1e-15);
        for (distance, along) in DISTANCES.iter().flat_map(|t| DIRECTIONS.map(|along| (*t, along))) {
            let found = gradient(near(distance, along));
            let what = format!("{what}, {distance:e} {along:?}");
            assert_close(&what, &found, &gradient(ORIGIN), 1e-9);
            assert_close(&what, &forward(near(distance, along)), &found, 1e-14);
        }
    }
}

#[test]
fn second_derivatives_that_exist_are_there_at_zero() {
    for (what, energy) in SMOOTH {
        let Derived { gradient, hessian, .. } = derived(energy);
        let expected = differences(&gradient, ORIGIN, 1e-9);
        assert_close(what, &hessian(ORIGIN), &expected, 5e-3);
        for (distance, along) in DISTANCES.iter().flat_map(|t| DIRECTIONS.map(|along| (*t, along))) {
            let found = hessian(near(distance, along));
            assert_close(&format!("{what}, {distance:e} {along:?}"), &found, &hessian(ORIGIN), 2e-5);
        }
    }
}

#[test]
fn away_from_zero_derivatives_are_limits_of_differences() {
    let all = SMOOTH.into_iter().chain(ONCE).chain(BEGUN).chain(ROUGH);
    for (what, energy) in all {
        let Derived { value, gradient, hessian, .. } = derived(energy);
        for at in [[0.3, -0.2, 0.4, 0.8], [0.0, 0.3, 0.0, 0.9], [0.4, 0.0, 0.0, -0.3], [2e-3, 1e-3, 0.0, 1.1]]
        {
            // |x| and |y| have none where these are zero
            if ["x|", "y|"].iter().any(|root| what.contains(root)) && (at[0] == 0.0 || at[1] == 0.0) {
                continue;
            }
            assert_close(what, &gradient(at), &differences(|v| vec![value(v)], at, 1e-6), 1e-5);
            assert_close(what, &hessian(at), &differences(&gradient, at, 1e-6), 1e-4);
        }
    }
}

/// No zero is made up, and no other number.
#[test]
fn derivatives_that_do_not_exist_are_not_finite() {
    for (what, energy) in ROUGH {
        for found in [(derived(energy).gradient)(ORIGIN), (derived(energy).forward)(ORIGIN)] {
            assert!(found.iter().any(|x| !x.is_finite()), "{what}: {found:?}");
        }
    }
    for (what, energy) in ONCE {
        let found = (derived(energy).hessian)(ORIGIN);
        assert!(found.iter().any(|x| !x.is_finite()), "{what}: {found:?}");
    }
    // where an angle is half a turn its square has an edge
    let half_turn = [0.0, 0.0, 0.0, -1.0];
    for (what, energy) in SMOOTH.into_iter().filter(|(what, _)| what.starts_with("angle")) {
        let found = (derived(energy).gradient)(half_turn);
        assert!(found.iter().any(|x| !x.is_finite()), "{what}: {found:?}");
    }
}

/// A homogeneous function of degree d has derivatives of degree d − 1 and d − 2: from the digits at one point follow
/// those at all others, to where numbers end.
#[test]
fn near_zero_all_digits_are_right() {
    let homogeneous: [(i32, Energy); 6] = [
        (3, |v| power(v, 3.0)),
        (3, |v| power(v, 1.0) * v[0] * v[1]),
        (2, |v| power(v, 1.0) * v[0]),
        (2, |[x, ..]| norm(&[x]) * x),
        (4, |v| power(v, 3.0) * v[2]),
        (5, |v| power(v, 5.0)),
    ];
    for (degree, energy) in homogeneous {
        let Derived { gradient, hessian, .. } = derived(energy);
        let along = [0.3, -0.7, 0.2, 0.0];
        for exponent in [-8, -40, -100, -150] {
            let scale = 2.0_f64.powi(exponent);
            let scaled = |of: Vec<f64>, degree: i32| -> Vec<f64> {
                of.into_iter().map(|x| x * scale.powi(degree)).collect()
            };
            for (found, expected) in [
                (gradient(near(scale, along)), scaled(gradient(near(1.0, along)), degree - 1)),
                (hessian(near(scale, along)), scaled(hessian(near(1.0, along)), degree - 2)),
            ] {
                let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
                let error = found.iter().zip(&expected).fold(0.0_f64, |size, (a, b)| size.max((a - b).abs()));
                assert!(
                    error <= 8.0 * f64::EPSILON * size,
                    "{degree}, {exponent}: {found:?} for {expected:?}"
                );
            }
        }
    }
}

/// `acos(w)²` and what is like it have derivatives at 1, on the side where they are real: 2 u + u²/3 + 4 u³/45 with
/// u = 1 − w.
#[test]
fn the_square_of_an_arc_cosine_is_smooth_at_one() {
    let square = derived(|[.., w]| w.apply(Function::Acos).powi(2));
    // −θ² / 2 as a function of the cosine of 2 θ
    let double = derived(|[.., w]| (w * w * 2 - 1).apply(Function::Acos).powi(2));
    assert_eq!(((square.gradient)(ORIGIN)[3], (double.gradient)(ORIGIN)[3]), (-2.0, -8.0));
    assert!(((square.hessian)(ORIGIN)[15] - 2.0 / 3.0).abs() < 1e-15);
    for theta in [1e-7, 1e-5, 1e-3, 0.1, 0.7, 1.5, 2.0_f64] {
        let at = [0.0, 0.0, 0.0, theta.cos()];
        let (sine, cosine) = theta.sin_cos();
        // the cosine of a small angle is rounded, and its arc cosine is that of another angle
        assert_close("gradient", &[(square.gradient)(at)[3]], &[-2.0 * theta / sine], 1e-14);
        if theta > 0.05 {
            let expected = 2.0 * (sine - theta * cosine) / sine.powi(3);
            assert_close("hessian", &[(square.hessian)(at)[15]], &[expected], 1e-11);
        }
    }
    let edge = derived(|[.., w]| w.apply(Function::Acos));
    assert!(!(edge.gradient)(ORIGIN)[3].is_finite());
}

/// A force is given as it is, and has the limit that it has.
#[test]
fn values_have_their_limits_too() {
    let at_zero = |energy: Energy| {
        let arena = Arena::new();
        let symbols = ["x", "y", "z", "w"].map(|name| arena.symbol(name, Stage::Step));
        let value = energy(symbols).with_limits();
        let symbols = Vector(symbols.to_vec()).symbols();
        value.evaluate(&|symbol| {
            ORIGIN[symbols.iter().position(|other| *other == symbol).expect("one of them")]
        })
    };
    assert_eq!(at_zero(|v| v[0] * v[1] / power(v, 1.0)), 0.0);
    assert_eq!(at_zero(|v| angle(v) / power(v, 1.0)), 2.0);
    assert_eq!(at_zero(|v| power(v, 1.0).apply(Function::Sin) / power(v, 1.0)), 1.0);
    assert!(at_zero(|v| v[0] / power(v, 1.0)).is_nan());
}

/// A root of what is positive, or of what is negative too, is none of these.
#[test]
fn other_roots_are_as_they_were() {
    let arena = Arena::new();
    let [x, y, t] = ["x", "y", "t"].map(|name| arena.symbol(name, Stage::Step));
    let symbols = Vector(vec![x, y, t]).symbols();
    let of = |expr: Expr<'_>| gradient(expr, &symbols).0[0].to_string();
    assert_eq!(
        of((x * x + y * y + 1).sqrt() * x * x),
        "2 x sqrt(x^2 + y^2 + 1) + x^3 sqrt(x^2 + y^2 + 1)^-1"
    );
    // of order 1/2: it has a limit, though not for lack of size of x
    assert!(of((x * x - t * t).sqrt() * x).contains("x^2 sqrt(x^2 - t^2)^-1"));
    assert!(of((x * x + y * y).sqrt() * x).contains("recip_or_zero"));
    // of a constant the sign is not known; that of a norm with weights is positive
    let weight = arena.symbol("weight", Stage::Parameters);
    assert!(of((weight * x * x + y * y).sqrt() * x).contains("recip_or_zero"));
    // what vanishes as a sum does not vanish as a part of another
    let of_sums = (x + y).powi(2) + (y - t).powi(2);
    assert!(of(of_sums.sqrt() * (x + t)).contains("recip_or_zero"));
    assert!(of(of_sums.sqrt() * (x - t)).contains("^-1"));
    // nothing is divided where algebra can do without
    assert_eq!(of((x * x).sqrt() * x), "2 sqrt(x^2)");
    assert_eq!(of((x * x + y * y).sqrt().powi(3)), "3 x sqrt(x^2 + y^2)");
}

/// What nalgebra calls `angle()` or `scaled_axis()` of a quaternion whose symbols are those of an [`Energy`].
fn component<'a>(name: &str, [x, y, z, w]: [Expr<'a>; 4]) -> Vec<Expr<'a>> {
    let components = group::SO3.names().components;
    let component = components.iter().find(|component| component.name == name).expect("it has one");
    match (component.of)(&Vector(vec![w, x, y, z])) {
        ComponentValue::Scalar(scalar) => vec![scalar],
        ComponentValue::Vector(vector) => vector.0,
        ComponentValue::Element(..) => panic!("{name} is a number or a vector"),
    }
}

/// `g exp(δ)` changes by `g δ/2`: the derivative along it of something by the quaternion.
fn along_the_group(derivative: &[f64], [x, y, z, w]: [f64; 4]) -> [f64; 3] {
    let changes = [[w, z, -y, -x], [-z, w, x, -y], [y, -x, w, -z]];
    changes.map(|change| change.iter().zip(derivative).map(|(a, b)| a * b / 2.0).sum())
}

/// With `x = scaled_axis`: `dx = (1 + ½ x̂ + (1/θ² − cot(θ/2)/2θ) x̂²) δ`, and `dθ² = 2 x·δ`, at both quaternions of a
/// rotation.
#[test]
fn angle_and_scaled_axis_are_smooth_but_at_half_a_turn() {
    let scaled_axis: [Energy; 3] = [
        |v| component("scaled_axis", v)[0],
        |v| component("scaled_axis", v)[1],
        |v| component("scaled_axis", v)[2],
    ];
    let squared = derived(|v| component("angle", v)[0].powi(2));
    let angle = derived(|v| component("angle", v)[0]);
    let scaled_axis = scaled_axis.map(derived);
    let unit = nalgebra::Vector3::new(0.6, -0.48, 0.64);
    for theta in [0.0, 1e-200, 1e-9, 1e-4, 0.3, 1.0, 2.0, 3.0, 3.1_f64] {
        let x = theta * unit;
        let factor =
            if theta < 1e-3 { 1.0 / 12.0 } else { 1.0 / theta.powi(2) - 0.5 / (theta * (theta / 2.0).tan()) };
        let hat = x.cross_matrix();
        let expected = nalgebra::Matrix3::identity() + hat * 0.5 + hat * hat * factor;
        for sign in [1.0, -1.0] {
            let u = sign * (theta / 2.0).sin() * unit;
            let at = [u.x, u.y, u.z, sign * (theta / 2.0).cos()];
            let what = format!("{theta}, {sign}");
            assert_close(&what, &[(angle.value)(at), (squared.value)(at)], &[theta, theta * theta], 1e-14);
            let gradient = along_the_group(&(squared.gradient)(at), at);
            assert_close(&what, &gradient, (2.0 * x).as_slice(), 1e-13);
            for (k, component) in scaled_axis.iter().enumerate() {
                assert_close(&what, &[(component.value)(at)], &[x[k]], 1e-14);
                let row: Vec<f64> = expected.row(k).iter().copied().collect();
                assert_close(&what, &along_the_group(&(component.gradient)(at), at), &row, 1e-11);
                // second derivatives too
                let found = differences(|v| (component.gradient)(v), at, 1e-5);
                assert_close(&what, &(component.hessian)(at), &found, 1e-4);
            }
        }
    }
    // the axis is lost
    let half_turn = [0.6, 0.0, 0.8, 0.0];
    assert!((scaled_axis[0].value)(half_turn).is_nan());
    assert!((squared.gradient)(half_turn).iter().any(|x| !x.is_finite()));
}

/// What is bounded where a root is zero vanishes with a factor that is zero there by its value: a parameter, or in
/// derivatives that are not taken again something of the state.
#[test]
fn factors_that_are_zero_decide() {
    let arena = Arena::new();
    let [x, y, u, w] = ["x", "y", "u", "w"].map(|name| arena.symbol(name, Stage::Step));
    let [rest, exponent] = ["rest", "exponent"].map(|name| arena.symbol(name, Stage::Parameters));
    let all = Vector(vec![x, y, u, w, rest, exponent]);
    let symbols = all.symbols();
    let at = |vector: &Vector<'_>, values: [f64; 6]| {
        vector.evaluate(&|symbol| {
            values[symbols.iter().position(|other| *other == symbol).expect("one of them")]
        })
    };
    let r = (x * x + y * y).sqrt();

    // a spring, at its anchor, by its length at rest
    let spring = gradient((r - rest).powi(2).with_lengths(false), &symbols[..2]);
    assert_eq!(at(&spring, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [0.0, 0.0]);
    assert!(at(&spring, [0.0, 0.0, 0.0, 0.0, 0.5, 0.0]).iter().all(|x| x.is_nan()));
    assert_close("spring", &at(&spring, [3.0, 4.0, 0.0, 0.0, 0.0, 0.0]), &[6.0, 8.0], 1e-15);
    assert_eq!(at(&spring, [3.0, 4.0, 0.0, 0.0, 5.0, 0.0]), [0.0, 0.0]);
    let hessian = Vector(spring.jacobian(&symbols[..2]).entries);
    assert_close("spring", &at(&hessian, [0.0; 6]), &[2.0, 0.0, 0.0, 2.0], 1e-15);
    let friction = (rest * x / r).with_limits_of_force(false);
    assert_eq!(at(&Vector(vec![friction]), [0.0; 6]), [0.0]);
    assert!(at(&Vector(vec![friction]), [0.0, 0.0, 0.0, 0.0, 1e-200, 0.0])[0].is_nan());

    // |x|^n
    let of_power = gradient(r.pow(exponent), &symbols[..2]);
    for (n, found) in [(2.0, 0.0), (3.0, 0.0), (1.5, 0.0), (1.0, f64::NAN), (0.5, f64::NAN)] {
        let zero = at(&of_power, [0.0, 0.0, 0.0, 0.0, 0.0, n]);
        assert!(zero.iter().all(|x| *x == found || x.is_nan() && f64::is_nan(found)), "{n}: {zero:?}");
        let there = at(&of_power, [3.0, 4.0, 0.0, 0.0, 0.0, n]);
        let expected = [3.0, 4.0].map(|x| n * 5.0_f64.powf(n - 2.0) * x);
        assert_close(&format!("{n}"), &there, &expected, 1e-15);
    }

    // of directions of two vectors there is no limit where both are zero
    let both = Vector(Vector(vec![r * u / (u * u + w * w).sqrt()]).last_jacobian(&symbols[..4]).entries);
    assert!(at(&both, [0.0; 6])[..2].iter().all(|x| !x.is_finite()));

    // drag in proportion to where one is; in a plane, of what goes through it; along a line of sight
    let sight = (x * u + y * w) / r;
    for (what, force) in [("|x| v", r * u), ("along", sight * x), ("|x| |v|²", r * (u * u + w * w))] {
        let jacobian = Vector(Vector(vec![force]).last_jacobian(&symbols[..4]).entries);
        assert_eq!(at(&jacobian, [0.0; 6]), [0.0; 4], "{what}");
        let there = at(&jacobian, [0.0, 0.0, 0.3, 0.4, 0.0, 0.0]);
        assert!(there.iter().any(|x| !x.is_finite()), "{what}: {there:?}");
        let near = at(&jacobian, [3e-9, -4e-9, 2e-9, 1e-9, 0.0, 0.0]);
        assert!(near.iter().all(|x| x.abs() < 1e-8), "{what}: {near:?}");
    }
}
