//! Whether recordings are whole: chunks, checksums, index, missing messages against recorded gaps, order of times.
//!
//! Files that follow each other as parts of one run are checked as one stream: a part that was cut is in order
//! if the next one says what is missing.

use std::fmt::Write;
use std::io::Read;

use common::recording::Gap;
use common::recording::container::{Blocks, Description, End, Entry, Reader};
use common::topic::{TOPICS, Topic};
use common::units::{NS_PER_S, seconds_between};

use crate::fold::read_counts;
use crate::losses::{Losses, Missing};
use crate::schedule::Schedule;

/// Findings that are named one by one, per file.
const LISTED: u64 = 20;

/// What lies between two parts of one run that do not follow each other.
fn parts_between(last: &Description, next: &Description) -> Option<String> {
    if next.run.is_empty() || (&last.site, &last.run) != (&next.site, &next.run) {
        return None;
    }
    match next.part.checked_sub(last.part + 1) {
        Some(0) => None,
        Some(1) => Some(format!("part {} of the run is missing", last.part + 1)),
        Some(_) => Some(format!("parts {} to {} of the run are missing", last.part + 1, next.part - 1)),
        None => Some(format!("part {} comes after part {}: expected parts in their order", next.part, last.part)),
    }
}

/// The check of recordings, file by file.
#[derive(Debug, Default)]
pub struct Verification {
    losses: Option<Losses>,
    last: Option<Description>,
    text: String,
    findings: u64,
    /// The last file so far was cut; it is a finding unless its next part follows.
    cut: bool,
}

/// One file's counts.
#[derive(Debug, Default)]
struct Count {
    messages: u64,
    gaps: u64,
    missing: u64,
    listed: u64,
    last: Option<(Topic, u64, u64)>,
    time_ns: [(u64, u64); TOPICS],
}

impl Verification {
    /// Checks one file; `length` is its size in bytes.
    pub fn file<R: Read>(&mut self, name: &str, length: u64, input: R) {
        let mut reader = Reader::of(Blocks::checking(input));
        let description = reader.description().cloned().unwrap_or_default();
        let follows = self.last.as_ref().is_some_and(|last| {
            (&last.site, &last.run) == (&description.site, &description.run) && last.part + 1 == description.part
        });
        self.conclude_cut(follows);
        // A lone part goes on from what had been counted before it.
        let from_counts = || reader.counts().and_then(read_counts).map(|(losses, ..)| losses);
        let before = if follows { self.losses.take() } else { None };
        let (mut losses, known) = match before.or_else(from_counts) {
            Some(losses) => (losses, true),
            None => (Losses::new(Schedule::default()), false),
        };
        let _ = writeln!(self.text, "{name}");
        let (mut count, mut joined) = (Count::default(), [known; TOPICS]);
        if let Some(between) = self.last.as_ref().and_then(|last| parts_between(last, &description)) {
            self.find(&mut count, &between);
        }
        while let Some(entry) = reader.next_entry() {
            match entry {
                Ok(Entry::Gap(gap)) => {
                    (count.gaps, count.missing) = (count.gaps + 1, count.missing + gap.count);
                    losses.announce(&gap);
                    let _ = writeln!(self.text, "  gap in {gap}");
                }
                Ok(Entry::Message(message)) => {
                    let message = message.by_ref();
                    let (topic, seq) = (message.topic(), message.seq());
                    let Missing { gap, excess } = losses.take(message);
                    if std::mem::replace(&mut joined[topic as usize], true) {
                        self.compare(&mut count, gap, excess, topic, seq);
                    }
                    let before = count.time_ns[topic as usize];
                    let (session, time_ns) = (message.session(), message.time_ns());
                    if topic.is_data() && before.0 == session && time_ns < before.1 {
                        let back_s = seconds_between(time_ns, before.1);
                        self.find(&mut count, &format!("{} {seq}: time goes back by {back_s} s", topic.name()));
                    }
                    count.time_ns[topic as usize] = (session, time_ns);
                    count.messages += 1;
                    // Health has no measurement time: it was said about when the message before it was measured.
                    let last_ns = if topic.is_data() { time_ns } else { count.last.map_or(0, |(.., ns)| ns) };
                    count.last = Some((topic, seq, last_ns));
                }
                Err(error) => self.find(&mut count, &error.to_string()),
            }
        }
        self.conclude_file(&count, reader.end(), length);
        self.losses = Some(losses);
        self.last = Some(description);
    }

    fn compare(&mut self, count: &mut Count, gap: Option<Gap>, excess: u64, topic: Topic, seq: u64) {
        if let Some(gap) = gap {
            self.find(count, &format!("no gap is recorded where messages are missing: {gap}"));
        }
        if excess > 0 {
            self.find(count, &format!("{} {seq}: {excess} messages fewer missing than recorded", topic.name()));
        }
    }

    fn find(&mut self, count: &mut Count, finding: &str) {
        self.findings += 1;
        count.listed += 1;
        if count.listed <= LISTED {
            let _ = writeln!(self.text, "  FOUND {finding}");
        }
    }

    fn conclude_file(&mut self, count: &Count, end: Option<End>, length: u64) {
        let Count { messages, gaps, missing, listed, last, .. } = count;
        if *listed > LISTED {
            let _ = writeln!(self.text, "  and {} more findings", listed - LISTED);
        }
        let _ = writeln!(self.text, "  {messages} messages, {gaps} gaps with {missing} missing messages");
        self.cut = end.is_some_and(|end| !end.whole);
        if let Some(End { readable, .. }) = end.filter(|end| !end.whole) {
            let last = last.map_or("no message".to_string(), |(topic, seq, time_ns)| {
                format!("last whole message {} {seq} at {:.3} s UTC", topic.name(), time_ns as f64 / NS_PER_S)
            });
            let _ = writeln!(self.text, "  cut: ends at byte {readable} of {length}, {last}");
        }
    }

    /// A file that was cut is in order if its next part follows.
    fn conclude_cut(&mut self, follows: bool) {
        if std::mem::take(&mut self.cut) && !follows {
            self.findings += 1;
            let _ = writeln!(self.text, "  FOUND no end, and no next part follows");
        }
    }

    /// The findings in words, and how many there are.
    pub fn finish(mut self) -> (String, u64) {
        self.conclude_cut(false);
        let _ = match self.findings {
            0 => writeln!(self.text, "whole"),
            findings => writeln!(self.text, "{findings} findings"),
        };
        (self.text, self.findings)
    }
}
