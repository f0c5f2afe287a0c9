//! The plan of a picture: what the radars saw at one time, with the ways that led there.

use std::collections::HashMap;
use std::f64::consts::TAU;

use common::config::{ChainConfig, Source};

use super::cells::Cells;
use super::labels::Labels;
use super::scale::{Scale, distance, round_step};
use super::sheet::{Anchor, Sheet};
use super::style::{Mark, Theme};
use crate::picture::Picture;
use crate::picture::site::SitePicture;
use crate::wire::plots::position_m;

/// The plan, px.
const SIDE: f64 = 1000.0;
/// Room above the plan for what it shows, px.
const HEAD: f64 = 64.0;
/// The sheet, width and height, px.
pub(super) const SIZE: [f64; 2] = [SIDE, SIDE + HEAD];
/// Room about the plan for the azimuth scale, px.
const MARGIN: f64 = 40.0;
/// Range rings at most.
const RINGS: f64 = 5.0;
/// A speed vector ends where its target is after so long, in scans.
const VECTOR_SCANS: f64 = 10.0;

/// Radius of a confirmed track, px.
const SYMBOL: f64 = 5.0;
/// Of the hexagon of a system track, px.
const HEXAGON: f64 = 9.0;

/// The ways of tracks, by site and number: positions in the picture, m, oldest first.
pub(super) type Trails = HashMap<(usize, u64), Vec<[f64; 3]>>;

/// What a plan shows.
pub(super) struct Plan<'a> {
    pub(super) picture: &'a Picture,
    pub(super) sites: &'a [ChainConfig],
    pub(super) trails: &'a Trails,
    /// Cells of the last scan, by site.
    pub(super) cells: &'a [Cells],
    /// What it shows, in a line: when, and of whom.
    pub(super) title: &'a str,
    /// Range of the plan about the first radar, m; `None` for what the radars cover.
    pub(super) range_m: Option<f64>,
    pub(super) theme: Theme,
}

impl Plan<'_> {
    /// Draws it on a sheet of [`SIZE`].
    pub(super) fn draw(&self, sheet: &mut dyn Sheet) {
        let range_m = self.range_m.unwrap_or_else(|| self.reach_m());
        let scale = Scale {
            middle_m: [0.0; 2],
            middle: [SIDE / 2.0, HEAD + SIDE / 2.0],
            per_m: (SIDE / 2.0 - MARGIN) / range_m,
        };
        for (site, cells) in self.picture.sites.iter().zip(self.cells) {
            let [east, north, _] = site.place.position_m([0.0; 3]);
            let corner = [0.0, HEAD];
            if let Some(shading) = cells.shading(&scale, range_m, [east, north], corner, self.theme.shade) {
                sheet.shade(corner, &shading);
            }
        }
        rings(sheet, &scale, range_m);
        for (number, site) in self.picture.sites.iter().enumerate() {
            self.site(sheet, &scale, number, site);
        }
        self.numbers(sheet, &scale);
        self.head(sheet);
    }

    /// System tracks, and the numbers of all tracks: theirs first. One that finds no place about its track is left out.
    fn numbers(&self, sheet: &mut dyn Sheet, scale: &Scale) {
        let mut labels = Labels::new();
        let font_px = self.theme.style(Mark::Number).font_px;
        let mut wanted = Vec::new(); // place and size of the mark, px, and its number
        for site in &self.picture.sites {
            let living = site.system_tracks.iter().flat_map(|(_, tracks)| tracks).filter(|track| track.ended == 0);
            for track in living {
                let at = scale.place(site.place.position_m([track.state[0], track.state[1], track.state[2]]));
                sheet.line(Mark::System, &hexagon(at));
                wanted.push((at, HEXAGON, format!("S{}", track.id)));
            }
        }
        for site in &self.picture.sites {
            for (id, of) in site.tracks.iter().filter(|(_, of)| of.track.is_confirmed()) {
                wanted.push((scale.place(site.place.position_m(of.track.position_m())), SYMBOL, id.to_string()));
            }
        }
        for (at, radius, _) in &wanted {
            labels.reserve(*at, *radius);
        }
        for (at, _, text) in wanted {
            if let Some(place) = labels.place(at, &text, font_px) {
                sheet.text(Mark::Number, place, Anchor::Start, &text);
            }
        }
    }

    /// The farthest that anything shown is from the first radar, m.
    fn reach_m(&self) -> f64 {
        let mut reach_m: f64 = 1.0;
        for (site, config) in self.picture.sites.iter().zip(self.sites) {
            let [x, y, _] = site.place.position_m([0.0; 3]);
            let radar = &config.radar;
            let simulated_m = radar.range_first_m + f64::from(radar.ranges) * radar.range_step_m;
            let has_cells = matches!(config.origin(), Source::RadarSim | Source::VideoSource);
            let own_m = if has_cells { simulated_m } else { farthest_m(site) };
            reach_m = reach_m.max(x.hypot(y) + own_m);
        }
        reach_m
    }

    fn site(&self, sheet: &mut dyn Sheet, scale: &Scale, number: usize, site: &SitePicture) {
        let config = &self.sites[number];
        let at = scale.place(site.place.position_m([0.0; 3]));
        sheet.line(Mark::Site, &[[at[0], at[1] - 7.0], [at[0] + 6.0, at[1] + 5.0], [at[0] - 6.0, at[1] + 5.0]]);
        if self.sites.len() > 1 {
            sheet.text(Mark::Note, [at[0] + 9.0, at[1] + 5.0], Anchor::Start, &site.name);
        }
        for (_, plots) in site.last_scan() {
            for plot in plots {
                sheet.circle(Mark::Plot, scale.place(position_m(plot, &site.place)), 2.5);
            }
        }
        for target in site.truth.iter().flat_map(|(_, targets)| targets) {
            let [x, y] = scale.place(site.place.position_m(target.position_m()));
            sheet.line(Mark::Truth, &[[x - 7.0, y], [x + 7.0, y]]);
            sheet.line(Mark::Truth, &[[x, y - 7.0], [x, y + 7.0]]);
        }
        let ahead_s = VECTOR_SCANS * config.scan_period_s();
        for (id, of) in &site.tracks {
            let track = &of.track;
            let from_m = site.place.position_m(track.position_m());
            let velocity = site.place.vector(track.velocity_mps());
            let at = scale.place(from_m);
            if let Some(trail) = self.trails.get(&(number, *id)) {
                let points: Vec<[f64; 2]> = trail.iter().map(|&position| scale.place(position)).collect();
                sheet.line(Mark::Trail, &points);
            }
            if !track.is_confirmed() {
                sheet.circle(Mark::Tentative, at, 3.5);
                continue;
            }
            let ahead_m = std::array::from_fn(|axis| from_m[axis] + ahead_s * velocity[axis]);
            sheet.line(Mark::Vector, &[at, scale.place(ahead_m)]);
            sheet.circle(Mark::Confirmed, at, SYMBOL);
        }
    }

    fn head(&self, sheet: &mut dyn Sheet) {
        sheet.text(Mark::Title, [MARGIN, 30.0], Anchor::Start, self.title);
        let tracks = || self.picture.sites.iter().flat_map(|site| site.tracks.values());
        let confirmed = tracks().filter(|of| of.track.is_confirmed()).count();
        let plots: usize =
            self.picture.sites.iter().flat_map(SitePicture::last_scan).map(|(_, plots)| plots.len()).sum();
        let legend = format!(
            "● {confirmed} confirmed tracks with trail and {VECTOR_SCANS:.0} scans ahead, ○ {} tentative, · {plots} plots of the last scan{}",
            tracks().count() - confirmed,
            if self.picture.sites.iter().any(|site| site.truth.is_some()) { ", + truth" } else { "" }
        );
        sheet.text(Mark::Note, [MARGIN, 52.0], Anchor::Start, &legend);
    }
}

/// The outline of a hexagon about a point, px.
fn hexagon([x, y]: [f64; 2]) -> [[f64; 2]; 7] {
    std::array::from_fn(|corner| {
        let (sin, cos) = (TAU * corner as f64 / 6.0).sin_cos();
        [x + HEXAGON * cos, y + HEXAGON * sin]
    })
}

/// The farthest plot or track of a site, m.
fn farthest_m(site: &SitePicture) -> f64 {
    let plots = site.last_scan().flat_map(|(_, plots)| plots).map(|plot| plot.range_m);
    let tracks = site.tracks.values().map(|of| of.track.position_m()).map(|[x, y, _]| x.hypot(y));
    plots.chain(tracks).fold(1.0, f64::max) * 1.05
}

/// Range rings about the first radar, and the azimuth scale.
fn rings(sheet: &mut dyn Sheet, scale: &Scale, range_m: f64) {
    let step_m = round_step(range_m, RINGS);
    let middle = scale.middle;
    for ring in 1..=(range_m / step_m).floor() as u32 {
        let radius_m = f64::from(ring) * step_m;
        sheet.circle(Mark::Ring, middle, radius_m * scale.per_m);
        sheet.text(
            Mark::Scale,
            [middle[0] + 4.0, middle[1] - radius_m * scale.per_m - 4.0],
            Anchor::Start,
            &distance(radius_m),
        );
    }
    let edge = range_m * scale.per_m;
    sheet.circle(Mark::Ring, middle, edge);
    for degrees in (0..360).step_by(30) {
        let (sin, cos) = (f64::from(degrees) * TAU / 360.0).sin_cos();
        let at = |radius: f64| [middle[0] + radius * sin, middle[1] - radius * cos];
        sheet.line(Mark::Spoke, &[at(0.0), at(edge)]);
        let [x, y] = at(edge + 18.0);
        sheet.text(Mark::Scale, [x, y + 4.0], Anchor::Middle, &format!("{degrees:03}°"));
    }
}

#[cfg(test)]
mod tests {
    use super::super::style::DAY;
    use super::super::svg::Svg;
    use super::*;
    use common::config::{ChainConfig, Sites};
    use common::messages::RecordedRef;
    use common::system_tracks::{SystemTrack, SystemTracksHeader};
    use common::tracks::{CONFIRMED, Track, TracksHeader};

    /// A target that a site tracks and that is a system track: both have their number, at two places.
    #[test]
    fn a_system_track_and_its_track_have_numbers_beside_each_other() {
        let sites = Sites::one(ChainConfig::default());
        let mut picture = Picture::new(&sites);
        let mut track = Track { id: 7, known: 6, state_code: CONFIRMED, ..Track::EMPTY };
        (track.state[0], track.state[3]) = (1000.0, 2000.0);
        picture.take(0, RecordedRef::Tracks(&TracksHeader::default(), &[track]), 0);
        let fused = SystemTrack { id: 3, state: [1000.0, 2000.0, 0.0, 0.0, 0.0, 0.0], ..SystemTrack::default() };
        let ended = SystemTrack { id: 4, ended: 1, ..fused };
        picture.take(0, RecordedRef::SystemTracks(&SystemTracksHeader::default(), &[fused, ended]), 0);
        let (trails, cells) = (Trails::new(), [Cells::default()]);
        let plan = Plan {
            picture: &picture,
            sites: sites.all(),
            trails: &trails,
            cells: &cells,
            title: "",
            range_m: None,
            theme: DAY,
        };
        let mut sheet: Box<dyn Sheet> = Box::new(Svg::new(SIZE[0], SIZE[1], "", &DAY));
        plan.draw(sheet.as_mut());
        let text = String::from_utf8(sheet.finish()).expect("text");
        let numbers: Vec<_> = text.lines().filter(|line| line.contains("class=\"number\"")).collect();
        assert!(numbers.len() == 2 && numbers[0].contains(">S3<") && numbers[1].contains(">7<"), "{numbers:?}");
        let place = |line: &str| line.split(" text-anchor").next().map(String::from);
        assert_ne!(place(numbers[0]), place(numbers[1]));
    }
}
