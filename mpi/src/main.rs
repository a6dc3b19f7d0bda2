//! The program `coadjoint-mpi`: the catalogue's ensembles on the processes of an MPI job.

fn main() -> std::process::ExitCode {
    let app = coadjoint_app::App::new(coadjoint_systems::catalogue::entries());
    let about = "Runs ensembles of mechanical systems on the processes of an MPI job.";
    coadjoint_mpi::run(app.named("coadjoint", env!("CARGO_PKG_VERSION"), about))
}
