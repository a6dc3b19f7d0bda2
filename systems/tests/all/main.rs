//! The tests of the systems and of the program, in one binary: it is linked once.

/// One test for each entry of the catalogue, so that they run side by side: each calls the function with its entry's name.
macro_rules! entries {
    ($check:ident) => {
        entries! {
            $check:
            harmonic_oscillator
            kepler
            two_bodies
            planar_pendulum
            double_pendulum
            driven_pendulum
            spherical_pendulum
            free_rigid_body
            full_rigid_body
            heavy_top
            lagrange_top
            kovalevskaya_top
            heavy_top_on_se3
            magnetic_top
            quadrotor
            hovering_quadrotor
            rigid_body_in_space
            hanging_plate
            gyrostat
            satellite_with_wheels
            coupled_bodies
            kirchhoff
            ellipsoidal_fluid
            nuclear_spin
            spin_chain
            four_dimensional_body
            affine_body
            navigation
            three_level_atom
        }
    };
    ($check:ident: $($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                $check(stringify!($name));
            }
        )*

        #[test]
        fn no_entry_is_left_out() {
            let names: Vec<&str> =
                coadjoint_systems::catalogue::CATALOGUE.entries().iter().map(|entry| entry.name.as_str()).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

/// Whether a system's text asks for a method: the midpoint costs as much to compile as all others of a large group.
fn is_asked_for(entry: &coadjoint_app::Entry, method: coadjoint_app::setup::Method) -> bool {
    method != coadjoint_app::setup::Method::MIDPOINT || entry.source.contains("methods(Midpoint")
}

mod applications;
mod catalogue;
mod certificates;
mod classical;
mod cli;
mod conservation;
mod dynamic;
mod groups;
mod hostile;
mod inputs;
mod members;
mod physics;
mod textbooks;
mod three_levels;
