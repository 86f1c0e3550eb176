// The messages between server and page; `run_view.rs` writes them.

export interface RunFacts {
  epoch: number;
  link: 'connecting' | 'live' | 'lost' | 'tape';
  reason: string;
  name: string;
  process: number;
  simulated: boolean;
  hosts: string[];
  scene: boolean;
  /** The topic with the images of cameras, if the program reads it. */
  camera_topic: string | null;
  /** Whether pages may change the run. */
  control?: boolean;
}

export interface ChartStep {
  t: number;
  number: number;
  event: string | null;
  fired: number[];
  held: number[];
  exits: number[];
  entries: number[];
}

export interface ChartNews {
  key: string;
  host: string;
  agent: string;
  chart: number;
  model: string;
  state: string;
  drawing: number;
  active: number[];
  steps: ChartStep[];
}

export interface Shape {
  x: number;
  y: number;
  w: number;
  h: number;
  head: number;
  region: boolean;
  lines: string[];
  notes: string[];
}

export interface PictureNode {
  kind: string;
  name: string;
  parent: number | null;
  activity: string | null;
  shape: Shape | null;
}

export type Point = [number, number];

export interface PictureArrow {
  id: number;
  source: number;
  target: number;
  points: Point[];
  lines: string[];
  at: Point;
}

export interface Picture {
  name: string;
  width: number;
  height: number;
  nodes: PictureNode[];
  arrows: PictureArrow[];
  transitions: { source: number; target: number; text: string }[];
  /** The names in triggers. */
  events: string[];
}

export type GroundMark =
  | { shape: 'rectangle'; x: number; y: number; width: number; height: number; group: number | null }
  | { shape: 'line'; ends: [number, number, number, number] }
  | { shape: 'circle'; x: number; y: number; radius: number };

export interface Ground {
  width: number;
  height: number;
  marks: GroundMark[];
}

export interface Body {
  host: string;
  label: string;
  group: number;
  x: number;
  y: number;
  heading: number;
  upright: boolean;
  active: boolean;
}

export interface SceneObject {
  kind: string;
  x: number;
  y: number;
  vx: number;
  vy: number;
  radius: number;
}

export interface Belief {
  host: string;
  kind: string;
  x: number;
  y: number;
  heading: number | null;
  confidence: number;
}

/** A straight part of a line on the ground, where a host sees it: x, y, x, y. */
export interface SeenLine {
  host: string;
  ends: [number, number, number, number];
}

/** A message that is published at the press of a button. */
export interface SceneAction {
  label: string;
  /** The host that it concerns; none if it concerns all. */
  about: string | null;
  host: string;
  topic: string;
  message: Json;
}

export interface SceneNews {
  ground?: Ground;
  actions?: SceneAction[];
  bodies: Body[];
  objects: SceneObject[];
  beliefs: Belief[];
  seen_lines: SeenLine[];
  banner: { groups: [string, string][]; text: string } | null;
}

export interface Times {
  count: number;
  mean: number;
  deviation: number;
  p50: number;
  p90: number;
  p99: number;
  longest: number;
}

export interface AgentRow {
  host: string;
  name: string;
  state: string;
  reason: string;
  frequency: number;
  cycles: number;
  overruns: number;
  missed: number;
  steps: number;
  time: Times | null;
  charts: { model: string; state: string }[];
  activities: {
    name: string;
    /** Empty in a list. */
    state: string;
    parameters?: Record<string, string>;
    calls: number;
    failures: number;
    time: Times | null;
  }[];
}

export interface TopicRow {
  host: string;
  path: string;
  kind: string;
  type: string;
  count: number;
  rate: number | null;
  publisher: string | null;
  t: number | null;
}

export interface LogLine {
  number: number;
  t: number;
  host: string;
  level: string;
  name: string;
  text: string;
}

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };

export interface Sample {
  host: string;
  topic: string;
  from?: string;
  publisher?: string;
  sequence?: number;
  t?: number;
  size?: number;
  count?: number;
  message?: Json;
  reason?: string;
}

export interface ReadValue {
  name: string;
  value: Json;
  topic: string | null;
  publisher: string | null;
  sequence: number | null;
  published: number | null;
  host: string | null;
  due: number | null;
  is_timer: boolean;
}

/** A message; those that its publisher had read follow one level deeper. */
export interface ChainLink {
  depth: number;
  host: string;
  publisher: string;
  activity: string | null;
  topic: string;
  sequence: number;
  published: number;
  /** Why the chain ends here. */
  end: string | null;
}

export interface TransitionExplanation {
  number: number;
  source: string;
  target: string;
  text: string;
  verdict: 'fired' | 'instead' | 'waits' | 'not_reached';
  reason: string;
  judged: number | null;
  fired: number | null;
  next: number | null;
  triggers: { text: string; arrived: number | null }[];
  guard: boolean | null;
  atoms: { text: string; value: boolean | null; reads: ReadValue[] }[];
  instead: string[];
  held_by: string | null;
  chains: { links: ChainLink[] }[];
}

export interface Explanation {
  state: string;
  is_active: boolean;
  entered: number | null;
  left: number | null;
  segments: { source: string; target: string; text: string; reads: ReadValue[] }[];
}

/** The camera images of a robot. */
export interface CameraNews {
  host: string;
  t: number;
  images: { name: string; url: string }[];
}

export interface TapeFacts {
  begin: number;
  end: number;
  /** The speed of playing, 0 while it is held. */
  factor: number;
  events: { t: number; kind: string; text: string }[];
  /** For a live run: whether its present moment is shown. */
  live?: boolean;
}

/** The values of a chart at the present moment of a run; times in seconds. */
export interface ChartValues {
  key: string;
  /** Its last step. */
  t: number;
  /** Whether guards hold; null without a value. */
  guards: { transition: number; scope: number; holds: boolean | null }[];
  timers: { scope: number; name: string; due: number | null }[];
  /** The regions with a blackboard. */
  scopes: {
    scope: number;
    name: string;
    is_lent: boolean;
    messages: { topic: string; host: string; publisher: string; sequence: number; t: number | null; message: Json }[];
  }[];
}

export interface Frame {
  type: 'frame';
  now: number;
  run?: RunFacts;
  alarms?: string[];
  agents?: AgentRow[];
  topics?: TopicRow[];
  log?: LogLine[];
  charts?: ChartNews[];
  scene?: SceneNews;
  sample?: Sample;
  camera?: CameraNews;
  values?: ChartValues;
  /** The moment is earlier: later data are discarded. */
  elsewhere?: boolean;
  tape?: TapeFacts;
  /** The same moment of the tape beside. */
  beside?: Frame;
  pace?: { is_set_here: boolean; factor: number | null };
}

/** A diagnostic about a change. */
export interface Finding {
  code: string;
  error: boolean;
  text: string;
  hint: string;
  file: string;
  line: number;
  column: number;
}

/** A field of the messages of a topic. */
export interface FormField {
  name: string;
  kind: 'number' | 'integer' | 'boolean' | 'text' | 'enum' | 'json';
  type: string;
  values: string[] | null;
  default: Json;
}

/** The reply to a request that changes the run. */
export interface Reply {
  done: boolean;
  reason?: string | null;
  /** The cycle of the agent after which it was changed. */
  cycle?: number;
  findings?: Finding[];
  message_type?: string;
  fields?: FormField[];
}

/** A finding in the text of a model; positions are those of the text. */
export interface ModelFinding extends Finding {
  from: number;
  to: number;
  trace: string | null;
}

export interface StatePart {
  from: number;
  to: number;
  settings: Record<string, string>;
}

export interface TransitionPart {
  /** Null if the formulas of a role alone make it. */
  from: number | null;
  to: number | null;
  expression: string;
  modifiers: string;
  /** Whether its entry applies to other transitions too. */
  shared: boolean;
}

/** An entry of a role. */
export interface EntryPart {
  section: string;
  from: number;
  to: number;
  text: string;
}

export type FieldPart =
  | { key: string; kind: 'text' | 'formulas' }
  | { key: string; kind: 'choice'; choices: string[] }
  | { key: string; kind: 'links'; class: string; many: boolean };

export interface ClassPart {
  word: string;
  title: string;
  fields: FieldPart[];
}

export interface ItemPart {
  item: number;
  word: string;
  name: string;
  reference: string;
  from: number;
  to: number;
  fields: Record<string, string[]>;
}

export interface TableRow {
  activity: string;
  functionality: string;
  technology: string;
}

/** The editable elements of a model. */
export type ModelParts =
  | { form: 'role'; states: StatePart[]; transitions: TransitionPart[]; entries: EntryPart[]; table: TableRow[] }
  | { form: 'chart'; states: StatePart[]; transitions: TransitionPart[] }
  | { form: 'items'; classes: ClassPart[]; items: ItemPart[] }
  | { form: 'text' };

export interface Completion {
  text: string;
  kind: string;
  detail: string;
}

/** The reply to a request about models; each kind of request has its own fields. */
export interface ModelReply {
  done: boolean;
  reason?: string | null;
  /** Null of a file that was deleted. */
  text?: string | null;
  revision?: string;
  picture?: Picture | null;
  parts?: ModelParts;
  findings?: ModelFinding[];
  stopped?: boolean;
  from?: number;
  to?: number;
  entries?: Completion[];
  edits?: { from: number; to: number; insert: string }[];
}

/** An edit of a model; the program makes replacements of its text from it. */
export type ModelEdit =
  | { edit: 'set_transition'; transition: number; expression: string | null; modifiers: string | null }
  | { edit: 'add_transition'; source: number; target: number; expression: string }
  | { edit: 'remove_transition'; transition: number }
  | { edit: 'rename_state'; state: number; name: string }
  | { edit: 'set_state'; state: number; key: string; value: string | null }
  | { edit: 'add_state'; parent: number; kind: string; name: string }
  | { edit: 'remove_state'; state: number }
  | { edit: 'set_field'; item: number; key: string; value: string | null }
  | { edit: 'add_item'; word: string; name: string }
  | { edit: 'remove_item'; item: number }
  | { edit: 'set_entry'; entry: number; text: string | null }
  | { edit: 'add_entry'; section: string; text: string };

export type ServerMessage =
  | Frame
  | ({ type: 'reply'; id: number | null } & Omit<Reply, 'fields'> & ModelReply)
  | { type: 'models'; files: string[]; writable: boolean }
  | { type: 'picture'; key: string; beside?: boolean; picture: Picture | null }
  | { type: 'why'; key: string; node: number; why: Explanation }
  | { type: 'why transition'; key: string; transition: number; why: TransitionExplanation }
  | { type: 'refused'; host: string; topic: string; reason: string };
