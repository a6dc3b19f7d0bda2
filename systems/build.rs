//! Says how the program is linked.

use std::env::var;
use std::process::Command;

/// The first glibc that reads packed relocations: 2.36.
const FIRST: [u32; 2] = [2, 36];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Addresses in the program's tables, which are corrected where it is loaded, take a bit each in place of 24 bytes: 1.9 MB less. A loader that
    // cannot read them does not start the program, so that this is asked of the machine that builds it, for itself; linkers that cannot write them
    // say so and go on.
    let is_native = var("HOST").is_ok_and(|host| var("TARGET").is_ok_and(|target| host == target));
    if is_native && glibc().is_some_and(|version| version >= FIRST) {
        println!("cargo::rustc-link-arg-bins=-Wl,-z,pack-relative-relocs");
    }
}

/// The version of glibc, where that is the system's library.
fn glibc() -> Option<[u32; 2]> {
    let said = Command::new("getconf").arg("GNU_LIBC_VERSION").output().ok()?;
    let said = String::from_utf8(said.stdout).ok()?;
    let mut numbers = said.trim().strip_prefix("glibc ")?.split('.').map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
}
