export interface DifferentLine {
  sign: '-' | '+';
  number: number;
  text: string;
}

/** The lines of the middle part in which two texts differ: those of the first, those of the second. */
export function lineDifference(before: string, after: string): DifferentLine[] {
  const [old, next] = [before.split('\n'), after.split('\n')];
  let same = 0;
  while (same < Math.min(old.length, next.length) && old[same] === next[same]) {
    same += 1;
  }
  let end = 0;
  while (end < Math.min(old.length, next.length) - same && old[old.length - 1 - end] === next[next.length - 1 - end]) {
    end += 1;
  }
  const lines = (all: string[], sign: '-' | '+') =>
    all.slice(same, all.length - end).map((text, index): DifferentLine => ({ sign, number: same + index + 1, text }));
  return [...lines(old, '-'), ...lines(next, '+')];
}
