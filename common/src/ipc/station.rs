//! A process in a domain.

use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::{event, publish_subscribe};

use super::domain::{BORROWED, Domain};
use super::hop::Sent;
use super::{IpcError, Publisher, Subscriber, Wake};
use crate::config::{ChainConfig, Mode};
use crate::services::{ALL_TOPICS, Consumer, Dwells, HealthReports, Message, Plots, Topic, Tracks, Truth};

pub(super) type Ipc = ipc::Service;
pub(super) type DataService<M> = publish_subscribe::PortFactory<Ipc, [<M as Message>::Element], <M as Message>::Header>;
pub(super) type HopService = publish_subscribe::PortFactory<Ipc, [f32], Sent>;
pub(super) type EventService = event::PortFactory<Ipc>;

/// One process at one site of a domain.
#[derive(Debug)]
pub struct Station {
    node: Node<Ipc>,
    domain: Domain,
    site: String,
    mode: Mode,
    process: String,
}

/// What a publisher needs: its messages, telling of their arrival, being told of consumers.
pub(super) struct PublisherServices<M: Message> {
    pub(super) data: DataService<M>,
    pub(super) arrival: EventService,
    pub(super) ready: EventService,
}

/// All services of a site, held open so that no death of a stage can leave one half made.
pub struct Keeper {
    _services: (DataService<Dwells>, DataService<Plots>, DataService<Tracks>, DataService<Truth>),
    _health: DataService<HealthReports>,
    _events: Vec<EventService>,
}

impl Station {
    /// Enters the domain of `chain` as the process `name`.
    ///
    /// # Errors
    /// [`IpcError::Domain`].
    pub fn enter(name: &str, chain: &ChainConfig) -> Result<Self, IpcError> {
        let domain = Domain::enter(&chain.ipc)?;
        let error = |reason| IpcError::Domain {
            prefix: chain.ipc.prefix.clone(),
            root: Domain::root(&chain.ipc).display().to_string(),
            reason,
        };
        let node_name = NodeName::new(name).map_err(|cause| error(format!("{cause:?}")))?;
        let node = NodeBuilder::new()
            .name(&node_name)
            .config(domain.config())
            // `process::catch_signals` handles them: iceoryx2 would replace its handler.
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|cause| error(format!("{cause:?}")))?;
        Ok(Self { node, domain, site: chain.site.name.clone(), mode: chain.run.mode, process: name.to_string() })
    }

    /// The domain.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Name of this process.
    pub fn process(&self) -> &str {
        &self.process
    }

    /// Creates every service of the site and holds it open.
    ///
    /// # Errors
    /// [`IpcError::Service`] if one exists with another version or mode.
    pub fn keep_services(&self) -> Result<Keeper, IpcError> {
        let names = ALL_TOPICS.map(|topic| [self.service_name(topic), self.ready_name(topic)]);
        Ok(Keeper {
            _services: (self.data::<Dwells>()?, self.data::<Plots>()?, self.data::<Tracks>()?, self.data::<Truth>()?),
            _health: self.data::<HealthReports>()?,
            _events: names.iter().flatten().map(|name| self.event(name)).collect::<Result<_, _>>()?,
        })
    }

    /// The publisher of a topic, for messages of at most `max_elements`. In lossless
    /// mode it does not send before `consumers` are connected.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn publisher<M: Message>(&self, max_elements: usize, consumers: &[Consumer]) -> Result<Publisher<M>, IpcError> {
        let services = PublisherServices {
            data: self.data::<M>()?,
            arrival: self.event(&self.service_name(M::TOPIC))?,
            ready: self.event(&self.ready_name(M::TOPIC))?,
        };
        Publisher::new(services, self.policy::<M>(), &self.domain, max_elements, consumers)
    }

    /// A subscriber to a topic.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn subscriber<M: Message>(&self) -> Result<Subscriber<M>, IpcError> {
        Subscriber::new(self.data::<M>()?, &self.event(&self.ready_name(M::TOPIC))?, &self.process)
    }

    /// What [`super::attend`] needs to be woken by messages of a topic.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn wake(&self, topic: Topic) -> Result<Wake, IpcError> {
        Wake::new(&self.event(&self.service_name(topic))?, topic)
    }

    /// Services of the bare hop `name`.
    pub(super) fn hop(&self, name: &str) -> Result<(HopService, EventService), IpcError> {
        let service = format!("radar/{}/hop/{name}", self.site);
        let error =
            |reason: String| IpcError::Service { service: service.clone(), schema: "hop/1", mode: "real-time", reason };
        let name = ServiceName::new(&service).map_err(|cause| error(format!("{cause:?}")))?;
        let builder = self.node.service_builder(&name).publish_subscribe::<[f32]>().user_header::<Sent>();
        let data = builder.max_nodes(MAX_NODES).open_or_create();
        Ok((data.map_err(|cause| error(format!("{cause:?}")))?, self.event(&service)?))
    }

    /// Health reports are never waited for, whatever the mode of the chain.
    fn policy<M: Message>(&self) -> Mode {
        if M::TOPIC == Topic::Health { Mode::RealTime } else { self.mode }
    }

    fn service_name(&self, topic: Topic) -> String {
        format!("radar/{}/{}", self.site, topic.name())
    }

    /// Event service on which subscribers of a topic tell a new publisher that they have found it.
    fn ready_name(&self, topic: Topic) -> String {
        format!("{}/ready", self.service_name(topic))
    }

    fn data<M: Message>(&self) -> Result<DataService<M>, IpcError> {
        let mode = self.policy::<M>();
        let service = self.service_name(M::TOPIC);
        let error = |reason: String| IpcError::Service {
            service: service.clone(),
            schema: M::SCHEMA,
            mode: mode.name(),
            reason,
        };
        let attribute = |verifier: AttributeVerifier, key: &str, value: &str| {
            let key = key.try_into().map_err(|cause| error(format!("{cause:?}")))?;
            let value = value.try_into().map_err(|cause| error(format!("{cause:?}")))?;
            verifier.require(&key, &value).map_err(|cause| error(format!("{cause:?}")))
        };
        let attributes = attribute(AttributeVerifier::new(), "schema", M::SCHEMA)?;
        let attributes = attribute(attributes, "mode", mode.name())?;
        let name = ServiceName::new(&service).map_err(|cause| error(format!("{cause:?}")))?;
        self.node
            .service_builder(&name)
            .publish_subscribe::<[M::Element]>()
            .user_header::<M::Header>()
            .max_publishers(M::PUBLISHERS)
            .max_subscribers(M::SUBSCRIBERS)
            .max_nodes(MAX_NODES)
            .subscriber_max_buffer_size(M::BUFFER)
            .subscriber_max_borrowed_samples(BORROWED)
            .history_size(M::HISTORY)
            .enable_safe_overflow(mode == Mode::RealTime)
            .open_or_create_with_attributes(&attributes)
            .map_err(|cause| error(explain(&format!("{cause:?}"))))
    }

    fn event(&self, service: &str) -> Result<EventService, IpcError> {
        let error =
            |reason: String| IpcError::Service { service: service.to_string(), schema: "event", mode: "event", reason };
        let name = ServiceName::new(service).map_err(|cause| error(format!("{cause:?}")))?;
        self.node
            .service_builder(&name)
            .event()
            .max_nodes(MAX_NODES)
            .event_id_max_value(Consumer::KINDS)
            .max_notifiers(HealthReports::PUBLISHERS)
            .max_listeners(HealthReports::PUBLISHERS)
            .open_or_create()
            .map_err(|cause| error(explain(&format!("{cause:?}"))))
    }
}

/// Processes that may use a service at once, those not yet cleaned up included.
const MAX_NODES: usize = 24;

/// Adds what a user can do about it to iceoryx2's names of errors.
fn explain(cause: &str) -> String {
    let hint = if cause.contains("Attributes") || cause.contains("Types") || cause.contains("Overflow") {
        "a process of another version or delivery mode runs in this domain; stop it or use another --ipc-prefix"
    } else if cause.contains("Hangs") || cause.contains("Corrupted") {
        "a process was killed while it created the service; stop the chain and start it again"
    } else if cause.contains("Exceeds") {
        "too many processes use the service"
    } else {
        return cause.to_string();
    };
    format!("{cause} ({hint})")
}
