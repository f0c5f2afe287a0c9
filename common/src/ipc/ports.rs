//! The ports as every process uses them: compiled here once for each topic of the table.
//!
//! iceoryx2 is generic through and through, and generic code is compiled anew in each crate that names it with a type of
//! its own: four hundred thousand lines of intermediate code for one publisher, a tenth of the chain's build in each
//! process. Behind [`Outlet`] and [`Inlet`] it stays in this crate.

use std::any::Any;

use super::IpcError;
use super::services::Ipc;
use crate::health::Intake;
use crate::messages::Message;

/// What a publishing port does.
pub(super) trait Outlet<M: Message> {
    fn publish_with(
        &self,
        length: usize,
        write: &mut dyn FnMut(&mut [M::Element]) -> M::Header,
    ) -> Result<(), IpcError>;

    fn publish(
        &self,
        header: &M::Header,
        elements: &[M::Element],
        stamp: &mut dyn FnMut(&mut M::Header),
    ) -> Result<(), IpcError>;

    fn wait_for_consumers(&self) -> Result<(), IpcError>;

    fn is_heard(&self) -> bool;

    fn linger(&self);
}

/// What a receiving port does.
pub(super) trait Inlet<M: Message> {
    fn receive(&self) -> Result<Option<Received<M>>, IpcError>;

    fn publishers(&self) -> usize;

    fn intake(&self) -> Intake;

    fn take_most_waiting(&self) -> Option<u32>;
}

/// Sends messages of one topic and wakes their consumers.
///
/// Lossless: the full queue of a required consumer blocks, and nothing is sent while one is missing; dead consumers
/// are cleaned up meanwhile. The full queue of an observer discards the message, counted
/// ([`super::ObserverLosses`]). Real time: a full queue loses its oldest message and nothing blocks.
pub struct Publisher<M: Message>(Box<dyn Outlet<M>>);

impl<M: Message> Publisher<M> {
    /// The port in `outlet`, a `Box<dyn Outlet<M>>`.
    pub(super) fn new(outlet: Box<dyn Any>) -> Result<Self, IpcError> {
        outlet.downcast().map_or_else(|_| Err(not_in_table::<M>()), |outlet| Ok(Self(*outlet)))
    }

    /// Sends a message of `length` elements that `write` fills in shared memory, in place;
    /// it returns the header.
    ///
    /// # Errors
    /// [`IpcError::Port`]; [`IpcError::Stopped`] when the user gave up waiting.
    pub fn publish_with(
        &self,
        length: usize,
        mut write: impl FnMut(&mut [M::Element]) -> M::Header,
    ) -> Result<(), IpcError> {
        self.0.publish_with(length, &mut write)
    }

    /// Sends a copy of `elements`; `stamp` may still write the time of publishing into the header.
    ///
    /// # Errors
    /// As [`Publisher::publish_with`].
    pub fn publish(
        &self,
        header: &M::Header,
        elements: &[M::Element],
        mut stamp: impl FnMut(&mut M::Header),
    ) -> Result<(), IpcError> {
        self.0.publish(header, elements, &mut stamp)
    }

    /// Waits until the required consumers are connected: in lossless mode before every
    /// message and for ever, in real time only before the first and not for long, shortest for the recorder.
    ///
    /// A subscriber that exists is not yet connected: iceoryx2 drops what does not fit
    /// into the queue of one that has not looked for this publisher, whatever the
    /// backpressure strategy. So each consumer says on an event of its own that it has.
    ///
    /// # Errors
    /// [`IpcError::Stopped`] if the user asks to stop meanwhile.
    pub fn wait_for_consumers(&self) -> Result<(), IpcError> {
        self.0.wait_for_consumers()
    }

    /// Whether all required consumers are connected: then a message waits for none of them to come.
    pub fn is_heard(&self) -> bool {
        self.0.is_heard()
    }

    /// Stays until the required consumers have left, at most two seconds: what a publisher sends
    /// last is lost to those that have not yet found it when it goes.
    pub fn linger(&self) {
        self.0.linger();
    }
}

/// Receives messages of one topic and counts the missing ones.
pub struct Subscriber<M: Message>(Box<dyn Inlet<M>>);

impl<M: Message> Subscriber<M> {
    /// The port in `inlet`, a `Box<dyn Inlet<M>>`.
    pub(super) fn new(inlet: Box<dyn Any>) -> Result<Self, IpcError> {
        inlet.downcast().map_or_else(|_| Err(not_in_table::<M>()), |inlet| Ok(Self(*inlet)))
    }

    /// The next message, if one is waiting.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn receive(&self) -> Result<Option<Received<M>>, IpcError> {
        self.0.receive()
    }

    /// Publishers connected now.
    pub fn publishers(&self) -> usize {
        self.0.publishers()
    }

    /// What has been received and missed so far.
    pub fn intake(&self) -> Intake {
        self.0.intake()
    }

    /// The most messages that one has found waiting before it, of those received since the last call.
    pub fn take_most_waiting(&self) -> Option<u32> {
        self.0.take_most_waiting()
    }
}

/// A message in shared memory; it is given back when dropped.
pub struct Received<M: Message> {
    pub(super) sample: iceoryx2::sample::Sample<Ipc, [M::Element], M::Header>,
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

fn not_in_table<M: Message>() -> IpcError {
    let reason = "its messages are not those of the table of topics".to_string();
    IpcError::Port { port: "port", topic: M::TOPIC.name(), reason }
}
