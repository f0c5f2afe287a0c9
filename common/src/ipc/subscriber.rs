//! Subscribing to one topic.

use std::cell::{Cell, RefCell};

use iceoryx2::port::notifier::Notifier;
use iceoryx2::prelude::*;

use super::IpcError;
use super::intake::count_intake;
use super::services::{DataService, EventService, Ipc};
use crate::health::Intake;
use crate::message::{Header, Place};
use crate::messages::Message;
use crate::topology::Stage;

/// Receives messages of one topic and counts the missing ones.
pub struct Subscriber<M: Message> {
    service: DataService<M>,
    port: iceoryx2::port::subscriber::Subscriber<Ipc, [M::Element], M::Header>,
    intake: RefCell<Intake>,
    session: Cell<u64>,
    /// Tells publishers that a stage has found them; observers tell nobody.
    ready: Option<Notifier<Ipc>>,
    known_publishers: Cell<[u128; MAX_PUBLISHERS]>,
}

/// Publishers of a topic that are told apart.
const MAX_PUBLISHERS: usize = 16;

/// A message in shared memory; it is given back when dropped.
pub struct Received<M: Message> {
    sample: iceoryx2::sample::Sample<Ipc, [M::Element], M::Header>,
    /// Messages missing before this one.
    pub missing: u64,
}

impl<M: Message> Received<M> {
    /// Header of the message.
    pub fn header(&self) -> &M::Header {
        self.sample.user_header()
    }

    /// Elements of the message, in place.
    pub fn elements(&self) -> &[M::Element] {
        self.sample.payload()
    }
}

impl<M: Message> Subscriber<M> {
    pub(super) fn new(service: DataService<M>, ready: &EventService, process: &str) -> Result<Self, IpcError> {
        let name = PortName::new(process).map_err(|cause| Self::failed(&cause))?;
        let port = service.subscriber_builder().name(&name).create().map_err(|cause| Self::failed(&cause))?;
        let notifier = |stage: &Stage| {
            let builder = ready.notifier_builder().default_event_id(EventId::new(stage.number()));
            builder.create().map_err(|cause| Self::failed(&cause))
        };
        let ready = Stage::from_name(process).map(notifier).transpose()?;
        let (intake, session, known_publishers) = (RefCell::default(), Cell::new(0), Cell::default());
        Ok(Self { service, port, intake, session, ready, known_publishers })
    }

    /// The next message, if one is waiting.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn receive(&self) -> Result<Option<Received<M>>, IpcError> {
        let mut received = self.port.receive().map_err(|cause| Self::failed(&cause))?;
        if received.is_none() {
            let publishers = self.publisher_ids();
            if publishers != self.known_publishers.get() {
                // This call connects to all of them: from now on a full queue of theirs waits instead of losing.
                received = self.port.receive().map_err(|cause| Self::failed(&cause))?;
                if received.is_none() {
                    self.known_publishers.set(publishers);
                    if let Some(ready) = &self.ready {
                        let _ = ready.notify();
                    }
                }
            }
        }
        let Some(sample) = received else { return Ok(None) };
        let Place { session, seq, .. } = sample.user_header().place();
        let mut last_session = self.session.get();
        let missing = count_intake(&mut self.intake.borrow_mut(), &mut last_session, session, seq);
        self.session.set(last_session);
        Ok(Some(Received { sample, missing }))
    }

    /// Identities of the publishers there are, in no order; 0 for none.
    fn publisher_ids(&self) -> [u128; MAX_PUBLISHERS] {
        let (mut ids, mut count) = ([0; MAX_PUBLISHERS], 0);
        self.service.dynamic_config().list_publishers(|details| {
            ids[count % MAX_PUBLISHERS] = details.publisher_id.value();
            count += 1;
            CallbackProgression::Continue
        });
        ids
    }

    /// Publishers connected now.
    pub fn publishers(&self) -> usize {
        self.service.dynamic_config().number_of_publishers()
    }

    /// What has been received and missed so far.
    pub fn intake(&self) -> Intake {
        *self.intake.borrow()
    }

    fn failed(cause: &dyn std::fmt::Debug) -> IpcError {
        IpcError::Port { port: "subscriber", topic: M::TOPIC.name(), reason: format!("{cause:?}") }
    }
}
