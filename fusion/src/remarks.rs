//! What is wrong with a site, said by its name: once when it begins, and once when it is over.

use common::config::ChainConfig;
use common::units::seconds_between;
use tracing::{info, warn};

use crate::engine::Fusion;
use crate::feed::Feed;
use crate::settings::Counts;

/// Measurement time between two looks at a site, s.
const LOOK_S: f64 = 10.0;
/// Fewest reports in that time that it is judged by.
const FEWEST: u64 = 20;
/// Share of reports that must be wrong.
const SHARE: f64 = 0.1;
/// How much more often than once a scan tracks may come.
const OFTEN: f64 = 3.0;

/// What can be wrong with a site.
const KINDS: usize = 4;
const SAYS_WHAT: [&str; KINDS] = [
    "its tracks do not fit those of the others",
    "it sends old tracks again",
    "its tracks come too often",
    "nothing comes in time",
];

/// What has been said of the sites.
#[derive(Debug, Default)]
pub(crate) struct Remarks {
    looked_ns: Option<u64>,
    sites: Vec<Said>,
}

#[derive(Debug, Default, Clone, Copy)]
struct Said {
    before: Counts,
    is_wrong: [bool; KINDS],
}

impl Remarks {
    /// Looks at what has become of the sites' reports up to `now_ns`, measurement time, and says what has changed.
    pub(crate) fn look(&mut self, now_ns: u64, fusion: &Fusion, feeds: &[Feed], sites: &[&ChainConfig]) {
        let passed_s = self.looked_ns.map_or(f64::INFINITY, |looked_ns| seconds_between(looked_ns, now_ns));
        if passed_s < LOOK_S {
            return;
        }
        self.looked_ns = Some(now_ns);
        self.sites.resize(sites.len(), Said::default());
        for (number, (said, site)) in self.sites.iter_mut().zip(sites).enumerate() {
            let name = &site.site.name;
            let (counts, before) = (fusion.counts(number), said.before);
            said.before = counts;
            if counts.realigned > before.realigned {
                let bias = fusion.registration().bias(number);
                warn!(
                    "site {name} measures {:+.0} m of range, {:+.2}° of azimuth, {:+.2}° of elevation too much, its clock is {:+.2} s ahead; that is beyond what [fusion] expects, and is corrected",
                    bias[0],
                    bias[1].to_degrees(),
                    bias[2].to_degrees(),
                    -bias[3],
                );
            }
            let taken = counts.taken().saturating_sub(before.taken());
            let many = |of: u64| taken >= FEWEST && of as f64 > SHARE * taken as f64;
            let expected = fusion.local_tracks(number) as f64 * passed_s / site.scan_period_s();
            let is_wrong = [
                fusion.matches_nobody(number) || many(counts.kept_out.saturating_sub(before.kept_out)),
                many(counts.repeated.saturating_sub(before.repeated)),
                taken >= FEWEST && taken as f64 > OFTEN * expected,
                !feeds[number].has_passed(now_ns)
                    && !feeds[number].has_ended(false, false)
                    && !feeds[number].is_out_of_step,
            ];
            for (kind, what) in SAYS_WHAT.iter().enumerate() {
                if is_wrong[kind] && !said.is_wrong[kind] {
                    warn!("site {name}: {what}");
                } else if said.is_wrong[kind] && !is_wrong[kind] {
                    info!("site {name}: over: {what}");
                }
            }
            said.is_wrong = is_wrong;
        }
    }
}
