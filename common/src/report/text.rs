//! The report as text for a terminal.

use std::fmt::Write;

use crate::health::FalseAlarms;
use crate::latency::LATENCY_NAMES;

use super::{Detection, LimitResult, Percentiles, Report, TrackSummary, Tracking};

/// Gaps that the text names one by one.
const LISTED_GAPS: usize = 10;
/// Tracks that the text lists one by one.
const LISTED_TRACKS: usize = 20;

impl Report {
    /// The report for a terminal.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing into a String cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    /// The scores alone, for a terminal.
    pub fn scores_to_text(&self) -> String {
        let mut text = String::new();
        let _ = self.detection.write_text(&mut text).and_then(|()| self.tracking.write_text(&mut text));
        text
    }

    /// The table of processes alone, for a terminal.
    pub(super) fn processes_to_text(&self) -> String {
        let mut text = String::new();
        let _ = self.write_processes(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let comparable = if self.comparable { "" } else { "  (not comparable: real-time mode, losses or a restart)" };
        writeln!(
            out,
            "{} scans in {:.1} s: {:.2} × real time, {} messages lost{comparable}",
            self.scans,
            self.wall_s,
            self.realtime_factor,
            self.lost()
        )?;
        for (topic, consumers) in &self.loss {
            for (consumer, lost) in consumers.iter().filter(|&(_, &lost)| lost > 0) {
                writeln!(out, "  lost: {lost} {topic} by {consumer}")?;
            }
        }
        for (topic, observers) in &self.observers {
            for (observer, lost) in observers.iter().filter(|&(_, &lost)| lost > 0) {
                writeln!(out, "  observer {observer} has missed {lost} {topic}; the chain did not wait for it")?;
            }
        }
        self.write_latencies(out)?;
        self.detection.write_text(out)?;
        self.tracking.write_text(out)?;
        self.write_processes(out)?;
        if let Some(recording) = &self.recording {
            let parts = if self.parts > 1 { format!("  ({} parts)", self.parts) } else { String::new() };
            writeln!(out, "\nrecording {recording}{parts}")?;
        }
        if self.removed_recordings > 0 {
            writeln!(out, "  {} old recordings removed", self.removed_recordings)?;
        }
        self.gaps.iter().take(LISTED_GAPS).try_for_each(|gap| writeln!(out, "  gap in {gap}"))?;
        if self.gaps.len() > LISTED_GAPS {
            writeln!(out, "  and {} more gaps", self.gaps.len() - LISTED_GAPS)?;
        }
        Ok(())
    }

    fn write_latencies(&self, out: &mut String) -> std::fmt::Result {
        if self.latency_us.values().all(|latency| latency.n == 0) {
            return Ok(());
        }
        let [n, max] = ["n", "max"];
        writeln!(
            out,
            "\n{:<10}{n:>9}{:>8}{:>8}{:>8}{:>8}{max:>9}  budget",
            "latency µs", "p50", "p90", "p99", "p99.9"
        )?;
        // In the order of the way through the chain, as the live status has them.
        let known = LATENCY_NAMES.iter().filter_map(|name| Some((*name, self.latency_us.get(*name)?)));
        for (name, latency) in known.filter(|(_, latency)| latency.n > 0) {
            let Percentiles { n, p50, p90, p99, p999, max } = latency;
            write!(out, "{name:<10}{n:>9}{p50:>8.0}{p90:>8.0}{p99:>8.0}{p999:>8.0}{max:>9.0}")?;
            for (place, limit) in self.budget.get(name).iter().flat_map(|budget| &budget.limits).enumerate() {
                let separator = if place == 0 { "  " } else { ", " };
                let verdict = match limit {
                    LimitResult { applied: false, .. } => "not applied".into(),
                    LimitResult { ok: true, .. } => format!("≤ {:.0}", limit.limit_us),
                    _ => format!("> {:.0} BROKEN", limit.limit_us),
                };
                write!(out, "{separator}p{} {verdict}", limit.percentile)?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    fn write_processes(&self, out: &mut String) -> std::fmt::Result {
        if self.processes.is_empty() {
            return Ok(());
        }
        writeln!(out, "\n{:<16}{:>9}{:>12}{:>10}   rejected input", "process", "CPU s", "memory MiB", "restarts")?;
        for (name, used) in &self.processes {
            write!(out, "{name:<16}{:>9.2}{:>12.1}{:>10}", used.cpu_s, used.rss_mib_max, used.restarts)?;
            for (place, (reason, count)) in used.rejected.iter().enumerate() {
                write!(out, "{}{count} {reason}", if place == 0 { "   " } else { ", " })?;
            }
            if !used.refused.is_empty() {
                write!(out, "   refused: {}", used.refused.join(", "))?;
            }
            writeln!(out)?;
        }
        for (name, used) in &self.processes {
            if let Some(warning) = used.false_alarms.and_then(FalseAlarms::warning) {
                writeln!(out, "WARNING {name}: {warning}")?;
            }
        }
        Ok(())
    }
}

impl Detection {
    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "\ndetection")?;
        let mut lines = Lines(out);
        lines.whole("plots", Some(self.plots))?;
        lines.whole("left out of full messages", Some(self.left_out).filter(|&left_out| left_out > 0))?;
        lines.whole("false plots", self.false_plots)?;
        lines.whole("looks at unresolved targets", self.unresolved)?;
        lines.share("detected", self.pd_measured)?;
        lines.share("detected, expected", self.pd_expected)?;
        if let (Some(measured), Some([low, high])) = (self.pfa_measured, self.pfa_interval) {
            let set = self.pfa_set.unwrap_or_default();
            let interval = format!("{measured:.3e} [{low:.2e}, {high:.2e}], set {set:.0e}");
            lines.text("false alarms per cell", &interval)?;
        }
        for (axis, value) in &self.normalised_error_squared {
            lines.text(&format!("normalised error² {axis}"), &format!("{value:.3}"))?;
        }
        Ok(())
    }
}

impl Tracking {
    /// The scores of tracks alone, for a terminal.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        writeln!(out, "\ntracking")?;
        let mut lines = Lines(out);
        if let (Some(targets), Some(confirmed)) = (self.targets, self.confirmed) {
            let none = if targets == 0 { " (none was visible for long enough)" } else { "" };
            lines.text("targets confirmed", &format!("{confirmed} of {targets}{none}"))?;
        }
        if let Some(slowest) = self.confirmation_scans.values().max() {
            lines.text("slowest confirmation", &format!("{slowest} scans"))?;
        }
        lines.whole("tracks lost", self.lost)?;
        lines.whole("false tracks", self.false_tracks)?;
        lines.whole("redundant tracks", self.redundant_tracks)?;
        if let (Some(rate), Some([low, high])) = (self.false_tracks_per_hour, self.false_tracks_per_hour_interval) {
            lines.text("false tracks per hour", &format!("{rate:.2} [{low:.2}, {high:.2}]"))?;
        }
        lines.number("redundant tracks per hour", self.redundant_tracks_per_hour, "")?;
        lines.number("position error (rms)", self.position_rmse_m, "m")?;
        lines.number("velocity error (rms)", self.velocity_rmse_mps, "m/s")?;
        if let (Some(nees), Some([dimensions, _])) = (self.nees, self.nees_dimensions) {
            lines.text(
                "NEES (position, velocity)",
                &format!("{nees:.2} over its {dimensions} dimensions, 1 is right"),
            )?;
        }
        if let (Some(nees), Some([_, dimensions])) = (self.nees_position, self.nees_dimensions) {
            lines.text("NEES (position)", &format!("{nees:.2} over its {dimensions} dimensions, 1 is right"))?;
        }
        lines.number("GOSPA", self.gospa_m, "m")?;
        lines.number("  localisation part", self.gospa_localisation_m, "m")?;
        lines.number("  part of missed targets", self.gospa_missed_m, "m")?;
        lines.number("  part of false tracks", self.gospa_false_m, "m")?;
        for (mode, probability) in &self.mode_probability {
            lines.share(&format!("true mode: {mode}"), Some(*probability))?;
        }
        lines.share("truth followed", self.truth_share)?;
        lines.share("aircraft on the ground", self.truth_share_ground)?;
        lines.number("distance, median", self.distance_p50_m, "m")?;
        lines.number("distance, 95 %", self.distance_p95_m, "m")?;
        lines.whole("changes of track number", self.id_changes)?;
        match &self.tracks {
            Some(tracks) if self.truth_hours.is_none() => tracks.write_text(out),
            Some(_) => Ok(()),
            None => Lines(out).whole("confirmed tracks", Some(0)),
        }
    }
}

impl TrackSummary {
    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let mut lines = Lines(out);
        lines.text("confirmed tracks", &format!("{}, {} alive at the end", self.count, self.alive))?;
        lines.text("life, median and 95 %", &format!("{:.1} s, {:.1} s", self.life_p50_s, self.life_p95_s))?;
        lines.share("looks with a plot", Some(self.hit_share))?;
        let [id, life, range] = ["track", "life s", "range m"];
        let [azimuth, speed, course, hits] = ["azimuth °", "speed m/s", "course °", "hits"];
        writeln!(out, "\n{id:>10}{life:>9}{range:>10}{azimuth:>11}{speed:>11}{course:>10}{hits:>16}")?;
        for line in self.list.iter().take(LISTED_TRACKS) {
            writeln!(
                out,
                "{:>10}{:>9.1}{:>10.0}{:>11.2}{:>11.1}{:>10.1}{:>16}{}",
                line.id,
                line.life_s,
                line.range_m,
                line.azimuth_deg,
                line.speed_mps,
                line.course_deg,
                format!("{} of {}", line.hits, line.looks),
                if line.alive { "" } else { "  ended" }
            )?;
        }
        if self.list.len() > LISTED_TRACKS {
            writeln!(out, "  and {} more in report.json", self.list.len() - LISTED_TRACKS)?;
        }
        Ok(())
    }
}

/// Writes indented lines of name and value; absent values have no line.
struct Lines<'a>(&'a mut String);

impl Lines<'_> {
    fn text(&mut self, name: &str, value: &str) -> std::fmt::Result {
        writeln!(self.0, "  {name:<30}{value}")
    }

    fn whole(&mut self, name: &str, value: Option<u64>) -> std::fmt::Result {
        value.map_or(Ok(()), |value| self.text(name, &value.to_string()))
    }

    fn number(&mut self, name: &str, value: Option<f64>, unit: &str) -> std::fmt::Result {
        value.map_or(Ok(()), |value| self.text(name, format!("{value:.2} {unit}").trim_end()))
    }

    fn share(&mut self, name: &str, value: Option<f64>) -> std::fmt::Result {
        value.map_or(Ok(()), |value| self.text(name, &format!("{:.2} %", value * 100.0)))
    }
}
