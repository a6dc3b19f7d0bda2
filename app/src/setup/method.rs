//! Methods by their names.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use serde::{Deserialize, Serialize};

use coadjoint::Scheme;
use coadjoint::erased::RetractionKind;
use coadjoint::scheme::Rule;
use coadjoint_classical::{Method as _, RungeKutta, Tableau};

use super::Order;

/// The integration method: of ours, built on a retraction, or a classical one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub enum Method {
    /// The system's standard step of order 2: `euler-a` where nothing but momentum and advected parameters has a part
    /// in the motion and the retraction is odd, else `verlet`.
    #[default]
    Standard,
    /// A step that was generated, where it was; of steps with an order the usual one stands for all.
    Step(Rule),
    /// Störmer and Verlet: half a step of `euler-a`, then half a step of `euler-b`; of order 2.
    Verlet,
    /// `euler-a` carrying the momentum in space, where nothing acts on the system.
    RightLift,
    /// Taylor steps to a tolerance, as many as there need be from one end of a step to the next, where the description has
    /// the key `taylor`.
    Taylor(Tolerance),
    /// A classical method, for comparison.
    Classical(Classical),
}

/// A method whose steps are generated.
struct Generated {
    /// Its name, for those of its steps that have none of their own.
    word: &'static str,
    /// Describes these.
    about: &'static str,
    /// Its steps.
    rules: Rules,
    /// Those with names of their own, each with its description.
    named: &'static [(&'static str, Rule, &'static str)],
    /// Whether they are symplectic, where no force acts.
    is_symplectic: bool,
}

/// The steps of a method by their parameter.
enum Rules {
    /// By the share `numerator/denominator` of the step before the intermediate point, in lowest terms.
    Share(fn(u32, u32) -> Rule),
    /// By the order, and the usual one.
    Order(fn(u32) -> Rule, Rule),
}

/// Lists the methods of the generator's table.
macro_rules! generated {
    (
        share { $($(#[$_share_doc:meta])* $share:ident {
            word: $share_word:literal,
            about: $share_about:literal,
            is_symplectic: $share_is_symplectic:literal,
            is_one_map: $_is_one_map:literal,
            named: { $($(#[$_doc:meta])* $_member:ident($n:literal, $d:literal) {
                word: $word:literal, about: $about:literal
            })* }
        })* }
        order { $($(#[$_order_doc:meta])* $order:ident {
            word: $order_word:literal,
            about: $order_about:literal,
            is_symplectic: $order_is_symplectic:literal,
            orders: [$($_of:literal),*],
            usual: $usual:literal
        })* }
    ) => {
        const GENERATED: &[Generated] = &[
            $(Generated {
                word: $share_word,
                about: $share_about,
                rules: Rules::Share(Rule::$share),
                named: &[$(($word, Rule::$share($n, $d), $about)),*],
                is_symplectic: $share_is_symplectic,
            },)*
            $(Generated {
                word: $order_word,
                about: $order_about,
                rules: Rules::Order(Rule::$order, Rule::$order($usual)),
                named: &[],
                is_symplectic: $order_is_symplectic,
            },)*
        ];

        /// The method of a generated step, and the share that tells it from others.
        fn generated(rule: Rule) -> (&'static Generated, Option<(u32, u32)>) {
            let (word, share) = match rule {
                $(Rule::$share(n, d) => ($share_word, Some((n, d))),)*
                $(Rule::$order(_) => ($order_word, None),)*
                // none is left out of the table
                _ => ("", None),
            };
            let method = GENERATED.iter().find(|method| method.word == word);
            (method.unwrap_or(&GENERATED[0]), share)
        }
    };
}
coadjoint_macros::methods!(generated);

/// A tolerance, between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance(u64);

impl Tolerance {
    /// That of `taylor` alone, `1e-12`.
    pub(crate) const USUAL: Self = Self(1e-12_f64.to_bits());

    /// Its value, if it is one.
    pub fn new(tolerance: f64) -> Option<Self> {
        (tolerance > 0.0 && tolerance < 1.0).then_some(Self(tolerance.to_bits()))
    }

    /// Its value.
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// Declares classical methods: their names on the command line, and their coefficients.
macro_rules! classical {
    ($(#[$about:meta])* { $($(#[$doc:meta])* $method:ident, $name:literal, $tableau:ident;)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Classical {
            $($(#[$doc])* $method,)*
        }

        impl Classical {
            /// All of them.
            pub const ALL: [Classical; [$($name),*].len()] = [$(Classical::$method),*];

            /// Its name on the command line and in file names.
            pub fn name(self) -> &'static str {
                match self { $(Classical::$method => $name,)* }
            }

            /// Builds its Runge–Kutta method: of RKMK4, that in exponential coordinates.
            pub fn runge_kutta(self) -> RungeKutta {
                match self { $(Classical::$method => Tableau::$tableau().into(),)* }
            }
        }
    };
}

classical! {
    /// A method that knows nothing of the structure: a Runge–Kutta method for the numbers of the state as they are
    /// stored, or RKMK4.
    ///
    /// Those for stored numbers take the motion for a vector field on a vector space. Rotations drift off their group,
    /// but with the methods that keep quadratic invariants: nothing is projected.
    {
        /// [`Tableau::explicit_euler`]
        ExplicitEuler, "explicit-euler", explicit_euler;
        /// [`Tableau::rk2`]
        Rk2, "rk2", rk2;
        /// [`Tableau::heun`]
        Heun, "heun", heun;
        /// [`Tableau::ralston`]
        Ralston, "ralston", ralston;
        /// [`Tableau::rk4`]
        Rk4, "rk4", rk4;
        /// [`Tableau::three_eighths`]
        ThreeEighths, "three-eighths", three_eighths;
        /// [`Tableau::implicit_euler`]
        ImplicitEuler, "implicit-euler", implicit_euler;
        /// [`Tableau::implicit_midpoint`]
        ImplicitMidpoint, "implicit-midpoint", implicit_midpoint;
        /// [`Tableau::gauss2`]
        Gauss4, "gauss4", gauss2;
        /// [`Tableau::gauss3`]
        Gauss6, "gauss6", gauss3;
        /// Runge, Kutta and Munthe-Kaas: RK4 in exponential coordinates about the start of each step.
        Rkmk4, "rkmk4", rk4;
    }
}

impl Classical {
    /// Its order.
    pub fn order(self) -> u32 {
        self.runge_kutta().order()
    }

    /// Describes it for people who choose one.
    fn about(self) -> String {
        let (method, order) = (self.runge_kutta(), self.order());
        let name = method.name();
        if self == Classical::Rkmk4 {
            format!("{name} in exponential coordinates: stays on the group; order {order}")
        } else if method.is_symplectic() {
            format!(
                "{name}, in stored numbers: keeps what is quadratic in them, such as lengths; order {order}"
            )
        } else {
            format!("{name}, in stored numbers: rotations drift off their group; order {order}")
        }
    }
}

impl Method {
    /// Those of ours that most systems have: `midpoint` where it was asked for.
    pub const COMMON: [Method; 5] =
        [Method::Standard, Method::EULER_A, Method::EULER_B, Method::MIDPOINT, Method::Verlet];
    /// The symplectic Euler step: the paper's reduced step, of order 2 where it is the standard, else of order 1.
    pub const EULER_A: Method = Method::Step(Rule::Family(0, 1));
    /// The adjoint of `euler-a`.
    pub const EULER_B: Method = Method::Step(Rule::Family(1, 1));
    /// The implicit midpoint step, of order 2.
    pub const MIDPOINT: Method = Method::Step(Rule::Family(1, 2));
    /// A Hamilton–Jacobi step, of order 4, 6, 8 or 10 from one equation.
    pub const HAMILTON_JACOBI: Method = Method::Step(Rule::HamiltonJacobi(6));

    /// All that have a name of their own, without a number.
    fn named() -> impl Iterator<Item = Method> {
        let shares = GENERATED.iter().flat_map(|method| method.named).map(|named| Method::Step(named.1));
        let orders = GENERATED.iter().filter_map(|method| match method.rules {
            Rules::Order(_, usual) => Some(Method::Step(usual)),
            Rules::Share(_) => None,
        });
        let is_new = |method: &Method| !Self::COMMON.contains(method);
        let ours = Self::COMMON.into_iter().chain(orders).chain([Method::Taylor(Tolerance::USUAL)]);
        let ours = ours.chain([Method::RightLift]).chain(shares.filter(is_new));
        ours.chain(Classical::ALL.into_iter().map(Method::Classical))
    }

    /// All with a number in their names, of denominators that anybody would ask for: which of them were generated is
    /// found by trying.
    pub(crate) fn with_numbers() -> impl Iterator<Item = Method> {
        let fractions = (1..=64).flat_map(|denominator| (0..=denominator).map(move |n| (n, denominator)));
        let lowest = fractions.filter(|&(n, denominator)| greatest_common_divisor(n, denominator) == 1);
        let shares = GENERATED.iter().filter_map(|method| match method.rules {
            Rules::Share(rule) => Some(rule),
            Rules::Order(..) => None,
        });
        let shares: Vec<_> = shares.collect();
        lowest
            .flat_map(move |(n, denominator)| {
                shares.clone().into_iter().map(move |rule| Method::Step(rule(n, denominator)))
            })
            .filter(|method| !Self::COMMON.contains(method))
    }

    /// The scheme that it stands for, before steps of an order are composed of it; none if it is no scheme of the library, or none of
    /// this order.
    pub(crate) fn base(self, map: RetractionKind, order: Order) -> Option<Scheme> {
        Some(match self {
            Method::Standard => Scheme::Standard(map),
            Method::Verlet => Scheme::StormerVerlet(map),
            Method::Step(rule) => match generated(rule).0.rules {
                Rules::Share(_) => Scheme::Step(map, rule),
                Rules::Order(..) if order == Order::Two => return None,
                Rules::Order(of, _) => Scheme::Step(map, of(order.number())),
            },
            Method::RightLift | Method::Taylor(_) | Method::Classical(_) => return None,
        })
    }

    /// Whether the order that is asked for is that of a step, not composed.
    pub fn is_of_order(self) -> bool {
        let Method::Step(rule) = self else { return false };
        matches!(generated(rule).0.rules, Rules::Order(..))
    }

    /// Whether it is symmetric and of order 2 for every system, so that steps of higher order can be composed of it.
    pub fn is_symmetric(self) -> bool {
        match self {
            Method::Standard | Method::Verlet => true,
            Method::Step(rule) => generated(rule).1 == Some((1, 2)),
            _ => false,
        }
    }

    /// The classical method, if it is one.
    pub fn classical(self) -> Option<Classical> {
        match self {
            Method::Classical(classical) => Some(classical),
            _ => None,
        }
    }

    /// Whether its steps are made with a retraction, and have an order to be chosen.
    pub fn has_retraction(self) -> bool {
        !matches!(self, Method::Taylor(_) | Method::Classical(_))
    }

    /// Whether its steps are symplectic, so that errors of what is conserved stay bounded for long.
    pub(crate) fn keeps_structure(self) -> bool {
        match self {
            Method::Taylor(_) => false,
            Method::Step(rule) => generated(rule).0.is_symplectic,
            Method::Classical(classical) => classical.runge_kutta().is_symplectic(),
            _ => true,
        }
    }

    /// Its name in lists, and its description.
    fn words(self) -> (&'static str, Cow<'static, str>) {
        let (name, about) = match self {
            Method::Standard => ("standard", "the system's standard step of order 2: `euler-a` or `verlet`"),
            Method::Step(rule) => {
                let method = generated(rule).0;
                match method.named.iter().find(|named| named.1 == rule) {
                    Some((name, _, about)) => (*name, *about),
                    None => (method.word, method.about),
                }
            }
            Method::Verlet => ("verlet", "half a step of `euler-a`, then half a step of `euler-b`: order 2"),
            Method::Taylor(_) => (
                "taylor",
                "Taylor steps to a tolerance, 1e-12 unless `taylor=1e-9` says another, where they were generated",
            ),
            Method::RightLift => {
                ("right-lift", "`euler-a` carrying the momentum in space, where nothing acts")
            }
            Method::Classical(classical) => return (classical.name(), classical.about().into()),
        };
        (name, about.into())
    }

    /// Its name as a part of file names: `family-1-4`.
    pub fn stem(self) -> String {
        self.to_string().replace(['=', '/'], "-")
    }
}

/// A fraction from 0 to 1, in lowest terms: `1/4`, `1`.
fn fraction(of: &str, text: &str) -> Result<(u32, u32), String> {
    let (numerator, denominator) = text.split_once('/').unwrap_or((text, "1"));
    let numbers: Option<(u32, u32)> = numerator.trim().parse().ok().zip(denominator.trim().parse().ok());
    match numbers {
        Some((numerator, denominator)) if denominator > 0 && numerator <= denominator => {
            let divisor = greatest_common_divisor(numerator, denominator);
            Ok((numerator / divisor, denominator / divisor))
        }
        _ => Err(format!("`{of}={text}`: `{text}` is not a fraction from 0 to 1, as in `{of}=1/4`")),
    }
}

fn greatest_common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

impl fmt::Display for Method {
    /// As the command line takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::Taylor(tolerance) => write!(f, "taylor={:e}", tolerance.value()),
            Method::Step(rule) => {
                f.write_str(self.words().0)?;
                match generated(*rule) {
                    (method, Some((n, d))) if method.named.iter().all(|named| named.1 != *rule) => {
                        write!(f, "={n}/{d}")
                    }
                    _ => Ok(()),
                }
            }
            named => f.write_str(named.words().0),
        }
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name.split_once('=') {
            Some(("taylor", tolerance)) => {
                let known = tolerance.trim().parse().ok().and_then(Tolerance::new);
                let message = || {
                    format!(
                        "`taylor={tolerance}`: `{tolerance}` is no tolerance between 0 and 1, as in `taylor=1e-9`"
                    )
                };
                return known.map(Method::Taylor).ok_or_else(message);
            }
            Some((of, s)) => {
                let method = GENERATED.iter().find(|method| method.word == of);
                if let Some(Rules::Share(rule)) = method.map(|method| &method.rules) {
                    return fraction(of, s).map(|(n, d)| Method::Step(rule(n, d)));
                }
                if Self::named().any(|method| method.words().0 == of) {
                    let order = format!("orders are said apart: `--order {s}`, in a file `order = {s}`");
                    return Err(format!("`{of}` takes no number; {order}"));
                }
            }
            None => {}
        }
        Self::named().find(|method| method.words().0 == name).ok_or_else(|| {
            let names: Vec<&str> = Self::named().map(|method| method.words().0).collect();
            format!("there is no method `{name}` (methods: {}, family=1/4)", names.join(", "))
        })
    }
}

impl TryFrom<String> for Method {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        name.parse()
    }
}

impl From<Method> for String {
    fn from(method: Method) -> Self {
        method.to_string()
    }
}

/// Reads a method from the command line.
#[derive(Clone, Debug)]
pub(crate) struct MethodParser;

/// All methods, as clap lists them.
fn possible() -> Vec<PossibleValue> {
    let listed = |method: Method| {
        let (name, about) = method.words();
        PossibleValue::new(name).help(about.into_owned())
    };
    let with_numbers = GENERATED.iter().filter(|method| matches!(method.rules, Rules::Share(_)));
    let with_numbers = with_numbers
        .map(|method| PossibleValue::new(format!("{}=N/D", method.word)).help(method.about.to_owned()));
    let mut values: Vec<PossibleValue> = Method::named().map(listed).collect();
    // beside other steps of ours
    let at = values.len() - Classical::ALL.len();
    values.splice(at..at, with_numbers);
    values
}

impl TypedValueParser for MethodParser {
    type Value = Method;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<Method, clap::Error> {
        let name = value.to_string_lossy();
        name.parse().map_err(|message: String| {
            if name.contains('=') {
                return clap::Error::raw(ErrorKind::ValueValidation, format!("{message}\n"))
                    .with_cmd(command);
            }
            // its message lists all, and says which was meant
            let listed = PossibleValuesParser::new(possible()).parse_ref(command, argument, value);
            listed.err().unwrap_or_else(|| clap::Error::new(ErrorKind::InvalidValue).with_cmd(command))
        })
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(possible().into_iter()))
    }
}
