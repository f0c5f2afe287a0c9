//! Plays recordings into a picture: forwards at any speed, by steps, from any time.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use common::config::Sites;
use common::message::END_OF_SCAN;
use common::recording::Recorded;
use common::topic::Topic;
use common::units::NS_PER_S;

use super::deck::Deck;
use super::tape::Tape;
use crate::picture::Picture;
use crate::picture::events::EventLog;
use crate::picture::video::Gatherer;
use crate::serve::Served;
use crate::wire::notices::TimeMessage;
use crate::wire::requests::{Playback, Step};

/// Between two looks at the clock while playing.
const FRAME: Duration = Duration::from_millis(20);
/// Viewers hear so often where the recording stands.
const WORD: Duration = Duration::from_millis(100);
/// The same while it stands still.
const WORD_AT_REST: Duration = Duration::from_secs(1);
/// Scans before a time from which the picture at that time is made: tracks are updated once a scan.
const SCANS_BEFORE: f64 = 3.0;
/// Scans before a time from which tracks are shown, so that they have a trail; fewer where cells would have to be read for it.
const SCANS_OF_TRAILS: f64 = 12.0;
/// A step never goes farther than so many scans: there may be nothing left to step to.
const SCANS_OF_A_STEP: f64 = 1000.0;
/// Bounds of the speed, times recorded time.
const SPEEDS: std::ops::RangeInclusive<f64> = 0.01..=1000.0;

/// What the player is told.
pub(super) enum Order {
    /// By a viewer.
    Viewer(Playback),
    /// All events of the recording are known, and what operators have done, site by site.
    Events(EventLog, Vec<(usize, Recorded)>),
}

/// Plays.
pub(super) struct Player {
    served: Arc<Served>,
    sites: Sites,
    tapes: Vec<Tape>,
    deck: Deck,
    video: Vec<Gatherer>,
    extent_ns: (u64, u64),
    at_ns: u64,
    rate: f64,
    /// When playing began and where, unless it stands still.
    since: Option<(Instant, u64)>,
    events: Option<EventLog>,
    actions: Vec<(usize, Recorded)>,
}

impl Player {
    /// A player that stands at the begin of the recordings.
    pub(super) fn new(served: Arc<Served>, sites: &Sites, tapes: Vec<Tape>, extent_ns: (u64, u64)) -> Self {
        let video = tapes.iter().map(|_| Gatherer::default()).collect();
        let deck = Deck::from(&tapes, extent_ns.0);
        let at_ns = extent_ns.0;
        Self {
            served,
            sites: sites.clone(),
            tapes,
            deck,
            video,
            extent_ns,
            at_ns,
            rate: 1.0,
            since: None,
            events: None,
            actions: Vec::new(),
        }
    }

    /// Plays as it is told until nobody is left who could tell.
    pub(super) fn run(mut self, orders: &Receiver<Order>) {
        let period_ns = self.period_s() * NS_PER_S;
        self.seek(self.extent_ns.0 + (SCANS_BEFORE * period_ns) as u64);
        let mut told = Instant::now();
        loop {
            let sleep = if self.since.is_some() { FRAME } else { WORD_AT_REST };
            match orders.recv_timeout(sleep) {
                Ok(order) => {
                    let (picture, other) = last_picture(order, orders);
                    for order in [picture].into_iter().chain(other) {
                        self.obey(order);
                    }
                    self.tell();
                }
                Err(RecvTimeoutError::Timeout) if self.since.is_none() => self.tell(), // somebody may have come
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return,
            }
            if let Some((since, from_ns)) = self.since {
                let played_ns = since.elapsed().as_nanos() as f64 * self.rate;
                self.play_to(from_ns.saturating_add(played_ns as u64));
                if self.since.is_none() || told.elapsed() >= WORD {
                    told = Instant::now();
                    self.tell();
                }
            }
        }
    }

    fn obey(&mut self, order: Order) {
        let moved = matches!(order, Order::Viewer(Playback::Seek(_) | Playback::Step(..)));
        match order {
            Order::Events(events, actions) => {
                self.served.know_events(&events);
                self.actions = actions;
                self.events = Some(events);
            }
            Order::Viewer(Playback::Play(rate)) => {
                self.rate = rate.clamp(*SPEEDS.start(), *SPEEDS.end());
                if self.at_ns >= self.extent_ns.1 {
                    self.seek(self.extent_ns.0);
                }
                self.since = Some((Instant::now(), self.at_ns));
            }
            Order::Viewer(Playback::Pause) => self.since = None,
            // What plays shows itself.
            Order::Viewer(Playback::Again) if self.since.is_none() => self.seek(self.at_ns),
            Order::Viewer(Playback::Again) => {}
            Order::Viewer(Playback::Seek(time_s)) => self.seek((time_s.max(0.0) * NS_PER_S) as u64),
            Order::Viewer(Playback::Step(step, by)) => {
                self.since = None;
                self.step(step, by);
            }
        }
        if moved && self.since.is_some() {
            self.since = Some((Instant::now(), self.at_ns));
        }
    }

    /// Time of a scan, s.
    fn period_s(&self) -> f64 {
        self.sites.all().iter().map(common::config::ChainConfig::scan_period_s).fold(0.0, f64::max)
    }

    /// The picture at a time, from the scans before it: tracks with their trails, plots, and the video of the last scan.
    fn seek(&mut self, time_ns: u64) {
        let time_ns = time_ns.clamp(self.extent_ns.0, self.extent_ns.1);
        let has_cells = self.sites.all().iter().any(|site| site.recorder.dwells);
        let before_ns = |scans: f64| time_ns.saturating_sub((scans * self.period_s() * NS_PER_S) as u64);
        let (whole_ns, video_ns) = (before_ns(SCANS_BEFORE), before_ns(1.0));
        let from_ns = if has_cells { whole_ns } else { before_ns(SCANS_OF_TRAILS) };
        self.deck = Deck::from(&self.tapes, from_ns);
        let mut picture = Picture::new(&self.sites);
        for (site, before) in picture.sites.iter_mut().zip(&self.served.picture().sites) {
            site.models.clone_from(&before.models); // known once, whatever the time
        }
        if let Some(events) = &self.events {
            picture.events = events.clone();
        }
        // Zones and labels last.
        for (site, action) in self.actions.iter().filter(|(_, action)| action.by_ref().time_ns() < from_ns) {
            picture.take(*site, action.by_ref(), 0);
        }
        self.at_ns = time_ns;
        self.video.fill_with(Gatherer::default);
        let served = Arc::clone(&self.served);
        served.replace(picture, || {
            while let Some((site, message)) = self.deck.next_until(time_ns) {
                // A chunk begins before the time that it was chosen for.
                let least_ns = match message.by_ref().topic() {
                    Topic::Dwells => video_ns,
                    Topic::Tracks => from_ns,
                    topic if topic.is_data() => whole_ns,
                    _ => 0,
                };
                if message.by_ref().time_ns() >= least_ns {
                    self.show(site, &message);
                }
            }
        });
    }

    fn play_to(&mut self, time_ns: u64) {
        while let Some((site, message)) = self.deck.next_until(time_ns) {
            self.show(site, &message);
        }
        self.at_ns = time_ns.min(self.extent_ns.1);
        if self.at_ns == self.extent_ns.1 {
            self.since = None;
        }
    }

    fn step(&mut self, step: Step, by: i32) {
        let (sites, period_s) = (self.sites.first(), self.period_s());
        let step_s = match step {
            Step::Scan => period_s,
            Step::Sector => period_s / f64::from(sites.sectors_per_scan().max(1)),
        };
        if by < 0 {
            let back_ns = f64::from(by.unsigned_abs()) * step_s * NS_PER_S;
            return self.seek(self.at_ns.saturating_sub(back_ns as u64));
        }
        let limit_ns = self.at_ns.saturating_add((SCANS_OF_A_STEP * period_s * NS_PER_S) as u64);
        for _ in 0..by.unsigned_abs().min(SCANS_OF_A_STEP as u32) {
            while let Some((site, message)) = self.deck.next_until(limit_ns) {
                let place = message.by_ref().place();
                self.at_ns = self.at_ns.max(place.time_ns).min(self.extent_ns.1);
                self.show(site, &message);
                let ends_scan = place.flags & END_OF_SCAN != 0;
                if matches!(message, Recorded::Tracks(..)) && site == 0 && (step == Step::Sector || ends_scan) {
                    break;
                }
            }
        }
        if self.deck.next_ns().is_none() {
            self.at_ns = self.extent_ns.1;
        }
    }

    fn show(&mut self, site: usize, message: &Recorded) {
        match message {
            Recorded::Dwells(header, cells) => {
                if self.served.wants_video()
                    && let Some(sector) = self.video[site].take(header, cells)
                {
                    self.served.take_video(site, &sector);
                }
            }
            other => self.served.take(site, other.by_ref(), 0),
        }
    }

    fn tell(&self) {
        let (at_s, playing) = (self.at_ns as f64 / NS_PER_S, self.since.is_some());
        self.served.say(&TimeMessage::new(at_s, playing, self.rate));
    }
}

/// Of several pictures that are asked for one after the other, the last will do; with the order of another kind that ended them. To
/// show the present time again adds nothing to a jump.
fn last_picture(mut order: Order, orders: &Receiver<Order>) -> (Order, Option<Order>) {
    while matches!(order, Order::Viewer(Playback::Again | Playback::Seek(_))) {
        match orders.try_recv() {
            Ok(Order::Viewer(Playback::Again)) => {}
            Ok(next @ Order::Viewer(Playback::Seek(_))) => order = next,
            Ok(other) => return (order, Some(other)),
            Err(_) => break,
        }
    }
    (order, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::sync_channel;

    fn wanted(order: Option<&Order>) -> Option<Playback> {
        match order {
            Some(Order::Viewer(wanted)) => Some(*wanted),
            _ => None,
        }
    }

    /// Viewers that ask again and again for more of the present time are shown it once.
    #[test]
    fn a_flood_of_requests_for_the_same_picture_is_one() {
        let (sender, orders) = sync_channel(10_000);
        let send = |wanted| sender.try_send(Order::Viewer(wanted)).expect("room");
        (0..4000).for_each(|_| send(Playback::Again));
        (0..4000).for_each(|second| send(Playback::Seek(f64::from(second))));
        (0..1000).for_each(|_| send(Playback::Again));
        send(Playback::Pause);
        send(Playback::Again);
        let (picture, other) = last_picture(orders.recv().expect("an order"), &orders);
        assert_eq!(
            (wanted(Some(&picture)), wanted(other.as_ref())),
            (Some(Playback::Seek(3999.0)), Some(Playback::Pause))
        );
        let (picture, other) = last_picture(orders.recv().expect("an order"), &orders);
        assert_eq!((wanted(Some(&picture)), wanted(other.as_ref())), (Some(Playback::Again), None));
    }
}
