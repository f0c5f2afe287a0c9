//! Connections: their number, and how long one may take.

use std::io::ErrorKind;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn};
use common::process::BadInput;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;
use tokio::sync::Notify;

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
/// The same of one that yields its place: what it has asked for meanwhile is answered.
const YIELDING: Duration = Duration::from_secs(1);
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
    let (routes, places) = (routes(Arc::clone(served)), Places::default());
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_PAUSE).await;
            continue;
        };
        if places.taken() >= most {
            served.hub.refuse();
            if !places.make_room() {
                turn_away(&stream);
                continue;
            }
        }
        let (place, routes) = (places.take(peer.ip()), routes.clone());
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
    let held = Arc::downgrade(&place.0);
    let yields = place.yields();
    let routes =
        routes.layer(axum::Extension(place)).layer(from_fn(move |request, next| answer(held.clone(), request, next)));
    let service = TowerToHyperService::new(routes);
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(HEAD).max_buf_size(1 << 16);
    let connection = builder.serve_connection(TokioIo::new(stream), service).with_upgrades();
    let mut connection = std::pin::pin!(connection);
    // How a connection ends is nobody's business.
    let last_answer = tokio::select! {
        ended = tokio::time::timeout(CONNECTION, connection.as_mut()) => ended.is_err().then_some(LAST_ANSWER),
        () = yields.notified() => Some(YIELDING),
    };
    if let Some(last_answer) = last_answer {
        connection.as_mut().graceful_shutdown();
        let _ = tokio::time::timeout(last_answer, connection).await;
    }
}

/// Answers a request; while that lasts, and for as long as its connection is a WebSocket, its place is used.
async fn answer(held: Weak<Held>, request: Request, next: Next) -> axum::response::Response {
    let set_used = |used| held.upgrade().map(|held| held.used.store(used, Ordering::Relaxed));
    set_used(true);
    let response = next.run(request).await;
    set_used(response.status() == StatusCode::SWITCHING_PROTOCOLS);
    response
}

/// The places of connections, oldest first. When all are taken, one that asks for nothing just now yields to a newcomer: whoever opens
/// a thousand connections and says nothing keeps nobody out.
#[derive(Debug, Default)]
struct Places(Mutex<Vec<Weak<Held>>>);

/// A place among the connections, given back when nobody holds it any more.
#[derive(Debug, Clone)]
pub(super) struct Place(Arc<Held>);

#[derive(Debug)]
struct Held {
    address: IpAddr,
    /// A request is being answered, or it has become a WebSocket.
    used: AtomicBool,
    yields: Arc<Notify>,
}

impl Places {
    /// How many are taken.
    fn taken(&self) -> usize {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        places.retain(|place| place.strong_count() > 0);
        places.len()
    }

    /// Takes one more, for a connection from there.
    fn take(&self, address: IpAddr) -> Place {
        let held = Arc::new(Held { address, used: AtomicBool::new(false), yields: Arc::default() });
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(Arc::downgrade(&held));
        Place(held)
    }

    /// Takes the place of a connection that does not use it: of the address that holds the most of these, the oldest one. Whether there
    /// is any.
    fn make_room(&self) -> bool {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let held: Vec<_> = places.iter().map(Weak::upgrade).collect();
        let is_idle = |of: &&Arc<Held>| !of.used.load(Ordering::Relaxed);
        let idle = || held.iter().flatten().filter(is_idle);
        let with_most = |of: &Arc<Held>| idle().filter(|other| other.address == of.address).count();
        // Of equals the last in the order is taken: the oldest, from behind.
        let Some(yielding) = idle().rev().max_by_key(|of| with_most(of)) else { return false };
        yielding.yields.notify_one();
        places.retain(|place| !std::ptr::eq(place.as_ptr(), Arc::as_ptr(yielding)));
        true
    }
}

impl Place {
    /// Told when the place is wanted by another connection.
    fn yields(&self) -> Arc<Notify> {
        Arc::clone(&self.0.yields)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the address with the most idle connections the oldest one; never one that is answered or is a WebSocket.
    #[test]
    fn a_connection_that_asks_for_nothing_yields() {
        let places = Places::default();
        let [one, other] = [[192, 0, 2, 1], [192, 0, 2, 2]].map(IpAddr::from);
        let held: Vec<_> = [one, other, one, one].into_iter().map(|address| places.take(address)).collect();
        held[0].0.used.store(true, Ordering::Relaxed);
        let listed = || -> Vec<bool> {
            let listed = places.0.lock().expect("the places");
            held.iter().map(|place| listed.iter().any(|of| std::ptr::eq(of.as_ptr(), Arc::as_ptr(&place.0)))).collect()
        };
        assert!(places.make_room());
        assert_eq!(listed(), [true, true, false, true], "the oldest idle one of the address with the most");
        assert!(places.make_room() && places.make_room());
        assert_eq!(listed(), [true, false, false, false]);
        assert!(!places.make_room(), "what is used is left alone");
        assert_eq!(places.taken(), 1);
        drop(held);
        assert_eq!(places.taken(), 0);
    }

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
