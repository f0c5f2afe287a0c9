//! What a cycle waits for: in lossless mode everything, in real time what is not far behind.

use common::config::{ChainConfig, Mode};
use common::units::{NS_PER_S, seconds_between};
use tracing::warn;

use crate::feed::Feed;
use crate::settings::Settings;

/// Cycles that a site may be ahead of the others.
const CYCLES_AHEAD: f64 = 2.0;

/// What a cycle waits for.
pub(crate) struct Pacing {
    real_time: bool,
    /// How far a site may be behind the first one before nobody waits for it, measurement time; only in real time.
    wait_ns: u64,
    /// Cycles that a site may be ahead of the others; only in lossless mode, where it waits for them.
    ahead_ns: u64,
    /// Whether this process has been started again.
    again: bool,
    /// Whether the chain has been asked to end.
    pub(crate) stopping: bool,
}

impl Pacing {
    pub(crate) fn new(chain: &ChainConfig) -> Self {
        Self {
            real_time: chain.run.mode == Mode::RealTime,
            wait_ns: (chain.fusion.wait_s * NS_PER_S) as u64,
            ahead_ns: (CYCLES_AHEAD * chain.fusion.cycle_s * NS_PER_S) as u64,
            again: chain.run.first_scan > 0,
            stopping: false,
        }
    }

    pub(crate) fn has_ended(&self, feed: &Feed) -> bool {
        feed.has_ended(self.stopping, self.again)
    }

    /// Measurement time up to which tracks are taken.
    pub(crate) fn limit_ns(&self, next_ns: Option<u64>) -> u64 {
        if self.real_time { u64::MAX } else { next_ns.map_or(0, |next_ns| next_ns.saturating_add(self.ahead_ns)) }
    }

    /// Whether nobody waits for the sites that are not as far as `now_ns`, since the first one is much farther.
    pub(crate) fn is_overdue(&self, now_ns: u64, feeds: &[Feed]) -> bool {
        let in_step = feeds.iter().filter(|feed| !feed.is_out_of_step);
        let first_ns = in_step.filter_map(Feed::time_ns).max();
        self.real_time && first_ns.is_some_and(|first_ns| first_ns >= now_ns.saturating_add(self.wait_ns))
    }

    /// Whether the cycle that ends at `now_ns` can be worked: all that are waited for have told everything, and somebody has.
    pub(crate) fn is_due(&self, now_ns: u64, feeds: &[Feed]) -> bool {
        let has_told = |feed: &Feed| feed.has_passed(now_ns) && (self.real_time || feed.has_told_truth(now_ns));
        let some = feeds.iter().any(|feed| feed.has_passed(now_ns) && !feed.is_out_of_step);
        let all = || feeds.iter().all(|feed| has_told(feed) || feed.is_out_of_step || self.has_ended(feed));
        some && (self.is_overdue(now_ns, feeds) || all())
    }

    /// In real time, notes and says which sites have a clock that is not that of the others: farther from the median than reports are
    /// taken.
    pub(crate) fn find_out_of_step(&self, feeds: &mut [Feed], sites: &[&ChainConfig]) {
        // What silent sites said last is long ago.
        let heard = feeds.iter().filter(|feed| !self.has_ended(feed) && feed.is_heard());
        let mut times: Vec<u64> = heard.filter_map(Feed::time_ns).collect();
        times.sort_unstable();
        let Some(&median_ns) = times.get(times.len() / 2).filter(|_| self.real_time) else { return };
        for (feed, site) in feeds.iter_mut().zip(sites) {
            let away_s = feed.time_ns().map_or(0.0, |time_ns| seconds_between(median_ns, time_ns));
            // One that says nothing any more is late, which is no matter of its clock.
            let is_out =
                if feed.is_heard() { away_s.abs() > Settings::default().patience_s } else { feed.is_out_of_step };
            if is_out && !feed.is_out_of_step {
                warn!("the clock of site {} is {away_s:+.0} s from that of the others: it is left out", site.site.name);
            }
            feed.is_out_of_step = is_out;
        }
    }
}
