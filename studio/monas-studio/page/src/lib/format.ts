/** Minutes and seconds of a run's time. */
export function clock(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - minutes * 60).toFixed(1).padStart(4, '0')}`;
}

/** A length of time. */
export function span(seconds: number): string {
  if (seconds < 0.0995) {
    return `${Math.max(0, Math.round(seconds * 1000))} ms`;
  }
  return seconds < 60 ? `${seconds.toFixed(1)} s` : clock(seconds);
}

/** A measured duration in milliseconds. */
export function millis(seconds: number | undefined): string {
  return seconds === undefined ? '–' : (seconds * 1000).toFixed(3);
}

export function rate(hertz: number | null | undefined): string {
  if (hertz === null || hertz === undefined) {
    return '–';
  }
  return hertz < 10 ? hertz.toFixed(1) : Math.round(hertz).toString();
}

export function count(number: number): string {
  return number.toLocaleString('en').replaceAll(',', '\u202f');
}

/** Note on tables of a past moment of a run: they are recorded at intervals only. */
export const PAST_TABLES = 'Looking back, these figures may be some seconds older than the moment.';
