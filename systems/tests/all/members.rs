//! Members of ensembles whose steps are long, and choose with which weights earlier solutions predict, move as they would alone.

use std::sync::Arc;

use coadjoint::ensemble::Instructions;
use coadjoint::erased::{self, EnsembleSystem, System};
use coadjoint_dynamic::Model;
use coadjoint_systems::catalogue::CATALOGUE;

const MEMBERS: usize = 17;
const STEPS: usize = 600;

/// Slow motion, whose solutions are hardly more than rounding, faster one, and controls that jump for a while.
fn felt(member: usize, step: usize) -> [f64; 6] {
    let is_jumping = member % 4 == 3 && step / 70 % 2 == 1;
    let jump = if is_jumping { 1e-4 * ((step * step) % 7) as f64 } else { 0.0 };
    let turning = if member % 3 == 1 { 3.0 } else { 0.1 };
    [0.0, 0.0, turning, jump, 0.1 * member as f64, 9.81]
}

#[test]
fn members_of_long_steps_move_as_alone() {
    let entry = CATALOGUE.system("navigation").expect("it is there");
    let typed = entry.system(&entry.example.parameters);
    let model = Model::from_text(entry.source).unwrap_or_else(|error| panic!("{error}"));
    let dynamic: Arc<dyn EnsembleSystem> = Arc::new(model.system(&typed.parameters()));
    let scheme = "Cayley".parse().expect("a scheme");
    let state = |member: usize| {
        let mut state = entry.example.state.clone();
        if let Some(last) = state.last_mut() {
            *last += 0.01 * member as f64;
        }
        state
    };
    let alone: Vec<Vec<f64>> = (0..MEMBERS)
        .map(|member| {
            let system = typed.clone() as Arc<dyn System>;
            let mut stepper = erased::Stepper::new(system, &scheme, 0.01).expect("steps");
            let mut state = state(member);
            for step in 0..STEPS {
                if step % 97 == 50 {
                    // its memory, the choice among it, is taken up anew
                    let (memory, system) = (stepper.snapshot(), typed.clone() as Arc<dyn System>);
                    stepper = erased::Stepper::new(system, &scheme, 0.01).expect("steps");
                    stepper.restore(&memory).expect("its own");
                }
                stepper.step(&mut state, &felt(member, step)).expect("a step");
            }
            state
        })
        .collect();
    for system in [&typed, &dynamic] {
        for instructions in Instructions::available() {
            let members = (0..MEMBERS).map(|member| (typed.parameters(), state(member)));
            let mut ensemble =
                erased::Ensemble::with_instructions(&**system, &scheme, members, 0.01, instructions)
                    .expect("an ensemble");
            for step in 0..STEPS {
                ensemble.control(|member, _, control| control.copy_from_slice(&felt(member, step)));
                ensemble.run(1);
            }
            assert!(ensemble.failed().is_empty(), "{instructions:?}");
            for (member, _, together) in ensemble.members() {
                assert_eq!(together, alone[member], "member {member}, {instructions:?}");
            }
        }
    }
}
