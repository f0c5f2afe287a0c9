//! True targets and system tracks as clients get them.

use common::system_tracks::{CONTRIBUTORS, Contributor, SystemTrack, SystemTracksHeader, pack};
use common::truth::{TruthHeader, TruthTarget};
use common::units::NS_PER_S;
use schemars::JsonSchema;
use serde::Serialize;

use super::columns::Column;
use crate::picture::place::Placement;

/// Header of the truth of a scan, or of the system tracks of a cycle.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ScanHead<'a> {
    r#type: &'static str,
    site: &'a str,
    seq: u64,
    time_s: f64,
}

impl<'a> ScanHead<'a> {
    /// Of the true targets that a site sees.
    pub fn of_truth(site: &'a str, header: &TruthHeader) -> Self {
        Self { r#type: "truth", site, seq: header.seq, time_s: header.time_ns as f64 / NS_PER_S }
    }

    /// Of system tracks.
    pub fn of_system_tracks(site: &'a str, header: &SystemTracksHeader) -> Self {
        Self { r#type: "system_tracks", site, seq: header.seq, time_s: header.time_ns as f64 / NS_PER_S }
    }
}

/// A target with its place in the picture.
#[derive(Debug, Clone, Copy)]
pub struct TruthRow {
    target: TruthTarget,
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
}

impl TruthRow {
    /// A target of the site at `place`.
    pub fn new(target: &TruthTarget, place: &Placement) -> Self {
        let (position_m, velocity_mps) = (place.position_m(target.position_m()), place.vector(target.velocity_mps()));
        Self { target: *target, position_m, velocity_mps }
    }
}

/// Columns of true targets.
pub const TRUTH: [Column<TruthRow>; 9] = [
    Column::u32("target_id", |row| row.target.target_id),
    Column::f64("time_s", |row| row.target.time_ns as f64 / NS_PER_S),
    Column::f32("x_m", |row| row.position_m[0] as f32),
    Column::f32("y_m", |row| row.position_m[1] as f32),
    Column::f32("z_m", |row| row.position_m[2] as f32),
    Column::f32("vx_mps", |row| row.velocity_mps[0] as f32),
    Column::f32("vy_mps", |row| row.velocity_mps[1] as f32),
    Column::f32("vz_mps", |row| row.velocity_mps[2] as f32),
    Column::f32("snr_db", |row| row.target.snr_db),
];

/// A system track with its place in the picture.
#[derive(Debug, Clone, Copy)]
pub struct SystemRow {
    track: SystemTrack,
    position_m: [f64; 3],
    velocity_mps: [f64; 3],
    covariance_m2: [[f64; 3]; 3],
}

impl SystemRow {
    /// A system track of the centre at `place`.
    pub fn new(track: &SystemTrack, place: &Placement) -> Self {
        let [x, y, z, vx, vy, vz] = track.state;
        Self {
            track: *track,
            position_m: place.position_m([x, y, z]),
            velocity_mps: place.vector([vx, vy, vz]),
            covariance_m2: place.turned(|row, column| track.covariance[pack(row, column)]),
        }
    }

    /// Bits of the sites of the local tracks that it names.
    fn site_bits(&self) -> u32 {
        let named = (self.track.contributor_count as usize).min(CONTRIBUTORS);
        let bit = |of: &Contributor| 1_u32.checked_shl(of.site).unwrap_or(0);
        self.track.contributors[..named].iter().map(bit).fold(0, |bits, bit| bits | bit)
    }
}

/// Columns of system tracks; `sites` is how many local tracks one is made of, and bit n of `site_bits` is set where the n-th site
/// of `hello` has one of them, from 0.
pub const SYSTEM_TRACKS: [Column<SystemRow>; 16] = [
    Column::whole("id", |row| row.track.id),
    Column::f64("time_s", |row| row.track.time_ns as f64 / NS_PER_S),
    Column::f32("x_m", |row| row.position_m[0] as f32),
    Column::f32("y_m", |row| row.position_m[1] as f32),
    Column::f32("z_m", |row| row.position_m[2] as f32),
    Column::f32("vx_mps", |row| row.velocity_mps[0] as f32),
    Column::f32("vy_mps", |row| row.velocity_mps[1] as f32),
    Column::f32("vz_mps", |row| row.velocity_mps[2] as f32),
    Column::f32("var_xx", |row| row.covariance_m2[0][0] as f32),
    Column::f32("var_xy", |row| row.covariance_m2[0][1] as f32),
    Column::f32("var_yy", |row| row.covariance_m2[1][1] as f32),
    Column::f32("var_zz", |row| row.covariance_m2[2][2] as f32),
    Column::u32("sites", |row| row.track.contributor_count),
    Column::u32("site_bits", SystemRow::site_bits),
    Column::u8("coasting", |row| u8::from(row.track.coasting > 0)),
    Column::u8("ended", |row| u8::from(row.track.ended != 0)),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_track_names_the_sites_that_it_is_made_of() {
        let mut track = SystemTrack { contributor_count: 3, ..SystemTrack::default() };
        for (place, site) in [2, 0, 2, 1].into_iter().enumerate() {
            track.contributors[place].site = site; // of the fourth nothing is said: there are three
        }
        assert_eq!(SystemRow::new(&track, &Placement::default()).site_bits(), 0b101);
    }
}
