//! Logs: lines on standard error, for people, for the journal or as JSON.
//!
//! `RADAR_LOG` is the filter (`warn` without one), `RADAR_LOG_FORMAT` the form: `text`, `json`, or `journal`,
//! which is the default where standard error is connected to the journal: no times and colours, which the
//! journal has, but the severity in front that it reads.

use std::fmt;
use std::io::IsTerminal;

use tracing::{Event, Level, Subscriber};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::format::{Format, Full, Writer};
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::registry::LookupSpan;

/// Starts logging for this process.
pub(crate) fn start() {
    let filter = EnvFilter::try_from_env("RADAR_LOG").unwrap_or_else(|_| EnvFilter::new("warn"));
    // Whoever read the log may be gone: that is no reason to end, as the panic of an `eprintln!` about it would be.
    let lines =
        tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).log_internal_errors(false);
    let started = match form().as_str() {
        "json" => lines.json().flatten_event(true).try_init(),
        "journal" => {
            lines.with_ansi(false).event_format(Journal(Format::default().without_time().with_level(false))).try_init()
        }
        _ => lines.with_ansi(std::io::stderr().is_terminal()).try_init(),
    };
    let _ = started; // a second start in one process changes nothing
}

/// Whether the log is read by a program: then everything on standard error is a record with a severity.
pub(crate) fn is_for_programs() -> bool {
    form() != "text"
}

fn form() -> String {
    let in_journal = || if std::env::var_os("JOURNAL_STREAM").is_some() { "journal" } else { "text" }.to_string();
    std::env::var("RADAR_LOG_FORMAT").unwrap_or_else(|_| in_journal())
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
