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

/** The outline and findings of a text. */
export interface Outline {
  text: string;
  picture: Picture | null;
  parts: ModelParts;
  findings: ModelFinding[];
}

/** The numbers of elements that edits refer to by number: valid while these are equal. */
function shapeOf(outline: { picture?: Picture | null; parts?: ModelParts } | null, edit: ModelEdit): string {
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
  /** Its text here. */
  text: string;
  saved: string;
  revision: string;
  lineBreak: string;
}

/** The models that are edited: one at a time is shown. Every edit is one of the text. */
export class ModelEditor {
  /** The name of the file that is shown: its number is another one when the studio has begun anew. */
  name = $state('');
  text = $state('');
  saved = $state('');
  isLoading = $state(false);
  /** Why the file cannot be shown. */
  fault = $state('');
  outline = $state.raw<Outline | null>(null);
  checked = $state.raw<{ text: string; findings: ModelFinding[]; stopped: boolean } | null>(null);
  isChecking = $state(false);
  outcome = $state.raw<Outcome | null>(null);
  /** The present file on disk if it has changed since it was read; without a text if deleted. */
  conflict = $state.raw<{ text: string | null; revision: string } | null>(null);
  canUndo = $state(false);
  canRedo = $state(false);
  /** The names of all files with changes that are not saved. */
  unsaved = $state.raw<string[]>([]);
  selected = $state<number | null>(null);
  transition = $state<number | null>(null);

  #client: StudioClient;
  #files = new Map<string, OpenFile>();
  #view: EditorView | null = null;
  /** The name of the file whose text the view has: not the one that is shown while that is read. */
  #inView = '';
  #complaint: Outcome | null = null;
  #saves: Promise<void> = Promise.resolve();
  #edits: Promise<boolean> = Promise.resolve(true);
  #outlineTimer = 0;
  #checkTimer = 0;

  constructor(client: StudioClient) {
    this.#client = client;
  }

  /** The number of the file that is shown, or -1. */
  get file(): number {
    return this.#number(this.name);
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
    const known = this.#files.get(this.name);
    this.#inView = known ? this.name : '';
    this.#view = new EditorView({ parent, state: known?.state ?? this.#newState('', false) });
    return () => {
      this.#keepState();
      this.#view?.destroy();
      this.#view = null;
    };
  }

  async open(file: number): Promise<void> {
    this.#keepState();
    this.name = this.#client.models?.files[file] ?? '';
    this.outcome = null;
    this.conflict = null;
    this.selected = null;
    this.transition = null;
    this.fault = '';
    if (this.#files.has(this.name)) {
      this.#show(this.name);
      return;
    }
    this.#showNothing();
    await this.reload();
  }

  /** Reads the file again; unsaved changes are lost. */
  async reload(): Promise<void> {
    const { file, name } = this;
    this.isLoading = true;
    const reply = await this.#client.model('open', { file });
    if (name !== this.name) {
      return;
    }
    this.isLoading = false;
    if (!reply.done || typeof reply.text !== 'string' || reply.revision === undefined) {
      this.fault = reply.reason ?? 'the file cannot be read';
      return;
    }
    this.#take(name, reply.text, reply.revision);
  }

  /** Continues after the connection was lost: requests missing replies again. */
  resume(): void {
    if (this.name === '' || this.file < 0) {
      return;
    }
    if (!this.#files.has(this.name)) {
      void this.open(this.file);
    } else if (this.#view && this.#inView === this.name && this.outline?.text !== this.text) {
      this.#changed(this.name);
    }
  }

  /** Continues with the present content of the file. */
  takeTheirs(): void {
    if (typeof this.conflict?.text === 'string') {
      this.#take(this.name, this.conflict.text, this.conflict.revision);
    }
  }

  /** Keeps the edited text: the next save replaces the present content of the file. */
  keepMine(): void {
    const known = this.#files.get(this.name);
    if (known && this.conflict) {
      known.revision = this.conflict.revision;
      this.conflict = null;
      void this.save();
    }
  }

  /** Saves after pending edits and saves, which change the text and the revision. */
  save(): Promise<void> {
    const name = this.name;
    this.#saves = this.#saves.then(async () => {
      await this.#edits;
      await this.#save(name);
    });
    return this.#saves;
  }

  async #save(name: string): Promise<void> {
    const known = this.#files.get(name);
    if (!known) {
      this.outcome = { done: false, lines: ['not saved: the file was not opened'] };
      return;
    }
    if (!this.isWritable) {
      this.outcome = { done: false, lines: ['not saved: this page may not write files'] };
      return;
    }
    const text = known.text;
    const written = text.replaceAll('\n', known.lineBreak);
    const reply = await this.#client.model('save', { file: this.#number(name), text: written, revision: known.revision });
    if (reply.done && reply.revision) {
      [known.revision, known.saved] = [reply.revision, text];
      this.#noteUnsaved();
      if (name === this.name) {
        this.saved = text;
        this.conflict = null;
        this.outcome = { done: true, lines: [`saved ${name}`] };
      }
    } else if (name !== this.name) {
      return;
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
   * Makes an edit of the file that is shown, after those before: replacements in the text, which
   * undo takes back together. States and transitions are given by their numbers in the present
   * outline. Another file may be shown before the edit is made.
   */
  edit(edit: ModelEdit): Promise<boolean> {
    const { name, outline } = this;
    const made = this.#edits.then(async () => {
      const reason = await this.#make(edit, name, outline);
      if (reason !== null) {
        this.outcome = { done: false, lines: [name === this.name ? reason : `${name}: ${reason}`] };
      }
      return reason === null;
    });
    this.#edits = made;
    return made;
  }

  /** Makes an edit. Returns why it is not possible. */
  async #make(edit: ModelEdit, name: string, known: Outline | null): Promise<string | null> {
    const isOther = 'the text has changed meanwhile: once more, please';
    const text = this.#files.get(name)?.text ?? '';
    const present = known?.text === text ? known : await this.#client.model('outline', { file: this.#number(name), text });
    if (shapeOf(present, edit) !== shapeOf(known, edit)) {
      return isOther;
    }
    const given = Object.fromEntries(Object.entries(edit).filter(([, value]) => value !== null));
    const reply = await this.#client.model('edit', { text, edit: given });
    if (!reply.done || !reply.edits) {
      return reply.reason ?? 'the edit is not possible';
    }
    if (this.#files.get(name)?.text !== text) {
      return isOther;
    }
    this.outcome = null;
    if (reply.edits.length > 0) {
      this.#replace(name, reply.edits);
      if (name === this.name) {
        await this.#understand();
      }
    }
    return null;
  }

  /** Makes replacements in the text of a file, which may not be shown any more. */
  #replace(name: string, changes: NonNullable<ModelReply['edits']>): void {
    const known = this.#files.get(name);
    const change = { changes, userEvent: 'input.drawing' };
    if (this.#view && this.#inView === name) {
      this.#view.dispatch(change);
    } else if (known) {
      known.state = known.state.update(change).state;
      this.#changed(name);
    }
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
    const { file, name, text } = this;
    if (this.#inView !== name) {
      return;
    }
    this.isChecking = true;
    const reply = await this.#client.model('check', { file, text });
    if (name === this.name && text === this.text) {
      this.isChecking = false;
      if (reply.done) {
        this.checked = { text, findings: reply.findings ?? [], stopped: reply.stopped === true };
        this.#mark();
      } else {
        this.#complain(`not checked: ${reply.reason ?? ''}`);
      }
    }
  }

  /** The number of a file in the list of models, or -1. */
  #number(name: string): number {
    return this.#client.models?.files.indexOf(name) ?? -1;
  }

  #newState(doc: string, isWritable: boolean): EditorState {
    const ask = (at: number) => this.#client.model('complete', { text: this.text, at });
    const change = () => this.#changed(this.#inView);
    return EditorState.create({ doc, extensions: textExtensions(ask, isWritable, () => void this.save(), change) });
  }

  #take(name: string, read: string, revision: string): void {
    const breaks = read.match(/\r\n?|\n/g) ?? [];
    const kinds = new Set(breaks);
    if (kinds.size > 1 || kinds.has('\r')) {
      this.fault = 'the lines of this file end in different ways: the editor would change all of them';
      return;
    }
    const lineBreak = kinds.has('\r\n') ? '\r\n' : '\n';
    const text = read.replaceAll('\r\n', '\n');
    this.#files.set(name, { state: this.#newState(text, true), text, saved: text, revision, lineBreak });
    this.conflict = null;
    this.#show(name);
  }

  #keepState(): void {
    const known = this.#files.get(this.#inView);
    if (known && this.#view) {
      known.state = this.#view.state;
    }
  }

  #show(name: string): void {
    const known = this.#files.get(name);
    if (!known) {
      return;
    }
    this.#inView = name;
    this.#view?.setState(known.state);
    this.saved = known.saved;
    this.outline = null;
    this.checked = null;
    this.isLoading = false;
    this.#changed(name);
    void this.#understand();
  }

  /** Shows no text, which cannot be written to, while a file is read. */
  #showNothing(): void {
    clearTimeout(this.#outlineTimer);
    clearTimeout(this.#checkTimer);
    this.#inView = '';
    this.#view?.setState(this.#newState('', false));
    [this.text, this.saved] = ['', ''];
    [this.outline, this.checked] = [null, null];
    [this.canUndo, this.canRedo, this.isChecking] = [false, false, false];
  }

  #noteUnsaved(): void {
    const changed = [...this.#files].filter(([, file]) => file.text !== file.saved);
    this.unsaved = changed.map(([name]) => name);
  }

  #changed(name: string): void {
    const known = this.#files.get(name);
    if (!known) {
      return;
    }
    const isInView = name === this.#inView;
    // A file may be read or edited while the editor is not shown.
    const state = (isInView ? this.#view?.state : null) ?? known.state;
    known.text = state.doc.toString();
    this.#noteUnsaved();
    if (!isInView) {
      return;
    }
    this.text = known.text;
    [this.canUndo, this.canRedo] = [undoDepth(state) > 0, redoDepth(state) > 0];
    clearTimeout(this.#outlineTimer);
    clearTimeout(this.#checkTimer);
    this.isChecking = false;
    this.#outlineTimer = setTimeout(() => void this.#understand(), OUTLINE_DELAY);
    this.#checkTimer = setTimeout(() => void this.check(), CHECK_DELAY);
  }

  /** Requests the outline of the text. */
  async #understand(): Promise<void> {
    clearTimeout(this.#outlineTimer);
    const { file, name, text } = this;
    const { done, picture, parts, findings, reason } = await this.#client.model('outline', { file, text });
    if (name !== this.name || text !== this.text) {
      return;
    }
    if (done && parts) {
      if (this.outcome === this.#complaint) {
        this.outcome = null;
      }
      this.outline = { text, picture: picture ?? null, parts, findings: findings ?? [] };
      const nodes = picture?.nodes.length ?? 0;
      const transitions = picture?.transitions.length ?? 0;
      this.selected = this.selected !== null && this.selected < nodes ? this.selected : null;
      this.transition = this.transition !== null && this.transition < transitions ? this.transition : null;
      this.#mark();
    } else {
      this.#complain(`not read: ${reason ?? ''}`);
    }
  }

  /** Shows why the text is not read or checked, until it is. */
  #complain(reason: string): void {
    this.#complaint = { done: false, lines: [reason] };
    this.outcome = this.#complaint;
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
