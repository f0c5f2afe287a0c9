//! Tries the decoder on damaged records for as long as it may:
//!
//! ```text
//! cargo run --release -p asterix --example fuzz -- decode|round-trip|recording --seconds N [--seed N]
//! ```
//!
//! Inputs are random records of every edition, spoilt: bits changed, octets lost, put in, repeated, cut off, or taken from
//! another record. `decode` reads them as blocks and records and takes everything from them; `round-trip` also encodes what
//! was read and reads it again, which must give the same values; `recording` does the same with captures of a network.
//! A panic ends the program and names the seed of the input.

use std::error::Error;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use asterix::BlockWriter;
use asterix::block::Blocks;
use asterix::cat062::SystemTrack;
use asterix::cat065::SystemStatus;
use asterix::definition::Edition;
use asterix::editions::Editions;
use asterix::random;
use asterix::record::Records;
use asterix::recording::Recording;
use asterix::recovery::records;
use asterix::report::Message;
use asterix::tables::ALL;
use asterix::value::RecordValues;

/// The generator SplitMix64.
struct Draw(u64);

impl Draw {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let bits = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        ((u128::from(self.bits()) * limit as u128) >> 64) as usize
    }
}

/// Changes some octets.
fn spoil(bytes: &mut Vec<u8>, other: &[u8], draw: &mut Draw) {
    for _ in 0..=draw.below(4) {
        let at = draw.below(bytes.len().max(1));
        let Some(octet) = bytes.get_mut(at) else { return };
        match draw.below(8) {
            0 => *octet ^= 1 << draw.below(8),
            1 => *octet = draw.bits() as u8,
            2 => *octet = [0, 1, 0x7f, 0x80, 0xff][draw.below(5)],
            3 => drop(bytes.remove(at)),
            4 => bytes.insert(at, draw.bits() as u8),
            5 => bytes.truncate(at),
            6 => {
                let end = (at + 1 + draw.below(8)).min(bytes.len());
                let repeated = bytes[at..end].to_vec();
                bytes.splice(at..at, repeated);
            }
            _ => {
                let from = draw.below(other.len().max(1)).min(other.len());
                let to = (from + draw.below(12)).min(other.len());
                bytes.splice(at..at, other[from..to].iter().copied());
            }
        }
    }
}

fn decode(bytes: &[u8], edition: &'static Edition, editions: &Editions) {
    for record in Records::new(edition, bytes, 0).flatten() {
        let _ = (Message::of(&record), SystemTrack::read(&record), SystemStatus::read(&record));
        assert!(record.items().map(|found| found.bytes.len()).sum::<usize>() < record.bytes.len());
    }
    for block in Blocks::new(bytes).flatten() {
        let Some(edition) = editions.of(block.category) else { continue };
        let _ = Records::new(edition, block.records, block.offset).last();
    }
}

fn round_trip(bytes: &[u8], edition: &'static Edition) {
    for record in Records::new(edition, bytes, 0).flatten() {
        let values = RecordValues::of(&record);
        let mut octets = Vec::new();
        values.encode(&mut octets).expect("what was read can be written");
        let again = Records::new(edition, &octets, 0).next().expect("a record").expect("what was written can be read");
        assert_eq!((RecordValues::of(&again), again.bytes, &octets[..]), (values, record.bytes, record.bytes));
    }
}

fn recording(bytes: &[u8], editions: &Editions) {
    let recording = Recording::new(bytes, editions);
    let _ = recording.records(editions).count();
    let _ = records(editions, bytes, 0).count();
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mode = arguments.next().ok_or("usage: fuzz decode|round-trip|recording --seconds N [--seed N]")?;
    let (mut seconds, mut seed) = (10, 1_u64);
    while let (Some(name), Some(value)) = (arguments.next(), arguments.next()) {
        match name.as_str() {
            "--seconds" => seconds = value.parse()?,
            "--seed" => seed = value.parse()?,
            _ => return Err(format!("{name}: not known").into()),
        }
    }
    let editions = Editions::default();
    let capture = include_bytes!("../tests/data/cat034-cat048-doppler-60s.pcapng");
    let (begin, end) = (Instant::now(), Duration::from_secs(seconds));
    let mut executions = 0_u64;
    while begin.elapsed() < end {
        // One of these, spoilt in many ways, each from its own seed.
        let mut draw = Draw(seed.wrapping_add(executions));
        let edition = ALL[draw.below(ALL.len())];
        let (mut good, mut other) = (Vec::new(), Vec::new());
        for octets in [&mut good, &mut other] {
            random::record(edition, &mut || draw.bits()).encode(octets)?;
        }
        match mode.as_str() {
            "recording" => good = capture[..2000].to_vec(),
            "decode" if draw.below(2) == 0 => {
                let records = RecordValues::of(&Records::new(edition, &good, 0).next().ok_or("a record")??);
                good.clear();
                BlockWriter::new(edition, &mut good).values(&records)?;
            }
            _ => {}
        }
        for _ in 0..64 {
            let case = seed.wrapping_add(executions).wrapping_mul(0x2545_f491_4f6c_dd1d);
            let mut bytes = good.clone();
            spoil(&mut bytes, &other, &mut Draw(case));
            let ran = catch_unwind(AssertUnwindSafe(|| match mode.as_str() {
                "decode" => decode(&bytes, edition, &editions),
                "round-trip" => round_trip(&bytes, edition),
                _ => recording(&bytes, &editions),
            }));
            if ran.is_err() {
                return Err(format!("category {:03}, execution {executions}: {bytes:02x?}", edition.category).into());
            }
            executions += 1;
        }
    }
    writeln!(std::io::stdout(), "{mode}: {executions} executions in {seconds} s, no panic")?;
    Ok(())
}
