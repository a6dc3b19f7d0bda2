//! The standard cases of the benchmarks: what steps cost, ours and others'.
//!
//! The free rigid body and the heavy top are the paper's, with principal moments 1, 10 and 100 and steps of 0.01 s.

use std::fmt;
use std::hint::black_box;

use crate::classical::generic::{GenericStepper, Hamiltonian, MatrixRetraction, SO3, SO3Semidirect};
use coadjoint::ensemble::Instructions;
use coadjoint::nalgebra::{Matrix4, SMatrix, SVector, Vector6};
use coadjoint::prelude::*;
use coadjoint::{Control, Discretized, Ensemble, State, System};

use crate::classical::{AttitudeState, Rk4Quaternion, Rkmk4, Timed, bodies};
use crate::coupled_bodies::CoupledBodies;
use crate::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use crate::heavy_top::HeavyTop;
use crate::quadrotor::Quadrotor;
use coadjoint_app::Example;

/// One benchmark case.
pub struct Case {
    /// The system.
    pub problem: &'static str,
    /// The integrator.
    pub method: String,
    /// Steps that are enough to be timed.
    pub steps: u64,
    run: Box<dyn FnMut(u64) -> bool>,
}

impl Case {
    /// Takes so many steps, on from where the last ones led; whether all could be taken.
    pub fn run(&mut self, steps: u64) -> bool {
        (self.run)(steps)
    }
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Case")
            .field("problem", &self.problem)
            .field("method", &self.method)
            .finish_non_exhaustive()
    }
}

/// The baseline of each problem: the integrator most people would write.
pub const BASELINE: &str = Rk4Quaternion::NAME;

/// The members of the ensembles.
const MEMBERS: usize = 256;

/// All cases, those of one problem together.
///
/// # Errors
/// If a stepper cannot be built, which would be a bug.
pub fn all() -> Result<Vec<Case>, Box<dyn std::error::Error>> {
    const FREE: &str = "free_rigid_body";
    const TOP: &str = "heavy_top";
    let body = FreeRigidBody { inertia: vector![1.0, 10.0, 100.0] };
    let start = FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    let (top, top_start) = HeavyTop::example();
    let lever = top.weight * top.chi;

    let plain = bodies::RigidBody::new(body.inertia);
    let at = AttitudeState { attitude: start.attitude, y: start.momentum };
    let heavy = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
    let (m, gamma) = (top_start.momentum, top_start.gamma);
    let y: Vector6<f64> = vector![m.x, m.y, m.z, gamma.x, gamma.y, gamma.z];
    let heavy_at = AttitudeState { attitude: top_start.attitude, y };

    let mut cases = vec![classical(FREE, Rk4Quaternion, plain, at), classical(FREE, Rkmk4, plain, at)];
    cases.extend(ours_of_order_2(FREE, &body, &start)?);
    cases.extend(from_new_states(FREE, &body, &start)?);
    cases.push(classical_from_new_states(FREE, Rk4Quaternion, plain, at));
    cases.extend([
        ours(FREE, "Cayley, order 4", at_once::<_, Order4<Cayley>>, &body, start)?,
        ours(FREE, "Cayley, order 6", at_once::<_, Order6<Cayley>>, &body, start)?,
        ours(FREE, "Cayley, order 8", at_once::<_, Order8<Cayley>>, &body, start)?,
        ours(FREE, "Cayley, order 10", at_once::<_, Order10<Cayley>>, &body, start)?,
        generic(
            FREE,
            "Cayley, generic stepper",
            SO3,
            Cayley,
            Quadratic { inertia: body.inertia, lever: None },
            start.momentum,
            SMatrix::identity(),
        )?,
        generic(
            FREE,
            "exponential, generic stepper",
            SO3,
            Exponential,
            Quadratic { inertia: body.inertia, lever: None },
            start.momentum,
            SMatrix::identity(),
        )?,
    ]);
    cases.extend([classical(TOP, Rk4Quaternion, heavy, heavy_at), classical(TOP, Rkmk4, heavy, heavy_at)]);
    cases.extend(ours_of_order_2(TOP, &top, &top_start)?);
    cases.extend(from_new_states(TOP, &top, &top_start)?);
    cases.push(classical_from_new_states(TOP, Rk4Quaternion, heavy, heavy_at));
    cases.extend([
        generic(
            TOP,
            "Cayley, generic stepper",
            SO3Semidirect::<1>,
            Cayley,
            Quadratic { inertia: top.inertia, lever: Some(lever) },
            y,
            Matrix4::identity(),
        )?,
        generic(
            TOP,
            "exponential, generic stepper",
            SO3Semidirect::<1>,
            Exponential,
            Quadratic { inertia: top.inertia, lever: Some(lever) },
            y,
            Matrix4::identity(),
        )?,
    ]);
    for config in configs() {
        cases.extend(ensembles(FREE, &body, &start, &config)?);
        cases.extend(ensembles(TOP, &top, &top_start, &config)?);
    }
    cases.sort_by_key(|case| case.problem);
    let (quadrotor, loose) = Quadrotor::example();
    cases.push(ours("quadrotor", "Cayley", at_once::<_, Cayley>, &quadrotor, loose)?);
    cases.push(ours("quadrotor", "exponential", at_once::<_, Exponential>, &quadrotor, loose)?);
    cases.extend(jumping(&quadrotor, &Quadrotor::example().1)?);
    let (coupled, still) = CoupledBodies::example();
    cases.push(ours("coupled_bodies", "Cayley", at_once::<_, Cayley>, &coupled, still)?);
    cases.push(ours("coupled_bodies", "exponential", at_once::<_, Exponential>, &coupled, still)?);
    Ok(cases)
}

/// Generated steps of order 2, in every way that they are taken.
fn ours_of_order_2<S>(
    problem: &'static str,
    system: &S,
    state: &S::State,
) -> Result<[Case; 6], ParameterError>
where
    S: Example + Discretized<Cayley> + Discretized<Exponential>,
{
    Ok([
        ours(problem, "Cayley", at_once::<_, Cayley>, system, state.clone())?,
        ours(problem, "exponential", at_once::<_, Exponential>, system, state.clone())?,
        ours(problem, "Cayley, one by one", one_by_one::<_, Cayley>, system, state.clone())?,
        ours(problem, "exponential, one by one", one_by_one::<_, Exponential>, system, state.clone())?,
        ours(problem, "Cayley, fused", at_once::<_, Fused<Cayley>>, system, state.clone())?,
        ours(problem, "exponential, fused", at_once::<_, Fused<Exponential>>, system, state.clone())?,
    ])
}

/// Generated steps, run by this function, with the control that the system's law chooses at the start.
fn ours<S, M>(
    problem: &'static str,
    method: &str,
    run: RunFn<S, M>,
    system: &S,
    mut state: S::State,
) -> Result<Case, ParameterError>
where
    S: Example + Discretized<M>,
    M: 'static,
{
    let mut stepper = system.stepper::<M>(0.01)?;
    let control = system.control(&state, 0.0);
    let run = move |steps| run(&mut stepper, &mut state, &control, steps);
    Ok(Case { problem, method: method.into(), steps: 20_000, run: Box::new(run) })
}

/// Takes so many steps; whether all could be taken.
type RunFn<S, M> = fn(&mut Stepper<S, M>, &mut <S as System>::State, &<S as System>::Control, u64) -> bool;

/// All of them in one call.
fn at_once<S, M>(stepper: &mut Stepper<S, M>, state: &mut S::State, control: &S::Control, steps: u64) -> bool
where
    S: Discretized<M>,
{
    stepper.steps_with(state, control, steps).is_ok()
}

/// One call for each.
fn one_by_one<S, M>(
    stepper: &mut Stepper<S, M>,
    state: &mut S::State,
    control: &S::Control,
    steps: u64,
) -> bool
where
    S: Discretized<M>,
{
    (0..steps).all(|_| stepper.step_with(state, control).is_ok())
}

/// How an ensemble is run.
struct BenchConfig {
    name: String,
    instructions: Instructions,
    threads: usize,
}

/// By all instructions that the processor has, on one of its cores, and by the widest on two.
fn configs() -> Vec<BenchConfig> {
    let config = |instructions| BenchConfig {
        name: format!("{instructions:?}").to_lowercase(),
        instructions,
        threads: 1,
    };
    let mut configs: Vec<BenchConfig> = Instructions::available().map(config).collect();
    if let (Some(&BenchConfig { ref name, instructions, .. }), 2..) =
        (configs.last(), rayon::current_num_threads())
    {
        configs.push(BenchConfig { name: format!("{name}, two cores"), instructions, threads: 2 });
    }
    configs
}

/// Steps of an ensemble's members; fused where there are instructions for it.
fn ensembles<S>(
    problem: &'static str,
    system: &S,
    state: &S::State,
    config: &BenchConfig,
) -> Result<Vec<Case>, Box<dyn std::error::Error>>
where
    S: Example + Discretized<Cayley> + Discretized<Exponential>,
{
    let mut cases = vec![
        ensemble_case::<_, Cayley>(problem, "Cayley", system, state, config)?,
        ensemble_case::<_, Exponential>(problem, "exponential", system, state, config)?,
    ];
    if config.instructions != Instructions::Portable {
        cases.push(ensemble_case::<_, Fused<Cayley>>(problem, "Cayley, fused", system, state, config)?);
        cases.push(ensemble_case::<_, Fused<Exponential>>(
            problem,
            "exponential, fused",
            system,
            state,
            config,
        )?);
    }
    Ok(cases)
}

/// A step of a member of an ensemble.
fn ensemble_case<S, M>(
    problem: &'static str,
    method: &str,
    system: &S,
    state: &S::State,
    config: &BenchConfig,
) -> Result<Case, Box<dyn std::error::Error>>
where
    S: Example + Discretized<M>,
    M: 'static,
{
    let states = spread(state, MEMBERS);
    let systems = std::iter::repeat(system);
    let mut ensemble = Ensemble::<S, M>::with_instructions(systems, states, 0.01, config.instructions)?;
    let threads = rayon::ThreadPoolBuilder::new().num_threads(config.threads).build()?;
    let method = format!("{method}, ensemble, {}", config.name);
    let run = move |steps: u64| {
        let steps = steps.div_ceil(MEMBERS as u64);
        threads.install(|| ensemble.run(steps));
        ensemble.failed().is_empty()
    };
    Ok(Case { problem, method, steps: 12_000 * MEMBERS as u64, run: Box::new(run) })
}

/// So many states that differ from each other in their momenta.
fn spread<S: State<Scalar = f64>>(state: &S, count: usize) -> Vec<S> {
    let states = (0..count).map(|member| {
        let mut components = state.to_components();
        for (k, (quantity, slot)) in places(S::QUANTITIES).enumerate() {
            if quantity == coadjoint::system::Role::Momentum {
                components.as_mut()[slot] *= 1.0 + 1e-4 * (member * (k + 1)) as f64;
            }
        }
        S::from_components(&components)
    });
    states.collect()
}

/// The states that short runs start from, one after the other.
const NEW: usize = 64;

/// Short runs, each from a new state: single steps, and as many as model-predictive control takes.
fn from_new_states<S>(
    problem: &'static str,
    system: &S,
    state: &S::State,
) -> Result<Vec<Case>, ParameterError>
where
    S: Example + Discretized<Cayley> + Discretized<Exponential>,
{
    let mut cases = Vec::new();
    for length in [1, 20, 200] {
        cases.push(rollouts::<_, Cayley>(problem, "Cayley", system, state, length)?);
        cases.push(rollouts::<_, Exponential>(problem, "exponential", system, state, length)?);
    }
    Ok(cases)
}

fn rollouts<S, M>(
    problem: &'static str,
    method: &str,
    system: &S,
    state: &S::State,
    length: u64,
) -> Result<Case, ParameterError>
where
    S: Example + Discretized<M>,
    M: 'static,
{
    let mut stepper = system.stepper::<M>(0.01)?;
    let (states, control) = (spread(state, NEW), system.control(state, 0.0));
    let run = move |steps: u64| {
        states.iter().cycle().take((steps / length) as usize).all(|from| {
            let mut state = black_box(from).clone();
            let taken = if length == 1 {
                stepper.step_with(&mut state, &control).is_ok()
            } else {
                stepper.steps_with(&mut state, &control, length).is_ok()
            };
            black_box(&state);
            taken
        })
    };
    Ok(Case { problem, method: format!("{method}, {}", called(length)), steps: 8_000, run: Box::new(run) })
}

/// What a run of so many steps from a new state is called.
fn called(length: u64) -> String {
    if length == 1 {
        "each step from a new state".to_owned()
    } else {
        format!("{length} steps from each new state")
    }
}

/// The same of a classical integrator's single steps.
fn classical_from_new_states<I, S, const N: usize>(
    problem: &'static str,
    integrator: I,
    system: S,
    state: AttitudeState<N>,
) -> Case
where
    I: Timed<S, AttitudeState<N>> + 'static,
    S: 'static,
{
    let method = format!("{}, {}", integrator.name(), called(1));
    let run = move |steps: u64| {
        (0..steps).all(|step| {
            let mut from = state;
            from.y *= 1.0 + 1e-4 * (step % NEW as u64) as f64;
            black_box(integrator.run(&system, black_box(from), 0.01, 1)).is_ok()
        })
    };
    Case { problem, method, steps: 8_000, run: Box::new(run) }
}

/// Steps of which each has a control of its own, that jumps by so much of its unit, or by nothing.
fn jumping(system: &Quadrotor, state: &<Quadrotor as System>::State) -> Result<Vec<Case>, ParameterError> {
    let cases = [0.0, 1e-9, 1e-6, 1e-3, 0.1].map(|size| {
        let mut stepper = system.stepper::<Cayley>(0.01)?;
        let (from, law) = (*state, system.control(state, 0.0).to_components());
        let controls: Vec<_> = (0..1_000_u32)
            .map(|k| {
                let mut components = law;
                for (component, i) in components.as_mut().iter_mut().zip(1_u32..) {
                    // between −1 and 1, with no pattern
                    *component += size * (2.0 * (f64::from(k * i + i) * 0.618_033_988_75).fract() - 1.0);
                }
                <Quadrotor as System>::Control::from_components(&components)
            })
            .collect();
        let run = move |steps: u64| {
            let mut state = from;
            let mut controls = controls.iter().cycle().take(steps as usize);
            let taken = controls.all(|control| stepper.step_with(&mut state, control).is_ok());
            black_box(&state);
            taken
        };
        let method = format!("Cayley, one by one, controls that jump by {size:e}");
        Ok(Case { problem: "quadrotor", method, steps: 8_000, run: Box::new(run) })
    });
    cases.into_iter().collect()
}

/// The role of each component of a state, and its place.
fn places(
    quantities: &'static [coadjoint::system::Quantity],
) -> impl Iterator<Item = (coadjoint::system::Role, usize)> {
    quantities.iter().flat_map(|quantity| quantity.components.iter().map(|_| quantity.role)).zip(0..)
}

fn classical<I, S, const N: usize>(
    problem: &'static str,
    integrator: I,
    system: S,
    mut state: AttitudeState<N>,
) -> Case
where
    I: Timed<S, AttitudeState<N>> + 'static,
    S: 'static,
{
    let method = integrator.name().into();
    let run = move |steps| match integrator.run(&system, state, 0.01, steps) {
        Ok(end) => {
            state = end;
            true
        }
        Err(_) => false,
    };
    Case { problem, method, steps: 20_000, run: Box::new(run) }
}

/// A body with or without a weight.
struct Quadratic {
    inertia: Vector3<f64>,
    /// Weight times the vector from the fixed point to the centre of mass.
    lever: Option<Vector3<f64>>,
}

impl<const D: usize> Hamiltonian<D> for Quadratic {
    fn energy(&self, mu: &SVector<f64, D>) -> f64 {
        let momentum = mu.fixed_rows::<3>(0);
        let weight = self.lever.map_or(0.0, |lever| mu.fixed_rows::<3>(3).dot(&lever));
        momentum.dot(&momentum.component_div(&self.inertia)) / 2.0 + weight
    }

    fn gradient(&self, mu: &SVector<f64, D>) -> SVector<f64, D> {
        let velocity = mu.fixed_rows::<3>(0).component_div(&self.inertia);
        SVector::from_iterator(velocity.iter().chain(self.lever.iter().flatten()).copied())
    }
}

#[allow(clippy::too_many_arguments, reason = "all that a generic stepper needs")]
fn generic<G, R, const N: usize, const D: usize>(
    problem: &'static str,
    method: &str,
    group: G,
    retraction: R,
    hamiltonian: Quadratic,
    mut mu: SVector<f64, D>,
    mut g: SMatrix<f64, N, N>,
) -> Result<Case, ParameterError>
where
    G: crate::classical::generic::MatrixGroup<N, D> + 'static,
    R: MatrixRetraction<G, N, D> + 'static,
{
    let mut stepper = GenericStepper::new(group, retraction, hamiltonian, 0.01)?;
    let run = move |steps| (0..steps).all(|_| stepper.step(&mut g, &mut mu).is_ok());
    Ok(Case { problem, method: method.into(), steps: 500, run: Box::new(run) })
}
