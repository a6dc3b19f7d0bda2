//! Methods by their names.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use serde::{Deserialize, Serialize};

use coadjoint_classical::{Method as _, RungeKutta, Tableau};

/// The integration method: of ours, built on a retraction, or a classical one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub enum Method {
    /// The system's standard step of order 2: `euler-a` where nothing but momentum and advected parameters has a part
    /// in the motion and the retraction is odd, else `verlet`.
    #[default]
    Standard,
    /// The symplectic Euler step: the paper's reduced step, of order 2 where it is the standard, else of order 1.
    EulerA,
    /// The adjoint of `euler-a`.
    EulerB,
    /// The implicit midpoint step, of order 2.
    Midpoint,
    /// Störmer and Verlet: half a step of `euler-a`, then half a step of `euler-b`; of order 2.
    Verlet,
    /// Another member `s = numerator/denominator` of the family, in lowest terms, where it was generated.
    Family(u32, u32),
    /// `euler-a` carrying the momentum in space, where nothing acts on the system.
    RightLift,
    /// A Hamilton–Jacobi step, of order 4, 6, 8 or 10 from one equation, where it was generated.
    HamiltonJacobi,
    /// The tangent lift with `s = numerator/denominator`, in lowest terms, where it was generated: of order 1, with `s
    /// = ½` of order 2, and not symplectic; explicit with `s = 0`.
    TangentLift(u32, u32),
    /// Taylor steps to a tolerance, as many as there need be from one end of a step to the next, where the description has
    /// the key `taylor`.
    Taylor(Tolerance),
    /// A classical method, for comparison.
    Classical(Classical),
}

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
        [Method::Standard, Method::EulerA, Method::EulerB, Method::Midpoint, Method::Verlet];

    /// All that have a name of their own, without a number.
    fn named() -> impl Iterator<Item = Method> {
        let ours = Self::COMMON.into_iter().chain([
            Method::HamiltonJacobi,
            Method::Taylor(Tolerance::USUAL),
            Method::RightLift,
            Method::TangentLift(0, 1),
        ]);
        ours.chain(Classical::ALL.into_iter().map(Method::Classical))
    }

    /// All with a number in their names, of denominators that anybody would ask for: which of them were generated is
    /// found by trying.
    pub(crate) fn with_numbers() -> impl Iterator<Item = Method> {
        let fractions = (1..=64).flat_map(|denominator| (0..=denominator).map(move |n| (n, denominator)));
        let lowest = fractions.filter(|&(n, denominator)| greatest_common_divisor(n, denominator) == 1);
        lowest.flat_map(|(n, denominator)| {
            let member = Self::family(n, denominator);
            let is_new = matches!(member, Method::Family(..));
            is_new.then_some(member).into_iter().chain([Method::TangentLift(n, denominator)])
        })
    }

    /// The member `s = numerator/denominator` of the family, in lowest terms.
    fn family(numerator: u32, denominator: u32) -> Self {
        match (numerator, denominator) {
            (0, 1) => Method::EulerA,
            (1, 2) => Method::Midpoint,
            (1, 1) => Method::EulerB,
            (numerator, denominator) => Method::Family(numerator, denominator),
        }
    }

    /// Whether it is symmetric and of order 2 for every system, so that steps of higher order can be composed of it.
    pub fn is_symmetric(self) -> bool {
        matches!(self, Method::Standard | Method::Midpoint | Method::Verlet | Method::TangentLift(1, 2))
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
            Method::TangentLift(..) | Method::Taylor(_) => false,
            Method::Classical(classical) => classical.runge_kutta().is_symplectic(),
            _ => true,
        }
    }

    /// Its name in lists, and its description.
    fn words(self) -> (&'static str, Cow<'static, str>) {
        let (name, about) = match self {
            Method::Standard => ("standard", "the system's standard step of order 2: `euler-a` or `verlet`"),
            Method::EulerA => (
                "euler-a",
                "symplectic Euler, the paper's reduced step: order 2 where it is the standard, else 1",
            ),
            Method::EulerB => ("euler-b", "the adjoint of `euler-a`"),
            Method::Midpoint => ("midpoint", "the implicit midpoint step on the group, order 2"),
            Method::Verlet => ("verlet", "half a step of `euler-a`, then half a step of `euler-b`: order 2"),
            Method::Family(..) => {
                ("family=N/D", "another member s of the family, from 0 to 1, where it was generated")
            }
            Method::HamiltonJacobi => {
                ("hamilton-jacobi", "order 4 to 10 from one equation, where it was generated")
            }
            Method::Taylor(_) => (
                "taylor",
                "Taylor steps to a tolerance, 1e-12 unless `taylor=1e-9` says another, where they were generated",
            ),
            Method::RightLift => {
                ("right-lift", "`euler-a` carrying the momentum in space, where nothing acts")
            }
            Method::TangentLift(0, _) => (
                "tangent-lift",
                "the tangent lift, where it was generated: explicit, order 1, not symplectic",
            ),
            Method::TangentLift(..) => {
                ("tangent-lift=N/D", "the tangent lift with another s; order 2 with 1/2")
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
            Method::Family(numerator, denominator) => write!(f, "family={numerator}/{denominator}"),
            Method::Taylor(tolerance) => write!(f, "taylor={:e}", tolerance.value()),
            Method::TangentLift(numerator @ 1.., denominator) => {
                write!(f, "tangent-lift={numerator}/{denominator}")
            }
            named => f.write_str(named.words().0),
        }
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name.split_once('=') {
            Some((of @ "family", s)) => return fraction(of, s).map(|(n, d)| Self::family(n, d)),
            Some(("taylor", tolerance)) => {
                let known = tolerance.trim().parse().ok().and_then(Tolerance::new);
                let message = || {
                    format!(
                        "`taylor={tolerance}`: `{tolerance}` is no tolerance between 0 and 1, as in `taylor=1e-9`"
                    )
                };
                return known.map(Method::Taylor).ok_or_else(message);
            }
            Some((of @ "tangent-lift", s)) => return fraction(of, s).map(|(n, d)| Method::TangentLift(n, d)),
            _ => {}
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
    let mut values: Vec<PossibleValue> = Method::named().map(listed).collect();
    // beside the first ones of their kinds
    values.insert(Method::COMMON.len() + 4, listed(Method::TangentLift(1, 2)));
    values.insert(Method::COMMON.len(), listed(Method::Family(1, 4)));
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
