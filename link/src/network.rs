//! The way to the other hosts: a session of Zenoh with one key for messages and one for answers.

use std::sync::mpsc::{Receiver, TrySendError, sync_channel};

use anyhow::{Context, anyhow};
use common::config::ChainConfig;
use common::process::BadInput;
use zenoh::Wait;
use zenoh::bytes::ZBytes;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority};

/// After so long without a sign of life a connection is taken for cut, and made anew, ms.
const LEASE_MS: u32 = 3_000;
/// The longest pause between two tries to connect, ms.
const LONGEST_PAUSE_MS: u32 = 1_000;
/// Messages that wait inside the process; a sender that is faster is held up by the network.
const INBOX: usize = 16;

/// Which end of a link this is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Sends messages, gets answers.
    Out,
    /// Gets messages, sends answers.
    In,
}

/// What has come from the other end.
pub(crate) struct Received {
    /// Envelope or answer.
    pub(crate) label: Vec<u8>,
    /// The message.
    pub(crate) content: ZBytes,
}

/// A way to the other end, which may be cut and come back.
pub(crate) struct Way {
    publisher: Publisher<'static>,
    /// What has come. Before the session: whoever waits for room in it must not be waited for.
    pub(crate) inbox: Receiver<Received>,
    session: zenoh::Session,
}

impl Way {
    /// Listens and connects as `link` says; whoever is not there yet is tried again and again.
    pub(crate) fn open(chain: &ChainConfig, end: End) -> anyhow::Result<Self> {
        let session = zenoh::open(settings(chain)?).wait().map_err(|error| {
            let ways = chain.link.listen.iter().chain(&chain.link.connect).cloned().collect::<Vec<_>>().join(", ");
            BadInput(format!("cannot open the link by {ways}: {error}"))
        })?;
        let key = |what: &str| format!("radar-chain/{}/{what}", chain.site.name);
        let (own, others) = match end {
            End::Out => (key("messages"), key("answers")),
            End::In => (key("answers"), key("messages")),
        };
        // What the network has no room for is sent again: nothing ever waits for it.
        let publisher = session
            .declare_publisher(own)
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::RealTime)
            .express(true)
            .wait()
            .map_err(|error| anyhow!("{error}"))
            .context("declaring a publisher")?;
        let (put, inbox) = sync_channel(INBOX);
        session
            .declare_subscriber(others)
            .callback(move |sample| {
                let label = sample.attachment().map(|label| label.to_bytes().into_owned()).unwrap_or_default();
                let received = Received { label, content: sample.payload().clone() };
                match end {
                    // A receiver that has no time holds up the network, and so the sender.
                    End::In => drop(put.send(received)),
                    End::Out => match put.try_send(received) {
                        Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
                    },
                }
            })
            .background()
            .wait()
            .map_err(|error| anyhow!("{error}"))
            .context("declaring a subscriber")?;
        Ok(Self { publisher, inbox, session })
    }

    /// Sends; whether it arrives, an answer tells.
    pub(crate) fn send(&self, label: Vec<u8>, content: ZBytes) {
        // Without a connection there is nobody to send to: the same as a message lost on the way.
        let _ = self.publisher.put(content).attachment(label).wait();
    }

    /// Ends the connection after what has been sent.
    pub(crate) fn close(self) {
        let Self { publisher, inbox, session } = self;
        drop((publisher, inbox));
        let _ = session.close().wait();
    }
}

fn settings(chain: &ChainConfig) -> anyhow::Result<zenoh::Config> {
    let link = &chain.link;
    let mut settings = match link.zenoh.as_str() {
        "" => zenoh::Config::default(),
        file => zenoh::Config::from_file(file)
            .map_err(|error| BadInput(format!("key `link.zenoh`: cannot read {file}: {error}")))?,
    };
    // Where the file says nothing of it, Zenoh would listen at all interfaces, without the file's keys.
    let unsaid = zenoh::Config::default().get_json("listen/endpoints").ok();
    let says_where = settings.get_json("listen/endpoints").ok() != unsaid;
    let mut set = |key: &str, value: String| {
        settings
            .insert_json5(key, &value)
            .map_err(|error| BadInput(format!("settings of Zenoh: {key} = {value}: {error}")))
    };
    set("mode", "\"peer\"".into())?;
    set("scouting/multicast/enabled", "false".into())?;
    // Nobody is asked to connect, nor connected to, because of what others say of themselves.
    set("scouting/gossip/autoconnect", "{router: [], peer: [], client: []}".into())?;
    if !link.listen.is_empty() || !says_where {
        set("listen/endpoints", serde_json::to_string(&link.listen)?)?;
    }
    if link.zenoh.is_empty() || !link.connect.is_empty() {
        set("connect/endpoints", serde_json::to_string(&link.connect)?)?;
    }
    // Without an end: 0 would try once, and a host that begins before the other would never find it.
    set("connect/timeout_ms", "-1".into())?;
    set("connect/exit_on_failure", "false".into())?;
    set(
        "connect/retry",
        format!("{{period_init_ms: 100, period_max_ms: {LONGEST_PAUSE_MS}, period_increase_factor: 2}}"),
    )?;
    set("transport/link/tx/lease", LEASE_MS.to_string())?;
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Else whoever reaches the machine could put in messages, past the keys of the file.
    #[test]
    fn it_listens_only_where_key_or_file_say() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("zenoh.json5");
        let mut chain = ChainConfig::default();
        chain.link.connect = vec!["tls/192.0.2.1:7447".into()];
        let endpoints =
            |chain: &ChainConfig| settings(chain).expect("settings").get_json("listen/endpoints").expect("endpoints");
        assert_eq!(endpoints(&chain), "[]");
        std::fs::write(&file, "{ transport: { link: { tls: { enable_mtls: true } } } }").expect("written");
        chain.link.zenoh = file.display().to_string();
        assert_eq!(endpoints(&chain), "[]");
        std::fs::write(&file, r#"{ listen: { endpoints: ["tls/127.0.0.1:7447"] } }"#).expect("written");
        assert_eq!(endpoints(&chain), r#"["tls/127.0.0.1:7447"]"#);
        chain.link.listen = vec!["tls/127.0.0.1:7448".into()];
        assert_eq!(endpoints(&chain), r#"["tls/127.0.0.1:7448"]"#);
    }
}
