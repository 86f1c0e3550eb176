import { addDecision, type Decision, mainRegion } from './decisions';
import { lineage } from './picture';
import type {
  AgentRow,
  CameraNews,
  ChartNews,
  ChartStep,
  ChartValues,
  Explanation,
  Frame,
  Ground,
  LogLine,
  Json,
  ModelReply,
  Picture,
  Reply,
  RunFacts,
  Sample,
  SceneAction,
  SceneNews,
  ServerMessage,
  TapeFacts,
  TopicRow,
  TransitionExplanation,
} from './protocol';

const LINES = 1000;
const STEPS = 200;
const HISTORY = 60;
const FIRST_RETRY = 500;
const LAST_RETRY = 5000;
/** Close reason of a server that ends. */
const GOING_AWAY = 1001;
/** Close reason of a server with too many pages. */
const TRY_AGAIN_LATER = 1013;
/** The longest request that may change a run or edit models, in bytes: a longer one ends the connection. */
const REQUEST_LIMIT = 1 << 20;

/** A chart as the page knows it. */
export interface ChartState extends Omit<ChartNews, 'steps'> {
  steps: ChartStep[];
  /** The step that entered each active node, if it was seen. */
  enteredBy: Map<number, ChartStep>;
  /** The decisions in its main region, the latest last. */
  decisions: Decision[];
}

/** The shapes of a chart. */
export interface KnownPicture {
  drawing: number;
  picture: Picture;
  region: number;
}

/** The figures of an agent over the last minute, one a second; lengths of cycles in seconds. */
export interface AgentHistory {
  times: number[];
  rates: number[];
  means: number[];
  deviations: number[];
  p50: number[];
  p99: number[];
  overruns: number[];
}

/** The connection to the server, and the received state of the run. */
export class StudioClient {
  connection = $state<'connecting' | 'open' | 'closed'>('connecting');
  /** Whether the server announced its end. */
  hasEnded = $state(false);
  /** The server's reason for not serving this page. */
  refusal = $state('');
  run = $state.raw<RunFacts | null>(null);
  now = $state(0);
  alarms = $state.raw<string[]>([]);
  agents = $state.raw<AgentRow[]>([]);
  topics = $state.raw<TopicRow[]>([]);
  histories = $state.raw<Map<string, AgentHistory>>(new Map());
  log = $state.raw<LogLine[]>([]);
  charts = $state.raw<Map<string, ChartState>>(new Map());
  pictures = $state.raw<Map<string, KnownPicture>>(new Map());
  ground = $state.raw<Ground | null>(null);
  scene = $state.raw<SceneNews | null>(null);
  actions = $state.raw<SceneAction[]>([]);
  sample = $state.raw<Sample | null>(null);
  /** The camera images of the chosen robot. */
  camera = $state.raw<CameraNews | null>(null);
  /** Whether a robot has delivered images. */
  hasImages = $state(false);
  /** The values of the chosen chart, at the present moment of a run. */
  values = $state.raw<ChartValues | null>(null);
  /** The speed of simulated time, null if it is unlimited; undefined if it is not set here. */
  pace = $state.raw<number | null | undefined>(undefined);
  tape = $state.raw<TapeFacts | null>(null);
  /** The latest explanation of a tape. */
  why = $state.raw<{ key: string; node: number; why: Explanation } | null>(null);

  /** The same of a transition. */
  whyTransition = $state.raw<{ key: string; transition: number; why: TransitionExplanation } | null>(null);

  /** The second tape, which receives its messages through this client. */
  beside = $state.raw<StudioClient | null>(null);

  /** The models that this page may edit, if there are any. */
  models = $state.raw<{ files: string[]; writable: boolean } | null>(null);

  #parent: StudioClient | null = null;
  #socket: WebSocket | null = null;
  #retry = FIRST_RETRY;
  #watched: { host: string; topic: string } | null = null;
  #cameraHost: string | null = null;
  #valuesKey: string | null = null;
  /** The drawings that were asked for, by chart. */
  #asked = new Map<string, number>();
  #tableTime = 0;
  #requests = new Map<number, (reply: Reply & ModelReply) => void>();
  #lastRequest = 0;

  connect(): void {
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const socket = new WebSocket(`${scheme}://${location.host}/socket${location.search}`);
    this.#socket = socket;
    socket.onopen = () => {
      // A refused request may be refused again.
      if (this.refusal === '') {
        this.#isServed();
      }
      this.#asked.clear();
      if (this.#watched) {
        this.#send({ type: 'watch', ...this.#watched });
      }
      if (this.#cameraHost) {
        this.#send({ type: 'camera', host: this.#cameraHost });
      }
      if (this.#valuesKey) {
        this.#send({ type: 'values', key: this.#valuesKey });
      }
    };
    socket.onmessage = (event) => {
      if (this.refusal !== '') {
        this.#isServed();
      }
      this.#take(JSON.parse(String(event.data)) as ServerMessage);
    };
    socket.onclose = (event) => {
      if (this.#socket !== socket) {
        return;
      }
      this.connection = 'closed';
      this.#requests.forEach((resolve) => resolve({ done: false, reason: 'the connection was lost; whether it was done is not known' }));
      this.#requests.clear();
      // A connection that cannot be opened afterwards does not change the announced reason.
      this.hasEnded ||= event.code === GOING_AWAY;
      this.refusal = event.code === TRY_AGAIN_LATER ? event.reason : '';
      setTimeout(() => this.connect(), this.#retry);
      this.#retry = Math.min(this.#retry * 2, LAST_RETRY);
    };
  }

  #isServed(): void {
    this.connection = 'open';
    this.hasEnded = false;
    this.refusal = '';
    this.#retry = FIRST_RETRY;
  }

  watch(host: string, topic: string): void {
    this.#watched = { host, topic };
    this.sample = null;
    this.#send({ type: 'watch', host, topic });
  }

  unwatch(): void {
    this.#watched = null;
    this.sample = null;
    this.#send({ type: 'unwatch' });
  }

  /** Subscribes to the values of a chart, or to none. */
  watchValues(key: string | null): void {
    this.#valuesKey = key;
    this.values = null;
    this.#send({ type: 'values', key });
  }

  /** Subscribes to the images of a robot, or to none. */
  watchCamera(host: string | null): void {
    this.#cameraHost = host;
    this.camera = null;
    this.#send({ type: 'camera', host });
  }

  setPace(factor: number): void {
    this.#send({ type: 'pace', factor: Number.isFinite(factor) ? factor : null });
  }

  seek(seconds: number): void {
    this.#send({ type: 'seek', seconds });
  }

  /** Goes to the present moment of a run. */
  goLive(): void {
    this.#send({ type: 'live' });
  }

  /** Whether a past moment of a live run is shown. */
  get isPast(): boolean {
    return this.tape?.live === false;
  }

  /** Whether this page may change the run: not while it looks back. */
  get mayControl(): boolean {
    return this.run?.control === true && this.run.link === 'live' && this.connection === 'open' && !this.isPast;
  }

  /** Changes an agent of a host, as `monas agent` and `monas chart raise` do. */
  change(host: string, agent: string, action: string, more: Record<string, Json> = {}): Promise<Reply> {
    return this.#request({ type: 'change', host, agent, action, ...more });
  }

  /** Publishes a message on a topic of a host. */
  publish(host: string, topic: string, message: Json): Promise<Reply> {
    return this.#request({ type: 'publish', host, topic, message });
  }

  /** The fields of the messages of a topic. */
  form(topic: string): Promise<Reply> {
    return this.#request({ type: 'form', topic });
  }

  /** Asks about a model: `open`, `outline`, `check`, `complete`, `edit` or `save`. */
  model(what: string, more: object): Promise<ModelReply> {
    return this.#request({ type: `model ${what}`, ...more });
  }

  #request(message: object): Promise<Reply & ModelReply> {
    this.#lastRequest += 1;
    const id = this.#lastRequest;
    if (this.#socket?.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ done: false, reason: 'the studio does not answer' });
    }
    const size = new TextEncoder().encode(JSON.stringify({ id, ...message })).length;
    if (size > REQUEST_LIMIT) {
      const kilobytes = (bytes: number) => `${Math.ceil(bytes / 1024)} KB`;
      return Promise.resolve({ done: false, reason: `too long: ${kilobytes(size)}, at most ${kilobytes(REQUEST_LIMIT)} can be sent` });
    }
    return new Promise((resolve) => {
      this.#requests.set(id, resolve);
      this.#send({ id, ...message });
    });
  }

  /** Whether a recording is shown, which has all messages. */
  get isTape(): boolean {
    return this.tape !== null && this.tape.live === undefined;
  }

  /** Asks why a state is active at the moment of a tape. */
  askWhy(key: string, node: number): void {
    this.#send({ type: 'why', key, node });
  }

  /** Asks why a transition fired, or did not, at the moment of a tape. */
  askWhyTransition(key: string, transition: number): void {
    this.#send({ type: 'why transition', key, transition });
  }

  /** Goes to the next firing of a transition, or to the one before. */
  jump(key: string, transition: number, back: boolean): void {
    this.#send({ type: 'jump', key, transition, back });
  }

  step(key: string, back: boolean): void {
    this.#send({ type: 'step', key, back });
  }

  #send(message: object): void {
    if (this.#parent) {
      this.#parent.#send({ ...message, beside: true });
      return;
    }
    if (this.#socket?.readyState === WebSocket.OPEN) {
      this.#socket.send(JSON.stringify(message));
    }
  }

  #fetchPictures(): void {
    for (const { key, drawing } of this.charts.values()) {
      if (drawing > 0 && this.#asked.get(key) !== drawing) {
        this.#asked.set(key, drawing);
        this.#send({ type: 'picture', key });
      }
    }
  }

  #take(message: ServerMessage): void {
    switch (message.type) {
      case 'frame':
        this.#takeFrame(message);
        break;
      case 'picture': {
        if (message.beside && this.beside) {
          this.beside.#take({ ...message, beside: false });
          break;
        }
        const chart = this.charts.get(message.key);
        if (chart && message.picture) {
          const pictures = new Map(this.pictures);
          const { picture } = message;
          pictures.set(message.key, { drawing: chart.drawing, picture, region: mainRegion(picture) });
          this.pictures = pictures;
          const charts = new Map(this.charts);
          charts.set(message.key, this.#follow({ ...chart, enteredBy: new Map(), decisions: [] }, chart.steps));
          this.charts = charts;
        }
        break;
      }
      case 'why':
        this.why = message;
        break;
      case 'why transition':
        this.whyTransition = message;
        break;
      case 'reply':
        if (message.id !== null) {
          this.#requests.get(message.id)?.(message);
          this.#requests.delete(message.id);
        }
        break;
      case 'models':
        this.models = { files: message.files, writable: message.writable };
        break;
      case 'refused':
        this.sample = message;
        break;
    }
  }

  #takeFrame(frame: Frame): void {
    if (frame.run) {
      if (frame.run.epoch !== this.run?.epoch) {
        this.#forget();
      }
      this.run = frame.run;
    }
    this.now = frame.now;
    if (frame.elsewhere) {
      this.#goElsewhere();
    }
    if (frame.tape) {
      this.tape = frame.tape;
    }
    if (frame.alarms) {
      this.alarms = frame.alarms;
    }
    if (frame.pace) {
      this.pace = frame.pace.is_set_here ? frame.pace.factor : undefined;
    }
    if (frame.agents) {
      this.#takeAgents(frame.agents, frame.now);
    }
    if (frame.topics) {
      this.topics = frame.topics;
    }
    if (frame.log) {
      this.log = [...this.log, ...frame.log].slice(-LINES);
    }
    if (frame.charts) {
      this.#takeCharts(frame.charts);
    }
    if (frame.scene) {
      this.ground = frame.scene.ground ?? this.ground;
      this.actions = frame.scene.actions ?? this.actions;
      this.scene = frame.scene;
    }
    if (frame.sample) {
      this.sample = frame.sample;
    }
    if (frame.values?.key === this.#valuesKey) {
      this.values = frame.values ?? null;
    }
    if (frame.camera) {
      this.camera = frame.camera;
      this.hasImages ||= frame.camera.images.length > 0;
    }
    if (frame.beside) {
      if (!this.beside) {
        this.beside = new StudioClient();
        this.beside.#parent = this;
      }
      this.beside.#takeFrame(frame.beside);
    }
  }

  /** Discards the data of another moment; shapes stay. */
  #goElsewhere(): void {
    this.camera = null;
    const charts = new Map<string, ChartState>();
    for (const [key, chart] of this.charts) {
      charts.set(key, { ...chart, steps: [], enteredBy: new Map(), decisions: [] });
    }
    this.charts = charts;
    this.log = [];
    this.histories = new Map();
    this.#tableTime = 0;
  }

  #forget(): void {
    this.charts = new Map();
    this.pictures = new Map();
    this.histories = new Map();
    this.agents = [];
    this.topics = [];
    this.log = [];
    this.beside = null;
    this.scene = null;
    this.actions = [];
    this.tape = null;
    this.why = null;
    this.whyTransition = null;
    this.#tableTime = 0;
    this.#asked.clear();
    if (this.#watched && this.run) {
      this.#send({ type: 'watch', ...this.#watched });
    }
  }

  #takeAgents(rows: AgentRow[], now: number): void {
    const span = now - this.#tableTime;
    if (this.#tableTime > 0 && span > 0) {
      const before = new Map(this.agents.map((row) => [agentKey(row), row]));
      const histories = new Map<string, AgentHistory>();
      for (const row of rows) {
        const key = agentKey(row);
        const last = before.get(key);
        const known = this.histories.get(key) ?? { times: [], rates: [], means: [], deviations: [], p50: [], p99: [], overruns: [] };
        if (!last) {
          histories.set(key, known);
          continue;
        }
        const add = (list: number[], value: number) => [...list, value].slice(-HISTORY);
        const length = (list: number[], value: number | undefined) => (value === undefined ? list : add(list, value));
        histories.set(key, {
          times: add(known.times, now),
          rates: add(known.rates, Math.max(0, row.cycles - last.cycles) / span),
          means: length(known.means, row.time?.mean),
          deviations: length(known.deviations, row.time?.deviation),
          p50: length(known.p50, row.time?.p50),
          p99: length(known.p99, row.time?.p99),
          overruns: add(known.overruns, Math.max(0, row.overruns - last.overruns) / span),
        });
      }
      this.histories = histories;
    }
    this.#tableTime = now;
    this.agents = rows;
  }

  #takeCharts(news: ChartNews[]): void {
    const charts = new Map(this.charts);
    for (const chart of news) {
      const known = charts.get(chart.key);
      const steps = [...(known?.steps ?? []), ...chart.steps].slice(-STEPS);
      const enteredBy = known?.enteredBy ?? new Map<number, ChartStep>();
      charts.set(chart.key, this.#follow({ ...chart, steps, enteredBy, decisions: known?.decisions ?? [] }, chart.steps));
    }
    this.charts = charts;
    this.#fetchPictures();
  }

  /** Records the entering steps of nodes, and decisions. */
  #follow(chart: ChartState, steps: ChartStep[]): ChartState {
    const known = this.pictures.get(chart.key);
    const enteredBy = new Map(chart.enteredBy);
    let { decisions } = chart;
    for (const step of steps) {
      step.exits.forEach((node) => enteredBy.delete(node));
      step.entries.forEach((node) => enteredBy.set(node, step));
      if (known) {
        decisions = addDecision(decisions, known.picture, known.region, enteredBy, step);
      }
    }
    return { ...chart, enteredBy, decisions };
  }
}

export function agentKey(row: { host: string; name: string }): string {
  return `${row.host}/${row.name}`;
}

/** The active states without active children. */
export function activeLeaves(chart: ChartState, picture: Picture): number[] {
  const parents = new Set(chart.active.flatMap((node) => lineage(picture, node).slice(1)));
  return chart.active.filter((node) => !parents.has(node));
}
