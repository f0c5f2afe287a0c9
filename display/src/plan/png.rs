//! Pixels as a PNG file.

use std::io::Write;

use flate2::{Compression, Crc, write::ZlibEncoder};

/// What the bytes of a pixel are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pixels {
    /// Grey and opacity.
    GreyAlpha,
    /// Red, green and blue.
    Rgb,
}

impl Pixels {
    /// Bytes of a pixel, and the number that PNG has for this kind.
    fn form(self) -> (usize, u8) {
        match self {
            Self::GreyAlpha => (2, 4),
            Self::Rgb => (3, 2),
        }
    }
}

/// An image of `[width, height]` px with eight bits a channel, row by row from the top, as PNG.
pub(super) fn png(size: [u32; 2], kind: Pixels, pixels: &[u8]) -> Vec<u8> {
    let (bytes_per_pixel, colour_type) = kind.form();
    let row_bytes = size[0] as usize * bytes_per_pixel;
    assert_eq!(pixels.len(), row_bytes * size[1] as usize, "bytes of an image of {size:?} px");
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    for row in pixels.chunks_exact(row_bytes.max(1)) {
        // Writing to memory cannot fail. Each row begins with its filter: none.
        let _ = encoder.write_all(&[0]).and_then(|()| encoder.write_all(row));
    }
    let data = encoder.finish().unwrap_or_default();
    let mut header = size.map(u32::to_be_bytes).concat();
    header.extend([8, colour_type, 0, 0, 0]);
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, content) in [(b"IHDR", header), (b"IDAT", data), (b"IEND", Vec::new())] {
        let mut check = Crc::new();
        check.update(name);
        check.update(&content);
        bytes.extend((content.len() as u32).to_be_bytes());
        bytes.extend(name);
        bytes.extend(content);
        bytes.extend(check.sum().to_be_bytes());
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn rows_are_packed_behind_their_filter() {
        let bytes = png([2, 1], Pixels::Rgb, &[1, 2, 3, 4, 5, 6]);
        assert_eq!(bytes[16..29], [0, 0, 0, 2, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
        let length = u32::from_be_bytes(bytes[33..37].try_into().expect("four")) as usize;
        let mut rows = Vec::new();
        ZlibDecoder::new(&bytes[41..41 + length]).read_to_end(&mut rows).expect("zlib");
        assert_eq!(rows, [0, 1, 2, 3, 4, 5, 6]);
        // The check sum of an empty IEND, as it stands at the end of every PNG.
        assert_eq!(bytes[bytes.len() - 4..], [0xae, 0x42, 0x60, 0x82]);
    }
}
