//! Lengths within a record, checked before the record is parsed: a spoilt one would have gigabytes set aside for it.

use mcap::records::op;

/// A part of a record.
#[derive(Clone, Copy)]
enum Part {
    /// So many bytes.
    Fixed(usize),
    /// A length of four bytes, and as many bytes.
    Counted,
    /// As [`Part::Counted`]; inside are texts, each as [`Part::Counted`].
    Texts,
}

/// Parts of a record up to the last length of four bytes.
fn parts(opcode: u8) -> &'static [Part] {
    use Part::{Counted, Fixed, Texts};
    match opcode {
        op::SCHEMA => &[Fixed(2), Counted, Counted, Counted],
        op::CHANNEL => &[Fixed(4), Counted, Counted, Texts],
        op::METADATA => &[Counted, Texts],
        op::CHUNK => &[Fixed(28), Counted],
        op::CHUNK_INDEX => &[Fixed(32), Counted, Fixed(8), Counted],
        _ => &[],
    }
}

/// Whether the lengths in a record agree with its size.
pub(super) fn fit(opcode: u8, content: &[u8]) -> bool {
    let rest = parts(opcode).iter().try_fold(content, |rest, part| match part {
        Part::Fixed(bytes) => rest.get(*bytes..),
        Part::Counted => counted(rest).map(|(_, rest)| rest),
        Part::Texts => {
            let (mut texts, rest) = counted(rest)?;
            while !texts.is_empty() {
                texts = counted(texts)?.1;
            }
            Some(rest)
        }
    });
    rest.is_some()
}

/// What a length of four bytes counts, and what follows.
fn counted(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_beyond_the_record_does_not_fit() {
        let text = |length: u32, text: &[u8]| [&length.to_le_bytes()[..], text].concat();
        let schema = |length: u32| [&[1, 0][..], &text(2, b"ab"), &text(length, b"cde"), &text(0, b"")].concat();
        assert!(fit(op::SCHEMA, &schema(3)));
        assert!(!fit(op::SCHEMA, &schema(u32::MAX)) && !fit(op::SCHEMA, &schema(9)));
        let pair = |length: u32| [text(1, b"k"), text(length, b"v")].concat();
        let metadata = |length: u32| [text(1, b"n"), text(10, &pair(length))].concat();
        assert!(fit(op::METADATA, &metadata(1)) && !fit(op::METADATA, &metadata(u32::MAX)));
        assert!(!fit(op::CHUNK, &[0; 28]) && fit(op::CHUNK, &[0; 40]));
        assert!(fit(op::MESSAGE, &[]), "no such length in it");
    }
}
