//! The class of a target, from declarations of several radars that are right with some probability (F10).

use common::random::{Purpose, generator};
use fusion::class::{declared, posterior};
use rand::RngExt;

use crate::{Case, Options, Results, Row};

/// Classes that a target may be of.
const CLASSES: usize = 4;
/// Probability that one declaration is right.
pub(super) const RIGHT: [f64; 3] = [0.5, 0.6, 0.7];
/// Radars that declare.
pub(super) const RADARS: [usize; 4] = [1, 2, 3, 8];

/// Share of 20,000 targets whose most probable class is their own.
pub(super) fn measure(options: &Options, results: &mut Results) {
    let targets = if options.quick { 200 } else { 20_000 };
    for right in RIGHT {
        for radars in RADARS {
            let mut rng = generator(options.seed, Purpose::Measurement, radars as u32, (1000.0 * right) as u32);
            let mut recognised = 0;
            for _ in 0..targets {
                let class = rng.random_range(0..CLASSES);
                let declarations: Vec<[f64; CLASSES]> = (0..radars)
                    .map(|_| {
                        let other = (class + rng.random_range(1..CLASSES)) % CLASSES;
                        declared(if rng.random::<f64>() < right { class } else { other }, right)
                    })
                    .collect();
                let probability = posterior(declarations);
                let most = probability.iter().copied().fold(0.0, f64::max);
                // Of equals, any.
                let best: Vec<usize> = (0..CLASSES).filter(|&of| probability[of] > most * (1.0 - 1e-9)).collect();
                recognised += u64::from(best[rng.random_range(0..best.len())] == class);
            }
            let case = Case::new().with("declared_right", right).with("radars", radars);
            results.rows.push(Row::proportion(&case, "recognised", recognised, targets));
        }
    }
}
