/** The wire between server and console: twin of server/wire.py. Units and frames are in the names. */

export type Vec2 = [number, number];
export type Vec3 = [number, number, number];
export type Vec4 = [number, number, number, number];

export interface CameraInfo {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  mirrored: boolean;
}

export interface Zones {
  depth_cuts_m: number[];
  center_half_width_m: number;
  side_limit_m: number;
  hysteresis_m: number;
}

export interface Primitive {
  name: string;
  kind: "box" | "cylinder" | "sphere";
  /** box: x, y, z edges; cylinder: radius, length along z; sphere: radius. */
  size_m: number[];
  xyz_m: Vec3;
  rpy_rad: Vec3;
  rgba: Vec4;
}

export interface Hello {
  type: "hello";
  version: string;
  joint_names: string[];
  bones: Vec2[];
  camera: CameraInfo;
  zones: Zones;
  shoulder_step_deg: number;
  urdf_url: string;
  scenery: Primitive[];
}

export interface SourceState {
  uri: string;
  kind: string;
  live: boolean;
  paused: boolean;
  position_s: number | null;
  duration_s: number | null;
  speed: number;
  loop: boolean;
  fps: number;
}

export interface SkeletonState {
  joints: Record<string, Vec3 | null>;
  pixels: Record<string, Vec2 | null>;
  confidence: Record<string, number>;
}

export interface FloorState {
  camera_height_m: number;
  tilt_deg: number;
}

export type Zone = "none" | "out" | "forward" | "work" | "back" | "left" | "right";

export type Mode =
  | "no_person"
  | "seen"
  | "engaged"
  | "picking"
  | "spraying"
  | "forward"
  | "back"
  | "left"
  | "right"
  | "held"
  | "stopped";

export type Hand = "open" | "fist" | "unknown";
export type Liquid = "water" | "nutrient" | "pesticide";

export interface Angles {
  theta1_right: number | null;
  theta2_right: number | null;
  theta3_right: number | null;
  theta1_left: number | null;
  theta2_left: number | null;
  theta3_left: number | null;
  T1: number | null;
  T2: number | null;
}

export interface HandsState {
  right: Hand;
  left: Hand;
  right_confidence: number;
  left_confidence: number;
}

export interface ArmTarget {
  c1_deg: number;
  c2_deg: number;
  elbow_deg: number;
}

export interface Command {
  drive_m_s: number;
  turn_rad_s: number;
  right_arm: ArmTarget | null;
  left_arm: ArmTarget | null;
  rear_arm: ArmTarget | null;
  lift_m: number | null;
  disc_rad: number | null;
  gripper_open: boolean | null;
  cutter_closed: boolean | null;
  spray_on: boolean;
  liquid: Liquid | null;
  head_camera_sweep: boolean;
  reasons: string[];
}

export interface RobotState {
  base: { x: number; y: number; yaw: number };
  joints: Record<string, number>;
  targets: Record<string, number>;
  gripper_open: boolean;
  cutter_closed: boolean;
  spray_on: boolean;
  liquid: Liquid;
  estop: boolean;
  drive_m_s: number;
  turn_rad_s: number;
  sim_time_s: number;
}

export interface StageLatency {
  p50: number;
  p95: number;
  last: number;
}

export interface State {
  type: "state";
  seq: number;
  t: number;
  source: SourceState | null;
  skeleton: SkeletonState | null;
  spine_xz: Vec2 | null;
  floor: FloorState | null;
  zone: Zone;
  mode: Mode;
  engaged: boolean;
  engage_progress: number;
  angles: Angles;
  hands: HandsState;
  command: Command;
  robot: RobotState;
  reasons: string[];
  latency_ms: Record<string, StageLatency>;
  clients: number;
}

export interface EventMessage {
  type: "event";
  t: number;
  kind: string;
  reason: string;
  detail: string;
}

export interface ErrorMessage {
  type: "error";
  detail: string;
}

export type ServerMessage = Hello | State | EventMessage | ErrorMessage;

export type ImageChoice = "depth" | "color" | "none";

export type ClientMessage =
  | { type: "painted"; seq: number }
  | { type: "view"; image: ImageChoice; head: boolean };

/** Kinds of binary messages. */
export const DEPTH_IMAGE = 1;
export const COLOR_IMAGE = 2;
export const HEAD_IMAGE = 3;
