//! The guide, one page for each question. Every example is compiled and run by the tests.
//!
//! **Getting started**
//!
//! * [From nothing to a system of your own](beginning), in ten minutes
//! * [The program](program): run, plot and view the systems of the catalogue
//! * [A program of your own](your_program), with all of that, for your systems
//!
//! **Concepts**
//!
//! * [Describing a system](describing): group, inertia, potential, advected parameters
//! * [Groups of your own](groups): from a basis, or made of other groups
//! * [Any energy](energies): Hamiltonians and Lagrangians
//! * [Spheres and round bodies](spheres): directions, spins, pendulums
//! * [Choosing retraction, method and order](choosing), and when structure pays
//! * [Choosing a step](step_size), and where the time scale changes
//! * [Trajectories to many digits](taylor): Taylor steps to a tolerance, and which method when
//! * [The mathematics](mathematics)
//!
//! **How to …**
//!
//! * … [move a body in space](rigid_motions): `SE3` and `SE2`, angular part first
//! * … [act on it](forces): forces, controls, control laws
//! * … [run it](running): to a time, until a condition, with observers, from a snapshot
//! * … [find events](events), and states between the steps
//! * … [run many at once](ensembles)
//! * … [run millions](clusters), on a cluster: shards, MPI, checkpoints
//! * … [differentiate steps and runs](derivatives): control, estimation, identification
//! * … [write and read states](storing), and the two orders of a quaternion
//! * … [run without the standard library](embedded)
//! * … [take steps in C](headers), on a microcontroller or a GPU
//! * … [choose the system while the program runs](erased)
//! * … [read a system from a text](at_run_time), with no compiler
//! * … [do all of that from Python](python)
//!
//! **Reference**
//!
//! * [The language of descriptions](language): every key, group, function and type
//! * [The generated code](reading)
//! * [The paper's equations](paper): where each method is, misprints, recipes
//!
//! How to read the figures is in the documentation of the crate `coadjoint-systems`: `coadjoint_systems::guide`.

/// A page is a file of its name.
macro_rules! pages {
    ($($page:ident),*) => {
        $(pub mod $page {
            #![doc = include_str!(concat!("guide/", stringify!($page), ".md"))]
        })*
    };
}
pages![
    beginning,
    program,
    describing,
    groups,
    energies,
    spheres,
    choosing,
    step_size,
    taylor,
    mathematics,
    rigid_motions,
    forces,
    running,
    events,
    ensembles,
    clusters,
    derivatives,
    storing,
    embedded,
    headers,
    erased,
    python,
    reading,
    paper
];

// their code needs crates that depend on this one, which compile it
pub mod at_run_time {
    #![cfg_attr(not(doctest), doc = include_str!("guide/at_run_time.md"))]
}

pub mod your_program {
    #![cfg_attr(not(doctest), doc = include_str!("guide/your_program.md"))]
}

pub mod language {
    //! Everything a description may contain. [Describing a system](super::describing) says what it is for.
    //!
    #![doc = include_str!("guide/language.md")]
}
