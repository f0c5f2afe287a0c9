//! What a specification says of a category: its items, their shapes, and their order in a record.
//!
//! The tables of these types are generated from the specifications; see [`crate::tables`].

/// One edition of one category.
#[derive(Debug, PartialEq)]
pub struct Edition {
    /// The category.
    pub category: u8,
    /// Number of the edition, such as `1.32`.
    pub number: &'static str,
    /// What the category is for.
    pub title: &'static str,
    /// User application profiles: one, or several among which an element of the record chooses.
    pub profiles: &'static [Profile],
    /// How a record chooses its profile, where there are several.
    pub choice: Option<Choice>,
}

/// An element whose value says which profile a record has.
///
/// Its item stands at the same position in all profiles, and the same items stand before it.
#[derive(Debug, PartialEq)]
pub struct Choice {
    /// Its item.
    pub item: &'static str,
    /// Its first bit in the item, counted from the highest of the first octet.
    pub bit: u16,
    /// Its size, bits.
    pub bits: u16,
    /// Values and the profiles that they choose. Without the item the first profile holds.
    pub profiles: &'static [(u64, usize)],
}

/// A user application profile: the items in the order of the FSPEC's bits.
#[derive(Debug, PartialEq)]
pub struct Profile {
    /// Its name, where a category has several.
    pub name: &'static str,
    /// What stands at each position.
    pub slots: &'static [Slot],
}

/// What a bit of the FSPEC stands for.
#[derive(Debug, PartialEq)]
pub enum Slot {
    /// An item.
    Item(&'static Item),
    /// Nothing.
    Spare,
    /// Random field sequencing: a count, and that many pairs of a position and its item.
    Sequence,
}

/// An item, or a part of one, with its name.
#[derive(Debug, PartialEq)]
pub struct Item {
    /// Its number or short name.
    pub name: &'static str,
    /// Its title; empty where the specification has none.
    pub title: &'static str,
    /// What it consists of.
    pub shape: Shape,
}

/// What an item, or a part of one, consists of.
#[derive(Debug, PartialEq)]
pub enum Shape {
    /// One value.
    Element {
        /// Its size.
        bits: u16,
        /// What the value means.
        content: Content,
    },
    /// Parts one after the other.
    Group {
        /// Size of all parts together.
        bits: u16,
        /// The parts.
        parts: &'static [Part],
    },
    /// Octets of seven bits each, whose lowest bit says whether another one follows.
    Extended(&'static [Part]),
    /// A count of one octet, and that many of `of`.
    Counted(&'static Shape),
    /// One of `of` after the other; the last bit of the octets of each says whether another one follows.
    Chained(&'static Shape),
    /// A length of one octet, which counts itself, and content that no edition of the category defines.
    Explicit,
    /// A field of bits like the FSPEC, and those of these items that it names.
    Compound(&'static [Option<Item>]),
}

/// A part of a group or an extended item.
#[derive(Debug, PartialEq)]
pub enum Part {
    /// A value, or several.
    Item(Item),
    /// So many bits without meaning.
    Spare(u16),
    /// The bit that says whether another octet follows.
    Fx,
}

/// What the bits of an element mean.
#[derive(Debug, PartialEq)]
pub enum Content {
    /// Whatever the item's text says.
    Raw,
    /// One of these.
    Table(&'static [(u64, &'static str)]),
    /// Characters.
    Text(Text),
    /// A whole number.
    Integer {
        /// In two's complement.
        signed: bool,
    },
    /// A physical quantity.
    Quantity {
        /// In two's complement.
        signed: bool,
        /// What the lowest bit is worth, in `unit`.
        step: f64,
        /// The unit, as the specification writes it.
        unit: &'static str,
    },
    /// One of several, as the part `of` of the same group says; raw for other values than those named.
    Case {
        /// Name of the part that decides.
        of: &'static str,
        /// Its values, and what they choose.
        cases: &'static [(u64, Content)],
    },
}

/// How characters are coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Text {
    /// ASCII, eight bits each.
    Ascii,
    /// The alphabet of ICAO's Annex 10, six bits each.
    Icao,
    /// Octal digits, three bits each.
    Octal,
}

impl Shape {
    /// Size of a shape that is always the same, octets.
    pub const fn fixed_octets(&self) -> Option<usize> {
        match self {
            Self::Element { bits, .. } | Self::Group { bits, .. } => Some(*bits as usize / 8),
            _ => None,
        }
    }

    /// Size of one of a chain, octets, if this is what is chained: the bit that says whether another one follows included.
    pub(crate) const fn link_octets(&self) -> usize {
        match self {
            Self::Element { bits, .. } | Self::Group { bits, .. } => (*bits + 1) as usize / 8,
            _ => 1,
        }
    }
}
