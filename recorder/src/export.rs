//! Recordings as tables (CSV) and JSON lines, one file per topic.
//!
//! A table has one row per element; the columns of the header that place it come first. A vector
//! takes a column per component, named as in the state: `x_m`, `vx_mps` and so on.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use common::health::REJECT_NAMES;
use common::recording::{Recorded, RecordedRef, RecordingError, jsonl};
use common::services::{TOPIC_NAMES, TOPICS, Topic};
use common::tracks::{STATE, pack};

/// Form of the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// JSON lines, which read back as a recording.
    JsonLines,
}

impl Format {
    fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::JsonLines => "jsonl",
        }
    }
}

/// Why an export stops.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file cannot be written.
    #[error("cannot write {}: {message}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        message: String,
    },
    /// Dwells have neither form.
    #[error("topic `dwells` has no text form: 10⁹ bytes per second")]
    Dwells,
}

/// Names of the components of the state.
const STATE_COLUMNS: [&str; STATE] =
    ["x_m", "vx_mps", "ax_mps2", "y_m", "vy_mps", "ay_mps2", "z_m", "vz_mps", "az_mps2"];

/// Writes the messages of `topics` into `directory`, one file per topic; returns the files with their numbers of rows.
///
/// # Errors
/// [`ExportError`].
pub fn export(
    messages: impl Iterator<Item = Result<Recorded, RecordingError>>,
    topics: &[Topic],
    format: Format,
    directory: &Path,
) -> Result<Vec<(PathBuf, u64)>, ExportError> {
    if topics.contains(&Topic::Dwells) {
        return Err(ExportError::Dwells);
    }
    let failed = |path: &Path, error: &dyn std::fmt::Display| ExportError::Write {
        path: path.to_path_buf(),
        message: error.to_string(),
    };
    std::fs::create_dir_all(directory).map_err(|error| failed(directory, &error))?;
    let mut outputs: [Option<Output>; TOPICS] = Default::default();
    for &topic in topics {
        let path = directory.join(format!("{}.{}", TOPIC_NAMES[topic as usize], format.extension()));
        outputs[topic as usize] =
            Some(Output::create(path.clone(), topic, format).map_err(|error| failed(&path, &error))?);
    }
    for message in messages {
        let message = message?;
        let message = message.by_ref();
        if let Some(output) = &mut outputs[message.topic() as usize] {
            output.write(message).map_err(|error| failed(&output.path, &error))?;
        }
    }
    let outputs = outputs.into_iter().flatten();
    outputs.map(|output| output.finish().map_err(|(path, error)| failed(&path, &error))).collect()
}

struct Output {
    path: PathBuf,
    rows: u64,
    sink: Sink,
}

enum Sink {
    Csv(Box<csv::Writer<File>>),
    JsonLines(jsonl::Writer<BufWriter<File>>),
}

impl Output {
    fn create(path: PathBuf, topic: Topic, format: Format) -> std::io::Result<Self> {
        let file = File::create(&path)?;
        let sink = match format {
            Format::JsonLines => Sink::JsonLines(jsonl::Writer::new(BufWriter::new(file))),
            Format::Csv => {
                let mut table = csv::Writer::from_writer(file);
                table.write_record(columns(topic))?;
                Sink::Csv(Box::new(table))
            }
        };
        Ok(Self { path, rows: 0, sink })
    }

    fn write(&mut self, message: RecordedRef<'_>) -> Result<(), RecordingError> {
        match &mut self.sink {
            Sink::JsonLines(lines) => {
                self.rows += 1;
                lines.write(message)
            }
            Sink::Csv(table) => {
                self.rows += message.len() as u64;
                Ok(write_rows(table, message).map_err(std::io::Error::from)?)
            }
        }
    }

    fn finish(self) -> Result<(PathBuf, u64), (PathBuf, RecordingError)> {
        let finished = match self.sink {
            Sink::Csv(mut table) => table.flush().map_err(RecordingError::Io),
            Sink::JsonLines(lines) => lines.finish(),
        };
        match finished {
            Ok(()) => Ok((self.path, self.rows)),
            Err(error) => Err((self.path, error)),
        }
    }
}

fn columns(topic: Topic) -> Vec<String> {
    let own = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
    match topic {
        Topic::Plots => own(&[
            "seq",
            "scan",
            "sector",
            "time_ns",
            "range_m",
            "azimuth_rad",
            "elevation_rad",
            "range_rate_mps",
            "sigma_range_m",
            "sigma_azimuth_rad",
            "sigma_elevation_rad",
            "sigma_range_rate_mps",
            "statistic",
            "snr_db",
            "cell_count",
            "flags",
        ]),
        Topic::Tracks => {
            let mut names = own(&["seq", "scan", "sector", "id", "time_ns", "state_code"]);
            names.extend(own(&STATE_COLUMNS));
            names.extend(STATE_COLUMNS.iter().map(|name| format!("sigma_{name}")));
            names.extend(own(&[
                "existence",
                "mode_hover",
                "mode_constant_velocity",
                "mode_manoeuvre",
                "plots_in_gate",
                "weight_none",
                "age_scans",
                "hits",
                "misses",
            ]));
            names
        }
        Topic::Truth => {
            let mut names = own(&["seq", "target_id", "time_ns", "mode", "flags", "snr_db"]);
            names.extend(own(&STATE_COLUMNS));
            names
        }
        Topic::Health => {
            let names =
                ["process", "session", "seq", "heartbeat_ns", "cpu_ns", "rss_bytes", "messages_out", "scan", "pid"];
            let mut names = own(&names);
            names.extend(TOPIC_NAMES.iter().map(|topic| format!("received_{topic}")));
            names.extend(TOPIC_NAMES.iter().map(|topic| format!("lost_{topic}")));
            names.extend(REJECT_NAMES.iter().map(|reason| format!("rejected_{reason}")));
            names
        }
        Topic::Dwells => Vec::new(),
    }
}

fn write_rows(table: &mut csv::Writer<File>, message: RecordedRef<'_>) -> csv::Result<()> {
    match message {
        RecordedRef::Plots(header, plots) => plots.iter().try_for_each(|plot| {
            let place = (header.seq, header.scan, header.sector);
            let measured = (plot.time_ns, plot.range_m, plot.azimuth_rad, plot.elevation_rad, plot.range_rate_mps);
            let sigmas =
                (plot.sigma_range_m, plot.sigma_azimuth_rad, plot.sigma_elevation_rad, plot.sigma_range_rate_mps);
            table.serialize((place, measured, sigmas, plot.statistic, plot.snr_db, plot.cell_count, plot.flags))
        }),
        RecordedRef::Tracks(header, tracks) => tracks.iter().try_for_each(|track| {
            let place = (header.seq, header.scan, header.sector, track.id, track.time_ns, track.state_code);
            let sigmas: [f64; STATE] = std::array::from_fn(|axis| track.covariance[pack(axis, axis)].sqrt());
            let association = (track.plots_in_gate, track.weight_none, track.age_scans, track.hits, track.misses);
            table.serialize((place, track.state, sigmas, track.existence, track.mode_probability, association))
        }),
        RecordedRef::Truth(header, targets) => targets.iter().try_for_each(|target| {
            let place = (header.seq, target.target_id, target.time_ns, target.mode, target.flags);
            table.serialize((place, target.snr_db, target.state))
        }),
        RecordedRef::Health(_, reports) => reports.iter().try_for_each(|health| {
            let place = (health.process(), health.session, health.seq, health.heartbeat_ns);
            let used = (health.cpu_ns, health.rss_bytes, health.messages_out, health.scan, health.pid);
            let received = health.intake.map(|intake| intake.received);
            let lost = health.intake.map(|intake| intake.lost);
            table.serialize((place, used, received, lost, health.rejected))
        }),
        RecordedRef::Dwells(..) => Ok(()),
    }
}
