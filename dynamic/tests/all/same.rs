//! Steps of systems made of texts against those that the macro makes of the same tokens.

use std::sync::Arc;

use coadjoint::erased::{self, EnsembleSystem, System};
use coadjoint::prelude::*;
use coadjoint_dynamic::Model;

/// Items, and their text.
macro_rules! described {
    ($text:ident: $($tokens:tt)*) => {
        $($tokens)*
        const $text: &str = stringify!($($tokens)*);
    };
}

described! { HEAVY_TOP:
    #[lie_poisson_system(
        group = SO3,
        advected(gamma: R3),
        potential = weight * gamma.dot(&chi),
        methods(Midpoint),
        retractions(Exponential, Cayley, SecondKind),
    )]
    pub struct HeavyTop {
        #[inertia]
        pub inertia: Vector3<f64>,
        pub weight: f64,
        pub chi: Vector3<f64>,
    }
}

/// What both say of a scheme after some steps: states, and reports.
fn same(typed: Arc<dyn EnsembleSystem>, text: &str, schemes: &[&str], state: &[f64], step: f64) {
    let model = Model::from_text(text).unwrap_or_else(|error| panic!("{error}"));
    let dynamic: Arc<dyn EnsembleSystem> = Arc::new(model.system(&typed.parameters()));
    assert_eq!(format!("{:?}", typed.description()), format!("{:?}", dynamic.description()));
    for scheme in schemes {
        let scheme = scheme.parse().unwrap();
        let run = |system: &Arc<dyn EnsembleSystem>| {
            let system: Arc<dyn System> = system.clone();
            let mut stepper = erased::Stepper::new(system, &scheme, step).unwrap();
            let mut state = state.to_vec();
            let report = stepper.steps(&mut state, &[], 300).unwrap();
            (state, format!("{report:?}"))
        };
        assert_eq!(run(&typed), run(&dynamic), "{scheme}");
    }
}

#[test]
fn heavy_top() {
    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
    let state = [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0];
    same(Arc::new(top), HEAVY_TOP, &["Cayley", "Exponential", "Midpoint<Cayley>"], &state, 0.01);
}
