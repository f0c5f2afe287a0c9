//! Whether the extractor's false alarms are as many as its threshold promises: a CFAR outside the noise that it is made for says so.

use common::health::FalseAlarms;
use common::plots::PlotsHeader;

use super::false_alarm_map::FalseAlarmMap;
use super::measurement::Measurement;

/// Turns over which false alarms are remembered.
const MEMORY_TURNS: f64 = 100.0;
/// Turns that the tracks of targets there from the start are given, so that their plots are theirs.
const TURNS_TO_START: u32 = 8;
/// False alarms, found or expected, below which a rate means nothing.
const FEW: f64 = 20.0;

/// Plots that no track explains against cells tested.
#[derive(Debug, Default)]
pub struct FalseAlarmCount {
    pfa: f64,
    turns: u32,
    found: f64,
    cells: f64,
    /// Turns that the sums stand for.
    scans: f64,
    /// Least width of a ring of the map, m.
    finest_m: f64,
    map: FalseAlarmMap,
}

impl FalseAlarmCount {
    /// Takes what the header of a sector says of the cells behind its plots; `dimensions` are those measured.
    pub fn test(&mut self, header: &PlotsHeader, dimensions: usize) {
        (self.pfa, self.finest_m) = (header.pfa, header.cell_range_m);
        // Neighbouring cells over threshold become one plot: of a cell and those before it in each direction, the first counts.
        let neighbours = f64::from(3_u32.pow(dimensions as u32) - 1) / 2.0;
        let alone = (-neighbours * header.pfa).exp();
        if self.turns >= TURNS_TO_START {
            self.cells += header.cells as f64 * alone;
        }
    }

    /// Takes a plot; `unclaimed` is the probability that no track has caused it.
    pub fn observe(&mut self, plot: &Measurement, unclaimed: f64) {
        if self.turns >= TURNS_TO_START {
            self.found += unclaimed;
            self.map.observe(plot, unclaimed, self.finest_m);
        }
    }

    /// A turn has ended.
    pub fn end_turn(&mut self) {
        self.scans += f64::from(u8::from(self.turns >= TURNS_TO_START));
        self.turns = self.turns.saturating_add(1);
        let keep = 1.0 - 1.0 / MEMORY_TURNS;
        for sum in [&mut self.found, &mut self.cells, &mut self.scans] {
            *sum *= keep;
        }
        self.map.end_turn(keep as f32);
    }

    /// Where they fall.
    pub fn map(&self) -> &FalseAlarmMap {
        &self.map
    }

    /// Turns that the map stands for, and cells tested in them; earlier ones count less.
    pub fn tested(&self) -> (f64, f64) {
        (self.scans, self.cells)
    }

    /// Set and measured probability of a false alarm; zeros where a radar does not say its own, or while there are few.
    pub fn rate(&self) -> FalseAlarms {
        if self.pfa > 0.0 && self.cells > 0.0 && self.found.max(self.cells * self.pfa) >= FEW {
            FalseAlarms { set: self.pfa as f32, measured: (self.found / self.cells) as f32 }
        } else {
            FalseAlarms::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 turns of `plots` false plots each in `cells` cells.
    fn after(plots: u32, cells: u64, pfa: f64) -> FalseAlarms {
        let (mut count, plot) = (FalseAlarmCount::default(), Measurement::at(1000.0, 1.0));
        for _ in 0..40 {
            count.test(&PlotsHeader { cells, pfa, cell_range_m: 10.0, ..PlotsHeader::default() }, 2);
            for _ in 0..plots {
                count.observe(&plot, 1.0);
            }
            count.end_turn();
        }
        count.rate()
    }

    #[test]
    fn a_rate_far_from_the_set_one_is_told_from_one_near_it_in_both_directions() {
        let (cells, pfa) = (1_000_000, 1e-5);
        for (plots, off) in [(10, false), (25, false), (5, false), (40, true), (2, true), (0, true)] {
            let rate = after(plots, cells, pfa);
            assert_eq!(rate.is_off(), off, "{plots} plots: {rate:?}");
            assert!((f64::from(rate.measured) / (f64::from(plots) * 1e-6) - 1.0).abs() < 1e-3 || plots == 0);
        }
    }

    #[test]
    fn nothing_is_said_of_few_or_of_an_unknown_threshold() {
        for (plots, cells, pfa) in [(0, 1_000, 1e-6), (10, 0, 1e-6), (10, 1_000_000, 0.0)] {
            assert_eq!(after(plots, cells, pfa), FalseAlarms::default());
        }
    }
}
