//! Tracks as clients get them.

use common::label::Label;
use common::message::Stamps;
use common::tracks::{ESTIMATOR_FUSION, GATE_WIDEST, GATE_WIDEST_FALLBACK, Track, TracksHeader, pack};
use common::units::NS_PER_S;
use schemars::JsonSchema;
use serde::Serialize;

use super::columns::Column;
use super::microseconds;
use crate::picture::site::SitePicture;

/// Header of the tracks of a sector.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TracksHead<'a> {
    r#type: &'static str,
    site: &'a str,
    scan: u32,
    sector: u32,
    seq: u64,
    time_s: f64,
    alive: u32,
    confirmed: u32,
    left_out: u32,
    stamps_us: StampsUs,
}

impl<'a> TracksHead<'a> {
    /// Of the tracks of a site.
    pub fn new(site: &'a str, header: &TracksHeader, stamps_us: StampsUs) -> Self {
        let TracksHeader { scan, sector, seq, alive, confirmed, left_out, .. } = *header;
        let time_s = header.time_ns as f64 / NS_PER_S;
        Self { r#type: "tracks", site, scan, sector, seq, time_s, alive, confirmed, left_out, stamps_us }
    }
}

/// The way of the last dwell of a sector to the screen, µs of the machine's monotonic clock; `null` where it has not been.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct StampsUs {
    source_out: Option<f64>,
    extractor_in: Option<f64>,
    plots_out: Option<f64>,
    tracker_in: Option<f64>,
    tracks_out: Option<f64>,
    display_in: Option<f64>,
    display_out: Option<f64>,
}

impl StampsUs {
    /// Stamps of a message, when this process took it, and when it sends it on; ns, 0 where it has not been.
    pub fn new(stamps: &Stamps, display_in_ns: u64, display_out_ns: u64) -> Self {
        Self {
            source_out: microseconds(stamps.source_out_ns),
            extractor_in: microseconds(stamps.extractor_in_ns),
            plots_out: microseconds(stamps.plots_out_ns),
            tracker_in: microseconds(stamps.tracker_in_ns),
            tracks_out: microseconds(stamps.tracks_out_ns),
            display_in: microseconds(display_in_ns),
            display_out: microseconds(display_out_ns),
        }
    }

    /// The hops by name with what each took, µs, in their order; those that are known.
    pub fn hops(&self) -> impl Iterator<Item = (String, f64)> {
        let stations = [
            ("source_out", self.source_out),
            ("extractor_in", self.extractor_in),
            ("plots_out", self.plots_out),
            ("tracker_in", self.tracker_in),
            ("tracks_out", self.tracks_out),
            ("display_in", self.display_in),
            ("display_out", self.display_out),
        ];
        let known: Vec<(&str, f64)> = stations.into_iter().filter_map(|(name, at)| Some((name, at?))).collect();
        let pairs: Vec<_> =
            known.windows(2).map(|hop| (format!("{}→{}", hop[0].0, hop[1].0), hop[1].1 - hop[0].1)).collect();
        pairs.into_iter()
    }
}

/// A track as it is drawn, in the axes of the picture.
#[derive(Debug, Clone, Copy)]
pub struct TrackRow {
    id: u64,
    time_ns: u64,
    position_m: [f32; 3],
    velocity_mps: [f32; 3],
    /// xx, xy, yy, zz of the position, m².
    variance_m2: [f32; 4],
    existence: f32,
    snr_db: f32,
    hits: Option<u32>,
    misses: u32,
    age_scans: Option<u32>,
    in_gate: Option<u32>,
    state: u8,
    model: u8,
    gate: u8,
    label: Option<Label>,
}

impl TrackRow {
    /// A track of a site.
    pub fn new(track: &Track, site: &SitePicture) -> Self {
        let place = &site.place;
        let covariance = place.covariance_m2(track);
        let known = |height: f64| if knows_height(track) { height as f32 } else { f32::NAN };
        let in_space = |[east, north, up]: [f64; 3]| [east as f32, north as f32, known(up)];
        Self {
            id: track.id,
            time_ns: track.time_ns,
            position_m: in_space(place.position_m(track.position_m())),
            velocity_mps: in_space(place.vector(track.velocity_mps())),
            variance_m2: {
                let [[xx, xy, _], [_, yy, _], [_, _, zz]] = covariance;
                [xx as f32, xy as f32, yy as f32, known(zz)]
            },
            existence: track.existence as f32,
            snr_db: of_plots(track, track.snr_db).unwrap_or(f32::NAN),
            hits: of_plots(track, track.hits),
            misses: track.misses,
            age_scans: of_plots(track, track.age_scans),
            in_gate: of_plots(track, track.plots_in_gate),
            state: track.state_code as u8,
            model: most_probable(track),
            gate: u8::from([GATE_WIDEST, GATE_WIDEST_FALLBACK].contains(&track.gate_code)),
            label: site.operated.labels.get(&track.id).map(|label| Label::new(label)),
        }
    }
}

/// What a tracker knows of a track by its plots; a track that is fused of other tracks has none.
pub(super) fn of_plots<T>(track: &Track, value: T) -> Option<T> {
    (track.estimator != ESTIMATOR_FUSION).then_some(value)
}

/// Whether a track has a height: a filter of a radar that measures none leaves its variance at 0.
pub(super) fn knows_height(track: &Track) -> bool {
    track.covariance[pack(6, 6)] > 0.0
}

/// Place of the most probable model (the first of equals).
fn most_probable(track: &Track) -> u8 {
    let models = usize::from(track.models).clamp(1, track.model_probability.len());
    let probability = &track.model_probability[..models];
    (1..models).fold(0, |best, model| if probability[model] > probability[best] { model } else { best }) as u8
}

/// Columns of tracks. `state`: 0 tentative, 1 confirmed, 2 coasting, 3 ended; `model` counts the names in `hello`; `gate` is
/// 1 where the gate of a manoeuvre was searched.
pub const TRACKS: [Column<TrackRow>; 22] = [
    Column::whole("id", |row| row.id),
    Column::f64("time_s", |row| row.time_ns as f64 / NS_PER_S),
    Column::f32("x_m", |row| row.position_m[0]),
    Column::f32("y_m", |row| row.position_m[1]),
    Column::f32("z_m", |row| row.position_m[2]),
    Column::f32("vx_mps", |row| row.velocity_mps[0]),
    Column::f32("vy_mps", |row| row.velocity_mps[1]),
    Column::f32("vz_mps", |row| row.velocity_mps[2]),
    Column::f32("var_xx", |row| row.variance_m2[0]),
    Column::f32("var_xy", |row| row.variance_m2[1]),
    Column::f32("var_yy", |row| row.variance_m2[2]),
    Column::f32("var_zz", |row| row.variance_m2[3]),
    Column::u8("state", |row| row.state),
    Column::f32("existence", |row| row.existence),
    Column::f32("snr_db", |row| row.snr_db),
    Column::count("hits", |row| row.hits),
    Column::u32("misses", |row| row.misses),
    Column::count("age_scans", |row| row.age_scans),
    Column::u8("model", |row| row.model),
    Column::u8("gate", |row| row.gate),
    Column::count("in_gate", |row| row.in_gate),
    Column::text("label", |row| row.label.as_ref().map(Label::as_str)),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::columns::{Rows, text};
    use common::config::ChainConfig;
    use common::tracks::CONFIRMED;

    #[test]
    fn what_is_not_known_of_a_track_is_null_and_its_label_is_told() {
        let mut site = SitePicture::new(&ChainConfig::default(), crate::picture::place::Placement::default());
        site.operated.labels.insert(7, "blue".into());
        let row = |track: &Track, site: &SitePicture| -> serde_json::Value {
            let text = text(&Rows { columns: &TRACKS, rows: &[TrackRow::new(track, site)] });
            serde_json::from_str::<serde_json::Value>(&text).expect("JSON")[0].take()
        };
        let mut track = Track { id: 7, state_code: CONFIRMED, snr_db: 15.0, hits: 4, ..Track::EMPTY };
        let flat = row(&track, &site);
        assert!(flat["x_m"].is_number() && flat["hits"] == 4 && flat["label"] == "blue", "{flat}");
        assert!(["z_m", "vz_mps", "var_zz"].iter().all(|key| flat[key].is_null()), "{flat}");
        track.covariance[pack(6, 6)] = 9.0;
        assert_eq!(row(&track, &site)["var_zz"], 9.0);
        track = Track { id: 8, estimator: ESTIMATOR_FUSION, misses: 2, ..track };
        let fused = row(&track, &site);
        let unknown = ["snr_db", "hits", "age_scans", "in_gate", "label"];
        assert!(unknown.iter().all(|key| fused[key].is_null()) && fused["misses"] == 2, "{fused}");
    }

    #[test]
    fn hops_are_between_the_stations_that_are_known() {
        let stamps = Stamps { source_out_ns: 1_000, tracker_in_ns: 3_500, tracks_out_ns: 5_000, ..Stamps::default() };
        let hops: Vec<_> = StampsUs::new(&stamps, 6_000, 0).hops().collect();
        let expected = [("source_out→tracker_in", 2.5), ("tracker_in→tracks_out", 1.5), ("tracks_out→display_in", 1.0)];
        assert_eq!(hops, expected.map(|(name, took)| (name.to_string(), took)));
    }
}
