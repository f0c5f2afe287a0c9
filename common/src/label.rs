//! Names inside messages: text of a fixed size, without undefined bytes.

use iceoryx2::prelude::ZeroCopySend;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A name of at most [`Label::LONGEST`] bytes of UTF-8, padded with zeros. In JSON it is text.
#[derive(Default, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, ZeroCopySend)]
#[type_name("radar/Label/1")]
#[repr(C)]
pub struct Label([u8; 32]);

impl Label {
    /// Bytes that a label has room for.
    pub const LONGEST: usize = 32;

    /// The label of `text`; what is longer is cut before the character that does not fit.
    pub fn new(text: &str) -> Self {
        let mut bytes = [0; Self::LONGEST];
        let length = (0..=text.len().min(Self::LONGEST)).rev().find(|&length| text.is_char_boundary(length));
        let length = length.unwrap_or(0);
        bytes[..length].copy_from_slice(&text.as_bytes()[..length]);
        Self(bytes)
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&byte| byte == 0).unwrap_or(self.0.len());
        std::str::from_utf8(&self.0[..end]).unwrap_or("?")
    }

    /// Whether there is no text.
    pub fn is_empty(&self) -> bool {
        self.0[0] == 0
    }
}

impl From<&str> for Label {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl std::fmt::Debug for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.as_str().fmt(f)
    }
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

impl Serialize for Label {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for Label {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|text| Self::new(&text))
    }
}

impl JsonSchema for Label {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Label".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        generator.subschema_for::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_is_cut_between_characters_and_reads_back() {
        assert_eq!(Label::new("tracker").as_str(), "tracker");
        let long = "ä".repeat(20);
        assert_eq!(Label::new(&long).as_str(), "ä".repeat(16));
        assert_eq!(Label::new(&format!("x{long}")).as_str(), format!("x{}", "ä".repeat(15)));
        assert!(Label::default().is_empty() && !Label::new("a").is_empty());
        let text = serde_json::to_string(&Label::new("north")).expect("JSON");
        assert_eq!(
            (text.as_str(), serde_json::from_str::<Label>(&text).expect("JSON")),
            ("\"north\"", Label::new("north"))
        );
    }
}
