//! What comes from the sites through shared memory, as an observer: every topic is taken when it waits, cells only while
//! somebody looks at video.

use std::time::Duration;

use common::config::{ChainConfig, Sites};
use common::health::{Health, Intake};
use common::ipc::{Flow, IpcError, Station, Subscriber, Turn, Wake};
use common::message::END_OF_STREAM;
use common::messages::{Dwells, ForTopic, Message, RecordedRef};
use common::time::monotonic_ns;
use common::topic::Topic;
use common::topology::{self, DISPLAY, Stage};

use crate::picture::video::Gatherer;
use crate::serve::Served;

/// Cells are looked for so often while somebody looks at video. To be woken by each dwell would cost its publisher a system
/// call; at this pace a queue of 32 holds 4,000 dwells a second.
const CELLS: Duration = Duration::from_millis(8);

/// The feeds of all sites.
pub struct Feed {
    sites: Vec<SiteFeed>,
}

/// What comes from one site.
struct SiteFeed {
    station: Station,
    inputs: Vec<Box<dyn Input>>,
    has_cells: bool,
    cells: Option<Subscriber<Dwells>>,
    /// What earlier subscribers to cells have received and missed.
    cells_before: Intake,
    video: Gatherer,
    scan: u32,
    ended: bool,
}

/// One topic of a site.
trait Input {
    /// Hands over messages that wait, for a turn.
    fn take_waiting(&self, turn: &Turn, take: &mut dyn FnMut(RecordedRef<'_>)) -> Result<(), IpcError>;

    fn topic(&self) -> Topic;

    fn intake(&self) -> Intake;

    fn take_most_waiting(&self) -> Option<u32>;
}

impl<M: Message> Input for Subscriber<M> {
    fn take_waiting(&self, turn: &Turn, take: &mut dyn FnMut(RecordedRef<'_>)) -> Result<(), IpcError> {
        while !turn.is_over() {
            let Some(message) = self.receive()? else { break };
            take(M::borrowed(message.header(), message.elements()));
        }
        Ok(())
    }

    fn topic(&self) -> Topic {
        M::TOPIC
    }

    fn intake(&self) -> Intake {
        Subscriber::intake(self)
    }

    fn take_most_waiting(&self) -> Option<u32> {
        Subscriber::take_most_waiting(self)
    }
}

impl Feed {
    /// Subscribes at all sites, from the station of the first one.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn open(first: &Station, sites: &Sites) -> Result<Self, IpcError> {
        let sites = sites.all().iter().map(|site| SiteFeed::open(first, site)).collect::<Result<_, _>>()?;
        Ok(Self { sites })
    }

    /// What wakes it: tracks come last of a sector, and health is in no hurry.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn wakes(&self) -> Result<Vec<Wake>, IpcError> {
        self.sites.iter().map(|site| site.station.wake(Topic::Tracks)).collect()
    }

    /// Takes what waits; when to come back.
    ///
    /// # Errors
    /// [`IpcError`].
    pub fn take_waiting(&mut self, served: &Served) -> Result<Flow, IpcError> {
        let (turn, video) = (Turn::begin(), served.wants_video());
        for (index, site) in self.sites.iter_mut().enumerate() {
            site.take_waiting(index, served, &turn)?;
            site.take_cells(index, served, &turn, video)?;
        }
        Ok(match turn.flow() {
            Flow::Wait if video => Flow::Soon(CELLS),
            flow => flow,
        })
    }

    /// Whether the tracks of all sites have ended.
    pub fn has_ended(&self) -> bool {
        self.sites.iter().all(|site| site.ended)
    }

    /// Writes what has come into a health report: the scan, and all sites together; of queues, the fullest one.
    pub fn describe(&self, health: &mut Health) {
        health.scan = self.sites.iter().map(|site| site.scan).max().unwrap_or(0);
        for topic in Topic::ALL.into_iter().filter(|topic| topic.is_counted()) {
            let of_topic = self.sites.iter().filter_map(|site| site.intake(topic));
            if let Some(intake) = of_topic.reduce(Intake::plus) {
                health.set_intake(topic, intake);
                health.set_waiting(topic, self.sites.iter().filter_map(|site| site.take_most_waiting(topic)).max());
            }
        }
    }
}

impl SiteFeed {
    fn open(first: &Station, site: &ChainConfig) -> Result<Self, IpcError> {
        struct Open<'a>(&'a Station);
        impl ForTopic for Open<'_> {
            type Out = Result<Box<dyn Input>, IpcError>;

            fn call<M: Message>(self) -> Self::Out {
                Ok(Box::new(self.0.subscriber::<M>()?))
            }
        }
        let station = first.at(site);
        let topics = Stage::from_name(DISPLAY).into_iter().flat_map(|stage| stage.inputs).map(|input| input.topic);
        let inputs = topics.filter(|topic| !topic.is_bulk()).map(|topic| topic.apply(Open(&station)));
        Ok(Self {
            inputs: inputs.collect::<Result<_, _>>()?,
            has_cells: topology::runs(site, "plot-extractor"),
            cells: None,
            cells_before: Intake::default(),
            video: Gatherer::default(),
            scan: 0,
            ended: false,
            station,
        })
    }

    fn take_waiting(&mut self, index: usize, served: &Served, turn: &Turn) -> Result<(), IpcError> {
        let (scan, ended) = (&mut self.scan, &mut self.ended);
        for input in &self.inputs {
            input.take_waiting(turn, &mut |message| {
                if let RecordedRef::Tracks(header, _) = message {
                    *scan = header.scan;
                    *ended = header.has(END_OF_STREAM);
                }
                served.take(index, message, monotonic_ns());
            })?;
        }
        Ok(())
    }

    fn take_cells(&mut self, index: usize, served: &Served, turn: &Turn, wanted: bool) -> Result<(), IpcError> {
        if !wanted || !self.has_cells {
            if let Some(cells) = self.cells.take() {
                self.cells_before = self.cells_before.plus(cells.intake());
            }
            return Ok(());
        }
        if self.cells.is_none() {
            self.cells = Some(self.station.subscriber::<Dwells>()?);
        }
        let Some(cells) = &self.cells else { return Ok(()) };
        while !turn.is_over() {
            let Some(dwell) = cells.receive()? else { break };
            if let Some(sector) = self.video.take(dwell.header(), dwell.elements()) {
                served.take_video(index, &sector);
            }
        }
        Ok(())
    }

    fn intake(&self, topic: Topic) -> Option<Intake> {
        if topic.is_bulk() {
            return Some(self.cells.as_ref().map_or(self.cells_before, |cells| self.cells_before.plus(cells.intake())));
        }
        self.input(topic).map(Input::intake)
    }

    fn take_most_waiting(&self, topic: Topic) -> Option<u32> {
        if topic.is_bulk() {
            return self.cells.as_ref().and_then(Subscriber::take_most_waiting);
        }
        self.input(topic).and_then(Input::take_most_waiting)
    }

    fn input(&self, topic: Topic) -> Option<&dyn Input> {
        self.inputs.iter().find(|input| input.topic() == topic).map(|input| &**input)
    }
}
