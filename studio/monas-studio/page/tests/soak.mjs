// Viewers of a run at full rate for some minutes, not part of the tests:
// `MONAS=path/to/monas node tests/soak.mjs [MINUTES] [VIEWERS]`. It prints the cycles of agents in
// real time without and with viewers, the memory of the program and of the pages, and the processor
// time of the program's threads: that of the run itself must not depend on viewers.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch, start } from './browser.mjs';

const PROGRAM = process.env.MONAS ?? fileURLToPath(new URL('../../../../target/debug/monas', import.meta.url));
const CONFIGURATIONS = fileURLToPath(new URL('../../../../config/', import.meta.url));
const length = Number(process.argv[2] ?? 3);
const viewers = Number(process.argv[3] ?? 5);
const INTERVAL = 15_000;

/** The match of the README, with halves that do not end before the soak. */
function longMatch() {
  const text = readFileSync(join(CONFIGURATIONS, 'match.xml'), 'utf8');
  const path = join(mkdtempSync(join(tmpdir(), 'monas-soak-')), 'match.xml');
  writeFileSync(path, text.replace('half="300s"', 'half="7200s"').replaceAll('"config/', `"${CONFIGURATIONS}`));
  return path;
}

const sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
const megabytes = (bytes) => (bytes / 1e6).toFixed(1);

/** The memory of a process in bytes, and its time on processors in seconds. */
function usage(pid) {
  const status = readFileSync(`/proc/${pid}/status`, 'utf8');
  const stat = readFileSync(`/proc/${pid}/stat`, 'utf8');
  const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
  const cpu = (Number(fields[11]) + Number(fields[12])) / 100;
  return { memory: Number(/VmRSS:\s+(\d+)/.exec(status)?.[1]) * 1024, cpu };
}

/** The processor time of the threads of a process in seconds, by their names without numbers. */
function threads(pid) {
  const times = new Map();
  for (const task of readdirSync(`/proc/${pid}/task`)) {
    try {
      const stat = readFileSync(`/proc/${pid}/task/${task}/stat`, 'utf8');
      const name = stat.slice(stat.indexOf('(') + 1, stat.lastIndexOf(')'));
      const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
      times.set(name, (times.get(name) ?? 0) + (Number(fields[11]) + Number(fields[12])) / 100);
    } catch {
      // It has ended.
    }
  }
  return [...times].sort((a, b) => b[1] - a[1]).map(([name, seconds]) => `${name} ${seconds.toFixed(1)} s`).join(', ');
}

/** The cycles of all agents: their number, and times in milliseconds; percentiles are the largest
 * of an agent. */
function cycles(folder) {
  const text = execFileSync(PROGRAM, ['agent', 'list', '--run', 'soak', '--format', 'json'], { env: { ...process.env, XDG_RUNTIME_DIR: folder } });
  const rows = String(text).trim().split('\n').map((line) => JSON.parse(line));
  const times = rows.map((row) => row.cycle_time).filter((time) => time);
  const count = times.reduce((all, time) => all + time.count, 0);
  const mean = times.reduce((all, time) => all + time.mean_seconds * time.count, 0) / Math.max(1, count);
  const longest = Math.max(...times.map((time) => time.longest_seconds));
  const [p50, p99, p999] = ['p50', 'p99', 'p999'].map((name) => Math.max(...times.map((time) => time[`${name}_seconds`])) * 1e3);
  return { count, mean: mean * 1e3, p50, p99, p999, longest: longest * 1e3 };
}

const line = (name, { count, mean, p50, p99, p999, longest }) =>
  console.log(
    `${name}: ${count} cycles, mean ${mean.toFixed(4)} ms, p50 ${p50.toFixed(4)} ms, p99 ${p99.toFixed(3)} ms, p99.9 ${p999.toFixed(3)} ms, longest ${longest.toFixed(2)} ms`,
  );

/** A run for some minutes, with so many viewers. */
async function soak(count, minutes) {
  const run = start(PROGRAM, ['run', longMatch(), '--control', 'soak', '--studio', '--seed', '1', '--for', `${minutes * 60 + 60}s`]);
  const url = await run.url;
  const pid = run.pid;
  const browser = count > 0 ? await launch() : null;
  const pages = [];
  for (let place = 0; place < count; place += 1) {
    const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
    await page.goto(url);
    pages.push({ page, session: await page.context().newCDPSession(page) });
    if (place === 1) {
      await page.keyboard.press('3');
      await page.getByLabel('Filter topics').fill('body/sensors');
      await page.locator('tr.choice').first().click();
    } else if (place === 2) {
      await page.keyboard.press('2');
    }
  }
  const begin = Date.now();
  const before = usage(pid).cpu;
  while (Date.now() - begin < minutes * 60_000) {
    await sleep(INTERVAL);
    const heaps = [];
    for (const { session } of pages) {
      await session.send('HeapProfiler.collectGarbage');
      heaps.push(megabytes((await session.send('Runtime.getHeapUsage')).usedSize));
    }
    const { memory, cpu } = usage(pid);
    const seconds = (Date.now() - begin) / 1000;
    console.log(
      `${count} viewers, ${seconds.toFixed(0)} s: program ${megabytes(memory)} MB, ${(((cpu - before) / seconds) * 100).toFixed(0)} % of a processor; heaps of pages ${heaps.join(' ')} MB`,
    );
  }
  line(`${count} viewers`, cycles(run.folder));
  console.log(`${count} viewers, threads: ${threads(pid)}`);
  await browser?.close();
  await run.stop();
}

await soak(0, Math.max(1, length / 4));
await soak(viewers, length);
