//! From when to when a recording is replayed.

use std::str::FromStr;

use common::config::ChainConfig;
use common::process::BadInput;
use common::recording::Recorded;
use common::units::NS_PER_S;

use crate::replay::Playback;

/// A part of a recording, in whole scans.
#[derive(Debug, Clone, Default, PartialEq, clap::Args)]
pub struct Window {
    /// Begin with the first whole scan from this time on: UTC (2026-01-31T12:00:00Z) or seconds after the beginning
    #[arg(long, value_name = "T")]
    pub from: Option<Moment>,
    /// End with the scan of this time
    #[arg(long, value_name = "T")]
    pub to: Option<Moment>,
}

/// A measurement time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moment {
    /// ns UTC.
    Utc(u64),
    /// Seconds after the first message.
    After(f64),
}

impl FromStr for Moment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected a time in UTC such as 2026-01-31T12:00:00Z, or seconds from 0 up".to_string();
        if let Ok(seconds) = text.parse::<f64>() {
            return if (0.0..f64::INFINITY).contains(&seconds) { Ok(Self::After(seconds)) } else { Err(expected()) };
        }
        let time: jiff::Timestamp = text.parse().map_err(|_| expected())?;
        u64::try_from(time.as_nanosecond()).map(Self::Utc).map_err(|_| expected())
    }
}

impl Moment {
    /// ns UTC, in a recording that begins at `start_ns`.
    fn time_ns(self, start_ns: u64) -> u64 {
        match self {
            Self::Utc(time_ns) => time_ns,
            Self::After(seconds) => start_ns.saturating_add((seconds * NS_PER_S).round() as u64),
        }
    }
}

impl Window {
    /// Whether it leaves something out.
    pub fn is_set(&self) -> bool {
        self.from.is_some() || self.to.is_some()
    }

    /// Sets the first scan and the number of scans of the replay that `config` describes. The first one is a whole scan
    /// that the recording holds, so that what it does not hold is not counted as lost.
    ///
    /// # Errors
    /// The recording cannot be read, or holds nothing of this time.
    pub fn narrow(&self, config: &mut ChainConfig) -> Result<(), BadInput> {
        let driving = common::topology::last_in_processing(&config.replay.topics);
        let mut playback = Playback::open(config).map_err(|error| BadInput(error.to_string()))?;
        let (mut start_ns, mut first, mut last) = (None, None, None);
        while let Some(message) =
            playback.read().map_err(|error| BadInput(format!("{}: {error}", config.replay.file)))?
        {
            let time_ns = message.by_ref().time_ns();
            let Some((scan, place)) = place(&message).filter(|_| message.by_ref().topic() == driving) else { continue };
            let start_ns = *start_ns.get_or_insert(time_ns);
            if self.to.is_some_and(|to| time_ns > to.time_ns(start_ns)) {
                break;
            }
            if place == 0 && self.from.is_none_or(|from| time_ns >= from.time_ns(start_ns)) {
                first = first.or(Some(scan));
            }
            last = Some(scan);
            if first.is_some() && self.to.is_none() {
                break;
            }
        }
        match (first, last) {
            (Some(first), Some(last)) => {
                config.run.first_scan = first;
                if self.to.is_some() {
                    config.run.scans = last + 1;
                }
                Ok(())
            }
            _ if self.is_set() => {
                Err(BadInput(format!("{} holds no whole scan of {} of this time", config.replay.file, driving.name())))
            }
            _ => Ok(()), // less than a scan in all
        }
    }
}

/// Scan of a message and its place in the scan; truth and health drive nothing.
fn place(message: &Recorded) -> Option<(u32, u32)> {
    match message {
        Recorded::Dwells(header, _) => Some((header.scan, header.dwell)),
        Recorded::Plots(header, _) => Some((header.scan, header.sector)),
        Recorded::Tracks(header, _) => Some((header.scan, header.sector)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    use common::plots::PlotsHeader;
    use common::recording::container::{Description, Writer};

    #[test]
    fn times_are_utc_or_seconds_after_the_beginning() {
        assert_eq!("1970-01-01T00:00:01.5Z".parse(), Ok(Moment::Utc(1_500_000_000)));
        assert_eq!("1970-01-01T01:00:01+01:00".parse(), Ok(Moment::Utc(1_000_000_000)));
        assert_eq!("2.5".parse(), Ok(Moment::After(2.5)));
        for bad in ["-1", "inf", "NaN", "noon", "1969-12-31T23:59:59Z", ""] {
            assert!(bad.parse::<Moment>().is_err_and(|error| error.contains("expected")), "{bad}");
        }
        assert_eq!(Moment::After(2.5).time_ns(7), 2_500_000_007);
    }

    #[test]
    fn a_window_is_whole_scans_that_are_there() {
        // Four sectors a second; the recording begins in the middle of scan 10 and ends with scan 19.
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a-1.000.mcap");
        let file = File::create(&path).expect("a file");
        let mut writer = Writer::new(file, &Description::default(), "", 1 << 20).expect("a container");
        let begin_ns = 1_000_000_000_000;
        for seq in 42..80_u64 {
            let time_ns = begin_ns + (seq - 42) * 250_000_000;
            let (scan, sector) = ((seq / 4) as u32, (seq % 4) as u32);
            let header = PlotsHeader { seq, time_ns, scan, sector, ..PlotsHeader::default() };
            writer.write(common::recording::RecordedRef::Plots(&header, &[])).expect("written");
        }
        writer.finish().expect("written");
        let scans = |from: Option<&str>, to: Option<&str>| {
            let mut config = ChainConfig::default();
            config.replay.file = path.display().to_string();
            (config.run.first_scan, config.run.scans) = (0, 0);
            let moment = |text: &str| text.parse().expect("a time");
            let window = Window { from: from.map(moment), to: to.map(moment) };
            window.narrow(&mut config).map(|()| (config.run.first_scan, config.run.scans))
        };
        assert_eq!(scans(None, None).expect("found"), (11, 0));
        assert_eq!(scans(Some("0.5"), None).expect("found"), (11, 0)); // scan 11 begins half a second after the beginning
        assert_eq!(scans(Some("0.501"), Some("2.5")).expect("found"), (12, 14));
        assert_eq!(scans(Some("1970-01-01T00:16:43Z"), None).expect("found"), (14, 0)); // 3 s after it
        assert_eq!(scans(None, Some("100")).expect("found"), (11, 20));
        for (from, to) in [(Some("9"), None), (Some("3"), Some("2")), (None, Some("1970-01-01T00:00:00Z"))] {
            let error = scans(from, to).expect_err("nothing").to_string();
            assert!(error.contains("no whole scan of plots"), "{error}");
        }
    }
}
