import type { FormField, Json } from './protocol';

const INTEGER = /^-?\d+$/;
const WORDS = ['NaN', 'Infinity', '-Infinity'];

/** A value of a field as it is edited. */
export function formText(field: FormField, value: Json): string {
  return field.kind === 'json' ? JSON.stringify(value) : typeof value === 'string' ? value : JSON.stringify(value);
}

/** The value of a text, or its error. */
export function formValue(field: FormField, text: string): { value: Json } | { fault: string } {
  const trimmed = text.trim();
  switch (field.kind) {
    case 'text':
    case 'enum':
      return { value: text };
    case 'boolean':
      return { value: text === 'true' };
    case 'integer':
      // As a text it keeps its 64 bits.
      return INTEGER.test(trimmed) ? { value: trimmed } : { fault: `${field.name} is not an integer` };
    case 'number': {
      const number = Number(trimmed);
      if (WORDS.includes(trimmed)) {
        return { value: trimmed };
      }
      return trimmed !== '' && Number.isFinite(number) ? { value: number } : { fault: `${field.name} is not a number` };
    }
    case 'json':
      try {
        return { value: JSON.parse(text) as Json };
      } catch {
        return { fault: `${field.name} is no JSON` };
      }
  }
}
