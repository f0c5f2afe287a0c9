//! The configuration of a chain: one TOML file, a table per process.
//!
//! Order: defaults, then the file, then `--set table.key=value`. Unknown keys are
//! errors, every range is checked at start-up, and the effective configuration can be
//! printed and is embedded in every recording. A [`ChainConfig`] that exists is valid.
//!
//! Keys carry their unit; angles are in degrees here and in radians everywhere else.

mod bank;
mod budget;
mod display;
mod explain;
mod extractor;
mod fusion;
mod ipc;
mod keys;
mod link;
mod load;
mod outputs;
mod plot_source;
mod radar;
mod realtime;
mod recorder;
mod replay;
mod run;
mod sim;
mod site;
mod sites;
mod soak;
mod supervision;
mod tracker;
mod turn;
mod video_source;

pub use bank::{BandwidthConfig, BankConfig, OutputRule};
pub use budget::{Budget, BudgetConfig};
pub use display::DisplayConfig;
pub use explain::{explained, explained_key, reference};
pub use extractor::{Cfar, ExtractorConfig};
pub use fusion::FusionConfig;
pub use ipc::IpcConfig;
pub use link::LinkConfig;
pub use load::ConfigError;
pub use outputs::{Affiliation, Destination, OutputConfig, OutputFormat, Sent, TargetClass};
pub use plot_source::*;
pub use radar::{RadarConfig, RadarGrid};
pub use realtime::{RealtimeConfig, Scheduling, StageRealtime, WaitStrategy};
pub use recorder::{RecorderConfig, ScoringConfig};
pub use replay::ReplayConfig;
pub use run::{Mode, RunConfig, Source, Speed};
pub use sim::{ClutterConfig, MotionConfig, SimConfig, Swerling, TargetConfig};
pub use site::{Position, SiteConfig};
pub use sites::{Sites, adjust, load, load_sites, parse, parse_recorded, parse_sites};
pub use soak::{MetricsConfig, SoakConfig};
pub use supervision::{SupervisionConfig, WatchdogConfig};
pub use tracker::*;
pub use turn::TurnConfig;
pub use video_source::VideoSourceConfig;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Everything that the chain of one site needs to know; [`Sites`] has one for each.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ChainConfig {
    /// `[site]`: which radar this is.
    pub site: SiteConfig,
    /// `[run]`: what runs, how long, how fast.
    pub run: RunConfig,
    /// `[ipc]`: shared memory.
    pub ipc: IpcConfig,
    /// `[radar]`: scan and resolution cells of the simulated radar, or of the one whose video is recorded.
    pub radar: RadarConfig,
    /// `[sim]`: targets and clutter.
    pub sim: SimConfig,
    /// `[extractor]`: detection.
    pub extractor: ExtractorConfig,
    /// `[tracker]`: tracking.
    pub tracker: TrackerConfig,
    /// `[recorder]`: recording.
    pub recorder: RecorderConfig,
    /// `[plot_source]`: recordings of real radars.
    pub plot_source: PlotSourceConfig,
    /// `[video_source]`: radar video; `[radar]` says how many dwells a turn has.
    pub video_source: VideoSourceConfig,
    /// `[fusion]`: tracks of several sites to one set of system tracks.
    pub fusion: FusionConfig,
    /// `[link]`: topics to and from other hosts.
    pub link: LinkConfig,
    /// `[replay]`: a recording in place of a radar.
    pub replay: ReplayConfig,
    /// `[budget]`: latency limits.
    pub budget: BudgetConfig,
    /// `[supervision]`: what happens when a stage dies.
    pub supervision: SupervisionConfig,
    /// `[watchdog]`: when a stage says that its input is silent or that it is slow.
    pub watchdog: WatchdogConfig,
    /// `[realtime]`: processors, priorities and memory of the stages.
    pub realtime: RealtimeConfig,
    /// `[soak]`: limits of a soak test.
    pub soak: SoakConfig,
    /// `[metrics]`: counters for Prometheus.
    pub metrics: MetricsConfig,
    /// `[display]`: the picture in a browser.
    pub display: DisplayConfig,
    /// `[outputs.NAME]`: tracks or plots to other systems.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub outputs: BTreeMap<String, OutputConfig>,
}

impl ChainConfig {
    /// Checks every range; called by [`load`] and [`parse`].
    fn check(&self) -> Result<(), ConfigError> {
        self.site.check()?;
        self.run.check()?;
        self.ipc.check()?;
        self.radar.check()?;
        self.sim.check()?;
        self.extractor.check()?;
        self.tracker.check()?;
        self.recorder.check()?;
        self.plot_source.check()?;
        self.video_source.check()?;
        self.fusion.check()?;
        self.link.check()?;
        if self.run.source == Source::Link || !self.link.send.is_empty() {
            self.link.check_ways()?;
        }
        self.replay.check()?;
        self.budget.check()?;
        self.supervision.check()?;
        self.watchdog.check()?;
        self.realtime.check()?;
        self.soak.check()?;
        self.metrics.check()?;
        self.display.check()?;
        self.outputs.iter().try_for_each(|(name, output)| output.check(name, self))
    }

    /// The configuration as TOML, complete: what `radar-chain config` prints.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a checked configuration can be written as TOML")
    }

    /// The source that the data is from: of a replay, that of the recorded run.
    pub fn origin(&self) -> Source {
        if self.run.source == Source::Replay { self.replay.of } else { self.run.source }
    }

    /// Length of a scan of whichever source is configured, measurement time, s.
    pub fn scan_period_s(&self) -> f64 {
        match self.origin() {
            Source::RadarSim | Source::VideoSource => self.radar.scan_period_s,
            Source::Fusion => self.fusion.cycle_s,
            Source::PlotSource | Source::External | Source::Link | Source::Replay => self.plot_source.scan_period_s,
        }
    }

    /// Sectors in a scan of whichever source is configured.
    pub fn sectors_per_scan(&self) -> u32 {
        match self.origin() {
            Source::RadarSim | Source::VideoSource => self.radar.sectors_per_scan,
            Source::Fusion => self.fusion.sectors,
            Source::PlotSource | Source::External | Source::Link | Source::Replay => self.plot_source.sectors_per_scan,
        }
    }
}
