//! The state of the picture, filled from messages, whether they come live or from a recording.
//!
//! ```text
//! message ──▶ Picture::take ──▶ News: events, tracks that are gone
//!                 └─ state: last scan of plots, living tracks, truth, system tracks, health, events
//! ```
//!
//! Nothing here reads a clock, shared memory or a file.

pub mod events;
pub mod operated;
pub mod place;
pub mod site;
pub mod video;

use common::config::Sites;
use common::health::Health;
use common::messages::RecordedRef;
use common::status::Board;
use common::tracks::Track;
use common::units::NS_PER_S;

use events::{Event, EventLog};
use place::Placement;
use site::SitePicture;

/// Everything that can be drawn or told now.
#[derive(Debug)]
pub struct Picture {
    /// The sites, in their order.
    pub sites: Vec<SitePicture>,
    /// What the processes have said last.
    pub board: Board,
    /// What has happened.
    pub events: EventLog,
    /// Latest measurement time of any message, ns UTC.
    time_ns: u64,
}

/// What a message has changed beyond its own content.
#[derive(Debug, Default)]
pub struct News {
    /// What has happened.
    pub events: Vec<Event>,
    /// Tracks that have ended without a word: those of a tracker that was started again, or whose last message was lost.
    pub gone: Vec<Track>,
}

impl Picture {
    /// An empty picture of these sites.
    pub fn new(sites: &Sites) -> Self {
        let places = Placement::all(sites).into_iter();
        Self {
            sites: sites.all().iter().zip(places).map(|(site, place)| SitePicture::new(site, place)).collect(),
            board: Board::new(sites),
            events: EventLog::default(),
            time_ns: 0,
        }
    }

    /// Takes a message of the site at `site`; `taken_ns` is CLOCK_MONOTONIC when it came, 0 from a recording. Cells go to
    /// [`video::Gatherer`].
    pub fn take(&mut self, site: usize, message: RecordedRef<'_>, taken_ns: u64) -> News {
        self.time_ns = self.time_ns.max(message.time_ns());
        let of_site = &mut self.sites[site];
        let mut news = News::default();
        let mut texts = Vec::new();
        match message {
            RecordedRef::Plots(header, plots) => of_site.take_plots(header, plots),
            RecordedRef::Tracks(header, tracks) => {
                news.gone = of_site.take_tracks(header, tracks, taken_ns);
                texts = of_site.take_turns();
            }
            RecordedRef::Truth(header, targets) => of_site.truth = Some((*header, targets.to_vec())),
            RecordedRef::SystemTracks(header, tracks) => of_site.take_system_tracks(header, tracks),
            RecordedRef::ClutterMap(header, cells) => of_site.clutter_map = Some((*header, cells.to_vec())),
            RecordedRef::HealthReports(_, reports) => {
                for health in reports {
                    texts.extend(self.take_health(health));
                }
            }
            RecordedRef::Actions(_, actions) => {
                texts.extend(actions.iter().map(|action| of_site.operated.take(action)));
            }
            RecordedRef::Commands(..) | RecordedRef::Dwells(..) => {}
        }
        let (time_s, site) = (self.time_s(), self.sites[site].name.clone());
        let events = texts.into_iter().filter_map(|of| self.events.add(time_s, Some(&site), of));
        news.events = events.collect();
        news
    }

    /// Latest measurement time, s UTC.
    pub fn time_s(&self) -> f64 {
        self.time_ns as f64 / NS_PER_S
    }

    /// The site of this name.
    pub fn site(&self, name: &str) -> Option<(usize, &SitePicture)> {
        self.sites.iter().enumerate().find(|(_, site)| site.name == name)
    }

    fn take_health(&mut self, health: &Health) -> Vec<events::Happening> {
        let before = self.board.named(health.site.as_str()).of(health.process.as_str()).copied();
        self.board.note(health);
        before.map_or(Vec::new(), |before| events::of_health(&before, health))
    }
}
