//! The arguments of `#[lie_poisson_system(…)]`.

use std::fmt::Display;

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::parse::discouraged::Speculative;
use syn::parse::{ParseStream, Parser};
use syn::{Ident, LitInt, LitStr, Token, bracketed, parenthesized, token};

use super::factor::FactorName;
use super::group::{Group, Space, declared_name, group, space};
use super::key::{EnergyKey, Key};
use super::nesting;
use super::shape;
use crate::diagnostics::{Diagnostics, list, nearest, suggestion};
use crate::group::Retraction;
use crate::limits;
use crate::quantity::{ScalarType, Shape};
use crate::scheme::Derivatives;
use crate::scheme::{Member, Method, Rule};

/// What the attribute says. Problems were reported where they were found, and what they concern is left out.
#[derive(Debug, Default)]
pub struct Attribute {
    /// `group = SO3` or `group(attitude: SO3, position: R3)`
    pub factors: Vec<Factor>,
    /// `advected(gamma: R3, …)`, in the order written.
    pub advected: Vec<Advected>,
    /// `potential = …`, `hamiltonian = …`, `lagrangian = …`
    pub energies: Vec<(EnergyKey, syn::Expr)>,
    /// `control(thrust: f64, …)`
    pub controls: Vec<Control>,
    /// `force = …` or `force(attitude = …, …)`
    pub forces: Vec<Force>,
    /// `invariance = right`
    pub right: bool,
    /// `methods(Midpoint, …)`
    pub methods: Vec<Rule>,
    /// `retractions(Cayley, …)`; empty for those of [`Retraction::defaults`].
    retractions: Vec<Retraction>,
    /// `derivatives` for all of them, or `derivatives(state, …)`
    pub derivatives: Derivatives,
    /// `units(momentum = "N m s", …)`
    pub units: Vec<Unit>,
    /// `crate = …`
    pub krate: Option<syn::Path>,
    /// What `lie_group!` says of groups that are named by their paths.
    pub definitions: Vec<Definition>,
    /// The names of factors, advected parameters and controls whose declarations could not be read, with the keys where
    /// they are.
    pub unreadable: Vec<(Key, Ident)>,
    /// Whether there were problems.
    faulty: bool,
    /// The keys that were there, whether or not their values could be read.
    given: Vec<Key>,
    /// Those that were meant by keys that there are not.
    slips: Vec<Key>,
}

/// A group that `lie_group!` defines.
#[derive(Debug)]
pub struct Definition {
    /// As users of it write it.
    pub path: String,
    /// Its name.
    pub name: Ident,
    /// Its value.
    pub group: Group,
}

/// One factor of the configuration's group.
#[derive(Debug)]
pub struct Factor {
    /// The user's name for it; `None` for a group that is the whole.
    pub name: Option<Ident>,
    /// Its group.
    pub group: Group,
    /// How many there are of it, where it is an array.
    pub length: Option<usize>,
}

/// One advected parameter.
#[derive(Debug)]
pub struct Advected {
    /// The user's name for it.
    pub name: Ident,
    /// The factor that acts on it, if the user names it: `gamma: attitude::R3`.
    pub factor: Option<FactorName>,
    /// The space it lives in.
    pub space: Space,
}

/// One control.
#[derive(Debug)]
pub struct Control {
    /// The user's name for it.
    pub name: Ident,
    /// Whether it is a scalar, a vector or a matrix.
    pub shape: Shape,
    /// How many there are of it, where it is an array.
    pub length: Option<usize>,
    /// Its type, where that says what numbers it is made of.
    pub scalar: Option<(ScalarType, syn::Type)>,
}

/// The unit of a part of the state or of a control.
#[derive(Debug)]
pub struct Unit {
    /// What it is the unit of.
    pub name: Ident,
    /// As it is written.
    pub unit: String,
}

/// A force on one factor.
#[derive(Debug)]
pub struct Force {
    /// The factor; `None` for a group that is the whole.
    pub factor: Option<FactorName>,
    /// Its value.
    pub value: syn::Expr,
}

impl Attribute {
    /// Reads the tokens between the parentheses of the attribute. `known` are the methods that there are.
    pub fn parse(tokens: TokenStream, known: &[&'static Method], diagnostics: &mut Diagnostics) -> Self {
        let before = diagnostics.len();
        let mut attribute = Self::read(tokens, known, diagnostics);
        attribute.faulty = diagnostics.len() > before;
        attribute
    }

    fn read(tokens: TokenStream, known: &[&'static Method], diagnostics: &mut Diagnostics) -> Self {
        let mut attribute = Self::default();
        if let Some((span, message)) = nesting::excess(&tokens) {
            diagnostics.push_at(span, message);
            // nothing was read, so nothing can be said to be missing
            attribute.given = Key::all().collect();
            return attribute;
        }
        let entries = |input: ParseStream<'_>| {
            while !input.is_empty() {
                attribute.entry(input, known, diagnostics);
            }
            Ok(())
        };
        if let Err(error) = entries.parse2(tokens) {
            diagnostics.absorb(error);
        }
        attribute
    }

    /// Whether the key was written or meant, even if its value could not be read.
    pub fn has(&self, key: Key) -> bool {
        self.given.contains(&key) || self.slips.contains(&key)
    }

    /// Whether all of it could be read.
    pub fn is_sound(&self) -> bool {
        !self.faulty
    }

    /// Whether the energy is given whole, not as inertia and potential.
    pub fn has_whole_energy(&self) -> bool {
        [EnergyKey::Hamiltonian, EnergyKey::Lagrangian].into_iter().any(|key| self.has(Key::Energy(key)))
    }

    /// The energy of a key.
    pub fn energy(&self, key: EnergyKey) -> Option<&syn::Expr> {
        self.energies.iter().find(|(known, _)| *known == key).map(|(_, energy)| energy)
    }

    /// The retractions that are named.
    pub fn named_retractions(&self) -> &[Retraction] {
        &self.retractions
    }

    /// One `key = value` or `key(…)`, with the comma after it. Always consumes something.
    fn entry(
        &mut self,
        input: ParseStream<'_>,
        known_methods: &[&'static Method],
        diagnostics: &mut Diagnostics,
    ) {
        let key = match Ident::parse_any(input) {
            Ok(key) => key,
            Err(error) => {
                diagnostics
                    .push_at(error.span(), format!("expected a key, such as `{}`", Key::Group.example()));
                skip_entry(input);
                return;
            }
        };
        let name = key.to_string();
        let names: Vec<&str> = Key::all().map(Key::name).collect();
        // a slip is read as what it is a slip of: nothing that it declares is missed elsewhere
        let meant = nearest(&name, &names).and_then(|name| Key::all().find(|known| known.name() == name));
        let is_slip = meant.is_none_or(|known| known.name() != name);
        if is_slip {
            diagnostics.push(&key, format!("there is no key `{name}`{}", suggestion(&name, &names)));
        }
        let Some(known) = meant else {
            skip_entry(input);
            return;
        };
        let again = self.given.contains(&known) || is_slip && self.has(known);
        if again && !is_slip {
            diagnostics.push(&key, format!("`{name}` is given twice; keep one of them"));
        }
        if is_slip { &mut self.slips } else { &mut self.given }.push(known);
        // a second value is read all the same, for the sake of problems in it
        let mut ignored = Self::default();
        let target = if again { &mut ignored } else { self };
        let value = input.fork();
        let read = match known {
            Key::Group => factors(&value, &key, diagnostics, &mut target.unreadable)
                .map(|factors| target.factors = factors),
            Key::Advected => {
                let name = |advected: &Advected| Some(advected.name.clone());
                entries(&value, (&key, known), diagnostics, &mut target.unreadable, advected, name)
                    .map(|list| target.advected = list)
            }
            Key::Energy(energy) => equals(&value, known, diagnostics)
                .map(|value| target.energies.extend(value.map(|value| (energy, value)))),
            Key::Control => {
                let name = |control: &Control| Some(control.name.clone());
                entries(&value, (&key, known), diagnostics, &mut target.unreadable, control, name)
                    .map(|list| target.controls = list)
            }
            Key::Force => forces(&value, &key, diagnostics).map(|forces| target.forces = forces),
            Key::Invariance => invariance(&value, diagnostics).map(|right| target.right = right),
            Key::Methods => {
                methods(&value, &key, known_methods, diagnostics).map(|methods| target.methods = methods)
            }
            Key::Retractions => retractions(&value, &key, diagnostics).map(|list| target.retractions = list),
            Key::Derivatives => {
                derivatives(&value, &key, diagnostics).map(|wanted| target.derivatives = wanted)
            }
            Key::Units => {
                let name = |unit: &Unit| Some(unit.name.clone());
                entries(&value, (&key, known), diagnostics, &mut Vec::new(), unit, name)
                    .map(|list| target.units = list)
            }
            Key::Crate => crate_path(&value, diagnostics).map(|path| target.krate = path),
        };
        finish_entry(input, &value, read, diagnostics);
    }
}

/// `(Cayley)`
fn retractions(
    input: ParseStream<'_>,
    key: &Ident,
    diagnostics: &mut Diagnostics,
) -> syn::Result<Vec<Retraction>> {
    let retraction = |input: ParseStream<'_>| {
        let name: Ident = input
            .parse()
            .map_err(|error| syn::Error::new(error.span(), "expected a retraction, such as `Cayley`"))?;
        let known = Retraction::ALL.into_iter().find(|retraction| name == retraction.name());
        known.map(|retraction| (name.clone(), retraction)).ok_or_else(|| {
            let names = Retraction::ALL.map(Retraction::name);
            let guess = suggestion(&name.to_string(), &names);
            syn::Error::new_spanned(&name, format!("there is no retraction `{name}`{guess}"))
        })
    };
    let name = |(name, _): &(Ident, Retraction)| Some(name.clone());
    let named = entries(input, (key, Key::Retractions), diagnostics, &mut Vec::new(), retraction, name)?;
    // in the order in which they always come
    let is_named = |retraction: &Retraction| named.iter().any(|(_, known)| known == retraction);
    Ok(Retraction::ALL.into_iter().filter(is_named).collect())
}

/// Nothing, for all of them, or `(state, controls, …)`
fn derivatives(
    input: ParseStream<'_>,
    key: &Ident,
    diagnostics: &mut Diagnostics,
) -> syn::Result<Derivatives> {
    if input.peek(Token![=]) {
        return Err(
            input.error(format!("write `{}`, or `{key}` alone for all of them", Key::Derivatives.example()))
        );
    }
    if !input.peek(token::Paren) {
        // or a forgotten comma, which is noticed elsewhere
        return Ok(Derivatives::ALL);
    }
    const NAMES: [&str; 5] = ["state", "controls", "parameters", "tangent", "adjoint"];
    let name = |input: ParseStream<'_>| {
        let name: Ident = input.parse().map_err(|error| {
            syn::Error::new(error.span(), "expected what the derivatives are by, such as `state`")
        })?;
        if NAMES.iter().any(|known| name == known) {
            return Ok(name);
        }
        let guess = suggestion(&name.to_string(), &NAMES);
        Err(syn::Error::new_spanned(&name, format!("there are no derivatives `{name}`{guess}")))
    };
    let of = |name: &Ident| Some(name.clone());
    let named = entries(input, (key, Key::Derivatives), diagnostics, &mut Vec::new(), name, of)?;
    let is_named = |name: &str| named.iter().any(|known| known == name);
    let [state, controls, parameters, tangent, adjoint] = NAMES.map(is_named);
    // the derivatives of composed steps by anything lead through the states between
    let state = state || controls || parameters;
    Ok(Derivatives { state, controls, parameters, tangent, adjoint })
}

/// `= value`. `None` where the value is missing, which is reported.
fn equals<T: syn::parse::Parse>(
    input: ParseStream<'_>,
    key: Key,
    diagnostics: &mut Diagnostics,
) -> syn::Result<Option<T>> {
    if !input.peek(Token![=]) || input.peek(Token![==]) {
        return Err(input.error(format!("expected `=`; write `{}`", key.example())));
    }
    let sign: Token![=] = input.parse()?;
    if input.is_empty() || input.peek(Token![,]) {
        diagnostics.push(sign, format!("`{}` has no value; write `{}`", key.name(), key.example()));
        return Ok(None);
    }
    input.parse().map(Some)
}

/// `= SO3` or `(attitude: SO3, position: R3)`
fn factors(
    input: ParseStream<'_>,
    key: &Ident,
    diagnostics: &mut Diagnostics,
    unreadable: &mut Vec<(Key, Ident)>,
) -> syn::Result<Vec<Factor>> {
    if input.peek(token::Paren) {
        let name = |factor: &Factor| factor.name.clone();
        return entries(input, (key, Key::Group), diagnostics, unreadable, factor, name);
    }
    if input.peek(Token![=]) && input.peek2(token::Bracket) {
        let message = "an array of factors has a name; write `group(spins: [SO3; 4])`";
        return Err(syn::Error::new_spanned(key, message));
    }
    let name: Option<FirstWord> =
        equals(input, Key::Group, diagnostics).map_err(|error| with_example(error, Key::Group))?;
    let Some(FirstWord(name)) = name else { return Ok(Vec::new()) };
    Ok(vec![Factor { name: None, group: group(input, name)?, length: None }])
}

/// The first word of a group; `crate`, `self` and `super` too, with which paths begin.
struct FirstWord(Ident);

impl syn::parse::Parse for FirstWord {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let of_path = input.peek(Token![crate]) || input.peek(Token![self]) || input.peek(Token![super]);
        if of_path { Ident::parse_any(input) } else { input.parse() }.map(Self)
    }
}

/// `attitude: SO3` or `spins: [SO3; 4]`
fn factor(input: ParseStream<'_>) -> syn::Result<Factor> {
    let name = declared_name(input, "attitude: SO3", "a factor", "the group it moves on")?;
    if !input.peek(token::Bracket) {
        return Ok(Factor { name: Some(name), group: factor_group(input, "attitude: SO3")?, length: None });
    }
    let content;
    bracketed!(content in input);
    let group = factor_group(&content, "spins: [SO3; 4]")?;
    let (span, written) = (content.span(), "an array of factors is written `spins: [SO3; 4]`");
    content.parse::<Token![;]>().map_err(|_| syn::Error::new(span, format!("expected `;`: {written}")))?;
    let length = shape::array_length(&content.parse()?)?;
    if !content.is_empty() {
        return Err(content.error(written));
    }
    Ok(Factor { name: Some(name), group, length: Some(length) })
}

/// The group of a factor.
fn factor_group(input: ParseStream<'_>, example: &str) -> syn::Result<Group> {
    let FirstWord(word) = input.parse().map_err(|error: syn::Error| {
        syn::Error::new(error.span(), format!("expected a group; a factor is written `{example}`"))
    })?;
    group(input, word)
}

/// `= expr` or `(attitude = expr, …)`
fn forces(input: ParseStream<'_>, key: &Ident, diagnostics: &mut Diagnostics) -> syn::Result<Vec<Force>> {
    if input.peek(token::Paren) {
        let name = |force: &Force| force.factor.clone();
        return entries(input, (key, Key::Force), diagnostics, &mut Vec::new(), force, name);
    }
    let value = equals(input, Key::Force, diagnostics)?;
    Ok(value.map(|value| Force { factor: None, value }).into_iter().collect())
}

/// `attitude = expr` or `spins[0] = expr`
fn force(input: ParseStream<'_>) -> syn::Result<Force> {
    let explain = |error: syn::Error| {
        let message = "expected the name of a factor and `=`; write `force(attitude = moment)`";
        syn::Error::new(error.span(), message)
    };
    if !input.peek(Ident) {
        return Err(explain(input.error("")));
    }
    let factor: FactorName = input.parse()?;
    input.parse::<Token![=]>().map_err(explain)?;
    Ok(Force { factor: Some(factor), value: input.parse()? })
}

/// `momentum = "N m s"`
fn unit(input: ParseStream<'_>) -> syn::Result<Unit> {
    let explain = |error: syn::Error| {
        let message = "expected a name, `=` and a unit in quotes; write `units(momentum = \"N m s\")`";
        syn::Error::new(error.span(), message)
    };
    let name = Ident::parse_any(input).map_err(explain)?;
    input.parse::<Token![=]>().map_err(explain)?;
    let text: LitStr = input.parse().map_err(explain)?;
    let unit = text.value().trim().to_owned();
    if unit.is_empty() { Err(explain(syn::Error::new_spanned(text, ""))) } else { Ok(Unit { name, unit }) }
}

/// `= left` or `= right`
fn invariance(input: ParseStream<'_>, diagnostics: &mut Diagnostics) -> syn::Result<bool> {
    let side: Option<Ident> =
        equals(input, Key::Invariance, diagnostics).map_err(|error| with_example(error, Key::Invariance))?;
    match side.as_ref().map(ToString::to_string).as_deref() {
        None | Some("left") => Ok(false),
        Some("right") => Ok(true),
        Some(_) => Err(syn::Error::new_spanned(side, "a system is `left`- or `right`-invariant")),
    }
}

/// `(Midpoint, SymplecticEulerB, Family(1, 4))`
fn methods(
    input: ParseStream<'_>,
    key: &Ident,
    known: &[&'static Method],
    diagnostics: &mut Diagnostics,
) -> syn::Result<Vec<Rule>> {
    let method = |input: ParseStream<'_>| method(input, known);
    let named = entries(input, (key, Key::Methods), diagnostics, &mut Vec::new(), method, |_| None::<Ident>)?;
    let mut rules = Vec::new();
    for rule in named {
        if !rules.contains(&rule) {
            rules.push(rule);
        }
    }
    if rules.len() > limits::METHODS {
        let message = format!("a system may have {} methods at most", limits::METHODS);
        return Err(syn::Error::new_spanned(key, message));
    }
    Ok(rules)
}

/// Compositions of steps that are generated without them.
const COMPOSED: [&str; 2] = ["StormerVerlet", "RightLift"];

/// `Midpoint` or `Family(1, 4)`
fn method(input: ParseStream<'_>, known: &[&'static Method]) -> syn::Result<Rule> {
    let name: Ident = input
        .parse()
        .map_err(|error| syn::Error::new(error.span(), "expected a method, such as `Midpoint`"))?;
    let text = name.to_string();
    let named = known.iter().find_map(|method| method.named(&text));
    match known.iter().find(|method| name == method.name) {
        Some(method) if named.is_none() || input.peek(token::Paren) => {
            return member(input, &name).map(|member| method.member(member));
        }
        _ => {}
    }
    named.ok_or_else(|| {
        let names: Vec<&str> = known.iter().flat_map(|method| method.named).map(|(name, _)| *name).collect();
        let guess = suggestion(&text, &names);
        let message = match Retraction::ALL.into_iter().find(|retraction| name == retraction.name()) {
            Some(retraction) if retraction.is_default() => format!(
                "`{name}` is a retraction, not a method: the standard steps with it are generated, unless `retractions(…)` names others only"
            ),
            Some(_) => {
                format!("`{name}` is a retraction, not a method: `retractions({name})` asks for the standard steps with it")
            }
            None if COMPOSED.contains(&text.as_str()) => {
                format!("leave out `{name}`: the steps that it is made of are generated without it")
            }
            None if guess.ends_with('?') => format!("there is no method `{name}`{guess}"),
            None => {
                let families = known.iter().map(|method| format!("{}(numerator, denominator)", method.name));
                let all = list(names.iter().map(|&name| name.to_owned()).chain(families));
                format!("there is no method `{name}`; there are {all}")
            }
        };
        syn::Error::new_spanned(&name, message)
    })
}

/// `(1, 4)`
fn member(input: ParseStream<'_>, name: &Ident) -> syn::Result<Member> {
    let content;
    parenthesized!(content in input);
    let numerator: LitInt = content.parse()?;
    content.parse::<Token![,]>()?;
    let denominator: LitInt = content.parse()?;
    Member::new(numerator.base10_parse()?, denominator.base10_parse()?).ok_or_else(|| {
        let message =
            format!("the parameter s of a method is a fraction between 0 and 1: `{name}(1, 4)` is s = 1/4");
        syn::Error::new_spanned(name, message)
    })
}

/// The error with an example of the key's use, unless it has one already.
fn with_example(error: syn::Error, key: Key) -> syn::Error {
    let message = error.to_string();
    if message.contains(key.example()) {
        return error;
    }
    syn::Error::new(error.span(), format!("{message}; write `{}`", key.example()))
}

/// `= path::to::coadjoint`
fn crate_path(input: ParseStream<'_>, diagnostics: &mut Diagnostics) -> syn::Result<Option<syn::Path>> {
    let ahead = input.fork();
    if ahead.parse::<Token![=]>().is_ok() && ahead.peek(LitStr) {
        let text: LitStr = ahead.parse()?;
        input.advance_to(&ahead);
        diagnostics.push(&text, format!("write the path without quotes: `crate = {}`", text.value()));
        return Ok(None);
    }
    if ahead.is_empty() || ahead.peek(Token![,]) {
        return equals::<syn::Path>(input, Key::Crate, diagnostics);
    }
    input.parse::<Token![=]>().map_err(|error| with_example(error, Key::Crate))?;
    syn::Path::parse_mod_style(input).map(Some).map_err(|error| with_example(error, Key::Crate))
}

/// Entries between parentheses, of which no two have the same name; the names of those that cannot be read are added to
/// `unreadable`.
fn entries<T, N: PartialEq + ToTokens + Display>(
    input: ParseStream<'_>,
    (key, known): (&Ident, Key),
    diagnostics: &mut Diagnostics,
    unreadable: &mut Vec<(Key, Ident)>,
    parse: impl Fn(ParseStream<'_>) -> syn::Result<T>,
    name: impl Fn(&T) -> Option<N>,
) -> syn::Result<Vec<T>> {
    if !input.peek(token::Paren) {
        let missing = input.is_empty() || input.peek(Token![,]);
        let place = if missing { key.span() } else { input.span() };
        return Err(syn::Error::new(place, format!("expected parentheses; write `{}`", known.example())));
    }
    let content;
    parenthesized!(content in input);
    if content.is_empty() {
        diagnostics.push(key, format!("`{}` names nothing; write `{}`", known.name(), known.example()));
    }
    let mut list: Vec<T> = Vec::new();
    while !content.is_empty() {
        let ahead = content.fork();
        let read = parse(&ahead).map(|entry| match name(&entry) {
            Some(this) if list.iter().any(|earlier| name(earlier).as_ref() == Some(&this)) => {
                diagnostics.push(&this, format!("`{this}` is named twice in `{}`", known.name()));
            }
            _ => list.push(entry),
        });
        if read.is_err() {
            unreadable.extend(content.fork().parse::<Ident>().map(|name| (known, name)));
        }
        finish_entry(&content, &ahead, read, diagnostics);
    }
    Ok(list)
}

/// `gamma: R3`, `gamma: attitude::R3` or `gamma: spins[0]::R3`
fn advected(input: ParseStream<'_>) -> syn::Result<Advected> {
    let name = declared_name(input, "gamma: R3", "an advected parameter", "the space it lives in")?;
    let explain = |error: syn::Error| {
        let message = "expected a space; an advected parameter is written `gamma: R3`";
        syn::Error::new(error.span(), message)
    };
    if !input.peek(Ident) {
        return Err(explain(input.error("")));
    }
    let is_of_factor = input.peek2(Token![::]) || input.peek2(token::Bracket);
    let factor = is_of_factor.then(|| input.parse::<FactorName>()).transpose()?;
    if is_of_factor {
        input.parse::<Token![::]>()?;
    }
    if !input.peek(Ident) {
        return Err(explain(input.error("")));
    }
    Ok(Advected { name, factor, space: space(input)? })
}

/// `moment: R3`, `thrust: f64`, `moment: Vector3<f64>` or `torques: [f64; 3]`
fn control(input: ParseStream<'_>) -> syn::Result<Control> {
    let name = declared_name(input, "thrust: f64", "a control", "a type")?;
    let ty: syn::Type = input.parse()?;
    let (element, length) = shape::element(&ty)?;
    if let syn::Type::Path(path) = element
        && let Some(ident) = path.path.get_ident()
        && let Some(n) = ident.to_string().strip_prefix('R').and_then(|n| n.parse::<usize>().ok())
        && (1..=6).contains(&n)
    {
        return Ok(Control { name, shape: Shape::Vector(n), length, scalar: None });
    }
    match shape::of_type(element) {
        Some((shape, scalar)) => Ok(Control { name, shape, length, scalar: Some((scalar, element.clone())) }),
        None => {
            let message = format!(
                "`{name}` cannot be of this type; a control is a number, `f64`, a vector, `R1` to `R6`, or an array of \
                 these, such as `[f64; 3]`"
            );
            Err(syn::Error::new_spanned(ty, message))
        }
    }
}

/// Goes on after an entry: behind its comma if it was read up to `end`, otherwise wherever the next one begins.
///
/// Entries are read from a fork, because syn remembers the tokens that a failed parser leaves behind and would complain
/// about them a second time.
fn finish_entry(
    input: ParseStream<'_>,
    end: ParseStream<'_>,
    read: syn::Result<()>,
    diagnostics: &mut Diagnostics,
) {
    if let Err(error) = read {
        diagnostics.absorb(error);
        return skip_entry(input);
    }
    input.advance_to(end);
    let comma = input.parse::<Option<Token![,]>>();
    if input.is_empty() || comma.is_ok_and(|comma| comma.is_some()) {
        return;
    }
    // a forgotten comma is no reason to skip what follows
    diagnostics.push_at(input.span(), "expected a comma before this");
    if !starts_entry(input) {
        skip_entry(input);
    }
}

/// Whether a known `key =` or `key(`, a `name:` or a `name =` comes next.
fn starts_entry(input: ParseStream<'_>) -> bool {
    let ahead = input.fork();
    let Ok(name) = Ident::parse_any(&ahead) else { return false };
    let known = Key::all().any(|key| name == key.name());
    let alone = name == Key::Derivatives.name() && (ahead.is_empty() || ahead.peek(Token![,]));
    ahead.peek(Token![:]) || alone || known && (ahead.peek(Token![=]) || ahead.peek(token::Paren))
}

/// Everything up to and with the next comma.
fn skip_entry(input: ParseStream<'_>) {
    while let Ok(token) = input.parse::<TokenTree>() {
        if matches!(&token, TokenTree::Punct(punct) if punct.as_char() == ',') {
            return;
        }
    }
}
