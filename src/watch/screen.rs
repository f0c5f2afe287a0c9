//! Live status: a block that is drawn again in a terminal, plain lines elsewhere.

use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _};
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Sites, Speed};
use common::latency::LATENCY_NAMES;
use common::status::{Board, SiteBoard, counted_inputs};
use crossterm::cursor::MoveToPreviousLine;
use crossterm::style::Stylize;
use crossterm::terminal::{Clear, ClearType, size};
use crossterm::{QueueableCommand, execute};

/// Between two pictures in a terminal.
const REDRAW: Duration = Duration::from_millis(250);
/// Between two lines elsewhere.
const LINE: Duration = Duration::from_secs(5);

/// Where live status goes.
#[derive(Debug)]
pub(crate) struct Screen {
    terminal: bool,
    drawn_lines: u16,
    last: Option<Instant>,
    /// What is left of a run that ends by time.
    left: Option<Duration>,
}

impl Screen {
    /// Standard error, as a terminal or not.
    pub(crate) fn new() -> Self {
        // At first there is nothing to show, and what a stage finds wrong comes alone.
        Self { terminal: std::io::stderr().is_terminal(), drawn_lines: 0, last: Some(Instant::now()), left: None }
    }

    /// Says from now on how long the run still takes.
    pub(crate) fn left(&mut self, left: Duration) {
        self.left = Some(left);
    }

    /// Shows the state of the chain if it is time to.
    pub(crate) fn show(&mut self, sites: &Sites, board: &Board) {
        let pause = if self.terminal { REDRAW } else { LINE };
        if board.is_empty() || self.last.is_some_and(|last| last.elapsed() < pause) {
            return;
        }
        self.last = Some(Instant::now());
        let left = self.left.map_or(String::new(), |left| {
            let s = left.as_secs();
            format!("{}:{:02}:{:02} left  ", s / 3600, s / 60 % 60, s % 60)
        });
        if self.terminal {
            self.draw(&left, &picture(sites, board));
        } else {
            common::process::tell(&format!("{left}{}", line(sites, board)));
        }
    }

    /// Writes a line for the user above the live status.
    pub(crate) fn say(&mut self, text: &str) {
        self.clear();
        common::process::say(text);
    }

    /// Takes the live status away.
    pub(crate) fn clear(&mut self) {
        if self.drawn_lines > 0 {
            let _ = execute!(std::io::stderr(), MoveToPreviousLine(self.drawn_lines), Clear(ClearType::FromCursorDown));
            self.drawn_lines = 0;
        }
    }

    fn draw(&mut self, left: &str, picture: &Picture) {
        let (columns, rows) = size().unwrap_or((80, 24));
        let mut out = std::io::stderr().lock();
        if self.drawn_lines > 0 {
            let _ = out.queue(MoveToPreviousLine(self.drawn_lines));
        }
        let mut count = 0;
        let lead = std::iter::once(left).chain(std::iter::repeat(""));
        for (lead, line) in lead.zip(&picture.0).take(usize::from(rows.saturating_sub(1))) {
            // A line longer than the terminal would wrap and spoil the count of lines.
            let cut = lead.chars().chain(line.text.chars()).take(usize::from(columns.saturating_sub(1))).collect();
            let cut = Line { tone: line.tone, text: cut }.coloured();
            let _ = out.queue(Clear(ClearType::CurrentLine)).and_then(|out| Ok(writeln!(out, "{cut}")?));
            count += 1;
        }
        let _ = out.queue(Clear(ClearType::FromCursorDown));
        let _ = out.flush();
        self.drawn_lines = count;
    }
}

/// What is going on, in a few words.
struct Headline {
    scan: u32,
    plots: u32,
    confirmed: u32,
    alive: u32,
}

impl Headline {
    fn of(board: &SiteBoard) -> Self {
        let tracker = board.of(tracker::process::NAME).copied().unwrap_or_default();
        let scan = board.source().map_or(tracker.scan, |source| source.scan);
        let plots = board.of(plot_extractor::process::NAME).map_or(tracker.plots, |health| health.plots);
        Self { scan, plots, confirmed: tracker.confirmed, alive: tracker.tracks }
    }
}

fn scan_of(chain: &ChainConfig, scan: u32) -> String {
    if chain.run.scans == 0 { format!("scan {}", scan + 1) } else { format!("scan {}/{}", scan + 1, chain.run.scans) }
}

/// One line of status.
fn line(sites: &Sites, board: &Board) -> String {
    let mut text = String::new();
    for (chain, (name, board)) in sites.all().iter().zip(board.sites()) {
        let now = Headline::of(board);
        if sites.only().is_none() {
            let _ = write!(text, "{}{name}: ", if text.is_empty() { "" } else { "   " });
        }
        let _ = write!(
            text,
            "{}  {} plots  {} tracks confirmed, {} alive  {} lost",
            scan_of(chain, now.scan),
            now.plots,
            now.confirmed,
            now.alive,
            board.lost()
        );
        if let Some(recorder) = board.of(recorder::process::NAME) {
            let latency = recorder.latency[common::latency::Latency::EndToEnd as usize];
            if latency.n > 0 {
                let _ = write!(text, "  end to end p50 {:.0} µs, p99 {:.0} µs", latency.p50_us, latency.p99_us);
            }
        }
    }
    text
}

/// How a line of the status is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tone {
    Plain,
    /// Worth a look.
    Warning,
    /// Something was lost.
    Fault,
}

#[derive(Debug)]
struct Line {
    tone: Tone,
    text: String,
}

impl Line {
    /// With the colour of its tone; without one where the environment asks for none (`NO_COLOR`).
    fn coloured(self) -> String {
        match self.tone {
            Tone::Plain => self.text,
            Tone::Warning => self.text.yellow().to_string(),
            Tone::Fault => self.text.red().to_string(),
        }
    }
}

/// The whole status, line by line.
#[derive(Debug, Default)]
pub(crate) struct Picture(Vec<Line>);

impl Picture {
    fn put(&mut self, tone: Tone, text: String) {
        self.0.push(Line { tone, text });
    }

    /// For standard output: coloured in a terminal.
    pub(crate) fn into_text(self) -> String {
        let terminal = std::io::stdout().is_terminal();
        let text = |line: Line| if terminal { line.coloured() } else { line.text };
        self.0.into_iter().map(|line| text(line) + "\n").collect()
    }
}

/// The whole status, site by site: headline, processes, latencies.
pub(crate) fn picture(sites: &Sites, board: &Board) -> Picture {
    let mut picture = Picture::default();
    for (index, (chain, (_, of_site))) in sites.all().iter().zip(board.sites()).enumerate() {
        if index > 0 {
            picture.put(Tone::Plain, String::new());
        }
        put_site(&mut picture, chain, of_site, board.restarts());
    }
    picture
}

fn put_site(picture: &mut Picture, chain: &ChainConfig, board: &SiteBoard, restarts: u32) {
    let now = Headline::of(board);
    let fault = |is_fault: bool| if is_fault { Tone::Fault } else { Tone::Plain };
    picture.put(
        fault(board.lost() > 0 || restarts > 0),
        format!(
            "{}  {}  {}  {}   {} lost   {restarts} restarts   {} tracks confirmed, {} alive   {} plots a scan",
            chain.site.name,
            chain.run.mode.name(),
            chain.run.speed,
            scan_of(chain, now.scan),
            board.lost(),
            now.confirmed,
            now.alive,
            now.plots,
        ),
    );
    picture.put(Tone::Plain, String::new());
    let heads = format!("{:<16}{:>7}{:>10}{:>12}{:>10}   lost", "process", "CPU %", "MiB", "sent", "rejected");
    picture.put(Tone::Plain, heads);
    for (name, health, cpu_share) in board.all() {
        let mut text = format!(
            "{name:<16}{:>7.0}{:>10.1}{:>12}{:>10}",
            cpu_share * 100.0,
            health.rss_bytes as f64 / f64::from(1 << 20),
            health.messages_out,
            health.rejected().map(|(_, count)| count).sum::<u64>()
        );
        let mut lost = 0;
        for (topic, intake) in counted_inputs(health).filter(|(_, intake)| intake.received > 0) {
            let _ = write!(text, "   {} {topic}", intake.lost);
            lost += intake.lost;
        }
        picture.put(fault(lost > 0), text);
    }
    for (name, health, _) in board.all() {
        if let Some(warning) = health.false_alarms.warning() {
            picture.put(Tone::Warning, format!("WARNING {name}: {warning}"));
        }
    }
    for of in board.observers() {
        picture.put(Tone::Warning, format!("observer {} has missed {} {}", of.observer, of.lost, of.topic));
    }
    let Some(recorder) = board.of(recorder::process::NAME) else { return };
    picture.put(Tone::Plain, String::new());
    picture.put(Tone::Plain, format!("{:<16}{:>9}{:>9}   budget", "latency µs", "p50", "p99"));
    for ((name, latency), budget) in LATENCY_NAMES.iter().zip(recorder.latency).zip(chain.budget.all()) {
        if latency.n > 0 {
            let limits: Vec<String> =
                budget.limits().map(|(percentile, limit_us)| format!("p{percentile} ≤ {limit_us:.0}")).collect();
            let applies = chain.run.speed != Speed::Max || budget.further().next().is_some();
            let told = if applies {
                format!("{}, over budget in {} scans", limits.join(", "), latency.misses)
            } else {
                "not applied at full speed".to_string()
            };
            let tone = if applies && latency.misses > 0 { Tone::Warning } else { Tone::Plain };
            picture.put(tone, format!("{name:<16}{:>9.0}{:>9.0}   {told}", latency.p50_us, latency.p99_us));
        }
    }
}
