//! The messages of BSI Flex 335 v2.0 that an edge node sends and hears, field numbers as in the published definitions. Fields that are
//! never used here are left out: a reader of protobuf passes over them.
//!
//! Codes of enumerations stand beside the message that uses them; on the wire they are numbers.

use prost::{Message, Oneof};

/// A message, either way.
#[derive(Clone, PartialEq, Message)]
pub(super) struct SapientMessage {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    /// UUID of the sender.
    #[prost(string, optional, tag = "2")]
    pub(super) node_id: Option<String>,
    /// UUID of the receiver.
    #[prost(string, optional, tag = "3")]
    pub(super) destination_id: Option<String>,
    #[prost(oneof = "Content", tags = "4, 5, 6, 7, 8, 9, 12")]
    pub(super) content: Option<Content>,
}

#[derive(Clone, PartialEq, Oneof)]
pub(super) enum Content {
    #[prost(message, tag = "4")]
    Registration(Registration),
    #[prost(message, tag = "5")]
    RegistrationAck(RegistrationAck),
    #[prost(message, tag = "6")]
    StatusReport(StatusReport),
    #[prost(message, tag = "7")]
    DetectionReport(DetectionReport),
    #[prost(message, tag = "8")]
    Task(Task),
    #[prost(message, tag = "9")]
    TaskAck(TaskAck),
    #[prost(message, tag = "12")]
    Error(ErrorReport),
}

/// Of protobuf's own types.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Timestamp {
    #[prost(int64, tag = "1")]
    pub(super) seconds: i64,
    #[prost(int32, tag = "2")]
    pub(super) nanos: i32,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Registration {
    #[prost(message, repeated, tag = "1")]
    pub(super) node_definition: Vec<NodeDefinition>,
    #[prost(string, optional, tag = "2")]
    pub(super) icd_version: Option<String>,
    #[prost(string, optional, tag = "3")]
    pub(super) name: Option<String>,
    #[prost(string, optional, tag = "4")]
    pub(super) short_name: Option<String>,
    #[prost(message, repeated, tag = "5")]
    pub(super) capabilities: Vec<Capability>,
    #[prost(message, optional, tag = "6")]
    pub(super) status_definition: Option<StatusDefinition>,
    #[prost(message, repeated, tag = "7")]
    pub(super) mode_definition: Vec<ModeDefinition>,
    #[prost(message, repeated, tag = "10")]
    pub(super) config_data: Vec<ConfigurationData>,
}

pub(super) const NODE_RADAR: i32 = 2;
pub(super) const NODE_FUSION: i32 = 20;

#[derive(Clone, PartialEq, Message)]
pub(super) struct NodeDefinition {
    #[prost(int32, optional, tag = "1")]
    pub(super) node_type: Option<i32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Capability {
    #[prost(string, optional, tag = "1")]
    pub(super) category: Option<String>,
    #[prost(string, optional, tag = "2")]
    pub(super) r#type: Option<String>,
    #[prost(string, optional, tag = "3")]
    pub(super) value: Option<String>,
    #[prost(string, optional, tag = "4")]
    pub(super) units: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct StatusDefinition {
    #[prost(message, optional, tag = "1")]
    pub(super) status_interval: Option<Duration>,
    #[prost(message, optional, tag = "2")]
    pub(super) location_definition: Option<LocationType>,
}

pub(super) const UNITS_MILLISECONDS: i32 = 3;
pub(super) const UNITS_SECONDS: i32 = 4;

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Duration {
    #[prost(int32, optional, tag = "1")]
    pub(super) units: Option<i32>,
    #[prost(float, optional, tag = "3")]
    pub(super) value: Option<f32>,
}

/// Latitude and longitude in degrees, height in metres.
pub(super) const LAT_LNG_DEG_M: i32 = 1;
/// Heights above the ellipsoid.
pub(super) const WGS84_E: i32 = 1;

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct LocationType {
    #[prost(int32, optional, tag = "1")]
    pub(super) location_units: Option<i32>,
    #[prost(int32, optional, tag = "3")]
    pub(super) location_datum: Option<i32>,
}

pub(super) const MODE_PERMANENT: i32 = 1;
pub(super) const SCANNING: i32 = 2;
/// Every track has an identity of its own; a target found again is another one.
pub(super) const TRACKLET: i32 = 2;
/// A target keeps its identity.
pub(super) const TRACK: i32 = 3;

#[derive(Clone, PartialEq, Message)]
pub(super) struct ModeDefinition {
    #[prost(string, optional, tag = "1")]
    pub(super) mode_name: Option<String>,
    #[prost(int32, optional, tag = "2")]
    pub(super) mode_type: Option<i32>,
    #[prost(message, optional, tag = "4")]
    pub(super) settle_time: Option<Duration>,
    #[prost(message, optional, tag = "5")]
    pub(super) maximum_latency: Option<Duration>,
    #[prost(int32, optional, tag = "6")]
    pub(super) scan_type: Option<i32>,
    #[prost(int32, optional, tag = "7")]
    pub(super) tracking_type: Option<i32>,
    #[prost(message, optional, tag = "8")]
    pub(super) duration: Option<Duration>,
    #[prost(message, repeated, tag = "10")]
    pub(super) detection_definition: Vec<DetectionDefinition>,
    #[prost(message, optional, tag = "11")]
    pub(super) task: Option<TaskDefinition>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct DetectionDefinition {
    #[prost(message, optional, tag = "1")]
    pub(super) location_type: Option<LocationType>,
    #[prost(message, repeated, tag = "4")]
    pub(super) detection_class_definition: Vec<DetectionClassDefinition>,
    #[prost(message, optional, tag = "6")]
    pub(super) velocity_type: Option<VelocityType>,
    #[prost(message, optional, tag = "7")]
    pub(super) geometric_error: Option<GeometricError>,
}

pub(super) const SINGLE_CLASS: i32 = 1;

#[derive(Clone, PartialEq, Message)]
pub(super) struct DetectionClassDefinition {
    #[prost(int32, optional, tag = "1")]
    pub(super) confidence_definition: Option<i32>,
    #[prost(message, repeated, tag = "3")]
    pub(super) class_definition: Vec<ClassDefinition>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct ClassDefinition {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(message, repeated, tag = "3")]
    pub(super) sub_class: Vec<SubClassDefinition>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SubClassDefinition {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(int32, optional, tag = "3")]
    pub(super) level: Option<i32>,
}

pub(super) const METRES_A_SECOND: i32 = 1;

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct VelocityType {
    #[prost(message, optional, tag = "4")]
    pub(super) enu_velocity_units: Option<VelocityUnits>,
    #[prost(int32, optional, tag = "6")]
    pub(super) location_datum: Option<i32>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct VelocityUnits {
    #[prost(int32, optional, tag = "1")]
    pub(super) east_north_rate_units: Option<i32>,
    #[prost(int32, optional, tag = "2")]
    pub(super) up_rate_units: Option<i32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct GeometricError {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(string, optional, tag = "2")]
    pub(super) units: Option<String>,
    #[prost(string, optional, tag = "3")]
    pub(super) variation_type: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct TaskDefinition {
    #[prost(int32, optional, tag = "1")]
    pub(super) concurrent_tasks: Option<i32>,
    #[prost(message, optional, tag = "2")]
    pub(super) region_definition: Option<RegionDefinition>,
}

pub(super) const AREA_OF_INTEREST: i32 = 1;

#[derive(Clone, PartialEq, Message)]
pub(super) struct RegionDefinition {
    #[prost(int32, repeated, tag = "1")]
    pub(super) region_type: Vec<i32>,
    #[prost(message, repeated, tag = "3")]
    pub(super) region_area: Vec<LocationType>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct ConfigurationData {
    #[prost(string, tag = "1")]
    pub(super) manufacturer: String,
    #[prost(string, tag = "2")]
    pub(super) model: String,
    #[prost(string, optional, tag = "5")]
    pub(super) software_version: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct RegistrationAck {
    #[prost(bool, optional, tag = "1")]
    pub(super) acceptance: Option<bool>,
    #[prost(string, repeated, tag = "3")]
    pub(super) ack_response_reason: Vec<String>,
}

pub(super) const SYSTEM_OK: i32 = 1;
pub(super) const SYSTEM_WARNING: i32 = 2;
pub(super) const SYSTEM_GOODBYE: i32 = 5;
pub(super) const INFO_NEW: i32 = 1;
pub(super) const INFO_UNCHANGED: i32 = 2;

#[derive(Clone, PartialEq, Message)]
pub(super) struct StatusReport {
    /// ULID.
    #[prost(string, optional, tag = "1")]
    pub(super) report_id: Option<String>,
    #[prost(int32, optional, tag = "2")]
    pub(super) system: Option<i32>,
    #[prost(int32, optional, tag = "3")]
    pub(super) info: Option<i32>,
    #[prost(string, optional, tag = "5")]
    pub(super) mode: Option<String>,
    #[prost(message, optional, tag = "7")]
    pub(super) node_location: Option<Location>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Location {
    /// East: longitude.
    #[prost(double, optional, tag = "1")]
    pub(super) x: Option<f64>,
    /// North: latitude.
    #[prost(double, optional, tag = "2")]
    pub(super) y: Option<f64>,
    /// Height, m.
    #[prost(double, optional, tag = "3")]
    pub(super) z: Option<f64>,
    #[prost(double, optional, tag = "4")]
    pub(super) x_error: Option<f64>,
    #[prost(double, optional, tag = "5")]
    pub(super) y_error: Option<f64>,
    #[prost(double, optional, tag = "6")]
    pub(super) z_error: Option<f64>,
    #[prost(int32, optional, tag = "7")]
    pub(super) coordinate_system: Option<i32>,
    #[prost(int32, optional, tag = "8")]
    pub(super) datum: Option<i32>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct DetectionReport {
    /// ULID of the report.
    #[prost(string, optional, tag = "1")]
    pub(super) report_id: Option<String>,
    /// ULID of the track.
    #[prost(string, optional, tag = "2")]
    pub(super) object_id: Option<String>,
    #[prost(string, optional, tag = "4")]
    pub(super) state: Option<String>,
    #[prost(message, optional, tag = "6")]
    pub(super) location: Option<Location>,
    #[prost(float, optional, tag = "7")]
    pub(super) detection_confidence: Option<f32>,
    #[prost(message, repeated, tag = "8")]
    pub(super) track_info: Vec<TrackInfo>,
    #[prost(message, repeated, tag = "11")]
    pub(super) classification: Vec<Classification>,
    #[prost(message, optional, tag = "19")]
    pub(super) enu_velocity: Option<EnuVelocity>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct TrackInfo {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(string, optional, tag = "2")]
    pub(super) value: Option<String>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Classification {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(message, repeated, tag = "3")]
    pub(super) sub_class: Vec<SubClass>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SubClass {
    #[prost(string, optional, tag = "1")]
    pub(super) r#type: Option<String>,
    #[prost(int32, optional, tag = "3")]
    pub(super) level: Option<i32>,
}

/// m/s.
#[derive(Clone, PartialEq, Message)]
pub(super) struct EnuVelocity {
    #[prost(double, optional, tag = "1")]
    pub(super) east_rate: Option<f64>,
    #[prost(double, optional, tag = "2")]
    pub(super) north_rate: Option<f64>,
    #[prost(double, optional, tag = "3")]
    pub(super) up_rate: Option<f64>,
    #[prost(double, optional, tag = "4")]
    pub(super) east_rate_error: Option<f64>,
    #[prost(double, optional, tag = "5")]
    pub(super) north_rate_error: Option<f64>,
    #[prost(double, optional, tag = "6")]
    pub(super) up_rate_error: Option<f64>,
}

/// Of a task, what says which it is; what it wants is told by the fields that are not read here.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Task {
    #[prost(string, optional, tag = "1")]
    pub(super) task_id: Option<String>,
    #[prost(message, optional, tag = "8")]
    pub(super) command: Option<Command>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct Command {
    /// For example `Registration`, `Status`, `Reset`.
    #[prost(string, optional, tag = "1")]
    pub(super) request: Option<String>,
    #[prost(string, optional, tag = "5")]
    pub(super) mode_change: Option<String>,
}

pub(super) const TASK_REJECTED: i32 = 2;
pub(super) const TASK_COMPLETED: i32 = 3;

#[derive(Clone, PartialEq, Message)]
pub(super) struct TaskAck {
    #[prost(string, optional, tag = "1")]
    pub(super) task_id: Option<String>,
    #[prost(int32, optional, tag = "2")]
    pub(super) task_status: Option<i32>,
    #[prost(string, repeated, tag = "5")]
    pub(super) reason: Vec<String>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct ErrorReport {
    #[prost(string, repeated, tag = "3")]
    pub(super) error_message: Vec<String>,
}
