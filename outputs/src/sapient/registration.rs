//! What the node says of itself when it registers.

use common::config::TargetClass;

use super::messages::{
    AREA_OF_INTEREST, Capability, ClassDefinition, ConfigurationData, DetectionClassDefinition, DetectionDefinition,
    Duration, GeometricError, LAT_LNG_DEG_M, LocationType, METRES_A_SECOND, MODE_PERMANENT, ModeDefinition,
    NODE_FUSION, NODE_RADAR, NodeDefinition, RegionDefinition, Registration, SCANNING, SINGLE_CLASS, StatusDefinition,
    SubClassDefinition, TRACK, TRACKLET, TaskDefinition, UNITS_MILLISECONDS, UNITS_SECONDS, VelocityType,
    VelocityUnits, WGS84_E,
};
use crate::targets::Site;

/// The version of the interface that is spoken.
const ICD_VERSION: &str = "BSI Flex 335 v2.0";
/// The only mode there is.
pub(super) const MODE: &str = "Default";

/// Class and sub-class of a target, as the taxonomy names them.
pub(super) fn class_of(class: TargetClass) -> (&'static str, Option<&'static str>) {
    match class {
        TargetClass::Air => ("Air Vehicle", None),
        TargetClass::Aeroplane => ("Air Vehicle", Some("Manned Fixed Wing")),
        TargetClass::Helicopter => ("Air Vehicle", Some("Manned Rotary Wing")),
        TargetClass::Drone => ("Air Vehicle", Some("UAV Rotary Wing")),
        TargetClass::Ship => ("Sea Vessel", None),
        TargetClass::Vehicle => ("Land Vehicle", None),
    }
}

fn seconds(value: f64) -> Duration {
    Duration { units: Some(UNITS_SECONDS), value: Some(value as f32) }
}

/// Places are latitude, longitude and height.
fn places() -> LocationType {
    LocationType { location_units: Some(LAT_LNG_DEG_M), location_datum: Some(WGS84_E) }
}

/// The registration of a site whose tracks leave at most `latency_ns` after their sector.
pub(super) fn registration(site: &Site, class: TargetClass, status_s: f64, latency_ns: u64) -> Registration {
    let (class, sub_class) = class_of(class);
    let sub_class = sub_class.map(|name| SubClassDefinition { r#type: Some(name.into()), level: Some(1) });
    let per_second =
        VelocityUnits { east_north_rate_units: Some(METRES_A_SECOND), up_rate_units: Some(METRES_A_SECOND) };
    let detection = DetectionDefinition {
        location_type: Some(places()),
        detection_class_definition: vec![DetectionClassDefinition {
            confidence_definition: Some(SINGLE_CLASS),
            class_definition: vec![ClassDefinition {
                r#type: Some(class.into()),
                sub_class: sub_class.into_iter().collect(),
            }],
        }],
        velocity_type: Some(VelocityType { enu_velocity_units: Some(per_second), location_datum: Some(WGS84_E) }),
        geometric_error: Some(GeometricError {
            r#type: Some("Standard Deviation".into()),
            units: Some("meters".into()),
            variation_type: Some("Per report".into()),
        }),
    };
    let mode = ModeDefinition {
        mode_name: Some(MODE.into()),
        mode_type: Some(MODE_PERMANENT),
        settle_time: Some(seconds(0.0)),
        maximum_latency: Some(Duration {
            units: Some(UNITS_MILLISECONDS),
            value: Some((latency_ns as f64 / 1e6) as f32),
        }),
        scan_type: Some(SCANNING),
        tracking_type: Some(if site.is_fused { TRACK } else { TRACKLET }),
        duration: None,
        detection_definition: vec![detection],
        task: Some(TaskDefinition {
            concurrent_tasks: Some(0),
            region_definition: Some(RegionDefinition {
                region_type: vec![AREA_OF_INTEREST],
                region_area: vec![places()],
            }),
        }),
    };
    Registration {
        node_definition: vec![NodeDefinition { node_type: Some(if site.is_fused { NODE_FUSION } else { NODE_RADAR }) }],
        icd_version: Some(ICD_VERSION.into()),
        name: Some(format!("radar-chain {}", site.name)),
        short_name: Some(site.name.clone()),
        capabilities: vec![Capability {
            category: Some("Tracking".into()),
            r#type: Some("Surveillance radar".into()),
            value: Some("Tracks with errors".into()),
            units: None,
        }],
        status_definition: Some(StatusDefinition {
            status_interval: Some(seconds(status_s)),
            location_definition: Some(places()),
        }),
        mode_definition: vec![mode],
        config_data: vec![ConfigurationData {
            manufacturer: "radar-chain".into(),
            model: "radar-chain".into(),
            software_version: Some(env!("CARGO_PKG_VERSION").into()),
        }],
    }
}
