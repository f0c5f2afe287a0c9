//! What a scan of a track costs each filter: prediction, expected measurement and update, in groups of eight and one by one.

use std::time::Instant;

use tracker::filter::{Evidence, Filter, Group, LANES, Machine, Prior, Row, TwoPlots, Update, expect};
use tracker::plots::measurement::Measurement;
use tracker::plots::radar::Radar;

use super::examples::{EXAMPLES, STEP_S};
use super::filters::{Kind, Setting, Variant};
use crate::Options;

/// Repetitions, the least of whose times counts.
const REPETITIONS: u32 = 200;
/// Scans in a repetition.
const SCANS: u32 = 50;

/// A filter's name and its time per track and scan in groups of eight and alone, ns.
pub(super) type Cost = (&'static str, [f64; 2]);

/// Of the three filters of example 1.
pub(super) fn of_all(options: &Options) -> Vec<Cost> {
    let [recentre, _, _, _, spacing_deg_per_s] = EXAMPLES[0].adaptive;
    let kinds = [
        Kind::Imm5,
        Kind::Adaptive { recentre, spacing_deg_per_s },
        Kind::Switching { threshold: 0.5, variant: Variant::Corrected },
    ];
    let repetitions = if options.quick { 1 } else { REPETITIONS };
    let of = |kind| {
        let setting = Setting { example: EXAMPLES[0], kind };
        (setting.name(), [LANES, 1].map(|lanes| time_ns(&setting.filter(), lanes, repetitions)))
    };
    kinds.into_iter().map(of).collect()
}

/// In a sentence.
pub(super) fn remark(costs: &[Cost]) -> String {
    let ratio = |which: usize, lanes: usize| costs[which].1[lanes] / costs[0].1[lanes];
    let each: Vec<String> =
        costs.iter().map(|(name, [eight, one])| format!("{name} {eight:.0} ns ({one:.0} ns alone)")).collect();
    format!(
        "A scan of a track in groups of eight, on this computer: {}. Three models over five: AGMM {:.2}, SGMM {:.2} (alone {:.2}, {:.2}).",
        each.join(", "),
        ratio(1, 0),
        ratio(2, 0),
        ratio(1, 1),
        ratio(2, 1),
    )
}

fn time_ns(filter: &dyn Filter, lanes: usize, repetitions: u32) -> f64 {
    let plot = |scan: u32| {
        let along = 10.0 * STEP_S * f64::from(scan);
        Measurement::in_plane([3000.0 + along, 4000.0 + 0.1 * along], [60.0, 0.01])
    };
    let layout = *filter.layout();
    let mut state = vec![0.0; layout.words()];
    filter.start(&TwoPlots { previous: &plot(0), last: &plot(1), step_s: STEP_S }, &mut state);
    let (mut update, mut prediction) = (Update::new(&layout), Group::new(&layout));
    let (mut expected, mut evidence) = (Vec::new(), Evidence::default());
    let machine = Machine::default();
    let mut least = f64::INFINITY;
    for _ in 0..repetitions {
        (0..lanes).for_each(|lane| update.posterior.load(lane, &state));
        let begin = Instant::now();
        for scan in 0..SCANS {
            filter.predict(machine, lanes, &update.posterior, &Row::splat(STEP_S), &mut prediction);
            expect(machine, lanes, &Radar::IN_PLANE, 3.0, &prediction, &mut expected);
            evidence.clear(layout.len());
            (0..lanes).for_each(|lane| evidence.add(lane, &plot(scan + 2), 0.0, 1.0));
            let prior = Prior { prediction: &prediction, expected: &expected, inflation: 0.0 };
            filter.update(machine, lanes, prior, &evidence, &mut update);
        }
        let each = begin.elapsed().as_secs_f64() * 1e9 / f64::from(SCANS) / lanes as f64;
        least = least.min(each);
    }
    least
}
