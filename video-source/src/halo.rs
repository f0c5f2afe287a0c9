//! Spokes of a Navico HALO radar, as it sends them to multicast groups on a ship's network.
//!
//! The form is not published; what follows is what public programs that show such radars read from it, and was checked against AIS
//! positions of ships (`tests/halo.rs`). All numbers are little-endian.
//!
//! | octets | what |
//! |---|---|
//! | 8 | header of the datagram; at 5 the number of spokes |
//! | 24 + 512 for each spoke | its header, and 1024 cells of 4 bits, the near one in the lower half of an octet |
//!
//! | octet of a spoke's header | what |
//! |---|---|
//! | 0 | its length, 24 |
//! | 1 | 0x02, or 0x12 |
//! | 6, 7 and 12, 13 | range scale: R = large · small/512 m; small/4 m where large is 0x80 |
//! | 8, 9 | angle from the bow, 4096 steps to a turn |
//! | 10, 11 | heading in the same steps in the lower 12 bits; bit 14 says that it is true |
//!
//! Codes 14 and 15 mark cells that approach or recede where the radar has been told to show Doppler, and 13 is the strongest amplitude
//! beside them. As the spoke does not say which, all three count as 13: amplitudes end at 13½ steps, 29 dB above those of code 0.

use std::f64::consts::TAU;

use crate::cells::Packing;
use crate::spoke::Spoke;

const HEADER: usize = 8;
const SPOKE_HEADER: usize = 24;
const OCTETS: usize = 512;
const STEPS_PER_TURN: f64 = 4096.0;
const TRUE_HEADING: u16 = 0x4000;
const NO_NUMBER: u16 = 0xffff;
const SHORT_RANGE: u16 = 0x80;

/// Cells of a spoke.
pub const CELLS: usize = 1024;
const PACKING: Packing = Packing { bits: 4, lowest_first: true, most: 13 };

/// The spokes of a datagram, none in place of one without range or true heading; or nothing if the datagram has another form.
pub fn spokes(datagram: &[u8], time_ns: Option<u64>) -> Option<impl Iterator<Item = Option<Spoke>>> {
    let count = usize::from(*datagram.get(5)?);
    let spokes = datagram.get(HEADER..)?;
    let is_one = |spoke: &[u8]| spoke[0] == SPOKE_HEADER as u8 && matches!(spoke[1], 0x02 | 0x12);
    let has_form = count > 0
        && spokes.len() == count * (SPOKE_HEADER + OCTETS)
        && spokes.chunks_exact(SPOKE_HEADER + OCTETS).all(is_one);
    has_form.then(|| {
        let spokes = spokes.chunks_exact(SPOKE_HEADER + OCTETS).enumerate();
        spokes.map(move |(index, spoke)| read(spoke, time_ns, (count - 1 - index) as u32))
    })
}

fn read(spoke: &[u8], time_ns: Option<u64>, followers: u32) -> Option<Spoke> {
    let word = |at: usize| u16::from_le_bytes([spoke[at], spoke[at + 1]]);
    let (large, angle, heading, small) = (word(6), word(8), word(10), word(12));
    let scale_m = match (large, small) {
        (_, NO_NUMBER) => return None,
        (SHORT_RANGE, small) => f64::from(small) / 4.0,
        (large, small) => f64::from(large) * f64::from(small) / 512.0,
    };
    if heading == NO_NUMBER || heading & TRUE_HEADING == 0 || scale_m <= 0.0 {
        return None;
    }
    let steps = f64::from(angle % 4096) + f64::from(heading % 4096);
    let range_step_m = scale_m / CELLS as f64;
    Some(Spoke {
        time_ns,
        followers,
        source_id: 0,
        azimuth_rad: steps / STEPS_PER_TURN * TAU % TAU,
        range_first_m: range_step_m / 2.0,
        range_step_m,
        cells: CELLS,
        packing: PACKING,
        octets: spoke[SPOKE_HEADER..].into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn datagram(heading: u16) -> Vec<u8> {
        let mut bytes = vec![1, 0, 0, 0, 0, 2, 0, 2];
        for angle in [4090_u16, 4092] {
            let mut header = [0_u8; SPOKE_HEADER];
            (header[0], header[1]) = (24, 2);
            for (at, word) in [(6, 25_600_u16), (8, angle), (10, heading), (12, 512)] {
                header[at..at + 2].copy_from_slice(&word.to_le_bytes());
            }
            bytes.extend(header);
            bytes.extend([0x21; OCTETS]);
        }
        bytes
    }

    #[test]
    fn spokes_have_their_azimuth_range_and_cells() {
        let bytes = datagram(TRUE_HEADING | 1024);
        let found: Vec<Spoke> = spokes(&bytes, Some(7)).expect("spokes").flatten().collect();
        assert_eq!(found.len(), 2);
        assert!((found[0].azimuth_rad - 1018.0 / 4096.0 * TAU).abs() < 1e-12, "past north");
        assert_eq!((found[0].followers, found[1].followers, found[1].time_ns), (1, 0, Some(7)));
        assert_eq!((found[0].range_step_m, found[0].range_first_m), (25.0, 12.5));
        let mut cells = vec![0.0; CELLS];
        found[1].fill(&mut cells);
        assert_eq!([cells[0], cells[1], cells[2]].map(|amplitude| amplitude as u32), [1, 2, 1]);
    }

    #[test]
    fn what_has_no_north_is_no_spoke_and_what_has_another_form_no_datagram() {
        let bytes = datagram(1024);
        assert_eq!(spokes(&bytes, None).expect("spokes").flatten().count(), 0);
        for cut in [0, 5, 8, 100, bytes.len() - 1] {
            assert!(spokes(&bytes[..cut], None).is_none(), "{cut}");
        }
    }
}
