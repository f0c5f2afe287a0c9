//! The frames of the recorder FINAL.
//!
//! ```text
//! length of the frame (2 octets, big-endian) | board | line | day | time of day (3 octets, 10 ms) | blocks | a5 a5 a5 a5
//! ```

use std::borrow::Cow;

use super::{Datagram, Recording};

const HEADER: usize = 8;
const PADDING: [u8; 4] = [0xa5; 4];
const DAY_NS: u64 = 86_400_000_000_000;
const TICK_NS: u64 = 10_000_000;

/// The frame at a place: blocks, day and time.
fn frame(bytes: &[u8], at: usize) -> Option<(&[u8], u8, u32)> {
    let header: &[u8; HEADER] = bytes.get(at..)?.first_chunk()?;
    let [high, low, _, _, day, time @ ..] = *header;
    let length = usize::from(u16::from_be_bytes([high, low]));
    let blocks = bytes.get(at + HEADER..at + length)?.strip_suffix(&PADDING)?;
    Some((blocks, day, u32::from_be_bytes([0, time[0], time[1], time[2]])))
}

pub(super) fn is_framed(bytes: &[u8]) -> bool {
    frame(bytes, 0).is_some()
}

/// The frames of a file; after damaged bytes, those from the next frame on.
pub(super) fn frames<'a>(bytes: &'a [u8], recording: &mut Recording<'a>) {
    let (mut at, mut first_day) = (0, None);
    while at < bytes.len() {
        if let Some((blocks, day, time)) = frame(bytes, at) {
            let days = day.wrapping_sub(*first_day.get_or_insert(day));
            let time_ns = Some(u64::from(days) * DAY_NS + u64::from(time) * TICK_NS);
            recording.datagrams.push(Datagram {
                time_ns,
                destination: None,
                offset: at + HEADER,
                bytes: Cow::Borrowed(blocks),
            });
            at += HEADER + blocks.len() + PADDING.len();
        } else {
            let next = (at + 1..bytes.len()).find(|&next| frame(bytes, next).is_some()).unwrap_or(bytes.len());
            recording.lose(at..next, "no frame of the recorder FINAL");
            at = next;
        }
    }
}
