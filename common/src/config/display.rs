//! `[display]`: the picture in a browser.

use std::net::{Ipv4Addr, SocketAddr};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::load::{ConfigError, require, within};

/// Where the picture is served, and to whom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct DisplayConfig {
    /// Whether `run` starts the stage.
    pub enabled: bool,
    /// Address and port. If the port is taken, the next free one above it is used; port 0 takes any.
    pub listen: String,
    /// File with the token that viewers must show, its first line; empty for none, which is allowed on loopback only.
    pub token_file: String,
    /// Whether viewers may act: acquire, drop and label tracks, draw zones.
    pub control: bool,
    /// Viewers at once; further ones are told to come back later.
    pub clients: u32,
}

impl Default for DisplayConfig {
    fn default() -> Self {
        Self { enabled: true, listen: "127.0.0.1:8080".into(), token_file: String::new(), control: false, clients: 64 }
    }
}

impl DisplayConfig {
    /// Where to listen.
    pub fn address(&self) -> SocketAddr {
        self.listen.parse().unwrap_or((Ipv4Addr::LOCALHOST, 0).into())
    }

    /// Checks the values and what they are together.
    ///
    /// # Errors
    /// A value cannot be used, or anybody could look without a token.
    pub fn check(&self) -> Result<(), ConfigError> {
        let address: Option<SocketAddr> = self.listen.parse().ok();
        require(
            "display.listen",
            &self.listen,
            address.is_some(),
            "an address and a port, for example 127.0.0.1:8080",
        )?;
        let open = !self.address().ip().is_loopback() && self.token_file.is_empty();
        require("display.listen", &self.listen, !open, "a loopback address, or display.token_file beside it")?;
        within("display.clients", self.clients.into(), 1..=10_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_listens_beyond_loopback_needs_a_token() {
        let config = |listen: &str, token_file: &str| {
            let config =
                DisplayConfig { listen: listen.into(), token_file: token_file.into(), ..DisplayConfig::default() };
            config.check().map_err(|error| error.to_string())
        };
        assert!(config("127.0.0.1:8080", "").is_ok() && config("[::1]:0", "").is_ok());
        assert!(config("0.0.0.0:8080", "token").is_ok());
        let refused = config("0.0.0.0:8080", "").expect_err("open to everybody");
        assert!(refused.contains("display.listen") && refused.contains("token_file"), "{refused}");
        assert!(config("localhost", "").is_err());
    }
}
