/** The motion page: pick a study's motion, play it, look at it from all sides. */

import "../styles/tokens.css";
import "../styles/controls.css";
import "./motion.css";
import { h } from "../dom";
import { icon, setIcon } from "../icons";
import { prefs, savePrefs } from "../prefs";
import { Clock } from "./clock";
import { pathLength_m } from "./drawn";
import { type Motion, duration_s, fetchMotion, fetchMotions } from "./motion";
import { MotionView, webglWorks } from "./view";
import { type Word, motionTitle, speak, word } from "./words";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4] as const;
const STEP_S = 0.5;

const box = h("div", { class: "motion-box" });
const note = h("p", { class: "motion-note", role: "status" });
const title = h("h1");
const back = h("a", { class: "chip", href: "./" });
const choices = h("nav", { class: "motion-choices" });
const facts = h("p", { class: "motion-facts" });
const glyph = icon("play");
const play = h("button", { class: "button round", type: "button" }, glyph);
const slider = h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0 });
const time = h("output");
const speed = h("select", {}, ...SPEEDS.map((s) => h("option", { value: s, selected: s === 1 }, `${s} ×`)));
const chip = (...children: (Node | string)[]) => h("button", { class: "chip", type: "button" }, ...children);
const pathButton = chip();
const volumesButton = chip();
const homeButton = chip();
const themeButton = chip(icon("theme"));
const languageButton = chip("EN 中");
const shows = { path: true, volumes: true };
const buttons = new Map<string, HTMLButtonElement>();
let view: MotionView | null = null;
let current: Motion | null = null;

const clock = new Clock((t_s, running) => {
  view?.place(t_s);
  slider.value = String(t_s);
  time.textContent = `${t_s.toFixed(2)} / ${Number(slider.max).toFixed(2)} s`;
  setIcon(glyph, running ? "pause" : "play");
});

function say(text: string): void {
  note.textContent = text;
  note.hidden = text === "";
}

function name(element: HTMLElement, key: Word): void {
  element.title = word(key);
  element.setAttribute("aria-label", word(key));
}

function writeTexts(): void {
  title.textContent = word("title");
  back.textContent = `‹ ${word("back")}`;
  pathButton.textContent = word("path");
  volumesButton.textContent = word("volumes");
  homeButton.textContent = word("home");
  name(play, "play");
  name(slider, "position");
  name(speed, "speed");
  name(themeButton, "theme");
  name(languageButton, "language");
  for (const [id, button] of buttons) button.textContent = motionTitle(id);
  facts.textContent = current
    ? word("facts", {
        robot: current.robot.replaceAll("_", " "),
        joints: current.joint_names.length,
        seconds: duration_s(current).toFixed(1),
        metres: pathLength_m(current).toFixed(2),
        volumes: current.volumes.length,
      })
    : "";
}

function applyPreferences(): void {
  document.documentElement.dataset["theme"] = prefs.theme;
  speak(prefs.language);
  writeTexts();
  view?.restyle();
  savePrefs();
}

function showShown(): void {
  volumesButton.hidden = current?.volumes.length === 0;
  pathButton.setAttribute("aria-pressed", String(shows.path));
  volumesButton.setAttribute("aria-pressed", String(shows.volumes));
  view?.setShown(shows);
}

async function open(id: string): Promise<void> {
  clock.pause();
  say(word("loading"));
  for (const [other, button] of buttons) button.setAttribute("aria-pressed", String(other === id));
  try {
    current = await fetchMotion(id);
  } catch (error) {
    if (!(error instanceof Error)) throw error;
    say(error.message);
    return;
  }
  history.replaceState(null, "", `?id=${encodeURIComponent(id)}`);
  view?.show(current);
  showShown();
  slider.max = String(duration_s(current));
  clock.load(duration_s(current));
  writeTexts();
  say("");
  clock.play();
}

async function start(): Promise<void> {
  if (!webglWorks()) {
    say(word("nowebgl"));
    return;
  }
  view = new MotionView(box);
  showShown();
  say(word("loading"));
  try {
    const files = await fetchMotions();
    for (const { id } of files) {
      const button = h("button", { class: "chip", type: "button" }, motionTitle(id));
      button.addEventListener("click", () => void open(id));
      buttons.set(id, button);
      choices.append(button);
    }
    const asked = new URLSearchParams(location.search).get("id");
    const id = asked ?? files[0]?.id;
    if (id === undefined) say(word("none"));
    else await open(id);
  } catch (error) {
    if (!(error instanceof Error)) throw error;
    say(error.message);
  }
}

play.addEventListener("click", () => clock.toggle());
slider.addEventListener("input", () => {
  const wanted_s = Number(slider.value); // pausing writes the slider
  clock.pause();
  clock.seek(wanted_s);
});
speed.addEventListener("change", () => {
  clock.speed = Number(speed.value);
});
pathButton.addEventListener("click", () => {
  shows.path = !shows.path;
  showShown();
});
volumesButton.addEventListener("click", () => {
  shows.volumes = !shows.volumes;
  showShown();
});
homeButton.addEventListener("click", () => view?.home());
themeButton.addEventListener("click", () => {
  prefs.theme = prefs.theme === "dark" ? "light" : "dark";
  applyPreferences();
});
languageButton.addEventListener("click", () => {
  prefs.language = prefs.language === "en" ? "zh" : "en";
  applyPreferences();
});
window.addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLElement && event.target.matches("select, input, button, a")) return;
  if (event.key === " ") clock.toggle();
  else if (event.key === "ArrowLeft") clock.step(-STEP_S);
  else if (event.key === "ArrowRight") clock.step(STEP_S);
  else return;
  event.preventDefault();
});

document
  .getElementById("motion")
  ?.append(
    h("header", {}, back, title, choices, h("div", { class: "motion-tools" }, languageButton, themeButton)),
    h("main", {}, box, note, facts, h("div", { class: "motion-shown" }, pathButton, volumesButton, homeButton)),
    h("footer", {}, play, slider, time, speed),
  );
applyPreferences();
void start();
