//! The command line.

mod certify;
pub mod console;
mod description;
mod ensemble;
mod init;
mod interrupt;
mod list;
#[cfg(feature = "manual")]
mod manual;
mod merge;
mod motion;
mod open;
mod play;
pub mod progress;
pub mod report;
mod run;
mod scan;
pub mod session;
#[cfg(feature = "show")]
mod show;

use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use run::RunArguments;

use crate::catalogue::{Catalogue, Entry, set_program};
use crate::error::{Error, FileError, RunError};
use crate::simulate::ensemble::{Alone, Ranks};
use crate::units::printable;

/// The meaning of exit codes.
const EXIT_CODES: &str = "\
Exit codes:
  0    all went well
  1    a claim of a scheme does not hold, or a bug
  2    the input is wrong: the message says what is right
  3    the motion cannot be computed
  4    the output cannot be written
  130  ended by Ctrl-C; what was computed is written";

/// Runs structure-preserving steppers of mechanical systems.
#[derive(Debug, Parser)]
#[command(version, after_help = EXIT_CODES)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the systems, or tell all about one
    List(list::ListArguments),
    /// Run a system and write its trajectory
    Run(run::RunArguments),
    /// Go on with a run that was interrupted
    Resume(run::ResumeArguments),
    /// Run a system and write a page that shows it moving
    View(run::ViewArguments),
    /// Write a page that shows data of any program's moving
    Play(play::PlayArguments),
    /// Write a file that describes a run, for `run --config`
    Init(init::InitArguments),
    /// Run many members of a system, and draw how they spread
    Ensemble(ensemble::EnsembleArguments),
    /// Make one ensemble of its shards
    Merge(merge::MergeArguments),
    /// Print the code generated for a system
    #[cfg(feature = "show")]
    Show(show::ShowArguments),
    /// Measure what the schemes claim of their steps of a system
    Certify(certify::CertifyArguments),
    /// Print a script that completes commands in a shell
    #[cfg(feature = "manual")]
    Completions(manual::CompletionsArguments),
    /// Print the manual's page
    #[cfg(feature = "manual")]
    Man,
}

/// Runs a command of the program's own.
type RunFn = Box<dyn Fn(&Catalogue, &ArgMatches, &mut dyn Write) -> Result<(), Error>>;

/// A program for some systems: [`main`](crate::main), with commands of its own.
#[must_use]
pub struct App {
    catalogue: Catalogue,
    commands: Vec<(clap::Command, RunFn)>,
    /// What `--help` begins with.
    about: Option<&'static str>,
    default: Option<&'static str>,
}

impl std::fmt::Debug for App {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("App").field("catalogue", &self.catalogue).finish_non_exhaustive()
    }
}

impl App {
    /// A program for these systems.
    pub fn new(entries: impl IntoIterator<Item = Entry>) -> Self {
        Self { catalogue: Catalogue::new(entries), commands: Vec::new(), about: None, default: None }
    }

    /// With a name, a version and a line about it: its files name the first two, and `--help` and `--version` show them.
    /// As in `named(env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"), "points a satellite")`.
    pub fn named(self, name: &'static str, version: &'static str, about: &'static str) -> Self {
        set_program(name, version);
        Self { about: Some(about), ..self }
    }

    /// With one more command, of this name, with a line about it: what runs it gets its arguments, and writes to the
    /// console.
    pub fn command<A: clap::Args + 'static>(
        mut self,
        name: &'static str,
        about: &'static str,
        run: fn(&Catalogue, &A, &mut dyn Write) -> Result<(), Error>,
    ) -> Self {
        let command = A::augment_args(clap::Command::new(name)).about(about);
        let run: RunFn = Box::new(move |catalogue, matches, console| {
            let arguments = A::from_arg_matches(matches).unwrap_or_else(|error| error.exit());
            run(catalogue, &arguments, console)
        });
        self.commands.push((command, run));
        self
    }

    /// With one of its commands for a call without any, which otherwise shows the help.
    pub fn default_command(self, name: &'static str) -> Self {
        Self { default: Some(name), ..self }
    }

    /// Runs the program with the arguments it was started with; its exit code says how it went: 0 well, 2 wrong input,
    /// 3 a motion that cannot be computed, 4 output that cannot be written, 130 ended by Ctrl-C, 1 a bug.
    pub fn main(self) -> ExitCode {
        ExitCode::from(self.run_among(&Alone))
    }

    /// Runs the program with other processes, all with the same arguments, and tells its exit code: they share the members of an ensemble. The
    /// first one prints, and runs every other command by itself. Where one ends with another code than 0, the others have to be ended.
    pub fn run_among(self, ranks: &dyn Ranks) -> u8 {
        let (mut stdout, mut nowhere) = (io::stdout().lock(), io::sink());
        let console: &mut dyn Write = if ranks.rank() == 0 { &mut stdout } else { &mut nowhere };
        match self.run(std::env::args_os(), console, ranks) {
            Ok(()) => 0,
            Err(error) if error.is_broken_pipe() => 0,
            // the message has been printed
            Err(error @ (Error::Interrupted | Error::Usage(_))) => exit_code(&error),
            Err(error) => {
                let of = match ranks.size() {
                    1 => String::new(),
                    size => format!(" (rank {} of {size})", ranks.rank() + 1),
                };
                // in one piece, since other ranks write there too; if it is closed, the exit code still speaks
                let message = format!("error{of}: {}\n", printable(&error.to_string()));
                let _ = io::stderr().write_all(message.as_bytes());
                exit_code(&error)
            }
        }
    }

    /// All commands, as clap knows them.
    fn parser(&self) -> clap::Command {
        let own = self.commands.iter().map(|(arguments, _)| arguments.clone());
        let systems = SystemParser(self.catalogue.clone());
        let command = CommandLine::command().name(program()).version(crate::catalogue::program()[1]);
        let command = self.about.iter().fold(command, |command, about| command.about(*about));
        command
            .subcommands(own)
            .mut_subcommands(|command| {
                command.mut_args(|argument| match argument.get_id().as_str() {
                    "system" => argument.value_parser(systems.clone()).hide_possible_values(true),
                    _ => argument,
                })
            })
            .subcommand_required(true)
            .arg_required_else_help(true)
    }

    fn run(
        &self,
        arguments: impl IntoIterator<Item = OsString>,
        console: &mut dyn Write,
        ranks: &dyn Ranks,
    ) -> Result<(), Error> {
        let is_first = ranks.rank() == 0;
        let mut arguments: Vec<OsString> = arguments.into_iter().collect();
        if arguments.len() == 1 {
            arguments.extend(self.default.map(OsString::from));
        }
        interrupt::guard();
        let matches = self.parser().try_get_matches_from(arguments);
        let matches = match matches {
            Ok(matches) => matches,
            Err(_) if !is_first => return Ok(()),
            Err(error) => {
                let error = explained(error, &self.parser());
                // not an exit at once: other processes may wait for this one; a message beside theirs in one piece
                let _ = match error.use_stderr() && ranks.size() > 1 {
                    true => io::stderr().write_all(error.render().to_string().as_bytes()),
                    false => error.print(),
                };
                return Err(Error::Usage(u8::try_from(error.exit_code()).unwrap_or(2)));
            }
        };
        let own = matches.subcommand().and_then(|(name, matches)| {
            let own = self.commands.iter().find(|(arguments, _)| arguments.get_name() == name);
            own.map(|(_, run)| (run, matches))
        });
        match own {
            Some((run, matches)) if is_first => run(&self.catalogue, matches, console)?,
            Some(_) => {}
            None => {
                let line = CommandLine::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
                if is_first || matches!(line.command, Command::Ensemble(_)) {
                    line.command.run(self, console, ranks)?;
                }
            }
        }
        Ok(console.flush()?)
    }
}

impl Command {
    fn run(&self, app: &App, console: &mut dyn Write, ranks: &dyn Ranks) -> Result<(), Error> {
        let catalogue = &self.catalogue(&app.catalogue)?;
        match self {
            Command::List(arguments) => list::list(catalogue, arguments, console),
            Command::Run(arguments) => run::run(catalogue, arguments, console),
            Command::Resume(arguments) => run::resume(catalogue, arguments, console),
            Command::View(arguments) => run::view(catalogue, arguments, console),
            Command::Play(arguments) => play::play(arguments, console),
            Command::Init(arguments) => init::init(catalogue, arguments, console),
            Command::Ensemble(arguments) => ensemble::ensemble(catalogue, arguments, console, ranks),
            Command::Merge(arguments) => merge::merge(catalogue, arguments, console),
            #[cfg(feature = "show")]
            Command::Show(arguments) => show::show(catalogue, arguments, console),
            Command::Certify(arguments) => certify::certify(catalogue, arguments, console),
            #[cfg(feature = "manual")]
            Command::Completions(arguments) => manual::completions(app.parser(), arguments, console),
            #[cfg(feature = "manual")]
            Command::Man => manual::man(app.parser(), console),
        }
    }

    /// The systems that it chooses from: those of the program, and one that is described in a file.
    fn catalogue(&self, catalogue: &Catalogue) -> Result<Catalogue, Error> {
        let (described, system) = match self {
            Command::List(arguments) => (&arguments.described, arguments.system.as_deref()),
            Command::Run(RunArguments { chosen, .. }) | Command::View(run::ViewArguments { chosen, .. }) => {
                (&chosen.described, chosen.system.as_deref())
            }
            // without a system, that file is to be written
            Command::Init(arguments) if arguments.system.is_some() => {
                (&arguments.described, arguments.system.as_deref())
            }
            Command::Ensemble(arguments) => (&arguments.described, arguments.system.as_deref()),
            #[cfg(feature = "show")]
            Command::Show(arguments) => (&arguments.described, arguments.system.as_deref()),
            Command::Certify(arguments) => (&arguments.described, arguments.system.as_deref()),
            _ => return Ok(catalogue.clone()),
        };
        described.catalogue(catalogue, system)
    }
}

/// Takes any name, so that [`Catalogue::system`] can find near ones; shells complete those that there are.
#[derive(Clone, Debug)]
struct SystemParser(Catalogue);

impl TypedValueParser for SystemParser {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.entries().iter().map(|entry| PossibleValue::new(&entry.name).help(entry.about))))
    }
}

/// Reads a command line of the program's own, without the program's name.
fn parsed(words: Vec<String>) -> Result<Command, clap::Error> {
    let line = std::iter::once(program()).chain(words);
    CommandLine::try_parse_from(line).map(|line| line.command)
}

/// Says which commands have an option that this one does not have, or that was taken for a command.
fn explained(mut error: clap::Error, parser: &clap::Command) -> clap::Error {
    let asked =
        [ContextKind::InvalidSubcommand, ContextKind::InvalidArg].map(|kind| error.get(kind).cloned());
    let kinds = [ErrorKind::UnknownArgument, ErrorKind::InvalidSubcommand];
    let Some(ContextValue::String(asked)) = asked.into_iter().flatten().next() else { return error };
    if !kinds.contains(&error.kind()) {
        return error;
    }
    // nothing that begins with `--` is a value
    error.remove(ContextKind::Suggested);
    let name = asked.trim_start_matches("--");
    let has = |command: &&clap::Command| command.get_arguments().any(|own| own.get_long() == Some(name));
    let of = parser.get_subcommands().filter(has).map(|command| format!("`{} --{name}`", command.get_name()));
    let of = of.collect::<Vec<_>>().join(", ");
    if !of.is_empty() {
        error.remove(ContextKind::SuggestedSubcommand);
        let hint = ContextValue::StyledStrs(vec![format!("there is {of}").into()]);
        error.insert(ContextKind::Suggested, hint);
    }
    error
}

/// Tells the exit code of an error, as [`EXIT_CODES`] lists them.
fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Setup(_) => 2,
        Error::File(FileError::Write(..)) => 4,
        Error::File(_) => 2,
        Error::Run(
            RunError::Setup(_) | RunError::Stepper(_) | RunError::Ensemble(_) | RunError::Member { .. },
        ) => 2,
        Error::Run(_) | Error::Command(_) => 3,
        Error::Usage(code) => *code,
        Error::Interrupted => interrupt::exit_code(),
        Error::Console(_) => 4,
        Error::Claim { .. } | Error::Generator { .. } => 1,
    }
}

/// The name by which the program was started, for messages that say what to type.
fn program() -> String {
    let path = std::env::args_os().next().unwrap_or_default();
    Path::new(&path)
        .file_stem()
        .map_or_else(|| "coadjoint".to_owned(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        App::new([]).parser().debug_assert();
    }

    /// A file has a key for each option that says what a run is, and says of the others where they belong.
    #[test]
    fn options_are_keys_of_a_file_or_told_to_be_none() {
        for command in ["run", "ensemble"] {
            let parser = App::new([]).parser();
            let options = parser.find_subcommand(command).expect(command).get_arguments();
            let mut count = 0;
            for option in options.filter_map(clap::Arg::get_long) {
                for key in [option.to_owned(), option.replace('-', "_")] {
                    let told = crate::setup::config::Config::of(&format!("[run]\n{key} = true\n"));
                    let told = told.map(drop).map_err(|error| error.to_string());
                    let is_told = |error: &String| !error.contains("unknown field");
                    assert!(told.as_ref().err().is_none_or(is_told), "{command} --{option}: {told:?}");
                }
                count += 1;
            }
            assert!(count > 15, "{command}: {count}");
        }
    }
}
