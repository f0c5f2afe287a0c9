//! What can be done with recordings.

use std::fs::File;
use std::io::{BufReader, Write};
use std::iter::Peekable;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use common::config::ChainConfig;
use common::process::{BadInput, EXIT_CHECK_BROKEN};
use common::recording::container::Reader;
use common::recording::{self, Messages, Recorded, RecordingError, parts_from};
use common::report::Report;
use common::topic::Topic;

use crate::export::{ExportError, Form};
use crate::replay::recorded_config;
use crate::scoring::Scoring;
use crate::verify::Verification;
use crate::{diff, export, info, replay_process};

/// Topics that an export writes unless others are named.
pub const TABLE_TOPICS: &str = "plots,tracks,truth";

/// The topic of this name.
///
/// # Errors
/// The names there are.
pub fn parse_topic(name: &str) -> Result<Topic, String> {
    let names = Topic::ALL.map(Topic::name).join(", ");
    Topic::from_name(name).ok_or_else(|| format!("expected one of {names}"))
}

/// Says what is in a recording.
pub(crate) fn info(path: &Path) -> anyhow::Result<ExitCode> {
    let file = open_container(path)?;
    let (length, parts) = (file.metadata().map_or(0, |about| about.len()), parts_from(path).len());
    let input = BufReader::with_capacity(1 << 20, file);
    let text = info::describe(input, length, parts).map_err(|error| in_file(path, &error))?;
    say(&text)
}

/// Checks recordings: exit code 0 if they are whole, 1 with findings.
pub(crate) fn verify(paths: &[PathBuf]) -> anyhow::Result<ExitCode> {
    let mut verification = Verification::default();
    for path in paths {
        let file = open_container(path)?;
        let length = file.metadata().map_or(0, |about| about.len());
        verification.file(&path.display().to_string(), length, BufReader::with_capacity(1 << 20, file));
    }
    let (text, findings) = verification.finish();
    say(&text)?;
    Ok(if findings == 0 { ExitCode::SUCCESS } else { ExitCode::from(EXIT_CHECK_BROKEN) })
}

/// Prints the configuration of the recorded run, or the one of its replay.
pub(crate) fn config(path: &Path, replay: bool) -> anyhow::Result<ExitCode> {
    if replay {
        return say(&recorded_config(path)?.to_toml());
    }
    let mut reader = Reader::new(open_container(path)?);
    let config = reader.description().map(|description| description.config.clone());
    say(&config.ok_or_else(|| BadInput(format!("{} holds no configuration", path.display())))?)
}

/// Opens a recording that has a description.
fn open_container(path: &Path) -> Result<File, BadInput> {
    recording::open_container(path).map_err(|error| BadInput(error.to_string()))
}

/// Writes topics of a run as files: exit code 0, or 1 if something in the recording could not be read.
///
/// # Errors
/// [`BadInput`] if the recording cannot be opened or a file cannot be written.
pub fn export(path: &Path, topics: &[Topic], form: &dyn Form, out: &Path) -> anyhow::Result<ExitCode> {
    // JSON lines have no description.
    let container = recording::open_container(path).ok();
    let description = container.and_then(|file| Reader::new(BufReader::new(file)).description().cloned());
    let mut skipped = false;
    let readable = open_run(path)?.filter(|message| {
        if let Err(error) = message {
            skipped = true;
            common::process::say(&format!("skipped: {error}"));
        }
        message.is_ok()
    });
    let files = export::export(readable, description.as_ref(), topics, form, out).map_err(|error| match error {
        ExportError::Recording(error) => in_file(path, &error),
        other => BadInput(other.to_string()),
    })?;
    let lines: Vec<String> = files.iter().map(|(file, rows)| format!("{} {rows} rows\n", file.display())).collect();
    say(&lines.concat())?;
    Ok(if skipped { ExitCode::from(EXIT_CHECK_BROKEN) } else { ExitCode::SUCCESS })
}

/// Puts recorded topics onto the services.
pub(crate) fn replay(config: &ChainConfig) -> anyhow::Result<ExitCode> {
    let first_scan = config.run.first_scan;
    if first_scan > 0 {
        // Stages that do not know would count what lies before as lost.
        common::process::say(&format!(
            "begins with scan {first_scan}: start the recorder with --set run.first_scan={first_scan}"
        ));
    }
    replay_process::replay(config)
}

/// Compares two recordings: exit code 0 if they are equal, 1 with the first difference.
pub(crate) fn diff(a: &Path, b: &Path) -> anyhow::Result<ExitCode> {
    let difference = diff::first_difference(open_run(a)?, open_run(b)?)
        .map_err(|error| BadInput(format!("comparing {} and {}: {error}", a.display(), b.display())))?;
    match difference {
        None => say("equal\n"),
        Some(difference) => {
            say(&format!("{difference}\n"))?;
            Ok(ExitCode::from(EXIT_CHECK_BROKEN))
        }
    }
}

/// Scores tracks (and plots) against truth.
pub(crate) fn score(
    config: &ChainConfig,
    tracks: &Path,
    truth: &Path,
    plots: Option<&Path>,
) -> anyhow::Result<ExitCode> {
    let mut scoring = Scoring::new(config);
    let mut inputs = vec![open_topic(truth, Topic::Truth)?, open_topic(tracks, Topic::Tracks)?];
    inputs.extend(plots.map(|path| open_topic(path, Topic::Plots)).transpose()?);
    while let Some(message) = next_by_time(&mut inputs)? {
        match message {
            Recorded::Truth(header, targets) => scoring.truth(&header, &targets),
            Recorded::Tracks(header, tracks) => scoring.tracks(&header, &tracks),
            Recorded::Plots(header, plots) => scoring.plots(&header, &plots),
            _ => {}
        }
    }
    let (detection, tracking) = scoring.finish();
    let report = Report { detection, tracking, ..Report::default() };
    say(&if plots.is_some() { report.scores_to_text() } else { report.tracking.to_text() })
}

/// The messages of a recording and of the later parts of its run; errors name the file.
fn open_run(path: &Path) -> Result<Messages, BadInput> {
    // What is wrong with the first file is said at once.
    drop(recording::open(path).map_err(|error| BadInput(error.to_string()))?);
    Ok(Box::new(parts_from(path).into_iter().flat_map(|part| -> Messages {
        match recording::open(&part) {
            Ok(messages) => Box::new(messages.map(move |message| {
                message.map_err(|error| RecordingError::Container { message: in_file(&part, &error).to_string() })
            })),
            Err(error) => Box::new(std::iter::once(Err(error))),
        }
    })))
}

/// The messages of one topic; the same file may be opened for several.
fn open_topic(path: &Path, topic: Topic) -> Result<Peekable<Messages>, BadInput> {
    let wanted: Messages = Box::new(open_run(path)?.filter(move |message| match message {
        Ok(message) => message.by_ref().topic() == topic,
        Err(_) => true,
    }));
    Ok(wanted.peekable())
}

/// The earliest of the next messages of several recordings.
fn next_by_time(inputs: &mut [Peekable<Messages>]) -> anyhow::Result<Option<Recorded>> {
    let time_ns = |input: &mut Peekable<Messages>| match input.peek() {
        None => u64::MAX,
        Some(Ok(message)) => message.by_ref().time_ns(),
        Some(Err(_)) => 0,
    };
    let times: Vec<u64> = inputs.iter_mut().map(time_ns).collect();
    let earliest = (0..inputs.len()).min_by_key(|&index| times[index]).context("no input")?;
    Ok(inputs[earliest].next().transpose().map_err(|error| BadInput(error.to_string()))?)
}

fn in_file(path: &Path, error: &RecordingError) -> BadInput {
    BadInput(format!("{}: {error}", path.display()))
}

/// Writes to standard output; a reader that has gone away is no error.
fn say(text: &str) -> anyhow::Result<ExitCode> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(ExitCode::SUCCESS),
    }
}
