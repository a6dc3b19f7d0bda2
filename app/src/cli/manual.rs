//! `coadjoint completions` and `coadjoint man`

use std::io::Write;

use clap::Args;
use clap_complete::Shell;

use crate::error::Error;

/// For which shell.
#[derive(Debug, Args)]
pub(crate) struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: Shell,
}

/// Prints a script that completes commands, options and the names of systems.
pub(crate) fn completions(
    mut parser: clap::Command,
    arguments: &CompletionsArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let name = parser.get_name().to_owned();
    // clap_complete panics where it cannot write
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut parser, name, &mut script);
    Ok(stdout.write_all(&script)?)
}

/// Prints the manual's page, of the program and of all its commands.
pub(crate) fn man(mut parser: clap::Command, stdout: &mut dyn Write) -> Result<(), Error> {
    parser.build();
    let name = parser.get_name().to_owned();
    clap_mangen::Man::new(parser.clone()).title(name.to_uppercase()).render(stdout)?;
    for command in parser.get_subcommands().filter(|command| command.get_name() != "help") {
        let page = clap_mangen::Man::new(command.clone());
        writeln!(stdout, ".SH \"{} {}\"", name.to_uppercase(), command.get_name().to_uppercase())?;
        page.render_description_section(stdout)?;
        page.render_options_section(stdout)?;
    }
    Ok(())
}
