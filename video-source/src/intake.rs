//! Datagrams to spokes, and what of them cannot be used.

use asterix::cat240::{self, VideoRecord};
use asterix::clock::DayClock;
use asterix::editions::Editions;
use asterix::record::Record;
use asterix::recording::{Datagram, Form};
use asterix::recovery::{Unused, records};
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
}

impl Intake {
    /// Nothing yet of a recording whose times of day begin on the day of `midnight_ns`.
    pub(crate) fn of_day(midnight_ns: u64) -> Self {
        Self { clock: DayClock::new(midnight_ns), spokes: Vec::new(), rejected: Rejected::default(), unread: 0 }
    }

    /// Takes a datagram from a file of this form, or from the network.
    pub(crate) fn take(&mut self, datagram: &Datagram<'_>, form: Form) {
        if let Some(spokes) = halo::spokes(&datagram.bytes, datagram.time_ns) {
            for spoke in spokes {
                match spoke {
                    Some(spoke) => self.spokes.push(spoke),
                    None => self.rejected.count(Reject::BadHeader),
                }
            }
            return;
        }
        // Of other datagrams on the network none begins with the category.
        if form != Form::Blocks && datagram.bytes.first() != Some(&cat240::CATEGORY) {
            return;
        }
        let editions = Editions::default();
        for record in records(&editions, &datagram.bytes, datagram.offset) {
            match record {
                Ok(record) => self.take_record(&record, datagram.time_ns),
                Err(Unused::Category { .. }) => self.rejected.count(Reject::OtherCategory),
                Err(Unused::Unread { .. }) => self.unread += 1,
            }
        }
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
        match spokes_of_records::spoke(&video, time_ns) {
            Some(spoke) => self.spokes.push(spoke),
            None => self.rejected.count(Reject::LengthMismatch),
        }
    }
}
