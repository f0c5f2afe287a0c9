//! Records of every edition: back to the same bytes, cut at every byte, and any bytes at all.

use asterix::block::{Blocks, HEADER};
use asterix::editions::Editions;
use asterix::record::Records;
use asterix::recovery::Pieces;
use asterix::tables::{ALL, CAT034_1_29, CAT048_1_32, CAT062_1_21};
use asterix::value::{RecordValues, Value};
use asterix::{BlockWriter, Fault, Field, field, random};
use proptest::prelude::*;

/// The generator SplitMix64.
fn generator(mut state: u64) -> impl FnMut() -> u64 {
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }
}

proptest! {
    /// Values to bytes to values to bytes: both pairs are the same.
    #[test]
    fn random_records_come_back(seed: u64, which in 0..ALL.len()) {
        let mut draw = generator(seed);
        let records: Vec<RecordValues> = (0..4).map(|_| random::record(ALL[which], &mut draw)).collect();
        let mut bytes = Vec::new();
        for record in &records {
            record.encode(&mut bytes).expect("it can be encoded");
        }
        let mut again = Vec::new();
        let mut read = Vec::new();
        for record in Records::new(ALL[which], &bytes, 0) {
            let values = RecordValues::of(&record.expect("it can be decoded"));
            let json: serde_json::Value = serde_json::from_str(&values.to_string()).expect("JSON");
            prop_assert_eq!(json.as_object().map(serde_json::Map::len), Some(values.items.len()));
            values.encode(&mut again).expect("it can be encoded");
            read.push(values);
        }
        prop_assert_eq!(&read, &records);
        prop_assert_eq!(again, bytes);
    }

    /// Wherever a block is cut, the records before the cut are read and the cut is named.
    #[test]
    fn every_cut_is_named(seed: u64, which in 0..ALL.len()) {
        let mut draw = generator(seed);
        let mut bytes = Vec::new();
        let mut ends = vec![0];
        for _ in 0..3 {
            random::record(ALL[which], &mut draw).encode(&mut bytes).expect("it can be encoded");
            ends.push(bytes.len());
        }
        for cut in 0..bytes.len() {
            let whole = ends.iter().filter(|&&end| end <= cut).count() - 1;
            let mut records = Records::new(ALL[which], &bytes[..cut], 100);
            let read = records.by_ref().flatten().count();
            prop_assert_eq!(read, whole);
            prop_assert_eq!(records.left(), cut - ends[whole]);
            let error = Records::new(ALL[which], &bytes[..cut], 100).find_map(Result::err);
            prop_assert_eq!(error.is_none(), cut == ends[whole]);
            if let Some(error) = error {
                prop_assert!(matches!(error.fault, Fault::Truncated { .. }), "{error}");
                prop_assert!((100 + ends[whole]..=100 + cut).contains(&error.offset) && error.record == whole + 1);
            }
        }
    }

    /// No bytes make it panic, and every byte is in a block or known as lost.
    #[test]
    fn any_bytes_can_be_read(bytes in prop::collection::vec(prop_oneof![any::<u8>(), Just(48), Just(0), Just(255)], 0..300)) {
        let editions = Editions::default();
        for edition in ALL {
            for record in Records::new(edition, &bytes, 0).flatten() {
                let values = RecordValues::of(&record);
                let mut again = Vec::new();
                values.encode(&mut again).expect("what was read can be written");
                prop_assert!(again == record.bytes);
                let read = Records::new(edition, &again, 0).next().expect("one record").expect("it can be read");
                prop_assert_eq!(RecordValues::of(&read), values);
            }
        }
        for block in Blocks::new(&bytes).flatten() {
            prop_assert!(block.offset >= HEADER);
        }
        prop_assert!(Pieces::new(&editions, &bytes).count() <= bytes.len());
    }
}

/// Fields of one edition, written into and read from records of another one: values or errors, never a panic.
#[test]
fn fields_of_another_edition_are_values_or_errors() {
    const FIELDS: [Field; 6] = [
        field!(CAT062_1_21, "380/ADR"),
        field!(CAT062_1_21, "340/SID/SAC"),
        field!(CAT062_1_21, "500/APC/X"),
        field!(CAT048_1_32, "020/TYP"),
        field!(CAT034_1_29, "050/COM/NOGO"),
        field!(CAT034_1_29, "030"),
    ];
    let mut octets = Vec::new();
    for edition in ALL {
        for first in &FIELDS {
            for second in &FIELDS {
                let mut block = BlockWriter::new(edition, &mut octets);
                let _ = block.record(|record| {
                    record.put_raw(first, 1)?;
                    record.put_raw(second, 1)
                });
            }
        }
    }
    for block in Blocks::new(&octets).map_while(Result::ok) {
        for edition in ALL {
            for record in Records::new(edition, block.records, 0).map_while(Result::ok) {
                assert!(FIELDS.iter().all(|field| field.value(&record).is_none_or(f64::is_finite)));
                assert!([63, 64, 1 << 32, usize::MAX].iter().all(|&position| record.octets(position).is_none()));
            }
        }
    }
}

/// Values that no record holds are refused, however large the positions.
#[test]
fn values_of_no_record_are_refused() {
    let profile = &CAT048_1_32.profiles[0];
    let of = |fspec_octets: usize, items: Vec<(usize, Value)>| {
        let values = RecordValues { edition: CAT048_1_32, profile, fspec_octets, items };
        values.encode(&mut Vec::new())
    };
    assert!(of(usize::MAX, Vec::new()).is_err());
    assert!(of(1, vec![(usize::MAX, Value::Element(0))]).is_err());
    assert!(of(1, vec![(27, Value::Sequence(vec![(usize::MAX, Value::Element(0))]))]).is_err());
}
