//! The rows of a topic's table: one per element, the columns of the header that place it first.
//!
//! A vector takes a column per component, named as in the state: `x_m`, `vx_mps` and so on.

use std::io;

use common::health::{Health, REJECT_NAMES};
use common::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use common::recording::{Recorded, RecordedRef};
use common::services::{HealthHeader, TOPIC_NAMES, Topic};
use common::tracks::{
    KIND_CONSTANT_VELOCITY, KIND_COORDINATED_TURN, KIND_HOVER, KIND_MANOEUVRE, KIND_MEAN_ACCELERATION, PACKED, STATE,
    Track, TracksHeader, pack,
};
use common::truth::{TruthHeader, TruthTarget};

/// A value of a column.
#[derive(Debug, Clone, Copy)]
pub(super) enum Value<'a> {
    U32(u32),
    U64(u64),
    F32(f32),
    F64(f64),
    Text(&'a str),
}

/// What takes rows, value by value.
pub(super) trait Table {
    /// The next value of the row.
    fn put(&mut self, column: &str, value: Value<'_>) -> io::Result<()>;

    /// The next value of the row, in a column whose values are not always known.
    fn put_if(&mut self, known: bool, column: &str, value: Value<'_>) -> io::Result<()>;

    /// Ends the row.
    fn end_row(&mut self) -> io::Result<()>;
}

/// Names of the components of the state.
const STATE_COLUMNS: [&str; STATE] =
    ["x_m", "vx_mps", "ax_mps2", "y_m", "vy_mps", "ay_mps2", "z_m", "vz_mps", "az_mps2"];
/// Names of their standard errors.
const SIGMA_COLUMNS: [&str; STATE] = [
    "sigma_x_m",
    "sigma_vx_mps",
    "sigma_ax_mps2",
    "sigma_y_m",
    "sigma_vy_mps",
    "sigma_ay_mps2",
    "sigma_z_m",
    "sigma_vz_mps",
    "sigma_az_mps2",
];
/// Names of the probabilities of the kinds of models; empty where the filter has none of a kind.
const KIND_COLUMNS: [(u16, &str); 5] = [
    (KIND_HOVER, "mode_hover"),
    (KIND_CONSTANT_VELOCITY, "mode_constant_velocity"),
    (KIND_MANOEUVRE, "mode_manoeuvre"),
    (KIND_COORDINATED_TURN, "mode_coordinated_turn"),
    (KIND_MEAN_ACCELERATION, "mode_mean_acceleration"),
];
/// Names of the components of the state predicted before the plots of the scan.
const PREDICTED_COLUMNS: [&str; STATE] = [
    "predicted_x_m",
    "predicted_vx_mps",
    "predicted_ax_mps2",
    "predicted_y_m",
    "predicted_vy_mps",
    "predicted_ay_mps2",
    "predicted_z_m",
    "predicted_vz_mps",
    "predicted_az_mps2",
];
/// Names of their standard errors.
const PREDICTED_SIGMA_COLUMNS: [&str; STATE] = [
    "predicted_sigma_x_m",
    "predicted_sigma_vx_mps",
    "predicted_sigma_ax_mps2",
    "predicted_sigma_y_m",
    "predicted_sigma_vy_mps",
    "predicted_sigma_ay_mps2",
    "predicted_sigma_z_m",
    "predicted_sigma_vz_mps",
    "predicted_sigma_az_mps2",
];

/// Gives `table` a row with the columns of a topic.
pub(super) fn put_columns(topic: Topic, table: &mut impl Table) -> io::Result<()> {
    let message = match topic {
        Topic::Dwells => return Ok(()),
        Topic::Plots => Recorded::Plots(PlotsHeader::default(), vec![Plot::default()]),
        Topic::Tracks => Recorded::Tracks(TracksHeader::default(), vec![Track::default()]),
        Topic::Truth => Recorded::Truth(TruthHeader::default(), vec![TruthTarget::default()]),
        Topic::Health => Recorded::Health(HealthHeader::default(), vec![Health::default()]),
    };
    put_rows(message.by_ref(), table)
}

/// Gives `table` the rows of a message.
pub(super) fn put_rows(message: RecordedRef<'_>, table: &mut impl Table) -> io::Result<()> {
    match message {
        RecordedRef::Plots(header, plots) => plots.iter().try_for_each(|plot| put_plot(header, plot, table)),
        RecordedRef::Tracks(header, tracks) => tracks.iter().try_for_each(|track| put_track(header, track, table)),
        RecordedRef::Truth(header, targets) => targets.iter().try_for_each(|target| put_target(header, target, table)),
        RecordedRef::Health(_, reports) => reports.iter().try_for_each(|health| put_health(health, table)),
        RecordedRef::Dwells(..) => Ok(()),
    }
}

fn put_plot(header: &PlotsHeader, plot: &Plot, table: &mut impl Table) -> io::Result<()> {
    let (elevation, range_rate) = (plot.has(HAS_ELEVATION), plot.has(HAS_RANGE_RATE));
    table.put("seq", Value::U64(header.seq))?;
    table.put("scan", Value::U32(header.scan))?;
    table.put("sector", Value::U32(header.sector))?;
    table.put("time_ns", Value::U64(plot.time_ns))?;
    table.put("range_m", Value::F64(plot.range_m))?;
    table.put("azimuth_rad", Value::F64(plot.azimuth_rad))?;
    table.put_if(elevation, "elevation_rad", Value::F64(plot.elevation_rad))?;
    table.put_if(range_rate, "range_rate_mps", Value::F64(plot.range_rate_mps))?;
    table.put("sigma_range_m", Value::F32(plot.sigma_range_m))?;
    table.put("sigma_azimuth_rad", Value::F32(plot.sigma_azimuth_rad))?;
    table.put_if(elevation, "sigma_elevation_rad", Value::F32(plot.sigma_elevation_rad))?;
    table.put_if(range_rate, "sigma_range_rate_mps", Value::F32(plot.sigma_range_rate_mps))?;
    table.put_if(plot.has(HAS_STATISTIC), "statistic", Value::F32(plot.statistic))?;
    table.put("snr_db", Value::F32(plot.snr_db))?;
    table.put("cell_count", Value::U32(plot.cell_count))?;
    table.put("flags", Value::U32(plot.flags))?;
    table.put("source_id", Value::U32(plot.source_id))?;
    table.put_if(plot.target_id != 0, "target_id", Value::U32(plot.target_id))?;
    table.end_row()
}

fn put_track(header: &TracksHeader, track: &Track, table: &mut impl Table) -> io::Result<()> {
    table.put("seq", Value::U64(header.seq))?;
    table.put("scan", Value::U32(header.scan))?;
    table.put("sector", Value::U32(header.sector))?;
    table.put("id", Value::U64(track.id))?;
    table.put("time_ns", Value::U64(track.time_ns))?;
    table.put("state_code", Value::U32(track.state_code))?;
    put_all(&STATE_COLUMNS, &track.state, table)?;
    let sigmas = |covariance: &[f64; PACKED]| -> [f64; STATE] {
        std::array::from_fn(|axis| covariance[pack(axis, axis)].sqrt())
    };
    put_all(&SIGMA_COLUMNS, &sigmas(&track.covariance), table)?;
    table.put("existence", Value::F64(track.existence))?;
    for (kind, column) in KIND_COLUMNS {
        table.put_if(track.model_kind.contains(&kind), column, Value::F64(track.probability_of(kind)))?;
    }
    table.put("gate_code", Value::U32(track.gate_code))?;
    table.put("gate_volume", Value::F64(track.gate_volume))?;
    table.put("plots_in_gate", Value::U32(track.plots_in_gate))?;
    table.put("weight_none", Value::F64(track.weight_none))?;
    let found = track.best_plot_index != u32::MAX;
    table.put_if(found, "weight_best", Value::F64(track.weight_best))?;
    table.put_if(found, "best_plot_seq", Value::U64(track.best_plot_seq))?;
    table.put_if(found, "best_plot_index", Value::U32(track.best_plot_index))?;
    table.put("snr_db", Value::F32(track.snr_db))?;
    table.put("age_scans", Value::U32(track.age_scans))?;
    table.put("hits", Value::U32(track.hits))?;
    table.put("misses", Value::U32(track.misses))?;
    table.put("estimator", Value::U32(track.estimator.into()))?;
    table.put("known", Value::U32(track.known.into()))?;
    put_all(&PREDICTED_COLUMNS, &track.predicted_state, table)?;
    put_all(&PREDICTED_SIGMA_COLUMNS, &sigmas(&track.predicted_covariance), table)?;
    table.end_row()
}

fn put_target(header: &TruthHeader, target: &TruthTarget, table: &mut impl Table) -> io::Result<()> {
    table.put("seq", Value::U64(header.seq))?;
    table.put("target_id", Value::U32(target.target_id))?;
    table.put("time_ns", Value::U64(target.time_ns))?;
    table.put("mode", Value::U32(target.mode))?;
    table.put("flags", Value::U32(target.flags))?;
    table.put_if(!target.snr_db.is_nan(), "snr_db", Value::F32(target.snr_db))?;
    put_all(&STATE_COLUMNS, &target.state, table)?;
    table.end_row()
}

fn put_health(health: &Health, table: &mut impl Table) -> io::Result<()> {
    table.put("process", Value::Text(health.process()))?;
    table.put("session", Value::U64(health.session))?;
    table.put("seq", Value::U64(health.seq))?;
    table.put("heartbeat_ns", Value::U64(health.heartbeat_ns))?;
    table.put("cpu_ns", Value::U64(health.cpu_ns))?;
    table.put("rss_bytes", Value::U64(health.rss_bytes))?;
    table.put("messages_out", Value::U64(health.messages_out))?;
    table.put("scan", Value::U32(health.scan))?;
    table.put("pid", Value::U32(health.pid))?;
    for (topic, intake) in TOPIC_NAMES.iter().zip(&health.intake) {
        table.put(&format!("received_{topic}"), Value::U64(intake.received))?;
    }
    for (topic, intake) in TOPIC_NAMES.iter().zip(&health.intake) {
        table.put(&format!("lost_{topic}"), Value::U64(intake.lost))?;
    }
    for (reason, &count) in REJECT_NAMES.iter().zip(&health.rejected) {
        table.put(&format!("rejected_{reason}"), Value::U64(count))?;
    }
    table.end_row()
}

fn put_all<const N: usize>(columns: &[&str; N], values: &[f64; N], table: &mut impl Table) -> io::Result<()> {
    columns.iter().zip(values).try_for_each(|(column, &value)| table.put(column, Value::F64(value)))
}
