//! The process `link-out`: sends chosen topics of a site to another host.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use common::config::{ChainConfig, Mode};
use common::health::{Intake, Reject, Rejected};
use common::ipc::{Flow, Station, Subscriber, Turn, attend};
use common::message::{END_OF_STREAM, Header};
use common::messages::{ForTopic, Message};
use common::process::{HealthReporter, StageArgs, new_session, say, stop_requested, tell};
use common::realtime;
use common::recording::container;
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::LINK_OUT;
use zenoh::bytes::ZBytes;

use crate::clock::OtherClock;
use crate::envelope::{Answer, Enclosed, Envelope, pack, unpack};
use crate::network::{End, Way};
use crate::window::Window;

/// Name of the process.
pub const NAME: &str = LINK_OUT;
/// How often the other side hears how far this one is, also without messages.
const BEAT: Duration = Duration::from_millis(100);
/// Nothing answered for so long is worth a word.
const SILENCE: Duration = Duration::from_secs(5);
/// How long the end of the stream is sent again and again to somebody who does not answer.
const LAST_WAIT: Duration = Duration::from_secs(5);
/// The longest sleep while the other side has to make room.
const WAIT_FOR_ROOM: Duration = Duration::from_millis(1);

/// Runs the process until what it sends has ended or it is asked to stop.
///
/// # Errors
/// Configuration, network or shared memory.
pub fn run(args: &StageArgs) -> anyhow::Result<ExitCode> {
    let chain = args.load()?;
    let refused = realtime::apply(chain.realtime.of(NAME));
    let way = Way::open(&chain, End::Out)?;
    let station = Station::enter(NAME, &chain)?;
    let session = new_session();
    let mut reporter = HealthReporter::new(&station, &chain, session, refused)?;
    // Causes before effects, as in a recording.
    let topics = [Topic::Truth, Topic::Plots, Topic::Tracks, Topic::SystemTracks];
    let mut inputs = Vec::new();
    for topic in topics.into_iter().filter(|topic| chain.link.send.contains(topic)) {
        inputs.push(topic.apply(Open(&station))?);
    }
    let wakes = inputs.iter().map(|input| station.wake(input.topic())).collect::<Result<Vec<_>, _>>()?;
    let wakes: Vec<_> = wakes.iter().collect();
    let mut sender = Sender::new(way, &chain, session);
    let mut ending = None::<Instant>;

    let watchdog = reporter.watchdog();

    attend(&wakes, &watchdog, || -> anyhow::Result<Flow> {
        let turn = Turn::begin();
        sender.hear();
        let is_stopping = stop_requested();
        let mut taken = true;
        while std::mem::take(&mut taken) && !turn.is_over() {
            for input in &mut inputs {
                if sender.may_take(is_stopping) && input.take(&mut sender)? {
                    taken = true;
                }
            }
            sender.send();
        }
        let ended = inputs.iter().all(|input| input.has_ended(is_stopping)) && !turn.is_over();
        let asked = ended.then(|| *ending.get_or_insert_with(Instant::now));
        let done = asked.is_some_and(|since| sender.window.is_empty() || sender.gives_up(is_stopping, since));
        sender.beat(done);
        if done || reporter.is_due() {
            let health = &mut reporter.health;
            for input in &inputs {
                health.set_intake(input.topic(), input.intake());
                health.set_waiting(input.topic(), input.take_most_waiting());
            }
            let mut rejected = Rejected::default();
            rejected.count_many(Reject::Full, sender.window.given_up());
            health.set_rejected(&rejected);
            (health.messages_out, health.scan) = (sender.window.end(), sender.scan);
            health.clock_uncertainty_us = sender.clock_uncertainty_us();
            health.ended = u32::from(done);
            reporter.publish()?;
        }
        sender.say_news();
        watchdog.hold_up(sender.waits_for_room());
        Ok(match (done, sender.waits_for_room() || ended) {
            (true, _) => Flow::End,
            (false, true) => {
                sender.wait_for_an_answer(WAIT_FOR_ROOM);
                Flow::Again
            }
            (false, false) => turn.flow(),
        })
    })?;
    sender.close();
    Ok(ExitCode::SUCCESS)
}

/// A topic that is sent.
trait Input {
    fn topic(&self) -> Topic;
    /// Takes the next message, if there is one.
    fn take(&mut self, sender: &mut Sender) -> anyhow::Result<bool>;
    /// Whether no more will come.
    fn has_ended(&self, is_stopping: bool) -> bool;
    fn intake(&self) -> Intake;
    fn take_most_waiting(&self) -> Option<u32>;
}

struct Of<M: Message> {
    subscriber: Subscriber<M>,
    has_seen_end: bool,
    has_heard: bool,
}

struct Open<'a>(&'a Station);

impl ForTopic for Open<'_> {
    type Out = anyhow::Result<Box<dyn Input>>;

    fn call<M: Message>(self) -> Self::Out {
        Ok(Box::new(Of { subscriber: self.0.subscriber::<M>()?, has_seen_end: false, has_heard: false }))
    }
}

impl<M: Message> Input for Of<M> {
    fn topic(&self) -> Topic {
        M::TOPIC
    }

    fn take(&mut self, sender: &mut Sender) -> anyhow::Result<bool> {
        let Some(message) = self.subscriber.receive()? else { return Ok(false) };
        let place = message.header().place();
        let mut bytes = Vec::new();
        container::encode(M::borrowed(message.header(), message.elements()), &mut bytes)?;
        sender.keep(M::TOPIC, bytes);
        sender.scan = place.scan.unwrap_or(sender.scan);
        self.has_seen_end |= place.flags & END_OF_STREAM != 0;
        self.has_heard = true;
        Ok(true)
    }

    fn has_ended(&self, is_stopping: bool) -> bool {
        // Truth has no mark of its own at the end: it ends with its publisher.
        self.has_seen_end || (is_stopping || self.has_heard) && self.subscriber.publishers() == 0
    }

    fn intake(&self) -> Intake {
        self.subscriber.intake()
    }

    fn take_most_waiting(&self) -> Option<u32> {
        self.subscriber.take_most_waiting()
    }
}

/// A message as it is kept until it is confirmed.
#[derive(Clone)]
struct Kept {
    enclosed: Enclosed,
    bytes: ZBytes,
}

/// What is to be sent, and what is known of the other side.
struct Sender {
    way: Way,
    site: String,
    is_lossless: bool,
    session: u64,
    window: Window<Kept>,
    clock: OtherClock,
    receiver: Option<u64>,
    answered: Instant,
    is_silent: bool,
    beaten: Option<Instant>,
    scan: u32,
}

impl Sender {
    fn new(way: Way, chain: &ChainConfig, session: u64) -> Self {
        Self {
            way,
            site: chain.site.name.clone(),
            is_lossless: chain.run.mode == Mode::Lossless,
            session,
            window: Window::new(chain.link.window as usize),
            clock: OtherClock::default(),
            receiver: None,
            answered: Instant::now(),
            is_silent: false,
            beaten: None,
            scan: 0,
        }
    }

    /// Whether a message may be taken: in lossless mode not before there is room for it, unless the chain is to end and nobody
    /// answers.
    fn may_take(&self, is_stopping: bool) -> bool {
        !self.is_lossless || self.window.has_room() || is_stopping && self.answered.elapsed() > LAST_WAIT
    }

    /// Whether what has ended is no longer sent: in lossless mode not before the chain is to end and nobody answers.
    fn gives_up(&self, is_stopping: bool, ended: Instant) -> bool {
        let is_silent = self.answered.elapsed() > LAST_WAIT;
        if self.is_lossless { is_stopping && is_silent } else { ended.elapsed() > LAST_WAIT }
    }

    fn waits_for_room(&self) -> bool {
        self.is_lossless && !self.window.has_room()
    }

    fn keep(&mut self, topic: Topic, bytes: Vec<u8>) {
        let (enclosed, length) = (Enclosed::new(topic, &bytes), bytes.len());
        self.window.push(Kept { enclosed, bytes: ZBytes::from(bytes) }, length);
    }

    /// Sends what may go on the way.
    fn send(&mut self) {
        let now_ns = monotonic_ns();
        while let Some((number, kept)) = self.window.next_to_send(now_ns) {
            let envelope = self.envelope(number, Some(kept.enclosed));
            self.way.send(pack(&envelope), kept.bytes);
        }
    }

    /// Says how far it is, when it is time or `now`.
    fn beat(&mut self, now: bool) {
        if now || self.beaten.is_none_or(|beaten| beaten.elapsed() >= BEAT) {
            self.beaten = Some(Instant::now());
            self.way.send(pack(&self.envelope(self.window.end(), None)), ZBytes::new());
            self.send();
        }
    }

    fn envelope(&self, number: u64, message: Option<Enclosed>) -> Envelope {
        let sent_ns = monotonic_ns();
        let offset = self.clock.offset(sent_ns);
        Envelope { session: self.session, number, oldest: self.window.oldest(), sent_ns, offset, message }
    }

    /// Takes the answers that have come.
    fn hear(&mut self) {
        while let Ok(received) = self.way.inbox.try_recv() {
            self.note(&received.label);
        }
    }

    fn wait_for_an_answer(&mut self, longest: Duration) {
        if let Ok(received) = self.way.inbox.recv_timeout(longest) {
            self.note(&received.label);
        }
    }

    fn note(&mut self, label: &[u8]) {
        let came_ns = monotonic_ns();
        // Whatever else is sent under this key is no answer; an answer to the sender before this one is none to this one.
        let Ok(answer) = unpack::<Answer>(label) else { return };
        if answer.session != self.session {
            return;
        }
        self.answered = Instant::now();
        if let Some(before) = self.receiver.replace(answer.receiver)
            && before != answer.receiver
        {
            self.clock.forget();
            say(&format!("link of site {}: another receiver answers", self.site));
        }
        self.clock.note([answer.sent_ns, answer.received_ns, answer.answered_ns, came_ns]);
        self.window.confirm(answer.next, answer.gap, came_ns);
    }

    fn say_news(&mut self) {
        let is_silent = self.answered.elapsed() > SILENCE;
        if std::mem::replace(&mut self.is_silent, is_silent) != is_silent {
            let site = &self.site;
            say(&if is_silent {
                format!("link of site {site}: the other host has not answered for {} s", SILENCE.as_secs())
            } else {
                format!("link of site {site}: the other host answers, {} messages given up", self.window.given_up())
            });
        }
    }

    fn clock_uncertainty_us(&self) -> f32 {
        let offset = self.clock.offset(monotonic_ns());
        offset.map_or(0.0, |offset| offset.uncertainty_ns as f32 / 1e3)
    }

    fn close(self) {
        let (sent, again, given_up) = (self.window.end(), self.window.sent_again(), self.window.given_up());
        let unconfirmed = sent - self.window.oldest();
        tell(&format!(
            "link of site {}: {sent} messages, {again} sent again, {given_up} given up, {unconfirmed} not confirmed",
            self.site
        ));
        self.way.close();
    }
}
