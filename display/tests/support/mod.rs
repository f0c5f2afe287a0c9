//! A viewer for tests: plain HTTP, and a WebSocket on a socket of its own.
#![allow(dead_code, reason = "each test file uses its part")]

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::Value;
use tungstenite::protocol::Role;
use tungstenite::{Error, Message, WebSocket};

/// Longest time that an answer is waited for: a guard against hanging, not a measurement.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// An answer over HTTP.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: String,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {}\n{}", self.head, self.body))
    }
}

/// Where the picture of the chain with this folder is.
pub(crate) fn address_in(root: &Path) -> SocketAddr {
    let (file, began) = (root.join(display::process::ADDRESS_FILE), Instant::now());
    loop {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        if let Some(address) = text.trim().strip_prefix("http://").and_then(|address| address.parse().ok()) {
            return address;
        }
        assert!(began.elapsed() < PATIENCE, "no picture");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A connection with patience.
pub(crate) fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream.set_write_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

/// `GET path`, with more lines of the head.
pub(crate) fn get_with(address: SocketAddr, path: &str, more: &str) -> Answer {
    ask(address, "GET", path, more, "")
}

/// A request with a content.
pub(crate) fn request(address: SocketAddr, method: &str, path: &str, content: &Value) -> Answer {
    let content = if content.is_null() { String::new() } else { content.to_string() };
    ask(address, method, path, &format!("content-length: {}\r\n", content.len()), &content)
}

fn ask(address: SocketAddr, method: &str, path: &str, more: &str, content: &str) -> Answer {
    let mut stream = connect(address);
    let head = format!("{method} {path} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n{more}\r\n{content}");
    stream.write_all(head.as_bytes()).expect("a request");
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).expect("an answer");
    let text = String::from_utf8(bytes).expect("text");
    let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok());
    Answer { status: status.unwrap_or_else(|| panic!("no answer: {text}")), head: head.into(), body: body.into() }
}

/// `GET path`.
pub(crate) fn get(address: SocketAddr, path: &str) -> Answer {
    get_with(address, path, "")
}

/// A viewer's WebSocket.
pub(crate) struct Live(WebSocket<TcpStream>);

impl Live {
    /// Opens it, with more lines of the head; the answer where it was refused.
    pub(crate) fn try_open(address: SocketAddr, more: &str) -> Result<Self, String> {
        let mut stream = connect(address);
        let head = format!(
            "GET /api/v1/live HTTP/1.1\r\nhost: {address}\r\nconnection: Upgrade\r\nupgrade: websocket\r\n\
             sec-websocket-version: 13\r\nsec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n{more}\r\n"
        );
        stream.write_all(head.as_bytes()).expect("a request");
        let mut answer = Vec::new();
        while !answer.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            match stream.read(&mut byte) {
                Ok(1) => answer.push(byte[0]),
                _ => break,
            }
        }
        let answer = String::from_utf8_lossy(&answer).into_owned();
        if !answer.starts_with("HTTP/1.1 101") {
            return Err(answer);
        }
        Ok(Self(WebSocket::from_raw_socket(stream, Role::Client, None)))
    }

    pub(crate) fn open(address: SocketAddr) -> Self {
        Self::try_open(address, "").unwrap_or_else(|answer| panic!("{answer}"))
    }

    pub(crate) fn send(&mut self, text: &str) {
        self.0.send(Message::text(text)).expect("sent");
    }

    /// Sends something else.
    pub(crate) fn send_message(&mut self, message: Message) -> Result<(), Error> {
        self.0.send(message)
    }

    /// The next message; `None` when the connection has ended.
    pub(crate) fn next(&mut self) -> Option<Message> {
        match self.0.read() {
            Ok(message) => Some(message),
            Err(Error::Io(error)) if [ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()) => {
                panic!("waited {PATIENCE:?} for a message")
            }
            Err(_) => None,
        }
    }

    /// The next message of this type; of a binary one, its header.
    pub(crate) fn next_of(&mut self, kind: &str) -> Value {
        self.find(kind, |message| (message["type"] == kind).then(|| message.clone()))
    }

    /// What the first message has for which `is` has something.
    pub(crate) fn find<T>(&mut self, what: &str, mut is: impl FnMut(&Value) -> Option<T>) -> T {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            let header = match self.next().unwrap_or_else(|| panic!("the connection has ended before `{what}`")) {
                Message::Text(text) => serde_json::from_str(&text).expect("JSON"),
                Message::Binary(bytes) => header_of(&bytes),
                _ => continue,
            };
            if let Some(found) = is(&header) {
                return found;
            }
        }
        panic!("waited {PATIENCE:?} for `{what}`")
    }
}

/// The header of a binary frame, after a check that its length is what it says.
pub(crate) fn header_of(frame: &[u8]) -> Value {
    let length = u32::from_le_bytes(frame[..4].try_into().expect("a length")) as usize;
    let header: Value = serde_json::from_slice(&frame[4..4 + length]).expect("a header");
    let count = header["count"].as_u64().expect("a count") as usize;
    let mut end = (4 + length).next_multiple_of(8);
    for column in header["columns"].as_array().expect("columns") {
        let size = match column["as"].as_str() {
            Some("f64") => 8,
            Some("f32" | "u32") => 4,
            Some("u8") => 1,
            other => panic!("{other:?}"),
        };
        end = (end + size * count).next_multiple_of(8);
    }
    assert_eq!(frame.len(), end, "{header}");
    header
}
