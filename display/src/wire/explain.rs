//! A track explains itself: its state with errors, its models, gates and plots, and the way of its last update.

use common::geometry::Polar;
use common::message::Stamps;
use common::tracks::{
    COASTING, CONFIRMED, GATE_MOST_PROBABLE, GATE_UNION, GATE_WIDEST, GATE_WIDEST_FALLBACK, STATE, TENTATIVE, Track,
    pack,
};
use common::units::NS_PER_S;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use super::plots::position_m;
use super::tracks::{StampsUs, knows_height, of_plots};
use crate::picture::site::SitePicture;

/// Names of the components of the state by the place of their coordinate: position, velocity, acceleration.
const COMPONENTS: [[&str; 3]; 3] = [["x", "y", "z"], ["vx", "vy", "vz"], ["ax", "ay", "az"]];

/// Everything that is known of one track.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TrackMessage {
    /// Always `track`.
    r#type: &'static str,
    site: String,
    id: u64,
    /// What operators call it.
    label: Option<String>,
    /// Measurement time of the state, s UTC.
    time_s: f64,
    /// Components that the filter knows, in the axes of the picture: `x`, `vx`, `ax` and so on; m, m/s, m/s².
    state: Map<String, Value>,
    /// Standard errors of the same.
    sigma: Map<String, Value>,
    models: Vec<Model>,
    /// Probability that the track follows a target.
    existence: f64,
    /// `null` where the track is fused of others, as the counts of plots and scans.
    snr_db: Option<f32>,
    hits: Option<u32>,
    misses: u32,
    age_scans: Option<u32>,
    /// `tentative`, `confirmed`, `coasting` or `ended`.
    state_name: &'static str,
    gate: Gate,
    /// The plots of the last update, by weight.
    used: Vec<Used>,
    /// Weight of "no plot in the gate is mine".
    weight_none: f64,
    /// The way of the last dwell of the last update to this message, hop by hop, µs.
    latency_us: Map<String, Value>,
}

/// A model of motion.
#[derive(Debug, Serialize, JsonSchema)]
struct Model {
    name: String,
    probability: f64,
    /// Turn rate rad/s or mean acceleration m/s², by kind; 0 where it has none.
    parameter: f64,
}

/// The gate of the last update.
#[derive(Debug, Serialize, JsonSchema)]
struct Gate {
    /// `none`, `most_probable`, `widest_fallback`, `widest` or `union`.
    kind: &'static str,
    /// m³·m/s, fewer dimensions where plots have fewer.
    volume: f64,
    /// Plots in it.
    #[serde(rename = "in_gate")]
    plots: Option<u32>,
    /// Where it lies; `null` while no plots have told how large a resolution cell is. That of all models together: a gate rule that chooses one searches less.
    region: Option<Region>,
}

/// The gate of all models together for a plot of nominal errors, about the antenna of the site (T9).
#[derive(Debug, Serialize, JsonSchema)]
struct Region {
    range_from_m: f64,
    range_to_m: f64,
    azimuth_from_rad: f64,
    azimuth_to_rad: f64,
    /// Of its centre.
    elevation_rad: f64,
}

/// A plot that took part in the last update.
#[derive(Debug, Serialize, JsonSchema)]
struct Used {
    /// `seq` of the message of plots that holds it.
    seq: u64,
    /// Its index in that message.
    index: u32,
    /// Probability that it is the track's.
    weight: f32,
    /// Bit j is set if it lies in the gate of model j.
    gates: u32,
    /// Where it is in the picture, m; `null` where its message is kept no longer.
    x_m: Option<f64>,
    y_m: Option<f64>,
    z_m: Option<f64>,
}

impl TrackMessage {
    /// A track of a site; `way` is where the message of its last update has been and when it came, `display_out_ns` CLOCK_MONOTONIC
    /// now.
    pub fn new(site: &SitePicture, track: &Track, way: &(Stamps, u64), display_out_ns: u64) -> Self {
        let (state, sigma) = state_of(site, track);
        let models = (0..usize::from(track.models).min(track.model_probability.len())).map(|index| Model {
            name: site.models.get(index).cloned().unwrap_or_default(),
            probability: track.model_probability[index],
            parameter: track.model_parameter[index],
        });
        let used = track.used.iter().filter(|used| used.weight > 0.0).map(|used| {
            let position = site.plot(used.seq, used.index).map(|plot| position_m(plot, &site.place));
            let axis = |axis: usize| position.map(|position| position[axis]).filter(|metres| metres.is_finite());
            let (seq, index, weight, gates) = (used.seq, used.index, used.weight, used.gates);
            Used { seq, index, weight, gates, x_m: axis(0), y_m: axis(1), z_m: axis(2) }
        });
        // A recording is read at no time of this clock.
        let (stamps, taken_ns) = way;
        let way = StampsUs::new(stamps, *taken_ns, if *taken_ns == 0 { 0 } else { display_out_ns });
        Self {
            r#type: "track",
            site: site.name.clone(),
            id: track.id,
            label: site.operated.labels.get(&track.id).cloned(),
            time_s: track.time_ns as f64 / NS_PER_S,
            state,
            sigma,
            models: models.collect(),
            existence: track.existence,
            snr_db: of_plots(track, track.snr_db),
            hits: of_plots(track, track.hits),
            misses: track.misses,
            age_scans: of_plots(track, track.age_scans),
            state_name: state_name(track.state_code),
            gate: Gate {
                kind: gate_name(track.gate_code),
                volume: track.gate_volume,
                plots: of_plots(track, track.plots_in_gate),
                region: region_of(site, track),
            },
            used: used.collect(),
            weight_none: track.weight_none,
            latency_us: way.hops().map(|(hop, us)| (hop, us.into())).collect(),
        }
    }
}

/// State and standard errors in the axes of the picture, of the components that the filter knows.
fn state_of(site: &SitePicture, track: &Track) -> (Map<String, Value>, Map<String, Value>) {
    let (mut state, mut sigma) = (Map::new(), Map::new());
    for (derivative, names) in COMPONENTS.iter().enumerate().take((usize::from(track.known) / 3).max(1)) {
        let axis = |axis: usize| 3 * axis + derivative;
        let own: [f64; 3] = std::array::from_fn(|of| track.state[axis(of) % STATE]);
        let turned = if derivative == 0 { site.place.position_m(own) } else { site.place.vector(own) };
        let covariance = site.place.turned(|row, column| track.covariance[pack(axis(row), axis(column))]);
        for (of, name) in names.iter().enumerate().take(if knows_height(track) { 3 } else { 2 }) {
            state.insert((*name).to_string(), turned[of].into());
            sigma.insert((*name).to_string(), covariance[of][of].max(0.0).sqrt().into());
        }
    }
    (state, sigma)
}

/// Of the state with all its models together: |Δ_i| ≤ α √(p_i + σ_i²) in range and azimuth about the state that was predicted for the last update (T9); σ² is that of
/// errors that are uniform in a resolution cell (C1).
fn region_of(site: &SitePicture, track: &Track) -> Option<Region> {
    let (header, _) = site.plots.back().filter(|(header, _)| header.cell_range_m > 0.0)?;
    let place: [f64; 3] = std::array::from_fn(|axis| track.predicted_state[3 * axis]);
    let centre = Polar::from_enu(&place.into());
    let (sin_azimuth, cos_azimuth) = centre.azimuth_rad.sin_cos();
    let (sin_elevation, cos_elevation) = centre.elevation_rad.sin_cos();
    let outwards = [cos_elevation * sin_azimuth, cos_elevation * cos_azimuth, sin_elevation];
    let clockwise = [cos_azimuth, -sin_azimuth, 0.0];
    let variance = |along: [f64; 3]| {
        let term = |row: usize, column: usize| {
            along[row] * along[column] * track.predicted_covariance[pack(3 * row, 3 * column)]
        };
        (0..3)
            .flat_map(|row| (0..3).map(move |column| (row, column)))
            .map(|(row, column)| term(row, column))
            .sum::<f64>()
    };
    let ground_m = (centre.range_m * cos_elevation).max(1.0);
    let half = |predicted: f64, cell: f64| site.gate_alpha * (predicted + cell * cell / 12.0).sqrt();
    let range_m = half(variance(outwards), header.cell_range_m);
    let azimuth_rad = half(variance(clockwise) / (ground_m * ground_m), header.cell_azimuth_rad);
    Some(Region {
        range_from_m: (centre.range_m - range_m).max(0.0),
        range_to_m: centre.range_m + range_m,
        azimuth_from_rad: centre.azimuth_rad - azimuth_rad,
        azimuth_to_rad: centre.azimuth_rad + azimuth_rad,
        elevation_rad: centre.elevation_rad,
    })
}

fn state_name(code: u32) -> &'static str {
    match code {
        TENTATIVE => "tentative",
        CONFIRMED => "confirmed",
        COASTING => "coasting",
        _ => "ended",
    }
}

fn gate_name(code: u32) -> &'static str {
    match code {
        GATE_MOST_PROBABLE => "most_probable",
        GATE_WIDEST_FALLBACK => "widest_fallback",
        GATE_WIDEST => "widest",
        GATE_UNION => "union",
        _ => "none",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;
    use common::config::{ChainConfig, Sites};
    use common::messages::RecordedRef;
    use common::plots::{HAS_ELEVATION, Plot, PlotsHeader};
    use common::tracks::{KIND_CONSTANT_VELOCITY, TracksHeader, UsedPlot};

    #[test]
    fn a_track_names_its_state_its_plots_and_their_places() {
        let mut picture = Picture::new(&Sites::one(ChainConfig::default()));
        let plot =
            Plot { range_m: 1000.0, azimuth_rad: std::f64::consts::FRAC_PI_2, flags: HAS_ELEVATION, ..Plot::default() };
        let cell_azimuth_rad = 72e-6_f64.sqrt();
        let plots =
            PlotsHeader { seq: 5, sectors_per_scan: 8, cell_range_m: 6.0, cell_azimuth_rad, ..PlotsHeader::default() };
        picture.take(0, RecordedRef::Plots(&plots, &[plot]), 0);
        let mut track = Track { id: 3, known: 6, models: 1, state_code: CONFIRMED, weight_none: 0.2, ..Track::EMPTY };
        track.model_kind[0] = KIND_CONSTANT_VELOCITY;
        track.model_probability[0] = 1.0;
        track.state[4] = -7.0;
        track.covariance[pack(0, 0)] = 25.0;
        // At 90°, 1000 m: the range is east, the azimuth north.
        (track.gate_code, track.predicted_state[0]) = (GATE_UNION, 1000.0);
        (track.predicted_covariance[pack(0, 0)], track.predicted_covariance[pack(3, 3)]) = (397.0, 94.0);
        track.used[0] = UsedPlot { seq: 5, index: 0, weight: 0.8, gates: 1, reserved: 0 };
        track.used[1] = UsedPlot { seq: 4, index: 9, weight: 0.1, gates: 1, reserved: 0 };
        picture.take(0, RecordedRef::Tracks(&TracksHeader::default(), &[track]), 0);
        let (_, site) = picture.site("site1").expect("the site");
        let of = &site.tracks[&3];
        let told = serde_json::to_value(TrackMessage::new(site, &of.track, &of.way, 0)).expect("JSON");
        assert_eq!(
            (told["state_name"].as_str(), told["models"][0]["name"].as_str()),
            (Some("confirmed"), Some("constant_velocity"))
        );
        assert_eq!((told["state"]["vy"].as_f64(), told["sigma"]["x"].as_f64()), (Some(-7.0), Some(5.0)));
        assert!(told["state"].get("ax").is_none(), "the filter does not know accelerations");
        assert!((told["used"][0]["x_m"].as_f64().expect("its place") - 1000.0).abs() < 1e-9);
        assert!(told["used"][1]["x_m"].is_null(), "its message is not there");
        let region = |key: &str| told["gate"]["region"][key].as_f64().expect("the gate");
        // 3.5 √(397 + 6²/12) m and 3.5 √(94/1000² + 72·10⁻⁶/12) rad.
        assert!((region("range_from_m") - 930.0).abs() < 1e-9 && (region("range_to_m") - 1070.0).abs() < 1e-9);
        let half = std::f64::consts::FRAC_PI_2 - region("azimuth_from_rad");
        assert!(
            (half - 0.035).abs() < 1e-12
                && (region("azimuth_to_rad") - region("azimuth_from_rad") - 2.0 * half).abs() < 1e-12
        );
    }
    /// The way of its own last update, whatever has come since of others.
    #[test]
    fn a_track_tells_its_own_latency() {
        let mut picture = Picture::new(&Sites::one(ChainConfig::default()));
        for (id, source_out_ns) in [(3, 1_000_000), (4, 5_000_000)] {
            let stamps = Stamps { source_out_ns, tracks_out_ns: source_out_ns + 1_000 * id, ..Stamps::default() };
            let header = TracksHeader { stamps, ..TracksHeader::default() };
            let track = Track { id, state_code: CONFIRMED, ..Track::EMPTY };
            picture.take(0, RecordedRef::Tracks(&header, &[track]), source_out_ns + 9_000);
        }
        let (_, site) = picture.site("site1").expect("the site");
        let of = &site.tracks[&3];
        let told = serde_json::to_value(TrackMessage::new(site, &of.track, &of.way, 1_020_000)).expect("JSON");
        let hops = serde_json::json!({"source_out→tracks_out": 3.0, "tracks_out→display_in": 6.0, "display_in→display_out": 11.0});
        assert_eq!(told["latency_us"], hops);
    }
}
