//! Files that are no recording of a radar, told by their first bytes.

/// First bytes and what begins with them.
const MAGIC: [(&[u8], &str); 3] = [
    (&[0x1f, 0x8b], "compressed by gzip"),
    (&[0x28, 0xb5, 0x2f, 0xfd], "compressed by zstd"),
    (b"\x89MCAP", "a recording of a chain (`radar-chain run --replay FILE` replays it)"),
];
/// So many bytes tell whether a file is text.
const TEXT: usize = 4096;

/// What the file that begins with `bytes` is, if that is known and not ASTERIX.
pub fn what_is(bytes: &[u8]) -> Option<&'static str> {
    if let Some((_, name)) = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Some(name);
    }
    let start = &bytes[..bytes.len().min(TEXT)];
    let is_text = start.iter().all(|&byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace() || byte >= 0x80);
    let line = start.split(|&byte| byte == b'\n').next().unwrap_or(start);
    match line.first()? {
        _ if !is_text => None,
        b'{' => Some("JSON lines (`tracker replay --plots FILE` reads plots in this form)"),
        _ if line.contains(&b',') || line.contains(&b';') => Some("a table (CSV)"),
        _ => Some("a text file"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_by_their_first_bytes() {
        assert_eq!(what_is(&[0x1f, 0x8b, 8, 0]), Some("compressed by gzip"));
        assert_eq!(what_is(b"time_s,range_m\n1,2\n"), Some("a table (CSV)"));
        assert_eq!(what_is(b"root:x:0:0\n"), Some("a text file"));
        assert!(what_is(b"{\"topic\":\"plots\"}\n").is_some_and(|text| text.starts_with("JSON lines")));
        assert_eq!(what_is(&[10, 0, 10, 0xd0]), None);
        assert_eq!(what_is(&[]), None);
    }
}
