//! A system may be called what the generated code calls something else, and come out of a user's own macro.

macro_rules! system {
    ($module:ident, $name:ident, $state:ident $(, $derivatives:ident)?) => {
        mod $module {
            use coadjoint::nalgebra::Vector3;

            #[coadjoint::lie_poisson_system(
                group = SO3,
                advected(gamma: R3),
                potential = weight * gamma.x,
                retractions(Cayley)
                $(, $derivatives)?
            )]
            #[derive(Clone, Debug)]
            pub struct $name {
                #[inertia]
                pub inertia: Vector3<f64>,
                pub weight: f64,
            }

            #[test]
            fn works() {
                let system = $name { inertia: Vector3::new(1.0, 2.0, 3.0), weight: 1.0 };
                let state = $state {
                    attitude: crate::hygiene::rotation(),
                    momentum: Vector3::new(1.0, 2.0, 3.0),
                    gamma: Vector3::z(),
                };
                crate::hygiene::drive_with::<_, coadjoint::Cayley>(&system, &state);
                assert_eq!(<$name as coadjoint::System>::NAME, stringify!($name).trim_start_matches("r#"));
            }
        }
    };
}
system!(step, Step, StepState, derivatives);
system!(iterate, Iterate, IterateState);
system!(kernel, Kernel, KernelState, derivatives);
system!(scalar, Scalar, ScalarState, derivatives);
system!(evaluation, Evaluation, EvaluationState);
system!(state, State, StateState);
system!(the_system, System, SystemState, derivatives);
system!(discretized, Discretized, DiscretizedState);
system!(t, T, TState, derivatives);
system!(point, Point, PointState, derivatives);
system!(linearized, Linearized, LinearizedState, derivatives);
system!(result, Result, ResultState);
system!(vector, Vec, VecState);
system!(cayley, Cayley, CayleyState);
system!(raw, r#Self_, Self_State);
