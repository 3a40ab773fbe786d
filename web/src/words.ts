/** Words used across panels beside those of the wire. Image kinds as in server/images_wire.py. */

/** The server's WIRE_VERSION that this console was built for. */
export const WIRE_VERSION = 1;

export type Side = "right" | "left";

export const SIDES: readonly Side[] = ["right", "left"];
export const DEPTH_IMAGE = 1;
export const COLOR_IMAGE = 2;
export const HEAD_IMAGE = 3;
export const PARTS_IMAGE = 4;
