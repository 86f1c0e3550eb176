/** A line of a migration with the last parts of the paths of states, which are long. */
export function briefLine(line: string): string {
  return line.replace(/`([^`]*)`/g, (whole, quoted: string) => {
    if (!quoted.includes('/') || quoted.includes(' -> ')) {
      return whole;
    }
    const [path, ...rest] = quoted.split(': ');
    const parts = pathParts(path ?? quoted).filter((part) => /^\w+$/.test(part) && !/^\d+$/.test(part));
    const name = parts.slice(-2).join('/') || (path ?? quoted);
    return `\`${[name, ...rest].join(': ')}\``;
  });
}

/** The parts of a path; brackets of formulas may enclose slashes. */
function pathParts(path: string): string[] {
  const parts: string[] = [];
  let [start, depth] = [0, 0];
  for (let at = 0; at < path.length; at += 1) {
    const letter = path[at] ?? '';
    if ('(['.includes(letter)) {
      depth += 1;
    } else if (')]'.includes(letter)) {
      depth -= 1;
    } else if (letter === '/' && depth === 0) {
      parts.push(path.slice(start, at));
      start = at + 1;
    }
  }
  parts.push(path.slice(start));
  return parts;
}
