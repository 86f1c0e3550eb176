// Debian's Chromium, and `monas` in processes.
import { spawn } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';

export async function launch() {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
}

/** Starts `monas`, in a folder for control sockets of its own or in a given one. */
export function start(program, args, folder = mkdtempSync(join(tmpdir(), 'monas-studio-'))) {
  const child = spawn(program, args, { env: { ...process.env, XDG_RUNTIME_DIR: folder }, stdio: ['ignore', 'ignore', 'pipe'] });
  let text = '';
  child.stderr.on('data', (data) => (text += data));
  const ended = new Promise((resolve) => child.on('exit', resolve));
  /** What is printed and fits a pattern. */
  const printed = (pattern) =>
    new Promise((resolve, reject) => {
      const look = () => {
        const found = pattern.exec(text);
        if (found) {
          resolve(found);
        }
      };
      look();
      child.stderr.on('data', look);
      child.on('exit', (code) => reject(new Error(`monas ${args.join(' ')} ended with ${code}:\n${text}`)));
    });
  const stop = async () => {
    child.kill('SIGINT');
    await ended;
  };
  return { folder, pid: child.pid, printed, stop, url: printed(/^studio: (http\S+)$/m).then((found) => found[1]) };
}

/** With PAGE=dist, the page that was built last instead of the one in the program. */
export async function useBuiltPage(page) {
  if (process.env.PAGE === 'dist') {
    for (const name of ['studio.js', 'studio.css']) {
      await page.route(`**/${name}`, (route) => route.fulfill({ path: `dist/${name}` }));
    }
  }
}
