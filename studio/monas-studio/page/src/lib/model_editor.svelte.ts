import { setDiagnostics } from '@codemirror/lint';
import { redo, redoDepth, undo, undoDepth } from '@codemirror/commands';
import { EditorState } from '@codemirror/state';
import { EditorView } from '@codemirror/view';
import type { StudioClient } from './client.svelte';
import type { Outcome } from './outcome';
import type { ModelEdit, ModelFinding, ModelParts, ModelReply, Picture } from './protocol';
import { textExtensions } from './text_editor';

const OUTLINE_DELAY = 120;
const CHECK_DELAY = 800;

/** What is understood of a text. */
export interface Outline {
  text: string;
  picture: Picture | null;
  parts: ModelParts;
  findings: ModelFinding[];
}

/** How much there is of what an edit names by number: numbers hold while that is the same. */
function shapeOf(outline: Outline | null, edit: ModelEdit): string {
  const parts = outline?.parts;
  switch (edit.edit) {
    case 'add_item':
    case 'add_entry':
      return '';
    case 'set_field':
    case 'remove_item':
      return String(parts?.form === 'items' ? parts.items.length : 0);
    case 'set_entry':
      return String(parts?.form === 'role' ? parts.entries.length : 0);
    default:
      return `${outline?.picture?.nodes.length} ${outline?.picture?.transitions.length}`;
  }
}

/** A file that was opened. */
interface OpenFile {
  state: EditorState;
  saved: string;
  revision: string;
  lineBreak: string;
}

/** The models that are edited: one at a time is shown. Every edit is one of the text. */
export class ModelEditor {
  file = $state(-1);
  text = $state('');
  saved = $state('');
  isLoading = $state(false);
  /** Why the file cannot be shown. */
  fault = $state('');
  outline = $state.raw<Outline | null>(null);
  checked = $state.raw<{ text: string; findings: ModelFinding[]; stopped: boolean } | null>(null);
  isChecking = $state(false);
  outcome = $state.raw<Outcome | null>(null);
  /** The file as it is on disk now, if it has changed since it was read. */
  conflict = $state.raw<{ text: string; revision: string } | null>(null);
  canUndo = $state(false);
  canRedo = $state(false);
  selected = $state<number | null>(null);
  transition = $state<number | null>(null);

  #client: StudioClient;
  #files = new Map<number, OpenFile>();
  #view: EditorView | null = null;
  #edits: Promise<boolean> = Promise.resolve(true);
  #outlineTimer = 0;
  #checkTimer = 0;

  constructor(client: StudioClient) {
    this.#client = client;
  }

  get name(): string {
    return this.#client.models?.files[this.file] ?? '';
  }

  get isWritable(): boolean {
    return this.#client.models?.writable === true;
  }

  get isChanged(): boolean {
    return this.text !== this.saved;
  }

  /** The findings of the text, and those of the check if it is of the same text. */
  get findings(): ModelFinding[] {
    const own = this.outline?.findings ?? [];
    const more = this.checked && this.checked.text === this.text ? this.checked.findings : [];
    const key = (one: ModelFinding) => `${one.code} ${one.from} ${one.text}`;
    const known = new Set(own.map(key));
    return [...own, ...more.filter((one) => !known.has(key(one)))].sort((a, b) => a.from - b.from);
  }

  /** Shows the editor in an element. */
  mount(parent: HTMLElement): () => void {
    this.#view = new EditorView({ parent, state: this.#files.get(this.file)?.state ?? this.#newState('') });
    return () => {
      this.#keepState();
      this.#view?.destroy();
      this.#view = null;
    };
  }

  async open(file: number): Promise<void> {
    this.#keepState();
    this.file = file;
    this.outcome = null;
    this.conflict = null;
    this.selected = null;
    this.transition = null;
    this.fault = '';
    if (!this.#files.has(file)) {
      await this.reload();
      return;
    }
    this.#show(file);
  }

  /** Reads the file again; what was not saved is lost. */
  async reload(): Promise<void> {
    const file = this.file;
    this.isLoading = true;
    const reply = await this.#client.model('open', { file });
    this.isLoading = false;
    if (file !== this.file) {
      return;
    }
    if (!reply.done || reply.text === undefined || reply.revision === undefined) {
      this.fault = reply.reason ?? 'the file cannot be read';
      return;
    }
    this.#take(file, reply.text, reply.revision);
  }

  /** Goes on with what the file contains now. */
  takeTheirs(): void {
    if (this.conflict) {
      this.#take(this.file, this.conflict.text, this.conflict.revision);
    }
  }

  /** Keeps what is here: the next save replaces what the file contains now. */
  keepMine(): void {
    const known = this.#files.get(this.file);
    if (known && this.conflict) {
      known.revision = this.conflict.revision;
      this.conflict = null;
      void this.save();
    }
  }

  async save(): Promise<void> {
    const [file, known, text] = [this.file, this.#files.get(this.file), this.text];
    if (!known || !this.isWritable) {
      this.outcome = { done: false, lines: ['not saved: this page may not write files'] };
      return;
    }
    const written = text.replaceAll('\n', known.lineBreak);
    const reply = await this.#client.model('save', { file, text: written, revision: known.revision });
    if (reply.done && reply.revision) {
      [known.revision, known.saved] = [reply.revision, text];
      if (file === this.file) {
        this.saved = text;
        this.conflict = null;
        this.outcome = { done: true, lines: [`saved ${this.name}`] };
      }
    } else if (reply.text !== undefined && reply.revision !== undefined) {
      this.conflict = { text: reply.text, revision: reply.revision };
      this.outcome = null;
    } else {
      this.outcome = { done: false, lines: [`not saved: ${reply.reason ?? ''}`] };
    }
  }

  undo(): void {
    if (this.#view) {
      undo(this.#view);
    }
  }

  redo(): void {
    if (this.#view) {
      redo(this.#view);
    }
  }

  /**
   * Makes an edit, after those before: replacements in the text, which undo takes back together.
   * States and transitions are given by their numbers in the present outline.
   */
  edit(edit: ModelEdit): Promise<boolean> {
    const known = this.outline;
    const made = this.#edits.then(() => this.#make(edit, known));
    this.#edits = made;
    return made;
  }

  async #make(edit: ModelEdit, known: Outline | null): Promise<boolean> {
    const view = this.#view;
    if (this.outline?.text !== this.text) {
      await this.#understand();
    }
    const text = this.text;
    if (!this.outline || this.outline.text !== text || shapeOf(this.outline, edit) !== shapeOf(known, edit)) {
      this.outcome = { done: false, lines: ['the text has changed meanwhile: once more, please'] };
      return false;
    }
    const given = Object.fromEntries(Object.entries(edit).filter(([, value]) => value !== null));
    const reply = await this.#client.model('edit', { text, edit: given });
    if (!reply.done || !reply.edits) {
      this.outcome = { done: false, lines: [reply.reason ?? 'the edit is not possible'] };
      return false;
    }
    if (!view || this.text !== text) {
      this.outcome = { done: false, lines: ['the text has changed meanwhile: once more, please'] };
      return false;
    }
    this.outcome = null;
    if (reply.edits.length > 0) {
      view.dispatch({ changes: reply.edits, userEvent: 'input.drawing' });
      await this.#understand();
    }
    return true;
  }

  completeExpression(expression: string, at: number): Promise<ModelReply> {
    return this.#client.model('complete', { text: this.text, expression, at });
  }

  /** Puts the cursor at a position, and shows it. */
  jump(from: number, to = from): void {
    const view = this.#view;
    if (view) {
      const length = view.state.doc.length;
      const [anchor, head] = [Math.min(from, length), Math.min(to, length)];
      view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: 'center' }) });
      view.focus();
    }
  }

  /** Checks the text at once. */
  async check(): Promise<void> {
    clearTimeout(this.#checkTimer);
    const [file, text] = [this.file, this.text];
    this.isChecking = true;
    const reply = await this.#client.model('check', { file, text });
    if (file === this.file && text === this.text) {
      this.isChecking = false;
      if (reply.done) {
        this.checked = { text, findings: reply.findings ?? [], stopped: reply.stopped === true };
        this.#mark();
      } else {
        this.outcome = { done: false, lines: [`not checked: ${reply.reason ?? ''}`] };
      }
    }
  }

  #newState(doc: string): EditorState {
    const ask = (at: number) => this.#client.model('complete', { text: this.text, at });
    const change = () => this.#changed();
    return EditorState.create({ doc, extensions: textExtensions(ask, true, () => void this.save(), change) });
  }

  #take(file: number, read: string, revision: string): void {
    const breaks = read.match(/\r\n?|\n/g) ?? [];
    const kinds = new Set(breaks);
    if (kinds.size > 1 || kinds.has('\r')) {
      this.fault = 'the lines of this file end in different ways: the editor would change all of them';
      return;
    }
    const lineBreak = kinds.has('\r\n') ? '\r\n' : '\n';
    const text = read.replaceAll('\r\n', '\n');
    this.#files.set(file, { state: this.#newState(text), saved: text, revision, lineBreak });
    this.conflict = null;
    this.#show(file);
  }

  #keepState(): void {
    const known = this.#files.get(this.file);
    if (known && this.#view) {
      known.state = this.#view.state;
    }
  }

  #show(file: number): void {
    const known = this.#files.get(file);
    if (!known) {
      return;
    }
    this.#view?.setState(known.state);
    this.saved = known.saved;
    this.outline = null;
    this.checked = null;
    this.#changed();
    void this.#understand();
  }

  #changed(): void {
    const state = this.#view?.state;
    if (!state) {
      return;
    }
    this.text = state.doc.toString();
    [this.canUndo, this.canRedo] = [undoDepth(state) > 0, redoDepth(state) > 0];
    clearTimeout(this.#outlineTimer);
    clearTimeout(this.#checkTimer);
    this.isChecking = false;
    this.#outlineTimer = setTimeout(() => void this.#understand(), OUTLINE_DELAY);
    this.#checkTimer = setTimeout(() => void this.check(), CHECK_DELAY);
  }

  /** Asks what is understood of the text. */
  async #understand(): Promise<void> {
    clearTimeout(this.#outlineTimer);
    const [file, text] = [this.file, this.text];
    const { done, picture, parts, findings, reason } = await this.#client.model('outline', { file, text });
    if (file !== this.file || text !== this.text) {
      return;
    }
    if (done && parts) {
      this.outline = { text, picture: picture ?? null, parts, findings: findings ?? [] };
      const nodes = picture?.nodes.length ?? 0;
      const transitions = picture?.transitions.length ?? 0;
      this.selected = this.selected !== null && this.selected < nodes ? this.selected : null;
      this.transition = this.transition !== null && this.transition < transitions ? this.transition : null;
      this.#mark();
    } else {
      this.outcome = { done: false, lines: [reason ?? 'the text cannot be read'] };
    }
  }

  /** Marks the findings in the text. */
  #mark(): void {
    const view = this.#view;
    if (!view) {
      return;
    }
    const length = view.state.doc.length;
    const diagnostics = this.findings.map((one) => ({
      from: Math.min(one.from, length),
      to: Math.min(Math.max(one.to, one.from), length),
      severity: one.error ? ('error' as const) : ('warning' as const),
      message: `${one.code}: ${one.text}${one.hint ? `\nhelp: ${one.hint}` : ''}`,
    }));
    view.dispatch(setDiagnostics(view.state, diagnostics));
  }
}
