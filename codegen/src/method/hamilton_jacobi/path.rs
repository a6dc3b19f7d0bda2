//! The motion through a step as a power series.
//!
//! With `g = ḡ τ(y)`, `ξ = dL τ_y y'`, quantities are power series in the time `τ` from the middle of the step and in the
//! square of the step:
//!
//! ```text
//! y = Σ y_ij τ^i t^2j,   and ξ, μ, g, a likewise
//! ```
//!
//! The equations of motion give what belongs to `τ^{i+1} t^2j` from what is of lower weight `i + 2j`. What is constant in
//! `τ` follows from the ends of the step: `y(t/2) = −y(−t/2)`, and either `y(t/2) − y(−t/2) = η`, or the mean of the
//! momenta at both ends, carried to `ḡ`, is `m̄`.

use crate::expr::{Arena, Expr, Number, Part, Series, Vector};
use crate::group::SemidirectVector;
use crate::method::discretization::{Discretization, bind};
use crate::method::motion::Field;
use crate::method::names::symbols;
use crate::model::{Relation, System};

/// What moves with the configuration: its own coordinates, or an advected parameter.
struct Moved<'a> {
    /// Symbols, which stand for the values at `ḡ`.
    symbols: Vector<'a>,
    /// Their changes along the motion.
    change: Vector<'a>,
    /// Their values at `ḡ τ(y)`.
    at_chart: Vector<'a>,
    /// The changes of the last weight.
    last: Vec<Part<'a>>,
}

/// What is held fixed as the step gets smaller.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Given {
    /// `m̄`
    Momentum,
    /// `η/t`
    Velocity,
}

/// The motion as a series, from the middle of a step.
pub(super) struct Motion<'s, 'a> {
    system: &'s System<'a>,
    arena: &'a Arena,
    given: Given,
    /// Series in the symbols of the state, the chart and its rate.
    pub series: Series<'a>,
    /// Series in `y` in the middle of the time.
    middle: Series<'a>,
    /// Series in `y` and the momentum at the end.
    end: Series<'a>,
    /// `y`: symbols.
    pub chart: Vector<'a>,
    /// `y'`: symbols.
    pub rate: Vector<'a>,
    /// `dL τ_y y' − y'`
    turned: Vector<'a>,
    /// Of the momentum, or of the velocity if that is given.
    change: Vector<'a>,
    /// The velocity by the momentum, or the other way round.
    other: Vector<'a>,
    /// `(dL τ_y)* μ`
    mean: Vector<'a>,
    moved: Vec<Moved<'a>>,
    /// The parts of `y` and of the change, of the weight that comes next.
    next: Vec<Part<'a>>,
    last: Vec<Part<'a>>,
    weight: usize,
}

impl<'s, 'a> Motion<'s, 'a> {
    pub(super) fn new(discretization: &Discretization<'s, 'a>, given: Given) -> Self {
        let Discretization { system, names, moving, carrying, step, .. } = discretization;
        let (arena, group) = (step.arena(), &system.group);
        let [chart, rate] = ["chart", "rate"].map(|name| symbols(arena, names.components(name)));
        let turned = &discretization.carried_velocity(&chart, &rate) - &rate;
        let field = Field::new(arena, system);
        // without a relation there are no such steps
        let (change, other) = match (given, system.momentum_relation()) {
            (Given::Momentum, _) => (field.momentum, system.velocity()),
            (Given::Velocity, Relation::Explicit(momentum)) => {
                let mut by_velocity = Vec::new();
                bind(&mut by_velocity, &system.momentum(), &momentum);
                (field.acceleration.substitute(&by_velocity), momentum)
            }
            (Given::Velocity, _) => (field.acceleration, system.momentum()),
        };
        let back = chart.scale(arena.number(-system.side.sign()));
        let [x, m] = [&back, &system.momentum()].map(|base| discretization.on_the_group(base));
        let mean = group.d_right_dual(carrying.before, &x, &m).base;

        let g = system.configuration();
        let increment = group.retract(moving.behind, &chart);
        let at_chart = group.compose(system.side, &g, &increment);
        let mut moved = vec![Moved { symbols: g, change: field.configuration, at_chart, last: Vec::new() }];
        let signed = chart.scale(arena.number(system.side.sign()));
        let advected = system.advected_values();
        let at_chart = group.carry(carrying.behind, &signed, &advected);
        for ((symbols, change), at_chart) in advected.into_iter().zip(field.advected).zip(at_chart) {
            moved.push(Moved { symbols, change, at_chart, last: Vec::new() });
        }
        moved.retain(|moved| {
            let symbols = moved.symbols.symbols();
            change.depends_on(&symbols) || other.depends_on(&symbols)
        });
        let next = vec![Vec::new(); chart.len()];
        let [series, middle, end] = [(); 3].map(|()| Series::new(arena));
        let (last, weight) = (Vec::new(), 0);
        Self {
            system,
            arena,
            given,
            series,
            middle,
            end,
            chart,
            rate,
            turned,
            change,
            other,
            mean,
            moved,
            next,
            last,
            weight,
        }
    }

    /// Works out the parts of the next weight.
    pub(super) fn advance(&mut self) {
        let weight = self.weight;
        let turned = self.turned(weight);
        let (chart, rate) = (self.chart.clone(), self.rate.clone());
        self.push_moved(weight);
        let time = match weight {
            0 => vec![self.system.time],
            1 => vec![self.arena.one()],
            _ => Vec::new(),
        };
        self.series.push(self.system.time, time);
        let rates = match self.given {
            Given::Momentum => self.by_momentum(&turned, weight),
            Given::Velocity => self.by_velocity(&turned, weight),
        };
        push(&mut self.series, &chart, &self.next);
        push(&mut self.series, &rate, &rates);

        self.last = self.parts(&self.change.clone(), weight);
        for k in 0..self.moved.len() {
            self.moved[k].last = self.parts(&self.moved[k].change.clone(), weight);
        }
        self.weight += 1;
        self.next = rates.iter().map(|rate| self.chart_part(weight + 1, rate)).collect();
        for (y, part) in chart.iter().zip(&self.next) {
            push_middle(&mut self.middle, y, part, weight);
        }
    }

    /// The parts of this and all higher weights are nothing, up to that one: only `y` goes on for one weight.
    pub(super) fn stop(&mut self, weight: usize) {
        for weight in self.weight..=weight {
            let none = vec![Vec::new(); self.chart.len()];
            let chart = if weight == self.weight { &self.next } else { &none };
            push(&mut self.series, &self.chart, chart);
            push(&mut self.series, &self.rate, &none);
            push(&mut self.series, &self.system.momentum(), &none);
            let time = if weight == 1 { vec![self.arena.one()] } else { Vec::new() };
            self.series.push(self.system.time, time);
        }
    }

    /// The part of this weight of the momentum at the end of the step.
    pub(super) fn momentum_at_end(&mut self, weight: usize) -> Vector<'a> {
        let momentum = self.parts(&self.other.clone(), weight);
        Vector(momentum.iter().map(|part| self.at_end(part, weight)).collect())
    }

    fn parts(&mut self, vector: &Vector<'a>, weight: usize) -> Vec<Part<'a>> {
        vector.iter().map(|component| self.series.part(component, weight)).collect()
    }

    /// The part of `dL τ_y y' − y'`, which does not depend on that of `y'`.
    fn turned(&mut self, weight: usize) -> Vec<Part<'a>> {
        push(&mut self.series, &self.chart, &self.next);
        push(&mut self.series, &self.rate, &vec![Vec::new(); self.chart.len()]);
        let turned = self.parts(&self.turned.clone(), weight);
        self.series.truncate(weight);
        turned
    }

    /// The part of `y'` by that of the velocity, whose constant makes the mean of `y'` over the step `η/t` alone.
    fn by_velocity(&mut self, turned: &[Part<'a>], weight: usize) -> Vec<Part<'a>> {
        let zero = self.arena.zero();
        let symbols = self.system.velocity_symbols();
        let (mut rates, mut velocities) = (Vec::new(), Vec::new());
        for (i, turned) in turned.iter().enumerate() {
            let mut xi = self.changed(i, weight);
            let mut rate: Part<'a> =
                xi.iter().enumerate().map(|(j, &xi)| (xi - at(turned, j, zero)).hold()).collect();
            if weight == 0 {
                (xi, rate) = (vec![symbols.0[i]], vec![symbols.0[i]]);
            } else if weight.is_multiple_of(2) {
                let first = (-mean_over_step(&rate, weight, zero)).hold();
                rate.push(first);
                xi.push((first + at(turned, weight / 2, zero)).hold());
            }
            rates.push(rate);
            velocities.push(xi);
        }
        push(&mut self.series, &symbols, &velocities);
        rates
    }

    /// The part of `y'` by that of the momentum, whose constant makes the mean of `(dL τ_y)* μ` at both ends `m̄` alone.
    fn by_momentum(&mut self, turned: &[Part<'a>], weight: usize) -> Vec<Part<'a>> {
        let zero = self.arena.zero();
        let symbols = self.system.momentum();
        let mut momenta: Vec<Part<'a>> = (0..symbols.len()).map(|i| self.changed(i, weight)).collect();
        if weight == 0 {
            momenta = symbols.iter().map(|m| vec![m]).collect();
        } else if weight.is_multiple_of(2) {
            let rest = self.mean_at_ends(&momenta, weight);
            self.end.truncate(weight);
            for (momentum, rest) in momenta.iter_mut().zip(rest) {
                momentum.push((-rest).hold());
            }
        }
        // for the weights to come
        self.mean_at_ends(&momenta, weight);
        push(&mut self.series, &symbols, &momenta);
        let velocities = self.parts(&self.other.clone(), weight);
        push(&mut self.series, &self.system.velocity_symbols(), &velocities);
        let rate = |(xi, turned): (&Part<'a>, &Part<'a>)| {
            let length = xi.len().max(turned.len());
            (0..length).map(|j| (at(xi, j, zero) - at(turned, j, zero)).hold()).collect()
        };
        velocities.iter().zip(turned).map(rate).collect()
    }

    /// The part of `(dL τ_y)* μ` at the end of the step; that of even weight is the same at its start.
    fn mean_at_ends(&mut self, momenta: &[Part<'a>], weight: usize) -> Vec<Expr<'a>> {
        let zero = self.arena.zero();
        let line = |part: &Part<'a>, arena: &'a Arena| {
            let value = at_end(part, weight, arena.zero());
            if value.is_zero() { Vec::new() } else { vec![value.hold()] }
        };
        let chart: Vec<Part<'a>> = self.next.iter().map(|part| line(part, self.arena)).collect();
        let momenta: Vec<Part<'a>> = momenta.iter().map(|part| line(part, self.arena)).collect();
        push(&mut self.end, &self.chart, &chart);
        push(&mut self.end, &self.system.momentum(), &momenta);
        self.mean.iter().map(|component| at(&self.end.part(component, weight), 0, zero)).collect()
    }

    /// The part of what changes, by the change before: all of it but the constant.
    fn changed(&self, i: usize, weight: usize) -> Part<'a> {
        match weight {
            0 => Vec::new(),
            _ => integrated(&self.last[i], weight, self.arena.zero()),
        }
    }

    /// The part of `y` from that of `y'` before: it is odd at the ends.
    fn chart_part(&self, weight: usize, rate: &Part<'a>) -> Part<'a> {
        let mut chart = integrated(rate, weight, self.arena.zero());
        if weight.is_multiple_of(2) {
            let even = self.at_end(&chart, weight);
            chart.push((-even).hold());
        }
        chart
    }

    fn at_end(&self, part: &Part<'a>, weight: usize) -> Expr<'a> {
        at_end(part, weight, self.arena.zero())
    }

    fn push_moved(&mut self, weight: usize) {
        let zero = self.arena.zero();
        for moved in &self.moved {
            for (i, symbol) in moved.symbols.iter().enumerate() {
                let part = if weight == 0 {
                    vec![symbol]
                } else {
                    let mut part = integrated(&moved.last[i], weight, zero);
                    if weight.is_multiple_of(2) {
                        let middle = self.middle.part(moved.at_chart.0[i], weight);
                        part.push(at(&middle, weight / 2, zero).hold());
                    }
                    part
                };
                self.series.push(symbol, part);
            }
        }
    }
}

impl<'a> Discretization<'_, 'a> {
    /// An element of the algebra or of its dual, with nothing in the spaces.
    pub(super) fn on_the_group(&self, base: &Vector<'a>) -> SemidirectVector<'a> {
        let zeros = |a: Vector<'a>| Vector::zeros(self.step.arena(), a.len());
        let spaces = self.system.advected_values().into_iter().map(zeros).collect();
        SemidirectVector { base: base.clone(), spaces }
    }
}

fn push<'a>(series: &mut Series<'a>, symbols: &Vector<'a>, parts: &[Part<'a>]) {
    for (symbol, part) in symbols.iter().zip(parts) {
        series.push(symbol, part.clone());
    }
}

/// Takes note of the part of `y` behind this weight in the middle of the time.
fn push_middle<'a>(middle: &mut Series<'a>, y: Expr<'a>, part: &Part<'a>, weight: usize) {
    if weight == 0 {
        middle.push(y, Vec::new());
    }
    let alone = |&first: &Expr<'a>| [vec![first.arena().zero(); part.len() - 1], vec![first]].concat();
    let constant = part.last().filter(|_| weight % 2 == 1);
    middle.push(y, constant.map(alone).unwrap_or_default());
}

fn at<'a>(part: &Part<'a>, j: usize, zero: Expr<'a>) -> Expr<'a> {
    part.get(j).copied().unwrap_or(zero)
}

/// The coefficient of the step's power at the end of the step.
pub(super) fn at_end<'a>(part: &Part<'a>, weight: usize, zero: Expr<'a>) -> Expr<'a> {
    let terms = part.iter().enumerate().map(|(j, &c)| c.scale(power_of_half(weight - 2 * j)));
    terms.fold(zero, |sum, c| sum + c)
}

/// The coefficient of the step's power in the mean over the step, of a part of even weight.
pub(super) fn mean_over_step<'a>(part: &Part<'a>, weight: usize, zero: Expr<'a>) -> Expr<'a> {
    let terms = part.iter().enumerate().map(|(j, &c)| {
        let i = weight - 2 * j;
        c.scale(power_of_half(i) * Number::ratio(1, i as i128 + 1))
    });
    terms.fold(zero, |sum, c| sum + c)
}

/// The part of this weight of an integral, from the part before: all of it but the constant.
fn integrated<'a>(part: &Part<'a>, weight: usize, zero: Expr<'a>) -> Part<'a> {
    let coefficient = |j: usize| at(part, j, zero).scale(Number::ratio(1, (weight - 2 * j) as i128)).hold();
    (0..weight.div_ceil(2)).map(coefficient).collect()
}

/// `2⁻ⁱ`
fn power_of_half(i: usize) -> Number {
    Number::ratio(1, 1 << i)
}
