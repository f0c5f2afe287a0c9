//! The picture served: its state, those who look at it, and how messages reach them.
//!
//! ```text
//! feed, player ──▶ Served::take ──▶ picture ──▶ hub ──▶ queue of each viewer ──▶ WebSocket
//!                                      └──────────────▶ HTTP
//! ```
//!
//! Messages are taken by one thread and sent by another, which runs all connections. They share the picture: a message is
//! put into it and into the queues under one lock, so that whoever joins in between misses nothing and gets nothing twice.

mod access;
mod client;
mod hub;
mod live;
mod operators;
mod routes;
mod server;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use axum::extract::ws::Message;
use common::clutter_map::ClutterMapHeader;
use common::config::Sites;
use common::message::Stamps;
use common::messages::RecordedRef;
use common::status;
use common::time::monotonic_ns;
use common::tracks::{Track, TracksHeader};
use common::turning::Turning;
use serde::Serialize;

use crate::picture::Picture;
use crate::picture::events::EventLog;
use crate::picture::site::SitePicture;
use crate::picture::video::SectorVideo;
use crate::wire::SectorMessage;
use crate::wire::clutter::{MAPS, MapRow, MapsHead};
use crate::wire::columns::{Column, binary, json, text};
use crate::wire::explain::TrackMessage;
use crate::wire::hello::{Chain, Extent, Hello};
use crate::wire::notices::{HealthMessage, Reset};
use crate::wire::operator::OperatorMessage;
use crate::wire::plots::{PLOTS, PlotRow, PlotsHead};
use crate::wire::requests::{Encoding, Playback, Want};
use crate::wire::tracks::{StampsUs, TRACKS, TrackRow, TracksHead};
use crate::wire::truth::{SYSTEM_TRACKS, ScanHead, SystemRow, TRUTH, TruthRow};

pub use access::Access;
use client::{Client, State};
pub use hub::Counts;
use hub::{Hub, Kind};
use operators::Operators;
pub use server::{bind, serve};

/// Health is sent about so often.
const HEALTH: Duration = Duration::from_secs(1);

/// Takes what viewers want of a recording, or says that too much waits already.
pub type Player = Box<dyn Fn(Playback) -> bool + Send + Sync>;

/// A picture and those who look at it.
pub struct Served {
    sites: Sites,
    access: Access,
    hub: Hub,
    picture: Mutex<Picture>,
    /// When health was sent last.
    told: Mutex<Option<Instant>>,
    recording: Option<(Extent, Player)>,
    operators: Operators,
}

impl Served {
    /// The picture of a running chain.
    pub fn live(sites: &Sites, access: Access) -> Self {
        Self::new(sites, access, None)
    }

    /// The picture of a recording of this extent, whose player is told what viewers want.
    pub fn recording(sites: &Sites, access: Access, extent: Extent, player: Player) -> Self {
        Self::new(sites, access, Some((extent, player)))
    }

    fn new(sites: &Sites, access: Access, recording: Option<(Extent, Player)>) -> Self {
        let hub = Hub::new(sites.first().display.clients as usize);
        let picture = Mutex::new(Picture::new(sites));
        Self {
            sites: sites.clone(),
            access,
            hub,
            picture,
            told: Mutex::default(),
            recording,
            operators: Operators::default(),
        }
    }

    /// The picture as it is.
    pub fn picture(&self) -> MutexGuard<'_, Picture> {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What has become of messages and viewers so far.
    pub fn counts(&self) -> Counts {
        self.hub.counts()
    }

    /// Whether anybody wants video: without that, nobody need read cells.
    pub fn wants_video(&self) -> bool {
        self.hub.wants_video()
    }

    /// Takes a message of the site at `site` and sends what viewers want of it; `taken_ns` is CLOCK_MONOTONIC when it came, 0
    /// from a recording.
    pub fn take(&self, site: usize, message: RecordedRef<'_>, taken_ns: u64) {
        let mut picture = self.picture();
        let models = picture.sites[site].models.len();
        let labels = picture.sites[site].operated.labels.len();
        let news = picture.take(site, message, taken_ns);
        let (picture, of_site) = (&*picture, &picture.sites[site]);
        match message {
            RecordedRef::Plots(header, plots) => {
                self.hub.publish_text(Kind::Beam, || {
                    let place = (header.sector, header.sectors_per_scan);
                    text(&SectorMessage::new(&of_site.name, header.scan, place, header.turning(), picture.time_s()))
                });
                let head = PlotsHead::new(&of_site.name, header);
                self.hub.publish(Kind::Plots, |as_| table(as_, &head, &PLOTS, &PlotRow::all(plots, &of_site.place)));
            }
            RecordedRef::Tracks(header, tracks) => {
                if of_site.plots.is_empty() {
                    self.hub.publish_text(Kind::Beam, || {
                        let (place, turning) =
                            ((header.sector, header.sectors_per_scan), Turning::of_flags(header.flags));
                        text(&SectorMessage::new(&of_site.name, header.scan, place, turning, picture.time_s()))
                    });
                }
                if of_site.operated.labels.len() != labels {
                    self.hub.publish_text(Kind::All, || text(&OperatorMessage::new(of_site)));
                }
                if of_site.models.len() > models {
                    self.hub.publish_text(Kind::All, || self.hello(picture));
                    for site in &picture.sites {
                        self.hub.publish_text(Kind::All, || text(&OperatorMessage::new(site)));
                    }
                }
                let all = || tracks.iter().chain(&news.gone);
                self.hub.publish(Kind::Tracks, |as_| tracks_message(as_, of_site, header, all(), taken_ns));
                if self.hub.follows(site) {
                    let find = |id: u64| all().find(|track| track.id == id);
                    let way = (header.stamps, taken_ns);
                    self.hub.publish_followed(site, |id| Some(explained(of_site, find(id)?, &way)));
                }
            }
            RecordedRef::Truth(header, targets) => {
                let head = ScanHead::of_truth(&of_site.name, header);
                let rows = || targets.iter().map(|target| TruthRow::new(target, &of_site.place)).collect::<Vec<_>>();
                self.hub.publish(Kind::Truth, |as_| table(as_, &head, &TRUTH, &rows()));
            }
            RecordedRef::SystemTracks(header, tracks) => {
                let head = ScanHead::of_system_tracks(&of_site.name, header);
                let rows = || tracks.iter().map(|track| SystemRow::new(track, &of_site.place)).collect::<Vec<_>>();
                self.hub.publish(Kind::SystemTracks, |as_| table(as_, &head, &SYSTEM_TRACKS, &rows()));
            }
            RecordedRef::ClutterMap(header, _) => {
                self.hub.publish(Kind::Maps, |as_| maps_message(as_, of_site, header));
            }
            RecordedRef::HealthReports(..) => self.tell_health(picture),
            RecordedRef::Actions(..) => self.hub.publish_text(Kind::All, || text(&OperatorMessage::new(of_site))),
            RecordedRef::Commands(..) | RecordedRef::Dwells(..) => {}
        }
        for event in &news.events {
            self.hub.publish_text(Kind::Events, || text(event));
        }
    }

    /// Sends the video of a sector of the site at `site`.
    pub fn take_video(&self, site: usize, video: &SectorVideo) {
        self.hub.publish_video(site, &self.sites.all()[site].site.name, video);
    }

    /// Sends a message to all viewers as it is: where a recording stands.
    pub fn say(&self, message: &impl Serialize) {
        self.hub.publish_text(Kind::All, || text(message));
    }

    /// All that happens in a recording is known now: viewers are told.
    pub fn know_events(&self, events: &EventLog) {
        let mut picture = self.picture();
        picture.events = events.clone();
        for event in picture.events.since(0) {
            self.hub.publish_text(Kind::Events, || text(event));
        }
    }

    /// Puts another picture in the place of this one, as after a jump in a recording, and shows it to all viewers, with what has led to
    /// the present picture: `lead` hands it over, message by message. Of more than viewers have room for, they see the picture alone.
    pub fn replace(&self, other: Picture, lead: impl FnOnce()) {
        let mut picture = self.picture();
        *picture = other;
        self.hub.begin_anew(|state| Self::show_all(&picture, state));
        drop(picture);
        self.hub.set_each_led(true);
        lead();
        self.hub.set_each_led(false);
    }

    /// Gives a viewer that has just come what everybody is told first. The picture is locked before a viewer, everywhere.
    fn greet(&self, client: &Client) {
        let picture = self.picture();
        client.with(|state| {
            state.greet(Message::Text(self.hello(&picture).into()));
            Self::tell_operators(&picture, state);
        });
    }

    /// Puts the whole picture into the queue of a viewer, after word that it begins anew.
    fn show_all(picture: &Picture, state: &mut State) {
        state.push_always(Message::Text(text(&Reset::default()).into()));
        Self::tell_operators(picture, state);
        Self::show(picture, state, &Want::default());
        if let Some((site, id)) = state.follow
            && let Some(of) = picture.sites[site].tracks.get(&id)
        {
            state.push_always(Message::Text(explained(&picture.sites[site], &of.track, &of.way).into()));
        }
        state.has_picture();
    }

    /// Puts into the queue of a viewer what operators have done.
    fn tell_operators(picture: &Picture, state: &mut State) {
        for site in &picture.sites {
            state.push_always(Message::Text(text(&OperatorMessage::new(site)).into()));
        }
    }

    /// Puts into the queue of a viewer what there is of all that it wants and did not want `before`.
    fn show(picture: &Picture, state: &mut State, before: &Want) {
        let (want, encoding) = (state.want, state.encoding);
        for site in &picture.sites {
            let name = &site.name;
            if want.plots && !before.plots {
                for (header, plots) in site.last_scan() {
                    let rows = PlotRow::all(plots, &site.place);
                    state.push_always(table(encoding, &PlotsHead::new(name, header), &PLOTS, &rows));
                }
            }
            if want.tracks
                && !before.tracks
                && let Some(header) = &site.tracks_header
            {
                // They came one by one, before it asked: no way to a screen begins here.
                let header = TracksHeader { stamps: Stamps::default(), ..*header };
                let tracks = site.tracks.values().map(|of| &of.track);
                state.push_always(tracks_message(encoding, site, &header, tracks, 0));
            }
            if want.truth
                && !before.truth
                && let Some((header, targets)) = &site.truth
            {
                let rows: Vec<_> = targets.iter().map(|target| TruthRow::new(target, &site.place)).collect();
                state.push_always(table(encoding, &ScanHead::of_truth(name, header), &TRUTH, &rows));
            }
            if want.system_tracks
                && !before.system_tracks
                && let Some((header, tracks)) = &site.system_tracks
            {
                let rows: Vec<_> = tracks.iter().map(|track| SystemRow::new(track, &site.place)).collect();
                state.push_always(table(encoding, &ScanHead::of_system_tracks(name, header), &SYSTEM_TRACKS, &rows));
            }
            if want.maps
                && !before.maps
                && let Some((header, _)) = &site.clutter_map
            {
                state.push_always(maps_message(encoding, site, header));
            }
        }
        if want.health && !before.health && !picture.board.is_empty() {
            state.push_always(Message::Text(health_text(picture).into()));
        }
        if want.events && !before.events {
            picture.events.since(0).for_each(|event| state.push_always(Message::Text(text(event).into())));
        }
    }

    fn hello(&self, picture: &Picture) -> String {
        text(&Hello::new(&self.chain(picture)))
    }

    /// What there is to see.
    fn chain(&self, picture: &Picture) -> Chain {
        let extent = self.recording.as_ref().map(|(extent, _)| *extent);
        Chain { control: self.may_act(), ..Chain::new(&self.sites, picture, extent) }
    }

    fn tell_health(&self, picture: &Picture) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.is_none_or(|told| told.elapsed() >= HEALTH) && self.hub.wants(Kind::Health) {
            *told = Some(Instant::now());
            self.hub.publish_text(Kind::Health, || health_text(picture));
        }
    }
}

fn health_text(picture: &Picture) -> String {
    text(&HealthMessage::new(picture.time_s(), status::to_json(&picture.board)))
}

/// A track, explained now.
fn explained(site: &SitePicture, track: &Track, way: &(Stamps, u64)) -> String {
    text(&TrackMessage::new(site, track, way, monotonic_ns()))
}

fn tracks_message<'a>(
    encoding: Encoding,
    site: &SitePicture,
    header: &TracksHeader,
    tracks: impl Iterator<Item = &'a Track>,
    taken_ns: u64,
) -> Message {
    let rows: Vec<_> = tracks.map(|track| TrackRow::new(track, site)).collect();
    let stamps = StampsUs::new(&header.stamps, taken_ns, if taken_ns == 0 { 0 } else { monotonic_ns() });
    table(encoding, &TracksHead::new(&site.name, header, stamps), &TRACKS, &rows)
}

fn maps_message(encoding: Encoding, site: &SitePicture, header: &ClutterMapHeader) -> Message {
    table(encoding, &MapsHead::new(&site.name, header), &MAPS, &map_rows(site))
}

/// The clutter map of a site; empty before it is known.
fn map_rows(site: &SitePicture) -> Vec<MapRow> {
    let (from_m, to_m) = site.ranges_m;
    let rows = |(header, cells): &(_, Vec<_>)| MapRow::all(header, cells, to_m.map(|to_m| (from_m, to_m)));
    site.clutter_map.as_ref().map(rows).unwrap_or_default()
}

fn table<H: Serialize, R>(encoding: Encoding, header: &H, columns: &[Column<R>], rows: &[R]) -> Message {
    match encoding {
        Encoding::Binary => Message::Binary(binary(header, columns, rows).into()),
        Encoding::Json => Message::Text(json(header, columns, rows).into()),
    }
}
