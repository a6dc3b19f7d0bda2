//! `coadjoint ensemble`

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use coadjoint::ensemble::Spread;
use coadjoint::system::Role;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::console::{Console, OutputMode};
use super::description::DescriptionArguments;
use super::interrupt;
use super::motion::{Motion, MotionArguments, SchemeArguments, check_scheme};
use super::run::pause;
use crate::catalogue::quantities::components;
use crate::catalogue::{Catalogue, Entry, Observable};
use crate::error::{Error, RunError, SetupError};
use crate::files::{
    Done, FileOrigin, Manifest, Members, NewFile, OverwriteGuard, PlannedFile, Provenance, RowLooks, Rows,
    Shard, ShardStore, Status, check_rows, file_in, is_stdout, table,
};
use crate::picture::{Kind, ensemble_figure};
use crate::setup::{Changes, Format, Job, Setup, observable, observables};
use crate::simulate::ensemble::{
    self, Alone, EnsembleSpec, EnsembleSummary, Handed, Ranks, Tally, Variation,
};
use crate::simulate::threads;
use crate::units::{grouped, short};

/// Momentum components that are drawn unless others are asked for.
const MOST: usize = 3;

/// The arguments of `ensemble`.
#[derive(Debug, Args)]
pub(crate) struct EnsembleArguments {
    /// The system; `list` shows all
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// How many members
    #[arg(long, value_name = "N", default_value_t = Members::MEMBERS, value_parser = members)]
    pub(crate) members: u64,
    /// How far members differ [default: momentum=1%]
    ///
    /// Evenly within plus or minus the width: `inertia=2%` of each component's own size, `momentum_z=0.01` in the
    /// component's own unit, `chi=0,0,0.1` for each component. A rotation is turned about any axis by an angle up to
    /// the width: `attitude=5deg`, `attitude=0.1rad`; advected vectors turn along. Symmetric matrices stay symmetric;
    /// an element of a group of matrices is displaced as a whole: `element=0.1`.
    #[arg(long, value_name = "NAME=WIDTH")]
    pub(crate) spread: Vec<String>,
    #[command(flatten)]
    pub(crate) scheme: SchemeArguments,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// A quantity to show: `energy`, `gamma.norm()` [default: the momentum]
    ///
    /// Expressions are written as in descriptions, by the names of state, velocities, parameters, controls and the time
    /// `t`; before them a name and a unit may stand: `'height, m = gamma.dot(&chi)'`.
    #[arg(long, value_name = "EXPRESSION")]
    pub(crate) quantity: Vec<String>,
    /// Look at the members after every N-th step [default: 300 times]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Another seed draws other members
    #[arg(long, value_name = "SEED", default_value_t = Members::SEED)]
    pub(crate) seed: u64,
    /// Run the K-th of N parts of the members, for `merge`: `2/7`
    ///
    /// What is known of them is saved in the directory of `--checkpoint`, as they are run. The same command goes on
    /// with what is left of the part. Where the directory has shards of another number of parts, N parts are made of
    /// what those have not done.
    #[arg(long, value_name = "K/N", value_parser = part)]
    pub(crate) shard: Option<(u64, u64)>,
    /// Save what is done in this directory; the same command goes on from there [default: where it is needed
    /// `<DIR>/<name>.blocks`]
    ///
    /// It is removed when the ensemble is complete.
    #[arg(long, value_name = "DIR")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// How often what is done is saved, s
    #[arg(long = "save-every", value_name = "S", default_value_t = 30.0, value_parser = pause)]
    pub(crate) save_every: f64,
    /// Write a row for each member too: at the end, or at all looks
    ///
    /// They are files of a directory, `<DIR>/<name>.rows`, one for each block of members. Their columns are the member,
    /// the time, what was drawn of it, and the quantities. Of members that failed these are not-a-number.
    #[arg(long, value_enum)]
    pub(crate) rows: Option<RowLooks>,
    /// The format of these files [default: parquet if the program has it, else csv]
    #[arg(long, value_enum, requires = "rows")]
    pub(crate) format: Option<Format>,
    /// How many members are run at once; fewer where each takes long
    #[arg(long, value_name = "N", default_value_t = EnsembleSpec::BLOCK as u64, value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    pub(crate) block: u64,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// Reads a number of members, which may be written as `1e6`.
fn members(text: &str) -> Result<u64, String> {
    /// Run one a microsecond, these take eleven days.
    const MOST: u64 = 1_000_000_000_000;
    let read = || match text.parse::<u64>() {
        Ok(members) => Some(members),
        // so many that each number is a double
        Err(_) => text.parse::<f64>().ok().filter(|x| x.fract() == 0.0 && *x >= 0.0).map(|x| x as u64),
    };
    match read() {
        Some(members @ 1..=MOST) => Ok(members),
        Some(members) => Err(format!("{members} is not in 1..={MOST}")),
        None => Err("it is no whole number".to_owned()),
    }
}

/// Reads a part: `2/7`.
fn part(text: &str) -> Result<(u64, u64), String> {
    let read = || {
        let (k, n) = text.split_once('/')?;
        Some((k.trim().parse().ok()?, n.trim().parse().ok()?))
    };
    match read() {
        Some((k, n)) if 1 <= k && k <= n => Ok((k, n)),
        _ => Err("a part is written as `2/7`, the second of seven".to_owned()),
    }
}

/// Runs an ensemble with other processes; writes the distributions as a table and as a plot.
pub(crate) fn ensemble(
    catalogue: &Catalogue,
    arguments: &EnsembleArguments,
    stdout: &mut dyn Write,
    ranks: &dyn Ranks,
) -> Result<(), Error> {
    // the others begin when the first one has looked at all that can be wrong
    let plan = (ranks.rank() > 0).then(|| ensemble::shared(ranks, Vec::new()));
    let mut console = arguments.output.on(stdout, is_stdout(&arguments.motion.out))?;
    let plan = plan.and_then(|plan| postcard::from_bytes(&plan).ok());
    Ensemble::of(catalogue, arguments, None, &mut console)?.execute(ranks, plan, &mut console)
}

/// Makes the ensemble that the arguments describe; again, if it made files of this origin.
pub(crate) fn described(
    catalogue: &Catalogue,
    arguments: &EnsembleArguments,
    again: Option<&FileOrigin>,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    Ensemble::of(catalogue, arguments, again, console)?.execute(&Alone, None, console)
}

/// An ensemble that can be run.
pub(super) struct Ensemble<'a> {
    arguments: &'a EnsembleArguments,
    motion: Motion<'a>,
    pub(super) spec: EnsembleSpec,
    named: Vec<Observable>,
    guard: OverwriteGuard,
    /// The table, and the pictures.
    paths: Vec<PathBuf>,
    /// The directory of shards.
    blocks: PathBuf,
    /// The directory of rows.
    rows: PathBuf,
    pub(super) manifest: Manifest,
}

/// What all ranks begin with.
#[derive(Serialize, Deserialize)]
struct Plan {
    done: Done,
    /// Shards of earlier jobs: what is in them is merged at the end.
    earlier: Vec<PathBuf>,
}

/// Who ran the blocks, in words for the report.
pub(super) enum Runners {
    Process,
    Ranks(usize),
    Shards(usize),
}

impl<'a> Ensemble<'a> {
    /// Reads what is asked for; again, if it made files of this origin.
    pub(super) fn of(
        catalogue: &'a Catalogue,
        arguments: &'a EnsembleArguments,
        again: Option<&FileOrigin>,
        console: &mut Console<'_>,
    ) -> Result<Self, Error> {
        let EnsembleArguments { scheme, motion, members, spread, seed, quantity, .. } = arguments;
        let to = motion;
        let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
        check_scheme(scheme.method()?, scheme.order, scheme.retraction)?;
        let motion = Motion::of(Changes::of(entry), scheme, true, motion, console)?;
        again.map_or(Ok(()), |made| made.check_digits(entry, &motion.setup, &motion.job))?;
        let every = arguments.every.unwrap_or(Members::every(motion.job.steps));
        let (spread, quantity) = (spread.clone(), quantity.clone());
        let asked = Members { members: *members, spread, seed: *seed, quantity };
        let spec = EnsembleSpec {
            block: usize::try_from(arguments.block).unwrap_or(usize::MAX),
            ..spec(&motion, &asked, every)?
        };
        // before files are looked at
        spec.check_room()?;
        spec.variation.notes.iter().try_for_each(|note| console.note(note.clone()))?;
        let named = shown(entry, &asked.quantity)?;
        let run = Provenance {
            ensemble: Some(asked),
            ..Provenance::of_run(entry, &motion.setup, &motion.job, every)
        };
        let stem = run.stem(entry, &motion.job);
        let guard = OverwriteGuard::new(run.origin(), to.force);
        let paths: Vec<PathBuf> = match is_stdout(&to.out) {
            true => vec![to.out.clone()],
            false => {
                let ends = std::iter::once("csv").chain(Kind::ALL.iter().map(|kind| kind.extension()));
                ends.map(|end| file_in(&to.out, &format!("{stem}.{end}"))).collect()
            }
        };
        let rows =
            arguments.rows.map(|looks| Ok::<_, SetupError>(Rows { looks, format: format(arguments)? }));
        let manifest = Manifest { origin: run.origin(), block: arguments.block, rows: rows.transpose()? };
        let blocks = to.out.join(format!("{stem}.blocks"));
        let blocks = arguments.checkpoint.clone().unwrap_or(blocks);
        let rows = to.out.join(format!("{stem}.rows"));
        Ok(Self { arguments, motion, spec, named, guard, paths, blocks, rows, manifest })
    }

    /// Runs it, or a part of it, and reports it.
    fn execute(&self, ranks: &dyn Ranks, plan: Option<Plan>, console: &mut Console<'_>) -> Result<(), Error> {
        let EnsembleArguments { shard, checkpoint, rows, .. } = self.arguments;
        let is_saved = shard.is_some() || checkpoint.is_some() || rows.is_some() || ranks.size() > 1;
        if shard.is_some() && ranks.size() > 1 {
            return Err(SetupError::new(
                "`--shard` is for jobs without MPI: ranks share the members by themselves",
            )
            .into());
        }
        if is_saved && checkpoint.is_none() && is_stdout(&self.arguments.motion.out) {
            let reason =
                "`--out -` names no directory in which blocks could be saved: give one by `--checkpoint DIR`";
            return Err(SetupError::new(reason).into());
        }
        if rows.is_some() && is_stdout(&self.arguments.motion.out) {
            return Err(
                SetupError::new("rows are a directory of files: `--out DIR` says where they go").into()
            );
        }
        threads::start()?;
        if ranks.rank() == 0 && shard.is_none() {
            self.check_files()?;
        }
        interrupt::listen();
        match (is_saved, self.spec.blocks()) {
            (false, ..=1) => self.at_once(console),
            (false, _) => {
                self.spec.check_statistics(self.named.len())?;
                let left: Vec<u64> = (0..self.spec.blocks()).collect();
                let mut all = self.nothing();
                self.run_blocks(&left, &mut all, &mut |_, _| Ok(()), ranks, console)?;
                self.finish(all, &Runners::Process, None, console)
            }
            (true, _) => {
                self.spec.check_statistics(self.named.len())?;
                self.in_shards(ranks, plan, console)
            }
        }
    }

    /// Checks that all files can be written.
    pub(super) fn check_files(&self) -> Result<(), Error> {
        let planned =
            |path: &PathBuf| PlannedFile { what: "the ensemble", path: path.clone(), written: true };
        self.guard.check_all(&self.paths.iter().map(planned).collect::<Vec<_>>())?;
        if self.manifest.rows.is_some() {
            check_rows(&self.rows, &self.manifest.origin, self.arguments.motion.force)?;
        }
        Ok(())
    }

    /// Runs all members side by side in time.
    fn at_once(&self, console: &mut Console<'_>) -> Result<(), Error> {
        let Motion { entry, setup, job, .. } = &self.motion;
        let mut progress = console.progress(&entry.name, job.steps, "step");
        let mut go_on = |index: u64| {
            progress.show(index);
            if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let summary = ensemble::run(entry, setup, &self.spec, &self.named, &mut go_on)?;
        drop(progress);
        self.write(&summary, &Runners::Process, &[], console)
    }

    /// A shard of no blocks.
    pub(super) fn nothing(&self) -> Shard {
        let Motion { entry, setup, .. } = &self.motion;
        let tally = Tally::new(&self.spec, entry, setup, self.named.len());
        Shard { done: Done::default(), tally, seconds: 0.0, width: 0 }
    }

    /// Runs those of these blocks that this rank is handed, and adds them to a shard; after each it is shown with the
    /// block.
    fn run_blocks(
        &self,
        left: &[u64],
        shard: &mut Shard,
        done: &mut dyn FnMut(&Shard, &ensemble::Block) -> Result<(), Error>,
        ranks: &dyn Ranks,
        console: &mut Console<'_>,
    ) -> Result<(), Error> {
        let Motion { entry, setup, job, .. } = &self.motion;
        let mut handed = Handed::new(ranks, left.len() as u64);
        let block = self.spec.block as u64;
        let members = (left.len() as u64 * block).min(self.spec.members as u64);
        let mut progress = console.progress(&entry.name, members, "member");
        while let Some(next) = handed.next() {
            let mut go_on = |taken: u64| {
                handed.serve();
                let share = taken as f64 / job.steps.max(1) as f64;
                let given = handed.given().saturating_sub(1);
                progress.show((given * block + (share * block as f64) as u64).min(members));
                if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            let index = left[next as usize];
            let block = ensemble::block(entry, setup, &self.spec, index, &self.named, &mut go_on)?;
            let Some(block) = block else { return Ok(()) };
            shard.tally.add(&block);
            shard.done.add(index);
            shard.seconds += block.end.seconds;
            shard.width = block.end.width;
            done(shard, &block)?;
            // a signal that came after the last look
            if interrupt::requested() {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Runs it in shards that are saved: a part of them, or all with other ranks.
    fn in_shards(
        &self,
        ranks: &dyn Ranks,
        plan: Option<Plan>,
        console: &mut Console<'_>,
    ) -> Result<(), Error> {
        let mut store = ShardStore::open(&self.blocks, self.manifest.clone())?;
        let rank_name = |rank: usize| format!("rank-{}-of-{}", rank + 1, ranks.size());
        let name = match self.arguments.shard {
            Some((k, n)) => format!("part-{k}-of-{n}"),
            None => rank_name(ranks.rank()),
        };
        if ranks.rank() == 0 {
            store.lock(self.arguments.shard.map(|_| &name[..]))?;
        }
        let mut shard = store.read(&store.place(&name))?.unwrap_or_else(|| self.nothing());
        let plan = match plan {
            Some(plan) => plan,
            None => {
                let is_of_now = |path: &Path| match self.arguments.shard {
                    // each of these is at work, or was
                    Some((_, n)) => is_part_of(path, n),
                    None => (0..ranks.size()).any(|rank| path == store.place(&rank_name(rank))),
                };
                let (now, earlier): (Vec<_>, Vec<_>) =
                    store.shards()?.into_iter().partition(|path| is_of_now(path));
                let mut done = Done::default();
                let known = if self.arguments.shard.is_some() { &[][..] } else { &now[..] };
                for path in known.iter().chain(&earlier) {
                    let Some(found) = store.read(path)? else { continue };
                    if let Some(block) = done.merge(&found.done) {
                        let what = format!(
                            "has block {block}, which another shard has too: one of them is left over"
                        );
                        return Err(crate::error::FileError::Damaged(path.clone(), what).into());
                    }
                }
                let plan = Plan { done, earlier };
                // written to memory
                ensemble::shared(ranks, postcard::to_stdvec(&plan).unwrap_or_default());
                plan
            }
        };
        let mut left: Vec<u64> = plan.done.left(self.spec.blocks()).collect();
        if let Some((k, n)) = self.arguments.shard {
            let place = |k: u64| (u128::from(k) * left.len() as u128 / u128::from(n)) as usize;
            left = left[place(k - 1)..place(k)].to_vec();
            if left.is_empty() && shard.done.count() == 0 {
                console.note(format!("part {k} of {n} has no members: `--block N` makes smaller blocks"))?;
            }
            let of_part = left.iter().filter(|block| shard.done.has(**block)).count() as u64;
            if of_part < shard.done.count() {
                let what = "has blocks that are not of this part any more: take another number of parts";
                return Err(crate::error::FileError::Damaged(store.place(&name), what.to_owned()).into());
            }
            left.retain(|block| !shard.done.has(*block));
        }
        let pause = Duration::try_from_secs_f64(self.arguments.save_every).unwrap_or(Duration::MAX);
        let (mut saved, mut is_saved) = (Instant::now(), store.place(&name).exists());
        let names: Vec<String> = self.named.iter().map(|named| named.name.clone()).collect();
        let mut keep = |shard: &Shard, block: &ensemble::Block| -> Result<(), Error> {
            store.write_rows(&self.spec, &names, block)?;
            is_saved = saved.elapsed() >= pause;
            if is_saved {
                store.save(&name, shard)?;
                saved = Instant::now();
            }
            Ok(())
        };
        self.run_blocks(&left, &mut shard, &mut keep, ranks, console)?;
        if !is_saved {
            store.save(&name, &shard)?;
        }
        if interrupt::requested() {
            return self.stopped(&shard, console);
        }
        if self.arguments.shard.is_some() {
            return self.report_part(&shard, &store.place(&name), console);
        }
        // what earlier jobs did, each rank some of it
        for path in plan.earlier.iter().skip(ranks.rank()).step_by(ranks.size()) {
            if let Some(found) = store.read(path)? {
                shard.merge(&found)?;
            }
        }
        let merge = |all: &mut Shard, bytes: &[u8]| match Shard::from_bytes(bytes) {
            Some(other) => all.merge(&other),
            None => Err(SetupError::new("a rank sent what is no shard")),
        };
        let Some(all) = ensemble::merged(ranks, shard, merge, Shard::to_bytes)? else { return Ok(()) };
        let runners = if ranks.size() > 1 { Runners::Ranks(ranks.size()) } else { Runners::Process };
        self.finish(all, &runners, Some((store, Vec::new(), true)), console)
    }

    /// Writes all that is known: with the rows, and without the shards any more, where there are some.
    pub(super) fn finish(
        &self,
        all: Shard,
        runners: &Runners,
        store: Option<(ShardStore, Vec<PathBuf>, bool)>,
        console: &mut Console<'_>,
    ) -> Result<(), Error> {
        let Motion { entry, setup, .. } = &self.motion;
        let Shard { tally, seconds, width, .. } = all;
        if tally.members() == 0 {
            return Err(Error::Interrupted);
        }
        let summary = tally.summary(&self.spec, entry, setup, (width, seconds));
        let mut rows = Vec::new();
        if let Some((store, others, _)) = &store {
            rows.extend(store.publish_rows(&self.spec, others, &self.rows, self.arguments.motion.force)?);
        }
        self.write(&summary, runners, &rows, console)?;
        if let Some((store, _, true)) = store {
            store.remove();
        }
        Ok(())
    }

    /// Writes table and pictures, and reports what was found.
    fn write(
        &self,
        summary: &EnsembleSummary,
        runners: &Runners,
        rows: &[PathBuf],
        console: &mut Console<'_>,
    ) -> Result<(), Error> {
        let (Motion { entry, setup, .. }, spec) = (&self.motion, &self.spec);
        let (contents, status) = contents(entry, spec, &self.named, summary, &self.paths)?;
        let written = self.guard.put(contents, status)?;
        for path in &written.kept {
            console.note(format!("{} holds the whole ensemble, and stays", path.display()))?;
        }
        let files = [&written.files[..], rows].concat();
        console.summary(&files, || {
            let mut object = object(entry, setup, spec, &self.named, summary);
            object["interrupted"] = interrupt::requested().into();
            object
        })?;
        report(entry, summary, spec, runners, console.words())?;
        console.wrote(&files)?;
        match summary.failed.first() {
            _ if status != Status::Complete => Err(Error::Interrupted),
            Some(first) if summary.failures == spec.members as u64 => {
                Err(RunError::NoneLeft { count: spec.members, what: "members", first: first.to_string() }
                    .into())
            }
            _ => Ok(()),
        }
    }

    /// Says how far a part is that was interrupted.
    fn stopped(&self, shard: &Shard, console: &mut Console<'_>) -> Result<(), Error> {
        let (done, all) = (grouped(shard.tally.members()), grouped(self.spec.members as u64));
        writeln!(
            console.words(),
            "interrupted: {done} of {all} members are saved in {}; the same command goes on",
            self.blocks.display()
        )?;
        Err(Error::Interrupted)
    }

    /// Says what a part has done.
    fn report_part(&self, shard: &Shard, place: &Path, console: &mut Console<'_>) -> Result<(), Error> {
        let (k, n) = self.arguments.shard.unwrap_or((1, 1));
        let (entry, members) = (&self.motion.entry, shard.tally.members());
        console.summary(&[place.to_owned()], || {
            json!({
                "system": entry.name, "part": k, "parts": n, "members": members, "blocks": shard.done.count(),
                "seconds": shard.seconds,
            })
        })?;
        writeln!(
            console.words(),
            "part {k} of {n} of {}: {} of {} members, {} blocks\n`{} merge {}` makes one of all parts",
            entry.name,
            grouped(members),
            grouped(self.spec.members as u64),
            grouped(shard.done.count()),
            super::program(),
            self.blocks.display()
        )?;
        console.wrote(&[place.to_owned()])
    }
}

/// Tells whether a shard is one of this many parts.
fn is_part_of(path: &Path, parts: u64) -> bool {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    name.starts_with("part-") && name.ends_with(&format!("-of-{parts}"))
}

/// The format of rows.
fn format(arguments: &EnsembleArguments) -> Result<Format, SetupError> {
    let usual = if cfg!(feature = "parquet") { Format::Parquet } else { Format::Csv };
    match arguments.format.unwrap_or(usual).checked()? {
        Format::Json => Err(SetupError::new("rows are written as `--format csv` or `parquet`")),
        format => Ok(format),
    }
}

/// Reads how members differ.
fn spec(motion: &Motion<'_>, asked: &Members, every: u64) -> Result<EnsembleSpec, SetupError> {
    let Motion { entry, setup, job, .. } = motion;
    let momenta = entry.description.state.iter().filter(|quantity| quantity.role == Role::Momentum);
    let spread: Vec<String> = match asked.spread.is_empty() {
        true => momenta.map(|quantity| format!("{}=1%", quantity.name)).collect(),
        false => asked.spread.clone(),
    };
    let variation = Variation::parse(entry, setup, &spread)?;
    let members = usize::try_from(asked.members).unwrap_or(usize::MAX);
    Ok(EnsembleSpec { members, variation, seed: asked.seed, job: *job, every, block: EnsembleSpec::BLOCK })
}

/// Writes the table, and the pictures unless there is nothing to draw, not yet in their places.
fn contents(
    entry: &Entry,
    spec: &EnsembleSpec,
    named: &[Observable],
    summary: &EnsembleSummary,
    paths: &[PathBuf],
) -> Result<(Vec<(PathBuf, NewFile)>, Status), Error> {
    let last = summary.spreads.first().and_then(|spreads| spreads.last());
    let taken = last.map_or(0, |spread| (spread.time / spec.job.step).round() as u64);
    let status = match summary.members {
        members if members < spec.members as u64 => Status::Members(members),
        _ if taken < spec.job.steps => Status::Interrupted(taken),
        _ => Status::Complete,
    };
    let mut contents = Vec::new();
    if let Some(path) = paths.first() {
        contents.push((path.clone(), NewFile::with(path, &table(&records(named, summary)))?));
    }
    let is_seen = |spread: &&Spread| spread.members > 0;
    let looks = summary.spreads.first().map_or(0, |spreads| spreads.iter().filter(is_seen).count());
    // of members that failed at once there is nothing to draw
    if looks > 1 {
        let figure = ensemble_figure(entry, named, summary, spec, &spec.variation.words);
        for (path, kind) in paths.iter().skip(1).zip(Kind::ALL) {
            contents.push((path.clone(), NewFile::with(path, &figure.picture(*kind))?));
        }
    }
    Ok((contents, status))
}

/// Reads the quantities asked for.
fn shown(entry: &Entry, asked: &[String]) -> Result<Vec<Observable>, SetupError> {
    if !asked.is_empty() {
        return observables(entry, asked);
    }
    let momenta = components(entry.description.state)
        .filter(|component| component.quantity.role == Role::Momentum)
        .take(MOST)
        .map(|component| observable(entry, &component.name));
    momenta.chain(entry.observables.iter().cloned().map(Ok)).collect()
}

/// Time and, for each quantity, how many members, mean, deviation and quantiles.
fn records(named: &[Observable], summary: &EnsembleSummary) -> Vec<Vec<String>> {
    const COLUMNS: [&str; 10] =
        ["members", "mean", "deviation", "min", "q05", "q25", "median", "q75", "q95", "max"];
    let columns = named.iter().flat_map(|own| COLUMNS.map(|column| format!("{}_{column}", own.name)));
    let header: Vec<String> = std::iter::once("time".to_owned()).chain(columns).collect();
    let samples = summary.spreads.first().map_or(0, Vec::len);
    let record = |sample: usize| {
        let mut record = vec![summary.spreads[0][sample].time.to_string()];
        for spreads in &summary.spreads {
            let Spread { members, mean, deviation, quantiles, .. } = spreads[sample];
            record.push(members.to_string());
            record.extend([mean, deviation].iter().chain(&quantiles).map(f64::to_string));
        }
        record
    };
    std::iter::once(header).chain((0..samples).map(record)).collect()
}

fn report(
    entry: &Entry,
    summary: &EnsembleSummary,
    spec: &EnsembleSpec,
    runners: &Runners,
    words: &mut dyn Write,
) -> Result<(), Error> {
    let EnsembleSummary { drawn, failures, failed, members, member_steps, width, seconds, .. } = summary;
    let Job { method, retraction, .. } = spec.job;
    let retraction = if method.has_retraction() { format!(" {}", retraction.name()) } else { String::new() };
    writeln!(words, "scheme: {method}{retraction}, order {}", spec.job.order_of_step(entry))?;
    for (i, drawn) in drawn.iter().enumerate() {
        let title = if i == 0 { "drawn: " } else { "       " };
        let (least, greatest) = drawn.range;
        let range = format!("from {} to {} {}", short(least), short(greatest), drawn.unit);
        writeln!(words, "{title}{}", format!("{:16} {range}", drawn.name).trim_end())?;
    }
    let threads = rayon::current_num_threads();
    let by = match runners {
        Runners::Process => format!("{threads} threads"),
        Runners::Ranks(ranks) => format!("{threads} threads on each of {ranks} ranks, whose times add up"),
        Runners::Shards(shards) => format!("{shards} shards, whose times add up"),
    };
    writeln!(
        words,
        "{} members, {} steps in {seconds:.2} s: {} member steps/s\n({width} side by side, {by})",
        grouped(*members),
        grouped(*member_steps),
        grouped((*member_steps as f64 / seconds) as u64),
    )?;
    if summary.quantile_error > 0.0 {
        let percent = 100.0 * summary.quantile_error;
        writeln!(
            words,
            "quantiles are within {} % of their size; means and deviations are exact",
            short(percent)
        )?;
    }
    for failure in failed {
        writeln!(words, "{failure}")?;
    }
    let others = failures - failed.len() as u64;
    if others > 0 {
        writeln!(words, "and {} others failed", grouped(others))?;
    }
    Ok(())
}

/// All of it as a JSON object, with the distributions at the end.
fn object(
    entry: &Entry,
    setup: &Setup,
    spec: &EnsembleSpec,
    named: &[Observable],
    summary: &EnsembleSummary,
) -> Value {
    let mut object = Value::Object(Provenance::of_run(entry, setup, &spec.job, spec.every).fields());
    object["members"] = json!(spec.members);
    object["seed"] = json!(spec.seed);
    object["spread"] = json!(spec.variation.words);
    for drawn in &summary.drawn {
        object["drawn"][&drawn.name] =
            json!({ "min": drawn.range.0, "max": drawn.range.1, "unit": drawn.unit });
    }
    for (Observable { name, .. }, last) in
        named.iter().zip(summary.spreads.iter().map(|spreads| spreads.last()))
    {
        object["end"][name] = last.map_or(Value::Null, |last| {
            json!({
                "time": last.time, "members": last.members, "mean": last.mean, "deviation": last.deviation,
                "quantiles": last.quantiles,
            })
        });
    }
    object["quantile_error"] = json!(summary.quantile_error);
    object["failed"] = json!(summary.failures);
    object["member_steps"] = json!(summary.member_steps);
    object["seconds"] = json!(summary.seconds);
    object["side_by_side"] = json!(summary.width);
    object["threads"] = json!(rayon::current_num_threads());
    object
}
