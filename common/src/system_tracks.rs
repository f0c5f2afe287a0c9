//! `system-tracks`: what several sites together know of targets, once per cycle of fusion.

use std::io;

use iceoryx2::prelude::ZeroCopySend;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::message::{Header, Place};
use crate::recording::row::{Row, Table, Value, put_all};

/// Most system tracks in one message.
pub const MAX_SYSTEM_TRACKS: usize = 1024;
/// Components of the state [x y z ẋ ẏ ż].
pub const SYSTEM_STATE: usize = 6;
/// Elements of the packed upper triangle of its covariance, row by row.
pub const SYSTEM_PACKED: usize = SYSTEM_STATE * (SYSTEM_STATE + 1) / 2;
/// Local tracks that a system track names.
pub const CONTRIBUTORS: usize = 8;
/// Sites whose biases a message tells.
pub const BIASED_SITES: usize = 8;

/// A local track that a system track is made of.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/Contributor/1")]
#[repr(C)]
pub struct Contributor {
    /// The site's number of the track.
    pub id: u64,
    /// Place of the site among those of the chain, from 0.
    pub site: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

/// One system track at [`SystemTrack::time_ns`].
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/SystemTrack/1")]
#[repr(C)]
pub struct SystemTrack {
    /// Time of the state: the end of the cycle, ns UTC.
    pub time_ns: u64,
    /// Number of the system track, never used again in a session.
    pub id: u64,
    /// [x y z ẋ ẏ ż] in ENU about the centre; m, m/s.
    pub state: [f64; SYSTEM_STATE],
    /// Covariance of the state, packed; what is not known of the radars' biases is part of it.
    pub covariance: [f64; SYSTEM_PACKED],
    /// WGS-84, degrees north.
    pub latitude_deg: f64,
    /// WGS-84, degrees east.
    pub longitude_deg: f64,
    /// Above the ellipsoid, m.
    pub height_m: f64,
    /// Probability that the target manoeuvres.
    pub manoeuvre_probability: f64,
    /// Local tracks that it is made of, the first ones.
    pub contributors: [Contributor; CONTRIBUTORS],
    /// How many local tracks it is made of.
    pub contributor_count: u32,
    /// Cycles without any of them, in a row.
    pub coasting: u32,
    /// 1 in its last message.
    pub ended: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
}

const _: () = assert!(size_of::<SystemTrack>() == 408 && align_of::<SystemTrack>() == 8);

/// What is known of the bias of a site.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/SiteBias/1")]
#[repr(C)]
pub struct SiteBias {
    /// Range m, azimuth rad, elevation rad, time s: what it measures too much.
    pub bias: [f32; 4],
    /// Standard errors of that.
    pub sigma: [f32; 4],
}

/// Header of the system tracks of a cycle.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize, Deserialize, ZeroCopySend, JsonSchema)]
#[type_name("radar/SystemTracksHeader/1")]
#[repr(C)]
#[repr(align(64))]
pub struct SystemTracksHeader {
    /// Number of the cycle.
    pub seq: u64,
    /// Session of the publisher.
    pub session: u64,
    /// Measurement time at the end of the cycle, ns UTC.
    pub time_ns: u64,
    /// CLOCK_MONOTONIC at which the last local track that went in was published, ns.
    pub tracks_out_ns: u64,
    /// CLOCK_MONOTONIC just before publishing, ns.
    pub fused_out_ns: u64,
    /// Time of a cycle, s.
    pub cycle_s: f64,
    /// `END_OF_…`, `TRUNCATED` of [`crate::message`].
    pub flags: u32,
    /// System tracks left out because the message was full.
    pub left_out: u32,
    /// Sites that have told all of this cycle in time.
    pub sites_heard: u32,
    /// Always 0: no undefined bytes.
    pub reserved: u32,
    /// What is known of the biases of the first sites of the chain, by their places; 0 for the centre and where there is none.
    pub biases: [SiteBias; BIASED_SITES],
}

const _: () = assert!(size_of::<SystemTracksHeader>() == 320 && align_of::<SystemTracksHeader>() == 64);

impl Header for SystemTracksHeader {
    fn place(&self) -> Place {
        let Self { session, seq, time_ns, flags, .. } = *self;
        Place { session, seq, time_ns, flags, scan: Some(seq as u32) }
    }

    fn each_stamp(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        visit(&mut self.tracks_out_ns);
        visit(&mut self.fused_out_ns);
    }

    fn make_comparable(&mut self) {
        (self.session, self.tracks_out_ns, self.fused_out_ns) = (0, 0, 0);
    }
}

impl Row<SystemTracksHeader> for SystemTrack {
    fn put_row(&self, header: &SystemTracksHeader, table: &mut dyn Table) -> io::Result<()> {
        table.put("seq", Value::U64(header.seq))?;
        table.put("id", Value::U64(self.id))?;
        table.put("time_ns", Value::U64(self.time_ns))?;
        put_all(&["x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps"], &self.state, table)?;
        let sigma = std::array::from_fn(|axis| self.covariance[pack(axis, axis)].sqrt());
        put_all(
            &["sigma_x_m", "sigma_y_m", "sigma_z_m", "sigma_vx_mps", "sigma_vy_mps", "sigma_vz_mps"],
            &sigma,
            table,
        )?;
        table.put("latitude_deg", Value::F64(self.latitude_deg))?;
        table.put("longitude_deg", Value::F64(self.longitude_deg))?;
        table.put("height_m", Value::F64(self.height_m))?;
        table.put("manoeuvre_probability", Value::F64(self.manoeuvre_probability))?;
        table.put("contributors", Value::U32(self.contributor_count))?;
        table.put("coasting", Value::U32(self.coasting))?;
        table.put("ended", Value::U32(self.ended))
    }
}

/// Index of element (row, column) of a covariance in its packed upper triangle.
pub const fn pack(row: usize, column: usize) -> usize {
    let (r, c) = if row <= column { (row, column) } else { (column, row) };
    r * SYSTEM_STATE - r * (r + 1) / 2 + c
}
