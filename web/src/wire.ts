/** The wire between server and console: twin of server/wire.py. Units and frames are in the names. */

export interface CameraInfo {
  width: number;
  height: number;
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  mirrored: boolean;
}

export interface ZoneInfo {
  depth_cuts_m: [number, number, number, number];
  center_half_width_m: number;
  side_limit_m: number;
  hysteresis_m: number;
}

export interface SceneryItem {
  name: string;
  kind: "box" | "cylinder" | "sphere";
  size_m: number[];
  xyz_m: [number, number, number];
  rpy_rad: [number, number, number];
  rgba: [number, number, number, number];
}

export interface ArmJoints {
  c1: string;
  c2: string;
  elbow: string;
}

export interface Hello {
  type: "hello";
  version: number;
  software: string;
  joint_names: string[];
  bones: [number, number][];
  camera: CameraInfo;
  zones: ZoneInfo;
  shoulder_step_deg: number;
  T1_threshold_deg: number;
  T2_threshold_deg: number;
  urdf_url: string;
  arm_joints: { [key: string]: ArmJoints };
  lift_range_m: [number, number];
  disc_range_rad: [number, number];
  scenery: SceneryItem[];
}

export interface SourceState {
  uri: string;
  kind: string;
  live: boolean;
  paused: boolean;
  ended: boolean;
  position_s: number;
  duration_s: number | null;
  speed: number;
  loop: boolean;
  fps: number;
  recording: boolean;
  fault: string | null;
}

export interface SkeletonState {
  joints: { [key: string]: [number, number, number] | null };
  pixels: { [key: string]: [number, number] | null };
  confidence: { [key: string]: number };
}

export interface FloorState {
  camera_height_m: number;
  tilt_deg: number;
}

export interface AnglesState {
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
  right: "open" | "fist" | "unknown";
  left: "open" | "fist" | "unknown";
  right_confidence: number;
  left_confidence: number;
}

export interface ArmTargetState {
  c1_deg: number;
  c2_deg: number;
  elbow_deg: number;
}

export interface CommandState {
  drive_m_s: number;
  turn_rad_s: number;
  right_arm: ArmTargetState | null;
  left_arm: ArmTargetState | null;
  rear_arm: ArmTargetState | null;
  lift_m: number | null;
  disc_rad: number | null;
  gripper_open: boolean | null;
  cutter_closed: boolean | null;
  spray_on: boolean;
  liquid: "water" | "nutrient" | "pesticide" | null;
  head_camera_sweep: boolean;
  reasons: string[];
}

export interface BasePose {
  x: number;
  y: number;
  yaw: number;
}

export interface RobotWire {
  base: BasePose;
  joints: { [key: string]: number };
  targets: { [key: string]: number };
  gripper_open: boolean;
  cutter_closed: boolean;
  spray_on: boolean;
  liquid: "water" | "nutrient" | "pesticide";
  estop: boolean;
  drive_m_s: number;
  turn_rad_s: number;
  sim_time_s: number;
  reasons: string[];
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
  spine_xz: [number, number] | null;
  floor: FloorState | null;
  zone: "none" | "out" | "forward" | "work" | "back" | "left" | "right";
  mode:
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
  engaged: boolean;
  engage_progress: number;
  angles: AnglesState;
  hands: HandsState;
  command: CommandState;
  robot: RobotWire;
  reasons: string[];
  latency_ms: { [key: string]: StageLatency };
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

export interface Painted {
  type: "painted";
  seq: number;
}

export interface View {
  type: "view";
  image: "depth" | "color" | "none";
  head: boolean;
}

export type ServerMessage = Hello | State | EventMessage | ErrorMessage;
export type ClientMessage = Painted | View;
