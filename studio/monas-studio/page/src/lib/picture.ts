import type { Json, Picture } from './protocol';

/** A node and the composites around it, outwards. */
export function lineage(picture: Picture, node: number): number[] {
  const found: number[] = [];
  for (let next: number | null = node; next !== null && found.length < picture.nodes.length; ) {
    found.push(next);
    next = picture.nodes[next]?.parent ?? null;
  }
  return found;
}

/** The node that is drawn for a node: itself, or the composite that it is folded into. */
export function drawn(picture: Picture, node: number): number | null {
  return lineage(picture, node).find((id) => picture.nodes[id]?.shape) ?? null;
}

/** The last part of a short name. */
export function lastWord(name: string): string {
  const parts = name.split('/');
  const word = parts[parts.length - 1] ?? name;
  return /^[\d#]+$/.test(word) && parts.length > 1 ? name : word;
}

export function nodeName(picture: Picture, node: number): string {
  return picture.nodes[node]?.name ?? `state ${node}`;
}

/** A value of a message for people. */
export function valueText(value: Json): string {
  return typeof value === 'number' && !Number.isInteger(value) ? value.toPrecision(4) : JSON.stringify(value);
}
