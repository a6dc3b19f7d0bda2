//! Ensembles on clusters: the processes of an MPI job share the members.
//!
//! ```no_run
//! use coadjoint::prelude::*;
//! use coadjoint_app::Example;
//!
//! /// A body on which nothing acts.
//! #[lie_poisson_system(group = SO3)]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! impl Example for Body {
//!     fn example() -> (Self, BodyState) {
//!         let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 1.0, 0.01] };
//!         (Body { inertia: vector![1.0, 2.0, 3.0] }, start)
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     coadjoint_mpi::main([Body::entry()])
//! }
//! ```
//!
//! Then `mpirun -n 4 target/release/my_program ensemble body --members 1e6`, with the arguments and the results of the
//! program without MPI, to the last byte. All other commands are run by the first rank alone.
//!
//! To build it, an MPI library with its headers and libclang are needed: on Debian `libopenmpi-dev` or `libmpich-dev`,
//! and `libclang-dev`. Where they are not found, `MPICC` names the compiler of the cluster's MPI, and `LIBCLANG_PATH`
//! the directory of `libclang.so`.
#![warn(clippy::print_stdout, clippy::print_stderr)]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use coadjoint_app::simulate::ensemble::{Ranks, Tag};
use coadjoint_app::{App, Entry};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, Source};
use mpi::{Rank, Threading};

/// Runs a program for these systems as a rank of an MPI job.
pub fn main(entries: impl IntoIterator<Item = Entry>) -> ExitCode {
    run(App::new(entries))
}

/// Runs a program as a rank of an MPI job: where one rank fails, its exit code is that of the job.
pub fn run(app: App) -> ExitCode {
    let Some((universe, _)) = mpi::initialize_with_threading(Threading::Funneled) else {
        return ExitCode::FAILURE;
    };
    let ranks = World(universe.world());
    start_threads(&ranks.0);
    // what a panic has to say is said by its hook
    let code = catch_unwind(AssertUnwindSafe(|| app.run_among(&ranks))).unwrap_or(1);
    if code != 0 && ranks.size() > 1 {
        // the others may wait for this one
        ranks.0.abort(code.into());
    }
    drop(universe);
    ExitCode::from(code)
}

/// All ranks of the job.
struct World(SimpleCommunicator);

impl Ranks for World {
    fn rank(&self) -> usize {
        usize::try_from(self.0.rank()).unwrap_or(0)
    }

    fn size(&self) -> usize {
        usize::try_from(self.0.size()).unwrap_or(1)
    }

    fn send(&self, to: usize, tag: Tag, message: &[u8]) {
        // ranks are numbers of MPI's own
        self.0.process_at_rank(to as Rank).send_with_tag(message, number(tag));
    }

    fn poll(&self, tag: Tag) -> Option<(usize, Vec<u8>)> {
        // one thread of the process receives, so that nobody else takes what was found
        let found = self.0.any_process().immediate_probe_with_tag(number(tag))?;
        let from = found.source_rank();
        let (bytes, _) = self.0.process_at_rank(from).receive_vec_with_tag::<u8>(number(tag));
        Some((usize::try_from(from).unwrap_or(0), bytes))
    }
}

fn number(tag: Tag) -> mpi::Tag {
    match tag {
        Tag::Plan => 1,
        Tag::Work => 2,
        Tag::Tally => 3,
    }
}

/// Starts the threads of this rank: the processors of a node are divided among its ranks, unless each is bound to some
/// of them, or `RAYON_NUM_THREADS` says how many.
fn start_threads(world: &SimpleCommunicator) {
    if std::env::var_os("RAYON_NUM_THREADS").is_some() {
        return;
    }
    let here = usize::try_from(world.split_shared(world.rank()).size()).unwrap_or(1).max(1);
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if is_bound() { processors } else { (processors / here).max(1) };
    // where they cannot be started, the program says so
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
}

/// Tells whether this process may run on some of the node's processors only; false where the system does not tell.
fn is_bound() -> bool {
    let own = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let own = own.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"));
    let all = std::fs::read_to_string("/sys/devices/system/cpu/online").unwrap_or_default();
    own.is_some_and(|own| !all.is_empty() && own.trim() != all.trim())
}
