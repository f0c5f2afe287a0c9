// The page: connection, picture and panels, put together.

import { ChainView } from "./chain.js";
import { Colours } from "./colours.js";
import { Control } from "./control.js";
import { Detail } from "./detail.js";
import { byId, setText } from "./element.js";
import { Events } from "./events.js";
import { Facts } from "./facts.js";
import { Frames } from "./frames.js";
import { Hand } from "./hand.js";
import { Keys, panOf } from "./keys.js";
import { ScreenLatency } from "./latency.js";
import { Layers } from "./layers.js";
import { Legend } from "./legend.js";
import { Link } from "./link.js";
import { TrackList } from "./list.js";
import { Picture } from "./picture.js";
import { Ppi } from "./ppi.js";
import { Probe } from "./probe.js";
import { Selection } from "./selection.js";
import { Settings } from "./settings.js";
import { Timeline } from "./timeline.js";
import { View } from "./view.js";
import { Want } from "./want.js";

const LINK_WORDS = { connecting: "Connecting", open: "Connected", lost: "Connection lost" };
/** Numbers beside the picture change so often, ms: slow enough to be read. */
const PANEL_MS = 200;

const settings = new Settings();
const picture = new Picture();
const view = new View();
const send = (message) => link.send(message);
const selection = new Selection(picture, (follow) => send({ follow }));
const scene = { picture, view, settings, selection, layers: settings.layers, sites: [], hovered: null, following: false };
const parts = Object.fromEntries(["stage", "ground", "plan", "heights"].map((id) => [id, byId(id)]));
scene.colours = new Colours(settings.scheme, () => settings.set({}));
const ppi = new Ppi(parts, scene);
const want = new Want(scene, send);
const frames = new Frames();
const chain = new ChainView(scene);
const layers = new Layers(settings);
const legend = new Legend();
const events = new Events(chooseOfEvent, toast);
const timeline = new Timeline(byId("timeline"), send, events);
const list = new TrackList(scene, choose);
const control = new Control(scene, (text) => events.tell(text));
let shown = "picture";
let dropped = 0;
/** The track of an event that was chosen. */
let sought = null;
let linkState = "connecting";
let linkText = "";

const hearers = {
  hello(message) {
    const again = picture.hello !== null;
    picture.start(message);
    selection.restart();
    ppi.clear();
    chain.start(message);
    timeline.start(message);
    events.start();
    facts.start(message);
    control.start(message);
    layers.start({ sites: message.sites, hasSystem: message.stages.some(({ outputs }) => outputs.includes("system-tracks") || outputs.includes("system_tracks")) || message.sites.length > 1 });
    cover();
    if (!again) view.fit();
    want.forget();
    document.title = `${message.sites.map(({ name }) => name).join(", ")} · radar-chain`;
  },
  sector: (message, arrived_ms) => picture.sector(message, arrived_ms),
  video: (message) => ppi.addVideo(message),
  plots(message) {
    picture.addPlots(message);
    if (picture.widened) cover();
  },
  tracks(message, arrived_ms) {
    picture.addTracks(message);
    latency.arrived(message, arrived_ms);
    selection.refresh();
    selection.sample();
  },
  truth: (message) => picture.addTruth(message),
  system_tracks(message) {
    picture.addSystemTracks(message);
    selection.refresh();
  },
  maps: (message) => picture.addMaps(message),
  track: (message) => selection.hear(message),
  health: (message) => chain.hear(message),
  event: (message) => events.add(message),
  operator(message) {
    picture.setLabels(message);
    control.hear(message);
    panels();
  },
  time(message) {
    timeline.hear(message);
    chooseSought();
  },
  reset() {
    picture.clear();
    selection.restart();
    ppi.clear();
  },
  dropped(message) {
    dropped = message.messages;
    showLink();
  },
};

const address = new URL(`/api/v1/live${location.search}`, location.href);
address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
const link = new Link(
  address,
  // Kinds that a newer server may send are none of this page's business.
  (message, arrived_ms) => hearers[message.type]?.(message, arrived_ms),
  (state, text) => {
    // An attempt to come back is no news until it succeeds.
    if (state === "connecting" && linkState === "lost") return;
    [linkState, linkText] = [state, text];
    byId("link").dataset.state = state;
    document.body.classList.toggle("lost", state === "lost");
    if (state === "lost") dropped = 0;
    showLink();
  },
);
const latency = new ScreenLatency(link.clock);
const facts = new Facts(picture, latency);
const detail = new Detail(byId("detail"), scene, latency, () => choose(null));

function showLink() {
  const text = LINK_WORDS[linkState];
  setText(byId("link"), dropped ? `${text}, ${dropped} dropped` : text);
  const notice = byId("notice");
  const words = noticeText();
  notice.hidden = words === "";
  setText(notice, words);
}

/** What the reader has to know to understand what is, or is not, on the screen. */
function noticeText() {
  if (!ppi.works) return "This browser has no WebGL 2, which the picture needs. The list of tracks and the view of the chain work without it.";
  if (linkState === "lost") return `Connection lost, ${linkText}. What you see is the last that came.`;
  if (picture.hello && Number.isNaN(picture.epoch_s)) return "Connected. No data of a radar have come yet.";
  return "";
}

/** A line at the foot of the plan that goes away by itself. */
function toast(text) {
  const box = byId("toast");
  setText(box, text);
  box.hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => (box.hidden = true), 6000);
}

/** The view shows the coverage of all sites. */
function cover() {
  picture.widened = false;
  const sites = [...picture.sites.values()].map(({ of }) => of).filter((of) => of.range_max_m > 0);
  if (sites.length === 0) return;
  const edge = (axis, sign) => Math.max(...sites.map((of) => sign * of.origin_m[axis] + of.range_max_m));
  const [east, west, north, south] = [edge(0, 1), -edge(0, -1), edge(1, 1), -edge(1, -1)];
  view.cover((east + west) / 2, (north + south) / 2, Math.max(east - west, north - south) / 2);
}

function choose(track) {
  sought = null;
  selection.choose(track ?? null);
  if (!track) scene.following = false;
  panels();
}

function chooseOfEvent(event) {
  timeline.seek(event.time_s);
  sought = `${event.site}/${event.track}`;
  chooseSought();
  show("picture");
}

/** In a recording the track of an event is there only when the server has gone to its time. */
function chooseSought() {
  const track = picture.find(sought);
  if (!track) return;
  sought = null;
  choose(track);
}

function show(name) {
  shown = name;
  for (const of of ["picture", "chain"]) {
    byId(of).hidden = of !== name;
    if (of === name) byId(`show-${of}`).setAttribute("aria-current", "page");
    else byId(`show-${of}`).removeAttribute("aria-current");
  }
  panels();
}

function follow() {
  scene.following = Boolean(selection.track) && !scene.following;
  panels();
}

function nextScheme() {
  settings.set({ scheme: scene.colours.next() });
  showScheme();
}

function showScheme() {
  const [text, label] = { auto: ["Auto", "as the system"], night: ["Night", "night"], day: ["Day", "day"] }[settings.scheme];
  setText(byId("theme"), text);
  byId("theme").setAttribute("aria-label", `Colours: ${label}`);
}

const actions = {
  help: () => keys.openHelp(),
  showPicture: () => show("picture"),
  showChain: () => show("chain"),
  nextTrack: () => selection.step(1, list.order()),
  previousTrack: () => selection.step(-1, list.order()),
  chooseNone() {
    if (!control.leave()) choose(null);
  },
  point: () => control.point(view.x, view.y),
  find() {
    show("picture");
    byId("find").focus();
  },
  zoomIn: () => view.zoom(1.4),
  zoomOut: () => view.zoom(1 / 1.4),
  zoomAll() {
    scene.following = false;
    view.fit();
  },
  centre: follow,
  pan(key) {
    scene.following = false;
    view.pan(...panOf(key, view));
  },
  layers: () => byId("layers-button").click(),
  toggle(_, { layer }) {
    settings.toggle(layer);
    layers.show();
  },
  scheme: nextScheme,
  play: () => timeline.toggle(),
  sector: (key) => timeline.step("sector", key === "." ? 1 : -1),
  scan: (key) => timeline.step("scan", key === ">" ? 1 : -1),
  event: (key) => timeline.jump(key === "]" ? 1 : -1),
};
const keys = new Keys(settings, actions);
new Hand(parts.plan, scene, (x, y, track) => {
  if (!control.point(x, y)) choose(track);
});
for (const [id, act] of Object.entries({
  "show-picture": "showPicture", "show-chain": "showChain", theme: "scheme", "help-button": "help",
  "zoom-in": "zoomIn", "zoom-out": "zoomOut", "zoom-all": "zoomAll", centre: "centre",
})) {
  byId(id).addEventListener("click", () => actions[act]());
}
showScheme();
showLink();

/** Everything beside the picture. */
function panels(soon = false) {
  facts.update();
  showLink();
  const { track } = selection;
  byId("centre").disabled = !track;
  byId("centre").setAttribute("aria-pressed", String(scene.following));
  parts.stage.classList.toggle("without-heights", !settings.layers.heights);
  if (shown === "picture") {
    legend.update(scene);
    list.update(soon);
    detail.update();
    control.update();
  }
  chain.update(shown === "chain");
  timeline.drawTicks(scene.colours);
}

let panels_ms = -Infinity;
function frame(now_ms) {
  requestAnimationFrame(frame);
  latency.frame(performance.now());
  const { track } = selection;
  if (scene.following && track && (track.x_m !== view.x || track.y_m !== view.y)) view.centre(track.x_m, track.y_m);
  want.update(now_ms, shown === "picture");
  const drawn = shown === "picture" && ppi.frame(now_ms);
  if (frames.note(now_ms, drawn) && frames.slow && shown === "picture" && !document.hidden) ppi.coarsen();
  if (drawn) latency.afterDrawing();
  else if (shown !== "picture") latency.forget();
  if (now_ms - panels_ms > PANEL_MS) {
    panels_ms = now_ms;
    panels(true);
    events.say(now_ms);
  }
}
requestAnimationFrame(frame);
document.addEventListener("visibilitychange", () => latency.forget());

window.radarChain = new Probe({ scene, latency, frames, chain, link, ppi, plan: parts.plan, dropped: () => dropped });
