//! Ways of targets as KML: a `gx:Track` for each, which map programs play in time.
//!
//! Heights are those above the ellipsoid, given as `absolute`: map programs take them for heights above the sea, tens of metres apart.
//! A target without heights lies on the ground.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use common::recording::container::Description;
use common::recording::{RecordedRef, RecordingError};
use common::time::rfc3339;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use super::Sink;
use super::paths::{Path, Paths};

/// One document.
pub(super) struct Kml {
    out: BufWriter<File>,
    paths: Paths,
    name: &'static str,
}

impl Kml {
    pub(super) fn create(
        out: BufWriter<File>,
        description: Option<&Description>,
        name: &'static str,
    ) -> Result<Self, RecordingError> {
        Ok(Self { out, paths: Paths::new(description)?, name })
    }
}

fn text(xml: &mut Writer<BufWriter<File>>, element: &str, text: &str) -> io::Result<()> {
    xml.create_element(element).write_text_content(BytesText::new(text))?;
    Ok(())
}

fn placemark(xml: &mut Writer<BufWriter<File>>, path: &Path) -> io::Result<()> {
    let has_heights = path.points.iter().all(|point| point.has_height);
    xml.create_element("Placemark").write_inner_content(|xml| {
        text(xml, "name", &path.name)?;
        xml.create_element("gx:Track").write_inner_content(|xml| {
            text(xml, "altitudeMode", if has_heights { "absolute" } else { "clampToGround" })?;
            for point in &path.points {
                text(xml, "when", &rfc3339(point.time_ns))?;
            }
            for point in &path.points {
                let height_m = if has_heights { point.place.height_m } else { 0.0 };
                let (longitude, latitude) = (point.place.longitude_deg, point.place.latitude_deg);
                text(xml, "gx:coord", &format!("{longitude:.8} {latitude:.8} {height_m:.2}"))?;
            }
            Ok(())
        })?;
        Ok(())
    })?;
    Ok(())
}

impl Sink for Kml {
    fn write(&mut self, message: RecordedRef<'_>) -> Result<u64, RecordingError> {
        Ok(self.paths.take(message))
    }

    fn finish(self: Box<Self>) -> Result<(), RecordingError> {
        let Self { out, paths, name } = *self;
        let mut xml = Writer::new(out);
        xml.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        let names = [("xmlns", "http://www.opengis.net/kml/2.2"), ("xmlns:gx", "http://www.google.com/kml/ext/2.2")];
        xml.create_element("kml").with_attributes(names).write_inner_content(|xml| {
            xml.create_element("Document").write_inner_content(|xml| {
                text(xml, "name", name)?;
                paths.iter().try_for_each(|(_, path)| placemark(xml, path))
            })?;
            Ok(())
        })?;
        Ok(xml.into_inner().flush()?)
    }
}
