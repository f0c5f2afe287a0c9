//! Logs: lines on standard error, for people, for the journal or as JSON.
//!
//! `RADAR_LOG` is the filter (`warn` without one, and for whatever it does not name), `RADAR_LOG_FORMAT` the form: `text`, `json`, or `journal`,
//! which is the default where standard error is connected to the journal: no times and colours, which the
//! journal has, but the severity in front that it reads.

use std::env::{VarError, var};
use std::fmt;
use std::io::IsTerminal;

use tracing::level_filters::LevelFilter;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::format::{Format, Full, Writer};
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use crate::bad_input::BadInput;

const LEVELS: [(&str, LevelFilter); 6] = [
    ("off", LevelFilter::OFF),
    ("error", LevelFilter::ERROR),
    ("warn", LevelFilter::WARN),
    ("info", LevelFilter::INFO),
    ("debug", LevelFilter::DEBUG),
    ("trace", LevelFilter::TRACE),
];

/// Starts logging for this process.
///
/// # Errors
/// [`BadInput`] if `RADAR_LOG` or `RADAR_LOG_FORMAT` says something that means nothing; logging has started all the same.
pub(crate) fn start() -> Result<(), BadInput> {
    let (form, filter) = (wanted("RADAR_LOG_FORMAT", form_named), wanted("RADAR_LOG", filter_of));
    let in_use = filter.as_ref().ok().cloned().flatten().unwrap_or_else(warnings);
    // Whoever read the log may be gone: that is no reason to end, as the panic of an `eprintln!` about it would be.
    let lines = tracing_subscriber::fmt::layer().with_writer(std::io::stderr).log_internal_errors(false);
    let lines = match form.as_ref().ok().copied().flatten().unwrap_or_else(Form::of_surroundings) {
        Form::Json => lines.json().flatten_event(true).boxed(),
        Form::Journal => {
            lines.with_ansi(false).event_format(Journal(Format::default().without_time().with_level(false))).boxed()
        }
        Form::Text => lines.with_ansi(std::io::stderr().is_terminal()).boxed(),
    };
    let started = tracing_subscriber::registry().with(lines).with(in_use).try_init();
    let _ = started; // a second start in one process changes nothing
    form.and(filter).map(|_| ())
}

/// What the environment variable asks for, if it is set.
fn wanted<T>(name: &str, parse: fn(&str) -> Result<T, String>) -> Result<Option<T>, BadInput> {
    match var(name) {
        Ok(text) if text.is_empty() => Ok(None),
        Err(VarError::NotPresent) => Ok(None),
        Ok(text) => parse(&text).map(Some).map_err(|expected| BadInput(format!("{name}={text}: expected {expected}"))),
        Err(VarError::NotUnicode(_)) => Err(BadInput(format!("{name}: expected text in UTF-8"))),
    }
}

fn warnings() -> Targets {
    Targets::new().with_default(LevelFilter::WARN)
}

/// The filter in words: levels, for all or for one part of the chain, separated by commas.
fn filter_of(text: &str) -> Result<Targets, String> {
    let level_named = |name: &str| {
        let found = LEVELS.iter().find(|(level, _)| level.eq_ignore_ascii_case(name));
        let expected = || "off, error, warn, info, debug or trace, or for example warn,recorder=debug".to_string();
        found.map(|&(_, level)| level).ok_or_else(expected)
    };
    text.split(',').map(str::trim).try_fold(warnings(), |filter, part| match part.split_once('=') {
        None => Ok(filter.with_default(level_named(part)?)),
        Some((target, level)) => Ok(filter.with_target(target.replace('-', "_"), level_named(level)?)),
    })
}

/// Form of the lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Text,
    Json,
    Journal,
}

impl Form {
    /// The form where none is asked for.
    fn of_surroundings() -> Self {
        if std::env::var_os("JOURNAL_STREAM").is_some() { Self::Journal } else { Self::Text }
    }
}

fn form_named(name: &str) -> Result<Form, String> {
    match name {
        "text" => Ok(Form::Text),
        "json" => Ok(Form::Json),
        "journal" => Ok(Form::Journal),
        _ => Err("text, json or journal".to_string()),
    }
}

/// Whether the log is read by a program: then everything on standard error is a record with a severity.
pub(crate) fn is_for_programs() -> bool {
    wanted("RADAR_LOG_FORMAT", form_named).ok().flatten().unwrap_or_else(Form::of_surroundings) != Form::Text
}

/// The plain form behind a severity as `sd-daemon(3)` defines it.
struct Journal(Format<Full, ()>);

impl<S, N> FormatEvent<S, N> for Journal
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        let severity = match *event.metadata().level() {
            Level::ERROR => 3,
            Level::WARN => 4,
            Level::INFO => 6,
            _ => 7,
        };
        write!(writer, "<{severity}>")?;
        self.0.format_event(context, writer, event)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_names_levels_for_all_and_for_parts() {
        let filter = filter_of("info, plot-source=debug,recorder=off").expect("a filter");
        let would = |target: &str, level: Level| filter.would_enable(target, &level);
        assert!(would("tracker::process", Level::INFO) && !would("tracker::process", Level::DEBUG));
        assert!(would("plot_source::clock", Level::DEBUG) && !would("recorder", Level::ERROR));
        let part_alone = filter_of("recorder=info").expect("a filter");
        assert!(part_alone.would_enable("tracker", &Level::WARN), "the others keep the default");
    }

    #[test]
    fn what_means_nothing_is_refused() {
        for text in ["nonsense", "nonsense=", "recorder=loud", "info,,"] {
            assert!(filter_of(text).is_err(), "{text}");
        }
        assert!(form_named("xml").is_err());
    }
}
