import type { Reply } from './protocol';

/** The outcome of a request as text. */
export interface Outcome {
  done: boolean;
  lines: string[];
}

/** The outcome of a reply, with the reasons of a refusal. */
export function outcomeOf(what: string, reply: Reply): Outcome {
  const after = reply.cycle !== undefined && reply.cycle > 0 ? `, after cycle ${reply.cycle}` : '';
  const findings = (reply.findings ?? []).map((finding) => {
    const place = finding.file && finding.line > 0 ? `${finding.file}:${finding.line}:${finding.column}: ` : '';
    const hint = finding.hint ? ` (${finding.hint})` : '';
    return `${place}${finding.text}${hint}`;
  });
  const reasons = findings.length > 0 || !reply.reason ? findings : [reply.reason];
  return reply.done
    ? { done: true, lines: [`${what}: done${after}`, ...findings] }
    : { done: false, lines: [`${what}: refused`, ...reasons] };
}
