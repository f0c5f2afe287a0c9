//! The services of iceoryx2 as this program uses them.

use std::sync::Arc;

use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::{event, publish_subscribe};

use crate::messages::Message;

pub(super) type Ipc = ipc::Service;
pub(super) type DataService<M> = publish_subscribe::PortFactory<Ipc, [<M as Message>::Element], <M as Message>::Header>;
pub(super) type EventService = event::PortFactory<Ipc>;

/// What a publisher needs: its messages, telling of their arrival, being told of consumers.
pub(super) struct PublisherServices<M: Message> {
    pub(super) data: Arc<DataService<M>>,
    pub(super) arrival: EventService,
    pub(super) ready: EventService,
}

/// Processes that may use a service at once, those not yet cleaned up included.
pub(super) const MAX_NODES: usize = 24;
