//! The receiving port of one topic.

use std::cell::{Cell, RefCell};

use iceoryx2::port::DegradationAction;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::prelude::*;

use super::IpcError;
use super::backlog::Backlog;
use super::intake::count_intake;
use super::ports::{Inlet, Received};
use super::reach::{Unreachable, lives, process_of};
use super::services::{DataService, EventService, Ipc};
use crate::health::Intake;
use crate::message::{Header, Place};
use crate::messages::Message;
use crate::time::monotonic_ns;
use crate::topology::Stage;

/// Receives messages of one topic and counts the missing ones.
pub(super) struct SubscriberPort<M: Message> {
    service: DataService<M>,
    port: iceoryx2::port::subscriber::Subscriber<Ipc, [M::Element], M::Header>,
    intake: RefCell<Intake>,
    backlog: RefCell<Backlog>,
    session: Cell<u64>,
    /// Tells publishers that a stage has found them; observers tell nobody.
    ready: Option<Notifier<Ipc>>,
    known_publishers: Cell<[u128; MAX_PUBLISHERS]>,
    unreachable: Unreachable,
}

/// Publishers of a topic that are told apart.
const MAX_PUBLISHERS: usize = 16;

impl<M: Message> SubscriberPort<M> {
    pub(super) fn new(service: DataService<M>, ready: &EventService, process: &str) -> Result<Self, IpcError> {
        let name = PortName::new(process).map_err(|cause| Self::failed(&cause))?;
        let unreachable = Unreachable::default();
        let noted = unreachable.clone();
        let builder = service.subscriber_builder().name(&name).set_degradation_handler(move |_, of| {
            noted.note(of.sender_port_id);
            DegradationAction::Ignore
        });
        let port = builder.create().map_err(|cause| Self::failed(&cause))?;
        let notifier = |stage: &Stage| {
            let builder = ready.notifier_builder().default_event_id(EventId::new(stage.number()));
            builder.create().map_err(|cause| Self::failed(&cause))
        };
        let ready = Stage::from_name(process).map(notifier).transpose()?;
        let (intake, session, known_publishers) = (RefCell::default(), Cell::new(0), Cell::default());
        let backlog = RefCell::new(Backlog::new(M::QUEUE));
        Ok(Self { service, port, intake, backlog, session, ready, known_publishers, unreachable })
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

    /// An error if a living publisher could not be reached. One that has died is cleaned up and no loss.
    fn check_reach(&self) -> Result<(), IpcError> {
        let Some(port) = self.unreachable.take() else { return Ok(()) };
        let mut alive = None;
        self.service.dynamic_config().list_publishers(|details| {
            if details.publisher_id.value() == port {
                alive = process_of(&details.node_id).filter(|&pid| lives(pid));
            }
            CallbackProgression::Continue
        });
        let reason =
            |pid| format!("the memory of its publisher, process {pid}, cannot be mapped (address space, open files?)");
        alive.map_or(Ok(()), |pid| {
            Err(IpcError::Port { port: "subscriber", topic: M::TOPIC.name(), reason: reason(pid) })
        })
    }

    fn failed(cause: &dyn std::fmt::Debug) -> IpcError {
        IpcError::Port { port: "subscriber", topic: M::TOPIC.name(), reason: format!("{cause:?}") }
    }
}

impl<M: Message> Inlet<M> for SubscriberPort<M> {
    fn receive(&self) -> Result<Option<Received<M>>, IpcError> {
        let mut received = self.port.receive().map_err(|cause| Self::failed(&cause))?;
        if received.is_none() {
            let publishers = self.publisher_ids();
            if publishers != self.known_publishers.get() {
                // This call connects to all of them: from now on a full queue of theirs waits instead of losing.
                received = self.port.receive().map_err(|cause| Self::failed(&cause))?;
                self.check_reach()?;
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
        let (mut header, mut published_ns) = (*sample.user_header(), 0);
        header.each_stamp(&mut |stamp_ns| published_ns = published_ns.max(*stamp_ns));
        self.backlog.borrow_mut().take(published_ns, monotonic_ns());
        Ok(Some(Received { sample, missing }))
    }

    fn publishers(&self) -> usize {
        self.service.dynamic_config().number_of_publishers()
    }

    fn intake(&self) -> Intake {
        *self.intake.borrow()
    }

    fn take_most_waiting(&self) -> Option<u32> {
        self.backlog.borrow_mut().take_most()
    }
}
