//! Who may look: by token, and never a page of somebody else.
//!
//! A browser lets any page send requests to any address, also to loopback, and names its own origin with them; by DNS, the
//! name of a foreign page can even be made to lead here. So, without a token, the picture answers to names of loopback only,
//! and it answers no request that a page of another origin makes.

use std::net::IpAddr;

use anyhow::Context;
use axum::http::header::{AUTHORIZATION, COOKIE, HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri};
use common::process::BadInput;

/// Cookie that holds the token, so that a browser shows it with every request.
const COOKIE_NAME: &str = "radar_chain_token";
/// Shortest token: 16 characters of any kind are more than anybody can try.
const SHORTEST: usize = 16;

/// Headers of every answer: nothing from elsewhere is loaded, nothing is framed, nothing is guessed.
pub(super) const HEADERS: [(HeaderName, HeaderValue); 5] = [
    (
        HeaderName::from_static("content-security-policy"),
        HeaderValue::from_static(
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        ),
    ),
    (HeaderName::from_static("x-content-type-options"), HeaderValue::from_static("nosniff")),
    (HeaderName::from_static("referrer-policy"), HeaderValue::from_static("no-referrer")),
    (HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin")),
    (HeaderName::from_static("cache-control"), HeaderValue::from_static("no-cache")),
];

/// The rule of who may look.
#[derive(Debug, Default)]
pub struct Access {
    token: Option<String>,
}

impl Access {
    /// With the token in `file`, its first line; without a file, for loopback alone.
    ///
    /// # Errors
    /// The file cannot be read, or its token is too short.
    pub fn new(file: &str) -> anyhow::Result<Self> {
        if file.is_empty() {
            return Ok(Self::default());
        }
        let text =
            std::fs::read_to_string(file).map_err(|error| BadInput(format!("display.token_file {file}: {error}")))?;
        let token = text.lines().next().unwrap_or_default().trim().to_string();
        let usable = token.len() >= SHORTEST && token.bytes().all(|byte| byte.is_ascii_graphic() && byte != b';');
        if !usable {
            let found = token.chars().count();
            let expected = format!("at least {SHORTEST} printable characters without spaces in its first line");
            return Err(BadInput(format!("display.token_file {file}: {found} characters found, expected {expected}")))
                .context("reading the token");
        }
        Ok(Self { token: Some(token) })
    }

    /// Whether a request may be answered; if not, how it is refused.
    pub(super) fn check(&self, headers: &HeaderMap) -> Result<(), (StatusCode, String)> {
        let host = text(headers, HOST).unwrap_or_default();
        if let Some(origin) = text(headers, ORIGIN) {
            let authority = origin.split_once("://").map_or(origin, |(_, authority)| authority);
            if authority != host {
                let error = format!("a page of {origin} may not look at {host}");
                return Err((StatusCode::FORBIDDEN, error));
            }
        }
        match &self.token {
            None if is_loopback(host) => Ok(()),
            None => {
                Err((StatusCode::FORBIDDEN, format!("host `{host}` found, expected localhost or a loopback address")))
            }
            Some(token) if shown(headers).is_some_and(|shown| is_equal(token, shown)) => Ok(()),
            Some(_) => Err((
                StatusCode::UNAUTHORIZED,
                "a token is expected: open /?token=… in a browser, or send `Authorization: Bearer …`".into(),
            )),
        }
    }

    /// The cookie for a browser that has opened `/?token=…` with the right one.
    pub(super) fn cookie(&self, uri: &Uri) -> Option<HeaderValue> {
        let token = self.token.as_ref()?;
        let shown = uri.query()?.split('&').find_map(|pair| pair.strip_prefix("token="))?;
        let cookie = format!("{COOKIE_NAME}={token}; Path=/; HttpOnly; SameSite=Strict");
        is_equal(token, shown).then(|| HeaderValue::from_str(&cookie).ok()).flatten()
    }
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name).map(|value| value.to_str().unwrap_or("?"))
}

/// The token that a request shows.
fn shown(headers: &HeaderMap) -> Option<&str> {
    let bearer = text(headers, AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
    let cookies =
        || headers.get_all(COOKIE).iter().filter_map(|value| value.to_str().ok()).flat_map(|all| all.split("; "));
    bearer.or_else(|| cookies().find_map(|cookie| cookie.strip_prefix(COOKIE_NAME)?.strip_prefix('=')))
}

/// Compares in a time that does not tell how much is right.
fn is_equal(token: &str, shown: &str) -> bool {
    let differences = token.bytes().zip(shown.bytes()).fold(0, |differences, (a, b)| differences | a ^ b);
    token.len() == shown.len() && differences == 0
}

/// Whether a `Host` is a name of loopback, with any port: one may have been forwarded here.
fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.split(':').next().unwrap_or_default(),
    };
    name.eq_ignore_ascii_case("localhost") || name.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(HeaderName, &'static str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), HeaderValue::from_static(value))).collect()
    }

    fn status(access: &Access, pairs: &[(HeaderName, &'static str)]) -> Option<u16> {
        access.check(&headers(pairs)).err().map(|(status, _)| status.as_u16())
    }

    #[test]
    fn without_a_token_only_names_of_loopback_are_answered() {
        let access = Access::default();
        for host in ["localhost:8080", "127.0.0.1:8080", "127.9.9.9", "[::1]:8080", "LOCALHOST"] {
            assert_eq!(status(&access, &[(HOST, host)]), None, "{host}");
        }
        for host in
            ["evil.example", "127.0.0.1.evil.example:8080", "192.168.1.2:8080", "[::2]:80", "", "[", "localhost.evil"]
        {
            assert_eq!(status(&access, &[(HOST, host)]), Some(403), "{host}");
        }
        assert_eq!(status(&access, &[]), Some(403));
    }

    #[test]
    fn a_page_of_another_origin_gets_no_answer() {
        let access = Access::default();
        let with = |origin| status(&access, &[(HOST, "localhost:8080"), (ORIGIN, origin)]);
        assert_eq!(with("http://localhost:8080"), None);
        for origin in ["http://evil.example", "http://localhost:3000", "null", "http://localhost:8080.evil.example", ""]
        {
            assert_eq!(with(origin), Some(403), "{origin}");
        }
    }

    #[test]
    fn a_token_is_shown_in_a_header_or_by_the_cookie_that_the_page_has_got() {
        let file = tempfile::NamedTempFile::new().expect("a file");
        let access = |text: &str| {
            std::fs::write(file.path(), text).expect("a token");
            Access::new(&file.path().display().to_string())
        };
        assert!(access("short\n").is_err() && access("").is_err() && access("sixteen; letters and more").is_err());
        assert!(Access::new("/no such file").is_err());
        let access = access("0123456789abcdef\n").expect("a token");
        let host = (HOST, "radar.example");
        assert_eq!(status(&access, std::slice::from_ref(&host)), Some(401));
        assert_eq!(status(&access, &[host.clone(), (AUTHORIZATION, "Bearer 0123456789abcdef")]), None);
        assert_eq!(status(&access, &[host.clone(), (AUTHORIZATION, "Bearer 0123456789abcdeX")]), Some(401));
        assert_eq!(status(&access, &[host.clone(), (AUTHORIZATION, "Bearer 0123456789abcdef0")]), Some(401));
        assert_eq!(status(&access, &[host.clone(), (COOKIE, "a=b; radar_chain_token=0123456789abcdef")]), None);
        let cookie = |uri: &'static str| access.cookie(&Uri::from_static(uri));
        assert!(
            cookie("/?token=0123456789abcdef")
                .is_some_and(|value| value.to_str().is_ok_and(|of| of.contains("HttpOnly")))
        );
        assert!(cookie("/?token=0123456789abcdeX").is_none() && cookie("/").is_none());
        let foreign = [host, (AUTHORIZATION, "Bearer 0123456789abcdef"), (ORIGIN, "http://evil.example")];
        assert_eq!(status(&access, &foreign), Some(403));
    }
}
