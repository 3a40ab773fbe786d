/** Puts the console together: messages in, panels out. */

import "uplot/dist/uPlot.min.css";
import "./styles/tokens.css";
import "./styles/layout.css";
import "./styles/controls.css";
import "./styles/banner.css";
import "./styles/views.css";
import "./styles/person.css";
import "./styles/tools.css";
import "./styles/pick.css";
import "./styles/replay.css";
import "./styles/puppet.css";
import "./styles/measures.css";
import "./styles/sheets.css";
import "./styles/far.css";
import "./styles/small.css";
import { EMERGENCY_STOP, act, emergencyStop, noticeBoard, notify } from "./act";
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
import { AccessPanel } from "./panels/access";
import { helpSheet } from "./panels/help";
import { LatencyPanel } from "./panels/latency";
import { LegsPanel } from "./panels/legs";
import { PlotsPanel } from "./panels/plots";
import { PuppetPanel } from "./panels/puppet";
import { RecordingsSheet } from "./panels/recordings";
import { ReplayPanel } from "./panels/replay";
import { ScenePanel } from "./panels/scene";
import { ToolsPanel } from "./panels/tools";
import { prefs, savePrefs } from "./prefs";
import { SettingsSheet } from "./settings/sheet";
import { Sounds } from "./sounds";
import { WhatIf } from "./whatif";
import { Wizard } from "./calibration/wizard";
import type { ServerMessage, State } from "./wire";
import { WIRE_VERSION } from "./words";

const sounds = new Sounds();
const settings = new SettingsSheet();
const recordings = new RecordingsSheet((recording) => whatIf.ask(recording));
const whatIf = new WhatIf(settings, (job) => void recordings.begin(job));
const wizard = new Wizard();
const access = new AccessPanel(() => connection.reopen());
const help = helpSheet();
const gone = h("div", { class: "gone", hidden: true, role: "alert" }, translated(h("h2"), "gone.title"), translated(h("p"), "gone.text"));

const themeButton = titled(h("button", { class: "chip", type: "button" }, icon("theme")), "button.theme");
const languageButton = titled(h("button", { class: "chip", type: "button" }, "EN 中"), "button.language");
const soundIcon = icon("mute");
const soundButton = titled(h("button", { class: "chip", type: "button" }, soundIcon), "button.sound");
const helpButton = titled(h("button", { class: "chip", type: "button" }, icon("help")), "button.help");

const farButton = titled(h("button", { class: "chip", type: "button", "data-keep": true }, icon("far")), "button.far");
const settingsButton = titled(h("button", { class: "chip", type: "button" }, icon("settings")), "button.settings");
const wizardButton = titled(h("button", { class: "chip", type: "button", "data-commands": true }, icon("ruler")), "button.calibrate");

const banner = new Banner(
  h("div", { class: "side-tools" }, wizardButton, settingsButton, access.button, farButton, languageButton, themeButton, soundButton, helpButton),
  access.element,
);
const camera = new CameraPanel((view) => connection.send(view));
const scene = new ScenePanel();
const replay = new ReplayPanel(recordings);
const puppet = new PuppetPanel();
const floor = new FloorPanel(
  () => puppet.active && !document.body.classList.contains("locked"),
  (x_m, z_m) => puppet.place(x_m, z_m),
);
const arms = new ArmsPanel();
const legs = new LegsPanel();
const tools = new ToolsPanel();
const plots = new PlotsPanel();
const latency = new LatencyPanel();
const events = new EventsPanel();
/** In the order they are painted: what the operator steers by comes first. */
const panels: readonly Panel[] = [camera, banner, floor, scene, arms, legs, tools, replay, puppet, latency, plots, events, wizard];

const painter = new Painter(
  (state: State, now_ms: number) => {
    for (const panel of panels) panel.state?.(state, now_ms);
  },
  (seq, paint_ms) => {
    connection.send({ type: "painted", seq, paint_ms });
    scene.painted(paint_ms);
  },
);

function receive(message: ServerMessage, received_ms: number): void {
  switch (message.type) {
    case "hello":
      if (message.version !== WIRE_VERSION) notify(t("notice.version"));
      if (message.missed_events > 0) notify(t("notice.missed", { count: message.missed_events }));
      for (const panel of panels) panel.hello?.(message);
      break;
    case "state":
      sounds.state(message);
      painter.show(message, received_ms);
      break;
    case "access":
      access.set(message);
      break;
    case "coverage":
      scene.coverage(message);
      break;
    case "preview":
      scene.preview(message);
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
  access.link(link);
  gone.hidden = link === "open" || link === "connecting" || link === "locked";
  document.body.classList.toggle("old", link !== "open");
}

const address = new URL("/api/v1/stream", location.href);
address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
const connection = new Connection(address.href, {
  message: receive,
  image: (kind, picture) => void camera.image(kind, picture),
  link: showLink,
});

function applyPreferences(): void {
  document.documentElement.dataset["theme"] = prefs.theme;
  setLanguage(prefs.language);
  setIcon(soundIcon, prefs.sound ? "sound" : "mute");
  soundButton.setAttribute("aria-pressed", String(prefs.sound));
  document.body.classList.toggle("far", prefs.far);
  farButton.setAttribute("aria-pressed", String(prefs.far));
  for (const panel of panels) panel.restyle?.();
  access.restyle();
  whatIf.restyle();
  settings.restyle();
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

/** Large letters, and only what an operator far away steers by. */
function toggleFar(): void {
  prefs.far = !prefs.far;
  applyPreferences();
}

/** What the server would refuse this console anyway; the buttons say so, the keys keep quiet. */
function command(action: () => void): () => void {
  return () => {
    if (!document.body.classList.contains("locked")) action();
  };
}

farButton.addEventListener("click", toggleFar);
settingsButton.addEventListener("click", () => settings.toggle());
wizardButton.addEventListener("click", () => wizard.toggle());
themeButton.addEventListener("click", toggleTheme);
languageButton.addEventListener("click", toggleLanguage);
soundButton.addEventListener("click", toggleSound);
helpButton.addEventListener("click", () => help.toggle());
window.addEventListener(EMERGENCY_STOP, () => scene.giveWay());
listen(() => void emergencyStop(), {
  "Shift+R": command(() => void act(api.estopReset())),
  "?": () => help.toggle(),
  e: command(() => banner.toggleEngage()),
  p: command(() => replay.toggle()),
  ArrowLeft: command(() => replay.step(-1)),
  ArrowRight: command(() => replay.step(1)),
  "[": command(() => replay.changeSpeed(-1)),
  "]": command(() => replay.changeSpeed(1)),
  ".": command(() => replay.stepFrame()),
  o: command(() => replay.toggleLoop()),
  r: command(() => replay.toggleRecord()),
  b: () => void recordings.open(),
  k: command(() => wizard.toggle()),
  ",": () => settings.toggle(),
  d: toggleFar,
  v: () => camera.toggleImage(),
  n: () => camera.toggleParts(),
  c: () => camera.toggleNumbers(),
  h: () => camera.toggleHead(),
  m: () => camera.toggleMirror(),
  f: () => scene.toggleFollow(),
  g: command(() => scene.pick.key()),
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
    h("div", { class: "column middle" }, scene.element, replay.element, puppet.element, h("div", { class: "pair" }, plots.element, latency.element)),
    h("div", { class: "column right" }, arms.element, legs.element, tools.element, events.element),
  ),
  gone,
  access.asks,
  whatIf.element,
  noticeBoard(),
  help.element,
  recordings.element,
  settings.element,
  wizard.element,
  access.dialog,
);
applyPreferences();
connection.open();
