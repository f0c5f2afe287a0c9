//! What is read is accounted for to the byte: lost, added and foreign bytes, other sensors, files of other kinds.

mod synthetic;

use std::process::ExitCode;

use common::health::Reject;
use plot_source::Source;
use synthetic::{Recorder, block, chain, messages, open};

const TURNS: u32 = 10;
/// Plots of all turns.
const PLOTS: usize = 50;
/// Records of all turns.
const RECORDS: u64 = 60;
/// Size of a report's block, bytes.
const REPORT: u64 = 15;

fn source(bytes: &[u8]) -> Source {
    open(&chain(), bytes).expect("a recording")
}

fn refusal(bytes: &[u8]) -> String {
    open(&chain(), bytes).expect_err("must be refused").to_string()
}

fn is_sound(source: &Source) -> bool {
    source.exit_code() == ExitCode::SUCCESS
}

fn plots(source: Source) -> usize {
    messages(source).map(|(_, plots)| plots.len()).sum()
}

#[test]
fn a_whole_recording_needs_no_word() {
    let source = source(&Recorder::default().blocks(TURNS).concat());
    assert!(is_sound(&source) && source.notes().is_empty(), "{:?}", source.notes());
    assert_eq!((source.records(), plots(source)), (RECORDS, PLOTS));
}

#[test]
fn a_lost_byte_costs_its_block_alone() {
    let blocks = Recorder::default().blocks(TURNS);
    for place in 0..REPORT as usize {
        let mut damaged = blocks.clone();
        damaged[27].remove(place);
        let source = source(&damaged.concat());
        assert!(!is_sound(&source), "byte {place}");
        assert_eq!(source.rejected().of(Reject::UnreadByte), REPORT - 1, "byte {place}");
        assert_eq!((source.records(), plots(source)), (RECORDS - 1, PLOTS - 1), "byte {place}");
    }
}

#[test]
fn padding_costs_no_block() {
    for padding in [&[0_u8; 5][..], &[0xff, 0xff], b"-- next block --"] {
        let padded: Vec<Vec<u8>> =
            Recorder::default().blocks(TURNS).iter().map(|block| [block, padding].concat()).collect();
        let source = source(&padded.concat());
        assert!(!is_sound(&source));
        assert_eq!(source.rejected().of(Reject::UnreadByte), RECORDS * padding.len() as u64);
        assert!(source.notes()[0].contains("bytes could not be read, in 60 places"), "{:?}", source.notes());
        assert_eq!((source.records(), plots(source)), (RECORDS, PLOTS));
    }
}

#[test]
fn an_unknown_item_costs_the_rest_of_its_block() {
    let mut blocks = Recorder::default().blocks(TURNS);
    blocks[20] = block(10, &[&blocks[20][3..], &[0x01, 0x01, 0x01, 0x08, 0x00], &blocks[21][3..]].concat());
    let source = source(&blocks.concat());
    assert_eq!(
        (source.rejected().of(Reject::UnknownItem), source.rejected().of(Reject::UnreadByte)),
        (1, 5 + REPORT - 3)
    );
    assert_eq!((source.records(), is_sound(&source)), (RECORDS, false));
}

#[test]
fn other_categories_are_named_and_do_no_harm() {
    let foreign = block(62, &[0xf0, 1, 2, 3, 4, 5]);
    let mixed: Vec<Vec<u8>> =
        Recorder::default().blocks(TURNS).into_iter().flat_map(|own| [own, foreign.clone()]).collect();
    let source = source(&mixed.concat());
    assert!(
        is_sound(&source) && source.notes() == ["radar.ast: category 062: 60 blocks not read"],
        "{:?}",
        source.notes()
    );
    assert_eq!(plots(source), PLOTS);
    let text = refusal(&[foreign, block(21, &[0xe0, 1, 2, 3])].concat());
    assert_eq!(
        text,
        "radar.ast is not an ASTERIX recording with category 001, 010 or 048: \
         categories 021 and 062 found, 001, 002, 010, 034 and 048 supported"
    );
}

#[test]
fn the_sensor_of_the_site_is_taken_and_others_are_counted() {
    let own = Recorder::default().blocks(TURNS);
    let other = Recorder { source: [3, 9], turn_s: &|_| 1.7, ..Recorder::default() }.blocks(TURNS);
    let both: Vec<u8> = own.iter().zip(&other).flat_map(|(own, other)| [&own[..], other].concat()).collect();
    let found = source(&both);
    assert_eq!(found.notes(), ["radar.ast: SAC 3 SIC 9: 60 records foreign, not used"]);
    assert_eq!((found.rejected().of(Reject::ForeignSource), is_sound(&found), plots(found)), (60, true, PLOTS));

    let mut chain = chain();
    let which = "radar.ast holds records of SAC 0 SIC 7 (60 records), SAC 3 SIC 9 (60 records): expected those of one sensor, named by keys `site.sac` and `site.sic`";
    (chain.site.sac, chain.site.sic) = (None, None);
    assert_eq!(open(&chain, &both).expect_err("two may be meant").to_string(), which);
    chain.site.sic = Some(8);
    assert_eq!(open(&chain, &both).expect_err("none is meant").to_string(), which);
    chain.site.sic = Some(9); // enough to tell
    let found = open(&chain, &both).expect("the other");
    assert!(
        messages(found)
            .all(|(header, plots)| { header.source_id == 0x0309 && plots.iter().all(|plot| plot.source_id == 0x0309) })
    );
    chain.site.sic = None;
    let found = open(&chain, &own.concat()).expect("only one can be meant");
    assert!(found.notes()[0].starts_with("radar.ast: taken for the site's: SAC 0 SIC 7"), "{:?}", found.notes());
}

#[test]
fn files_of_other_kinds_are_called_by_their_name() {
    let said = |bytes: &[u8], text: &str| assert!(refusal(bytes).ends_with(text), "{}", refusal(bytes));
    said(&[0x1f, 0x8b, 8, 0, 0], "category 001, 010 or 048: it is compressed by gzip");
    said(b"time_s,range,azimuth\n", "category 001, 010 or 048: it is a table (CSV)");
    let empty = refusal(b"time_s,range_m,azimuth_deg\n");
    assert!(empty.starts_with("radar.ast is a table of plots without a plot: it ends after its header; "), "{empty}");
    let wrong = refusal(b"time_s,range_m,azimuth\n1,1000,90\n");
    assert!(wrong.contains("without a plot: line 2: missing field `azimuth_deg`; expected columns time_s,"), "{wrong}");
    assert!(refusal(b"{\"topic\":\"plots\"}\n").contains("it is JSON lines"));
    let mut chain = chain();
    chain.plot_source.file = "udp://239.1.1.1:8600".into();
    let text = Source::open(&chain).expect_err("no file").to_string();
    assert!(
        text.starts_with("key `plot_source.file` is `udp://239.1.1.1:8600`, expected the name of a file"),
        "{text}"
    );
}

/// The multilateration of an airport tells places in x and y: of it as a radar nothing is left.
#[test]
fn a_recording_without_one_plot_is_not_sound() {
    let mut chain = chain();
    chain.site.sic = None;
    let source = open(&chain, include_bytes!("data/lebl-mlat-30s.ast")).expect("it has cycles");
    assert!(!is_sound(&source));
    assert!(source.notes().iter().any(|note| note.contains("not one plot; ")), "{:?}", source.notes());
}

/// A flipped bit in the identification of one record is no second radar; a few percent of the records are one.
#[test]
fn a_record_of_a_damaged_sensor_is_counted() {
    let mut chain = chain();
    (chain.site.sac, chain.site.sic) = (None, None);
    for (place, flipped) in [(4, 0x10), (5, 0x01), (4, 0x80)] {
        let mut own = Recorder::default().blocks(TURNS);
        own[17][place] ^= flipped;
        let found = open(&chain, &own.concat()).expect("one radar and a stray record");
        assert_eq!(found.rejected().of(Reject::ForeignSource), 1);
        assert!(
            found.notes().iter().any(|note| note.ends_with(": 1 records foreign, not used")),
            "{:?}",
            found.notes()
        );
        assert!(messages(found).all(|(header, _)| header.source_id == 0x0007));
        own[10..20].iter_mut().for_each(|block| block[place] = flipped);
        let refused = open(&chain, &own.concat()).expect_err("two may be meant").to_string();
        assert!(refused.contains("expected those of one sensor"), "{refused}");
    }
}
