//! `openapi.json` describes what is answered: it is made from the types and tables of the messages (`just openapi`), it
//! names every route, and the answers of a server are as it says.

mod support;

use std::collections::BTreeSet;
use std::sync::Arc;

use common::clutter_map::{ClutterCell, ClutterMapHeader};
use common::commands::{ACCEPTED, Command, CommandsHeader, EXCLUSION_ZONE};
use common::config::{ChainConfig, Sites};
use common::health::{Health, HealthHeader};
use common::messages::RecordedRef;
use common::plots::{HAS_ELEVATION, Plot, PlotsHeader};
use common::system_tracks::{SystemTrack, SystemTracksHeader};
use common::tracks::{CONFIRMED, KIND_HOVER, Track, TracksHeader, UsedPlot};
use display::picture::events::Event;
use display::serve::{Access, Served, bind, serve};
use display::wire::clutter::MAPS;
use display::wire::columns::Column;
use display::wire::explain::TrackMessage;
use display::wire::hello::Chain;
use display::wire::operator::{Acquisition, Answer, TrackLabel, Zone};
use display::wire::plots::PLOTS;
use display::wire::tracks::TRACKS;
use display::wire::truth::SYSTEM_TRACKS;
use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");

/// A row of a table.
fn row<R>(columns: &[Column<R>]) -> Value {
    let kind = |column: &Column<R>| {
        if column.is_whole() { json!({"type": "integer", "minimum": 0}) } else { json!({"type": ["number", "null"]}) }
    };
    let properties: serde_json::Map<_, _> = columns.iter().map(|column| (column.name.into(), kind(column))).collect();
    let required: Vec<_> = columns.iter().map(|column| column.name).collect();
    json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false})
}

fn list(of: &str) -> Value {
    json!({"type": "array", "items": {"$ref": format!("#/components/schemas/{of}")}})
}

fn parameter(name: &str, place: &str, kind: &str, about: &str) -> Value {
    json!({"name": name, "in": place, "required": place == "path", "description": about, "schema": {"type": kind}})
}

/// An answer that says in one line what is wrong.
fn error(about: &str) -> Value {
    let schema = json!({"$ref": "#/components/schemas/Error"});
    json!({"description": about, "content": {"application/json": {"schema": schema}}})
}

fn path(summary: &str, parameters: &[Value], kind: &str, schema: &Value) -> Value {
    let found = json!({"description": summary, "content": {kind: {"schema": schema}}});
    let mut responses =
        json!({"200": found, "401": error("A token is expected."), "403": error("A foreign host or origin.")});
    if parameters.iter().any(|parameter| parameter["in"] == "path") {
        responses["404"] = error("There is none.");
    }
    if parameters.iter().any(|parameter| parameter["in"] == "query") {
        responses["400"] = error("A query that is not known.");
    }
    json!({"get": {"summary": summary, "parameters": parameters, "responses": responses}})
}

/// A request by which an operator acts, with what it holds.
fn acting(summary: &str, parameters: &[Value], content: Option<&Value>) -> Value {
    let json =
        |about: &str, schema: Value| json!({"description": about, "content": {"application/json": {"schema": schema}}});
    let answer = |about: &str| json(about, json!({"$ref": "#/components/schemas/Answer"}));
    let mut request = json!({"summary": summary, "parameters": parameters, "responses": {
        "200": answer("The tracker has accepted it."),
        "202": answer("The tracker has not answered yet: an event tells what it says."),
        "400": error("It makes no sense."),
        "401": error("A token is expected."),
        "403": error("A foreign host or origin, or nobody may act here."),
        "404": error("There is none."),
        "409": error("The site has no tracker here, or its tracker no room."),
        "503": error("Too many commands wait."),
    }});
    if let Some(content) = content {
        request["requestBody"] = json!({"required": true, "content": {"application/json": {"schema": content}}});
    }
    request
}

/// The same path with another method.
fn and(mut path: Value, method: &str, request: Value) -> Value {
    path[method] = request;
    path
}

/// The description, from the types.
fn description() -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| {
        settings.definitions_path = "/components/schemas".into();
        settings.meta_schema = None;
    });
    let mut generator = settings.into_generator();
    let [chain, event, track, _, acquisition, label, zone] = [
        generator.subschema_for::<Chain>(),
        generator.subschema_for::<Event>(),
        generator.subschema_for::<TrackMessage>(),
        generator.subschema_for::<Answer>(),
        generator.subschema_for::<Acquisition>(),
        generator.subschema_for::<TrackLabel>(),
        generator.subschema_for::<Zone>(),
    ]
    .map(|schema| json!(schema));
    let mut schemas = generator.take_definitions(true);
    schemas.insert("PlotRow".into(), row(&PLOTS));
    schemas.insert("TrackRow".into(), row(&TRACKS));
    schemas.insert("ClutterRow".into(), row(&MAPS));
    schemas.insert("SystemTrackRow".into(), row(&SYSTEM_TRACKS));
    let of_errors = json!({"type": "object", "properties": {"error": {"type": "string"}}, "required": ["error"], "additionalProperties": false});
    schemas.insert("Error".into(), of_errors);
    let site = || parameter("site", "path", "string", "Name of a site.");
    let track_id = || parameter("id", "path", "integer", "Number of the track.");
    let json = "application/json";
    let object = json!({"type": "object", "additionalProperties": true});
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "radar-chain: the picture",
            "version": "1",
            "description": "What a radar chain sees, as its page reads it. Metres east, north and up of the first site's antenna, \
                radians, azimuth clockwise from north, seconds UTC of measurement; null is what is not known. Live data is sent \
                over the WebSocket /api/v1/live, described in docs/display-api.md.",
            "license": {"name": "MIT OR Apache-2.0", "url": "https://spdx.org/licenses/MIT.html"}
        },
        "servers": [{"url": "http://127.0.0.1:8080"}],
        "security": [{}, {"token": []}],
        "paths": {
            "/api/v1/openapi.json": path("This description.", &[], json, &object),
            "/api/v1/chain": path("What there is to see.", &[], json, &chain),
            "/api/v1/status": path(
                "What the processes say of themselves by name, site by site where there are several: what `radar-chain status --json` prints.",
                &[], json, &object),
            "/api/v1/sites/{site}/tracks": and(path(
                "The living tracks of a site.",
                &[site(), parameter("confirmed", "query", "boolean", "Whether to leave out tentative tracks.")],
                json, &list("TrackRow")),
                "post", acting("Has a track begin at a place, from the first two plots in the next five turns.", &[site()], Some(&acquisition))),
            "/api/v1/sites/{site}/tracks/{id}": and(path(
                "Everything that is known of a track.", &[site(), track_id()], json, &track),
                "delete", acting("Ends a track. If its target is seen again, it gets another number.", &[site(), track_id()], None)),
            "/api/v1/sites/{site}/tracks/{id}/label": {
                "post": acting("Gives a track a label, or takes it away.", &[site(), track_id()], Some(&label))},
            "/api/v1/sites/{site}/zones": and(
                path("The zones of a site.", &[site()], json, &list("Zone")),
                "post", acting("Sets a zone, in place of one of the same name.", &[site()], Some(&zone))),
            "/api/v1/sites/{site}/zones/{name}": {"delete": acting(
                "Removes a zone.", &[site(), parameter("name", "path", "string", "Name of the zone.")], None)},
            "/api/v1/sites/{site}/plots": path("The plots of the last scan of a site.", &[site()], json, &list("PlotRow")),
            "/api/v1/sites/{site}/clutter-map": path(
                "Where false plots fall at a site: found and promised in each cell of a polar grid, and expected by the tracker; empty where there are none.",
                &[site()], json, &list("ClutterRow")),
            "/api/v1/system-tracks": path("What several sites together know of targets.", &[], json, &list("SystemTrackRow")),
            "/api/v1/events": path(
                "What has happened, oldest first: the last 4096 events.",
                &[parameter("since", "query", "integer", "Only events after the one with this number.")],
                json, &json!({"type": "array", "items": event})),
            "/api/v1/live": {"get": {
                "summary": "The WebSocket of live data.",
                "description": "A client says what it wants, and is sent JSON with a `type` and binary tables: docs/display-api.md describes both.",
                "responses": {
                    "101": {"description": "The connection is a WebSocket now."},
                    "400": error("No request for a WebSocket."),
                    "401": error("A token is expected."),
                    "403": error("A foreign host or origin."),
                    "503": error("Too many viewers.")
                }
            }}
        },
        "components": {
            "schemas": schemas,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}}
        }
    })
}

fn written() -> Value {
    serde_json::from_str(&std::fs::read_to_string(FILE).expect("the file")).expect("JSON")
}

#[test]
fn the_file_is_as_the_types_are() {
    let mut text = serde_json::to_string_pretty(&description()).expect("JSON");
    text.push('\n');
    if std::env::var_os("WRITE_OPENAPI").is_some() {
        std::fs::write(FILE, &text).expect("the file");
    }
    assert!(std::fs::read_to_string(FILE).expect("the file") == text, "just openapi writes display/openapi.json anew");
}

#[test]
fn every_route_is_described_and_everything_described_is_a_route() {
    let source = include_str!("../src/serve/routes.rs");
    let routes = source.split(".route(").skip(1).filter_map(|rest| rest.split('"').nth(1));
    let of_programs: BTreeSet<_> = routes.filter(|route| route.starts_with("/api/")).map(String::from).collect();
    let described: BTreeSet<_> = written()["paths"].as_object().expect("paths").keys().cloned().collect();
    assert_eq!(of_programs, described);
}

/// Whether a value is as a schema says; what is not, in words. A word of the schema that is not known here is an error.
fn check(value: &Value, schema: &Value, all: &Value, place: &str) -> Result<(), String> {
    let Some(schema) = schema.as_object() else { return Ok(()) };
    for (word, of) in schema {
        match word.as_str() {
            "$ref" => {
                let name = of.as_str().and_then(|path| path.strip_prefix("#/components/schemas/")).expect("a name");
                check(value, &all[name], all, place)?;
            }
            "anyOf" | "oneOf" => {
                let tries: Vec<_> =
                    of.as_array().expect("a list").iter().map(|of| check(value, of, all, place)).collect();
                if tries.iter().all(Result::is_err) {
                    return Err(format!("{place}: {tries:?}"));
                }
            }
            "type" => {
                let is = |kind: &Value| match kind.as_str().expect("a type") {
                    "object" => value.is_object(),
                    "array" => value.is_array(),
                    "string" => value.is_string(),
                    "boolean" => value.is_boolean(),
                    "null" => value.is_null(),
                    "number" => value.is_number(),
                    "integer" => value.is_u64() || value.is_i64(),
                    other => panic!("type {other}"),
                };
                let fits = of.as_array().map_or_else(|| is(of), |kinds| kinds.iter().any(is));
                fits.then_some(()).ok_or(format!("{place}: {value} is no {of}"))?;
            }
            "const" => (value == of).then_some(()).ok_or(format!("{place}: {value} is not {of}"))?,
            "enum" => of
                .as_array()
                .expect("a list")
                .contains(value)
                .then_some(())
                .ok_or(format!("{place}: {value} is none of {of}"))?,
            "required" => {
                let missing =
                    of.as_array().expect("a list").iter().find(|key| value.get(key.as_str().unwrap_or("")).is_none());
                missing.map_or(Ok(()), |key| Err(format!("{place}: {key} is missing")))?;
            }
            "properties" => {
                for (key, of) in of.as_object().expect("properties") {
                    value.get(key).map_or(Ok(()), |value| check(value, of, all, &format!("{place}.{key}")))?;
                }
                // The types say everything that there is, also where a schema would allow more.
                let open = schema.get("additionalProperties").is_some_and(|more| more != &json!(false));
                let more = value.as_object().and_then(|object| object.keys().find(|key| of.get(*key).is_none()));
                more.filter(|_| !open).map_or(Ok(()), |key| Err(format!("{place}: {key} is not described")))?;
            }
            "additionalProperties" => {
                let known = schema.get("properties");
                let more = value.as_object().into_iter().flatten();
                for (key, value) in more.filter(|(key, _)| known.is_none_or(|known| known.get(*key).is_none())) {
                    check(value, of, all, &format!("{place}.{key}"))?;
                }
            }
            "items" => value.as_array().into_iter().flatten().try_for_each(|value| check(value, of, all, place))?,
            "minItems" | "maxItems" | "minimum" | "maximum" | "format" | "description" | "title" => {}
            other => panic!("{place}: `{other}` is not known to this test"),
        }
    }
    Ok(())
}

#[test]
fn answers_are_as_described() {
    let sites = Sites::one(ChainConfig::default());
    let served = Arc::new(Served::live(&sites, Access::default()));
    let listener = bind("127.0.0.1:0".parse().expect("an address")).expect("a port");
    let address = listener.local_addr().expect("its address");
    serve(listener, Arc::clone(&served)).expect("a thread");
    let plots = PlotsHeader { sectors_per_scan: 1, ..PlotsHeader::default() };
    served.take(0, RecordedRef::Plots(&plots, &[Plot { flags: HAS_ELEVATION, ..Plot::default() }, Plot::default()]), 1);
    let mut track = Track { id: 1, known: 9, models: 1, state_code: CONFIRMED, ..Track::EMPTY };
    track.model_kind[0] = KIND_HOVER;
    track.used[0] = UsedPlot { weight: 0.5, ..UsedPlot::NONE };
    track.used[1] = UsedPlot { seq: 99, weight: 0.5, ..UsedPlot::NONE };
    let tracks = TracksHeader {
        stamps: common::message::Stamps { source_out_ns: 1, ..Default::default() },
        ..TracksHeader::default()
    };
    served.take(0, RecordedRef::Tracks(&tracks, &[track]), 2);
    served.take(0, RecordedRef::SystemTracks(&SystemTracksHeader::default(), &[SystemTrack::default()]), 1);
    let map = ClutterMapHeader { scans: 1.0, range_step_m: 100.0, ..ClutterMapHeader::default() };
    served.take(0, RecordedRef::ClutterMap(&map, &[ClutterCell::default()]), 1);
    let zone = Command { name: "hill".into(), outcome: ACCEPTED, ..Command::new(EXCLUSION_ZONE, 1, 1) };
    let zone = zone.at(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
    served.take(0, RecordedRef::Actions(&CommandsHeader::default(), &[zone]), 1);
    let health = Health { process: "tracker".into(), ..Health::default() };
    served.take(0, RecordedRef::HealthReports(&HealthHeader::default(), &[health]), 1);

    let written = written();
    let schemas = &written["components"]["schemas"];
    let mut checked = 0;
    for (path, of) in written["paths"].as_object().expect("paths") {
        let Some(schema) = of["get"]["responses"]["200"]["content"].get("application/json") else { continue };
        let answer = support::get(address, &path.replace("{site}", "site1").replace("{id}", "1"));
        assert!(
            answer.status == 200 && answer.head.contains("content-type: application/json"),
            "{path}: {}",
            answer.head
        );
        let value = answer.json();
        assert!(value.as_array().is_none_or(|list| !list.is_empty()), "{path}: nothing to check");
        check(&value, &schema["schema"], schemas, path).unwrap_or_else(|error| panic!("{error}"));
        checked += 1;
    }
    assert_eq!(checked, 10);
    let error = support::get(address, "/api/v1/sites/none/plots");
    check(&error.json(), &schemas["Error"], schemas, "error").expect("as described");
    // The check itself finds what is wrong.
    assert!(check(&json!([{"id": 1}]), &list("TrackRow"), schemas, "").is_err());
    assert!(check(&json!({"error": "x", "more": 1}), &schemas["Error"], schemas, "").is_err());
}
