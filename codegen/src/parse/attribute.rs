//! The arguments of `#[lie_poisson_system(…)]`.

use std::fmt::Display;

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use syn::ext::IdentExt;
use syn::parse::discouraged::Speculative;
use syn::parse::{Parse, ParseStream, Parser};
use syn::{Ident, LitInt, LitStr, Token, bracketed, parenthesized, token};

use super::factor::FactorName;
use super::function::OwnFunction;
use super::group::{Group, Space, declared_name, first_word, group, space};
use super::key::{EnergyKey, Key};
use super::nesting;
use super::shape;
use crate::diagnostics::{Diagnostics, Explained, list, nearest, suggestion};
use crate::group::Retraction;
use crate::limits;
use crate::quantity::{Direction, ScalarType, Shape};
use crate::scheme::{Derivatives, Member, Method, Rule};

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
    /// `event(apogee = …, falling)`
    pub events: Vec<Event>,
    /// `invariance = right`
    pub right: bool,
    /// `methods(Midpoint, …)`
    pub methods: Vec<Rule>,
    /// `retractions(Cayley, …)`; empty for those of [`Retraction::defaults`].
    pub retractions: Vec<Retraction>,
    /// `derivatives` for all of them, or `derivatives(state, …)`
    pub derivatives: Derivatives,
    /// `taylor`
    pub taylor: bool,
    /// `units(momentum = "N m s", …)`
    pub units: Vec<Unit>,
    /// `scalar = f32`
    pub scalar: Option<ScalarType>,
    /// `crate = …`
    pub krate: Option<syn::Path>,
    /// What `lie_group!` says of groups that are named by their paths.
    pub definitions: Vec<Definition>,
    /// The functions that expressions call, as far as they are known.
    pub functions: Vec<OwnFunction>,
    /// The names of factors, advected parameters and controls whose declarations could not be read, with the keys where
    /// they are.
    pub unreadable: Vec<(Key, Ident)>,
    /// Whether all of it could be read.
    pub is_sound: bool,
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

/// A quantity that may become zero.
#[derive(Debug)]
pub struct Event {
    /// The user's name for it.
    pub name: Ident,
    /// The quantity.
    pub value: syn::Expr,
    /// Which of its zeros count.
    pub direction: Direction,
}

impl Attribute {
    /// Reads the tokens between the parentheses of the attribute. `known` are the methods that there are.
    pub fn parse(tokens: TokenStream, known: &[&'static Method], diagnostics: &mut Diagnostics) -> Self {
        let before = diagnostics.len();
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
        attribute.is_sound = diagnostics.len() == before;
        attribute
    }

    /// Whether the key was written or meant, even if its value could not be read.
    pub fn has(&self, key: Key) -> bool {
        self.given.contains(&key) || self.slips.contains(&key)
    }

    /// Whether the energy is given whole, not as inertia and potential.
    pub fn has_whole_energy(&self) -> bool {
        [EnergyKey::Hamiltonian, EnergyKey::Lagrangian].into_iter().any(|key| self.has(Key::Energy(key)))
    }

    /// The energy of a key.
    pub fn energy(&self, key: EnergyKey) -> Option<&syn::Expr> {
        self.energies.iter().find(|(known, _)| *known == key).map(|(_, energy)| energy)
    }

    /// One `key = value` or `key(…)`, with the comma after it. Always consumes something.
    fn entry(&mut self, input: ParseStream<'_>, methods: &[&'static Method], diagnostics: &mut Diagnostics) {
        let word = match Ident::parse_any(input) {
            Ok(word) => word,
            Err(error) => {
                let message = format!("expected a key, such as `{}`", Key::Group.example());
                diagnostics.push_at(error.span(), message);
                return skip_entry(input);
            }
        };
        let name = word.to_string();
        let names: Vec<&str> = Key::all().map(Key::name).collect();
        // a slip is read as what it is a slip of: nothing that it declares is missed elsewhere
        let meant = nearest(&name, &names).and_then(|name| Key::all().find(|known| known.name() == name));
        let is_slip = meant.is_none_or(|known| known.name() != name);
        if is_slip {
            diagnostics.push(&word, format!("there is no key `{name}`{}", suggestion(&name, &names)));
        }
        let Some(key) = meant else { return skip_entry(input) };
        let again = self.given.contains(&key) || is_slip && self.has(key);
        if again && !is_slip {
            diagnostics.push(&word, format!("`{name}` is given twice; keep one of them"));
        }
        if is_slip { &mut self.slips } else { &mut self.given }.push(key);
        // a second value is read all the same, for the sake of problems in it
        let mut ignored = Self::default();
        let target = if again { &mut ignored } else { self };
        let value = input.fork();
        let mut reader = Reader { word: &word, key, diagnostics, unreadable: Vec::new() };
        let read = target.value(&value, methods, &mut reader);
        if let Key::Group | Key::Advected | Key::Control = key {
            target.unreadable.append(&mut reader.unreadable);
        }
        finish_entry(input, &value, read, diagnostics);
    }

    /// Reads the value of a key.
    fn value(
        &mut self,
        input: ParseStream<'_>,
        methods: &[&'static Method],
        reader: &mut Reader<'_>,
    ) -> syn::Result<()> {
        match reader.key {
            Key::Group => self.factors = reader.factors(input)?,
            Key::Advected => self.advected = reader.entries(input, advected, |it| Some(&it.name))?,
            Key::Energy(energy) => {
                self.energies.extend(reader.equals(input, Parse::parse)?.map(|value| (energy, value)));
            }
            Key::Control => self.controls = reader.entries(input, control, |it| Some(&it.name))?,
            Key::Force => self.forces = reader.forces(input)?,
            Key::Event => self.events = reader.entries(input, event, |it| Some(&it.name))?,
            Key::Invariance => self.right = reader.invariance(input)?,
            Key::Methods => self.methods = reader.methods(input, methods)?,
            Key::Retractions => self.retractions = reader.retractions(input)?,
            Key::Derivatives => self.derivatives = reader.derivatives(input)?,
            Key::Taylor => self.taylor = reader.nothing(input)?,
            Key::Units => self.units = reader.entries(input, unit, |it| Some(&it.name))?,
            Key::Scalar => self.scalar = reader.scalar(input)?,
            Key::Crate => self.krate = reader.crate_path(input)?,
        }
        Ok(())
    }
}

/// Reads the value of one key.
struct Reader<'r> {
    /// The key as it is written.
    word: &'r Ident,
    key: Key,
    diagnostics: &'r mut Diagnostics,
    /// The names of entries that could not be read.
    unreadable: Vec<(Key, Ident)>,
}

impl Reader<'_> {
    /// `= value`. `None` where the value is missing, which is reported.
    fn equals<T>(
        &mut self,
        input: ParseStream<'_>,
        parse: impl FnOnce(ParseStream<'_>) -> syn::Result<T>,
    ) -> syn::Result<Option<T>> {
        let (name, example) = (self.key.name(), self.key.example());
        if !input.peek(Token![=]) || input.peek(Token![==]) {
            return Err(input.error(format!("expected `=`; write `{example}`")));
        }
        let sign: Token![=] = input.parse()?;
        if input.is_empty() || input.peek(Token![,]) {
            self.diagnostics.push(sign, format!("`{name}` has no value; write `{example}`"));
            return Ok(None);
        }
        parse(input).map(Some)
    }

    /// Entries between parentheses, of which no two have the same name.
    fn entries<T, N: PartialEq + ToTokens + Display>(
        &mut self,
        input: ParseStream<'_>,
        parse: impl Fn(ParseStream<'_>) -> syn::Result<T>,
        name: impl Fn(&T) -> Option<&N>,
    ) -> syn::Result<Vec<T>> {
        let (word, key) = (self.key.name(), self.key);
        if !input.peek(token::Paren) {
            let missing = input.is_empty() || input.peek(Token![,]);
            let place = if missing { self.word.span() } else { input.span() };
            let message = format!("expected parentheses; write `{}`", key.example());
            return Err(syn::Error::new(place, message));
        }
        let content;
        parenthesized!(content in input);
        if content.is_empty() {
            self.diagnostics.push(self.word, format!("`{word}` names nothing; write `{}`", key.example()));
        }
        let mut list: Vec<T> = Vec::new();
        while !content.is_empty() {
            let ahead = content.fork();
            let read = parse(&ahead).map(|entry| match name(&entry) {
                Some(this) if list.iter().any(|earlier| name(earlier) == Some(this)) => {
                    self.diagnostics.push(this, format!("`{this}` is named twice in `{word}`"));
                }
                _ => list.push(entry),
            });
            if read.is_err() {
                self.unreadable.extend(content.fork().parse::<Ident>().map(|name| (key, name)));
            }
            finish_entry(&content, &ahead, read, self.diagnostics);
        }
        Ok(list)
    }

    /// Some of these words between parentheses; what is `expected`, and how a message begins that says what there is
    /// not.
    fn words(
        &mut self,
        input: ParseStream<'_>,
        known: &[&str],
        [expected, there_is_no]: [&str; 2],
    ) -> syn::Result<Vec<Ident>> {
        let word = |input: ParseStream<'_>| {
            let name: Ident = input.parse().explained(expected)?;
            if known.iter().any(|known| name == known) {
                return Ok(name);
            }
            let guess = suggestion(&name.to_string(), known);
            Err(syn::Error::new_spanned(&name, format!("{there_is_no} `{name}`{guess}")))
        };
        self.entries(input, word, |name| Some(name))
    }

    /// `(Cayley)`
    fn retractions(&mut self, input: ParseStream<'_>) -> syn::Result<Vec<Retraction>> {
        let messages = ["expected a retraction, such as `Cayley`", "there is no retraction"];
        let named = self.words(input, &Retraction::ALL.map(Retraction::name), messages)?;
        // in the order in which they always come
        let is_named = |retraction: &Retraction| named.iter().any(|name| name == retraction.name());
        Ok(Retraction::ALL.into_iter().filter(is_named).collect())
    }

    /// Nothing, for all of them, or `(state, controls, …)`
    fn derivatives(&mut self, input: ParseStream<'_>) -> syn::Result<Derivatives> {
        if input.peek(Token![=]) {
            let (example, word) = (self.key.example(), self.word);
            return Err(input.error(format!("write `{example}`, or `{word}` alone for all of them")));
        }
        if !input.peek(token::Paren) {
            // or a forgotten comma, which is noticed elsewhere
            return Ok(Derivatives::ALL);
        }
        const NAMES: [&str; 5] = ["state", "controls", "parameters", "tangent", "adjoint"];
        let messages = ["expected what the derivatives are by, such as `state`", "there are no derivatives"];
        let named = self.words(input, &NAMES, messages)?;
        let [state, controls, parameters, tangent, adjoint] =
            NAMES.map(|name| named.iter().any(|known| known == name));
        // the derivatives of composed steps by anything lead through the states between
        let state = state || controls || parameters;
        Ok(Derivatives { state, controls, parameters, tangent, adjoint })
    }

    /// A key that says all by itself.
    fn nothing(&mut self, input: ParseStream<'_>) -> syn::Result<bool> {
        if input.peek(Token![=]) || input.peek(token::Paren) {
            return Err(input.error(format!("write `{}` alone", self.word)));
        }
        Ok(true)
    }

    /// `= SO3` or `(attitude: SO3, position: R3)`
    fn factors(&mut self, input: ParseStream<'_>) -> syn::Result<Vec<Factor>> {
        if input.peek(token::Paren) {
            return self.entries(input, factor, |factor| factor.name.as_ref());
        }
        if input.peek(Token![=]) && input.peek2(token::Bracket) {
            let message = "an array of factors has a name; write `group(spins: [SO3; 4])`";
            return Err(syn::Error::new_spanned(self.word, message));
        }
        let name = self.equals(input, first_word).map_err(|error| with_example(error, self.key))?;
        let Some(name) = name else { return Ok(Vec::new()) };
        Ok(vec![Factor { name: None, group: group(input, name)?, length: None }])
    }

    /// `= expr` or `(attitude = expr, …)`
    fn forces(&mut self, input: ParseStream<'_>) -> syn::Result<Vec<Force>> {
        if input.peek(token::Paren) {
            return self.entries(input, force, |force| force.factor.as_ref());
        }
        let value = self.equals(input, Parse::parse)?;
        Ok(value.map(|value| Force { factor: None, value }).into_iter().collect())
    }

    /// `= left` or `= right`
    fn invariance(&mut self, input: ParseStream<'_>) -> syn::Result<bool> {
        let side: Option<Ident> =
            self.equals(input, Parse::parse).map_err(|error| with_example(error, self.key))?;
        match side.as_ref().map(ToString::to_string).as_deref() {
            None | Some("left") => Ok(false),
            Some("right") => Ok(true),
            Some(_) => Err(syn::Error::new_spanned(side, "a system is `left`- or `right`-invariant")),
        }
    }

    /// `= f32` or `= f64`
    fn scalar(&mut self, input: ParseStream<'_>) -> syn::Result<Option<ScalarType>> {
        let name: Option<Ident> =
            self.equals(input, Parse::parse).map_err(|error| with_example(error, self.key))?;
        let Some(name) = name else { return Ok(None) };
        let known = shape::scalar_named(&name.to_string());
        known.map(Some).ok_or_else(|| syn::Error::new_spanned(name, "a system is made of `f64` or `f32`"))
    }

    /// `(Midpoint, SymplecticEulerB, Family(1, 4))`
    fn methods(&mut self, input: ParseStream<'_>, known: &[&'static Method]) -> syn::Result<Vec<Rule>> {
        let named = self.entries(input, |input| method(input, known), |_| None::<&Ident>)?;
        let mut rules = Vec::new();
        for rule in named {
            if !rules.contains(&rule) {
                rules.push(rule);
            }
        }
        if rules.len() > limits::METHODS {
            let message = format!("a system may have {} methods at most", limits::METHODS);
            return Err(syn::Error::new_spanned(self.word, message));
        }
        Ok(rules)
    }

    /// `= path::to::coadjoint`
    fn crate_path(&mut self, input: ParseStream<'_>) -> syn::Result<Option<syn::Path>> {
        let ahead = input.fork();
        if ahead.parse::<Token![=]>().is_ok() && ahead.peek(LitStr) {
            let text: LitStr = ahead.parse()?;
            input.advance_to(&ahead);
            let message = format!("write the path without quotes: `crate = {}`", text.value());
            self.diagnostics.push(&text, message);
            return Ok(None);
        }
        if ahead.is_empty() || ahead.peek(Token![,]) {
            return self.equals(input, Parse::parse);
        }
        let path = |input: ParseStream<'_>| {
            input.parse::<Token![=]>()?;
            syn::Path::parse_mod_style(input)
        };
        path(input).map(Some).map_err(|error| with_example(error, self.key))
    }
}

/// The error with an example of the key's use, unless it has one already.
fn with_example(error: syn::Error, key: Key) -> syn::Error {
    let message = error.to_string();
    if message.contains(key.example()) {
        return error;
    }
    syn::Error::new(error.span(), format!("{message}; write `{}`", key.example()))
}

/// `attitude: SO3` or `spins: [SO3; 4]`
fn factor(input: ParseStream<'_>) -> syn::Result<Factor> {
    let name = declared_name(input, "attitude: SO3", "a factor", "the group it moves on")?;
    let factor_group = |input: ParseStream<'_>, example: &str| {
        let message = format!("expected a group; a factor is written `{example}`");
        group(input, first_word(input).explained(message)?)
    };
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

/// `attitude = expr` or `spins[0] = expr`
fn force(input: ParseStream<'_>) -> syn::Result<Force> {
    let message = "expected the name of a factor and `=`; write `force(attitude = moment)`";
    if !input.peek(Ident) {
        return Err(input.error("")).explained(message);
    }
    let factor: FactorName = input.parse()?;
    input.parse::<Token![=]>().explained(message)?;
    Ok(Force { factor: Some(factor), value: input.parse()? })
}

/// `apogee = position.dot(&momentum), falling`
fn event(input: ParseStream<'_>) -> syn::Result<Event> {
    let example = Key::Event.example();
    if !input.peek(Ident) {
        let message = format!("expected a name, `=` and a quantity; write `{example}`");
        return Err(input.error("")).explained(message);
    }
    let name: Ident = input.parse()?;
    if !input.peek(Token![=]) {
        let guess = match nearest(&name.to_string(), &Direction::ALL.map(Direction::name)) {
            Some(guess) => format!("did you mean `{guess}`?"),
            None => format!("write `{example}`"),
        };
        return Err(syn::Error::new_spanned(&name, format!("`{name}` has no quantity; {guess}")));
    }
    input.parse::<Token![=]>()?;
    let value = input.parse()?;
    let ahead = input.fork();
    let mut direction = Direction::Both;
    // a word behind a comma, which is no name of the next event
    if ahead.parse::<Token![,]>().is_ok()
        && let Ok(word) = ahead.parse::<Ident>()
        && !ahead.peek(Token![=])
        && let Some(known) = Direction::ALL.into_iter().find(|direction| word == direction.name())
    {
        direction = known;
        input.advance_to(&ahead);
    }
    Ok(Event { name, value, direction })
}

/// `momentum = "N m s"`
fn unit(input: ParseStream<'_>) -> syn::Result<Unit> {
    let parts = || {
        let name = Ident::parse_any(input)?;
        input.parse::<Token![=]>()?;
        let text: LitStr = input.parse()?;
        let unit = text.value().trim().to_owned();
        if unit.is_empty() { Err(syn::Error::new_spanned(text, "")) } else { Ok(Unit { name, unit }) }
    };
    parts().explained("expected a name, `=` and a unit in quotes; write `units(momentum = \"N m s\")`")
}

/// Compositions of steps that are generated without them.
const COMPOSED: [&str; 2] = ["StormerVerlet", "RightLift"];

/// `Midpoint` or `Family(1, 4)`
fn method(input: ParseStream<'_>, known: &[&'static Method]) -> syn::Result<Rule> {
    let name: Ident = input.parse().explained("expected a method, such as `Midpoint`")?;
    let text = name.to_string();
    let named = known.iter().find_map(|method| method.named(&text));
    match known.iter().find(|method| name == method.name) {
        Some(method) if named.is_none() || input.peek(token::Paren) => {
            return parameter(input, &name, method);
        }
        _ => {}
    }
    named.ok_or_else(|| {
        let names: Vec<&str> = known.iter().flat_map(|method| method.named).map(|named| named.name).collect();
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
                let families = known.iter().map(|method| match method.orders {
                    [] => format!("{}(numerator, denominator)", method.name),
                    _ => format!("{}(order)", method.name),
                });
                let all = list(names.iter().map(|&name| name.to_owned()).chain(families));
                format!("there is no method `{name}`; there are {all}")
            }
        };
        syn::Error::new_spanned(&name, message)
    })
}

/// `(1, 4)` or `(6)`
fn parameter(input: ParseStream<'_>, name: &Ident, method: &'static Method) -> syn::Result<Rule> {
    if !method.orders.is_empty() {
        let read = || {
            let content;
            parenthesized!(content in input);
            let order: LitInt = content.parse()?;
            let (order, is_plain) = (order.base10_parse::<u32>()?, order.suffix().is_empty());
            // all of it is read, or syn complains about the rest
            let rest: proc_macro2::TokenStream = content.parse()?;
            (rest.is_empty() && is_plain && method.orders.contains(&order))
                .then(|| method.of_order(order))
                .ok_or_else(|| content.error(""))
        };
        let orders = list(method.orders.iter().map(u32::to_string));
        let usual = method.usual_order.unwrap_or(method.orders[0]);
        return read().map_err(|_| {
            let message =
                format!("`{name}` takes the order of the step: `{name}({usual})`; there are {orders}");
            syn::Error::new_spanned(name, message)
        });
    }
    let content;
    parenthesized!(content in input);
    let numerator: LitInt = content.parse()?;
    content.parse::<Token![,]>()?;
    let denominator: LitInt = content.parse()?;
    let is_plain = [&numerator, &denominator].iter().all(|number| number.suffix().is_empty());
    let member = Member::new(numerator.base10_parse()?, denominator.base10_parse()?);
    member.filter(|_| is_plain).map(|member| method.member(member)).ok_or_else(|| {
        let message =
            format!("the parameter s of a method is a fraction between 0 and 1: `{name}(1, 4)` is s = 1/4");
        syn::Error::new_spanned(name, message)
    })
}

/// `gamma: R3`, `gamma: attitude::R3` or `gamma: spins[0]::R3`
fn advected(input: ParseStream<'_>) -> syn::Result<Advected> {
    let name = declared_name(input, "gamma: R3", "an advected parameter", "the space it lives in")?;
    let is_named = || match input.peek(Ident) {
        true => Ok(()),
        false => {
            Err(input.error("")).explained("expected a space; an advected parameter is written `gamma: R3`")
        }
    };
    is_named()?;
    let is_of_factor = input.peek2(Token![::]) || input.peek2(token::Bracket);
    let factor = is_of_factor.then(|| input.parse::<FactorName>()).transpose()?;
    if is_of_factor {
        input.parse::<Token![::]>()?;
    }
    is_named()?;
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
