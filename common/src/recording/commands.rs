//! What operators did in a recorded run, to be done again.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use mcap::records::{Record, op};

use super::{Recorded, RecordingError, open, parts_from, parts_of_run};
use crate::commands::{ACCEPTED, ACQUIRE, ACQUISITION_ZONE, Command, EXCLUSION_ZONE, REMOVE_ZONE};
use crate::topic::Topic;

/// Bytes of the footer: its record, its checksum and the magic at the end.
const FOOTER: usize = 9 + 20 + 8;
/// No summary of ours is larger; a larger one is damage.
const LONGEST_SUMMARY: u64 = 1 << 28;

/// The commands that were carried out in a run, in their order, as a replay from the scan `first_scan` of this part on has
/// to give them; `meanwhile` is called often, for a recording with cells takes long.
///
/// They are asked for before the replay begins: in the recording an action lies behind the plots that it acts before. Where
/// the replay does not begin with the run, of what was before only zones are left, and tracks have other numbers than those
/// that were dropped and labelled.
///
/// # Errors
/// A part cannot be read.
pub fn commands_of(
    path: &Path,
    first_scan: u32,
    sectors_per_scan: u32,
    mut meanwhile: impl FnMut(),
) -> Result<Vec<Command>, RecordingError> {
    let (parts, later) = (parts_of_run(path), parts_from(path));
    let is_whole = first_scan == 0 && parts.len() <= later.len();
    let first_seq = u64::from(first_scan) * u64::from(sectors_per_scan);
    let is_wanted = |action: &Command, is_earlier: bool| match action.kind {
        EXCLUSION_ZONE | ACQUISITION_ZONE | REMOVE_ZONE => true,
        ACQUIRE => !is_earlier && action.before_seq >= first_seq,
        _ => is_whole,
    };
    let mut commands = Vec::new();
    for part in if parts.is_empty() { &later } else { &parts } {
        // Without an action, which is usual, nothing is unpacked.
        if File::open(part).and_then(|mut file| has_none(&mut file)).unwrap_or(false) {
            continue;
        }
        let is_earlier = !later.contains(part);
        for message in open(part)? {
            meanwhile();
            if let Recorded::Actions(_, actions) = message? {
                let accepted = actions.into_iter().filter(|action| action.outcome == ACCEPTED);
                commands.extend(accepted.filter(|action| is_wanted(action, is_earlier)));
            }
        }
    }
    Ok(commands)
}

/// Whether the summary of a container says that there is no action in it; a container that was cut has none.
fn has_none(file: &mut (impl Read + Seek)) -> io::Result<bool> {
    let length = file.seek(SeekFrom::End(0))?;
    let mut footer = [0; FOOTER];
    file.seek(SeekFrom::Start(length.saturating_sub(FOOTER as u64)))?;
    file.read_exact(&mut footer)?;
    let number = |bytes: &[u8]| bytes.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
    let start = number(&footer[9..]);
    let end = length - FOOTER as u64;
    if footer[0] != op::FOOTER || start == 0 || start > end || end - start > LONGEST_SUMMARY {
        return Ok(false);
    }
    let mut summary = vec![0; (end - start) as usize];
    file.seek(SeekFrom::Start(start))?;
    file.read_exact(&mut summary)?;
    let (mut rest, mut channel, mut counts) = (&summary[..], None, None);
    while rest.len() > 9 {
        let end = usize::try_from(number(&rest[1..])).ok().and_then(|length| length.checked_add(9));
        let Some((end, body)) = end.and_then(|end| Some((end, rest.get(9..end)?))) else { return Ok(false) };
        match mcap::parse_record(rest[0], body) {
            Ok(Record::Channel(found)) if found.topic.rsplit('/').next() == Some(Topic::Actions.name()) => {
                channel = Some(found.id);
            }
            Ok(Record::Statistics(found)) => counts = Some(found.channel_message_counts),
            _ => {}
        }
        rest = &rest[end..];
    }
    // A recording of an earlier version has no such channel.
    Ok(counts.is_some_and(|counts| channel.is_none_or(|channel| counts.get(&channel).is_none_or(|&count| count == 0))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::{ASKED, CommandsHeader, DROP, LABEL, NO_SUCH_TRACK};
    use crate::message::Header;
    use crate::recording::RecordedRef;
    use crate::recording::container::{Description, Writer};
    use crate::truth::TruthHeader;

    /// A recording with these outcomes of commands, each written behind what it acts before, cut to a share of its length.
    fn recording(outcomes: &[u32], kept: f64) -> tempfile::NamedTempFile {
        let mut bytes = io::Cursor::new(Vec::new());
        let description = Description { site: "small".into(), ..Description::default() };
        let mut writer = Writer::new(&mut bytes, &description, "{}", 1 << 20).expect("a recording");
        writer.write(RecordedRef::Truth(&TruthHeader { time_ns: 5, ..TruthHeader::default() }, &[])).expect("written");
        for (seq, &outcome) in outcomes.iter().enumerate() {
            let header = CommandsHeader { seq: seq as u64, time_ns: 6, ..CommandsHeader::default() };
            assert_eq!(header.place().seq, seq as u64);
            let kind = if seq % 2 == 0 { LABEL } else { DROP };
            let action = Command { outcome, ..Command::new(kind, 1, seq as u64) };
            writer.write(RecordedRef::Actions(&header, &[action])).expect("written");
        }
        writer.finish().expect("finished");
        let bytes = bytes.into_inner();
        let file = tempfile::NamedTempFile::with_suffix(".mcap").expect("a file");
        std::fs::write(file.path(), &bytes[..(bytes.len() as f64 * kept) as usize]).expect("written");
        file
    }

    #[test]
    fn what_was_carried_out_is_found() {
        let file = recording(&[ACCEPTED, NO_SUCH_TRACK, ASKED, ACCEPTED], 1.0);
        let ids: Vec<u64> =
            commands_of(file.path(), 0, 1, || {}).expect("read").iter().map(|command| command.id).collect();
        assert_eq!(ids, [0, 3]);
        assert!(commands_of(file.path(), 1, 8, || {}).expect("read").is_empty(), "their tracks have other numbers");
        assert!(!has_none(&mut File::open(file.path()).expect("open")).expect("read"));
    }

    #[test]
    fn a_summary_without_actions_is_believed_and_one_that_was_cut_is_not() {
        let none = recording(&[], 1.0);
        assert!(has_none(&mut File::open(none.path()).expect("open")).expect("read"));
        assert!(commands_of(none.path(), 0, 1, || {}).expect("read").is_empty());
        let cut = recording(&[ACCEPTED], 0.99);
        assert!(!has_none(&mut File::open(cut.path()).expect("open")).expect("read"));
    }
}
