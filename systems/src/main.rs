//! The program `coadjoint`.

use std::process::ExitCode;

fn main() -> ExitCode {
    coadjoint_systems::cli::main()
}
