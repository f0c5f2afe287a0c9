//! Tracks as JSON lines: one object for each report of a track, described in `docs/outputs.md`.

use common::time::rfc3339;
use common::tracks::{estimator_name, kind_name, pack};
use serde::Serialize;

use crate::format::{Format, Frames, Update};
use crate::targets::Target;

/// A report of a track. What is not known is left out.
#[derive(Debug, Serialize)]
pub struct TrackLine<'a> {
    /// Site whose track it is.
    site: &'a str,
    /// Number of the track, of this track only while `session` is the same.
    id: u64,
    /// What operators call it.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    /// Start of the tracker, or of the one before whose tracks it goes on with.
    session: u64,
    /// Time of the state, RFC 3339, UTC.
    time: String,
    /// `tentative`, `confirmed`, `coasting` or `ended`.
    state: &'static str,
    /// WGS-84, degrees, where the site has a position.
    #[serde(skip_serializing_if = "Option::is_none")]
    latitude_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    longitude_deg: Option<f64>,
    /// Above the ellipsoid, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    height_m: Option<f64>,
    /// Position about the site, m.
    east_m: f64,
    north_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    up_m: Option<f64>,
    /// Velocity, m/s.
    east_mps: f64,
    north_mps: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    up_mps: Option<f64>,
    /// Horizontal speed, m/s; course clockwise from north, degrees.
    speed_mps: f64,
    course_deg: f64,
    /// Standard errors, m and m/s, and the covariance of east and north, m².
    sigma_east_m: f64,
    sigma_north_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma_up_m: Option<f64>,
    covariance_east_north_m2: f64,
    sigma_east_mps: f64,
    sigma_north_mps: f64,
    /// Since its first report and since its last plot, s.
    age_s: f64,
    since_plot_s: f64,
    /// Probability that there is a target.
    existence: f64,
    /// Signal-to-noise ratio, dB.
    snr_db: f32,
    /// Kind of the most probable model of motion, and the filter it is of.
    #[serde(skip_serializing_if = "Option::is_none")]
    model: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    estimator: Option<&'static str>,
}

impl<'a> TrackLine<'a> {
    /// The report of a target at the site of this name, which operators call `name`.
    pub fn new(site: &'a str, name: Option<&'a str>, target: &Target<'_>) -> Self {
        let track = target.track;
        let ([east_m, north_m, up_m], [east_mps, north_mps, up_mps]) = (track.position_m(), track.velocity_mps());
        let has_height = target.has_height();
        Self {
            site,
            id: track.id,
            name,
            session: target.session,
            time: rfc3339(target.time_ns),
            state: target.state(),
            latitude_deg: target.place.map(|place| place.latitude_deg),
            longitude_deg: target.place.map(|place| place.longitude_deg),
            height_m: target.place.filter(|_| has_height).map(|place| place.height_m),
            east_m,
            north_m,
            up_m: has_height.then_some(up_m),
            east_mps,
            north_mps,
            up_mps: has_height.then_some(up_mps),
            speed_mps: target.speed_mps(),
            course_deg: target.course_deg(),
            sigma_east_m: target.sigma(0),
            sigma_north_m: target.sigma(3),
            sigma_up_m: has_height.then(|| target.sigma(6)),
            covariance_east_north_m2: track.covariance[pack(0, 3)],
            sigma_east_mps: target.sigma(1),
            sigma_north_mps: target.sigma(4),
            age_s: target.age_s,
            since_plot_s: target.since_plot_s,
            existence: track.existence,
            snr_db: track.snr_db,
            model: kind_name(track.most_probable_kind()),
            estimator: estimator_name(track.estimator),
        }
    }
}

/// One object a line.
#[derive(Debug, Default)]
pub struct JsonLines {
    not_said: u64,
}

impl Format for JsonLines {
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames) {
        for target in update.targets {
            let written = out.frame(|octets| {
                let name = update.origins.label(target.track.id);
                serde_json::to_writer(&mut *octets, &TrackLine::new(&update.site.name, name, target))?;
                octets.push(b'\n');
                Ok::<(), serde_json::Error>(())
            });
            self.not_said += u64::from(written.is_err());
        }
    }

    fn not_said(&self) -> u64 {
        self.not_said
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::origins::Origins;
    use crate::targets::tests::{NOON_NS, site, targets, track, update};
    use common::commands::{ACCEPTED, Command, LABEL};
    use common::label::Label;
    use common::tracks::{CONFIRMED, KIND_HOVER};
    use serde_json::Value;

    fn line(change: impl FnOnce(&mut common::tracks::Track)) -> Value {
        named_line(change, "")
    }

    fn named_line(change: impl FnOnce(&mut common::tracks::Track), name: &str) -> Value {
        let mut origins = Origins::default();
        let label = Command { track_id: 7, name: Label::new(name), outcome: ACCEPTED, ..Command::new(LABEL, 1, 1) };
        origins.take_action(&label);
        let mut tracks = [track(7, NOON_NS, CONFIRMED)];
        change(&mut tracks[0]);
        let site = site();
        let targets = targets(&tracks);
        let update = update(&site, &targets, &origins);
        let mut frames = Frames::default();
        JsonLines::default().tracks(&update, &mut frames);
        let frame = frames.iter().next().expect("a line");
        assert_eq!(frame.last(), Some(&b'\n'));
        serde_json::from_slice(frame).expect("JSON")
    }

    #[test]
    fn a_line_says_all_that_is_known_and_nothing_else() {
        let said = line(|track| (track.model_kind[0], track.model_probability[0]) = (KIND_HOVER, 1.0));
        assert_eq!(said["time"], "2024-10-04T12:00:00.000Z");
        assert_eq!((&said["state"], &said["model"]), (&"confirmed".into(), &"hover".into()));
        assert_eq!((said["east_m"].as_f64(), said["sigma_north_m"].as_f64()), (Some(12_345.25), Some(9.0)));
        let place = site().place([12_345.25, -6789.0, 900.0]).expect("a place");
        assert_eq!(said["latitude_deg"].as_f64(), Some(place.latitude_deg));
        assert_eq!(said["height_m"].as_f64(), Some(place.height_m));
        assert!(said.get("estimator").is_none() && said.get("name").is_none());
        assert_eq!(named_line(|_| (), "blue")["name"], "blue");
        let flat = line(|track| track.covariance[pack(6, 6)] = 0.0);
        assert!(["height_m", "up_m", "up_mps", "sigma_up_m"].iter().all(|&key| flat.get(key).is_none()));
    }

    #[test]
    fn every_field_is_documented() {
        let text = include_str!("../../docs/outputs.md");
        let said = line(|track| (track.model_kind[0], track.estimator) = (KIND_HOVER, 1));
        for key in said.as_object().expect("an object").keys() {
            assert!(text.contains(&format!("`{key}`")), "{key}");
        }
    }
}
