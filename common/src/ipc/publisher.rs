//! The publishing port of one topic.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use iceoryx2::port::BackpressureAction;
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::prelude::*;
use iceoryx2::sample_mut::SampleMut;

use super::IpcError;
use super::domain::{Domain, LOANED, clean_dead_nodes};
use super::observers::ObserverLosses;
use super::ports::Outlet;
use super::services::{DataService, Ipc, PublisherServices};
use crate::config::Mode;
use crate::messages::Message;
use crate::stop;
use crate::topology::{RECORDER, Stage};

/// How often a publisher that waits looks for dead consumers, ms.
const CLEAN_INTERVAL_MS: u64 = 50;
/// How long a publisher in real-time mode waits for its consumers before the first message.
const FIRST_WAIT: Duration = Duration::from_secs(5);

/// How long it then waits for the recorder alone: one that is there answers at once, and one that stands still must
/// not keep a stage that was started again from its work.
const FIRST_WAIT_RECORDER: Duration = Duration::from_millis(500);

/// How long a publisher that has ended waits for its consumers to leave.
const LONGEST_LINGER: Duration = Duration::from_secs(2);

/// Sends messages of one topic and wakes their consumers.
///
/// Lossless: the full queue of a required consumer blocks, and nothing is sent while one is missing; dead consumers
/// are cleaned up meanwhile. The full queue of an observer discards the message, counted ([`ObserverLosses`]).
/// Real time: a full queue loses its oldest message and nothing blocks.
pub(super) struct PublisherPort<M: Message> {
    port: iceoryx2::port::publisher::Publisher<Ipc, [M::Element], M::Header>,
    notifier: Notifier<Ipc>,
    service: Arc<DataService<M>>,
    ready: Listener<Ipc>,
    domain: Domain,
    mode: Mode,
    /// Consumers without which nothing is sent, one bit for each stage.
    required: u32,
    /// Those of them that have not yet found this publisher. One that comes later
    /// connects to the publishers there are as it is created.
    awaited: Cell<u32>,
    started: Cell<bool>,
    /// The message being sent has met a full queue.
    blocked: Arc<AtomicBool>,
}

/// The bit of the stage of this name; 0 for an observer.
fn bit(process: &str) -> u32 {
    Stage::from_name(process).map_or(0, |stage| 1 << stage.number())
}

/// Name of the subscriber with this port; `None` if it has left.
fn name_of<M: Message>(service: &DataService<M>, port: u128) -> Option<String> {
    let mut name = None;
    service.dynamic_config().list_subscribers(|details| {
        if details.subscriber_id.value() != port {
            return CallbackProgression::Continue;
        }
        name = Some(details.subscriber_name.to_string());
        CallbackProgression::Stop
    });
    name
}

impl<M: Message> PublisherPort<M> {
    pub(super) fn new(
        services: PublisherServices<M>,
        mode: Mode,
        domain: &Domain,
        max_elements: usize,
        required: u32,
        losses: ObserverLosses,
    ) -> Result<Self, IpcError> {
        let failed = |reason| IpcError::Port { port: "publisher", topic: M::TOPIC.name(), reason };
        let PublisherServices { data: service, arrival, ready } = services;
        // Before the port: no consumer may find the one without reaching the other.
        let ready = ready.listener_builder().create().map_err(|cause| failed(format!("{cause:?}")))?;
        let builder = service
            .publisher_builder()
            .initial_max_slice_len(max_elements)
            .allocation_strategy(AllocationStrategy::Static)
            .max_loaned_samples(LOANED);
        let blocked = Arc::new(AtomicBool::new(false));
        let builder = match mode {
            Mode::RealTime => builder.backpressure_strategy(BackpressureStrategy::DiscardData),
            Mode::Lossless => {
                let (config, cleaned_ms) = (domain.config().clone(), AtomicU64::new(0));
                let (blocked, subscribers) = (Arc::clone(&blocked), Arc::clone(&service));
                builder.backpressure_strategy(BackpressureStrategy::RetryUntilDelivered).set_backpressure_handler(
                    move |info| {
                        let Some(name) = name_of::<M>(&subscribers, info.receiver_port_id) else {
                            return BackpressureAction::DiscardData; // it has left
                        };
                        if bit(&name) & required == 0 {
                            losses.count(M::TOPIC, if name.is_empty() { "unnamed" } else { &name });
                            return BackpressureAction::DiscardData;
                        }
                        blocked.store(true, Ordering::Relaxed);
                        let waited_ms = info.elapsed_time.as_millis() as u64;
                        let last_ms = cleaned_ms.load(Ordering::Relaxed);
                        if waited_ms < last_ms {
                            cleaned_ms.store(0, Ordering::Relaxed); // another message waits now
                        } else if waited_ms >= last_ms + CLEAN_INTERVAL_MS {
                            cleaned_ms.store(waited_ms, Ordering::Relaxed);
                            clean_dead_nodes(&config);
                            stop::say_waiting();
                        }
                        BackpressureAction::Retry
                    },
                )
            }
        };
        let this = Self {
            port: builder.create().map_err(|cause| failed(format!("{cause:?}")))?,
            notifier: arrival.notifier_builder().create().map_err(|cause| failed(format!("{cause:?}")))?,
            service,
            ready,
            domain: domain.clone(),
            mode,
            required,
            awaited: Cell::new(required),
            started: Cell::new(false),
            blocked,
        };
        domain.reserve()?;
        this.wake(); // consumers look for a new publisher when they are woken
        Ok(this)
    }

    fn send(&self, sample: SampleMut<Ipc, [M::Element], M::Header>) -> Result<(), IpcError> {
        let began = Instant::now();
        sample.send().map_err(|cause| Self::failed(&cause))?;
        if self.blocked.swap(false, Ordering::Relaxed) {
            stop::note_waiting(began.elapsed());
        }
        self.wake();
        Ok(())
    }

    /// Required consumers that are not there or have not connected, one bit each.
    fn missing(&self) -> u32 {
        if self.awaited.get() != 0 {
            let _ = self.ready.try_wait(|event| {
                self.awaited.set(self.awaited.get() & !(1_u32.checked_shl(event.id.as_value() as u32).unwrap_or(0)));
            });
        }
        self.awaited.get() | self.required & !self.present()
    }

    /// Stages that are subscribed, one bit each.
    fn present(&self) -> u32 {
        let mut present = 0;
        self.service.dynamic_config().list_subscribers(|details| {
            present |= bit(details.subscriber_name.as_str());
            CallbackProgression::Continue
        });
        present
    }

    fn wake(&self) {
        // A listener that has just died is no reason to stop.
        let _ = self.notifier.notify();
    }

    fn failed(cause: &dyn std::fmt::Debug) -> IpcError {
        IpcError::Port { port: "publisher", topic: M::TOPIC.name(), reason: format!("{cause:?}") }
    }
}

impl<M: Message> Outlet<M> for PublisherPort<M> {
    fn publish_with(
        &self,
        length: usize,
        write: &mut dyn FnMut(&mut [M::Element]) -> M::Header,
    ) -> Result<(), IpcError> {
        self.wait_for_consumers()?;
        // Writing defaults first costs 0.2 ns per f32 and keeps the interface free of `unsafe`.
        let mut sample = self.port.loan_slice(length).map_err(|cause| Self::failed(&cause))?;
        let header = write(sample.payload_mut());
        *sample.user_header_mut() = header;
        self.send(sample)
    }

    fn publish(
        &self,
        header: &M::Header,
        elements: &[M::Element],
        stamp: &mut dyn FnMut(&mut M::Header),
    ) -> Result<(), IpcError> {
        self.wait_for_consumers()?;
        let sample = self.port.loan_slice_uninit(elements.len()).map_err(|cause| Self::failed(&cause))?;
        let mut sample = sample.write_from_slice(elements);
        let place = sample.user_header_mut();
        *place = *header;
        stamp(place);
        self.send(sample)
    }

    fn wait_for_consumers(&self) -> Result<(), IpcError> {
        if self.mode == Mode::RealTime && self.started.get() || self.missing() == 0 {
            self.started.set(true);
            return Ok(());
        }
        let topic = M::TOPIC.name();
        let (began, mut cleaned, mut told) = (Instant::now(), Instant::now(), false);
        let mut recorder_alone = None;
        loop {
            let missing = self.missing();
            if missing == 0 {
                break;
            }
            if stop::stop_requested() && (!self.started.get() || began.elapsed() > FIRST_WAIT) {
                return Err(IpcError::Stopped { topic });
            }
            if missing != bit(RECORDER) {
                recorder_alone = None;
            }
            let recorder_late = missing == bit(RECORDER)
                && recorder_alone.get_or_insert_with(Instant::now).elapsed() > FIRST_WAIT_RECORDER;
            if self.mode == Mode::RealTime && (recorder_late || began.elapsed() > FIRST_WAIT) {
                break;
            }
            if cleaned.elapsed() > Duration::from_millis(CLEAN_INTERVAL_MS) {
                cleaned = Instant::now();
                self.domain.clean_dead_nodes();
                stop::say_waiting();
            }
            if !told && began.elapsed() > Duration::from_secs(2) {
                told = true;
                tracing::warn!(topic, "waiting for consumers");
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.started.set(true);
        stop::note_waiting(began.elapsed());
        Ok(())
    }

    fn is_heard(&self) -> bool {
        self.missing() == 0
    }

    fn linger(&self) {
        let began = Instant::now();
        while self.required & self.present() != 0 && began.elapsed() < LONGEST_LINGER {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}
