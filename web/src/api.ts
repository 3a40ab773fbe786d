/** Actions over REST. Every refusal reaches the operator in words. */

import { clientKey } from "./client";
import type { Json, Schema } from "./settings/schema";
import type { Access, TaskState } from "./wire";

export interface Recording {
  id: string;
  name: string;
  uri: string;
  bundled: boolean;
  size_bytes: number;
  /** Unix time [s]. */
  modified: number;
  duration_s: number | null;
}

/** What happened in a recording. */
export interface Story {
  duration_s: number;
  events: { position_s: number; kind: string; reason: string; detail: string }[];
  modes: { position_s: number; mode: string }[];
}

/** A long job as it stands. */
export interface Job {
  id: string;
  kind: string;
  detail: string;
  status: "queued" | "running" | "done" | "failed" | "cancelled";
  progress: number;
  result: { file?: string; bytes?: number; lines?: string[] } | null;
  error: string | null;
}

export type ExportFormat = "csv" | "mp4" | "lerobot";

export interface VirtualArm {
  side_deg: number;
  front_deg: number;
  elbow_deg: number;
  hand: "open" | "relaxed" | "fist";
}

/** What the rendered operator of ``virtual:live`` is told to do. */
export interface VirtualOperator {
  x_m: number;
  z_m: number;
  turn_deg: number;
  apart_deg: number;
  right: VirtualArm;
  left: VirtualArm;
  gesture: "none" | "engage" | "stop";
}

export type VirtualChange = Partial<Omit<VirtualOperator, "right" | "left">> & { right?: Partial<VirtualArm>; left?: Partial<VirtualArm> };

export interface RobotRequest {
  lift_m?: number;
  disc_rad?: number;
}

export interface SessionRequest {
  source: string;
  loop: boolean;
  record: boolean;
}

export type LeaseAction = "request" | "release" | "take";

/** A request that the server refused or did not answer. status: of HTTP, 0 without an answer. */
export class RequestError extends Error {
  constructor(
    message: string,
    readonly status: number,
  ) {
    super(message);
  }
}

export const ROOT = "/api/v1";
const TIMEOUT_MS = 5_000;
const OPEN_TIMEOUT_MS = 30_000;
const KEY_HEADER = "X-Teleop-Client";

/** What a problem-details answer says. */
function problemText(answer: unknown, otherwise: string): string {
  const problem = answer as { detail?: unknown; title?: unknown } | null;
  const detail = problem?.detail ?? problem?.title ?? otherwise;
  return typeof detail === "string" ? detail : JSON.stringify(detail);
}

export async function request(method: string, path: string, body?: unknown, timeout_ms = TIMEOUT_MS): Promise<unknown> {
  const headers: Record<string, string> = { [KEY_HEADER]: clientKey };
  if (body !== undefined) headers["Content-Type"] = "application/json";
  const init: RequestInit = { method, headers, signal: AbortSignal.timeout(timeout_ms) };
  if (body !== undefined) init.body = JSON.stringify(body);
  let response: Response;
  let answer: unknown = null;
  try {
    response = await fetch(ROOT + path, init);
    const type = response.headers.get("Content-Type") ?? "";
    if (response.status !== 204 && type.includes("json")) answer = await response.json(); // the time may run out here, too
  } catch (cause) {
    throw new RequestError(cause instanceof Error ? cause.message : String(cause), 0);
  }
  if (!response.ok) throw new RequestError(problemText(answer, response.statusText), response.status);
  return answer;
}

/** Sends a file and tells how much of it is on its way, 0..1; fetch cannot tell that. */
function upload(file: File, progress: (share: number) => void): Promise<Recording> {
  return new Promise((resolve, reject) => {
    const form = new FormData();
    form.append("file", file);
    const sending = new XMLHttpRequest();
    sending.open("POST", `${ROOT}/recordings`);
    sending.setRequestHeader(KEY_HEADER, clientKey);
    sending.responseType = "json";
    sending.upload.addEventListener("progress", (event) => {
      if (event.lengthComputable) progress(event.loaded / event.total);
    });
    sending.addEventListener("load", () => {
      if (sending.status < 300) resolve(sending.response as Recording);
      else reject(new RequestError(problemText(sending.response, sending.statusText), sending.status));
    });
    sending.addEventListener("error", () => reject(new RequestError("the connection broke", 0)));
    sending.send(form);
  });
}

export const api = {
  engage: () => request("POST", "/engage"),
  disengage: () => request("POST", "/disengage"),
  estop: () => request("POST", "/estop", undefined, 1_500),
  estopReset: () => request("POST", "/estop/reset"),
  play: () => request("POST", "/replay/play"),
  pause: () => request("POST", "/replay/pause"),
  step: () => request("POST", "/replay/step"),
  seek: (position_s: number) => request("POST", "/replay/seek", { position_s }),
  speed: (speed: number) => request("POST", "/replay/speed", { speed }),
  loop: (loop: boolean) => request("POST", "/replay/loop", { loop }),
  robot: (command: RobotRequest) => request("POST", "/robot/command", command),
  pick: async (fruit: string | null, preview: boolean) => (await request("POST", "/tasks/pick", { fruit, preview })) as TaskState,
  confirmTask: (id: string) => request("POST", `/tasks/${encodeURIComponent(id)}/confirm`),
  cancelTask: (id: string) => request("DELETE", `/tasks/${encodeURIComponent(id)}`),
  openSession: (session: SessionRequest) => request("POST", "/sessions", session, OPEN_TIMEOUT_MS),
  upload,
  recordings: async () => (await request("GET", "/recordings")) as Recording[],
  deleteRecording: (id: string) => request("DELETE", `/recordings/${encodeURIComponent(id)}`),
  story: async (id: string) => (await request("GET", `/recordings/${encodeURIComponent(id)}/story`, undefined, OPEN_TIMEOUT_MS)) as Story,
  exportRecording: (id: string, format: ExportFormat) => request("POST", `/recordings/${encodeURIComponent(id)}/export`, { format }),
  verify: (id: string) => request("POST", `/recordings/${encodeURIComponent(id)}/verify`),
  whatIf: (id: string, settings: Json) => request("POST", `/recordings/${encodeURIComponent(id)}/whatif`, { settings }),
  jobs: async () => (await request("GET", "/jobs")) as Job[],
  cancelJob: (id: string) => request("DELETE", `/jobs/${id}`),
  virtual: async () => (await request("GET", "/virtual")) as VirtualOperator,
  driveVirtual: (change: VirtualChange) => request("PATCH", "/virtual", change),
  config: async () => (await request("GET", "/config")) as Json,
  configSchema: async () => (await request("GET", "/config/schema")) as Schema,
  changeConfig: async (patch: Json) => (await request("PATCH", "/config", patch, 2 * TIMEOUT_MS)) as Json,
  access: async () => (await request("GET", "/access")) as Access,
  login: async (token: string) => (await request("POST", "/login", { token })) as Access,
  logout: () => request("POST", "/logout"),
  lease: (action: LeaseAction) => request("POST", `/lease/${action}`),
  decide: (decision: "grant" | "deny", to: string) => request("POST", `/lease/${decision}`, { to }),
};
