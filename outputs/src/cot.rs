//! Tracks as Cursor on Target events, XML.
//!
//! A track keeps its `uid`. An event is valid until it goes stale; that of a track that has ended is stale at once, which takes it
//! off the map. Errors are of one standard deviation: `ce` that of a circle of the same area as the ellipse, `le` that of the height.

use common::config::{Affiliation, OutputConfig, TargetClass};
use common::time::rfc3339;
use common::units::NS_PER_S;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::format::{Format, Frames, Update};
use crate::targets::{Site, Target};

/// What stands for a height or an error that is not known.
const NOT_KNOWN: &str = "9999999.0";

/// One event for each report of a track.
#[derive(Debug)]
pub struct CursorOnTarget {
    kind: String,
    stale_ns: u64,
    not_said: u64,
}

impl CursorOnTarget {
    /// With the class and the affiliation of the configuration.
    pub fn new(config: &OutputConfig) -> Self {
        let affiliation = match config.affiliation {
            Affiliation::Unknown => 'u',
            Affiliation::Friend => 'f',
            Affiliation::Neutral => 'n',
            Affiliation::Hostile => 'h',
        };
        let of = match config.class {
            TargetClass::Air => "A",
            TargetClass::Aeroplane => "A-M-F",
            TargetClass::Helicopter => "A-M-H",
            TargetClass::Drone => "A-M-H-Q",
            TargetClass::Ship => "S",
            TargetClass::Vehicle => "G",
        };
        let stale_ns = (config.stale_s * NS_PER_S) as u64;
        Self { kind: format!("a-{affiliation}-{of}"), stale_ns, not_said: 0 }
    }

    fn write(&self, site: &Site, target: &Target<'_>, octets: &mut Vec<u8>) -> std::io::Result<()> {
        let no_place = || std::io::Error::other("a track without a place");
        let place = target.place.ok_or_else(no_place)?;
        let time = rfc3339(target.time_ns);
        let stale_ns = if target.has_ended() { 0 } else { self.stale_ns };
        let known = |value: f64, is_known: bool| if is_known { format!("{value:.1}") } else { NOT_KNOWN.into() };
        let has_height = target.has_height();
        let (name, number) = (&site.name, target.track.id);
        let mut xml = Writer::new(octets);
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), Some("yes"))))?;
        xml.create_element("event")
            .with_attributes([
                ("version", "2.0"),
                ("uid", &format!("radar-chain.{name}.{:x}.{number}", target.session)),
                ("type", &self.kind),
                ("how", "m-r"),
                ("time", &time),
                ("start", &time),
                ("stale", &rfc3339(target.time_ns + stale_ns)),
            ])
            .write_inner_content(|event| {
                event
                    .create_element("point")
                    .with_attributes([
                        ("lat", format!("{:.7}", place.latitude_deg).as_str()),
                        ("lon", &format!("{:.7}", place.longitude_deg)),
                        ("hae", &known(place.height_m, has_height)),
                        ("ce", &known(target.circular_error_m(), true)),
                        ("le", &known(target.sigma(6), has_height)),
                    ])
                    .write_empty()?;
                event.create_element("detail").write_inner_content(|detail| {
                    let callsign = format!("{name} {number}");
                    detail.create_element("contact").with_attribute(("callsign", callsign.as_str())).write_empty()?;
                    let [course, speed] = [target.course_deg(), target.speed_mps()].map(|value| format!("{value:.2}"));
                    let motion = [("course", course.as_str()), ("speed", speed.as_str())];
                    detail.create_element("track").with_attributes(motion).write_empty()?;
                    let remarks = format!("radar track, {}", target.state());
                    detail.create_element("remarks").write_text_content(BytesText::new(&remarks))?;
                    Ok(())
                })?;
                Ok(())
            })?;
        Ok(())
    }
}

impl Format for CursorOnTarget {
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames) {
        for target in update.targets {
            let written = out.frame(|octets| self.write(update.site, target, octets));
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
    use common::tracks::{CONFIRMED, Track};

    fn event(config: &OutputConfig, tracks: &[Track]) -> String {
        let (site, targets) = (site(), targets(tracks));
        let origins = Origins::default();
        let update = update(&site, &targets, &origins);
        let mut frames = Frames::default();
        CursorOnTarget::new(config).tracks(&update, &mut frames);
        String::from_utf8(frames.iter().next().expect("an event").to_vec()).expect("text")
    }

    #[test]
    fn an_event_says_what_where_and_how_long() {
        let config = OutputConfig {
            class: TargetClass::Drone,
            affiliation: Affiliation::Hostile,
            stale_s: 3.0,
            ..OutputConfig::default()
        };
        let text = event(&config, &[track(7, NOON_NS, CONFIRMED)]);
        for part in [
            "uid=\"radar-chain.site1.1.7\"",
            "type=\"a-h-A-M-H-Q\" how=\"m-r\"",
            "time=\"2024-10-04T12:00:00.000Z\"",
            "stale=\"2024-10-04T12:00:03.000Z\"",
            "ce=\"10.4\" le=\"40.0\"",
            "<contact callsign=\"site1 7\"/>",
            "<track course=\"143.13\" speed=\"50.00\"/>",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn what_is_not_known_says_so_and_an_ended_track_is_stale() {
        let mut tracks = [track(7, NOON_NS, CONFIRMED)];
        tracks[0].covariance[common::tracks::pack(6, 6)] = 0.0;
        let text = event(&OutputConfig::default(), &tracks);
        assert!(text.contains("hae=\"9999999.0\"") && text.contains("le=\"9999999.0\""), "{text}");
        let mut ended = targets(&tracks)[0];
        let track = Track { state_code: common::tracks::TERMINATED, ..tracks[0] };
        ended.track = &track;
        let mut octets = Vec::new();
        CursorOnTarget::new(&OutputConfig::default()).write(&site(), &ended, &mut octets).expect("written");
        assert!(String::from_utf8_lossy(&octets).contains("stale=\"2024-10-04T12:00:00.000Z\""));
    }
}
