/** Strings of the motion page in the console's two languages. */

import { type Language, setLanguage } from "../i18n";

const en = {
  title: "Motions of the arm studies",
  back: "Console",
  none: "No motion yet. Run teleop study tomato --quick (or grape, plantlet), then reload this page.",
  loading: "Loading the motion",
  nowebgl: "This browser offers no WebGL, so the motion cannot be drawn. Try teleop study play FILE.",
  play: "Play or pause (space)",
  position: "Position",
  speed: "Speed",
  path: "Path",
  volumes: "Volumes",
  home: "Reset view",
  theme: "Dark or light",
  language: "EN 中: Language",
  grape: "Grape picking",
  plantlet: "Plantlet transplanting",
  tomato: "Cherry-tomato arm",
  facts: "{robot}: {joints} joints, {seconds} s, path {metres} m, {volumes} volumes",
};

const zh: Record<keyof typeof en, string> = {
  title: "机械臂研究的运动",
  back: "操作台",
  none: "还没有运动。先运行 teleop study tomato --quick（或 grape、plantlet），再刷新本页。",
  loading: "正在加载运动",
  nowebgl: "此浏览器不支持 WebGL，无法绘制运动。可用 teleop study play FILE。",
  play: "播放或暂停（空格）",
  position: "位置",
  speed: "速度",
  path: "路径",
  volumes: "体积",
  home: "重置视角",
  theme: "深色或浅色",
  language: "EN 中: 语言",
  grape: "葡萄采摘",
  plantlet: "组培苗移植",
  tomato: "樱桃番茄机械臂",
  facts: "{robot}：{joints} 个关节，{seconds} 秒，路径 {metres} 米，{volumes} 个体积",
};

export type Word = keyof typeof en;
let table: Record<Word, string> = en;

export function speak(language: Language): void {
  table = language === "zh" ? zh : en;
  setLanguage(language);
  document.title = table.title;
}

export function word(key: Word, values: Record<string, string | number> = {}): string {
  return table[key].replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}

/** The title of a study's motion; a motion under another name is shown by that name. */
export function motionTitle(id: string): string {
  return id === "grape" || id === "plantlet" || id === "tomato" ? word(id) : id.replaceAll("_", " ");
}
