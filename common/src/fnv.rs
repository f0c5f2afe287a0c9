//! A short hash of names, the same in every process and version: FNV-1a.

/// Hash of `bytes`, beginning from `seed`; 0 gives the published one.
pub(crate) fn fnv1a(seed: u64, bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325 ^ seed, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    #[test]
    fn published_values_come_out() {
        assert_eq!(super::fnv1a(0, b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(super::fnv1a(0, b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(super::fnv1a(0, b"foobar"), 0x8594_4171_f739_67e8);
    }
}
