//! Writes the descriptions found in source files to a directory, one file each: `seeds DIRECTORY FILE…`

use std::path::PathBuf;

use coadjoint_fuzz::{Description, descriptions};

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args_os().skip(1);
    let directory = PathBuf::from(arguments.next().expect("usage: seeds DIRECTORY FILE…"));
    for path in arguments.map(PathBuf::from) {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        for (i, found) in descriptions(&std::fs::read_to_string(&path)?).into_iter().enumerate() {
            let Description { attribute, item } = found;
            let text = format!("#[lie_poisson_system({attribute})]\n{item}\n");
            std::fs::write(directory.join(format!("{stem}-{i}.rs")), text)?;
        }
    }
    Ok(())
}
