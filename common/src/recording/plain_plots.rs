//! Plots by hand: JSON lines with as little as time, range, azimuth and their errors.
//!
//! ```text
//! {"topic":"plots","elements":[
//!   {"time_ns":1714867200500000000,"range_m":1234.5,"azimuth_rad":0.79,"sigma_range_m":5,"sigma_azimuth_rad":0.002}]}
//! ```
//!
//! A line is a scan of the radar, on one line of the file; one without plots has no elements. Of a plot all else may be
//! left out or `null`, which is: not measured. Any field of the header may be given; without it
//!
//! | field | is |
//! |---|---|
//! | `scan`, `seq` | that of the line before and one more; `seq` follows from scan and sector |
//! | `sectors_per_scan`, `sector` | 1 and 0: the line is a whole scan |
//! | `covered_from_rad`, `covered_to_rad` | the sector |
//! | `time_ns` | that of the latest plot; without plots a sector after the line before |
//! | `scan_period_s` | from the time since the line before; 1 s for the first, and as before after a pause |
//! | `cell_range_m`, … | √12 times the largest error of the first plots: errors are uniform in a cell |
//! | all others | 0: not known |

use std::f64::consts::TAU;

use serde::de::value::MapDeserializer;
use serde::de::{DeserializeOwned, IntoDeserializer, Visitor};
use serde::{Deserializer, Serialize, forward_to_deserialize_any};
use serde_json::{Map, Value};

use crate::plots::{HAS_ELEVATION, HAS_RANGE_RATE, HAS_STATISTIC, Plot, PlotsHeader};
use crate::units::{NS_PER_S, seconds_between};

/// A scan this many times longer than the one before is a pause.
const LONGEST_SCAN: f64 = 3.0;
/// No scan is longer, s.
const LONGEST_S: f64 = 1e4;
/// What is said of the first scan, s.
const FIRST_SCAN_S: f64 = 1.0;
/// Fields without which a plot is none.
const REQUIRED: [&str; 5] = ["time_ns", "range_m", "azimuth_rad", "sigma_range_m", "sigma_azimuth_rad"];

/// Completes lines, each from those before it.
#[derive(Debug, Default)]
pub(super) struct PlainPlots {
    last: Option<PlotsHeader>,
    /// Time of a scan, s, once it is known.
    scan_period_s: Option<f64>,
}

impl PlainPlots {
    /// A line from the JSON of its header, if it has one, and of its elements.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn complete(
        &mut self,
        header: Option<&str>,
        elements: &str,
    ) -> Result<(PlotsHeader, Vec<Plot>), String> {
        let elements: Vec<Map<String, Value>> =
            serde_json::from_str(elements).map_err(|error| format!("elements: {error}"))?;
        let plots = elements.into_iter().map(plot).collect::<Result<Vec<_>, _>>();
        let plots = plots.map_err(|error| format!("elements: {error}"))?;
        let given: Map<String, Value> =
            serde_json::from_str(header.unwrap_or("{}")).map_err(|error| format!("header: {error}"))?;
        let is_given = |name: &str| given.contains_key(name);
        let mut header: PlotsHeader = completed(&given).map_err(|error| format!("header: {error}"))?;
        if !is_given("sectors_per_scan") {
            header.sectors_per_scan = 1;
        }
        if !is_given("scan") {
            header.scan = self.last.map_or(0, |last| last.scan + u32::from(header.sector <= last.sector));
        }
        if !is_given("seq") {
            header.seq = u64::from(header.scan) * u64::from(header.sectors_per_scan) + u64::from(header.sector);
        }
        let edge = |sector: u32| TAU * f64::from(sector) / f64::from(header.sectors_per_scan);
        let (from_rad, to_rad) = (edge(header.sector), edge(header.sector + 1));
        if !is_given("covered_from_rad") {
            header.covered_from_rad = from_rad;
        }
        if !is_given("covered_to_rad") {
            header.covered_to_rad = to_rad;
        }
        self.time(&mut header, &plots, is_given)?;
        self.cells(&mut header, &plots, is_given);
        self.last = Some(header);
        Ok((header, plots))
    }

    fn time(
        &mut self,
        header: &mut PlotsHeader,
        plots: &[Plot],
        is_given: impl Fn(&str) -> bool,
    ) -> Result<(), String> {
        let sectors = f64::from(header.sectors_per_scan);
        let known_s = self.scan_period_s.unwrap_or(FIRST_SCAN_S);
        if !is_given("time_ns") {
            let next_ns = self.last.map(|last| last.time_ns + (known_s * NS_PER_S / sectors) as u64);
            let latest_ns = plots.iter().map(|plot| plot.time_ns).max();
            header.time_ns = latest_ns.or(next_ns).ok_or("header: missing field `time_ns` before the first plot")?;
        }
        if is_given("scan_period_s") {
            self.scan_period_s = Some(header.scan_period_s);
            return Ok(());
        }
        if let Some(last) = self.last {
            let scan_s = seconds_between(last.time_ns, header.time_ns) * sectors;
            let longest_s = self.scan_period_s.map_or(LONGEST_S, |known_s| LONGEST_SCAN * known_s);
            if scan_s > 0.0 && scan_s < longest_s {
                self.scan_period_s = Some(scan_s);
            }
        }
        header.scan_period_s = self.scan_period_s.unwrap_or(FIRST_SCAN_S);
        Ok(())
    }

    fn cells(&self, header: &mut PlotsHeader, plots: &[Plot], is_given: impl Fn(&str) -> bool) {
        let last = self.last.filter(|last| last.cell_azimuth_rad < TAU).unwrap_or_default();
        let from = |flags: u32, error: fn(&Plot) -> f32| {
            let errors = plots.iter().filter(|plot| plot.has(flags)).map(|plot| f64::from(error(plot)));
            errors.fold(0.0, f64::max) * 12.0_f64.sqrt()
        };
        let is_first = last.cell_range_m <= 0.0;
        let fill = |name: &str, cell: &mut f64, last: f64, of_plots: f64, without: f64| {
            if !is_given(name) {
                *cell = if !is_first {
                    last
                } else if of_plots > 0.0 {
                    of_plots
                } else {
                    without
                };
            }
        };
        // Before the first plots, cells that any radar has: the largest.
        fill("cell_range_m", &mut header.cell_range_m, last.cell_range_m, from(0, |plot| plot.sigma_range_m), 1e3);
        let azimuth_rad = from(0, |plot| plot.sigma_azimuth_rad);
        fill("cell_azimuth_rad", &mut header.cell_azimuth_rad, last.cell_azimuth_rad, azimuth_rad, TAU);
        let elevation_rad = from(HAS_ELEVATION, |plot| plot.sigma_elevation_rad);
        fill("cell_elevation_rad", &mut header.cell_elevation_rad, last.cell_elevation_rad, elevation_rad, 0.0);
        let rate_mps = from(HAS_RANGE_RATE, |plot| plot.sigma_range_rate_mps);
        fill("cell_range_rate_mps", &mut header.cell_range_rate_mps, last.cell_range_rate_mps, rate_mps, 0.0);
    }
}

/// A plot from the fields that are given.
fn plot(mut given: Map<String, Value>) -> Result<Plot, String> {
    let says_what_is_measured = given.contains_key("flags");
    given.retain(|_, value| says_what_is_measured || !value.is_null());
    let missing = REQUIRED.into_iter().find(|&name| !given.contains_key(name));
    if let Some(name) = missing {
        return Err(format!("missing field `{name}`, a plot has at least {}", REQUIRED.join(", ")));
    }
    let mut plot: Plot = completed(&given)?;
    if !says_what_is_measured {
        for (name, error, flag) in [
            ("elevation_rad", Some("sigma_elevation_rad"), HAS_ELEVATION),
            ("range_rate_mps", Some("sigma_range_rate_mps"), HAS_RANGE_RATE),
            ("statistic", None, HAS_STATISTIC),
        ] {
            if !given.contains_key(name) {
                continue;
            }
            if let Some(error) = error.filter(|&error| !given.contains_key(error)) {
                return Err(format!("missing field `{error}` beside `{name}`"));
            }
            plot.flags |= flag;
        }
    }
    Ok(plot)
}

/// `T` with the given fields, and its defaults for the others.
fn completed<T: Default + Serialize + DeserializeOwned>(given: &Map<String, Value>) -> Result<T, String> {
    let Ok(Value::Object(mut all)) = serde_json::to_value(T::default()) else { return Ok(T::default()) };
    for (name, value) in given {
        let Some(place) = all.get_mut(name) else {
            let names: Vec<&str> = all.keys().map(String::as_str).collect();
            return Err(format!("unknown field `{name}`, expected one of {}", names.join(", ")));
        };
        *place = value.clone();
    }
    let fields = MapDeserializer::new(all.into_iter().map(|(name, value)| (name, OrNull(value))));
    T::deserialize(fields).map_err(|error: serde_json::Error| error.to_string())
}

/// A value of which `null` stands for a number that is not known, NaN: so it is written.
struct OrNull(Value);

impl<'de> Deserializer<'de> for OrNull {
    type Error = serde_json::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        self.0.deserialize_any(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        if self.0.is_null() { visitor.visit_f64(f64::NAN) } else { self.0.deserialize_f64(visitor) }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        self.deserialize_f64(visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl IntoDeserializer<'_, serde_json::Error> for OrNull {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::jsonl::{Reader, Writer};
    use crate::recording::{Recorded, RecordedRef};

    fn read(text: &str) -> Vec<(PlotsHeader, Vec<Plot>)> {
        let plots = Reader::new(text.as_bytes()).map(|line| match line.expect(text) {
            Recorded::Plots(header, plots) => (header, plots),
            other => panic!("{other:?}"),
        });
        plots.collect()
    }

    fn refused(line: &str) -> String {
        Reader::new(line.as_bytes()).next().expect("a line").expect_err(line).to_string()
    }

    fn plot_line(time_s: u64, more: &str) -> String {
        format!(
            "{{\"topic\":\"plots\",\"elements\":[{{\"time_ns\":{time_s}000000000,\"range_m\":1200,\"azimuth_rad\":0.5,\
             \"sigma_range_m\":5,\"sigma_azimuth_rad\":0.25{more}}}]}}\n"
        )
    }

    #[test]
    fn time_range_azimuth_and_errors_are_enough() {
        let lines = [100, 104, 108].map(|time_s| plot_line(time_s, "")).concat();
        let empty = "{\"topic\":\"plots\",\"elements\":[]}\n";
        let messages = read(&[&lines, empty].concat());
        for ((header, plots), scan) in messages.iter().zip(0_u32..) {
            assert_eq!((header.scan, header.seq, header.sectors_per_scan), (scan, scan.into(), 1));
            assert_eq!((header.covered_from_rad, header.covered_to_rad), (0.0, TAU));
            assert_eq!(header.time_ns, 100_000_000_000 + u64::from(scan) * 4_000_000_000);
            assert!((header.scan_period_s - if scan == 0 { 1.0 } else { 4.0 }).abs() < 1e-9);
            assert!((header.cell_range_m - 300_f64.sqrt()).abs() < 1e-9 && header.cell_elevation_rad == 0.0);
            assert!(plots.iter().all(|plot| plot.flags == 0 && plot.range_m > 1199.0));
        }
        assert_eq!(messages.len(), 4);
    }

    #[test]
    fn what_is_given_counts_and_null_is_not_measured() {
        let measured = read(&plot_line(
            1,
            ",\"elevation_rad\":0.1,\"sigma_elevation_rad\":0.01,\"statistic\":4,\"range_rate_mps\":null",
        ));
        let plot = measured[0].1[0];
        assert_eq!((plot.flags, plot.elevation_rad), (HAS_ELEVATION | HAS_STATISTIC, 0.1));
        assert!(measured[0].0.cell_elevation_rad > 0.0);
        let null = read(&plot_line(1, ",\"elevation_rad\":null"));
        assert_eq!((null[0].1[0].flags, null[0].0.cell_elevation_rad), (0, 0.0));
        let header = "\"header\":{\"scan_period_s\":2.5,\"sectors_per_scan\":4,\"sector\":1,\"pfa\":1e-6},\"elements\"";
        let given = read(&plot_line(1, "").replace("\"elements\"", header));
        let (found, _) = given[0];
        assert_eq!((found.scan_period_s, found.sector, found.seq, found.pfa), (2.5, 1, 1, 1e-6));
        assert_eq!((found.covered_from_rad, found.covered_to_rad), (TAU / 4.0, TAU / 2.0));
    }

    /// What is written is read: numbers that are not finite are `null`, and not a number when they come back.
    #[test]
    fn numbers_that_are_not_known_are_null_both_ways() {
        let plot =
            Plot { range_m: f64::NAN, sigma_azimuth_rad: f32::INFINITY, flags: HAS_ELEVATION, ..Plot::default() };
        let header = PlotsHeader { scan: 3, seq: 3, sectors_per_scan: 1, pfa: f64::NAN, ..PlotsHeader::default() };
        let mut written = Vec::new();
        let mut writer = Writer::new(&mut written);
        writer.write(RecordedRef::Plots(&header, &[plot])).expect("memory");
        writer.finish().expect("memory");
        let text = String::from_utf8(written).expect("text");
        assert!(text.contains("\"range_m\":null") && text.contains("\"pfa\":null"), "{text}");
        let (found_header, found) = read(&text).remove(0);
        assert!(found_header.pfa.is_nan() && found[0].range_m.is_nan() && found[0].sigma_azimuth_rad.is_nan());
        assert_eq!((found_header.scan, found[0].flags), (3, HAS_ELEVATION));
    }

    #[test]
    fn what_is_missing_or_unknown_is_named() {
        let line = plot_line(1, "");
        let without = line.replace("\"sigma_range_m\":5,", "");
        assert_eq!(
            refused(&without),
            "line 1: elements: missing field `sigma_range_m`, a plot has at least time_ns, range_m, azimuth_rad, sigma_range_m, sigma_azimuth_rad"
        );
        assert!(
            refused(&plot_line(1, ",\"elevation_rad\":0.1"))
                .ends_with("missing field `sigma_elevation_rad` beside `elevation_rad`")
        );
        assert!(refused(&plot_line(1, ",\"heigth_m\":1")).contains("unknown field `heigth_m`, expected one of"));
        assert!(
            refused("{\"topic\":\"plots\",\"elements\":[]}").ends_with("missing field `time_ns` before the first plot")
        );
        assert!(refused(&line.replace("plots\",", "tracks\",")).contains("missing field `header`"));
    }
}
