//! The report of a chain: that of its only site, schema 1, or of several sites, schema 2.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::{ProcessUse, Report, SCHEMA};
use crate::config::Sites;
use crate::topology::Stage;

/// Version of the layout for several sites; keys are only added within a version.
pub const SCHEMA_OF_SITES: u32 = 2;

/// What a run of several sites did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SitesReport {
    /// [`SCHEMA_OF_SITES`].
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// Commit of the program; `unknown` outside a repository.
    pub git: String,
    /// Identity of the run.
    pub run: String,
    /// Seed of every random draw.
    pub seed: u64,
    /// Scans that went through the whole chain of every site.
    pub scans: u64,
    /// Wall-clock time of the slowest site from its first to its last message, s.
    pub wall_s: f64,
    /// Measurement time that every site has worked off, over the wall-clock time.
    pub realtime_factor: f64,
    /// Whether results of every site can be compared byte by byte with another run.
    pub comparable: bool,
    /// By name of the site: what the report of a single site holds, but for the processes.
    pub sites: BTreeMap<String, Report>,
    /// Resources, by process: `SITE/PROCESS`, or the name alone where a process serves all sites.
    pub processes: BTreeMap<String, ProcessUse>,
}

/// What a run did.
#[derive(Debug, Clone, PartialEq)]
pub enum ChainReport {
    /// Of one site.
    One(Box<Report>),
    /// Of several sites.
    Several(SitesReport),
}

impl ChainReport {
    /// From the reports of all sites, in their order.
    pub fn new(reports: Vec<Report>, sites: &Sites) -> Self {
        let mut reports = reports;
        if reports.len() == 1
            && let Some(only) = reports.pop()
        {
            return Self::One(Box::new(only));
        }
        let first = sites.first();
        let wall_s = reports.iter().map(|report| report.wall_s).fold(0.0, f64::max);
        let measured_s =
            reports.iter().map(|report| report.realtime_factor * report.wall_s).fold(f64::INFINITY, f64::min);
        let mut several = SitesReport {
            schema: SCHEMA_OF_SITES,
            version: env!("CARGO_PKG_VERSION").to_string(),
            git: reports.first().map(|report| report.git.clone()).unwrap_or_default(),
            run: first.run.id.clone(),
            seed: first.run.seed,
            scans: reports.iter().map(|report| report.scans).min().unwrap_or(0),
            wall_s,
            realtime_factor: if wall_s > 0.0 { measured_s / wall_s } else { 0.0 },
            comparable: reports.iter().all(|report| report.comparable),
            ..SitesReport::default()
        };
        for (name, mut report) in sites.names().into_iter().zip(reports) {
            for (process, used) in std::mem::take(&mut report.processes) {
                let of_site = Stage::from_name(&process).is_some_and(|stage| !stage.is_of_chain());
                several.processes.entry(if of_site { format!("{name}/{process}") } else { process }).or_insert(used);
            }
            several.sites.insert(name.to_string(), report);
        }
        Self::Several(several)
    }

    /// From `report.json`; `None` if it is not one.
    pub fn from_json(text: &str) -> Option<Self> {
        #[derive(Deserialize)]
        struct Version {
            schema: u32,
        }
        match serde_json::from_str::<Version>(text).ok()?.schema {
            SCHEMA => serde_json::from_str(text).ok().map(|report| Self::One(Box::new(report))),
            SCHEMA_OF_SITES => serde_json::from_str(text).ok().map(Self::Several),
            _ => None,
        }
    }

    /// As `report.json`.
    pub fn to_json(&self) -> String {
        match self {
            Self::One(report) => report.to_json(),
            Self::Several(report) => {
                let mut text = serde_json::to_string_pretty(report).expect("a report has only text keys");
                text.push('\n');
                text
            }
        }
    }

    /// For a terminal.
    pub fn to_text(&self) -> String {
        let report = match self {
            Self::One(report) => return report.to_text(),
            Self::Several(report) => report,
        };
        let mut text = String::new();
        for (name, of_site) in &report.sites {
            let _ = writeln!(text, "== {name}\n{}", of_site.to_text());
        }
        let resources = Report { processes: report.processes.clone(), ..Report::default() };
        let _ = writeln!(
            text,
            "== {} sites in {:.1} s: {:.2} × real time, {} messages lost{}",
            report.sites.len(),
            report.wall_s,
            report.realtime_factor,
            self.lost(),
            resources.processes_to_text()
        );
        text
    }

    /// The reports of the sites, by name.
    pub fn sites(&self) -> Vec<(&str, &Report)> {
        match self {
            Self::One(report) => {
                vec![(report.config.as_ref().map_or("", |config| config.site.name.as_str()), &**report)]
            }
            Self::Several(report) => report.sites.iter().map(|(name, report)| (name.as_str(), report)).collect(),
        }
    }

    /// Resources, by process.
    pub fn processes(&self) -> &BTreeMap<String, ProcessUse> {
        match self {
            Self::One(report) => &report.processes,
            Self::Several(report) => &report.processes,
        }
    }

    /// Messages lost in all, observers aside.
    pub fn lost(&self) -> u64 {
        self.sites().iter().map(|(_, report)| report.lost()).sum()
    }

    /// Identity of the run.
    pub fn run(&self) -> &str {
        match self {
            Self::One(report) => report.config.as_ref().map_or("", |config| config.run.id.as_str()),
            Self::Several(report) => &report.run,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::parse_sites;

    #[test]
    fn the_report_of_several_sites_holds_each_and_the_processes_of_all() {
        let position = "position = { latitude_deg = 50.0, longitude_deg = 30.0 }";
        let text = format!("[[site]]\nname = \"a\"\n{position}\n[[site]]\nname = \"b\"\n{position}\n");
        let sites = parse_sites(std::path::Path::new("x.toml"), &text, &[]).expect("valid");
        let report = |scans, wall_s, factor| {
            let processes = ["tracker", "recorder"].map(|name| (name.to_string(), ProcessUse::default()));
            let mut report =
                Report { scans, wall_s, realtime_factor: factor, processes: processes.into(), ..Report::default() };
            report.loss.entry("plots".into()).or_default().insert("tracker".into(), scans);
            report
        };
        let chain = ChainReport::new(vec![report(8, 2.0, 4.0), report(9, 3.0, 3.0)], &sites);
        let ChainReport::Several(several) = &chain else { panic!("two sites") };
        assert_eq!((several.scans, several.wall_s, chain.lost()), (8, 3.0, 17));
        assert!((several.realtime_factor - 8.0 / 3.0).abs() < 1e-12);
        let names: Vec<&String> = chain.processes().keys().collect();
        assert_eq!(names, ["a/tracker", "b/tracker", "recorder"]);
        assert_eq!(ChainReport::from_json(&chain.to_json()).as_ref(), Some(&chain));
        assert!(chain.to_text().contains("== 2 sites in 3.0 s: 2.67 × real time, 17 messages lost"));
        let one = ChainReport::new(vec![report(8, 2.0, 4.0)], &Sites::one(sites.first().clone()));
        assert!(matches!(one, ChainReport::One(_)));
    }
}
