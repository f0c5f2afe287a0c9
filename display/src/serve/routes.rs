//! The routes: the page, and what programs read.

use std::sync::Arc;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::rejection::{BytesRejection, QueryRejection};
use axum::extract::{DefaultBodyLimit, Path, Query, Request, State};
use axum::http::header::{CONTENT_TYPE, LOCATION, SET_COOKIE};
use axum::http::{HeaderValue, Method, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{delete, get, post};
use common::status;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::access::HEADERS;
use super::live::{live, no_such_site};
use super::{Served, explained, map_rows};
use crate::page;
use crate::picture::site::SitePicture;
use crate::wire::clutter::MAPS;
use crate::wire::columns::{Column, Rows, text};
use crate::wire::operator::{Acquisition, TrackLabel, Zone, drop_track};
use crate::wire::plots::{PLOTS, PlotRow};
use crate::wire::tracks::{TRACKS, TrackRow};
use crate::wire::truth::{SYSTEM_TRACKS, SystemRow};

/// The description of what programs can read.
const OPENAPI: &str = include_str!("../../openapi.json");

/// Longest content of a request, bytes: a zone takes less than 1,000.
const LONGEST_BODY: usize = 16 << 10;

/// What a request holds, if it is not too long.
type Content = Result<Bytes, BytesRejection>;

type Shared = State<Arc<Served>>;

/// All routes.
pub(super) fn routes(served: Arc<Served>) -> Router {
    Router::new()
        .route("/", get(async || asset("index.html")))
        .route("/assets/{name}", get(async |Path(name): Path<String>| asset(&name)))
        .route("/api/v1/openapi.json", get(async || as_json(OPENAPI.to_string())))
        .route("/api/v1/chain", get(chain))
        .route("/api/v1/status", get(status))
        .route("/api/v1/sites/{site}/tracks", get(tracks).post(acquire))
        .route("/api/v1/sites/{site}/tracks/{id}", get(track).delete(end_track))
        .route("/api/v1/sites/{site}/tracks/{id}/label", post(label))
        .route("/api/v1/sites/{site}/zones", get(zones).post(set_zone))
        .route("/api/v1/sites/{site}/zones/{name}", delete(remove_zone))
        .route("/api/v1/sites/{site}/plots", get(plots))
        .route("/api/v1/sites/{site}/clutter-map", get(clutter_map))
        .route("/api/v1/system-tracks", get(system_tracks))
        .route("/api/v1/events", get(events))
        .route("/api/v1/live", get(live))
        .fallback(async |request: Request| {
            failure(StatusCode::NOT_FOUND, &format!("there is no `{}`", request.uri().path()))
        })
        .method_not_allowed_fallback(async |method: Method| {
            failure(StatusCode::METHOD_NOT_ALLOWED, &format!("{method} cannot be done here"))
        })
        .layer(DefaultBodyLimit::max(LONGEST_BODY))
        .layer(from_fn_with_state(Arc::clone(&served), guard))
        .with_state(served)
}

/// Lets through who may look, and says with every answer what a browser must not do with it.
async fn guard(State(served): Shared, request: Request, next: Next) -> Response {
    let mut response = match (served.access.cookie(request.uri()), served.access.check(request.headers())) {
        (Some(cookie), _) if request.uri().path() == "/" => {
            let mut response = StatusCode::SEE_OTHER.into_response();
            response.headers_mut().insert(LOCATION, HeaderValue::from_static("/"));
            response.headers_mut().insert(SET_COOKIE, cookie);
            response
        }
        (_, Err((status, error))) => failure(status, &error),
        (_, Ok(())) => next.run(request).await,
    };
    response.headers_mut().extend(HEADERS);
    response
}

fn asset(name: &str) -> Response {
    match page::asset(name) {
        Some((kind, content)) => ([(CONTENT_TYPE, kind)], Body::from(content)).into_response(),
        None => failure(StatusCode::NOT_FOUND, &format!("there is no asset `{name}`")),
    }
}

pub(super) fn as_json(text: String) -> Response {
    ([(CONTENT_TYPE, "application/json")], text).into_response()
}

/// `{"error": …}`
pub(super) fn failure(status: StatusCode, error: &str) -> Response {
    (status, [(CONTENT_TYPE, "application/json")], text(&serde_json::json!({ "error": error }))).into_response()
}

/// Reads the site of this name, or says that there is none.
fn of_site(served: &Served, name: &str, read: impl FnOnce(&SitePicture)) -> Option<Response> {
    let picture = served.picture();
    let Some((_, site)) = picture.site(name) else {
        return Some(failure(StatusCode::NOT_FOUND, &no_such_site(name)));
    };
    read(site);
    None
}

async fn chain(State(served): Shared) -> Response {
    let chain = served.chain(&served.picture());
    as_json(text(&chain))
}

async fn status(State(served): Shared) -> Response {
    let status = status::to_json(&served.picture().board);
    as_json(text(&status))
}

fn list<R>(columns: &[Column<R>], rows: &[R]) -> Response {
    as_json(text(&Rows { columns, rows }))
}

#[derive(Deserialize)]
struct OfTracks {
    #[serde(default)]
    confirmed: bool,
}

async fn tracks(
    State(served): Shared,
    Path(site): Path<String>,
    query: Result<Query<OfTracks>, QueryRejection>,
) -> Response {
    let Query(OfTracks { confirmed }) = match query {
        Ok(query) => query,
        Err(error) => return failure(StatusCode::BAD_REQUEST, &error.body_text()),
    };
    let mut rows = Vec::new();
    let refused = of_site(&served, &site, |site| {
        let wanted = site.tracks.values().filter(|of| !confirmed || of.track.is_confirmed());
        rows.extend(wanted.map(|of| TrackRow::new(&of.track, site)));
    });
    // Written when the picture is free again.
    refused.unwrap_or_else(|| list(&TRACKS, &rows))
}

async fn track(State(served): Shared, Path((site, id)): Path<(String, String)>) -> Response {
    let mut found = None;
    let refused = of_site(&served, &site, |site| {
        let track = id.parse().ok().and_then(|id: u64| site.tracks.get(&id));
        found = track.map(|of| explained(site, &of.track, &of.way));
    });
    let missing = || failure(StatusCode::NOT_FOUND, &format!("there is no living track `{id}` at `{site}`"));
    refused.unwrap_or_else(|| found.map_or_else(missing, as_json))
}

/// The content of a request.
fn content<T: DeserializeOwned>(content: Content) -> Result<T, String> {
    let bytes = content.map_err(|error| format!("{}, expected at most {LONGEST_BODY} bytes", error.body_text()))?;
    serde_json::from_slice(&bytes).map_err(|error| error.to_string())
}

/// The number of a track, as paths have it.
fn track_number(id: &str) -> Result<u64, String> {
    id.parse().map_err(|_| format!("track `{id}` found, expected a number"))
}

async fn acquire(State(served): Shared, Path(site): Path<String>, body: Content) -> Response {
    served.operate(&site, |place| content::<Acquisition>(body)?.command(place)).await
}

async fn end_track(State(served): Shared, Path((site, id)): Path<(String, String)>) -> Response {
    served.operate(&site, |_| Ok(drop_track(track_number(&id)?))).await
}

async fn label(State(served): Shared, Path((site, id)): Path<(String, String)>, body: Content) -> Response {
    served.operate(&site, |_| content::<TrackLabel>(body)?.command(track_number(&id)?)).await
}

async fn zones(State(served): Shared, Path(site): Path<String>) -> Response {
    let mut zones = Vec::new();
    of_site(&served, &site, |site| zones = Zone::all(site)).unwrap_or_else(|| as_json(text(&zones)))
}

async fn set_zone(State(served): Shared, Path(site): Path<String>, body: Content) -> Response {
    served.operate(&site, |place| content::<Zone>(body)?.command(place)).await
}

async fn remove_zone(State(served): Shared, Path((site, name)): Path<(String, String)>) -> Response {
    served.operate(&site, |_| Zone::removal(&name)).await
}

async fn plots(State(served): Shared, Path(site): Path<String>) -> Response {
    let mut rows = Vec::new();
    let refused = of_site(&served, &site, |site| {
        site.last_scan().for_each(|(_, plots)| rows.extend(PlotRow::all(plots, &site.place)));
    });
    refused.unwrap_or_else(|| list(&PLOTS, &rows))
}

async fn clutter_map(State(served): Shared, Path(site): Path<String>) -> Response {
    let mut rows = Vec::new();
    of_site(&served, &site, |site| rows = map_rows(site)).unwrap_or_else(|| list(&MAPS, &rows))
}

async fn system_tracks(State(served): Shared) -> Response {
    let mut rows = Vec::new();
    for site in &served.picture().sites {
        let tracks = site.system_tracks.iter().flat_map(|(_, tracks)| tracks);
        rows.extend(tracks.map(|track| SystemRow::new(track, &site.place)));
    }
    list(&SYSTEM_TRACKS, &rows)
}

#[derive(Deserialize)]
struct OfEvents {
    #[serde(default)]
    since: u64,
}

async fn events(State(served): Shared, query: Result<Query<OfEvents>, QueryRejection>) -> Response {
    match query {
        Ok(Query(OfEvents { since })) => as_json(text(&served.picture().events.since(since).collect::<Vec<_>>())),
        Err(error) => failure(StatusCode::BAD_REQUEST, &error.body_text()),
    }
}
