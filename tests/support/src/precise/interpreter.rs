//! Runs programs with 71 digits.

use std::collections::HashMap;

use coadjoint_codegen::program::{DerivativeRole, FunctionRole, Input, Module, StepRole};

use crate::interpret::{Call as _, Given, Returned};

use super::matrix::Column;
use super::real::Real;

/// The arrays that the function of a role returns.
pub fn call<R: FunctionRole>(module: &Module<R>, role: R, given: &Given<Real>) -> Vec<Column> {
    arrays(module.call(role, given).unwrap_or_else(|error| panic!("{role:?}: {error}")))
}

fn arrays(returned: Returned<Real>) -> Vec<Column> {
    returned.results.into_iter().map(Column).collect()
}

/// What one call of each of a step's functions gives, called in the order of a step.
pub struct Stages {
    /// The first approximation of the unknown.
    pub start: Column,
    /// `left − right`
    pub residual: Column,
    /// The equation's right side.
    pub right: Column,
    /// The Newton correction.
    pub correction: Column,
    /// The next iterate of the fixed-point iteration, where there is one.
    pub update: Option<Column>,
    /// The distances to the edges of the domain.
    pub margins: Column,
    /// The next state.
    pub next: Column,
}

/// Calls the function of a role and adds the record that it returns to what is given.
fn with_record<R: FunctionRole>(
    module: &Module<R>,
    role: R,
    given: Given<Real>,
) -> (Vec<Column>, Given<Real>) {
    let returned = module.call(role, &given).unwrap_or_else(|error| panic!("{role:?}: {error}"));
    let (kind, fields) = returned.record.clone().expect("a record");
    (arrays(returned), given.with(Input::Record(kind), fields))
}

/// Calls all functions of a step. `given` holds parameters, step size, state, time, controls and unknown.
pub fn stages(module: &Module<StepRole>, given: &Given<Real>) -> Stages {
    let (_, given) = with_record(module, StepRole::New, given.clone());
    let (_, given) = with_record(module, StepRole::Begin, given);
    let one = |role, given: &Given<Real>| {
        let mut arrays = call(module, role, given);
        assert_eq!(arrays.len(), 1);
        arrays.remove(0)
    };
    let maybe = |role, given: &Given<Real>| module.function(role).map(|_| one(role, given));
    let start = one(StepRole::Start, &given);
    let (evaluation, given) = with_record(module, StepRole::Evaluate, given);
    let [residual, right] = &evaluation[..] else { panic!("residual and right side") };
    let given = given.with(Input::Residual, residual.0.clone()).with(Input::Right, right.0.clone());
    Stages {
        start,
        residual: residual.clone(),
        right: right.clone(),
        correction: one(StepRole::Correction, &given),
        update: maybe(StepRole::FixedPointUpdate, &given),
        margins: maybe(StepRole::Domain, &given).unwrap_or_else(|| Column(Vec::new())),
        next: one(StepRole::Finish, &given),
    }
}

/// The linear maps of a derivative: products and matrices, at one point.
pub fn linear_maps(
    module: &Module<DerivativeRole>,
    given: &Given<Real>,
) -> HashMap<DerivativeRole, Vec<Column>> {
    let (_, given) = with_record(module, DerivativeRole::Point, given.clone());
    let maps =
        module.functions.iter().map(|function| function.role).filter(|role| *role != DerivativeRole::Point);
    maps.map(|role| (role, call(module, role, &given))).collect()
}
