//! Where the radar of a recording stands, and with it the places of what it has found.

use std::io;
use std::path::Path;

use common::config::{self, ChainConfig};
use common::geodesy::LocalFrame;
use common::recording::RecordingError;
use common::recording::container::Description;
use common::recording::row::{Table, Value};

/// The configuration that a recording was made with.
///
/// # Errors
/// There is none, or one that is not understood.
pub(super) fn configuration(description: Option<&Description>) -> Result<ChainConfig, RecordingError> {
    let refuse = |reason: String| RecordingError::Io(io::Error::other(reason));
    let text = &description.ok_or_else(|| refuse("the file holds no configuration".into()))?.config;
    config::parse_recorded(Path::new("recorded configuration"), text).map_err(|error| refuse(error.to_string()))
}

/// Columns of places, for tables of a recording whose radar has one.
#[derive(Debug, Clone, Copy)]
pub struct Places(Option<LocalFrame>);

impl Places {
    /// Of a recording that says `description` of itself.
    pub fn of(description: Option<&Description>) -> Self {
        let position = configuration(description).ok().and_then(|chain| chain.site.position);
        Self(position.as_ref().map(LocalFrame::new))
    }

    /// Puts latitude, longitude and height of a position about the radar into a row; nothing where there is no place.
    pub(super) fn put(&self, position_m: Option<[f64; 3]>, table: &mut dyn Table) -> io::Result<()> {
        let Some((frame, position_m)) = self.0.zip(position_m) else { return Ok(()) };
        let place = frame.place(position_m);
        table.put("latitude_deg", Value::F64(place.latitude_deg))?;
        table.put("longitude_deg", Value::F64(place.longitude_deg))?;
        table.put("height_m", Value::F64(place.height_m))
    }
}
