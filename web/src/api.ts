/** Actions over REST. Every refusal reaches the operator in words. */

export interface Recording {
  id: string;
  name: string;
  uri: string;
  size_bytes: number;
  duration_s: number | null;
}

export interface RobotRequest {
  lift_m?: number;
  disc_rad?: number;
}

/** A request that the server refused or did not answer. */
export class RequestError extends Error {}

const ROOT = "/api/v1";
const TIMEOUT_MS = 5_000;
const UPLOAD_TIMEOUT_MS = 300_000;

function encoded(body: unknown): RequestInit {
  if (body === undefined) return {};
  if (body instanceof FormData) return { body };
  return { headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) };
}

async function request(method: string, path: string, body?: unknown, timeout_ms = TIMEOUT_MS): Promise<unknown> {
  let response: Response;
  try {
    response = await fetch(ROOT + path, {
      method,
      signal: AbortSignal.timeout(timeout_ms),
      ...encoded(body),
    });
  } catch (cause) {
    throw new RequestError(cause instanceof Error ? cause.message : String(cause));
  }
  const type = response.headers.get("Content-Type") ?? "";
  const answer: unknown = type.includes("json") ? await response.json() : null;
  if (!response.ok) {
    const problem = answer as { detail?: unknown; title?: unknown } | null;
    const detail = problem?.detail ?? problem?.title ?? response.statusText;
    throw new RequestError(typeof detail === "string" ? detail : JSON.stringify(detail));
  }
  return answer;
}

export const api = {
  engage: () => request("POST", "/engage"),
  disengage: () => request("POST", "/disengage"),
  estop: () => request("POST", "/estop", undefined, 1_500),
  estopReset: () => request("POST", "/estop/reset"),
  play: () => request("POST", "/replay/play"),
  pause: () => request("POST", "/replay/pause"),
  seek: (position_s: number) => request("POST", "/replay/seek", { position_s }),
  speed: (speed: number) => request("POST", "/replay/speed", { speed }),
  loop: (loop: boolean) => request("POST", "/replay/loop", { loop }),
  robot: (command: RobotRequest) => request("POST", "/robot/command", command),
  openSession: (source: string, loop: boolean) => request("POST", "/sessions", { source, loop, record: false }, 30_000),
  upload: (file: File) => {
    const form = new FormData();
    form.append("file", file);
    return request("POST", "/recordings", form, UPLOAD_TIMEOUT_MS);
  },
  recordings: async () => (await request("GET", "/recordings")) as Recording[],
};
