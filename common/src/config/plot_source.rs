//! `[plot_source]`: recordings of real radars.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::turning::Turning;
use crate::units::DAY_NS;

use super::load::{ConfigError, not_negative, positive, require, within};

/// Recording with real plots, and the properties of the radar that made it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "each is a question of its own about the reports")]
pub struct PlotSourceConfig {
    /// Recording of the radar.
    pub file: String,
    /// Where a radar is listened to instead: `udp://ADDRESS:PORT`, or `udp://GROUP:PORT?interface=NAME`; of a record that
    /// arrives at several of them, or twice, the first is taken.
    pub listen: Vec<String>,
    /// A sector is closed this long, s, after the beam must have left it, if no sector message of the radar has closed it before.
    pub latency_s: f64,
    /// Least time, s, for which reports of a sector are waited for after the message of the radar that the beam has left it.
    pub sector_delay_s: f64,
    /// Editions of ASTERIX categories where the source does not speak the newest, as `"048=1.32"`.
    pub editions: Vec<String>,
    /// Recording of a cooperative sensor, for scoring, or with `listen` where it is listened to, as `udp://ADDRESS:PORT`,
    /// by a clock that is the radar's; empty for none.
    pub truth: String,
    /// UTC date of the first report, `YYYY-MM-DD`: reports carry only the time of day.
    pub date: String,
    /// Sectors in a scan.
    pub sectors_per_scan: u32,
    /// Scan period, s, where the recording has too few start-of-cycle messages to tell; said if theirs differs.
    pub scan_period_s: f64,
    /// How the antenna turns: `clockwise`, `counter-clockwise` or `standing`; learnt from times and azimuths where it is not
    /// given. The scans of an antenna that stands are as long as the time between two reports of a target, or `scan_period_s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turning: Option<Turning>,
    /// The radar sees no farther than this, m.
    pub coverage_range_m: f64,
    /// Standard error of the range of a plot, m.
    pub sigma_range_m: f64,
    /// Standard error of the azimuth of a plot, degrees.
    pub sigma_azimuth_deg: f64,
    /// Resolution cell in range, m.
    pub cell_range_m: f64,
    /// Resolution cell in azimuth, degrees.
    pub cell_azimuth_deg: f64,
    /// Standard error of the range rate of a plot, m/s, where the radar reports it.
    pub sigma_range_rate_mps: f64,
    /// Resolution cell in range rate, m/s, where the radar reports it.
    pub cell_range_rate_mps: f64,
    /// Standard error of reported heights, m, above that of `site.position`: they give plots an elevation; 0 leaves them unused.
    pub sigma_height_m: f64,
    /// Probability of a false plot per cell, to which amplitudes are related; 0 for unknown.
    pub pfa: f64,
    /// Whether reports of simulated targets (SIM) become plots.
    pub use_simulated: bool,
    /// Whether reports of test targets (TST) become plots.
    pub use_test: bool,
    /// Whether reports of the sensor's fixed monitors (RAB) become plots.
    pub use_monitors: bool,
    /// Whether plots carry the address of the transponder as `target_id`: for exports and scores; no stage looks at it.
    pub use_identity: bool,
    /// `[plot_source.registration]`: the offset between the frames of radar and cooperative sensor.
    pub registration: RegistrationConfig,
}

impl Default for PlotSourceConfig {
    fn default() -> Self {
        Self {
            file: String::new(),
            listen: Vec::new(),
            editions: Vec::new(),
            latency_s: 0.5,
            sector_delay_s: 0.0,
            truth: String::new(),
            date: "1970-01-01".into(),
            sectors_per_scan: 32,
            scan_period_s: 1.0,
            turning: None,
            coverage_range_m: 10_000.0,
            sigma_range_m: 3.0,
            sigma_azimuth_deg: 0.1,
            cell_range_m: 6.0,
            cell_azimuth_deg: 0.4,
            sigma_range_rate_mps: 1.0,
            cell_range_rate_mps: 2.0,
            sigma_height_m: 0.0,
            pfa: 0.0,
            use_simulated: false,
            use_test: false,
            use_monitors: false,
            use_identity: false,
            registration: RegistrationConfig::default(),
        }
    }
}

/// Site registration: systematic differences between the radar, true north and the cooperative sensor.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RegistrationConfig {
    /// The radar reads azimuth too large by this, degrees; taken off every plot.
    pub azimuth_bias_deg: f64,
    /// Plots are older than the radar says by this, s; taken off the time of every plot.
    pub plot_lag_s: f64,
    /// Place of the radar, WGS-84 latitude, degrees.
    pub radar_latitude_deg: f64,
    /// Place of the radar, WGS-84 longitude, degrees.
    pub radar_longitude_deg: f64,
    /// Height of the radar above the ellipsoid, m.
    pub radar_height_m: f64,
    /// Origin of the cooperative sensor's Cartesian positions, WGS-84 latitude, degrees.
    pub truth_latitude_deg: f64,
    /// Origin of the cooperative sensor's Cartesian positions, WGS-84 longitude, degrees.
    pub truth_longitude_deg: f64,
    /// Height of that origin above the ellipsoid, m.
    pub truth_height_m: f64,
    /// Added to true positions after the change of tangent plane, m east.
    pub truth_offset_east_m: f64,
    /// Added to true positions after the change of tangent plane, m north.
    pub truth_offset_north_m: f64,
    /// The radar sees the centroid of an aircraft this far behind its cooperative position, m along the heading.
    pub centroid_behind_m: f64,
    /// Step of the cooperative sensor's Cartesian velocity (I010/202), m/s; 0 stands for 1/16, that of the specification.
    pub truth_velocity_step_mps: f64,
}

impl PlotSourceConfig {
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        within("plot_source.sectors_per_scan", self.sectors_per_scan.into(), 1..=1024)?;
        require("plot_source.date", &self.date, self.days_since_1970().is_some(), "a date from 1970 on as YYYY-MM-DD")?;
        positive("plot_source.scan_period_s", self.scan_period_s)?;
        positive("plot_source.coverage_range_m", self.coverage_range_m)?;
        positive("plot_source.sigma_range_m", self.sigma_range_m)?;
        positive("plot_source.sigma_azimuth_deg", self.sigma_azimuth_deg)?;
        positive("plot_source.cell_range_m", self.cell_range_m)?;
        positive("plot_source.cell_azimuth_deg", self.cell_azimuth_deg)?;
        positive("plot_source.latency_s", self.latency_s)?;
        not_negative("plot_source.sector_delay_s", self.sector_delay_s)?;
        positive("plot_source.sigma_range_rate_mps", self.sigma_range_rate_mps)?;
        positive("plot_source.cell_range_rate_mps", self.cell_range_rate_mps)?;
        not_negative("plot_source.sigma_height_m", self.sigma_height_m)?;
        require("plot_source.pfa", self.pfa, (0.0..0.5).contains(&self.pfa), "a number from 0 to below 0.5")?;
        self.registration.check()
    }

    /// Midnight UTC at the start of the configured date, ns since 1970; 0 for a date that is none.
    pub fn midnight_ns(&self) -> u64 {
        self.days_since_1970().unwrap_or(0) * DAY_NS
    }

    fn days_since_1970(&self) -> Option<u64> {
        let date: jiff::civil::Date = self.date.parse().ok()?;
        let midnight = date.to_zoned(jiff::tz::TimeZone::UTC).ok()?.timestamp().as_second();
        u64::try_from(midnight).ok().map(|seconds| seconds / 86_400)
    }
}

impl RegistrationConfig {
    fn check(&self) -> Result<(), ConfigError> {
        let key = |name: &str| format!("plot_source.registration.{name}");
        for (name, value) in
            [("radar_latitude_deg", self.radar_latitude_deg), ("truth_latitude_deg", self.truth_latitude_deg)]
        {
            require(&key(name), value, (-90.0..=90.0).contains(&value), "a latitude from -90 to 90")?;
        }
        for (name, value) in
            [("radar_longitude_deg", self.radar_longitude_deg), ("truth_longitude_deg", self.truth_longitude_deg)]
        {
            require(&key(name), value, (-180.0..=180.0).contains(&value), "a longitude from -180 to 180")?;
        }
        for (name, value) in [
            ("azimuth_bias_deg", self.azimuth_bias_deg),
            ("plot_lag_s", self.plot_lag_s),
            ("radar_height_m", self.radar_height_m),
            ("truth_height_m", self.truth_height_m),
            ("truth_offset_east_m", self.truth_offset_east_m),
            ("truth_offset_north_m", self.truth_offset_north_m),
            ("centroid_behind_m", self.centroid_behind_m),
        ] {
            require(&key(name), value, value.is_finite(), "a finite number")?;
        }
        not_negative(&key("truth_velocity_step_mps"), self.truth_velocity_step_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn midnight_s(date: &str) -> u64 {
        PlotSourceConfig { date: date.into(), ..Default::default() }.midnight_ns() / 1_000_000_000
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(midnight_s("1970-01-01"), 0);
        assert_eq!(midnight_s("2000-03-01"), 951_868_800);
        assert_eq!(midnight_s("2020-10-02"), 1_601_596_800);
    }

    #[test]
    fn what_is_no_date_is_refused() {
        for date in ["", "2020-13-01", "2021-02-29", "2020-00-10", "1969-12-31", "2020-01-01-01", "2nd of May"] {
            let error = PlotSourceConfig { date: date.into(), ..Default::default() }.check().expect_err(date);
            assert!(error.to_string().starts_with("key `plot_source.date`"), "{error}");
        }
    }
}
