//! Messages in a stream: length, four octets, little-endian, then the message.

use prost::Message;

use super::messages::SapientMessage;

/// A longer message is none, octets: it ends the reading of a stream that has lost its frames.
const LONGEST: usize = 1 << 20;

/// Appends a message with its length.
pub(super) fn write(message: &SapientMessage, out: &mut Vec<u8>) {
    out.extend_from_slice(&(message.encoded_len() as u32).to_le_bytes());
    out.extend_from_slice(&message.encode_to_vec());
}

/// Messages from the pieces of a stream.
#[derive(Debug, Default)]
pub(super) struct Incoming {
    octets: Vec<u8>,
    is_lost: bool,
}

impl Incoming {
    /// Forgets what came over an earlier connection.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether the frames of the stream are lost: nothing more comes out of it.
    pub(super) fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Takes a piece; the whole messages so far, each an error where it is none.
    pub(super) fn take(&mut self, piece: &[u8]) -> Vec<Result<SapientMessage, String>> {
        let mut messages = Vec::new();
        if self.is_lost {
            return messages;
        }
        self.octets.extend_from_slice(piece);
        let mut at = 0;
        while let Some((length, rest)) = self.octets[at..].split_first_chunk::<4>() {
            let length = u32::from_le_bytes(*length) as usize;
            if length > LONGEST {
                messages.push(Err(format!("a message of {length} octets, expected {LONGEST} at most")));
                self.is_lost = true;
                break;
            }
            let Some(message) = rest.get(..length) else { break };
            messages.push(SapientMessage::decode(message).map_err(|error| error.to_string()));
            at += 4 + length;
        }
        self.octets.drain(..at);
        messages
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(node: &str) -> SapientMessage {
        SapientMessage { node_id: Some(node.into()), ..SapientMessage::default() }
    }

    #[test]
    fn messages_come_out_however_the_stream_is_cut() {
        let (mut stream, sent) = (Vec::new(), [message("a"), message("a longer name"), message("c")]);
        for message in &sent {
            write(message, &mut stream);
        }
        for piece in 1..stream.len() {
            let mut incoming = Incoming::default();
            let read: Vec<_> = stream.chunks(piece).flat_map(|piece| incoming.take(piece)).collect();
            assert_eq!(read, sent.clone().map(Ok));
        }
    }

    #[test]
    fn garbage_is_said_once_and_costs_no_memory() {
        let mut incoming = Incoming::default();
        assert!(incoming.take(&[2, 0, 0, 0, 0xff, 0xff])[0].is_err(), "no message");
        assert_eq!(incoming.take(&[0xff; 8]).len(), 1);
        for _ in 0..1000 {
            assert_eq!(incoming.take(&[0xff; 4096]), []);
        }
        assert!(incoming.octets.len() < 16);
    }
}
