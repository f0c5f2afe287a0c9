//! serde form of an f32 that is NaN when not known: JSON has no NaN, so it writes `null`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature is serde's")]
pub(crate) fn serialize<S: Serializer>(value: &f32, serializer: S) -> Result<S::Ok, S::Error> {
    if serializer.is_human_readable() && value.is_nan() {
        serializer.serialize_none()
    } else {
        value.serialize(serializer)
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f32, D::Error> {
    if deserializer.is_human_readable() {
        Ok(Option::<f32>::deserialize(deserializer)?.unwrap_or(f32::NAN))
    } else {
        f32::deserialize(deserializer)
    }
}
