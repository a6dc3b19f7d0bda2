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
//! * [Choosing retraction, method and order](choosing), and when structure pays
//! * [The mathematics](mathematics)
//!
//! **How to …**
//!
//! * … [move a body in space](rigid_motions): `SE3` and `SE2`, angular part first
//! * … [act on it](forces): forces, controls, control laws
//! * … [run it](running): to a time, until a condition, with observers, from a snapshot
//! * … [run many at once](ensembles)
//! * … [differentiate steps and runs](derivatives): control, estimation, identification
//! * … [write and read states](storing), and the two orders of a quaternion
//! * … [run without the standard library](embedded)
//! * … [choose the system while the program runs](erased)
//!
//! **Reference**
//!
//! * [The language of descriptions](language): every key, group, function and type
//! * [The generated code](reading)
//! * [The paper's equations](paper): where each method is, misprints, recipes
//!
//! How to read the figures is in the documentation of the crate `coadjoint-systems`: `coadjoint_systems::guide`.

pub mod beginning {
    #![doc = include_str!("guide/beginning.md")]
}

pub mod program {
    #![doc = include_str!("guide/program.md")]
}

// its code needs a crate that depends on this one, which compiles it
pub mod your_program {
    #![cfg_attr(not(doctest), doc = include_str!("guide/your_program.md"))]
}

pub mod groups {
    #![doc = include_str!("guide/groups.md")]
}

pub mod describing {
    #![doc = include_str!("guide/describing.md")]
}

pub mod energies {
    #![doc = include_str!("guide/energies.md")]
}

pub mod choosing {
    #![doc = include_str!("guide/choosing.md")]
}

pub mod mathematics {
    #![doc = include_str!("guide/mathematics.md")]
}

pub mod rigid_motions {
    #![doc = include_str!("guide/rigid_motions.md")]
}

pub mod forces {
    #![doc = include_str!("guide/forces.md")]
}

pub mod running {
    #![doc = include_str!("guide/running.md")]
}

pub mod ensembles {
    #![doc = include_str!("guide/ensembles.md")]
}

pub mod derivatives {
    #![doc = include_str!("guide/derivatives.md")]
}

pub mod storing {
    #![doc = include_str!("guide/storing.md")]
}

pub mod embedded {
    #![doc = include_str!("guide/embedded.md")]
}

pub mod erased {
    #![doc = include_str!("guide/erased.md")]
}

pub mod language {
    //! Everything a description may contain. [Describing a system](super::describing) says what it is for.
    //!
    #![doc = include_str!("guide/language.md")]
}

pub mod reading {
    #![doc = include_str!("guide/reading.md")]
}

pub mod paper {
    #![doc = include_str!("guide/paper.md")]
}
