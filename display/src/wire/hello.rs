//! The first message: what there is to see.

use std::collections::BTreeMap;

use common::config::{ChainConfig, Estimator, Position, Sites, Source};
use common::latency::LATENCY_NAMES;
use common::messages::{ForTopic, Message};
use common::topic::Topic;
use common::topology::{self, Stage};
use schemars::JsonSchema;
use serde::Serialize;

use crate::picture::Picture;

/// Version of the messages.
pub const VERSION: u32 = 1;

/// Where the picture comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// A running chain.
    Live,
    /// A recording.
    Recording,
}

/// The extent of a recording.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Extent {
    /// Measurement time of its first message, s UTC.
    pub from_s: f64,
    /// Measurement time of its last message, s UTC.
    pub to_s: f64,
    /// Files that it consists of.
    pub files: usize,
}

/// What there is to see.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Chain {
    /// Version of the messages.
    pub version: u32,
    /// Version of the program.
    pub program: &'static str,
    /// Where the picture comes from.
    pub mode: Mode,
    /// Whether viewers may act.
    pub control: bool,
    /// Where the first antenna stands (WGS-84), if that is known: the origin of the picture.
    pub origin: Option<Place>,
    /// The sites.
    pub sites: Vec<Site>,
    /// The processes and what passes between them.
    pub stages: Vec<StageOfChain>,
    /// Messages for which there is room in the queue of a consumer, by topic.
    pub queues: BTreeMap<&'static str, usize>,
    /// The extent of the recording.
    pub recording: Option<Extent>,
}

/// A place (WGS-84).
#[derive(Debug, Serialize, JsonSchema)]
pub struct Place {
    latitude_deg: f64,
    longitude_deg: f64,
    height_m: f64,
}

/// One radar.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Site {
    name: String,
    source: Source,
    /// Its antenna in the picture: east, north, up, m.
    origin_m: [f64; 3],
    /// Nearest range, m.
    range_min_m: f64,
    /// Farthest range, m; `null` where it is not known.
    range_max_m: Option<f64>,
    /// Time of a scan, s.
    scan_period_s: f64,
    /// Azimuth steps of a scan; 0 without cells.
    dwells_per_scan: u32,
    sectors_per_scan: u32,
    /// Beams over each other; 0 without cells.
    elevations: u32,
    /// Doppler cells; 0 without cells.
    dopplers: u32,
    /// Range cells; 0 without cells.
    ranges: u32,
    /// 3 where height is measured, otherwise 2.
    dimensions: u32,
    /// Whether there is radar video.
    has_video: bool,
    /// Whether there is truth.
    has_truth: bool,
    /// Family of the tracker's filter.
    estimator: Estimator,
    /// Names of its models of motion, once a track has told them.
    models: Vec<String>,
    /// Kinds of maps that can be asked for: `clutter`, where false plots fall.
    maps: Vec<&'static str>,
    /// Limits of latencies by name, µs.
    budgets_us: BTreeMap<&'static str, f64>,
}

/// One process.
#[derive(Debug, Serialize, JsonSchema)]
pub struct StageOfChain {
    name: &'static str,
    /// The site that it works for; `null` where it serves all of them.
    site: Option<String>,
    /// Topics that it reads.
    inputs: Vec<&'static str>,
    /// Topics that it publishes.
    outputs: Vec<&'static str>,
    /// Whether the chain depends on it.
    observer: bool,
}

/// `hello`: the same as a message.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Hello<'a> {
    r#type: &'static str,
    #[serde(flatten)]
    chain: &'a Chain,
}

impl<'a> Hello<'a> {
    /// The message.
    pub fn new(chain: &'a Chain) -> Self {
        Self { r#type: "hello", chain }
    }
}

impl Chain {
    /// What there is to see of these sites.
    pub fn new(sites: &Sites, picture: &Picture, recording: Option<Extent>) -> Self {
        let place = |of: Position| Place {
            latitude_deg: of.latitude_deg,
            longitude_deg: of.longitude_deg,
            height_m: of.height_m,
        };
        let of_sites = sites.all().iter().zip(&picture.sites);
        Self {
            version: VERSION,
            program: env!("CARGO_PKG_VERSION"),
            mode: if recording.is_some() { Mode::Recording } else { Mode::Live },
            control: false,
            origin: sites.first().site.position.map(place),
            sites: of_sites.map(|(site, picture)| Site::new(site, picture)).collect(),
            stages: stages(sites),
            queues: Topic::ALL.into_iter().map(|topic| (topic.name(), topic.apply(Room))).collect(),
            recording,
        }
    }
}

impl Site {
    fn new(site: &ChainConfig, picture: &crate::picture::site::SitePicture) -> Self {
        let radar = &site.radar;
        let has_cells = matches!(site.origin(), Source::RadarSim | Source::VideoSource);
        let cells = |count: u32| if has_cells { count } else { 0 };
        let (range_min_m, range_max_m) = picture.ranges_m;
        let budgets = LATENCY_NAMES.into_iter().zip(site.budget.all());
        let measures_height = has_cells && radar.elevations > 1 || site.origin() == Source::Fusion;
        let models = picture.models.clone();
        Self {
            name: site.site.name.clone(),
            source: site.run.source,
            origin_m: picture.place.position_m([0.0; 3]),
            range_min_m,
            range_max_m,
            scan_period_s: site.scan_period_s(),
            dwells_per_scan: cells(radar.dwells_per_scan),
            sectors_per_scan: site.sectors_per_scan(),
            elevations: cells(radar.elevations),
            dopplers: cells(radar.dopplers),
            ranges: cells(radar.ranges),
            dimensions: if measures_height { 3 } else { 2 },
            has_video: topology::runs(site, "plot-extractor"),
            has_truth: site.origin() != Source::External,
            estimator: site.tracker.estimator,
            models,
            maps: if topology::runs(site, topology::TRACKER) { vec!["clutter"] } else { Vec::new() },
            budgets_us: budgets.map(|(name, budget)| (name, budget.limit_us)).collect(),
        }
    }
}

/// Room in the queue of a consumer of a topic, messages.
struct Room;

impl ForTopic for Room {
    type Out = usize;

    fn call<M: Message>(self) -> usize {
        M::QUEUE
    }
}

/// The processes of the chain, upstream first, those that serve all sites last and once.
fn stages(sites: &Sites) -> Vec<StageOfChain> {
    let of_chain = |stage: &&Stage, site: Option<&str>| StageOfChain {
        name: stage.name,
        site: site.map(String::from),
        inputs: stage.inputs.iter().map(|input| input.topic.name()).collect(),
        outputs: stage.outputs.iter().map(|topic| topic.name()).collect(),
        observer: stage.is_observer(),
    };
    let mut all = Vec::new();
    for site in sites.all() {
        let own = topology::stages(site).into_iter().filter(|stage| !stage.is_of_chain());
        all.extend(own.map(|stage| of_chain(&stage, Some(&site.site.name))));
    }
    let shared = topology::stages(sites.first()).into_iter().filter(|stage| stage.is_of_chain());
    all.extend(shared.map(|stage| of_chain(&stage, None)));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_chain_introduces_itself() {
        let sites = Sites::one(ChainConfig::default());
        let chain = Chain::new(&sites, &Picture::new(&sites), None);
        let hello = serde_json::to_value(Hello::new(&chain)).expect("JSON");
        assert_eq!((hello["type"].as_str(), hello["mode"].as_str()), (Some("hello"), Some("live")));
        let site = &hello["sites"][0];
        assert_eq!((site["dimensions"].as_u64(), site["has_video"].as_bool()), (Some(3), Some(true)));
        let [near, far] = ["range_min_m", "range_max_m"].map(|key| site[key].as_f64().expect("a range"));
        assert!((near - 199.95).abs() < 1e-9 && (far - near - 70.0 * 69.3).abs() < 1e-6, "{near} {far}");
        let names: Vec<_> = hello["stages"].as_array().expect("a list").iter().map(|of| of["name"].as_str()).collect();
        assert_eq!(names, ["radar-sim", "plot-extractor", "tracker", "recorder", "display"].map(Some));
    }
}
