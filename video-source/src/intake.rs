//! Datagrams to spokes, and what of them cannot be used.

use asterix::cat240::{self, VideoRecord};
use asterix::clock::DayClock;
use asterix::editions::Editions;
use asterix::record::Record;
use asterix::recording::{Datagram, Form};
use asterix::recovery::{Unused, records};
use common::config::SiteConfig;
use common::health::{Reject, Rejected};

use crate::spoke::Spoke;
use crate::{cat240 as spokes_of_records, halo};

/// What has come in so far.
#[derive(Debug)]
pub(crate) struct Intake {
    /// For what comes without times of packets.
    clock: DayClock,
    pub(crate) spokes: Vec<Spoke>,
    pub(crate) rejected: Rejected,
    /// Records that cannot be read.
    pub(crate) unread: u64,
    site: SiteConfig,
    /// SAC (high byte) and SIC (low byte) of the radar: of the first spoke that says them.
    source_id: Option<u32>,
    most_cells: usize,
}

impl Intake {
    /// Nothing yet of the radar of a site, whose spokes have `most_cells` cells at most, and whose times of day begin on the day of
    /// `midnight_ns`.
    pub(crate) fn new(site: &SiteConfig, most_cells: usize, midnight_ns: u64) -> Self {
        Self {
            clock: DayClock::new(midnight_ns),
            spokes: Vec::new(),
            rejected: Rejected::default(),
            unread: 0,
            site: site.clone(),
            source_id: None,
            most_cells,
        }
    }

    /// Takes a datagram from a file of this form, or from the network; says whether it has the form of one with video.
    pub(crate) fn take(&mut self, datagram: &Datagram<'_>, form: Form) -> bool {
        if let Some(spokes) = halo::spokes(&datagram.bytes, datagram.time_ns) {
            for spoke in spokes {
                match spoke {
                    Some(spoke) => self.take_spoke(spoke),
                    None => self.rejected.count(Reject::BadHeader),
                }
            }
            return true;
        }
        // Of other datagrams on the network none begins with the category.
        if form != Form::Blocks && datagram.bytes.first() != Some(&cat240::CATEGORY) {
            return false;
        }
        let editions = Editions::default();
        for record in records(&editions, &datagram.bytes, datagram.offset) {
            match record {
                Ok(record) => self.take_record(&record, datagram.time_ns),
                Err(Unused::Category { .. }) => self.rejected.count(Reject::OtherCategory),
                Err(Unused::Unread { .. }) => self.unread += 1,
            }
        }
        true
    }

    fn take_record(&mut self, record: &Record<'_>, received_ns: Option<u64>) {
        if record.edition.category != cat240::CATEGORY {
            self.rejected.count(Reject::OtherCategory);
            return;
        }
        let Some(video) = VideoRecord::read(record) else {
            self.rejected.count(Reject::NotATarget); // a summary
            return;
        };
        let time_ns = received_ns.or_else(|| video.time_of_day.map(|time| self.clock.time_ns(time).max(0) as u64));
        match spokes_of_records::spoke(&video, self.most_cells, time_ns) {
            Some(spoke) => self.take_spoke(spoke),
            None => self.rejected.count(Reject::LengthMismatch),
        }
    }

    /// Takes a spoke unless it has too many cells, or is another radar's than the site's. One that does not say whose it is is the site's.
    fn take_spoke(&mut self, spoke: Spoke) {
        let [.., sac, sic] = spoke.source_id.to_be_bytes();
        let is_named = self.site.sac.is_none_or(|it| it == sac) && self.site.sic.is_none_or(|it| it == sic);
        if spoke.cells > self.most_cells {
            self.rejected.count(Reject::LengthMismatch);
        } else if spoke.source_id == 0 || is_named && *self.source_id.get_or_insert(spoke.source_id) == spoke.source_id
        {
            self.spokes.push(spoke);
        } else {
            self.rejected.count(Reject::ForeignSource);
        }
    }
}
