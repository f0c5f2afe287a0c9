//! The bare event-driven hop of iceoryx2: a message, one event, one sleeping receiver, nothing of ours around it.
//! The limit that the chain's own hops are compared with; messages are as long as theirs, and are filled.

use std::time::Duration;

use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::subscriber::Subscriber;
use iceoryx2::prelude::*;
use iceoryx2::service::port_factory::publish_subscribe;

use super::IpcError;
use super::services::{EventService, Ipc, MAX_NODES};
use super::station::Station;
use crate::time::monotonic_ns;

/// Longest sleep of a receiver that is to look at its stop flag.
const TICK: Duration = Duration::from_millis(100);

/// When a message was sent, CLOCK_MONOTONIC ns.
#[derive(Debug, Default, Clone, Copy, ZeroCopySend)]
#[type_name("radar/Sent/1")]
#[repr(C)]
struct Sent(u64);

type HopService = publish_subscribe::PortFactory<Ipc, [f32], Sent>;

/// The sending end.
#[derive(Debug)]
pub struct HopSender {
    publisher: Publisher<Ipc, [f32], Sent>,
    notifier: Notifier<Ipc>,
}

/// The receiving end.
#[derive(Debug)]
pub struct HopReceiver {
    subscriber: Subscriber<Ipc, [f32], Sent>,
    listener: Listener<Ipc>,
}

/// The services of the hop `name`.
fn open(station: &Station, name: &str) -> Result<(HopService, EventService), IpcError> {
    let service = station.service_name(&format!("hop/{name}"));
    let error =
        |reason: String| IpcError::Service { service: service.clone(), schema: "hop/1", mode: "real-time", reason };
    let name = ServiceName::new(&service).map_err(|cause| error(format!("{cause:?}")))?;
    let builder = station.node().service_builder(&name).publish_subscribe::<[f32]>().user_header::<Sent>();
    let data = builder.max_nodes(MAX_NODES).open_or_create();
    Ok((data.map_err(|cause| error(format!("{cause:?}")))?, station.event(&service)?))
}

fn failed(cause: &dyn std::fmt::Debug) -> IpcError {
    IpcError::Port { port: "bare hop", topic: "hop", reason: format!("{cause:?}") }
}

impl HopSender {
    /// The sending end of the hop `name`, for messages of `length` numbers.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn open(station: &Station, name: &str, length: usize) -> Result<Self, IpcError> {
        let (data, event) = open(station, name)?;
        let builder = data.publisher_builder().initial_max_slice_len(length);
        let publisher = builder.create().map_err(|cause| failed(&cause))?;
        Ok(Self { publisher, notifier: event.notifier_builder().create().map_err(|cause| failed(&cause))? })
    }

    /// Fills a message of `length` numbers, notes the time and sends it.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn send(&self, length: usize) -> Result<(), IpcError> {
        let sample = self.publisher.loan_slice_uninit(length).map_err(|cause| failed(&cause))?;
        let mut sample = sample.write_from_fn(|index| index as f32);
        *sample.user_header_mut() = Sent(monotonic_ns());
        sample.send().map_err(|cause| failed(&cause))?;
        let _ = self.notifier.notify();
        Ok(())
    }
}

impl HopReceiver {
    /// The receiving end of the hop `name`.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn open(station: &Station, name: &str) -> Result<Self, IpcError> {
        let (data, event) = open(station, name)?;
        let subscriber = data.subscriber_builder().create().map_err(|cause| failed(&cause))?;
        Ok(Self { subscriber, listener: event.listener_builder().create().map_err(|cause| failed(&cause))? })
    }

    /// Calls `arrived` with the times sent and received of each message, ns, and `tick` after each wake-up and every
    /// 100 ms, until that says no.
    ///
    /// # Errors
    /// [`IpcError::Port`].
    pub fn attend(&self, arrived: &mut dyn FnMut(u64, u64), tick: &mut dyn FnMut() -> bool) -> Result<(), IpcError> {
        let wait_set = WaitSetBuilder::new()
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|cause| failed(&cause))?;
        let _guard = wait_set.attach_notification(&self.listener).map_err(|cause| failed(&cause))?;
        while tick() {
            while let Some(sample) = self.subscriber.receive().map_err(|cause| failed(&cause))? {
                arrived(sample.user_header().0, monotonic_ns());
            }
            let _ = wait_set.wait_and_process_once_with_timeout(|_| CallbackProgression::Continue, TICK);
            let _ = self.listener.try_wait(|_| {}); // also after a sleep that nobody ended: see `Wake`
        }
        Ok(())
    }
}
