//! The tracker: one call per `plots` message, the tracks brought up to date by it.
//!
//! ```text
//!  plots of a sector ─▶ store, ordered by beam angle
//!  every track whose gates the beam has passed, up to eight at once:
//!      gate ─▶ associate ─▶ update ─▶ existence ─▶ predict its next detection opportunity
//!  every plot that no confirmed track can still claim: clutter map, pair with last turn ─▶ tentative track
//! ```
//!
//! A track is processed once per pass of the beam, as soon as the upper azimuth edge of its gates is
//! covered. All angles are unwrapped ([`crate::beam::sweep`]), so north is no special place, and grow with time, whichever way
//! the antenna turns. Nothing here
//! depends on the time of day, on threads or on the order of plots in a message.

mod births;
mod duplicates;
mod forecast;
mod taking_over;
mod updates;

use std::f64::consts::TAU;

use common::clutter_map::{AZIMUTHS, ClutterCell, ClutterMapHeader, RANGES};
use common::commands::Command;
use common::config::{ConfigError, TrackerConfig};
use common::health::{FalseAlarms, Reject, Rejected};
use common::message::{END_OF_SCAN, END_OF_STREAM};
use common::plots::{Plot, PlotsHeader};
use common::tracks::{TERMINATED, Track};

use crate::association::Rules;
use crate::beam::agenda::Agenda;
use crate::beam::sweep::{Continuation, Sweep};
use crate::constants::LATE_CELLS;
use crate::environment::{self, Environment};
use crate::filter::{Machine, layout_of};
use crate::operator::Operator;
use crate::plots::false_alarm_map::FalseAlarmMap;
use crate::plots::measurement::Measurement;
use crate::plots::store::{Entry, PlotStore};
use crate::tracks::handle::Handle;
use crate::tracks::store::TrackStore;
use births::Births;
use forecast::Forecast;
use updates::Updates;

/// What became of one message.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Processed {
    /// Input that was not used, by reason.
    pub rejected: Rejected,
    /// Tracks alive, of any state.
    pub alive: u32,
    /// Of these confirmed or coasting.
    pub confirmed: u32,
}

/// The tracker of one radar.
#[derive(Debug)]
pub struct Tracker {
    config: TrackerConfig,
    rules: Rules,
    sweep: Sweep,
    plots: PlotStore,
    machine: Machine,
    environment: Option<Environment>,
    tracks: TrackStore,
    agenda: Agenda,
    next_id: u64,
    /// Of the tracks, those that are confirmed or coasting.
    confirmed: u32,
    /// Places of the tracks that this message has ended, reused.
    ended: Vec<usize>,
    updates: Updates,
    forecast: Forecast,
    births: Births,
    operator: Operator,
    /// Last messages of the tracks of a tracker before, until the first plots.
    before: Vec<Track>,
}

impl Tracker {
    /// An empty tracker; track numbers count from `first_id`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn new(config: &TrackerConfig, first_id: u64) -> Result<Self, ConfigError> {
        config.check()?;
        let (layout, rules) = (layout_of(config), Rules::new(config));
        Ok(Self {
            config: config.clone(),
            rules,
            sweep: Sweep::default(),
            plots: PlotStore::default(),
            machine: Machine::default(),
            environment: None,
            tracks: TrackStore::new(&layout),
            agenda: Agenda::default(),
            next_id: first_id,
            confirmed: 0,
            ended: Vec::with_capacity(256),
            updates: Updates::new(&layout, rules.inflation),
            forecast: Forecast::new(&layout),
            births: Births::new(&layout),
            operator: Operator::default(),
            before: Vec::new(),
        })
    }

    /// With other instructions than the machine's best, to compare.
    #[must_use]
    pub fn on(mut self, machine: Machine) -> Self {
        self.updates.on(machine);
        Self { machine, ..self }
    }

    /// Processes the plots of one sector and replaces `tracks` by the tracks that it brought up to date:
    /// processed, started, or ended (once, as `TERMINATED`).
    pub fn process_plots(&mut self, header: &PlotsHeader, plots: &[Plot], tracks: &mut Vec<Track>) -> Processed {
        let mut processed = Processed::default();
        tracks.clear();
        if !environment::is_possible(header) {
            processed.rejected.count(Reject::BadHeader);
            return self.counted(processed);
        }
        match self.sweep.advance(header) {
            Continuation::Onwards => {}
            Continuation::Otherwise => self.meet_otherwise(header),
            Continuation::Late => {
                for _ in plots {
                    processed.rejected.count(Reject::Late);
                }
                return self.counted(processed);
            }
            Continuation::Anew => {
                self.plots.clear();
                self.end_all(tracks);
                // Its clutter map counts the turns of the stream that has ended.
                self.environment = None;
            }
        }
        self.end_dropped(tracks);
        // Out of the tracker, so that both can be borrowed side by side.
        let mut environment = match self.environment.take() {
            Some(environment) if environment.is_described_by(header) => environment,
            _ => Environment::new(header, &self.config, self.machine),
        };
        environment.turn_in(header.scan_period_s, &self.config);
        self.go_on(&environment, tracks);
        environment.false_alarms.test(header, environment.radar.dimensions());
        for (index, plot) in plots.iter().enumerate() {
            if let Err(reason) = self.store(header, index, plot) {
                processed.rejected.count(reason);
            }
        }
        self.plots.sort(&environment.radar, self.sweep.turning());
        let covered_rad = self.sweep.covered_to_rad();
        self.update_due(covered_rad, header.has(END_OF_STREAM), &environment, tracks);
        self.start_tracks(covered_rad, &mut environment, tracks);
        self.plots.drop_before(covered_rad);
        self.free_ended();
        if header.has(END_OF_SCAN) {
            environment.false_alarms.end_turn();
            self.operator.end_turn();
        }
        self.environment = Some(environment);
        self.counted(processed)
    }

    /// Carries out what an operator asks, before the next plots; one of the outcomes of [`common::commands`].
    pub fn carry_out(&mut self, command: &Command) -> u32 {
        if let Some(outcome) = self.carry_out_before(command) {
            return outcome;
        }
        let place = self.tracks.alive().find(|&place| self.tracks[place].id == command.track_id);
        self.operator.carry_out(command, place.map(|place| self.tracks.handle(place)))
    }

    /// The zones that an operator has drawn, each as the command that has set it.
    pub fn zones(&self) -> &[Command] {
        self.operator.zones()
    }

    /// What has become since the last call of commands that take their time.
    pub fn take_told(&mut self) -> impl Iterator<Item = Command> + use<'_> {
        self.operator.take_told()
    }

    /// The antenna turns otherwise than before: tracks wait for it where it comes from there, and plots of before begin none.
    fn meet_otherwise(&mut self, header: &PlotsHeader) {
        let Self { sweep, plots, tracks, agenda, updates, .. } = self;
        plots.clear();
        agenda.clear();
        let places: Vec<usize> = tracks.alive().collect();
        for place in places {
            let track = &mut tracks[place];
            // What is predicted is of another time, and predicted anew before it is used.
            track.next.angle_rad = sweep.next_at(header, track.next.position_m);
            track.angle_rad = track.next.angle_rad - TAU;
            track.last.angle_rad = track.angle_rad;
            track.searched_to_rad = f64::NEG_INFINITY;
            updates.rivals.record(place, &tracks[place]);
            agenda.add(tracks.handle(place), &tracks[place].next);
        }
    }

    /// Ends the tracks that an operator has dropped.
    fn end_dropped(&mut self, messages: &mut Vec<Track>) {
        while let Some(handle) = self.operator.dropped.pop() {
            let Some(place) = self.tracks.find(handle) else { continue };
            self.end(place);
            if let Some(environment) = &self.environment {
                self.forecast.tell(environment, &self.tracks, place, messages);
            }
        }
        self.free_ended();
    }

    /// Keeps a plot at the angle of the beam, or says why not.
    fn store(&mut self, header: &PlotsHeader, index: usize, plot: &Plot) -> Result<(), Reject> {
        let measurement = Measurement::from_plot(plot).ok_or(Reject::BadPlot)?;
        let angle_rad = self.sweep.unwrap(header, plot.azimuth_rad);
        let tolerance_rad = LATE_CELLS * header.cell_azimuth_rad;
        let angle_rad = self.plots.admit(angle_rad, tolerance_rad).ok_or(Reject::Late)?;
        let (seq, index) = (header.seq, index as u32);
        self.plots.push(Entry { angle_rad, seq, index, explained: 0.0, claimed: 0.0, owner: None }, measurement);
        Ok(())
    }

    /// The track store.
    pub fn tracks(&self) -> &TrackStore {
        &self.tracks
    }

    /// False alarms of the radar, as far as tracks do not explain its plots.
    pub fn false_alarms(&self) -> FalseAlarms {
        self.environment.as_ref().map_or_else(FalseAlarms::default, |environment| environment.false_alarms.rate())
    }

    /// Replaces `cells` by the map of false plots after the plots under `plots`; `None` while nothing has been learnt.
    pub fn clutter_map(&self, plots: &PlotsHeader, cells: &mut Vec<ClutterCell>) -> Option<ClutterMapHeader> {
        let environment = self.environment.as_ref()?;
        let (scans, tested) = environment.false_alarms.tested();
        let map = environment.false_alarms.map();
        cells.clear();
        cells.extend(map.cells(|place| environment.clutter.expected_per_cell(&place)));
        (scans > 0.0 && map.range_step_m() > 0.0).then(|| ClutterMapHeader {
            time_ns: plots.time_ns,
            azimuth_step_rad: FalseAlarmMap::AZIMUTH_STEP_RAD,
            range_step_m: map.range_step_m(),
            scans,
            tested,
            pfa: plots.pfa,
            least_expected: environment.clutter.least_expected(),
            scan: plots.scan,
            azimuths: AZIMUTHS as u32,
            ranges: RANGES as u32,
            ..ClutterMapHeader::default()
        })
    }

    fn counted(&self, mut processed: Processed) -> Processed {
        processed.alive = self.tracks.len() as u32;
        processed.confirmed = self.confirmed;
        processed
    }

    /// Ends every track: measurement time went back.
    fn end_all(&mut self, messages: &mut Vec<Track>) {
        let places: Vec<usize> = self.tracks.alive().collect();
        for place in places {
            self.end(place);
            if let Some(environment) = &self.environment {
                self.forecast.tell(environment, &self.tracks, place, messages);
            }
        }
        self.free_ended();
        self.agenda.clear();
    }

    /// Ends a track; its place is free after the message.
    fn end(&mut self, place: usize) {
        let track = &mut self.tracks[place];
        self.confirmed -= u32::from(track.life.is_confirmed());
        track.life.state = TERMINATED;
        self.updates.rivals.forget(place);
        self.ended.push(place);
    }

    fn free_ended(&mut self) {
        for place in self.ended.drain(..) {
            self.tracks.free(place);
        }
    }

    /// Ends a track and says so in `messages`, which may hold one of it.
    fn end_and_tell(&mut self, place: usize, environment: &Environment, messages: &mut Vec<Track>) {
        self.end(place);
        let id = self.tracks[place].id;
        match messages.iter_mut().find(|message| message.id == id) {
            Some(message) => message.state_code = TERMINATED,
            None => self.forecast.tell(environment, &self.tracks, place, messages),
        }
    }

    /// A track that is alive.
    fn find(&self, handle: Option<Handle>) -> Option<usize> {
        handle.and_then(|handle| self.tracks.find(handle))
    }
}
