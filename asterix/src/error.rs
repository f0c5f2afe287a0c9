//! What can be wrong with bytes that are read, and with values that are written.

/// Why a record could not be read, and where.
///
/// The next record of its block cannot be found; those before it stay good.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("category {category:03}, record {record}, item {item}, byte {offset}: {fault}")]
pub struct DecodeError {
    /// Its category.
    pub category: u8,
    /// Which record of its block, the first is 1.
    pub record: usize,
    /// The item: its number or short name, `FSPEC`, or `?` at a position without an item.
    pub item: &'static str,
    /// Where the item begins, bytes from the start of what is read.
    pub offset: usize,
    /// What is wrong.
    pub fault: Fault,
}

/// What is wrong with an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The block ends inside it.
    #[error("{needed} octets expected, {left} left in the block")]
    Truncated {
        /// Its size, or the least that is possible, octets.
        needed: usize,
        /// What is left of the block, octets.
        left: usize,
    },
    /// The FSPEC names a position at which the edition has no item.
    #[error("the edition has no item at position {0} of the FSPEC")]
    UndefinedPosition(usize),
    /// The item names a part that the edition does not have.
    #[error("the edition has no part {0} of the item")]
    UndefinedPart(usize),
    /// A length that counts its own octet is 0.
    #[error("length 0 found, at least 1 expected")]
    LengthZero,
}

/// Why a block could not be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum BlockError {
    /// The length is smaller than the header or larger than what is left.
    #[error("category {category:03}, byte {offset}: block length {length} found, 3 to {left} expected")]
    Length {
        /// Category of the block.
        category: u8,
        /// Where the block begins.
        offset: usize,
        /// The length that its header says, octets.
        length: usize,
        /// What is left, octets.
        left: usize,
    },
    /// Fewer octets than a header has.
    #[error("byte {offset}: {left} octets left, a block has at least 3")]
    NoHeader {
        /// Where they begin.
        offset: usize,
        /// How many there are.
        left: usize,
    },
}

/// Why a value could not be written.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum EncodeError {
    /// The field cannot hold it.
    #[error("item {item}: value {value} found, {least} to {most} expected")]
    Range {
        /// The item.
        item: &'static str,
        /// The value, in the unit of the field.
        value: f64,
        /// The least that the field can hold.
        least: f64,
        /// The most.
        most: f64,
    },
    /// Items are written in the order of the profile, parts of a compound item in the order of the item.
    #[error("item {item}: written after one that follows it")]
    Order {
        /// The item.
        item: &'static str,
    },
    /// The value is not of the item's shape.
    #[error("item {item}: the value has another shape than the item")]
    Shape {
        /// The item.
        item: &'static str,
    },
    /// The record is of an edition in which the field does not lie where it is written.
    #[error("item {item}: the field is of another edition than the record")]
    Edition {
        /// The item.
        item: &'static str,
    },
    /// A block holds at most 65,535 octets.
    #[error("category {category:03}: a block of {octets} octets, at most 65535 expected")]
    BlockTooLong {
        /// Category of the block.
        category: u8,
        /// Its size with the record that no longer fits, octets.
        octets: usize,
    },
}
