# Written by `just layouts` from the Rust types. Do not edit.
"""Messages of radar-chain as they lie in shared memory: SI units, radians, ns UTC."""

import ctypes
from typing import NamedTuple


class Topic(NamedTuple):
    header: type
    element: type
    header_name: str
    element_name: str
    header_alignment: int
    schema: str
    most: int


class DwellHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("source_out_ns", ctypes.c_uint64),
        ("azimuth_rad", ctypes.c_double),
        ("azimuth_step_rad", ctypes.c_double),
        ("elevation_first_rad", ctypes.c_double),
        ("elevation_step_rad", ctypes.c_double),
        ("range_rate_first_mps", ctypes.c_double),
        ("range_rate_step_mps", ctypes.c_double),
        ("range_first_m", ctypes.c_double),
        ("range_step_m", ctypes.c_double),
        ("scan_period_s", ctypes.c_double),
        ("scan", ctypes.c_uint32),
        ("dwell", ctypes.c_uint32),
        ("dwells_per_scan", ctypes.c_uint32),
        ("sector", ctypes.c_uint32),
        ("sectors_per_scan", ctypes.c_uint32),
        ("elevations", ctypes.c_uint32),
        ("dopplers", ctypes.c_uint32),
        ("ranges", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("source_id", ctypes.c_uint32),
        ("full_scale", ctypes.c_float),
        ("reserved", ctypes.c_uint32 * 11),
    ]  # 192 bytes


class Lineage(ctypes.Structure):
    _fields_ = [
        ("session", ctypes.c_uint64),
        ("first_seq", ctypes.c_uint64),
        ("last_seq", ctypes.c_uint64),
        ("taken", ctypes.c_uint64),
        ("taken_in_session", ctypes.c_uint64),
        ("published_before", ctypes.c_uint64),
    ]  # 48 bytes


class Stamps(ctypes.Structure):
    _fields_ = [
        ("source_out_ns", ctypes.c_uint64),
        ("extractor_in_ns", ctypes.c_uint64),
        ("plots_out_ns", ctypes.c_uint64),
        ("tracker_in_ns", ctypes.c_uint64),
        ("tracks_out_ns", ctypes.c_uint64),
    ]  # 40 bytes


class PlotsHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("lineage", Lineage),
        ("stamps", Stamps),
        ("covered_from_rad", ctypes.c_double),
        ("covered_to_rad", ctypes.c_double),
        ("scan_period_s", ctypes.c_double),
        ("pfa", ctypes.c_double),
        ("cells", ctypes.c_uint64),
        ("detections", ctypes.c_uint64),
        ("cell_range_m", ctypes.c_double),
        ("cell_azimuth_rad", ctypes.c_double),
        ("cell_elevation_rad", ctypes.c_double),
        ("cell_range_rate_mps", ctypes.c_double),
        ("reference_cells", ctypes.c_uint32),
        ("scan", ctypes.c_uint32),
        ("sector", ctypes.c_uint32),
        ("sectors_per_scan", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("rejected", ctypes.c_uint32),
        ("left_out", ctypes.c_uint32),
        ("source_id", ctypes.c_uint32),
        ("range_rate_interval_mps", ctypes.c_double),
        ("cfar", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32 * 1),
        ("padding", ctypes.c_uint8 * 16),
    ]  # 256 bytes


class Plot(ctypes.Structure):
    _fields_ = [
        ("time_ns", ctypes.c_uint64),
        ("range_m", ctypes.c_double),
        ("azimuth_rad", ctypes.c_double),
        ("elevation_rad", ctypes.c_double),
        ("range_rate_mps", ctypes.c_double),
        ("sigma_range_m", ctypes.c_float),
        ("sigma_azimuth_rad", ctypes.c_float),
        ("sigma_elevation_rad", ctypes.c_float),
        ("sigma_range_rate_mps", ctypes.c_float),
        ("statistic", ctypes.c_float),
        ("snr_db", ctypes.c_float),
        ("cell_count", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("source_id", ctypes.c_uint32),
        ("target_id", ctypes.c_uint32),
    ]  # 80 bytes


class TracksHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("lineage", Lineage),
        ("stamps", Stamps),
        ("scan", ctypes.c_uint32),
        ("sector", ctypes.c_uint32),
        ("sectors_per_scan", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("alive", ctypes.c_uint32),
        ("confirmed", ctypes.c_uint32),
        ("rejected", ctypes.c_uint32),
        ("left_out", ctypes.c_uint32),
        ("source_id", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("continued_session", ctypes.c_uint64),
        ("reserved_too", ctypes.c_uint32 * 8),
    ]  # 192 bytes


class UsedPlot(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("index", ctypes.c_uint32),
        ("weight", ctypes.c_float),
        ("gates", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]  # 24 bytes


class Track(ctypes.Structure):
    _fields_ = [
        ("time_ns", ctypes.c_uint64),
        ("id", ctypes.c_uint64),
        ("state", ctypes.c_double * 9),
        ("covariance", ctypes.c_double * 45),
        ("predicted_state", ctypes.c_double * 9),
        ("predicted_covariance", ctypes.c_double * 45),
        ("model_state", ctypes.c_double * 9),
        ("model_covariance", ctypes.c_double * 45),
        ("model_probability", ctypes.c_double * 8),
        ("model_parameter", ctypes.c_double * 8),
        ("existence", ctypes.c_double),
        ("gate_volume", ctypes.c_double),
        ("weight_none", ctypes.c_double),
        ("weight_best", ctypes.c_double),
        ("best_plot_seq", ctypes.c_uint64),
        ("best_plot_index", ctypes.c_uint32),
        ("plots_in_gate", ctypes.c_uint32),
        ("state_code", ctypes.c_uint32),
        ("gate_code", ctypes.c_uint32),
        ("age_scans", ctypes.c_uint32),
        ("hits", ctypes.c_uint32),
        ("misses", ctypes.c_uint32),
        ("snr_db", ctypes.c_float),
        ("model_kind", ctypes.c_uint16 * 8),
        ("estimator", ctypes.c_uint16),
        ("known", ctypes.c_uint8),
        ("models", ctypes.c_uint8),
        ("reserved", ctypes.c_uint32),
        ("used", UsedPlot * 6),
    ]  # 1680 bytes


class TruthHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("source_out_ns", ctypes.c_uint64),
        ("scan_period_s", ctypes.c_double),
        ("scan", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32 * 4),
    ]  # 64 bytes


class TruthTarget(ctypes.Structure):
    _fields_ = [
        ("time_ns", ctypes.c_uint64),
        ("target_id", ctypes.c_uint32),
        ("mode", ctypes.c_uint32),
        ("state", ctypes.c_double * 9),
        ("snr_db", ctypes.c_float),
        ("flags", ctypes.c_uint32),
    ]  # 96 bytes


class SiteBias(ctypes.Structure):
    _fields_ = [
        ("bias", ctypes.c_float * 4),
        ("sigma", ctypes.c_float * 4),
    ]  # 32 bytes


class SystemTracksHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("tracks_out_ns", ctypes.c_uint64),
        ("fused_out_ns", ctypes.c_uint64),
        ("cycle_s", ctypes.c_double),
        ("flags", ctypes.c_uint32),
        ("left_out", ctypes.c_uint32),
        ("sites_heard", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("biases", SiteBias * 8),
    ]  # 320 bytes


class Contributor(ctypes.Structure):
    _fields_ = [
        ("id", ctypes.c_uint64),
        ("site", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]  # 16 bytes


class SystemTrack(ctypes.Structure):
    _fields_ = [
        ("time_ns", ctypes.c_uint64),
        ("id", ctypes.c_uint64),
        ("state", ctypes.c_double * 6),
        ("covariance", ctypes.c_double * 21),
        ("latitude_deg", ctypes.c_double),
        ("longitude_deg", ctypes.c_double),
        ("height_m", ctypes.c_double),
        ("manoeuvre_probability", ctypes.c_double),
        ("contributors", Contributor * 8),
        ("contributor_count", ctypes.c_uint32),
        ("coasting", ctypes.c_uint32),
        ("ended", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]  # 408 bytes


class CommandsHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("out_ns", ctypes.c_uint64),
        ("reserved", ctypes.c_uint64 * 4),
    ]  # 64 bytes


class Command(ctypes.Structure):
    _fields_ = [
        ("asked_ns", ctypes.c_uint64),
        ("id", ctypes.c_uint64),
        ("before_seq", ctypes.c_uint64),
        ("track_id", ctypes.c_uint64),
        ("radius_m", ctypes.c_double),
        ("corners_m", ctypes.c_double * 2 * 16),
        ("name", ctypes.c_char * 32),
        ("kind", ctypes.c_uint32),
        ("outcome", ctypes.c_uint32),
        ("corners", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
    ]  # 344 bytes


class ClutterMapHeader(ctypes.Structure):
    _fields_ = [
        ("seq", ctypes.c_uint64),
        ("session", ctypes.c_uint64),
        ("time_ns", ctypes.c_uint64),
        ("out_ns", ctypes.c_uint64),
        ("azimuth_step_rad", ctypes.c_double),
        ("range_step_m", ctypes.c_double),
        ("scans", ctypes.c_double),
        ("tested", ctypes.c_double),
        ("pfa", ctypes.c_double),
        ("least_expected", ctypes.c_double),
        ("scan", ctypes.c_uint32),
        ("azimuths", ctypes.c_uint32),
        ("ranges", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32 * 9),
    ]  # 128 bytes


class ClutterCell(ctypes.Structure):
    _fields_ = [
        ("azimuth", ctypes.c_uint16),
        ("range", ctypes.c_uint16),
        ("found", ctypes.c_float),
        ("expected", ctypes.c_float),
    ]  # 12 bytes


class HealthHeader(ctypes.Structure):
    _fields_ = [
        ("session", ctypes.c_uint64),
        ("seq", ctypes.c_uint64),
    ]  # 16 bytes


class Intake(ctypes.Structure):
    _fields_ = [
        ("received", ctypes.c_uint64),
        ("lost", ctypes.c_uint64),
        ("restarts", ctypes.c_uint64),
        ("last_seq", ctypes.c_uint64),
    ]  # 32 bytes


class Input(ctypes.Structure):
    _fields_ = [
        ("topic", ctypes.c_char * 32),
        ("intake", Intake),
    ]  # 64 bytes


class LatencySummary(ctypes.Structure):
    _fields_ = [
        ("n", ctypes.c_uint64),
        ("p50_us", ctypes.c_float),
        ("p99_us", ctypes.c_float),
        ("misses", ctypes.c_uint64),
    ]  # 24 bytes


class RejectedFor(ctypes.Structure):
    _fields_ = [
        ("reason", ctypes.c_char * 32),
        ("count", ctypes.c_uint64),
    ]  # 40 bytes


class ObserverLoss(ctypes.Structure):
    _fields_ = [
        ("topic", ctypes.c_char * 32),
        ("observer", ctypes.c_char * 32),
        ("lost", ctypes.c_uint64),
    ]  # 72 bytes


class FalseAlarms(ctypes.Structure):
    _fields_ = [
        ("set", ctypes.c_float),
        ("measured", ctypes.c_float),
    ]  # 8 bytes


class Health(ctypes.Structure):
    _fields_ = [
        ("process", ctypes.c_char * 32),
        ("site", ctypes.c_char * 32),
        ("session", ctypes.c_uint64),
        ("seq", ctypes.c_uint64),
        ("heartbeat_ns", ctypes.c_uint64),
        ("cpu_ns", ctypes.c_uint64),
        ("rss_bytes", ctypes.c_uint64),
        ("messages_out", ctypes.c_uint64),
        ("elements_out", ctypes.c_uint64),
        ("inputs", Input * 16),
        ("latency", LatencySummary * 7),
        ("rejected", RejectedFor * 16),
        ("observers", ObserverLoss * 8),
        ("scan", ctypes.c_uint32),
        ("pid", ctypes.c_uint32),
        ("tracks", ctypes.c_uint32),
        ("confirmed", ctypes.c_uint32),
        ("plots", ctypes.c_uint32),
        ("restarts", ctypes.c_uint32),
        ("ended", ctypes.c_uint32),
        ("files", ctypes.c_uint32),
        ("condition", ctypes.c_uint32),
        ("silences", ctypes.c_uint32),
        ("slow_steps", ctypes.c_uint32),
        ("refused", ctypes.c_uint32),
        ("private_kib", ctypes.c_uint32),
        ("false_alarms", FalseAlarms),
        ("clock_uncertainty_us", ctypes.c_float),
        ("waiting", ctypes.c_uint32 * 16),
        ("reserved", ctypes.c_uint32 * 8),
    ]  # 2688 bytes


TOPICS = {
    "dwells": Topic(DwellHeader, ctypes.c_float, "radar/DwellHeader/1", "f32", 64, "dwell/1", 4194304),
    "plots": Topic(PlotsHeader, Plot, "radar/PlotsHeader/2", "radar/Plot/1", 64, "plots/2", 1024),
    "tracks": Topic(TracksHeader, Track, "radar/TracksHeader/2", "radar/Track/3", 64, "tracks/3", 256),
    "truth": Topic(TruthHeader, TruthTarget, "radar/TruthHeader/1", "radar/TruthTarget/1", 64, "truth/1", 1024),
    "system-tracks": Topic(SystemTracksHeader, SystemTrack, "radar/SystemTracksHeader/1", "radar/SystemTrack/1", 64, "system-tracks/1", 1024),
    "commands": Topic(CommandsHeader, Command, "radar/CommandsHeader/1", "radar/Command/1", 64, "commands/1", 1),
    "actions": Topic(CommandsHeader, Command, "radar/CommandsHeader/1", "radar/Command/1", 64, "actions/1", 1),
    "clutter-map": Topic(ClutterMapHeader, ClutterCell, "radar/ClutterMapHeader/1", "radar/ClutterCell/1", 64, "clutter-map/1", 5760),
    "health": Topic(HealthHeader, Health, "radar/HealthHeader/1", "radar/Health/4", 8, "health/4", 1),
}

# The event by which each stage tells a publisher that it has found it.
STAGES = {
    "radar-sim": 0,
    "plot-source": 1,
    "video-source": 2,
    "replay": 3,
    "fusion": 4,
    "link-in": 5,
    "plot-extractor": 6,
    "tracker": 7,
    "link-out": 8,
    "recorder": 9,
    "display": 10,
    "outputs": 11,
}
