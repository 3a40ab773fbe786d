/** Names for single fields of the wire, and the kinds of binary messages (server/images_wire.py). */

import type { HandsState, RobotWire, State, View } from "./wire";

export type Mode = State["mode"];
export type Zone = State["zone"];
export type Hand = HandsState["right"];
export type Liquid = RobotWire["liquid"];
export type ImageChoice = View["image"];
export type Side = "right" | "left";

export const SIDES: readonly Side[] = ["right", "left"];
export const DEPTH_IMAGE = 1;
export const COLOR_IMAGE = 2;
export const HEAD_IMAGE = 3;
