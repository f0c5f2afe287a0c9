//! A process in a domain.

use std::any::Any;
use std::rc::Rc;
use std::sync::Arc;

use iceoryx2::prelude::*;

use super::domain::{BORROWED, Domain, Inhabitant};
use super::observers::ObserverLosses;
use super::ports::{Inlet, Outlet};
use super::publisher::PublisherPort;
use super::services::{DataService, EventService, Ipc, MAX_NODES, PublisherServices};
use super::subscriber::SubscriberPort;
use super::{IpcError, Publisher, Subscriber, Wake};
use crate::config::{ChainConfig, Mode};
use crate::messages::{ForTopic, HealthReports, Message};
use crate::topic::{TOPICS, Topic};
use crate::topology::{STAGES, required_consumers};

/// One process at one site of a domain.
#[derive(Debug)]
pub struct Station {
    node: Rc<Node<Ipc>>,
    domain: Domain,
    site: String,
    mode: Mode,
    process: String,
    /// Stages that publishers of each topic wait for, one bit each.
    required: [u32; TOPICS],
    losses: ObserverLosses,
}

/// All services of a site, held open so that no death of a stage can leave one half made.
pub struct Keeper {
    _services: Vec<Box<dyn Any>>,
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
        let node_name = Inhabitant::node_name(name, &chain.site.name);
        let node_name = NodeName::new(&node_name).map_err(|cause| error(format!("{cause:?}")))?;
        let node = NodeBuilder::new()
            .name(&node_name)
            .config(domain.config())
            // `process::catch_signals` handles them: iceoryx2 would replace its handler.
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|cause| error(format!("{cause:?}")))?;
        Ok(Self { process: name.to_string(), ..Self::of_site(Rc::new(node), domain, chain) })
    }

    /// The same process at another site of its domain.
    #[must_use]
    pub fn at(&self, chain: &ChainConfig) -> Self {
        Self { process: self.process.clone(), ..Self::of_site(Rc::clone(&self.node), self.domain.clone(), chain) }
    }

    fn of_site(node: Rc<Node<Ipc>>, domain: Domain, chain: &ChainConfig) -> Self {
        let mut required = [0; TOPICS];
        for topic in Topic::ALL {
            required[topic as usize] = required_consumers(topic, chain);
        }
        let (site, losses) = (chain.site.name.clone(), ObserverLosses::default());
        Self { node, domain, site, mode: chain.run.mode, process: String::new(), required, losses }
    }

    /// The domain.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Name of this process.
    pub fn process(&self) -> &str {
        &self.process
    }

    /// Name of the site.
    pub fn site(&self) -> &str {
        &self.site
    }

    /// What full queues of observers have discarded of the messages published here.
    pub fn observer_losses(&self) -> ObserverLosses {
        self.losses.clone()
    }

    pub(super) fn node(&self) -> &Node<Ipc> {
        &self.node
    }

    /// Creates every service of the site and holds it open.
    ///
    /// # Errors
    /// [`IpcError::Service`] if one exists with another version or mode.
    pub fn keep_services(&self) -> Result<Keeper, IpcError> {
        struct Open<'a>(&'a Station);
        impl ForTopic for Open<'_> {
            type Out = Result<Box<dyn Any>, IpcError>;

            fn call<M: Message>(self) -> Self::Out {
                Ok(Box::new(self.0.data::<M>(M::SCHEMA)?))
            }
        }
        let names = Topic::ALL.map(|topic| [self.topic_service(topic), self.ready_service(topic)]);
        Ok(Keeper {
            _services: Topic::ALL.into_iter().map(|topic| topic.apply(Open(self))).collect::<Result<_, _>>()?,
            _events: names.iter().flatten().map(|name| self.event(name)).collect::<Result<_, _>>()?,
        })
    }

    /// The publisher of a topic, for messages of at most `most` elements. In lossless mode it does not send before the
    /// consumers that the topology requires are connected.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn publisher<M: Message>(&self, most: usize) -> Result<Publisher<M>, IpcError> {
        Publisher::new(self.outlet(M::TOPIC, M::SCHEMA, most)?)
    }

    /// A subscriber to a topic.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn subscriber<M: Message>(&self) -> Result<Subscriber<M>, IpcError> {
        Subscriber::new(self.inlet(M::TOPIC, M::SCHEMA)?)
    }

    /// The `Box<dyn Outlet>` of a topic, in a box. Here and not where its messages are named, so that it is compiled once.
    fn outlet(&self, topic: Topic, schema: &'static str, most: usize) -> Result<Box<dyn Any>, IpcError> {
        struct Open<'a>(&'a Station, &'static str, usize);
        impl ForTopic for Open<'_> {
            type Out = Result<Box<dyn Any>, IpcError>;

            fn call<M: Message>(self) -> Self::Out {
                let Self(station, schema, most) = self;
                let services = PublisherServices {
                    data: Arc::new(station.data::<M>(schema)?),
                    arrival: station.event(&station.topic_service(M::TOPIC))?,
                    ready: station.event(&station.ready_service(M::TOPIC))?,
                };
                let (policy, required) = (station.policy::<M>(), station.required[M::TOPIC as usize]);
                let losses = station.losses.clone();
                let port = PublisherPort::<M>::new(services, policy, &station.domain, most, required, losses)?;
                let outlet: Box<dyn Outlet<M>> = Box::new(port);
                Ok(Box::new(outlet))
            }
        }
        topic.apply(Open(self, schema, most))
    }

    /// The `Box<dyn Inlet>` of a topic, in a box; as [`Station::outlet`].
    fn inlet(&self, topic: Topic, schema: &'static str) -> Result<Box<dyn Any>, IpcError> {
        struct Open<'a>(&'a Station, &'static str);
        impl ForTopic for Open<'_> {
            type Out = Result<Box<dyn Any>, IpcError>;

            fn call<M: Message>(self) -> Self::Out {
                let Self(station, schema) = self;
                let ready = station.event(&station.ready_service(M::TOPIC))?;
                let port = SubscriberPort::<M>::new(station.data::<M>(schema)?, &ready, &station.process)?;
                let inlet: Box<dyn Inlet<M>> = Box::new(port);
                Ok(Box::new(inlet))
            }
        }
        topic.apply(Open(self, schema))
    }

    /// What [`super::attend`] needs to be woken by messages of a topic.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn wake(&self, topic: Topic) -> Result<Wake, IpcError> {
        Wake::new(&self.event(&self.topic_service(topic))?, topic)
    }

    /// Health reports are never waited for, and commands always delivered, whatever the mode of the chain.
    fn policy<M: Message>(&self) -> Mode {
        match M::TOPIC {
            Topic::HealthReports => Mode::RealTime,
            Topic::Commands => Mode::Lossless,
            _ => self.mode,
        }
    }

    /// Name of a service of the site.
    pub(super) fn service_name(&self, what: &str) -> String {
        format!("radar/{}/{what}", self.site)
    }

    fn topic_service(&self, topic: Topic) -> String {
        self.service_name(topic.name())
    }

    /// Event service on which the stages that read a topic tell a new publisher that they have found it.
    fn ready_service(&self, topic: Topic) -> String {
        format!("{}/ready", self.topic_service(topic))
    }

    fn data<M: Message>(&self, schema: &'static str) -> Result<DataService<M>, IpcError> {
        let mode = self.policy::<M>();
        let service = self.topic_service(M::TOPIC);
        let error = |reason: String| IpcError::Service { service: service.clone(), schema, mode: mode.name(), reason };
        let attribute = |verifier: AttributeVerifier, key: &str, value: &str| {
            let key = key.try_into().map_err(|cause| error(format!("{cause:?}")))?;
            let value = value.try_into().map_err(|cause| error(format!("{cause:?}")))?;
            verifier.require(&key, &value).map_err(|cause| error(format!("{cause:?}")))
        };
        let attributes = attribute(AttributeVerifier::new(), "schema", schema)?;
        let attributes = attribute(attributes, "mode", mode.name())?;
        let name = ServiceName::new(&service).map_err(|cause| error(format!("{cause:?}")))?;
        self.node
            .service_builder(&name)
            .publish_subscribe::<[M::Element]>()
            .user_header::<M::Header>()
            .max_publishers(M::PUBLISHERS)
            .max_subscribers(M::SUBSCRIBERS)
            .max_nodes(MAX_NODES)
            .subscriber_max_buffer_size(M::QUEUE)
            .subscriber_max_borrowed_samples(BORROWED)
            .history_size(M::HISTORY)
            .enable_safe_overflow(mode == Mode::RealTime)
            .open_or_create_with_attributes(&attributes)
            .map_err(|cause| {
                let cause = format!("{cause:?}");
                half_made(&service, &cause)
                    .unwrap_or_else(|| error(format!("{}{}", explain(&cause), self.present(&name))))
            })
    }

    /// What the attributes of a service that exists say: its version and mode.
    fn present(&self, name: &ServiceName) -> String {
        let details = Ipc::details(name, self.domain.config(), MessagingPattern::PublishSubscribe);
        let Ok(Some(details)) = details else { return String::new() };
        let attributes = details.static_details.attributes().iter();
        let told: Vec<String> = attributes.map(|attribute| attribute.value().to_string()).collect();
        format!("; the service there is {}", told.join(", "))
    }

    pub(super) fn event(&self, service: &str) -> Result<EventService, IpcError> {
        let error =
            |reason: String| IpcError::Service { service: service.to_string(), schema: "event", mode: "event", reason };
        let name = ServiceName::new(service).map_err(|cause| error(format!("{cause:?}")))?;
        self.node
            .service_builder(&name)
            .event()
            .max_nodes(MAX_NODES)
            .event_id_max_value(STAGES.len())
            .max_notifiers(HealthReports::PUBLISHERS)
            .max_listeners(HealthReports::PUBLISHERS)
            .open_or_create()
            .map_err(|cause| {
                let cause = format!("{cause:?}");
                half_made(service, &cause).unwrap_or_else(|| error(explain(&cause)))
            })
    }
}

/// The error of a service that iceoryx2 finds in the making or damaged.
fn half_made(service: &str, cause: &str) -> Option<IpcError> {
    let is_half_made = ["Hangs", "Corrupted"].iter().any(|word| cause.contains(word));
    is_half_made.then(|| IpcError::HalfMade { service: service.to_string(), reason: cause.to_string() })
}

/// Adds what a user can do about it to iceoryx2's names of errors.
fn explain(cause: &str) -> String {
    let hint = if cause.contains("Attributes") || cause.contains("Types") || cause.contains("Overflow") {
        "a process of another version or delivery mode runs in this domain; stop it or use another --ipc-prefix"
    } else if cause.contains("Exceeds") {
        "too many processes use the service"
    } else {
        return cause.to_string();
    };
    format!("{cause} ({hint})")
}
