/** A study's motion as the server tells it (server/api/motions.py), and where its joints are at a time. */

import type { SceneryItem } from "../wire";

export interface MotionFile {
  id: string;
  size_bytes: number;
  modified: number;
}

export interface Motion {
  id: string;
  robot: string;
  urdf: string;
  base_xyz_m: [number, number, number];
  base_rpy_rad: [number, number, number];
  joint_names: string[];
  t_s: number[];
  q: number[][];
  path: [number, number, number][];
  path_rgba: [number, number, number, number];
  volumes: SceneryItem[];
}

async function get(path: string): Promise<unknown> {
  const response = await fetch(`/api/v1/motions${path}`, { signal: AbortSignal.timeout(20_000) });
  const answer = (await response.json()) as { detail?: unknown };
  if (!response.ok) throw new Error(typeof answer.detail === "string" ? answer.detail : response.statusText);
  return answer;
}

export const fetchMotions = async (): Promise<MotionFile[]> => (await get("")) as MotionFile[];
export const fetchMotion = async (id: string): Promise<Motion> => (await get(`/${encodeURIComponent(id)}`)) as Motion;

/** Index of the last sample not after t_s. */
function sampleBefore(times_s: readonly number[], t_s: number): number {
  let low = 0;
  let high = times_s.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if ((times_s[middle] ?? 0) <= t_s) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Joint values at a time, between two samples in proportion, into `out`. */
export function jointsAt(motion: Motion, t_s: number, out: number[]): number[] {
  const i = sampleBefore(motion.t_s, t_s);
  const j = Math.min(i + 1, motion.t_s.length - 1);
  const [from = 0, to = 0] = [motion.t_s[i], motion.t_s[j]];
  const share = to > from ? Math.min(1, Math.max(0, (t_s - from) / (to - from))) : 0;
  motion.joint_names.forEach((_, k) => {
    const a = motion.q[i]?.[k] ?? 0;
    out[k] = a + share * ((motion.q[j]?.[k] ?? a) - a);
  });
  return out;
}

export function duration_s(motion: Motion): number {
  return motion.t_s.at(-1) ?? 0;
}
