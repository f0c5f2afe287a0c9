//! Prints how many target reports of category 048 a second are read from a file of blocks, to SI units, on one core.
//!
//! ```text
//! cargo run --release -p asterix --example decode_speed -- FILE
//! ```

use std::error::Error;
use std::hint::black_box;
use std::io::Write;
use std::time::{Duration, Instant};

use asterix::block::Blocks;
use asterix::record::Records;
use asterix::report::Message;
use asterix::tables::CAT048_1_32;

/// Time over which records are counted.
const MEASURED: Duration = Duration::from_secs(2);

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("usage: decode_speed FILE")?;
    let bytes = std::fs::read(file)?;
    let (start, mut records) = (Instant::now(), 0_u64);
    while start.elapsed() < MEASURED {
        for block in Blocks::new(black_box(&bytes)) {
            let block = block?;
            for record in Records::new(CAT048_1_32, block.records, block.offset) {
                black_box(Message::of(&record?));
                records += 1;
            }
        }
    }
    writeln!(std::io::stdout(), "{}", records as f64 / start.elapsed().as_secs_f64())?;
    Ok(())
}
