/** The console's own line icons, 24 x 24, drawn in the current colour. */

import { s } from "./dom";

const paths = {
  nobody: "M12 11a4 4 0 1 0 0-8 4 4 0 0 0 0 8M4 21c0-4 3.5-7 8-7 1 0 2 .2 3 .5M16 16l5 5M21 16l-5 5",
  eye: "M2 12c3-5 6-7 10-7s7 2 10 7c-3 5-6 7-10 7s-7-2-10-7M12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6",
  engaged: "M9 12l2 2 4-5M12 3l8 3v6c0 5-3.5 8-8 9-4.500-1-8-4-8-9V6z",
  picking: "M12 8c-4-2-7 0-7 5 0 4 3 8 5 8 1 0 1.200-.5 2-.5s1 .5 2 .5c2 0 5-4 5-8 0-5-3-7-7-5M12 8c0-3 1-5 4-5",
  spraying: "M12 3c4 5 6 8 6 11a6 6 0 0 1-12 0c0-3 2-6 6-11M9.500 14.500a2.500 2.500 0 0 0 2.500 2.500",
  forward: "M12 21V4M5 11l7-7 7 7",
  back: "M12 3v17M5 13l7 7 7-7",
  left: "M4 4v6h6M4.500 10a8 8 0 1 1-.5 4",
  right: "M20 4v6h-6M19.500 10a8 8 0 1 0 .5 4",
  held: "M8 4v16M16 4v16",
  stopped: "M8 2.500h8L21.500 8v8L16 21.500H8L2.500 16V8zM8 12h8",
  play: "M7 4l13 8-13 8z",
  pause: "M8 4v16M16 4v16",
  step: "M5 4l9 8-9 8zM18 4v16",
  more: "M5 12h.01M12 12h.01M19 12h.01",
  download: "M12 4v11M7 11l5 5 5-5M4 20h16",
  loop: "M4 12V9a3 3 0 0 1 3-3h12M16 3l3 3-3 3M20 12v3a3 3 0 0 1-3 3H5M8 21l-3-3 3-3",
  files: "M3 6h6l2 2h10v11H3z",
  mirror: "M12 3v18M9 7l-6 5 6 5zM15 7l6 5-6 5z",
  target: "M12 3v4M12 17v4M3 12h4M17 12h4M12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  sound: "M4 9v6h4l5 4V5L8 9zM16 9a4 4 0 0 1 0 6M18.500 6.500a8 8 0 0 1 0 11",
  mute: "M4 9v6h4l5 4V5L8 9zM16 9l5 6M21 9l-5 6",
  help: "M9 9a3 3 0 1 1 4 3c-.7.3-1 1-1 2M12 17.500v.5M12 22a10 10 0 1 0 0-20 10 10 0 0 0 0 20",
  open: "M7 12V6M10 11V4M13 11V4M16 12V6M7 12v3a5 5 0 0 0 9 3l3-5M16 12v2",
  fist: "M6 10a2 2 0 0 1 4 0 2 2 0 0 1 4 0 2 2 0 0 1 4 0v4a6 6 0 0 1-12 0zM6 13h5",
  unknown: "M9 9a3 3 0 1 1 4 3c-.7.3-1 1-1 2M12 17.500v.5",
  parts: "M12 7a2.500 2.500 0 1 0 0-5 2.500 2.500 0 0 0 0 5M12 7v7M12 9L6 12M12 9l6 3M12 14l-4 8M12 14l4 8",
  settings: "M4 7h10M18 7h2M4 17h2M10 17h10M16 9.500a2.500 2.500 0 1 0 0-5 2.500 2.500 0 0 0 0 5M8 19.500a2.500 2.500 0 1 0 0-5 2.500 2.500 0 0 0 0 5",
  ruler: "M3 16L16 3l5 5L8 21zM7 12l2 2M10 9l2 2M13 6l2 2",
  person: "M12 11a4 4 0 1 0 0-8 4 4 0 0 0 0 8M4 21c0-4 3.500-7 8-7s8 3 8 7",
  record: "M12 18a6 6 0 1 0 0-12 6 6 0 0 0 0 12",
  far: "M3 9V4h5M21 9V4h-5M3 15v5h5M21 15v5h-5",
  check: "M4 13l5 5L20 6",
  camera: "M4 7h4l2-2h4l2 2h4v12H4zM12 16a3.500 3.500 0 1 0 0-7 3.500 3.500 0 0 0 0 7",
} as const;

export type IconName = keyof typeof paths;

export function icon(name: IconName): SVGSVGElement {
  const path = s("path", { d: paths[name] });
  return s("svg", { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true", "data-icon": name }, path);
}

/** Changes which icon an element made by `icon` shows. */
export function setIcon(element: SVGSVGElement, name: IconName): void {
  if (element.getAttribute("data-icon") === name) return;
  element.setAttribute("data-icon", name);
  element.firstElementChild?.setAttribute("d", paths[name]);
}
