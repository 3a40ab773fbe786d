/** Puts the console together: messages in, panels out. */

import "uplot/dist/uPlot.min.css";
import "./styles/tokens.css";
import "./styles/layout.css";
import "./styles/controls.css";
import "./styles/banner.css";
import "./styles/views.css";
import "./styles/person.css";
import "./styles/tools.css";
import "./styles/replay.css";
import "./styles/measures.css";
import "./styles/small.css";
import { act, emergencyStop, noticeBoard, notify } from "./act";
import { api } from "./api";
import { Connection, type Link } from "./connection";
import { h } from "./dom";
import { setLanguage, t, titled, translated } from "./i18n";
import { icon, setIcon } from "./icons";
import { listen } from "./keys";
import { Painter } from "./painter";
import type { Panel } from "./panel";
import { ArmsPanel } from "./panels/arms";
import { Banner } from "./panels/banner";
import { CameraPanel } from "./panels/camera";
import { EventsPanel } from "./panels/events";
import { FloorPanel } from "./panels/floor";
import { helpSheet } from "./panels/help";
import { LatencyPanel } from "./panels/latency";
import { LegsPanel } from "./panels/legs";
import { PlotsPanel } from "./panels/plots";
import { RecordingsSheet } from "./panels/recordings";
import { ReplayPanel } from "./panels/replay";
import { ScenePanel } from "./panels/scene";
import { ToolsPanel } from "./panels/tools";
import { prefs, savePrefs } from "./prefs";
import { Sounds } from "./sounds";
import type { ServerMessage, State } from "./wire";
import { WIRE_VERSION } from "./words";

const sounds = new Sounds();
const recordings = new RecordingsSheet();
const help = helpSheet();
const gone = h("div", { class: "gone", hidden: true, role: "alert" }, translated(h("h2"), "gone.title"), translated(h("p"), "gone.text"));

const themeButton = titled(h("button", { class: "chip", type: "button" }, icon("theme")), "button.theme");
const languageButton = titled(h("button", { class: "chip", type: "button" }, "EN 中"), "button.language");
const soundIcon = icon("mute");
const soundButton = titled(h("button", { class: "chip", type: "button" }, soundIcon), "button.sound");
const helpButton = titled(h("button", { class: "chip", type: "button" }, icon("help")), "button.help");

const banner = new Banner(h("div", { class: "side-tools" }, languageButton, themeButton, soundButton, helpButton));
const camera = new CameraPanel((image, head) => connection.send({ type: "view", image, head }));
const scene = new ScenePanel();
const replay = new ReplayPanel(recordings);
const floor = new FloorPanel();
const arms = new ArmsPanel();
const legs = new LegsPanel();
const tools = new ToolsPanel();
const plots = new PlotsPanel();
const latency = new LatencyPanel();
const events = new EventsPanel();
/** In the order they are painted: what the operator steers by comes first. */
const panels: readonly Panel[] = [camera, banner, floor, scene, arms, legs, tools, replay, latency, plots, events];

const painter = new Painter(
  (state: State, now_ms: number) => {
    for (const panel of panels) panel.state?.(state, now_ms);
  },
  (seq) => connection.send({ type: "painted", seq }),
);

function receive(message: ServerMessage): void {
  switch (message.type) {
    case "hello":
      if (message.version !== WIRE_VERSION) notify(t("notice.version"));
      for (const panel of panels) panel.hello?.(message);
      break;
    case "state":
      sounds.state(message);
      painter.show(message);
      break;
    case "event":
      for (const panel of panels) panel.event?.(message);
      break;
    case "error":
      notify(message.detail);
      break;
  }
}

function showLink(link: Link): void {
  banner.showLink(link);
  gone.hidden = link === "open" || link === "connecting";
  document.body.classList.toggle("old", link !== "open");
}

const address = new URL("/api/v1/stream", location.href);
address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
const connection = new Connection(address.href, {
  message: receive,
  image: (kind, jpeg) => void camera.image(kind, jpeg),
  link: showLink,
});

function applyPreferences(): void {
  document.documentElement.dataset["theme"] = prefs.theme;
  setLanguage(prefs.language);
  setIcon(soundIcon, prefs.sound ? "sound" : "mute");
  soundButton.setAttribute("aria-pressed", String(prefs.sound));
  for (const panel of panels) panel.restyle?.();
  savePrefs();
}

function toggleTheme(): void {
  prefs.theme = prefs.theme === "dark" ? "light" : "dark";
  applyPreferences();
}

function toggleLanguage(): void {
  prefs.language = prefs.language === "en" ? "zh" : "en";
  applyPreferences();
}

function toggleSound(): void {
  prefs.sound = !prefs.sound;
  applyPreferences();
}

themeButton.addEventListener("click", toggleTheme);
languageButton.addEventListener("click", toggleLanguage);
soundButton.addEventListener("click", toggleSound);
helpButton.addEventListener("click", () => help.toggle());
listen(() => void emergencyStop(), {
  "Shift+R": () => void act(api.estopReset()),
  "?": () => help.toggle(),
  e: () => banner.toggleEngage(),
  p: () => replay.toggle(),
  ArrowLeft: () => replay.step(-1),
  ArrowRight: () => replay.step(1),
  "[": () => replay.changeSpeed(-1),
  "]": () => replay.changeSpeed(1),
  o: () => replay.toggleLoop(),
  v: () => camera.toggleImage(),
  m: () => camera.toggleMirror(),
  f: () => scene.toggleFollow(),
  t: toggleTheme,
  l: toggleLanguage,
  s: toggleSound,
});

document.getElementById("console")?.append(
  banner.element,
  h(
    "main",
    {},
    h("div", { class: "column left" }, camera.element, floor.element),
    h("div", { class: "column middle" }, scene.element, replay.element, h("div", { class: "pair" }, plots.element, latency.element)),
    h("div", { class: "column right" }, arms.element, legs.element, tools.element, events.element),
  ),
  gone,
  noticeBoard(),
  help.element,
  recordings.element,
);
applyPreferences();
connection.open();
