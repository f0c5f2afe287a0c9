//! Writes random records of every edition, one file for each, to try other decoders with:
//!
//! ```text
//! cargo run --release -p asterix --example random_records -- FOLDER COUNT
//! ```

use std::error::Error;
use std::fs;
use std::path::Path;

use asterix::tables::ALL;
use asterix::{BlockWriter, random};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, count] = arguments.as_slice() else { return Err("usage: random_records FOLDER COUNT".into()) };
    let count: u32 = count.parse()?;
    for edition in ALL {
        let mut state = u64::from(edition.category);
        // The generator SplitMix64.
        let mut draw = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let bits = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            bits ^ (bits >> 31)
        };
        let mut octets = Vec::new();
        for _ in 0..count {
            BlockWriter::new(edition, &mut octets).values(&random::record(edition, &mut draw))?;
        }
        let name = format!("cat{:03}-{}.ast", edition.category, edition.number);
        fs::write(Path::new(folder).join(name), octets)?;
    }
    Ok(())
}
