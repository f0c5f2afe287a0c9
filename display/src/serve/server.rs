//! Connections: their number, and how long one may take.

use std::io::ErrorKind;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use axum::Router;
use common::process::BadInput;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;

use super::Served;
use super::routes::routes;

/// Ports above the one asked for that are tried when it is taken.
const PORTS: u16 = 100;
/// Connections beside those of viewers, for what is asked once: a browser opens six.
const SPARE_CONNECTIONS: usize = 64;
/// A request that has not come whole by then never will.
const HEAD: Duration = Duration::from_secs(10);
/// A connection that asks for one thing after the other is begun anew then; one that does not take its answer ends.
const CONNECTION: Duration = Duration::from_secs(300);
/// How long it then has to finish.
const LAST_ANSWER: Duration = Duration::from_secs(10);
/// Pause after a connection that could not be accepted, for example because too many files are open.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// Listens where it is wanted, or at the next free port.
///
/// # Errors
/// Nobody can listen at this address.
pub fn bind(wanted: SocketAddr) -> anyhow::Result<TcpListener> {
    let refused = |error: std::io::Error| BadInput(format!("cannot serve the picture on {wanted}: {error}"));
    let (from, to) = (wanted.port(), wanted.port().saturating_add(if wanted.port() == 0 { 0 } else { PORTS }));
    // If all of these are taken, any free one.
    for port in (from..=to).chain([0]) {
        match TcpListener::bind((wanted.ip(), port)) {
            Err(error) if error.kind() == ErrorKind::AddrInUse && port != 0 => {}
            Err(error) => return Err(refused(error).into()),
            Ok(listener) => {
                listener.set_nonblocking(true).map_err(refused)?;
                return Ok(listener);
            }
        }
    }
    Err(refused(ErrorKind::AddrInUse.into()).into())
}

/// Serves a picture in a thread of its own, for as long as the process lives.
///
/// # Errors
/// The thread cannot be started.
pub fn serve(listener: TcpListener, served: Arc<Served>) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let listener = runtime.block_on(async { tokio::net::TcpListener::from_std(listener) })?;
    std::thread::Builder::new().name("viewers".into()).spawn(move || runtime.block_on(accept(&listener, &served)))?;
    Ok(())
}

async fn accept(listener: &tokio::net::TcpListener, served: &Arc<Served>) {
    let most = served.sites.first().display.clients as usize + SPARE_CONNECTIONS;
    let (routes, open) = (routes(Arc::clone(served)), Arc::new(AtomicUsize::new(0)));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_PAUSE).await;
            continue;
        };
        if open.load(Ordering::Relaxed) >= most {
            served.hub.refuse();
            turn_away(&stream);
            continue;
        }
        let place = Place::new(&open);
        let routes = routes.clone();
        tokio::spawn(async move { attend(stream, routes, place).await });
    }
}

/// Says that there is no room, if that can be said at once.
fn turn_away(stream: &TcpStream) {
    let body = r#"{"error":"too many connections: try again later"}"#;
    let head =
        "HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\nconnection: close\r\nretry-after: 5\r\n";
    let _ = stream.try_write(format!("{head}content-length: {}\r\n\r\n{body}", body.len()).as_bytes());
}

/// Answers the requests of a connection.
async fn attend(stream: TcpStream, routes: Router, place: Place) {
    let _ = stream.set_nodelay(true); // without it, a small message waits for the next
    // A WebSocket takes its place along when the connection becomes one.
    let service = TowerToHyperService::new(routes.layer(axum::Extension(place)));
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(1 << 16);
    let connection = builder.serve_connection(TokioIo::new(stream), service).with_upgrades();
    let mut connection = std::pin::pin!(connection);
    // How a connection ends is nobody's business.
    if tokio::time::timeout(CONNECTION, connection.as_mut()).await.is_err() {
        connection.as_mut().graceful_shutdown();
        let _ = tokio::time::timeout(LAST_ANSWER, connection).await;
    }
}

/// A place among the connections, given back when nobody holds it any more.
#[derive(Debug, Clone)]
pub(super) struct Place(#[expect(dead_code, reason = "it is held, not read")] Arc<Held>);

#[derive(Debug)]
struct Held(Arc<AtomicUsize>);

impl Place {
    fn new(open: &Arc<AtomicUsize>) -> Self {
        open.fetch_add(1, Ordering::Relaxed);
        Self(Arc::new(Held(Arc::clone(open))))
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_free_port_is_taken() {
        let first = bind("127.0.0.1:0".parse().expect("an address")).expect("a port");
        let taken = first.local_addr().expect("its address");
        let second = bind(taken).expect("another port").local_addr().expect("its address");
        assert!(second.ip() == taken.ip() && second.port() != taken.port(), "{taken} {second}");
        // TEST-NET: no machine has it.
        let error = bind("192.0.2.1:8080".parse().expect("an address")).expect_err("not here").to_string();
        assert!(error.contains("192.0.2.1:8080"), "{error}");
    }
}
