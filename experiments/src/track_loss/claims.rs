//! The source's claims against the nearest neighbour: 18, 8 and 2 times fewer losses at F = 0.1, 0.01 and 0.001, and up to 9 times
//! longer tracking. Which reading is meant is not said; all that there are get a row.

use common::config::Association;
use common::random::{Purpose, generator};
use evaluation::bootstrap;

use super::{Case, LONGEST, cases};
use crate::Row;
use crate::follow::Fate;
use crate::rows::LEVEL;
use crate::settings::Settings;

/// Claimed ratio of losses by F.
const CLAIMED: [f64; 3] = [18.0, 8.0, 2.0];
/// Claimed ratio of times, at most.
const CLAIMED_TIME: f64 = 9.0;
const SOURCE: &str = "claim of the source";
const RESAMPLES: usize = 1000;

/// Ratios and what they say.
pub(super) struct Claims {
    pub(super) rows: Vec<Row>,
    pub(super) remarks: Vec<String>,
}

/// Compares PDA with statistics with the nearest neighbour on the same runs, where both have the source's settings.
pub(super) fn of(all: &[Case], seed: u64) -> Claims {
    let mut claims = Claims { rows: Vec::new(), remarks: Vec::new() };
    let source = |case: &&Case| case.setting.settings == Settings::Source;
    let statistics = all.iter().filter(source).filter(|case| case.setting.association == Association::PdaStatistics);
    for (index, case) in (0..).zip(statistics) {
        let nearest = super::Setting { association: Association::Nearest, ..case.setting };
        let Some(nearest) = all.iter().find(|other| other.setting == nearest) else { continue };
        let pairs: Vec<[Fate; 2]> = nearest.fates.iter().zip(&case.fates).map(|(&a, &b)| [a, b]).collect();
        let mut rng = generator(seed, Purpose::Resampling, index, 0);
        let mut ratio = |of: fn(&Fate) -> f64| {
            bootstrap::interval(&pairs, RESAMPLES, LEVEL, &mut rng, |drawn| {
                let sum = |which: usize| drawn.iter().map(|pair| of(&pair[which])).sum::<f64>();
                sum(0) / sum(1)
            })
        };
        let losses = ratio(|fate| f64::from(u32::from(fate.lost_at.is_some())));
        // Longer by statistics: the other way round.
        let times = ratio(|fate| f64::from(fate.scans()));
        let times =
            evaluation::Estimate { value: 1.0 / times.value, lo: 1.0 / times.hi, hi: 1.0 / times.lo, n: times.n };
        let parameters = case.setting.case();
        let claimed =
            cases::PFA.iter().position(|pfa| (pfa - case.setting.pfa).abs() < 1e-9).map(|place| CLAIMED[place]);
        let mut row = Row::new(&parameters, "loss_ratio_to_nearest", losses);
        if let Some(claimed) = claimed {
            row = row.against(claimed, SOURCE);
        }
        claims.rows.push(row);
        claims.rows.push(Row::new(&parameters, "time_ratio_to_nearest", times).against(CLAIMED_TIME, SOURCE));
    }
    claims.remarks.extend(verdict(&claims.rows));
    claims
}

/// For each trajectory and F: the ratios from the lowest to the highest SNR, the largest with its interval.
fn verdict(rows: &[Row]) -> Vec<String> {
    let key =
        |row: &Row| ["trajectory", "pfa"].map(|key| row.case.get(key).map(ToString::to_string).unwrap_or_default());
    rows.chunk_by(|a, b| key(a) == key(b))
        .map(|group| {
            let [trajectory, pfa] = key(&group[0]).map(|text| text.replace('"', ""));
            let of = |metric: &str| {
                let rows: Vec<&Row> = group.iter().filter(|row| row.metric == metric).collect();
                let finite = rows.iter().filter(|row| row.value.is_finite());
                let values: Vec<String> = rows.iter().map(|row| format!("{:.2}", row.value)).collect();
                let most = finite.max_by(|a, b| a.value.total_cmp(&b.value));
                let most = most.map_or("–".into(), |row| format!("{:.1} [{:.1}, {:.1}]", row.value, row.lo, row.hi));
                (values.join(" "), most, rows.first().and_then(|row| row.reference).unwrap_or(f64::NAN))
            };
            let (losses, most_losses, claimed) = of("loss_ratio_to_nearest");
            let (times, most_times, claimed_time) = of("time_ratio_to_nearest");
            format!(
                "{trajectory}, F = {pfa}, nearest neighbour against PDA with statistics, by rising SNR: losses {losses} times \
                 as many, at most {most_losses} (claimed {claimed}); tracked {times} times as long, at most {most_times} \
                 (claimed up to {claimed_time}; no run is longer than {LONGEST} scans)."
            )
        })
        .collect()
}
