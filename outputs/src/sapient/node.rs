//! The node: what it says when.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use common::config::{OutputConfig, TargetClass};
use common::process::{BadInput, say, tell};
use ulid::Ulid;
use uuid::Uuid;

use super::framing::{self, Incoming};
use super::messages::{
    Classification, Content, DetectionReport, EnuVelocity, INFO_NEW, INFO_UNCHANGED, LAT_LNG_DEG_M, Location,
    SYSTEM_GOODBYE, SYSTEM_OK, SYSTEM_WARNING, SapientMessage, StatusReport, SubClass, TASK_COMPLETED, TASK_REJECTED,
    Task, TaskAck, Timestamp, TrackInfo, WGS84_E,
};
use super::registration::{MODE, class_of, registration};
use crate::format::{Format, Frames, Update};
use crate::targets::{Site, Target};

/// Metres in a degree of latitude: errors of places are in the unit of the places.
const DEGREE_M: f64 = 111_320.0;
/// Without tracks for so long, the node says that something is amiss.
const SILENCE: Duration = Duration::from_secs(10);

/// A peer that has not answered a registration for so long is reconnected to.
const PATIENCE: Duration = Duration::from_secs(30);

/// How far the registration has come on this connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Standing {
    Apart,
    /// It waits for the first tracks: with them the latency is known.
    Connected,
    Asked {
        since: SystemTime,
    },
    Accepted,
    Refused,
}

/// An edge node for the tracks of one site.
#[derive(Debug)]
pub struct EdgeNode {
    site: Site,
    node_id: String,
    class: TargetClass,
    status_s: f64,
    standing: Standing,
    incoming: Incoming,
    answers: Vec<Content>,
    /// Tells reports of one start of the process from those of another.
    session: u64,
    reports: u64,
    latency_ns: u64,
    /// Tracks have come since the last tick.
    has_news: bool,
    tracks_at: Option<SystemTime>,
    status_at: Option<SystemTime>,
    last_system: Option<i32>,
    not_said: u64,
    held_back: u64,
}

fn since_1970(time: SystemTime) -> Duration {
    time.duration_since(UNIX_EPOCH).unwrap_or_default()
}

impl EdgeNode {
    /// Of a site; `session` is a number that no earlier start had.
    ///
    /// # Errors
    /// [`BadInput`]: `node_id` of the configuration is no UUID.
    pub fn new(name: &str, config: &OutputConfig, site: &Site, session: u64) -> Result<Self, BadInput> {
        let place = site.position.map_or_else(String::new, |at| format!("{}/{}", at.latitude_deg, at.longitude_deg));
        let own = || Uuid::new_v5(&Uuid::NAMESPACE_OID, format!("radar-chain/{}/{place}", site.name).as_bytes());
        let node_id = if config.node_id.is_empty() {
            own()
        } else {
            let refuse = |_| BadInput(format!("key `outputs.{name}.node_id` is {}, expected a UUID", config.node_id));
            Uuid::parse_str(&config.node_id).map_err(refuse)?
        };
        Ok(Self {
            site: site.clone(),
            node_id: node_id.to_string(),
            class: config.class,
            status_s: config.status_s,
            standing: Standing::Apart,
            incoming: Incoming::default(),
            answers: Vec::new(),
            session,
            reports: 0,
            latency_ns: 0,
            has_news: false,
            tracks_at: None,
            status_at: None,
            last_system: None,
            not_said: 0,
            held_back: 0,
        })
    }

    fn send(&self, at: Duration, content: Content, out: &mut Frames) {
        let message = SapientMessage {
            timestamp: Some(Timestamp { seconds: at.as_secs() as i64, nanos: at.subsec_nanos() as i32 }),
            node_id: Some(self.node_id.clone()),
            destination_id: None,
            content: Some(content),
        };
        let _ = out.frame(|octets| {
            framing::write(&message, octets);
            Ok::<(), ()>(())
        });
    }

    /// An identity that no other report has.
    fn report_id(&mut self, at: Duration) -> String {
        self.reports += 1;
        let rest = u128::from(self.session) << 16 | u128::from(self.reports & 0xffff);
        Ulid::from_parts(at.as_millis() as u64, rest).to_string()
    }

    fn detection(&mut self, target: &Target<'_>) -> Option<DetectionReport> {
        let place = target.place?;
        let has_height = target.has_height();
        let [east_mps, north_mps, up_mps] = target.track.velocity_mps();
        let (class, sub_class) = class_of(self.class);
        let object = u128::from(self.site.source_id) << 64 | u128::from(target.track.id);
        let longitude_m = DEGREE_M * place.latitude_deg.to_radians().cos().max(1e-6);
        Some(DetectionReport {
            report_id: Some(self.report_id(Duration::from_nanos(target.time_ns))),
            // The start of the tracker and the number of the track: the same also when this process begins anew.
            object_id: Some(Ulid::from_parts(target.session / 1_000_000, object).to_string()),
            state: target.has_ended().then(|| "lost".to_string()),
            location: Some(Location {
                x: Some(place.longitude_deg),
                y: Some(place.latitude_deg),
                z: has_height.then_some(place.height_m),
                x_error: Some(target.sigma(0) / longitude_m),
                y_error: Some(target.sigma(3) / DEGREE_M),
                z_error: has_height.then(|| target.sigma(6)),
                coordinate_system: Some(LAT_LNG_DEG_M),
                datum: Some(WGS84_E),
            }),
            detection_confidence: Some(target.track.existence.clamp(0.0, 1.0) as f32),
            track_info: vec![TrackInfo { r#type: Some("state".into()), value: Some(target.state().into()) }],
            classification: vec![Classification {
                r#type: Some(class.into()),
                sub_class: sub_class
                    .map(|name| SubClass { r#type: Some(name.into()), level: Some(1) })
                    .into_iter()
                    .collect(),
            }],
            enu_velocity: Some(EnuVelocity {
                east_rate: Some(east_mps),
                north_rate: Some(north_mps),
                up_rate: has_height.then_some(up_mps),
                east_rate_error: Some(target.sigma(1)),
                north_rate_error: Some(target.sigma(4)),
                up_rate_error: has_height.then(|| target.sigma(7)),
            }),
        })
    }

    fn status(&mut self, at: Duration, system: i32) -> StatusReport {
        let is_new = self.last_system.replace(system) != Some(system);
        StatusReport {
            report_id: Some(self.report_id(at)),
            system: Some(system),
            info: Some(if is_new { INFO_NEW } else { INFO_UNCHANGED }),
            mode: Some(MODE.into()),
            node_location: self.site.position.map(|position| Location {
                x: Some(position.longitude_deg),
                y: Some(position.latitude_deg),
                z: Some(position.height_m),
                coordinate_system: Some(LAT_LNG_DEG_M),
                datum: Some(WGS84_E),
                ..Location::default()
            }),
        }
    }

    /// Does what the other side asks for.
    fn answer(&mut self, content: Content) {
        match content {
            Content::RegistrationAck(ack) if ack.acceptance == Some(true) => {
                self.standing = Standing::Accepted;
                (self.status_at, self.last_system) = (None, None);
                tell(&format!("sapient: node {} is registered", self.node_id));
            }
            Content::RegistrationAck(ack) => {
                self.standing = Standing::Refused;
                say(&format!("sapient: the registration is refused: {}", ack.ack_response_reason.join("; ")));
            }
            Content::Task(task) => {
                let answer = Content::TaskAck(self.acknowledge(&task));
                self.answers.push(answer);
            }
            Content::Error(error) => {
                self.not_said += 1;
                tell(&format!("sapient: the other side found an error: {}", error.error_message.join("; ")));
            }
            _ => {}
        }
    }

    /// The mode there is and requests for what is sent anyhow are fulfilled; a radar that turns cannot do more.
    fn acknowledge(&mut self, task: &Task) -> TaskAck {
        let command = task.command.clone().unwrap_or_default();
        let done = match (command.request.as_deref(), command.mode_change.as_deref()) {
            (Some("Registration"), _) => {
                self.standing = Standing::Connected;
                true
            }
            (Some("Status"), _) => {
                self.status_at = None;
                true
            }
            (None, Some(MODE)) => true,
            _ => false,
        };
        let reason = "this node turns and tracks: it has one mode and takes no regions".to_string();
        TaskAck {
            task_id: task.task_id.clone(),
            task_status: Some(if done { TASK_COMPLETED } else { TASK_REJECTED }),
            reason: if done { Vec::new() } else { vec![reason] },
        }
    }
}

impl Format for EdgeNode {
    fn tracks(&mut self, update: &Update<'_>, out: &mut Frames) {
        self.latency_ns = self.latency_ns.max(update.latency_ns);
        self.has_news = true;
        if self.standing != Standing::Accepted {
            self.held_back += update.targets.len() as u64;
            return;
        }
        for target in update.targets {
            match self.detection(target) {
                Some(report) => {
                    self.send(Duration::from_nanos(target.time_ns), Content::DetectionReport(report), out);
                }
                None => self.not_said += 1,
            }
        }
    }

    fn opened(&mut self) {
        self.standing = Standing::Connected;
        self.incoming.clear();
        self.answers.clear();
    }

    fn heard(&mut self, octets: &[u8]) {
        for message in self.incoming.take(octets) {
            match message {
                Ok(message) => message.content.into_iter().for_each(|content| self.answer(content)),
                Err(error) => say(&format!("sapient: what the other side says is no message: {error}")),
            }
        }
    }

    fn is_useless(&self, now: SystemTime) -> Option<&'static str> {
        match self.standing {
            Standing::Apart => None,
            _ if self.incoming.is_lost() => Some("what it says cannot be told apart into messages"),
            Standing::Asked { since } if now.duration_since(since).is_ok_and(|waited| waited > PATIENCE) => {
                Some("no answer to the registration")
            }
            _ => None,
        }
    }

    fn tick(&mut self, now: SystemTime, out: &mut Frames) {
        let at = since_1970(now);
        if std::mem::take(&mut self.has_news) {
            self.tracks_at = Some(now);
        }
        if self.standing == Standing::Connected && self.tracks_at.is_some() {
            let registration = registration(&self.site, self.class, self.status_s, self.latency_ns);
            self.send(at, Content::Registration(registration), out);
            self.standing = Standing::Asked { since: now };
        }
        for answer in std::mem::take(&mut self.answers) {
            self.send(at, answer, out);
        }
        let since = |time: SystemTime| now.duration_since(time).unwrap_or_default();
        let is_due = self.status_at.is_none_or(|last| since(last).as_secs_f64() >= self.status_s);
        if self.standing == Standing::Accepted && is_due {
            self.status_at = Some(now);
            let is_silent = self.tracks_at.is_none_or(|last| since(last) > SILENCE);
            let status = self.status(at, if is_silent { SYSTEM_WARNING } else { SYSTEM_OK });
            self.send(at, Content::StatusReport(status), out);
        }
    }

    fn close(&mut self, now: SystemTime, out: &mut Frames) {
        if self.standing == Standing::Accepted {
            let at = since_1970(now);
            let status = self.status(at, SYSTEM_GOODBYE);
            self.send(at, Content::StatusReport(status), out);
            self.standing = Standing::Apart; // nothing comes after it
        }
    }

    fn held_back(&self) -> u64 {
        self.held_back
    }

    fn not_said(&self) -> u64 {
        self.not_said
    }
}

#[cfg(test)]
mod tests {
    use super::super::messages::{Command, RegistrationAck, UNITS_MILLISECONDS};
    use super::*;
    use crate::origins::Origins;
    use crate::targets::tests::{NOON_NS, site, targets, track, update};
    use common::tracks::{CONFIRMED, Track};

    const NOW: SystemTime = UNIX_EPOCH;

    fn node() -> EdgeNode {
        EdgeNode::new("sapient", &OutputConfig::default(), &site(), 17).expect("a node")
    }

    fn contents(frames: &Frames) -> Vec<Content> {
        let mut incoming = Incoming::default();
        let messages = frames.iter().flat_map(|frame| incoming.take(frame)).collect::<Vec<_>>();
        messages.into_iter().filter_map(|message| message.expect("a message").content).collect()
    }

    fn tracks(node: &mut EdgeNode, tracks: &[Track]) -> Vec<Content> {
        let (site, targets) = (site(), targets(tracks));
        let origins = Origins::default();
        let update = Update { latency_ns: 2_500_000, ..update(&site, &targets, &origins) };
        let mut frames = Frames::default();
        node.tracks(&update, &mut frames);
        contents(&frames)
    }

    fn tick(node: &mut EdgeNode, now: SystemTime) -> Vec<Content> {
        let mut frames = Frames::default();
        node.tick(now, &mut frames);
        contents(&frames)
    }

    fn hear(node: &mut EdgeNode, content: Content) {
        let mut octets = Vec::new();
        framing::write(&SapientMessage { content: Some(content), ..SapientMessage::default() }, &mut octets);
        node.heard(&octets);
    }

    fn accept(node: &mut EdgeNode) {
        hear(node, Content::RegistrationAck(RegistrationAck { acceptance: Some(true), ack_response_reason: vec![] }));
    }

    #[test]
    fn nothing_is_reported_before_the_registration_is_accepted() {
        let mut node = node();
        let seen = [track(7, NOON_NS, CONFIRMED)];
        assert_eq!(tick(&mut node, NOW), []);
        node.opened();
        assert_eq!(tick(&mut node, NOW), [], "the latency is not known yet");
        assert_eq!(tracks(&mut node, &seen), []);
        let said = tick(&mut node, NOW);
        let [Content::Registration(registration)] = &said[..] else { panic!("{said:?}") };
        let latency = registration.mode_definition[0].maximum_latency.expect("a latency");
        assert_eq!((latency.units, latency.value), (Some(UNITS_MILLISECONDS), Some(2.5)));
        assert_eq!((tick(&mut node, NOW), tracks(&mut node, &seen)), (vec![], vec![]));
        accept(&mut node);
        assert!(matches!(tick(&mut node, NOW)[..], [Content::StatusReport(_)]));
        assert!(matches!(tracks(&mut node, &seen)[..], [Content::DetectionReport(_)]));
        node.opened();
        assert_eq!(tracks(&mut node, &seen), [], "a new connection begins anew");
        assert_eq!(node.held_back(), 3);
    }

    #[test]
    fn a_connection_without_sense_or_answer_is_of_no_use() {
        let mut node = node();
        assert_eq!(node.is_useless(NOW), None);
        node.opened();
        tracks(&mut node, &[]);
        tick(&mut node, NOW);
        assert_eq!(node.is_useless(NOW + Duration::from_secs(29)), None);
        assert!(node.is_useless(NOW + Duration::from_secs(31)).is_some());
        node.heard(&[0xff; 10]);
        assert!(node.is_useless(NOW).is_some());
        node.opened();
        assert_eq!(node.is_useless(NOW), None);
    }

    #[test]
    fn an_object_keeps_its_identity_and_reports_have_their_own() {
        let mut node = node();
        node.opened();
        node.standing = Standing::Accepted;
        let said =
            [NOON_NS, NOON_NS + 1].map(|time_ns| match tracks(&mut node, &[track(7, time_ns, CONFIRMED)]).pop() {
                Some(Content::DetectionReport(report)) => report,
                other => panic!("{other:?}"),
            });
        assert_eq!(said[0].object_id, said[1].object_id);
        assert_ne!(said[0].report_id, said[1].report_id);
        let other = tracks(&mut node, &[track(8, NOON_NS, CONFIRMED)]);
        let [Content::DetectionReport(other)] = &other[..] else { panic!("{other:?}") };
        assert_ne!(other.object_id, said[0].object_id);
        let location = said[0].location.clone().expect("a place");
        assert!((location.y_error.expect("an error") * DEGREE_M - 9.0).abs() < 1e-9);
    }

    #[test]
    fn tasks_are_answered_and_status_comes_when_it_is_due() {
        let mut node = node();
        node.opened();
        node.standing = Standing::Accepted;
        let status = |said: &[Content]| match said {
            [Content::StatusReport(report)] => (report.system, report.info),
            other => panic!("{other:?}"),
        };
        tracks(&mut node, &[]);
        let now = SystemTime::now();
        assert_eq!(status(&tick(&mut node, now)), (Some(SYSTEM_OK), Some(INFO_NEW)));
        assert_eq!(tick(&mut node, now + Duration::from_secs(4)), []);
        assert_eq!(status(&tick(&mut node, now + Duration::from_secs(5))), (Some(SYSTEM_OK), Some(INFO_UNCHANGED)));
        let late = now + Duration::from_secs(60);
        assert_eq!(status(&tick(&mut node, late)), (Some(SYSTEM_WARNING), Some(INFO_NEW)));
        let task = |command| Task { task_id: Some("01ARZ3NDEKTSV4RRFFQ69G5FAV".into()), command: Some(command) };
        for (command, expected) in [
            (Command { request: None, mode_change: Some(MODE.into()) }, TASK_COMPLETED),
            (Command { request: Some("Reset".into()), mode_change: None }, TASK_REJECTED),
            (Command::default(), TASK_REJECTED),
        ] {
            hear(&mut node, Content::Task(task(command)));
            let said = tick(&mut node, late);
            let [Content::TaskAck(ack)] = &said[..] else { panic!("{said:?}") };
            assert_eq!((ack.task_status, ack.reason.is_empty()), (Some(expected), expected == TASK_COMPLETED));
        }
        let mut frames = Frames::default();
        node.close(late, &mut frames);
        assert_eq!(status(&contents(&frames)).0, Some(SYSTEM_GOODBYE));
    }

    #[test]
    fn a_node_id_is_a_uuid_and_its_own_where_none_is_given() {
        let config = OutputConfig { node_id: "seven".into(), ..OutputConfig::default() };
        let error = EdgeNode::new("fusion", &config, &site(), 1).expect_err("no UUID").to_string();
        assert_eq!(error, "key `outputs.fusion.node_id` is seven, expected a UUID");
        assert_eq!(node().node_id, node().node_id);
        assert_eq!(node().node_id.len(), 36);
    }

    #[test]
    fn a_refusal_is_final_on_its_connection() {
        let mut node = node();
        node.opened();
        tracks(&mut node, &[]);
        tick(&mut node, NOW);
        hear(&mut node, Content::RegistrationAck(RegistrationAck { acceptance: Some(false), ..Default::default() }));
        assert_eq!((tick(&mut node, NOW), node.standing), (vec![], Standing::Refused));
    }
}
