//! Category 240, edition 1.3: video messages of a radar.

use std::f64::consts::TAU;

use crate::field::Field;
use crate::record::Record;
use crate::report::{SourceId, TimeOfDay};
use crate::tables::CAT240_1_3;

/// The category.
pub const CATEGORY: u8 = CAT240_1_3.category;

const SAC: Field = field!(CAT240_1_3, "010/SAC");
const SIC: Field = field!(CAT240_1_3, "010/SIC");
const MESSAGE_TYPE: Field = field!(CAT240_1_3, "000");
const TIME_OF_DAY: Field = field!(CAT240_1_3, "140");
const COMPRESSION: Field = field!(CAT240_1_3, "048/C");
const RESOLUTION: Field = field!(CAT240_1_3, "048/RES");
const VALID_OCTETS: Field = field!(CAT240_1_3, "049/NBVB");
const VALID_CELLS: Field = field!(CAT240_1_3, "049/NBCELLS");
const VIDEO_MESSAGE: u64 = 2;

/// Start and end azimuth, first cell and duration of a cell, and what is a second in the unit of the duration.
struct Header {
    start: Field,
    end: Field,
    first_cell: Field,
    duration: Field,
    per_second: f64,
}

const HEADERS: [Header; 2] = [
    Header {
        start: field!(CAT240_1_3, "040/STARTAZ"),
        end: field!(CAT240_1_3, "040/ENDAZ"),
        first_cell: field!(CAT240_1_3, "040/STARTRG"),
        duration: field!(CAT240_1_3, "040/CELLDUR"),
        per_second: 1e9,
    },
    Header {
        start: field!(CAT240_1_3, "041/STARTAZ"),
        end: field!(CAT240_1_3, "041/ENDAZ"),
        first_cell: field!(CAT240_1_3, "041/STARTRG"),
        duration: field!(CAT240_1_3, "041/CELLDUR"),
        per_second: 1e15,
    },
];

/// The items with cells and the octets that each of their repetitions has.
const BLOCKS: [(&str, usize); 3] = [("050", 4), ("051", 64), ("052", 256)];

/// A video message: the cells of one azimuth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VideoRecord<'a> {
    /// The sensor.
    pub source: Option<SourceId>,
    /// When, if it says so.
    pub time_of_day: Option<TimeOfDay>,
    /// Middle of start and end azimuth, rad, in [0, 2π).
    pub azimuth_rad: f64,
    /// End minus start azimuth, rad, in [0, 2π).
    pub width_rad: f64,
    /// Cells between the radar and the first one.
    pub first_cell: u32,
    /// Duration of a cell, s: the way there and back.
    pub cell_s: f64,
    /// Size of a cell's code: 1, 2, 4, 8, 16 or 32 bits.
    pub bits: u8,
    /// Whether the octets are compressed, by zlib.
    pub is_compressed: bool,
    /// Cells.
    pub cells: u32,
    /// The octets that are valid.
    pub octets: &'a [u8],
}

impl<'a> VideoRecord<'a> {
    /// The video message that a record is; none if it is another message, or lacks what a video message must have.
    pub fn read(record: &Record<'a>) -> Option<Self> {
        if record.edition.category != CATEGORY || MESSAGE_TYPE.raw(record) != Some(VIDEO_MESSAGE) {
            return None;
        }
        let header = HEADERS.iter().find(|header| header.duration.raw(record).is_some())?;
        let start_rad = header.start.value(record)?.to_radians();
        let width_rad = (header.end.value(record)?.to_radians() - start_rad).rem_euclid(TAU);
        let cell_s = header.duration.raw(record)? as f64 / header.per_second;
        let bits = match RESOLUTION.raw(record)? {
            code @ 1..=6 => 1 << (code - 1),
            _ => return None,
        };
        let valid = usize::try_from(VALID_OCTETS.raw(record)?).ok()?;
        let octets = BLOCKS.into_iter().find_map(|(name, size)| {
            let (&count, octets) = record.item(name)?.bytes.split_first()?;
            octets.get(..(usize::from(count) * size).min(octets.len()))
        })?;
        (cell_s > 0.0).then_some(())?;
        Some(Self {
            source: SourceId::read(record, &SAC, &SIC),
            time_of_day: TimeOfDay::read(record, &TIME_OF_DAY),
            azimuth_rad: (start_rad + width_rad / 2.0) % TAU,
            width_rad,
            first_cell: u32::try_from(header.first_cell.raw(record)?).ok()?,
            cell_s,
            bits,
            is_compressed: COMPRESSION.raw(record) == Some(1),
            cells: u32::try_from(VALID_CELLS.raw(record)?).ok()?,
            octets: octets.get(..valid)?,
        })
    }
}
