//! `[outputs.NAME]`: tracks or plots of the chain to another system.

use std::net::{Ipv4Addr, SocketAddr};
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ChainConfig;
use super::load::{ConfigError, require, seconds, seconds_or_none, within};

/// What goes to another system, where and how. Nothing leaves this machine unless `to` or `interface` names an address that does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputConfig {
    /// `udp://ADDRESS:PORT` (also a group), `tcp://ADDRESS:PORT` connects, `tcp-listen://ADDRESS:PORT` serves whoever connects.
    pub to: String,
    /// What is spoken; where it is not set, `NAME` says it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub format: Option<OutputFormat>,
    /// What is sent; plots as `asterix` only.
    pub send: Sent,
    /// Tracks are sent once they are confirmed; else tentative ones as well.
    pub confirmed_only: bool,
    /// Site whose tracks are sent; empty for the fused one where tracks are fused, else for all.
    pub site: String,
    /// Address of the interface that a group is reached by.
    pub interface: Ipv4Addr,
    /// Networks that datagrams to a group may cross: 0 stays on this machine, 1 on the first network.
    pub hops: u8,
    /// Octets that wait for a slow peer; what comes while they fill the room is dropped and counted.
    pub queue_bytes: usize,
    /// Least measurement time between two reports of a track, s; 0 for every one.
    pub interval_s: f64,
    /// Time that a report stays valid without a later one, s (`cot`).
    pub stale_s: f64,
    /// Pause between two status messages, s (`sapient`).
    pub status_s: f64,
    /// Times are shifted so that the first message is of now: for recorded and simulated data to peers that drop what is old.
    pub shift_time: bool,
    /// What the targets are (`cot`, `sapient`).
    pub class: TargetClass,
    /// Whose they are (`cot`).
    pub affiliation: Affiliation,
    /// UUID of this sensor (`sapient`); empty for one made from the name of the site.
    pub node_id: String,
}

/// What is spoken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OutputFormat {
    /// ASTERIX: tracks in category 062 with 065, plots in category 048 with 034.
    Asterix,
    /// Cursor on Target, XML.
    Cot,
    /// NMEA 0183, TTM and TLL.
    Nmea,
    /// SAPIENT, BSI Flex 335 v2.0.
    Sapient,
    /// One JSON object a line.
    Json,
}

/// What is sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Sent {
    /// Tracks.
    #[default]
    Tracks,
    /// Plots.
    Plots,
}

/// What a target is, where the user knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TargetClass {
    /// Something in the air.
    #[default]
    Air,
    /// An aircraft with fixed wings.
    Aeroplane,
    /// A helicopter.
    Helicopter,
    /// A drone with rotors.
    Drone,
    /// A ship or boat.
    Ship,
    /// A vehicle on the ground.
    Vehicle,
}

/// Whose a target is, where the user knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Affiliation {
    /// Not known.
    #[default]
    Unknown,
    /// A friend's.
    Friend,
    /// Nobody's side.
    Neutral,
    /// A foe's.
    Hostile,
}

impl Default for OutputConfig {
    fn default() -> Self {
        Self {
            to: String::new(),
            format: None,
            send: Sent::Tracks,
            confirmed_only: true,
            site: String::new(),
            interface: Ipv4Addr::LOCALHOST,
            hops: 1,
            queue_bytes: 1 << 20,
            interval_s: 0.0,
            stale_s: 10.0,
            status_s: 5.0,
            shift_time: false,
            class: TargetClass::Air,
            affiliation: Affiliation::Unknown,
            node_id: String::new(),
        }
    }
}

impl OutputFormat {
    /// All of them with their names.
    pub const NAMED: [(Self, &'static str); 5] = [
        (Self::Asterix, "asterix"),
        (Self::Cot, "cot"),
        (Self::Nmea, "nmea"),
        (Self::Sapient, "sapient"),
        (Self::Json, "json"),
    ];

    /// Whether it says places on the earth and nothing else.
    fn needs_position(self) -> bool {
        matches!(self, Self::Cot | Self::Sapient)
    }
}

/// Where frames go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Destination {
    /// As datagrams, also to a group.
    Datagrams(SocketAddr),
    /// To a peer that is connected to.
    Peer(SocketAddr),
    /// To all who connect.
    Listeners(SocketAddr),
}

impl FromStr for Destination {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let (scheme, address) = text.split_once("://").ok_or(())?;
        let address: SocketAddr = address.parse().map_err(|_| ())?;
        // A group of IPv6 has no interface key and would leave by whichever the routes name.
        let is_usable = address.port() != 0 && !(address.is_ipv6() && address.ip().is_multicast());
        match scheme {
            "udp" if is_usable => Ok(Self::Datagrams(address)),
            "tcp" if is_usable => Ok(Self::Peer(address)),
            "tcp-listen" if is_usable => Ok(Self::Listeners(address)),
            _ => Err(()),
        }
    }
}

impl OutputConfig {
    /// What is spoken by the output of this name, if anything is.
    pub fn format(&self, name: &str) -> Option<OutputFormat> {
        let named = || OutputFormat::NAMED.iter().find(|(_, own)| *own == name).map(|(format, _)| *format);
        self.format.or_else(named)
    }

    /// Where it goes; `None` in a configuration that is not checked.
    pub fn destination(&self) -> Option<Destination> {
        self.to.parse().ok()
    }

    /// Whether it sends what is made at this site.
    pub fn takes(&self, site: &ChainConfig) -> bool {
        if self.site.is_empty() { !site.run.fused || self.send == Sent::Plots } else { self.site == site.site.name }
    }

    pub(super) fn check(&self, name: &str, chain: &ChainConfig) -> Result<(), ConfigError> {
        let key = |of: &str| format!("outputs.{name}.{of}");
        within(&key("queue_bytes"), self.queue_bytes as u64, 1 << 16..=1 << 30)?;
        seconds_or_none(&key("interval_s"), self.interval_s)?;
        seconds(&key("stale_s"), self.stale_s)?;
        seconds(&key("status_s"), self.status_s)?;
        let to = "udp://ADDRESS:PORT, tcp://ADDRESS:PORT or tcp-listen://ADDRESS:PORT";
        let shown = if self.to.is_empty() { "not given" } else { &self.to };
        let destination = self.destination();
        require(&key("to"), shown, destination.is_some(), to)?;
        let formats = OutputFormat::NAMED.map(|(_, name)| name).join(", ");
        let format = self.format(name);
        require(&key("format"), "not given", format.is_some(), &format!("one of {formats}"))?;
        let as_plots = self.send == Sent::Tracks || format == Some(OutputFormat::Asterix);
        require(&key("send"), "plots", as_plots, "tracks, for any format but asterix")?;
        let connects = format != Some(OutputFormat::Sapient) || matches!(destination, Some(Destination::Peer(_)));
        require(&key("to"), shown, connects, "tcp://ADDRESS:PORT, for sapient")?;
        let placed = !self.takes(chain) || chain.site.position.is_some();
        let needs = format.is_some_and(OutputFormat::needs_position);
        let expected = format!("a position: output `{name}` sends places on the earth");
        require("site.position", "not given", placed || !needs, &expected)
    }
}

#[cfg(test)]
mod tests {
    use crate::config::parse;

    fn refusal(overrides: &[&str]) -> String {
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        match parse(std::path::Path::new("x.toml"), "", &overrides) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn one_key_is_enough_and_what_cannot_be_sent_is_refused_in_one_line() {
        assert_eq!(refusal(&["outputs.asterix.to=udp://127.0.0.1:8600"]), "");
        assert_eq!(refusal(&["outputs.asterix.to=udp://127.0.0.1:8600", "outputs.asterix.send=plots"]), "");
        let place = "site.position={ latitude_deg = 50.0, longitude_deg = 30.0 }";
        assert_eq!(refusal(&["outputs.cot.to=udp://239.2.3.1:6969", place]), "");
        for (overrides, expected) in [
            (
                &["outputs.a.to=udp://127.0.0.1:8600"][..],
                "key `outputs.a.format` is not given, expected one of asterix, cot",
            ),
            (&["outputs.json.send=tracks"], "key `outputs.json.to` is not given, expected udp://ADDRESS:PORT, tcp://"),
            (&["outputs.json.to=http://127.0.0.1:1"], "key `outputs.json.to` is http://127.0.0.1:1, expected udp://"),
            (&["outputs.json.to=udp://127.0.0.1:0"], "expected udp://ADDRESS:PORT"),
            (
                &["outputs.cot.to=udp://239.2.3.1:6969"],
                "key `site.position` is not given, expected a position: output `cot`",
            ),
            (&["outputs.sapient.to=udp://127.0.0.1:5020", place], "expected tcp://ADDRESS:PORT, for sapient"),
            (&["outputs.nmea.to=udp://127.0.0.1:1", "outputs.nmea.send=plots"], "key `outputs.nmea.send` is plots"),
            (&["outputs.nmea.colour=red"], "unknown field `colour`"),
        ] {
            let text = refusal(overrides);
            assert!(text.contains(expected), "{overrides:?}: {text}");
        }
    }
}
