//! `openapi.json` describes what is answered: it is made from the types and tables of the messages (`just openapi`), it
//! names every route, and the answers of a server are as it says.

mod support;

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;
use std::sync::Arc;

use common::clutter_map::{ClutterCell, ClutterMapHeader};
use common::commands::{ACCEPTED, Command, CommandsHeader, EXCLUSION_ZONE, LABEL};
use common::config::{ChainConfig, Sites};
use common::health::{Health, HealthHeader};
use common::messages::RecordedRef;
use common::plots::{HAS_ELEVATION, Plot, PlotsHeader};
use common::system_tracks::{SystemTrack, SystemTracksHeader};
use common::tracks::{CONFIRMED, KIND_HOVER, Track, TracksHeader, UsedPlot};
use common::truth::{TruthHeader, TruthTarget};
use display::picture::events::Event;
use display::picture::video::SectorVideo;
use display::serve::{Access, Served, bind, serve};
use display::wire::SectorMessage;
use display::wire::clutter::{MAPS, MapsHead};
use display::wire::columns::{Column, Columns, Value as Of};
use display::wire::explain::TrackMessage;
use display::wire::hello::{Chain, Extent, Hello};
use display::wire::notices::{Dropped, Failure, HealthMessage, Pong, Reset, TimeMessage};
use display::wire::operator::{Acquisition, Answer, OperatorMessage, TrackLabel, Zone};
use display::wire::plots::{PLOTS, PlotsHead};
use display::wire::requests::Request;
use display::wire::tracks::{TRACKS, TracksHead};
use display::wire::truth::{SYSTEM_TRACKS, ScanHead, TRUTH};
use display::wire::video::VideoHead;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};
use support::{Live, header_of};
use tungstenite::Message;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/openapi.json");

/// A row of a table.
fn row<R>(columns: &[Column<R>]) -> Value {
    let kind = |column: &Column<R>| match column.value {
        Of::Whole(_) | Of::U32(_) | Of::U8(_) => json!({"type": "integer", "minimum": 0}),
        Of::Count(_) => json!({"type": ["integer", "null"], "minimum": 0}),
        Of::F64(_) | Of::F32(_) => json!({"type": ["number", "null"]}),
        Of::Text(_) => json!({"type": ["string", "null"]}),
    };
    let properties: Map<_, _> = columns.iter().map(|column| (column.name.into(), kind(column))).collect();
    let required: Vec<_> = columns.iter().map(|column| column.name).collect();
    json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false})
}

/// A message of this `type`, from the schema of its Rust type.
fn message(kind: &str, mut schema: Value) -> Value {
    assert_eq!(schema["properties"]["type"]["type"], "string", "{kind} has a type");
    schema["properties"]["type"] = json!({"const": kind});
    schema["additionalProperties"] = json!(false);
    schema
}

/// The header of a table and what follows it: its rows in JSON, or its columns in a binary frame.
fn headed(mut head: Value, more: &Value) -> Value {
    for (key, schema) in more["properties"].as_object().expect("properties") {
        head["properties"][key] = schema.clone();
        head["required"].as_array_mut().expect("a list").push(json!(key));
    }
    head
}

/// The schema of a type in its own words; those of other types that it names go to the components.
fn inline<T: JsonSchema>(generator: &mut SchemaGenerator) -> Value {
    json!(T::json_schema(generator))
}

/// Schemas of all messages of the WebSocket by their `type`: of text, those of tables with `items`; and of the headers of binary
/// frames.
fn messages(generator: &mut SchemaGenerator) -> (BTreeMap<&'static str, Value>, BTreeMap<&'static str, Value>) {
    let of_text = [
        ("hello", inline::<Hello>(generator)),
        ("sector", inline::<SectorMessage>(generator)),
        ("health", inline::<HealthMessage>(generator)),
        ("event", inline::<Event>(generator)),
        ("operator", inline::<OperatorMessage>(generator)),
        ("time", inline::<TimeMessage>(generator)),
        ("track", inline::<TrackMessage>(generator)),
        ("dropped", inline::<Dropped>(generator)),
        ("reset", inline::<Reset>(generator)),
        ("pong", inline::<Pong>(generator)),
        ("error", inline::<Failure>(generator)),
    ];
    let tables = [
        ("plots", inline::<PlotsHead>(generator), Some("PlotRow")),
        ("tracks", inline::<TracksHead>(generator), Some("TrackRow")),
        ("truth", inline::<ScanHead>(generator), Some("TruthRow")),
        ("system_tracks", inline::<ScanHead>(generator), Some("SystemTrackRow")),
        ("maps", inline::<MapsHead>(generator), Some("ClutterRow")),
        ("video", inline::<VideoHead>(generator), None),
    ];
    let columns = inline::<Columns>(generator);
    let mut text: BTreeMap<_, _> = of_text.into_iter().map(|(kind, schema)| (kind, message(kind, schema))).collect();
    let mut binary = BTreeMap::new();
    for (kind, head, rows) in tables {
        let head = message(kind, head);
        if let Some(rows) = rows {
            text.insert(kind, headed(head.clone(), &json!({"properties": {"items": list(rows)}})));
        }
        binary.insert(kind, headed(head, &columns));
    }
    (text, binary)
}

/// Name of the schema of a message: `SystemTracksMessage`, or `SystemTracksHeader` of a binary one.
fn name_of(kind: &str, ending: &str) -> String {
    let words = kind.split('_').map(|word| word[..1].to_uppercase() + &word[1..]);
    words.collect::<String>() + ending
}

/// Puts schemas of messages among the components; the references to them by the `type` of the message.
fn named(all: BTreeMap<&str, Value>, ending: &str, schemas: &mut Map<String, Value>) -> Map<String, Value> {
    let refer = |(kind, schema): (&str, Value)| {
        let name = name_of(kind, ending);
        schemas.insert(name.clone(), schema);
        (kind.to_string(), json!({"$ref": format!("#/components/schemas/{name}")}))
    };
    all.into_iter().map(refer).collect()
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
    let (of_text, of_binary) = messages(&mut generator);
    let request = json!(generator.subschema_for::<Request>());
    let mut schemas = generator.take_definitions(true);
    let (of_text, of_binary) = (named(of_text, "Message", &mut schemas), named(of_binary, "Header", &mut schemas));
    schemas.insert("TruthRow".into(), row(&TRUTH));
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
                over the WebSocket /api/v1/live; docs/display-api.md describes how.",
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
                "description": "A client says what it wants, and is sent JSON with a `type` and binary tables: docs/display-api.md describes both, x-websocket-messages names their schemas.",
                "x-websocket-messages": {
                    "client": request,
                    "server": {"text": of_text, "binary_header": of_binary}
                },
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
            "minItems" | "maxItems" | "minimum" | "maximum" | "format" | "description" | "title" | "default" => {}
            other => panic!("{place}: `{other}` is not known to this test"),
        }
    }
    Ok(())
}

fn sites() -> Sites {
    Sites::one(ChainConfig::default())
}

/// Serves a picture with something of everything in it.
fn start(served: Served) -> (SocketAddr, Arc<Served>) {
    let served = Arc::new(served);
    let listener = bind("127.0.0.1:0".parse().expect("an address")).expect("a port");
    let address = listener.local_addr().expect("its address");
    serve(listener, Arc::clone(&served)).expect("a thread");
    fill(&served);
    (address, served)
}

/// Takes a message of each kind.
fn fill(served: &Served) {
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
    served.take(0, RecordedRef::Truth(&TruthHeader::default(), &[TruthTarget::default()]), 1);
    let map = ClutterMapHeader { scans: 1.0, range_step_m: 100.0, ..ClutterMapHeader::default() };
    served.take(0, RecordedRef::ClutterMap(&map, &[ClutterCell::default()]), 1);
    let zone = Command { name: "hill".into(), outcome: ACCEPTED, ..Command::new(EXCLUSION_ZONE, 1, 1) };
    let zone = zone.at(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
    let label = Command { track_id: 1, name: "blue".into(), outcome: ACCEPTED, ..Command::new(LABEL, 1, 2) };
    for action in [zone, label] {
        served.take(0, RecordedRef::Actions(&CommandsHeader::default(), &[action]), 1);
    }
    let health = Health { process: "tracker".into(), ..Health::default() };
    served.take(0, RecordedRef::HealthReports(&HealthHeader::default(), &[health]), 1);
}

#[test]
fn answers_are_as_described() {
    let (address, _served) = start(Served::live(&sites(), Access::default()));

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

/// Reads messages, each as its schema says, until one of this type has come; the types are noted.
fn read_until(viewer: &mut Live, last: &str, seen: &mut BTreeSet<(&'static str, String)>, written: &Value) {
    let live = &written["paths"]["/api/v1/live"]["get"];
    let told = &live["x-websocket-messages"]["server"];
    loop {
        let (value, place) = match viewer.next().expect("a message") {
            Message::Text(text) => (serde_json::from_str(&text).expect("JSON"), "text"),
            Message::Binary(bytes) => (header_of(&bytes), "binary_header"),
            _ => continue,
        };
        let kind = value["type"].as_str().expect("a type").to_string();
        let schema = told[place].get(&kind).unwrap_or_else(|| panic!("{kind} is not described"));
        check(&value, schema, &written["components"]["schemas"], &kind).unwrap_or_else(|error| panic!("{error}"));
        let is_last = kind == last;
        seen.insert((place, kind));
        if is_last {
            return;
        }
    }
}

/// Every message that the WebSocket sends, in both encodings, and what it may be sent.
#[test]
fn messages_are_as_described() {
    let extent = Extent { from_s: 0.0, to_s: 9.0, files: 1 };
    let (address, served) = start(Served::recording(&sites(), Access::default(), extent, Box::new(|_| true)));
    let (written, mut seen) = (written(), BTreeSet::new());
    let live = &written["paths"]["/api/v1/live"]["get"]["x-websocket-messages"];
    let schemas = &written["components"]["schemas"];
    let mut viewer = Live::open(address);
    let send = |viewer: &mut Live, request: &Value| {
        check(request, &live["client"], schemas, "request").unwrap_or_else(|error| panic!("{error}"));
        viewer.send(&request.to_string());
    };
    let want = json!({
        "video": {"lines": 64, "ranges": 8}, "plots": true, "tracks": true, "truth": true, "system_tracks": true, "maps": true,
        "health": true, "events": true
    });
    let follow = json!({"site": "site1", "track": 1});
    for encoding in ["binary", "json"] {
        send(&mut viewer, &json!({"want": want, "encoding": encoding, "follow": follow, "ping": encoding}));
        read_until(&mut viewer, "pong", &mut seen, &written);
        fill(&served);
        let video = SectorVideo {
            scan: 0,
            sector: 0,
            time_s: 0.0,
            azimuth_first_rad: 0.0,
            azimuth_step_rad: 0.1,
            range_first_m: 0.0,
            range_step_m: 1.0,
            ranges: 2,
            levels: vec![1, 2],
        };
        served.take_video(0, &video);
        served.say(&TimeMessage::new(1.0, true, 2.0));
        send(&mut viewer, &json!({"play": 1.0, "pause": false, "seek": 3.0, "step": "scan", "by": -1}));
        if encoding == "binary" {
            read_until(&mut viewer, "video", &mut seen, &written);
        }
        viewer.send(r#"{"wants": 1}"#);
        read_until(&mut viewer, "error", &mut seen, &written);
    }
    // A viewer that does not look is told of it, and begins anew.
    let plots = vec![Plot::default(); 1000];
    while served.counts().dropped == 0 {
        served.take(0, RecordedRef::Plots(&PlotsHeader::default(), &plots), 1);
    }
    read_until(&mut viewer, "reset", &mut seen, &written);
    for place in ["text", "binary_header"] {
        let of_place = seen.iter().filter(|(of, _)| *of == place).map(|(_, kind)| kind);
        let described = live["server"][place].as_object().expect("messages").keys();
        assert_eq!(of_place.collect::<BTreeSet<_>>(), described.collect(), "{place}");
    }
    // What is described is what is accepted.
    for wrong in
        [json!({"wants": {}}), json!({"want": {"plots": 1}}), json!({"step": "turn"}), json!({"follow": {"site": "x"}})]
    {
        assert!(
            check(&wrong, &live["client"], schemas, "").is_err() && Request::parse(&wrong.to_string()).is_err(),
            "{wrong}"
        );
    }
}

/// How a WebSocket is refused.
#[test]
fn refusals_are_as_described() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(file.path(), "0123456789abcdef").expect("a token");
    let guarded = Access::new(&file.path().display().to_string()).expect("a token");
    let (address, _served) = start(Served::live(&sites(), Access::default()));
    let (with_token, _guarded) = start(Served::live(&sites(), guarded));
    let written = written();
    let responses = &written["paths"]["/api/v1/live"]["get"]["responses"];
    for (address, origin, status) in
        [(address, "", 400), (address, "origin: http://evil.example\r\n", 403), (with_token, "", 401)]
    {
        let answer = support::get_with(address, "/api/v1/live", origin);
        assert_eq!(answer.status, status, "{}", answer.head);
        let schema = &responses[status.to_string()]["content"]["application/json"]["schema"];
        assert!(schema.is_object(), "{status} is described");
        check(&answer.json(), schema, &written["components"]["schemas"], "live")
            .unwrap_or_else(|error| panic!("{error}"));
    }
}
