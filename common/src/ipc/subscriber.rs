//! Subscribing to one topic.

use std::cell::{Cell, RefCell};

use iceoryx2::prelude::PortFactory;

use super::IpcError;
use super::intake::count_intake;
use super::station::{DataService, Ipc};
use crate::health::Intake;
use crate::services::Message;

/// Receives messages of one topic and counts the missing ones.
pub struct Subscriber<M: Message> {
    service: DataService<M>,
    port: iceoryx2::port::subscriber::Subscriber<Ipc, [M::Element], M::Header>,
    intake: RefCell<Intake>,
    session: Cell<u64>,
}

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
    pub(super) fn new(service: DataService<M>) -> Result<Self, IpcError> {
        let port = service.subscriber_builder().create().map_err(|cause| Self::failed(&cause))?;
        Ok(Self { service, port, intake: RefCell::default(), session: Cell::new(0) })
    }

    /// The next message, if one is waiting.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn receive(&self) -> Result<Option<Received<M>>, IpcError> {
        let Some(sample) = self.port.receive().map_err(|cause| Self::failed(&cause))? else { return Ok(None) };
        let (session, seq) = M::place(sample.user_header());
        let mut last_session = self.session.get();
        let missing = count_intake(&mut self.intake.borrow_mut(), &mut last_session, session, seq);
        self.session.set(last_session);
        Ok(Some(Received { sample, missing }))
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
