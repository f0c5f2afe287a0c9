//! What a cycle waits for: in lossless mode everything, in real time what is not far behind.

use common::config::{ChainConfig, Mode};
use common::pace::Speed;
use common::units::NS_PER_S;
use tracing::{info, warn};

use crate::clocks::{Clock, Common};
use crate::engine::Fusion;
use crate::feed::Feed;

/// Cycles that a site may be ahead of the others.
const CYCLES_AHEAD: f64 = 2.0;
/// Longest that a message is usually on its way, s.
const ON_THE_WAY_S: f64 = 1.0;
/// A clock that has been found wrong is believed again when it is within this share of what is allowed.
const BELIEVED: f64 = 0.7;
/// A clock that is so far from the others is of no use, whoever is right, s: that of the reports that fusion takes.
const HOPELESS_S: f64 = 60.0;

/// What a cycle waits for.
pub(crate) struct Pacing {
    real_time: bool,
    /// How far a site may be behind the first one before nobody waits for it, measurement time; only in real time.
    wait_ns: u64,
    /// Cycles that a site may be ahead of the others; only in lossless mode, where it waits for them.
    ahead_ns: u64,
    /// How fast measurement time runs; 0 if as fast as it can.
    rate: f64,
    /// In real time, the clocks of all sites together.
    common: Option<Common>,
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
            rate: match chain.run.speed {
                Speed::Times(rate) => rate,
                Speed::Max => 0.0,
            },
            common: None,
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

    /// Whether nobody waits for the sites that are not as far as `now_ns`, since by the clock of most it is much later.
    pub(crate) fn is_overdue(&self, now_ns: u64) -> bool {
        self.real_time && self.common.is_some_and(|common| common.time_ns >= now_ns.saturating_add(self.wait_ns))
    }

    /// Whether the cycle that ends at `now_ns` can be worked: all that are waited for have told everything, and somebody has.
    pub(crate) fn is_due(&self, now_ns: u64, feeds: &[Feed]) -> bool {
        let has_told = |feed: &Feed| feed.has_passed(now_ns) && (self.real_time || feed.has_told_truth(now_ns));
        let some = feeds.iter().any(|feed| feed.has_passed(now_ns) && !feed.is_out_of_step());
        let all = || feeds.iter().all(|feed| has_told(feed) || feed.is_out_of_step() || self.has_ended(feed));
        some && (self.is_overdue(now_ns) || all())
    }

    /// In real time, finds which time it is, and notes and says which sites have a clock that is not that of most. The tracks of one that is
    /// ahead are left out; one that is behind may only be late, and nobody waits for it.
    pub(crate) fn find_out_of_step(&mut self, feeds: &mut [Feed], sites: &[&ChainConfig], fusion: &mut Fusion) {
        if !self.real_time {
            return;
        }
        let clock = |feed: &Feed, site: &ChainConfig| {
            let time_ns = feed.clock_ns(self.rate).filter(|_| !self.has_ended(feed) && feed.is_heard())?;
            // Sites that run as fast as they can have no clock in common.
            let within_s = if self.rate > 0.0 {
                self.wait_ns as f64 / NS_PER_S + site.scan_period_s() + self.rate * ON_THE_WAY_S
            } else {
                HOPELESS_S
            };
            Some(Clock { time_ns, within_s: if feed.is_out_of_step() { BELIEVED * within_s } else { within_s } })
        };
        let clocks: Vec<Option<Clock>> = feeds.iter().zip(sites).map(|(feed, site)| clock(feed, site)).collect();
        let heard: Vec<Clock> = clocks.iter().flatten().copied().collect();
        // Where too few are heard to decide, those decide that have been right so far.
        let right: Vec<Clock> = feeds
            .iter()
            .zip(&clocks)
            .filter(|(feed, _)| !feed.is_out_of_step())
            .filter_map(|(_, clock)| *clock)
            .collect();
        let of_all = Common::of(&heard);
        let common = of_all.filter(|all| all.is_majority).or_else(|| Common::of(&right)).or(of_all);
        let Some(common) = common else { return };
        if self.common.is_none_or(|before| before.is_majority) && !common.is_majority {
            warn!(
                "the clocks of the sites are not the same, and no majority says which of them are right: all are taken"
            );
        }
        self.common = Some(common);
        for (number, (feed, site)) in feeds.iter_mut().zip(sites).enumerate() {
            // What one says that is not heard is no matter of its clock.
            let Some(clock) = clocks[number] else { continue };
            let (was_out, was_ahead, name) = (feed.is_out_of_step(), feed.is_ahead(), &site.site.name);
            feed.wrong_by_s = common.wrong_by_s(&clock, HOPELESS_S);
            if feed.is_ahead() && !was_ahead {
                fusion.forget(number); // what it has told of times to come
                warn!("the clock of site {name} is {:.1} s ahead of that of most: it is left out", feed.wrong_by_s);
            } else if feed.is_out_of_step() && !was_out {
                let behind_s = -feed.wrong_by_s;
                warn!(
                    "site {name} is {behind_s:.1} s behind most: its clock is wrong or its tracks come late, and nobody waits for it"
                );
            } else if was_out && !feed.is_out_of_step() {
                info!("the clock of site {name} is that of most again");
            }
        }
    }
}
