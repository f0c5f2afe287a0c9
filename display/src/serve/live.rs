//! A viewer's WebSocket: what it asks for, and what it is sent.

use std::sync::Arc;
use std::time::Duration;

use axum::Error;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{FromRequestParts, Request as HttpRequest, State as Shared};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use common::time::monotonic_ns;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::time::{sleep, timeout};

use super::client::{Client, Next};
use super::routes::failure;
use super::server::Place;
use super::{Served, explained};
use crate::wire::columns::text;
use crate::wire::notices::{Dropped, Failure, Pong};
use crate::wire::requests::{Following, Playback, Request, Want};

/// Longest message of a viewer, bytes.
const LONGEST_REQUEST: usize = 4096;
/// Least time between two messages of a viewer: one that floods waits in its own socket.
const REQUEST_PAUSE: Duration = Duration::from_millis(1);
/// A viewer that takes no more for so long has gone.
const WRITE: Duration = Duration::from_secs(10);
/// A viewer that is sent nothing is asked whether it is there so often, and has gone when it says nothing for three times as long.
const ALIVE: Duration = Duration::from_secs(20);

/// `GET /api/v1/live`
pub(super) async fn live(Shared(served): Shared<Arc<Served>>, request: HttpRequest) -> Response {
    let (mut parts, _) = request.into_parts();
    let upgrade = match WebSocketUpgrade::from_request_parts(&mut parts, &()).await {
        Ok(upgrade) => upgrade,
        Err(refused) => return failure(refused.into_response().status(), "a WebSocket is expected here"),
    };
    let Some(client) = served.hub.join() else {
        return failure(StatusCode::SERVICE_UNAVAILABLE, "too many viewers: try again later");
    };
    // It leaves the hub however its connection ends, also if it never comes to be one.
    let viewer = Viewer { served, client, _place: parts.extensions.get().cloned() };
    upgrade
        .max_message_size(LONGEST_REQUEST)
        .max_frame_size(LONGEST_REQUEST)
        .on_upgrade(move |socket| async move { viewer.attend(socket).await })
}

/// A viewer while it is connected.
struct Viewer {
    served: Arc<Served>,
    client: Arc<Client>,
    /// Its place among the connections.
    _place: Option<Place>,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        self.served.hub.leave(&self.client);
    }
}

impl Viewer {
    async fn attend(&self, socket: WebSocket) {
        let (sink, stream) = socket.split();
        self.served.greet(&self.client);
        tokio::select! {
            () = self.hear(stream) => {}
            _ = self.send(sink) => {}
        }
    }

    /// Does what the viewer asks for, until it goes.
    async fn hear(&self, mut stream: SplitStream<WebSocket>) {
        while let Ok(Some(Ok(message))) = timeout(3 * ALIVE, stream.next()).await {
            match message {
                Message::Text(text) => self.heed(&text),
                Message::Binary(_) => self.complain("a message of text is expected, not a binary one"),
                Message::Close(_) => return,
                Message::Ping(_) | Message::Pong(_) => {}
            }
            sleep(REQUEST_PAUSE).await;
        }
    }

    /// Sends what waits for the viewer, until it takes no more.
    async fn send(&self, mut sink: SplitSink<WebSocket, Message>) -> Result<(), Error> {
        loop {
            let message = match timeout(ALIVE, self.client.next()).await {
                Err(_) => Message::Ping(Vec::new().into()),
                Ok(Next::Message(message)) => message,
                Ok(Next::Anew) => {
                    let picture = self.served.picture();
                    self.client.with(|state| {
                        state.clear();
                        Served::show_all(&picture, state);
                    });
                    continue;
                }
            };
            let untold = self.client.state().untold();
            let dropped = untold.map(|messages| Message::Text(text(&Dropped::new(messages)).into()));
            for message in dropped.into_iter().chain([message]) {
                timeout(WRITE, sink.send(message)).await.map_err(Error::new)??;
            }
        }
    }

    fn heed(&self, text: &str) {
        match Request::parse(text) {
            Err(error) => self.complain(&error),
            Ok(request) => {
                if let Err(error) = self.carry_out(&request) {
                    self.complain(&error);
                }
            }
        }
    }

    fn carry_out(&self, request: &Request) -> Result<(), String> {
        if let Some(ping) = &request.ping {
            self.tell(text(&Pong::new(ping, monotonic_ns() as f64 / 1e3)));
        }
        let picture = self.served.picture();
        let follow = match &request.follow {
            Following::Track(of) => {
                let site = picture.site(&of.site).map(|(index, _)| index);
                Some(Some((site.ok_or_else(|| no_such_site(&of.site))?, of.track)))
            }
            Following::None => Some(None),
            Following::AsBefore => None,
        };
        let wants_more = self.client.with(|state| {
            // In another encoding, everything is new.
            let recoded = request.encoding.is_some_and(|encoding| encoding != state.encoding);
            let before = if recoded { Want::default() } else { state.want };
            state.encoding = request.encoding.unwrap_or(state.encoding);
            state.want = request.want.unwrap_or(state.want);
            Served::show(&picture, state, &before);
            state.follow = follow.unwrap_or(state.follow);
            state.want.tracks && !before.tracks || state.want.video.is_some() && state.want.video != before.video
        });
        if let Some(Some((site, id))) = follow {
            let site = &picture.sites[site];
            if let Some(of) = site.tracks.get(&id) {
                self.tell(explained(site, &of.track, &of.way));
            }
        }
        drop(picture);
        let mut wanted = request.playback().peekable();
        if let Some((_, player)) = &self.served.recording
            && wants_more
            && wanted.peek().is_none()
        {
            // Where too much waits, another picture is on its way.
            let _ = player(Playback::Again);
        }
        wanted.try_for_each(|wanted| self.play(wanted))
    }

    fn play(&self, wanted: Playback) -> Result<(), String> {
        let (_, player) =
            self.served.recording.as_ref().ok_or("this is a running chain, which cannot be moved in time")?;
        match wanted {
            Playback::Play(rate) if !rate.is_finite() || rate <= 0.0 => {
                Err(format!("play is {rate}, expected times recorded time, more than 0"))
            }
            Playback::Seek(time_s) if !time_s.is_finite() => Err("seek is no time".into()),
            wanted if player(wanted) => Ok(()),
            _ => Err("too much waits for the player: try again later".into()),
        }
    }

    fn complain(&self, error: &str) {
        self.tell(text(&Failure::new(error)));
    }

    /// Adds an answer, unless the viewer takes none.
    fn tell(&self, text: String) {
        self.client.with(|state| state.push(Message::Text(text.into())));
    }
}

/// What is said of a site that there is not.
pub(super) fn no_such_site(name: &str) -> String {
    format!("there is no site `{name}`")
}
