//! From a program to what the runtime makes systems of.

use std::sync::Arc;

use coadjoint::erased::RetractionKind;
use coadjoint::erased::dynamic::{
    Definition, Given, Inertia, LANES, Layout, Lengths, MACHINE_LANES, March, Rule, Step, StepFunction,
    StepFunctions, SystemFunction, SystemFunctions, Work, description, side_by_side, with_events,
};
use coadjoint::{Event, Kind, Quantity, Role, Scheme, Side};
use coadjoint_codegen::emit::bytes;
use coadjoint_codegen::program::{
    self, Function, Input, Interface, Module, Program, RecordKind, StepProgram, StepRole, SystemRole,
    Transform, Value,
};
use coadjoint_codegen::quantity;
use coadjoint_codegen::scheme;

use crate::assembler::{Frame, Places, assembled};
use crate::derivative::Derivative;
use crate::intern;
use crate::interpreter::Code;
use crate::machine::Machine;
use crate::series::InterpretedSeries;

/// The definition of a program with these values of its constants, by machine code where there may be any, if it is not to be interpreted.
pub(crate) fn definition(program: &Arc<Program>, constants: Vec<f64>, interpreted: bool) -> Definition {
    let interface = &program.interface;
    let step = |place| Arc::new(step(program, place, interpreted));
    let inertias = interface.inertias.iter().map(|inertia| Inertia {
        name: intern::text(&inertia.name),
        rows: inertia.is_matrix.then_some(inertia.rows),
    });
    let events = interface.events.iter().map(|(name, direction)| {
        let event = match direction {
            quantity::Direction::Rising => Event::rising(),
            quantity::Direction::Falling => Event::falling(),
            quantity::Direction::Both => Event::any(),
        };
        (intern::text(name), event)
    });
    let events = intern::events(events.collect());
    Definition {
        description: with_events(
            description(
                intern::text(&interface.name),
                [&interface.parameters, &interface.state, &interface.controls].map(|all| quantities(all)),
                intern::texts(&interface.casimirs),
                match interface.side {
                    quantity::Side::Left => Side::Left,
                    quantity::Side::Right => Side::Right,
                },
                [
                    interface.is_autonomous,
                    interface.is_left_invariant,
                    interface.is_forced,
                    interface.is_piecewise,
                ],
            ),
            events,
        ),
        constants,
        inertias: inertias.collect(),
        dimension: interface.dimension,
        is_momentum_singular: interface.momentum == Transform::Singular,
        functions: Box::new(system_functions(program)),
        steps: (0..program.steps.len()).map(step).collect(),
        series: program.taylor.as_ref().map(InterpretedSeries::shared),
    }
}

fn quantities(all: &[program::Quantity]) -> &'static [Quantity] {
    let of = |one: &program::Quantity| Quantity {
        name: intern::text(&one.name),
        role: match one.role {
            quantity::Role::Parameter => Role::Parameter,
            quantity::Role::Configuration => Role::Configuration,
            quantity::Role::Momentum => Role::Momentum,
            quantity::Role::Advected => Role::Advected,
            quantity::Role::Control => Role::Control,
        },
        kind: match one.kind {
            quantity::Kind::Scalar => Kind::Scalar,
            quantity::Kind::Vector(n) => Kind::Vector(n),
            quantity::Kind::Symmetric(n) => Kind::SymmetricMatrix(n),
            quantity::Kind::Matrix(rows, columns) => Kind::Matrix(rows, columns),
            quantity::Kind::UnitComplex => Kind::UnitComplex,
            quantity::Kind::UnitQuaternion => Kind::UnitQuaternion,
            quantity::Kind::RigidMotion2 => Kind::RigidMotion2,
            quantity::Kind::RigidMotion3 => Kind::RigidMotion3,
        },
        components: intern::texts(&one.components),
        tangent: (one.tangent.start, one.tangent.end),
        unit: one.unit.as_deref().map(intern::text),
        doc: intern::text(&one.doc),
    };
    intern::quantities(all.iter().map(of).collect())
}

fn retraction(retraction: scheme::Retraction) -> RetractionKind {
    let is = |kind: &RetractionKind| kind.name() == retraction.name();
    RetractionKind::ALL.into_iter().find(is).unwrap_or(RetractionKind::Exponential)
}

/// The runtime's step of the same name.
fn step_named(scheme: &scheme::Scheme) -> Option<(RetractionKind, Rule)> {
    match scheme.type_name().parse() {
        Ok(Scheme::Step(map, rule)) => Some((map, rule)),
        _ => None,
    }
}

/// A step's functions on frames.
struct Functions {
    interpreted: [Code; 8],
    /// None if they are to be interpreted.
    machine: Option<Machine>,
}

pub(crate) const FUNCTIONS: [(StepFunction, StepRole); 8] = [
    (StepFunction::New, StepRole::New),
    (StepFunction::Begin, StepRole::Begin),
    (StepFunction::Start, StepRole::Start),
    (StepFunction::Evaluate, StepRole::Evaluate),
    (StepFunction::Correction, StepRole::Correction),
    (StepFunction::FixedPointUpdate, StepRole::FixedPointUpdate),
    (StepFunction::Domain, StepRole::Domain),
    (StepFunction::Finish, StepRole::Finish),
];

/// Code for frames side by side.
struct Wide<'a> {
    code: &'a Code,
    frame: &'a mut [[f64; LANES]],
}

impl Work for Wide<'_> {
    type CallSite = ();
    type Result = ();

    #[inline(always)]
    fn done(self) {
        self.code.run(self.frame);
    }
}

impl StepFunctions for Functions {
    fn call(&self, function: StepFunction, frame: &mut [f64]) {
        if self.machine.as_ref().is_some_and(|machine| machine.call(function, frame)) {
            return;
        }
        self.interpreted[function as usize].run::<1>(frame.as_chunks_mut().0);
    }

    fn call_wide(&self, function: StepFunction, frame: &mut [[f64; LANES]]) {
        if self.machine.as_ref().is_some_and(|machine| machine.call_wide(function, frame)) {
            return;
        }
        side_by_side(Wide { code: &self.interpreted[function as usize], frame });
    }

    fn call_machine_lanes(&self, function: StepFunction, frame: &mut [[f64; MACHINE_LANES]]) {
        if self.machine.as_ref().is_some_and(|machine| machine.call_wide(function, frame)) {
            return;
        }
        self.interpreted[function as usize].run(frame);
    }

    fn has_march(&self) -> bool {
        self.machine.as_ref().is_some_and(Machine::has_march)
    }

    fn march(&self, then: Option<usize>) -> Option<March> {
        self.machine.as_ref()?.march(then, 1)
    }

    fn march_machine_lanes(&self, then: Option<usize>) -> Option<March> {
        self.machine.as_ref()?.march(then, MACHINE_LANES)
    }
}

/// Where a step's functions find what they are given.
pub(crate) struct InStep<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) module: &'a Module<StepRole>,
    pub(crate) function: &'a Function<StepRole>,
}

impl Places for InStep<'_> {
    fn input(&self, input: Input) -> usize {
        let layout = self.layout;
        match input {
            Input::Parameters => layout.parameters.start,
            Input::StepSize => layout.step_size,
            Input::State => layout.state.start,
            Input::Time => layout.time,
            Input::Control => layout.control.start,
            Input::Unknown => layout.unknown.start,
            Input::Residual => layout.residual.start,
            Input::Right => layout.right.start,
            Input::Record(RecordKind::Constants) => layout.constants.start,
            Input::Record(RecordKind::Step) => layout.step.start,
            Input::Record(RecordKind::Iterate) => layout.iterate.start,
            // the table of signatures, `program/roles.rs`, gives steps the inputs above alone
            _ => unreachable!("no function of a step is given {input:?}"),
        }
    }

    fn record(&self) -> (&[Value], usize) {
        match self.function.record {
            Some(kind) => (self.module.values.fields(kind), self.input(Input::Record(kind))),
            None => (&[], 0),
        }
    }

    fn result(&self, array: usize) -> usize {
        match (self.function.role, array) {
            (StepRole::Evaluate, 0) => self.layout.residual.start,
            (StepRole::Evaluate, _) => self.layout.right.start,
            (StepRole::Domain, _) => self.layout.margin,
            (StepRole::Finish, _) => self.layout.next.start,
            _ => self.layout.out.start,
        }
    }

    fn is_least(&self) -> bool {
        self.function.role == StepRole::Domain
    }
}

/// Where a step's numbers are.
pub(crate) fn layout(interface: &Interface, step: &StepProgram) -> Layout {
    let module = &step.module;
    let fields = |kind| module.values.fields(kind).len();
    Layout::new(&Lengths {
        parameters: interface.parameter_length(),
        state: interface.state_length(),
        control: interface.control_length(),
        unknown: module.function(StepRole::Evaluate).map_or(0, |evaluate| evaluate.length(Input::Unknown)),
        constants: fields(RecordKind::Constants),
        step: fields(RecordKind::Step),
        iterate: fields(RecordKind::Iterate),
    })
}

fn step(all: &Arc<Program>, place: usize, interpreted: bool) -> Step {
    let (interface, program) = (&all.interface, &all.steps[place]);
    let module = &program.module;
    let layout = self::layout(interface, program);
    let mut frame = Frame::new(layout.scratch);
    let code = FUNCTIONS.map(|(_, role)| match module.function(role) {
        Some(function) => assembled(function, &InStep { layout: &layout, module, function }, &mut frame),
        None => Code::default(),
    });
    let frame = frame.numbers();
    let functions = Functions {
        interpreted: code,
        machine: (!interpreted).then(|| Machine::new(all.clone(), place, layout.clone())),
    };
    let schemes = std::iter::once(&program.scheme).chain(&program.aliases);
    let mut bytes = bytes::functions(module);
    Step {
        schemes: schemes.filter_map(step_named).collect(),
        blocks: program.blocks.clone(),
        has_domain: module.function(StepRole::Domain).is_some(),
        has_true_jacobian: program.has_true_jacobian,
        is_newton: program.is_newton,
        is_chord: program.is_chord,
        is_long: program.is_long,
        program: std::array::from_fn(|_| bytes.next().unwrap_or_default()),
        places: module.values.places(),
        frame,
        functions: Box::new(functions),
        derivative: program.derivative.as_ref().map(|module| Derivative::boxed(module, interface)),
        layout,
    }
}

/// The functions of a system.
struct InterpretedSystem(Vec<(SystemFunction, Plain)>);

/// A function of a system, with a frame of its own.
struct Plain {
    code: Code,
    frame: Vec<f64>,
    inputs: Vec<(Input, std::ops::Range<usize>)>,
    results: std::ops::Range<usize>,
}

struct InPlain<'a> {
    inputs: &'a [(Input, std::ops::Range<usize>)],
    results: Vec<usize>,
}

impl Places for InPlain<'_> {
    fn input(&self, input: Input) -> usize {
        self.inputs.iter().find(|(known, _)| *known == input).map_or(0, |(_, range)| range.start)
    }

    fn record(&self) -> (&[Value], usize) {
        (&[], 0)
    }

    fn result(&self, array: usize) -> usize {
        self.results[array]
    }
}

impl Plain {
    fn new(function: &Function<SystemRole>) -> Self {
        let mut end = 0;
        let mut take = |length: usize| {
            let start = end;
            end += length;
            start..end
        };
        let arguments = function.arguments.iter();
        let inputs: Vec<_> =
            arguments.map(|argument| (argument.input, take(argument.values.len()))).collect();
        let results: Vec<_> = function.results.iter().map(|array| take(array.len())).collect();
        let places = InPlain { inputs: &inputs, results: results.iter().map(|range| range.start).collect() };
        let results = results.first().map_or(0, |first| first.start)..end;
        let mut frame = Frame::new(end);
        let code = assembled(function, &places, &mut frame);
        Self { code, frame: frame.numbers(), inputs, results }
    }

    fn call(&self, given: &Given<'_>) -> Vec<f64> {
        let mut frame = self.frame.clone();
        for (input, range) in &self.inputs {
            let numbers = match input {
                Input::Parameters => given.parameters,
                Input::State => given.state,
                Input::Time => std::slice::from_ref(&given.time),
                Input::Control => given.control,
                Input::Velocity => given.velocity,
                Input::Tangent => given.tangent,
                _ => &[],
            };
            frame[range.clone()].iter_mut().zip(numbers).for_each(|(to, number)| *to = *number);
        }
        self.code.run::<1>(frame.as_chunks_mut().0);
        frame[self.results.clone()].to_vec()
    }
}

fn system_functions(program: &Program) -> InterpretedSystem {
    let pivots = (0..program.interface.inertias.len())
        .map(|place| (SystemFunction::Pivots(place), SystemRole::Pivots(place)));
    let displacements = scheme::Retraction::ALL
        .map(|map| (SystemFunction::Displacement(retraction(map)), SystemRole::Displacement(map)));
    let others = [
        (SystemFunction::Energy, SystemRole::Energy),
        (SystemFunction::Velocity, SystemRole::Velocity),
        (SystemFunction::VelocityNewton, SystemRole::VelocityNewton),
        (SystemFunction::Momentum, SystemRole::Momentum),
        (SystemFunction::MomentumNewton, SystemRole::MomentumNewton),
        (SystemFunction::Casimirs, SystemRole::Casimirs),
        (SystemFunction::Deviation, SystemRole::Deviation),
        (SystemFunction::Differential, SystemRole::Differential),
        (SystemFunction::HamiltonianVector, SystemRole::HamiltonianVector),
        (SystemFunction::Force, SystemRole::Force),
    ];
    let events = (0..program.interface.events.len())
        .map(|place| (SystemFunction::Event(place), SystemRole::Event(place)));
    let all = others.into_iter().chain(pivots).chain(displacements).chain(events);
    let there = all
        .filter_map(|(function, role)| program.function(role).map(|(_, code)| (function, Plain::new(code))));
    InterpretedSystem(there.collect())
}

impl InterpretedSystem {
    fn function(&self, function: SystemFunction) -> Option<&Plain> {
        self.0.iter().find(|(known, _)| *known == function).map(|(_, plain)| plain)
    }
}

impl SystemFunctions for InterpretedSystem {
    fn call(&self, function: SystemFunction, given: &Given<'_>) -> Option<Vec<f64>> {
        self.function(function).map(|plain| plain.call(given))
    }

    fn asks_for_velocity(&self, function: SystemFunction) -> bool {
        let asks = |plain: &Plain| plain.inputs.iter().any(|(input, _)| *input == Input::Velocity);
        self.function(function).is_some_and(asks)
    }
}
