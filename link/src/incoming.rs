//! The process `link-in`: publishes what the same site says on another host.

use std::process::ExitCode;
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use anyhow::Context;
use common::config::ChainConfig;
use common::health::{Intake, Reject, Rejected};
use common::ipc::{Publisher, Station, count_intake};
use common::message::{END_OF_STREAM, Header, Place};
use common::messages::{ForTopic, Message};
use common::process::{HealthReporter, StageArgs, new_session, say, stop_requested, tell};
use common::realtime;
use common::recording::container;
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::{LINK_IN, driving, maker};
use zenoh::bytes::ZBytes;

use crate::arrivals::{Arrival, Arrivals};
use crate::clock::Offset;
use crate::envelope::{Answer, Envelope, Refused, pack, unpack};
use crate::network::{End, Way};

/// Name of the process.
pub const NAME: &str = LINK_IN;
/// How long the process sleeps at most: signals are obeyed and health is reported meanwhile.
const LONGEST_SLEEP: Duration = Duration::from_millis(50);
/// Nothing received for so long is worth a word.
const SILENCE: Duration = Duration::from_secs(5);

/// Runs the process until the stream of the other host ends or it is asked to stop.
///
/// # Errors
/// Configuration, network or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let refused = realtime::apply(chain.realtime.of(NAME));
    let station = Station::enter(NAME, &chain)?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    let mut outlets = Vec::new();
    for &topic in &chain.link.receive {
        let has_upstream = maker(topic).is_none_or(|(_, upstream)| chain.link.receive.contains(&upstream));
        outlets.push(topic.apply(Open { station: &station, has_upstream })?);
    }
    reporter.publish()?;
    for outlet in &outlets {
        outlet.wait_for_consumers()?;
    }
    let mut receiver = Receiver::new(&chain, session, outlets);
    let way = Way::open(&chain, End::In)?;
    let mut has_ended = false;
    while !has_ended && !stop_requested() {
        match way.inbox.recv_timeout(LONGEST_SLEEP) {
            Ok(received) => {
                has_ended = receiver.take(&received.label, &received.content)?;
                while !has_ended && let Ok(received) = way.inbox.try_recv() {
                    has_ended = receiver.take(&received.label, &received.content)?;
                }
            }
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
        }
        if let Some(answer) = receiver.answer() {
            way.send(pack(&answer), ZBytes::new());
        }
        receiver.say_news();
        if reporter.is_due() {
            receiver.describe(&mut reporter);
            reporter.publish()?;
        }
    }
    receiver.describe(&mut reporter);
    reporter.health.ended = 1;
    reporter.publish()?;
    receiver.summarise();
    receiver.outlets.iter().for_each(|outlet| outlet.linger());
    way.close();
    Ok(ExitCode::SUCCESS)
}

/// A topic that is received.
trait Outlet {
    fn topic(&self) -> Topic;
    /// Publishes a message of another host, with stamps of this host's clock.
    fn publish(&mut self, bytes: &[u8], offset: Option<Offset>) -> anyhow::Result<Result<Published, String>>;
    fn intake(&self) -> Intake;
    fn wait_for_consumers(&self) -> anyhow::Result<()>;
    fn linger(&self);
}

/// What has been published.
struct Published {
    place: Place,
    elements: usize,
}

struct Of<M: Message> {
    publisher: Publisher<M>,
    /// Whether what its messages were made from comes here, too.
    has_upstream: bool,
    intake: Intake,
    session: u64,
}

struct Open<'a> {
    station: &'a Station,
    has_upstream: bool,
}

impl ForTopic for Open<'_> {
    type Out = anyhow::Result<Box<dyn Outlet>>;

    fn call<M: Message>(self) -> Self::Out {
        let (publisher, has_upstream) = (self.station.publisher::<M>(M::MOST)?, self.has_upstream);
        Ok(Box::new(Of { publisher, has_upstream, intake: Intake::default(), session: 0 }))
    }
}

impl<M: Message> Outlet for Of<M> {
    fn topic(&self) -> Topic {
        M::TOPIC
    }

    fn publish(&mut self, bytes: &[u8], offset: Option<Offset>) -> anyhow::Result<Result<Published, String>> {
        let (mut header, elements) = match container::decode::<M>(bytes) {
            Ok((_, elements)) if elements.len() > M::MOST => {
                return Ok(Err(format!("{} elements, expected at most {}", elements.len(), M::MOST)));
            }
            Ok(message) => message,
            Err(error) => return Ok(Err(error)),
        };
        header.each_stamp(&mut |stamp| match offset {
            Some(offset) => offset.translate(stamp),
            None => *stamp = 0, // a time of an unknown clock is no time
        });
        if !self.has_upstream {
            header.forget_upstream();
        }
        let published = self.publisher.publish(&header, &elements, |_| {});
        published.with_context(|| format!("publishing {}", M::TOPIC.name()))?;
        let place = header.place();
        count_intake(&mut self.intake, &mut self.session, place.session, place.seq);
        Ok(Ok(Published { place, elements: elements.len() }))
    }

    fn intake(&self) -> Intake {
        self.intake
    }

    fn wait_for_consumers(&self) -> anyhow::Result<()> {
        Ok(self.publisher.wait_for_consumers()?)
    }

    fn linger(&self) {
        self.publisher.linger();
    }
}

/// What has come, and from whom.
struct Receiver {
    site: String,
    own: u64,
    outlets: Vec<Box<dyn Outlet>>,
    /// The topic whose end is the end of the site.
    driving: Topic,
    arrivals: Arrivals,
    /// The envelope to answer: session, its time, and when it came.
    to_answer: Option<[u64; 3]>,
    offset: Option<Offset>,
    heard: Instant,
    is_silent: bool,
    restarts: u64,
    rejected: Rejected,
    refused: Option<Refused>,
    messages: u64,
    elements: u64,
    scan: u32,
}

impl Receiver {
    fn new(chain: &ChainConfig, own: u64, outlets: Vec<Box<dyn Outlet>>) -> Self {
        Self {
            site: chain.site.name.clone(),
            own,
            outlets,
            driving: driving(chain),
            arrivals: Arrivals::default(),
            to_answer: None,
            offset: None,
            heard: Instant::now(),
            is_silent: false,
            restarts: 0,
            rejected: Rejected::default(),
            refused: None,
            messages: 0,
            elements: 0,
            scan: 0,
        }
    }

    /// Takes what has come; whether that is the end.
    fn take(&mut self, label: &[u8], content: &ZBytes) -> anyhow::Result<bool> {
        let received_ns = monotonic_ns();
        let envelope: Envelope = match unpack(label) {
            Ok(envelope) => envelope,
            Err(refused) => {
                self.refuse(refused);
                return Ok(false);
            }
        };
        self.heard = Instant::now();
        self.offset = envelope.offset;
        self.to_answer = Some([envelope.session, envelope.sent_ns, received_ns]);
        if self.arrivals.take(&envelope) != Arrival::Next {
            return Ok(false);
        }
        let Some(enclosed) = envelope.message else { return Ok(false) };
        let bytes = content.to_bytes();
        match enclosed.check(&bytes) {
            Ok(topic) => self.publish(topic, &bytes),
            Err(refused) => {
                self.refuse(refused);
                Ok(false)
            }
        }
    }

    fn publish(&mut self, topic: Topic, bytes: &[u8]) -> anyhow::Result<bool> {
        let offset = self.offset;
        // The other host may send more than this one wants.
        let Some(outlet) = self.outlets.iter_mut().find(|outlet| outlet.topic() == topic) else { return Ok(false) };
        match outlet.publish(bytes, offset)? {
            Ok(Published { place, elements }) => {
                self.messages += u64::from(topic == self.driving);
                self.elements += if topic == self.driving { elements as u64 } else { 0 };
                self.scan = place.scan.unwrap_or(self.scan);
                Ok(topic == self.driving && place.flags & END_OF_STREAM != 0)
            }
            Err(error) => {
                self.refuse(Refused::Garbage(error));
                Ok(false)
            }
        }
    }

    /// Counts, and says each kind once in a row.
    fn refuse(&mut self, refused: Refused) {
        self.rejected.count_many(Reject::BadHeader, 1);
        if self.refused.as_ref() != Some(&refused) {
            say(&format!("link of site {}: refused: {refused}", self.site));
            self.refused = Some(refused);
        }
    }

    fn answer(&mut self) -> Option<Answer> {
        let [session, sent_ns, received_ns] = self.to_answer.take()?;
        Some(Answer {
            session,
            receiver: self.own,
            next: self.arrivals.next(),
            gap: self.arrivals.has_gap(),
            sent_ns,
            received_ns,
            answered_ns: monotonic_ns(),
        })
    }

    fn describe(&self, reporter: &mut HealthReporter) {
        let health = &mut reporter.health;
        for outlet in &self.outlets {
            health.set_intake(outlet.topic(), outlet.intake());
        }
        health.set_rejected(&self.rejected);
        (health.messages_out, health.elements_out, health.scan) = (self.messages, self.elements, self.scan);
        health.clock_uncertainty_us = self.offset.map_or(0.0, |offset| offset.uncertainty_ns as f32 / 1e3);
    }

    fn say_news(&mut self) {
        let site = &self.site;
        let is_silent = self.heard.elapsed() > SILENCE;
        if std::mem::replace(&mut self.is_silent, is_silent) != is_silent {
            say(&if is_silent {
                format!("link of site {site}: nothing has come from the other host for {} s", SILENCE.as_secs())
            } else {
                format!("link of site {site}: the other host is heard, {} messages lost", self.arrivals.lost())
            });
        }
        if self.arrivals.restarts() > self.restarts {
            self.restarts = self.arrivals.restarts();
            say(&format!("link of site {site}: the sender has been started again"));
        }
    }

    fn summarise(&self) {
        let (lost, repeated) = (self.arrivals.lost(), self.arrivals.repeated());
        let clocks = self.offset.map_or("unknown".into(), |offset| {
            format!("{:.6} s ± {:.0} µs", offset.offset_ns as f64 / 1e9, offset.uncertainty_ns as f64 / 1e3)
        });
        let (site, messages) = (&self.site, self.arrivals.next());
        tell(&format!(
            "link of site {site}: {messages} messages, {lost} lost, {repeated} came again; this clock minus the other: {clocks}"
        ));
    }
}
