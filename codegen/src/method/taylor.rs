//! Taylor steps: the motion as a power series in time, put back on the group and the coadjoint orbit.
//!
//! Beside what the motion is made of, the series are those of the element of the group by which the step moves the
//! configuration, `r' = r ξ`, and of its translations of the advected parameters' spaces, `w' = ∂h/∂a − ρ_ξ w`. Both
//! start from the identity. At the end of the step `r` is put back on the group, and
//!
//! ```text
//! g_{k+1} = g_k r,   a_{k+1} = Ad*_r a_k,   μ_{k+1} = Ad*_r μ_k − Σ J(w, a_{k+1})
//! ```
//!
//! whatever rest the series have: the Casimirs are kept to rounding. Where the energy depends on the configuration, or a
//! force acts, there is no more to be kept by the momentum, which is then that of its own series. Right-invariant
//! systems move by `r⁻¹`, with `r' = −r ξ`.

use std::collections::BTreeSet;

use super::discretization::{Values, bind};
use super::motion::Field;
use crate::expr::{Arena, Expr, Recurrences, Stage, Symbol, Unknown, Vector, gradient};
use crate::group::{Retraction, Semidirect, Side};
use crate::model::{Advected, Energy, Parts, System};
use crate::quantity::Kind;

/// The motion of a system as power series.
pub struct Taylor<'a> {
    /// How coefficients follow from those before.
    pub recurrences: Recurrences<'a>,
    /// What the unknowns start from.
    pub start: Vector<'a>,
    /// The lengths of the blocks of unknowns that have a unit in common.
    pub blocks: Vec<usize>,
    /// Where the controls stand among the unknowns, if they have a part in the motion: held ones have no higher coefficients.
    pub controls: Option<usize>,
    /// Where the rates at which they change stand, if the velocity depends on them: those of held ones are zero.
    pub rates: Option<usize>,
    /// Stand for these rates at the start.
    pub rate_symbols: Vec<Symbol>,
    /// The events whose series there are.
    pub events: Vec<usize>,
    /// Stand for the unknowns at the end of the step.
    pub end: Vector<'a>,
    /// How the unknowns change there.
    pub rate: Vector<'a>,
    /// The state at the end of the step.
    pub next: Vector<'a>,
}

/// What has a series.
struct Unknowns<'a> {
    all: Vec<Unknown<'a>>,
    /// Stand for them at the end of the step.
    end: Vec<Expr<'a>>,
    blocks: Vec<usize>,
    /// Where the controls stand, and the rates at which they change.
    controls: Option<usize>,
    rates: Option<usize>,
}

impl<'a> Unknowns<'a> {
    /// What they are at the end of the step.
    fn ends(&self) -> Values<'a> {
        let mut ends = Values::new();
        for (unknown, &end) in self.all.iter().zip(&self.end) {
            bind(&mut ends, &Vector(vec![unknown.symbol]), &Vector(vec![end]));
        }
        ends
    }
}

/// The series of a system's motion. None where a function in its description has no closed recurrence.
pub fn taylor<'a>(arena: &'a Arena, system: &System<'a>) -> Option<Taylor<'a>> {
    let motion = Motion::new(arena, system);
    // an event without a series is looked for among states
    let has_series = |event: &&(usize, Expr<'a>)| {
        Recurrences::new(arena, &motion.unknowns(&[event.1]).all, &[event.1]).is_some()
    };
    let (events, values): (Vec<usize>, Vec<Expr<'a>>) =
        motion.events.iter().filter(has_series).copied().unzip();
    let unknowns = motion.unknowns(&values);
    let recurrences = Recurrences::new(arena, &unknowns.all, &values)?;
    let end = Vector(unknowns.end.clone());
    let (rate, next) = (motion.rate(&unknowns), motion.next(&unknowns));
    let start = Vector(unknowns.all.iter().map(|unknown| unknown.start).collect());
    let Unknowns { blocks, controls, rates, .. } = unknowns;
    let rate_symbols = motion.control_rates.symbols();
    Some(Taylor { recurrences, start, blocks, controls, rates, rate_symbols, events, end, rate, next })
}

/// A motion in the unknowns of its series.
struct Motion<'s, 'a> {
    arena: &'a Arena,
    system: &'s System<'a>,
    /// `r`
    relative: Vector<'a>,
    /// `w`, where the momentum is kept by them.
    translations: Vec<Vector<'a>>,
    /// What has a series of its own: the velocity of a Lagrangian, else the momentum.
    moving: Vector<'a>,
    /// The rates at which the controls change, where the momentum of a velocity depends on them.
    control_rates: Vector<'a>,
    /// The changes of all of them, and of the advected parameters.
    relative_change: Vector<'a>,
    translation_changes: Vec<Vector<'a>>,
    moving_change: Vector<'a>,
    advected_changes: Vec<Vector<'a>>,
    /// The events that are smooth, with their places.
    events: Vec<(usize, Expr<'a>)>,
}

impl<'s, 'a> Motion<'s, 'a> {
    fn new(arena: &'a Arena, system: &'s System<'a>) -> Self {
        let group = &system.group;
        let numbered = |name: &str, length: usize| {
            Vector((1..=length).map(|i| arena.symbol(format!("{name}_{i}"), Stage::Step)).collect())
        };
        let relative = numbered("relative", system.configuration().len());
        let controls = system.control_symbols();
        let by_control = match &system.energy {
            Energy::Lagrangian(lagrangian) => {
                gradient(*lagrangian, &system.velocity_symbols().symbols()).depends_on(&controls)
            }
            _ => false,
        };
        let rates = controls.iter().filter(|_| by_control).map(|&control| {
            let name = format!("{}_rate", arena.symbol_info(control).name);
            (control, arena.symbol(name, Stage::Step))
        });
        let rates: Vec<(Symbol, Expr<'a>)> = rates.collect();
        let field = Field::driven(arena, system, &rates);
        let velocity = match &system.energy {
            Energy::Mechanical { inertia, .. } => inertia.inverse().map(Expr::hold).times(&system.momentum()),
            _ => system.velocity(),
        };
        let velocity = match system.energy {
            Energy::Lagrangian(_) => system.velocity_symbols(),
            _ => velocity,
        };
        // momentum and velocity by each other, then the configuration by where the step has come to
        let mut by_each_other = Values::new();
        match &system.energy {
            Energy::Lagrangian(lagrangian) => {
                let momentum = gradient(*lagrangian, &velocity.symbols());
                bind(&mut by_each_other, &system.momentum(), &momentum);
            }
            _ => bind(&mut by_each_other, &system.velocity_symbols(), &velocity),
        }
        let come_to = match system.side {
            Side::Left => relative.clone(),
            Side::Right => group.inverse(&relative),
        };
        let configuration = group.compose(system.side, &system.configuration(), &come_to);
        let mut here = Values::new();
        bind(&mut here, &system.configuration(), &configuration);
        let there = |vector: &Vector<'a>| vector.substitute(&by_each_other).substitute(&here);

        let sign = arena.number(system.side.sign());
        let velocity = there(&velocity).scale(sign);
        let is_kept = system.kick().is_none() && !matches!(system.energy, Energy::Lagrangian(_));
        let mut translations = Vec::new();
        let mut translation_changes = Vec::new();
        let mut by_advected = system.advected().map(|a| gradient(system.potential(), &a.value.symbols()));
        for (factor, place) in group.parts().filter(|_| is_kept) {
            for space in &factor.spaces {
                let by = there(&by_advected.next().unwrap_or_else(|| Vector(Vec::new()))).scale(sign);
                let name = format!("translation_{}", translations.len() + 1);
                let translation = numbered(&name, by.len());
                let turned = space.act_infinitesimally(&place.algebra(&velocity), &translation);
                translation_changes.push(&by - &turned);
                translations.push(translation);
            }
        }
        let changing = [system.state_symbols(), system.velocity_symbols().symbols(), system.time_symbol()];
        let is_smooth = |value: &Vector<'a>| !system.is_piecewise() && !value.chooses_by(&changing.concat());
        let events = system.events.iter().map(|event| Vector(vec![event.value])).enumerate();
        let events = events.filter(|(_, value)| is_smooth(value));
        let events = events.map(|(place, value)| (place, there(&value).0[0])).collect();
        let (moving, change) = match system.energy {
            Energy::Lagrangian(_) => (system.velocity_symbols(), &field.acceleration),
            _ => (system.momentum(), &field.momentum),
        };
        Self {
            arena,
            system,
            relative_change: group.stored_perturbation(Side::Left, &relative, &velocity),
            relative,
            translations,
            translation_changes,
            moving,
            control_rates: Vector(rates.iter().map(|rate| rate.1).collect()),
            moving_change: there(change),
            advected_changes: field.advected.iter().map(there).collect(),
            events,
        }
    }

    /// Whether the momentum follows from the element of the group.
    fn is_kept(&self) -> bool {
        self.system.kick().is_none() && !matches!(self.system.energy, Energy::Lagrangian(_))
    }

    /// What needs a series: the element of the group and its translations, the momentum where it does not follow from
    /// them, advected parameters that the group does not carry in closed form, and whatever the series of these, and of
    /// these events, need.
    fn unknowns(&self, events: &[Expr<'a>]) -> Unknowns<'a> {
        let Self { arena, system, .. } = self;
        let identity = self.identity();
        let mut candidates: Vec<(Vector<'a>, Vector<'a>, Vector<'a>, bool)> = Vec::new();
        for (factor, place) in system.group.parts() {
            let parts = [&self.relative, &identity, &self.relative_change].map(|whole| place.stored(whole));
            let unit = unit_length(factor.group.names().kind);
            let length = parts[0].len();
            for range in [0..unit, unit..length].into_iter().filter(|range| !range.is_empty()) {
                let [symbol, start, change] = [0, 1, 2].map(|k| parts[k].part(range.clone()));
                candidates.push((symbol, start, change, true));
            }
        }
        for (translation, change) in self.translations.iter().zip(&self.translation_changes) {
            candidates.push((translation.clone(), Vector::zeros(arena, change.len()), change.clone(), true));
        }
        let mut from = 0;
        for length in system.group.blocks() {
            let range = from..from + length;
            from += length;
            let [symbol, change] = [&self.moving, &self.moving_change].map(|whole| whole.part(range.clone()));
            candidates.push((symbol.clone(), symbol, change, !self.is_kept()));
        }
        for (place, (advected, change)) in system.advected().zip(&self.advected_changes).enumerate() {
            let is_carried = self.carried(place).is_some();
            candidates.push((advected.value.clone(), advected.value.clone(), change.clone(), !is_carried));
        }
        let time = Vector(vec![system.time]);
        // the momentum at the end may depend on the time, whatever the motion does
        let is_timed = matches!(system.energy, Energy::Lagrangian(_))
            && system.potential().depends_on(&system.time_symbol());
        candidates.push((time.clone(), time, Vector(vec![arena.one()]), is_timed));

        // the momentum at the end may depend on them, too
        let is_controlled = matches!(system.energy, Energy::Lagrangian(_))
            && system.potential().depends_on(&system.control_symbols());
        let first_control = candidates.len();
        for part in &system.controls {
            let symbols = Vector(part.symbols.iter().map(|&symbol| arena.of_symbol(symbol)).collect());
            let held = Vector::zeros(arena, symbols.len());
            candidates.push((symbols.clone(), symbols, held, is_controlled));
        }
        let first_rate = candidates.len();
        let [rates, held] = [self.control_rates.clone(), Vector::zeros(arena, self.control_rates.len())];
        if !rates.0.is_empty() {
            candidates.push((rates.clone(), rates, held, false));
        }

        let mut needed: BTreeSet<usize> =
            candidates.iter().enumerate().filter(|(_, one)| one.3).map(|(place, _)| place).collect();
        loop {
            let used = |symbols: &Vector<'a>| {
                let symbols = symbols.symbols();
                let of_event = |event: &Expr<'a>| event.depends_on(&symbols);
                needed.iter().any(|&place| candidates[place].2.depends_on(&symbols))
                    || events.iter().any(of_event)
            };
            let more: Vec<usize> = (0..candidates.len())
                .filter(|place| !needed.contains(place) && used(&candidates[*place].0))
                .collect();
            if more.is_empty() {
                break;
            }
            needed.extend(more);
        }
        if needed.iter().any(|&place| place >= first_control) {
            needed.extend(first_control..candidates.len());
        }
        let (all, end, blocks) = (Vec::new(), Vec::new(), Vec::new());
        let mut unknowns = Unknowns { all, end, blocks, controls: None, rates: None };
        for place in needed {
            if place == first_control {
                unknowns.controls = Some(unknowns.all.len());
            }
            if place == first_rate {
                unknowns.rates = Some(unknowns.all.len());
            }
            let (symbols, starts, changes, _) = &candidates[place];
            unknowns.blocks.push(symbols.len());
            for ((symbol, start), change) in symbols.iter().zip(starts.iter()).zip(changes.iter()) {
                unknowns.all.push(Unknown { symbol, start, change });
                let name = symbol.as_symbol().map(|symbol| arena.symbol_info(symbol).name);
                let name = format!("{}_end", name.unwrap_or_default());
                unknowns.end.push(arena.symbol(name, Stage::Iteration));
            }
        }
        unknowns
    }

    /// The identity of the group.
    fn identity(&self) -> Vector<'a> {
        let (arena, group) = (self.arena, &self.system.group);
        group.retract(Retraction::Exponential, &Vector::zeros(arena, group.dimension()))
    }

    /// `Ad*_r a` of an advected parameter, where there is a form of it.
    fn carried(&self, place: usize) -> Option<Vector<'a>> {
        let advected = &self.system.advected().nth(place)?.value;
        let (factor, at) = self.system.group.parts().find(|(_, at)| at.spaces.contains(&place))?;
        let space = factor.spaces[place - at.spaces.start];
        let relative = at.stored(&self.relative);
        let image = |axis: usize| {
            let unit = (0..advected.len()).map(|k| match k == axis {
                true => self.arena.one(),
                false => self.arena.zero(),
            });
            space.act(&relative, &Vector(unit.collect()))
        };
        let images: Option<Vec<_>> = (0..advected.len()).map(image).collect();
        Some(Vector(images?.iter().map(|image| advected.dot(image)).collect()))
    }

    /// How the unknowns change at the end of the step, as the equations have it: the series are held against it.
    fn rate(&self, unknowns: &Unknowns<'a>) -> Vector<'a> {
        Vector(unknowns.all.iter().map(|unknown| unknown.change).collect()).substitute(&unknowns.ends())
    }

    /// The state at the end of the step.
    fn next(&self, unknowns: &Unknowns<'a>) -> Vector<'a> {
        let (system, group) = (self.system, &self.system.group);
        let ends = unknowns.ends();
        let at_end = |vector: &Vector<'a>| vector.substitute(&ends);
        // back on the group
        let relative = at_end(&self.relative);
        let parts = group.parts().map(|(factor, place)| put_back(factor, &place.stored(&relative)));
        let relative = Vector(parts.flat_map(|part| part.0).collect()).hold();
        let come_to = match system.side {
            Side::Left => relative.clone(),
            Side::Right => group.inverse(&relative),
        };
        let moved = group.compose(system.side, &system.configuration(), &come_to).hold();
        let parts = group.parts().map(|(factor, place)| factor.group.normalize(&place.stored(&moved)));
        let configuration = Vector(parts.flat_map(|part| part.0).collect()).hold();

        let mut by = Values::new();
        bind(&mut by, &self.relative, &relative);
        let carried = |(place, a): (usize, &Advected<'a>)| match self.carried(place) {
            Some(carried) => carried.substitute(&by).hold(),
            None => at_end(&a.value),
        };
        let advected: Vec<Vector<'a>> = system.advected().enumerate().map(carried).collect();
        let momentum = if self.is_kept() {
            let back = group.inverse(&relative);
            let momentum = group.to_space(&back, &system.momentum()).hold();
            let translations: Vec<Vector<'a>> = self.translations.iter().map(at_end).collect();
            group.shifted(&momentum, &translations, &advected)
        } else if let Energy::Lagrangian(lagrangian) = &system.energy {
            let mut there = Values::new();
            bind(&mut there, &system.configuration(), &configuration);
            for (symbols, value) in system.advected_values().iter().zip(&advected) {
                bind(&mut there, symbols, value);
            }
            let controls = system.control_symbols().into_iter().map(|symbol| self.arena.of_symbol(symbol));
            let others = [&self.moving, &Vector(vec![system.time]), &Vector(controls.collect())];
            for symbols in others {
                bind(&mut there, symbols, &at_end(symbols));
            }
            gradient(*lagrangian, &self.moving.symbols()).substitute(&there)
        } else {
            at_end(&self.moving)
        };
        system.join_state(&Parts { configuration, momentum, advected })
    }
}

/// How many of the stored coordinates are of unit length together.
fn unit_length(kind: Kind) -> usize {
    match kind {
        Kind::UnitComplex | Kind::RigidMotion2 => 2,
        Kind::UnitQuaternion | Kind::RigidMotion3 => 4,
        Kind::Scalar | Kind::Vector(_) | Kind::Symmetric(_) | Kind::Matrix(..) => 0,
    }
}

/// What the rest of a series has taken off the group, back on it: a rotation by its length, a matrix by Newton's method.
fn put_back<'a>(factor: &Semidirect, relative: &Vector<'a>) -> Vector<'a> {
    match unit_length(factor.group.names().kind) {
        0 => (0..NEWTON_STEPS).fold(relative.clone(), |g, _| factor.group.normalize(&g).hold()),
        length => {
            let rotation = relative.part(0..length);
            let scale = rotation.squared_norm().sqrt().recip().hold();
            Vector::concat([&rotation.scale(scale), &relative.part(length..relative.len())])
        }
    }
}

/// Newton steps from the largest tolerance, 1e-3, to rounding.
const NEWTON_STEPS: usize = 3;
