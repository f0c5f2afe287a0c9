//! The schedule of a site: where the positions of its streams begin, and where they end as far as that can be known.
//!
//! A simulator sends every position of its schedule, so what nobody has told of is known to be missing: before the first
//! message of a stream and after its last. Where the end of the stream has been seen, its last message is the end; otherwise the
//! scans that were asked for are, or what the source has said of itself.

use common::config::{ChainConfig, Source};
use common::health::Health;
use common::message::END_OF_STREAM;
use common::recording::RecordedRef;
use common::topic::Topic;
use common::topology::{self, Stage};
use serde::{Deserialize, Serialize};

/// Where the streams of a site begin and end.
#[derive(Debug, Default, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Schedule {
    dwells_per_scan: u64,
    sectors_per_scan: u64,
    first_scan: u64,
    /// Scans asked for; 0 for no end.
    scans: u64,
    /// The source is the simulator.
    is_simulated: bool,
    /// Plots come from the source, and not from a plot extractor.
    plots_of_source: bool,
    /// The end of a stream has been seen.
    ended: bool,
    /// Position after the last dwell that the simulator has told of.
    dwells: u64,
}

impl Schedule {
    /// Of a site with this configuration.
    pub(crate) fn new(config: &ChainConfig) -> Self {
        Self {
            dwells_per_scan: config.radar.dwells_per_scan.into(),
            sectors_per_scan: config.sectors_per_scan().into(),
            first_scan: config.run.first_scan.into(),
            scans: config.run.scans.into(),
            is_simulated: config.run.source == Source::RadarSim,
            plots_of_source: !topology::runs(config, "plot-extractor"),
            ..Self::default()
        }
    }

    /// Notes how far a message shows that the streams have gone.
    pub(crate) fn take(&mut self, message: RecordedRef<'_>) {
        self.ended |= message.topic().is_data() && message.place().flags & END_OF_STREAM != 0;
        if let RecordedRef::HealthReports(_, reports) = message {
            let of_source = |health: &&Health| Stage::from_name(health.process.as_str()).is_some_and(Stage::is_source);
            reports.iter().filter(of_source).for_each(|health| self.take_source(health));
        }
    }

    /// Notes what the source says of itself.
    fn take_source(&mut self, health: &Health) {
        if self.is_simulated && health.messages_out > 0 {
            let before = (health.messages_out - 1) / self.dwells_per_scan.max(1);
            let began = u64::from(health.scan).saturating_sub(before) * self.dwells_per_scan;
            self.dwells = self.dwells.max(began + health.messages_out);
        }
    }

    /// The first position of a topic, where it is known.
    pub(crate) fn first(&self, topic: Topic) -> Option<u64> {
        match topic {
            Topic::Dwells => Some(self.first_scan * self.dwells_per_scan),
            Topic::Plots | Topic::Tracks => Some(self.first_scan * self.sectors_per_scan),
            Topic::Truth => self.is_simulated.then_some(self.first_scan),
            Topic::SystemTracks | Topic::Commands | Topic::Actions | Topic::ClutterMap | Topic::HealthReports => None,
        }
    }

    /// Whether all positions of a topic are sent, and by the source itself.
    pub(crate) fn is_complete(&self, topic: Topic) -> bool {
        self.is_simulated && matches!(topic, Topic::Dwells | Topic::Truth)
    }

    /// Whether the messages of a topic come from the source, which loses what it has in hand when it dies.
    pub(crate) fn is_of_source(&self, topic: Topic) -> bool {
        topic == Topic::Plots && self.plots_of_source
    }

    /// The position after the last one of a topic, as far as it is known; 0 where it is not.
    pub(crate) fn end(&self, topic: Topic) -> u64 {
        let scans = if self.is_simulated && !self.ended { self.scans } else { 0 };
        match topic {
            Topic::Dwells => self.dwells.max(scans * self.dwells_per_scan),
            Topic::Truth => self.dwells.div_ceil(self.dwells_per_scan.max(1)).max(scans),
            Topic::Plots | Topic::Tracks => scans * self.sectors_per_scan,
            Topic::SystemTracks | Topic::Commands | Topic::Actions | Topic::ClutterMap | Topic::HealthReports => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::health::HealthHeader;
    use common::tracks::TracksHeader;

    fn health(scan: u32, messages_out: u64) -> Health {
        let mut health = Health { scan, messages_out, ..Health::default() };
        health.process = "radar-sim".into();
        health
    }

    #[test]
    fn the_end_is_what_was_asked_for_until_it_is_seen_elsewhere() {
        let mut config = ChainConfig::default();
        (config.run.scans, config.radar.dwells_per_scan, config.radar.sectors_per_scan) = (10, 100, 4);
        let mut schedule = Schedule::new(&config);
        let ends = |schedule: &Schedule| [Topic::Dwells, Topic::Truth, Topic::Plots].map(|topic| schedule.end(topic));
        assert_eq!(ends(&schedule), [1000, 10, 40]);
        // The source was started again with scan 4, and stopped in the middle of scan 6.
        for (scan, messages_out) in [(2, 250), (6, 225)] {
            schedule.take(RecordedRef::HealthReports(&HealthHeader::default(), &[health(scan, messages_out)]));
        }
        let last = TracksHeader { flags: END_OF_STREAM, ..TracksHeader::default() };
        schedule.take(RecordedRef::Tracks(&last, &[]));
        assert_eq!(ends(&schedule), [625, 7, 0]);
        config.run.source = Source::PlotSource;
        assert_eq!(ends(&Schedule::new(&config)), [0, 0, 0]);
    }
}
