//! Waiting until there is something to do, and noticing when that takes too long.

use std::cell::Cell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use iceoryx2::port::listener::Listener;
use iceoryx2::prelude::*;

use super::IpcError;
use super::services::{EventService, Ipc};
use crate::config::{ChainConfig, WaitStrategy};
use crate::health::{Condition, Health};
use crate::stop;
use crate::topic::Topic;

/// Longest sleep: the stop flag and the health report are looked after this often.
const TICK: Duration = Duration::from_millis(100);
/// Looks between two emptyings of the event queues by a process that polls.
const LOOKS: u32 = 4096;

/// Is woken by the messages of one topic.
#[derive(Debug)]
pub struct Wake {
    listener: Listener<Ipc>,
    topic: Topic,
}

impl Wake {
    pub(super) fn new(event: &EventService, topic: Topic) -> Result<Self, IpcError> {
        let listener = event.listener_builder().create().map_err(|cause| IpcError::Port {
            port: "listener",
            topic: topic.name(),
            reason: format!("{cause:?}"),
        })?;
        Ok(Self { listener, topic })
    }

    /// Takes all events. One that is sent while others are taken can lose its call to wake up and keep its mark, for
    /// which no later one of its kind calls: so until there is none, and after every sleep, also one that nobody ended.
    fn drain(&self) {
        let mut found = true;
        while std::mem::take(&mut found) {
            let _ = self.listener.try_wait(|_| found = true);
        }
    }
}

/// What a step of a process asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Wait until something arrives.
    Wait,
    /// The same, but come back after this time at the latest.
    Soon(Duration),
    /// More is waiting: come back at once.
    Again,
    /// The process has done its work.
    End,
}

/// A stage takes what waits for so long, then it says how it is and goes on.
const TURN: Duration = Duration::from_millis(50);

/// The time that a stage works off its input before it looks after itself: under overload a queue never becomes empty,
/// and a stage that says nothing counts as one that hangs.
#[derive(Debug, Clone, Copy)]
pub struct Turn(Instant);

impl Turn {
    /// A turn that begins now.
    pub fn begin() -> Self {
        Self(Instant::now())
    }

    /// Whether it is time to look after other things.
    pub fn is_over(&self) -> bool {
        self.0.elapsed() > TURN
    }

    /// What the step asks for that has had this turn.
    pub fn flow(&self) -> Flow {
        if self.is_over() { Flow::Again } else { Flow::Wait }
    }
}

/// Tells a silent upstream from own slowness: input that stays away for longer than
/// `watchdog.silence_s`, work on the input that goes on for longer than `watchdog.slow_s` without catching up. Clones
/// share what they know.
#[derive(Debug, Clone)]
pub struct Watchdog(Rc<Watch>);

#[derive(Debug)]
struct Watch {
    silence: Duration,
    slow: Duration,
    wait: WaitStrategy,
    heard: Cell<Instant>,
    /// Input has come at least once.
    begun: Cell<bool>,
    condition: Cell<Condition>,
    silences: Cell<u32>,
    slow_steps: Cell<u32>,
    /// How long the process has worked without catching up with its input.
    busy: Cell<Duration>,
}

impl Watchdog {
    /// The watchdog of the process with this name.
    pub fn new(chain: &ChainConfig, process: &str) -> Self {
        Self(Rc::new(Watch {
            silence: Duration::from_secs_f64(chain.watchdog.silence_s),
            slow: Duration::from_secs_f64(chain.watchdog.slow_s),
            wait: chain.realtime.of(process).wait,
            heard: Cell::new(Instant::now()),
            begun: Cell::default(),
            condition: Cell::default(),
            silences: Cell::default(),
            slow_steps: Cell::default(),
            busy: Cell::default(),
        }))
    }

    /// Writes what it knows into a health report.
    pub fn describe(&self, health: &mut Health) {
        health.condition = self.0.condition.get() as u32;
        health.silences = self.0.silences.get();
        health.slow_steps = self.0.slow_steps.get();
    }

    /// Notes whether another host keeps the process waiting: no input then is no silence of those upstream.
    pub fn hold_up(&self, is_held_up: bool) {
        if is_held_up {
            self.0.condition.set(Condition::HeldUp);
        } else if self.0.condition.get() == Condition::HeldUp {
            self.0.condition.set(Condition::Fine);
        }
    }

    /// Input has arrived.
    fn input(&self) {
        let silent = self.0.heard.replace(Instant::now()).elapsed();
        let begun = self.0.begun.replace(true);
        if self.0.condition.get() == Condition::UpstreamSilent {
            // As loud as the warning that it ends.
            tracing::warn!("input has {} after {silent:.0?}", if begun { "resumed" } else { "begun" });
            self.0.condition.set(Condition::Fine);
        }
    }

    /// Nothing has come on one topic for the time allowed; on others there may have.
    fn missed(&self) {
        if self.0.heard.get().elapsed() < self.0.silence || self.0.condition.get() == Condition::HeldUp {
            return;
        }
        if self.0.condition.replace(Condition::UpstreamSilent) != Condition::UpstreamSilent {
            self.0.silences.set(self.0.silences.get() + 1);
            if self.0.begun.get() {
                tracing::warn!("upstream silent: no input for {:?}", self.0.silence);
            } else {
                tracing::warn!("waiting for input: none has come for {:?}", self.0.silence);
            }
        }
    }

    /// A step took this long, and whether it has caught up with the input.
    fn step(&self, took: Duration, caught_up: bool) {
        let before = self.0.busy.get();
        let busy = before + took;
        self.0.busy.set(if caught_up { Duration::ZERO } else { busy });
        if busy > self.0.slow {
            self.0.slow_steps.set(self.0.slow_steps.get() + u32::from(before <= self.0.slow));
            if self.0.condition.replace(Condition::Slow) != Condition::Slow {
                tracing::warn!("slow: behind its input for {busy:?}, limit {:?}", self.0.slow);
            }
        } else if self.0.condition.get() == Condition::Slow {
            self.0.condition.set(Condition::Fine);
        }
    }
}

/// Calls `step` whenever a message has arrived on one of the topics, a signal has come
/// or 100 ms have passed, until it returns [`Flow::End`]. `step` must take **all** waiting messages or say [`Flow::Again`].
/// With [`WaitStrategy::Poll`] it is called all the time.
///
/// # Errors
/// [`IpcError::Port`] if waiting is impossible; the errors of `step`.
pub fn attend<E: From<IpcError>>(
    wakes: &[&Wake],
    watchdog: &Watchdog,
    mut step: impl FnMut() -> Result<Flow, E>,
) -> Result<(), E> {
    let mut failure = None;
    let mut timed_step = || {
        let (began, waited) = (Instant::now(), stop::waited());
        let flow = step();
        // What it waited for its consumers is not its own slowness.
        let worked = began.elapsed().saturating_sub(stop::waited().saturating_sub(waited));
        watchdog.step(worked, !matches!(flow, Ok(Flow::Again)));
        flow.unwrap_or_else(|error| {
            failure = Some(error);
            Flow::End
        })
    };
    match watchdog.0.wait {
        WaitStrategy::Sleep => sleep_until_woken(wakes, watchdog, &mut timed_step)?,
        WaitStrategy::Poll => poll(wakes, watchdog, &mut timed_step),
    }
    failure.map_or(Ok(()), Err)
}

fn sleep_until_woken(wakes: &[&Wake], watchdog: &Watchdog, step: &mut dyn FnMut() -> Flow) -> Result<(), IpcError> {
    let failed = |topic: &'static str, cause: &dyn std::fmt::Debug| IpcError::Port {
        port: "wait set",
        topic,
        reason: format!("{cause:?}"),
    };
    let wait_set = WaitSetBuilder::new()
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<Ipc>()
        .map_err(|cause| failed("all", &cause))?;
    let mut guards = Vec::with_capacity(wakes.len());
    for wake in wakes {
        let guard = wait_set.attach_deadline(&wake.listener, watchdog.0.silence);
        guards.push(guard.map_err(|cause| failed(wake.topic.name(), &cause))?);
    }
    loop {
        let longest = match step() {
            Flow::End => return Ok(()),
            Flow::Again => {
                watchdog.input();
                continue;
            }
            Flow::Wait => TICK,
            Flow::Soon(longest) => longest.min(TICK),
        };
        // Its result only tells signals apart, which `step` sees by the stop flag.
        let _ = wait_set.wait_and_process_once_with_timeout(
            |event| {
                if guards.iter().any(|guard| event.has_missed_deadline(guard)) {
                    watchdog.missed();
                } else {
                    watchdog.input();
                }
                CallbackProgression::Continue
            },
            longest,
        );
        for wake in wakes {
            wake.drain();
        }
    }
}

fn poll(wakes: &[&Wake], watchdog: &Watchdog, step: &mut dyn FnMut() -> Flow) {
    let mut looks = 0;
    loop {
        match step() {
            Flow::End => return,
            Flow::Again => watchdog.input(),
            Flow::Wait | Flow::Soon(_) => {}
        }
        looks += 1;
        if looks == LOOKS {
            looks = 0;
            let mut events = 0;
            for wake in wakes {
                let _ = wake.listener.try_wait(|_| events += 1);
            }
            if events > 0 {
                watchdog.input();
            } else {
                watchdog.missed();
            }
        }
        std::hint::spin_loop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_is_who_does_not_catch_up_for_too_long() {
        let watchdog = Watchdog::new(&ChainConfig::default(), "tracker");
        let told = |watchdog: &Watchdog| {
            let mut health = Health::default();
            watchdog.describe(&mut health);
            (health.condition, health.slow_steps)
        };
        let [fine, slow] = [Condition::Fine, Condition::Slow].map(|condition| condition as u32);
        let most = Duration::from_millis(600); // 1 s is allowed
        watchdog.step(most, true);
        watchdog.step(most, true);
        assert_eq!(told(&watchdog), (fine, 0), "it has caught up in between");
        watchdog.step(most, false);
        watchdog.step(most, false);
        watchdog.step(most, true);
        assert_eq!(told(&watchdog), (slow, 1), "once for all of it");
        watchdog.step(most, true);
        assert_eq!(told(&watchdog), (fine, 1));
    }
}
