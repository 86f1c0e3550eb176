import { lineage, nodeName } from './picture';
import type { ChartStep, Picture } from './protocol';

/** A decision of a chart, with the number of its consecutive repetitions. */
export interface Decision {
  /** The number of the step that first decided it. */
  number: number;
  node: number;
  name: string;
  /** The state that was left, if it is not the beginning of a composite. */
  from: string | null;
  event: string | null;
  /** The conditions on the path, outermost first. */
  conditions: string[];
  first: number;
  last: number;
  count: number;
}

const DECISIONS = 60;
/** In a loop a decided state is left at once, and decided again. */
const MOMENT = 1;

/** The region with most decisions: of all regions the one with most states outside of its own
 * regions. Regions with one state only repeat it. */
export function mainRegion(picture: Picture): number {
  const counts = new Map<number, number>();
  picture.nodes.forEach((node, id) => {
    if (node.kind === 'BASIC') {
      const region = regionOf(picture, id);
      counts.set(region, (counts.get(region) ?? 0) + 1);
    }
  });
  let main = 0;
  let most = 0;
  for (const [region, count] of counts) {
    if (count > most) {
      [main, most] = [region, count];
    }
  }
  return main;
}

/** The innermost region around a node: a child of an AND, or the chart. */
export function regionOf(picture: Picture, node: number): number {
  const around = lineage(picture, node);
  return around.find((id) => picture.nodes[picture.nodes[id]?.parent ?? -1]?.kind === 'AND') ?? 0;
}

/** The smallest drawn composite with all states of a region. */
export function stage(picture: Picture, region: number): number {
  const states = picture.nodes.flatMap((node, id) => (node.kind === 'BASIC' && regionOf(picture, id) === region ? [id] : []));
  const [first, ...others] = states.map((id) => lineage(picture, id).slice(1));
  const shared = (first ?? []).filter((id) => others.every((line) => line.includes(id)));
  return shared.find((id) => picture.nodes[id]?.shape) ?? 0;
}

/** The segments of a step that lead to a node, from the state that was left to it. */
function wayTo(picture: Picture, step: ChartStep, node: number): number[] {
  const left = new Set(step.fired);
  const into = (target: number | undefined) => [...left].find((id) => picture.transitions[id]?.target === target);
  const around = lineage(picture, node);
  let segment = around.map(into).find((found) => found !== undefined);
  const way: number[] = [];
  while (segment !== undefined) {
    way.unshift(segment);
    left.delete(segment);
    segment = into(picture.transitions[segment]?.source);
  }
  return way;
}

/** The transitions that leave a node together with others: one of them has to be chosen. */
function isChoice(picture: Picture, segment: number): boolean {
  const source = picture.transitions[segment]?.source;
  const others = picture.transitions.filter((other) => other.source === source && other.text !== '[false]');
  return others.length > 1;
}

/** Why a node was entered, by the steps that entered it and the composites around it at that time. */
export function reasonOf(
  picture: Picture,
  enteredBy: ReadonlyMap<number, ChartStep>,
  node: number,
): Omit<Decision, 'first' | 'count'> | null {
  const last = enteredBy.get(node);
  if (!last) {
    return null;
  }
  const steps: ChartStep[] = [];
  for (const id of lineage(picture, node)) {
    const step = enteredBy.get(id);
    if (step?.t === last.t && !steps.includes(step)) {
      steps.unshift(step);
    }
  }
  const segments = steps.flatMap((step) => wayTo(picture, step, node));
  const own = wayTo(picture, last, node);
  const first = own.map((id) => picture.transitions[id]?.source).find((id) => id !== undefined);
  const isState = first !== undefined && picture.nodes[first]?.kind === 'BASIC';
  const chosen = segments.filter((id) => isChoice(picture, id));
  const conditions = (chosen.length > 0 ? chosen : own).map((id) => picture.transitions[id]?.text ?? '').filter((text) => text !== '');
  return {
    node,
    name: nodeName(picture, node),
    from: isState && first !== node ? nodeName(picture, first) : null,
    event: steps.find((step) => step.event !== null)?.event ?? null,
    conditions: [...new Set(conditions)],
    last: last.t,
    number: last.number,
  };
}

/** Whether a decision still holds: its state is active, or was until a moment ago. */
export function holds(decision: Decision | undefined, active: number[], now: number): decision is Decision {
  return decision !== undefined && (active.includes(decision.node) || now - decision.last < MOMENT);
}

/** Adds the decision of a step in a region: a state that was one of several. */
export function addDecision(
  decisions: Decision[],
  picture: Picture,
  region: number,
  enteredBy: ReadonlyMap<number, ChartStep>,
  step: ChartStep,
): Decision[] {
  const entered = step.entries.find((id) => picture.nodes[id]?.kind === 'BASIC' && regionOf(picture, id) === region);
  if (entered === undefined || !wayTo(picture, step, entered).some((id) => isChoice(picture, id))) {
    return decisions;
  }
  const reason = reasonOf(picture, enteredBy, entered);
  if (!reason) {
    return decisions;
  }
  const before = decisions.at(-1);
  const isSame = before?.node === reason.node && before.conditions.join() === reason.conditions.join();
  if (before && isSame) {
    return [...decisions.slice(0, -1), { ...before, last: reason.last, count: before.count + 1 }];
  }
  return [...decisions, { ...reason, first: reason.last, count: 1 }].slice(-DECISIONS);
}
