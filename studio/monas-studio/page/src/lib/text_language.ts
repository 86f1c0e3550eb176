import { HighlightStyle, StreamLanguage, syntaxHighlighting } from '@codemirror/language';
import { tags } from '@lezer/highlight';

const KINDS = /^(OR|AND|BASIC|START|END|CONDITION|JUNCTION|CHOICE|FORK|JOIN|SHALLOW_HISTORY|HISTORY|TERMINATE|ENTRY|EXIT|NODE)\b/;
const WORDS = /^(also|interrupts|internal|true|false|not|and|or|In|StartTimeout|TimeoutCheck|raise|publish|process_messages|publish_all)\b/;

/** The colours of a model's text: comments, headers, texts, numbers, words, operators. */
const modelText = StreamLanguage.define<null>({
  startState: () => null,
  token(stream) {
    if (stream.sol() && stream.match(/^\s*[A-Z][A-Za-z]*:/)) {
      return 'heading';
    }
    if (stream.eatSpace()) {
      return null;
    }
    if (stream.match(/^#.*/)) {
      return 'comment';
    }
    if (stream.match(/^"([^"\\]|\\.)*"?/)) {
      return 'string';
    }
    if (stream.match(/^\d+(\.\d+)?([a-z]+\b)?/)) {
      return 'number';
    }
    if (stream.match(KINDS) || stream.match(WORDS)) {
      return 'keyword';
    }
    if (stream.match(/^[a-z_]+(?=\s*=(?!=))/)) {
      return 'propertyName';
    }
    if (stream.match(/^(->|\|\||&&|==|!=|<=|>=|[|.+*~ωΩ!<>=\-/[\]()^])/)) {
      return 'operator';
    }
    if (!stream.match(/^\w+/)) {
      stream.next();
    }
    return null;
  },
});

const colours = HighlightStyle.define([
  { tag: tags.comment, color: 'var(--quiet)', fontStyle: 'italic' },
  { tag: tags.heading, color: 'var(--accent)', fontWeight: '700' },
  { tag: tags.string, color: 'var(--good)' },
  { tag: tags.number, color: 'var(--flash)' },
  { tag: tags.keyword, color: 'var(--accent)', fontWeight: '600' },
  { tag: tags.propertyName, color: 'var(--accent)' },
  { tag: tags.operator, color: 'var(--arrow)', fontWeight: '600' },
]);

export const modelLanguage = [modelText, syntaxHighlighting(colours)];
