import { autocompletion, completionKeymap, type Completion as Option, type CompletionContext } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap } from '@codemirror/commands';
import { lintGutter, lintKeymap } from '@codemirror/lint';
import { EditorState, type Extension } from '@codemirror/state';
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';
import { bracketMatching } from '@codemirror/language';
import type { ModelReply } from './protocol';
import { modelLanguage } from './text_language';

/** The kinds of completions as the editor draws them. */
const ICONS: Record<string, string> = {
  activity: 'method',
  action: 'function',
  constant: 'constant',
  event: 'interface',
  field: 'property',
  formula: 'variable',
  function: 'function',
  item: 'variable',
  key: 'property',
  kind: 'type',
  message: 'class',
  modifier: 'keyword',
  section: 'namespace',
  state: 'type',
  timer: 'variable',
  topic: 'class',
  value: 'enum',
  word: 'keyword',
};

const look = EditorView.theme({
  '&': { height: '100%', fontSize: '12.5px', backgroundColor: 'var(--panel)', color: 'var(--text)' },
  '&.cm-focused': { outline: '2px solid var(--accent)', outlineOffset: '-2px' },
  '.cm-scroller': { fontFamily: "ui-monospace, 'DejaVu Sans Mono', 'Liberation Mono', monospace", lineHeight: '1.5' },
  '.cm-content': { caretColor: 'var(--text)' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '.cm-gutters': { backgroundColor: 'var(--panel)', color: 'var(--quiet)', border: 'none' },
  '.cm-activeLine': { backgroundColor: 'color-mix(in srgb, var(--accent) 7%, transparent)' },
  '.cm-selectionBackground, &.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground': {
    backgroundColor: 'var(--accent-soft)',
  },
  '.cm-matchingBracket': { backgroundColor: 'var(--accent-soft)', outline: '1px solid var(--accent)' },
  '.cm-tooltip': { backgroundColor: 'var(--panel)', color: 'var(--text)', border: '1px solid var(--line)', borderRadius: '6px' },
  '.cm-tooltip-autocomplete > ul > li[aria-selected]': { backgroundColor: 'var(--accent-soft)', color: 'var(--text)' },
  '.cm-completionDetail': { color: 'var(--quiet)', fontStyle: 'normal' },
  '.cm-diagnostic': { fontFamily: 'system-ui, sans-serif', whiteSpace: 'pre-wrap', maxWidth: '60ch' },
  '.cm-lintRange-error': { backgroundImage: 'none', borderBottom: '2px solid var(--bad)' },
  '.cm-lintRange-warning': { backgroundImage: 'none', borderBottom: '2px dashed var(--flash)' },
});

type Ask = (at: number) => Promise<ModelReply>;

/** Completion by the program, which replies with the word that is replaced. */
function completion(ask: Ask): Extension {
  const source = async (context: CompletionContext) => {
    const before = context.matchBefore(/[\w.:[/=| ]/)?.text ?? '';
    if (!context.explicit && !/[\w.[]/.test(before)) {
      return null;
    }
    const reply = await ask(context.pos);
    if (context.aborted || !reply.done || !reply.entries || reply.entries.length === 0) {
      return null;
    }
    const options: Option[] = reply.entries.map(({ text, kind, detail }) => ({
      label: text,
      type: ICONS[kind] ?? 'text',
      detail: detail === '' ? kind : detail,
    }));
    return { from: reply.from ?? context.pos, options, validFor: /^\w*$/ };
  };
  return autocompletion({ override: [source], icons: true });
}

/** The editor of a whole text. Tab leaves it. */
export function textExtensions(ask: Ask, isWritable: boolean, onsave: () => void, onchange: () => void): Extension {
  return [
    lineNumbers(),
    lintGutter(),
    history(),
    drawSelection(),
    bracketMatching(),
    highlightActiveLine(),
    modelLanguage,
    completion(ask),
    look,
    EditorState.readOnly.of(!isWritable),
    EditorView.contentAttributes.of({ 'aria-label': 'Text of the model', spellcheck: 'false', autocapitalize: 'off' }),
    EditorView.updateListener.of((update) => update.docChanged && onchange()),
    keymap.of([
      { key: 'Mod-s', run: () => (onsave(), true), preventDefault: true },
      ...completionKeymap,
      ...lintKeymap,
      ...historyKeymap,
      ...defaultKeymap,
    ]),
  ];
}

/** The editor of an expression, on one line. */
export function expressionExtensions(ask: Ask, label: string, onenter: () => void, onsave: () => void, onchange: (text: string) => void): Extension {
  return [
    history(),
    bracketMatching(),
    modelLanguage,
    completion(ask),
    look,
    EditorView.lineWrapping,
    EditorState.transactionFilter.of((transaction) => (transaction.newDoc.lines > 1 ? [] : transaction)),
    EditorView.contentAttributes.of({ 'aria-label': label, spellcheck: 'false', autocapitalize: 'off' }),
    EditorView.updateListener.of((update) => update.docChanged && onchange(update.state.doc.toString())),
    // As other fields do: another file may be chosen next.
    EditorView.domEventHandlers({ blur: () => onenter() }),
    keymap.of([{ key: 'Mod-s', run: () => (onsave(), true), preventDefault: true }, ...completionKeymap, { key: 'Enter', run: () => (onenter(), true) }, ...historyKeymap, ...defaultKeymap]),
  ];
}
