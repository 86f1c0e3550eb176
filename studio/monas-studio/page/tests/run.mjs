// The studio in headless Chromium on real runs: `MONAS=path/to/monas npm test`. Screenshots are
// written to tests/screenshots.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch, start, useBuiltPage } from './browser.mjs';
import { testEditor } from './editor.mjs';

const PROGRAM = process.env.MONAS ?? fileURLToPath(new URL('../../../../target/debug/monas', import.meta.url));
const MATCH = fileURLToPath(new URL('../../../../config/match.xml', import.meta.url));
const SCREENSHOTS = fileURLToPath(new URL('screenshots', import.meta.url));
const SOON = 60_000;

/** A page that fails the test on errors, and on requests to anywhere else. */
async function open(browser, url, viewport = { width: 1280, height: 720 }) {
  const page = await browser.newPage({ viewport });
  const faults = [];
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('console', (message) => message.type() === 'error' && faults.push(message.text()));
  page.on('request', (request) => {
    const { protocol, host } = new URL(request.url());
    if (!['data:', 'blob:'].includes(protocol) && host !== new URL(url).host) {
      faults.push(`a request to ${host}`);
    }
  });
  page.setDefaultTimeout(SOON);
  await useBuiltPage(page);
  await page.goto(url);
  return { page, faults };
}

const shot = (page, name) => page.screenshot({ path: `${SCREENSHOTS}/${name}.png` });
const textOf = (page, selector) => page.locator(selector).first().innerText();

/** The condition, within a time. */
async function until(page, what, condition, argument) {
  await page.waitForFunction(condition, argument, { timeout: SOON }).catch(() => assert.fail(`not within a minute: ${what}`));
}

const seconds = (clock) => clock.split(':').reduce((all, part) => all * 60 + Number(part), 0);

const TESTS = {
  async 'the first view explains itself'({ page }) {
    await until(page, 'six robots and the ball', () => document.querySelectorAll('.body').length === 6 && document.querySelector('.ball'));
    await until(page, 'six charts', () => document.querySelectorAll('.robots li').length === 6);
    await until(page, 'an active state', () => document.querySelector('.chart .node.BASIC.active'));
    await until(page, 'a reason with a condition', () => /because\s+\[/.test(document.querySelector('.why')?.textContent ?? ''));
    await until(page, 'decisions', () => document.querySelectorAll('.steps li b').length > 1);
    assert.match(await textOf(page, '.score'), /Blue \d+\s*:\s*Red \d+/);
    await until(page, 'a transition that fires', () => document.querySelector('.way.flash'));
    await shot(page, 'overview');
  },

  async 'charts are chosen on the field, in the list and with keys'({ page }) {
    const title = () => textOf(page, '.chart h2');
    const before = await title();
    await page.keyboard.press('j');
    assert.notEqual(await title(), before);
    await page.locator('.robots button', { hasText: 'red-1' }).click();
    assert.match(await title(), /red-1\s+Goalie/);
    await page.evaluate(() => {
      const body = [...document.querySelectorAll('.body')].find((one) => one.textContent?.startsWith('blue-3'));
      body?.dispatchEvent(new MouseEvent('click', { bubbles: true }));
    });
    await until(page, 'the chosen robot', () => document.querySelector('.chart h2')?.textContent?.includes('blue-3'));
  },

  async 'a state says how it was entered'({ page }) {
    await page.locator('.chart button', { hasText: 'Fit' }).click();
    const state = page.locator('.chart [data-state$="RobotController"]').first();
    await state.focus();
    await page.keyboard.press('Enter');
    assert.match(await textOf(page, '.why'), /RobotController\s+runs activity\s+RobotController/);
    await until(page, 'how it was entered', () => /robot_timeout/.test(document.querySelector('.why')?.textContent ?? ''));
    await page.locator('.why button').click();
    await shot(page, 'chart');
  },

  async 'guards, timers and blackboards are seen as they change'({ page }) {
    await page.getByRole('button', { name: 'Values' }).click();
    await until(page, 'guards that hold, and others', () => {
      const signs = [...document.querySelectorAll('[aria-label=Guards] .sign')].map((sign) => sign.textContent);
      return signs.includes('✓') && signs.includes('✗');
    });
    await until(page, 'a timer that runs', () => /decision_timeout in /.test(document.querySelector('[aria-label=Timers]')?.textContent ?? ''));
    const ball = page.locator('[aria-label=Blackboards] details', { hasText: 'soccer/ball' }).first();
    await ball.evaluate((details) => (details.open = true));
    await until(page, 'the ball of a region', () => /soccer\/ball\s+0:\d\d\.\d\s+.*distance \d/.test(document.querySelector('[aria-label=Blackboards]')?.textContent ?? ''));
    const timers = await textOf(page, '[aria-label=Timers]');
    await until(page, 'that timers go on', (before) => document.querySelector('[aria-label=Timers]')?.textContent !== before, timers);
    await shot(page, 'values');
    await page.locator('[aria-label=Guards] li', { hasText: '[robot_timeout]' }).getByRole('button').click();
    await until(page, 'whether its guard holds', () => /its guard (holds|does not hold) at 0:\d\d/.test(document.querySelector('.why')?.textContent ?? ''));
    await page.locator('.why button').click();
    await page.getByRole('button', { name: 'Latest decisions' }).click();
  },

  async 'the drawing is saved as SVG'({ page }) {
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('.chart button', { hasText: 'SVG' }).click()]);
    assert.match(download.suggestedFilename(), /^blue-3-Attacker\.svg$/);
  },

  async 'the drawing is saved as PNG, with two pixels for one'({ page }) {
    const [download] = await Promise.all([page.waitForEvent('download'), page.locator('.chart button', { hasText: 'PNG' }).click()]);
    assert.match(download.suggestedFilename(), /^blue-3-Attacker\.png$/);
    const bytes = readFileSync(await download.path());
    assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
    const size = await page.locator('.chart svg').getAttribute('viewBox');
    const [, , width, height] = size.split(' ').map(Number);
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [Math.ceil(width * 2), Math.ceil(height * 2)]);
    const colours = await page.evaluate(async (text) => {
      const image = new Image();
      image.src = `data:image/png;base64,${text}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      return new Set(new Uint32Array(data.buffer)).size;
    }, bytes.toString('base64'));
    assert.ok(colours > 20, `${colours} colours: something is drawn`);
  },

  async 'composites that only enclose another are folded'({ page }) {
    const picture = await page.evaluate(
      () =>
        new Promise((resolve) => {
          const socket = new WebSocket(`ws://${location.host}/socket`);
          const ask = () => socket.readyState === WebSocket.OPEN && socket.send(JSON.stringify({ type: 'picture', key: 'blue-2/Attacker/0' }));
          const again = setInterval(ask, 500);
          socket.onmessage = (event) => {
            const message = JSON.parse(event.data);
            if (message.type === 'picture' && message.picture) {
              clearInterval(again);
              socket.close();
              resolve(message.picture);
            }
          };
        }),
    );
    const { nodes } = picture;
    const drawn = nodes.map((node, id) => (node.shape ? id : null)).filter((id) => id !== null);
    const composites = (list) => list.filter((id) => ['OR', 'AND'].includes(nodes[id].kind));
    const around = (id) => {
      let parent = nodes[id].parent;
      while (parent !== null && !nodes[parent].shape) {
        parent = nodes[parent].parent;
      }
      return parent;
    };
    const all = composites(nodes.map((_, id) => id));
    assert.ok(composites(drawn).length < all.length, `${composites(drawn).length} of ${all.length} are drawn`);
    for (const id of composites(drawn).filter((id) => nodes[id].kind === 'OR')) {
      const inside = drawn.filter((other) => around(other) === id);
      const onlyWraps = inside.length > 0 && inside.every((other) => ['OR', 'AND', 'START', 'END'].includes(nodes[other].kind)) && composites(inside).length === 1;
      const leads = picture.arrows.some((arrow) => inside.includes(arrow.source) && arrow.lines.length > 0);
      assert.ok(!onlyWraps || leads, `${nodes[id].name} only encloses ${composites(inside).map((other) => nodes[other].name)}`);
    }
  },

  async 'simulated time is held and goes on'({ page }) {
    await page.locator('h2').first().click();
    await page.keyboard.press(' ');
    await until(page, 'the run is held', () => document.querySelector('.link')?.textContent === 'Held');
    await page.waitForFunction(
      () => {
        const now = document.querySelector('.time')?.textContent;
        const isSame = window.heldTime === now;
        window.heldTime = now;
        return isSame;
      },
      undefined,
      { polling: 500, timeout: SOON },
    );
    const held = seconds(await textOf(page, '.time'));
    await page.keyboard.press(' ');
    await until(page, 'time goes on', (held) => (document.querySelector('.time')?.textContent ?? '') !== held, await textOf(page, '.time'));
    assert.ok(held > 0);
  },

  async 'a run is looked back at while it goes on'({ page }) {
    await until(page, 'some seconds', () => Number((document.querySelector('.time')?.textContent ?? '').split(':')[1]) > 9);
    const link = () => textOf(page, '.link');
    await page.getByLabel('Moment').fill('7');
    await until(page, 'a moment before', () => document.querySelector('.link')?.textContent === 'Looking back' && document.querySelector('.time')?.textContent === '0:07.0');
    await until(page, 'its robots and chart', () => document.querySelectorAll('.body').length === 6 && document.querySelector('.chart .node.active'));
    await page.locator('h2').first().click();
    await page.keyboard.press('.');
    await until(page, 'the next step', () => /^0:07\.[1-9]$/.test(document.querySelector('.time')?.textContent ?? ''));
    await shot(page, 'looking-back');
    await page.keyboard.press(' ');
    await until(page, 'that it plays', () => Number((document.querySelector('.time')?.textContent ?? '').split(':')[1]) > 8);
    assert.equal(await link(), 'Looking back');
    await page.keyboard.press('l');
    await until(page, 'the present moment', () => document.querySelector('.link')?.textContent === 'Live');
    assert.ok(seconds(await textOf(page, '.time')) > 9.9);
    await until(page, 'an active state', () => document.querySelector('.chart .node.BASIC.active'));
  },

  async 'agents have figures, and activities'({ page }) {
    await page.keyboard.press('2');
    await until(page, 'six agents', () => document.querySelectorAll('tr.choice').length === 6);
    await until(page, 'a rate', () => Number(document.querySelector('tr.choice td.number')?.textContent) > 0);
    await page.locator('tr.choice', { hasText: 'blue-2' }).click();
    assert.match(await textOf(page, '.inner'), /WalkTowardsBall/);
    await until(page, 'plots of lengths, cycles and overruns', () => document.querySelectorAll('.plots .uplot').length === 3);
    assert.match(await textOf(page, '.plots'), /mean.*deviation.*p50.*p99.*Cycles per second.*Overruns per second/s);
    await shot(page, 'agents');
  },

  async 'topics have rates, the last message as a tree, and plots'({ page }) {
    await page.keyboard.press('3');
    await page.getByLabel('Filter topics').fill('soccer/ball');
    await until(page, 'a row for each robot', () => document.querySelectorAll('tr.choice').length >= 6);
    await page.locator('tr.choice', { hasText: 'blue-2' }).click();
    await until(page, 'the last message', () => /distance/.test(document.querySelector('.message')?.textContent ?? ''));
    await page.locator('.leaf', { hasText: 'distance' }).getByRole('button').click();
    await until(page, 'a plot', () => document.querySelector('.u-over'));
    await until(page, 'a line', () => {
      const canvas = document.querySelector('.uplot canvas');
      const data = canvas?.getContext('2d')?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
      for (let at = 0; at < data.length; at += 4) {
        if (data[at] === 0 && data[at + 1] === 114 && data[at + 2] === 178 && data[at + 3] === 255) {
          return true;
        }
      }
      return false;
    });
    await shot(page, 'topics');
  },

  async 'agent, topic, filter and plot stay chosen when one comes back'({ page }) {
    await page.locator('h2').first().click();
    await page.keyboard.press('2');
    await page.locator('tr.chosen', { hasText: 'blue-2' }).waitFor();
    await page.keyboard.press('3');
    await page.locator('tr.chosen', { hasText: 'blue-2' }).waitFor();
    await until(page, 'its messages', () => /distance/.test(document.querySelector('.message')?.textContent ?? ''));
    assert.equal(await page.getByLabel('Filter topics').inputValue(), 'soccer/ball');
    await until(page, 'the plot', () => document.querySelector('.u-over'));
  },

  async 'looking back, no later message is shown, and the age of figures is said'({ page }) {
    await page.getByLabel('Moment').fill('7');
    await page.getByText('Messages of a past moment are not kept').waitFor();
    await page.getByText('Looking back, these figures may be some seconds older').waitFor();
    assert.equal(await page.locator('.leaf').count(), 0);
    await page.locator('h2').first().click();
    await page.keyboard.press('2');
    await page.getByText('Looking back, these figures may be some seconds older').waitFor();
    await page.keyboard.press('l');
    await until(page, 'the present moment', () => document.querySelector('.link')?.textContent === 'Live');
    await page.keyboard.press('3');
    await until(page, 'messages again', () => /distance/.test(document.querySelector('.message')?.textContent ?? ''));
  },

  async 'the log has filters'({ page }) {
    await page.locator('h2').first().click();
    await page.keyboard.press('4');
    await until(page, 'a line', () => document.querySelector('.line'));
    await page.getByLabel('Filter lines').fill('no line has this');
    await until(page, 'no line', () => /No line fits/.test(document.querySelector('.lines')?.textContent ?? ''));
    await page.getByLabel('Filter lines').fill('motion');
    await until(page, 'lines with the word', () => document.querySelector('.line'));
    await shot(page, 'log');
    await page.locator('h2').first().click();
    await page.keyboard.press('1');
    await page.keyboard.press('4');
    assert.equal(await page.getByLabel('Filter lines').inputValue(), 'motion');
  },

  async 'help, light and dark'({ page }) {
    await page.locator('h2').first().click();
    await page.keyboard.press('1');
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
    await page.keyboard.press('Escape');
    const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
    const before = await theme();
    await page.keyboard.press('t');
    assert.notEqual(await theme(), before);
    await until(page, 'the chart', () => document.querySelector('.chart .node.BASIC.active'));
    await shot(page, 'dark');
    await page.keyboard.press('t');
  },

  async 'a phone shows all in one column'({ page }) {
    await page.setViewportSize({ width: 390, height: 844 });
    for (const key of ['1', '2', '3', '4', '1']) {
      await page.keyboard.press(key);
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      assert.ok(width <= 390, `view ${key} is ${width} pixels wide`);
    }
    await shot(page, 'phone');
    // one column in a window that is not high
    await page.setViewportSize({ width: 800, height: 600 });
    await page.waitForTimeout(300);
    const heights = await page.evaluate(() => ['[aria-label=Field]', '.robots'].map((panel) => document.querySelector(panel)?.clientHeight ?? 0));
    assert.ok(heights.every((height) => height > 100), `field and robots are ${heights} pixels high`);
    await shot(page, 'small');
    // of the agents, only the table is wider than the window
    await page.locator('h2').first().click();
    await page.keyboard.press('2');
    await page.locator('.plots').waitFor();
    for (const side of [0, 1000]) {
      const [panel, plots] = await page.locator('[aria-label=Agents] > .scroll').evaluate((rows, side) => {
        rows.scrollLeft = side;
        return ['[aria-label=Agents]', '.plots'].map((selector) => document.querySelector(selector).getBoundingClientRect().toJSON());
      }, side);
      assert.ok(plots.left >= panel.left && plots.right <= panel.right, `plots from ${plots.left} to ${plots.right}`);
    }
    await page.locator('[aria-label=Agents] > .scroll').evaluate((rows) => rows.scrollTo(0, 0));
    await shot(page, 'small-agents');
    await page.keyboard.press('1');
    await page.setViewportSize({ width: 1280, height: 720 });
  },

  async 'a page too many says why it shows nothing'({ page }) {
    const others = await page.evaluate(async () => {
      window.others = Array.from({ length: 7 }, () => new WebSocket(`ws://${location.host}/socket`));
      return Promise.all(window.others.map((socket) => new Promise((resolve) => (socket.onmessage = () => resolve(true)))));
    });
    assert.equal(others.length, 7);
    const ninth = await page.context().browser().newPage();
    await useBuiltPage(ninth);
    await ninth.goto(page.url());
    await until(ninth, 'the reason', () => /8 pages are open already. Close one/.test(document.querySelector('.notice')?.textContent ?? ''));
    assert.equal(await textOf(ninth, '.link'), 'Refused');
    await page.evaluate(() => window.others.forEach((socket) => socket.close()));
    await until(ninth, 'that it is served', () => document.querySelectorAll('.body').length === 6 && !document.querySelector('.notice'));
    await ninth.close();
  },

  async 'an end is said'({ page, run }) {
    const isRetry = (message) => message.type() === 'error' && /WebSocket/.test(message.text());
    const retry = page.waitForEvent('console', isRetry);
    await run.stop();
    const notice = () => /The studio has ended/.test(document.querySelector('.notice')?.textContent ?? '');
    await until(page, 'the notice', notice);
    await retry;
    await page.waitForEvent('console', isRetry);
    assert.ok(await page.evaluate(notice), 'a retry takes the reason back');
    assert.equal(await page.locator('.robots li').count(), 6);
    const timeline = page.getByRole('group', { name: 'Timeline' });
    assert.ok((await timeline.locator('button, select, input').count()) > 5);
    assert.equal(await timeline.locator(':is(button, select, input):enabled').count(), 0, 'nothing that has no effect is enabled');
    await shot(page, 'ended');
    await page.keyboard.press('3');
    await page.locator('tr.choice').first().click();
    await page.getByText('The studio does not answer: there are no messages.').waitFor();
  },
};

/** A studio beside runs: it shows that there is none, the next one, and its end. */
async function beside(browser) {
  const args = ['run', MATCH, '--control', 'side', '--realtime', '--for', '300s'];
  const first = start(PROGRAM, args);
  first.url.catch(() => {});
  await first.printed(/^control socket: /m);
  const studio = start(PROGRAM, ['studio', '--run', 'side'], first.folder);
  const { page } = await open(browser, await studio.url);
  await until(page, 'the run', () => document.querySelector('.link')?.textContent === 'Live');
  await until(page, 'its charts', () => document.querySelectorAll('.robots li').length === 6);
  assert.equal(await page.locator('.dial').count(), 0, 'a studio beside a run does not set its pace');
  await first.stop();
  await until(page, 'its end', () => document.querySelector('.link')?.textContent === 'Run ended');
  await page.getByText('What you see is its last moment').waitFor();
  const second = start(PROGRAM, args, first.folder);
  second.url.catch(() => {});
  await until(page, 'the next run', () => document.querySelector('.link')?.textContent === 'Live');
  await until(page, 'its robots', () => document.querySelectorAll('.body').length === 6);
  await second.stop();
  await studio.stop();
}

/** A tape: everything on the page follows the moment on the timeline. */
async function tape(browser) {
  const folder = mkdtempSync(join(tmpdir(), 'monas-tape-'));
  const file = join(folder, 'match.mcap');
  execFileSync(PROGRAM, ['run', MATCH, '--seed', '1', '--for', '60s', '--no-control', '--record', file], { stdio: 'ignore' });
  const studio = start(PROGRAM, ['studio', file]);
  const { page, faults } = await open(browser, await studio.url);
  await until(page, 'six charts', () => document.querySelectorAll('.robots li').length === 6);
  await page.locator('.play', { hasText: 'Hold' }).click();
  await until(page, 'the tape is held', () => document.querySelector('.play')?.textContent === 'Play');
  const time = async () => seconds(await textOf(page, '.time'));
  const seek = async (to) => {
    await page.getByLabel('Moment').fill(String(to));
    await until(page, `moment ${to}`, (to) => {
      const [minutes, rest] = (document.querySelector('.time')?.textContent ?? '').split(':').map(Number);
      return Math.abs(minutes * 60 + rest - to) < 0.06;
    }, to);
  };
  const place = () => page.locator('.body').evaluateAll((all) => all.map((one) => one.outerHTML.match(/translate\([^)]*\)/)?.[0]).join());
  const decided = () => textOf(page, '.why');
  const log = async () => {
    await page.keyboard.press('4');
    const lines = await page.locator('.line').allInnerTexts();
    await page.keyboard.press('1');
    return lines;
  };
  // the same moment is the same, from whichever side it is reached
  await seek(30);
  await until(page, 'robots', () => document.querySelectorAll('.body').length === 6);
  await until(page, 'a decision', () => /because/.test(document.querySelector('.why')?.textContent ?? ''));
  await page.locator('h2').first().click();
  const [first, why, lines] = [await place(), await decided(), await log()];
  await seek(50);
  await until(page, 'robots elsewhere', (first) => {
    const all = [...document.querySelectorAll('.body')];
    return all.map((one) => one.outerHTML.match(/translate\([^)]*\)/)?.[0]).join() !== first;
  }, first);
  await seek(30);
  await until(page, 'robots where they were', (first) => {
    const all = [...document.querySelectorAll('.body')];
    return all.map((one) => one.outerHTML.match(/translate\([^)]*\)/)?.[0]).join() === first;
  }, first);
  await page.locator('h2').first().click();
  assert.equal((await decided()).split(',')[0].split(' for ')[0], why.split(',')[0].split(' for ')[0]);
  assert.deepEqual(await log(), lines);
  // steps of the chosen chart, on and back
  const active = () => page.locator('.chart .node.active').evaluateAll((all) => all.map((one) => one.dataset.state).join());
  const activeIs = (what, states, isSame) =>
    until(
      page,
      what,
      ([states, isSame]) => {
        const now = [...document.querySelectorAll('.chart .node.active')].map((one) => one.dataset.state).join();
        return (now === states) === isSame;
      },
      [states, isSame],
    );
  const atMoment = await active();
  await page.keyboard.press('.');
  await activeIs('the next step', atMoment, false);
  const [atStep, stepTime] = [await active(), await time()];
  await page.keyboard.press('.');
  await activeIs('the step after it', atStep, false);
  await page.keyboard.press(',');
  await activeIs('the step before', atStep, true);
  assert.equal(await time(), stepTime);
  // events
  await seek(1);
  const events = await page.locator('.marks button').count();
  assert.ok(events > 0, 'the timeline has events');
  await page.getByRole('button', { name: 'event ›' }).click();
  await until(page, 'the kick-off', () => /kick-off/.test(document.querySelector('.latest')?.textContent ?? ''));
  assert.equal(await time(), 10.9);
  // keys mean the same while a button or the timeline has the focus
  const isAt = (clock) => until(page, clock, (clock) => document.querySelector('.time')?.textContent === clock, clock);
  await page.keyboard.press('ArrowRight');
  await isAt('0:11.9');
  await page.getByLabel('Moment').focus();
  await page.keyboard.press('ArrowLeft');
  await isAt('0:10.9');
  const title = await textOf(page, '.chart h2');
  await page.keyboard.press('j');
  await until(page, 'another chart', (title) => document.querySelector('.chart h2')?.textContent?.trim() !== title, title);
  await page.keyboard.press('k');
  // each event is reached from the one before, however near it is
  const places = await page.locator('.marks button').evaluateAll((all) => new Set(all.map((one) => one.style.left)).size);
  await seek(0);
  let reached = 0;
  for (; (await page.getByRole('button', { name: 'event ›' }).isEnabled()) && reached <= places; reached += 1) {
    const before = await page.getByLabel('Moment').inputValue();
    await page.keyboard.press(']');
    await until(page, 'the next event', (before) => document.querySelector('[aria-label=Moment]')?.value !== before, before);
  }
  assert.equal(reached, places);
  // playing
  await page.getByLabel('Speed', { exact: true }).selectOption('16');
  await page.locator('.play').click();
  await until(page, 'the tape is played to its end', () => document.querySelector('.play')?.textContent === 'Play' && document.querySelector('.time')?.textContent?.startsWith('1:00'));
  await seek(13.3);
  await page.locator('.robots button', { hasText: 'blue-2' }).click();
  await page.waitForTimeout(300);
  // the conditions of the kick, with the messages that they read
  await until(page, 'what the conditions read', () => /Ball\.distance = 0\.17/.test(document.querySelector('.reads')?.textContent ?? ''));
  assert.match(await textOf(page, '.reads'), /near = 0\.25[\s\S]*constant/);
  assert.match(await page.locator('.reads li', { hasText: 'Ball.distance' }).first().getAttribute('title'), /number \d+ on soccer\/ball by Attacker/);
  await shot(page, 'tape');
  // what the chart knew at this moment: the kick has begun, with the ball at the right foot
  await page.getByRole('button', { name: 'Values' }).click();
  await until(page, 'guards that hold, and others', () => {
    const signs = [...document.querySelectorAll('[aria-label=Guards] .sign')].map((sign) => sign.textContent);
    return signs.includes('✓') && signs.includes('✗');
  });
  const ball = page.locator('[aria-label=Blackboards] details', { hasText: 'soccer/ball' }).first();
  await ball.evaluate((details) => (details.open = true));
  assert.match(await ball.innerText(), /soccer\/ball\s+0:1\d\.\d\s+.*distance 0\.1/);
  const values = await textOf(page, '[aria-label=Timers]');
  assert.match(values, /decision_timeout/);
  await seek(20);
  await until(page, 'values of another moment', (before) => {
    const now = document.querySelector('[aria-label=Timers]')?.textContent;
    return now && now !== before;
  }, values);
  await seek(13.3);
  await page.getByRole('button', { name: 'Latest decisions' }).click();
  await whyNot(page, seek, time);
  // of agents a tape has cycles and steps, and says so
  await page.keyboard.press('2');
  await page.locator('tr.choice', { hasText: 'blue-2' }).click();
  assert.match(await textOf(page, '[aria-label=Agents]'), /A tape has cycles and steps/);
  assert.match(await textOf(page, '.details'), /A tape has no calls of activities/);
  assert.equal(await page.locator('.details table').count(), 0, 'no table without activities');
  await shot(page, 'tape-agents');
  assert.deepEqual(faults, []);
  await page.close();
  await studio.stop();
}

/** An event is raised by its name in the chart of an agent in real time. */
async function events(browser) {
  const folder = mkdtempSync(join(tmpdir(), 'monas-lamp-'));
  const role = 'Role: Lamp\nLiveness:\n  lamp = (Stand . LedHandler)~\nTransitions:\n  Stand -> LedHandler : whistle\n';
  writeFileSync(join(folder, 'lamp.srm'), role);
  writeFileSync(join(folder, 'lamp.xml'), '<agent><name>Lamp</name><statechart>lamp.srm</statechart></agent>\n');
  const run = start(PROGRAM, ['run', join(folder, 'lamp.xml'), '--studio', '--allow-control', '--for', '300s']);
  const { page, faults } = await open(browser, await run.url);
  const form = page.getByRole('form', { name: 'Raise an event' });
  await form.waitFor();
  assert.deepEqual(await form.locator('option').evaluateAll((all) => all.map((one) => one.value)), ['whistle']);
  await form.getByLabel('Event').fill('whistle');
  await page.keyboard.press('Enter');
  await form.locator('.outcome', { hasText: 'event whistle: done' }).waitFor();
  await form.getByLabel('Event').fill('shout');
  await page.keyboard.press('Enter');
  await form.locator('.outcome', { hasText: /refused.*names the event `shout`/ }).waitFor();
  await shot(page, 'event');
  assert.deepEqual(faults, []);
  await page.close();
  await run.stop();
}

/** Two futures of a match on one timeline. */
async function besides(browser) {
  const folder = mkdtempSync(join(tmpdir(), 'monas-tapes-'));
  const [file, other] = ['match.mcap', 'other.mcap'].map((name) => join(folder, name));
  execFileSync(PROGRAM, ['run', MATCH, '--seed', '1', '--for', '20s', '--no-control', '--record', file], { stdio: 'ignore' });
  const guard = ['--at', '12.55s', '--guard', 'CONDITION -> kickBall=[false]', '--host', 'blue-2'];
  execFileSync(PROGRAM, ['tape', 'what-if', file, ...guard, '-o', other], { stdio: 'ignore' });
  const studio = start(PROGRAM, ['studio', file, '--beside', other]);
  const { page, faults } = await open(browser, await studio.url);
  await until(page, 'two fields', () => document.querySelectorAll('.side svg').length === 2);
  await page.locator('.play', { hasText: 'Hold' }).click();
  const places = (side) => page.locator('.side').nth(side).locator('.body').evaluateAll((all) => all.map((one) => one.outerHTML.match(/translate\([^)]*\)/)?.[0]).join());
  const seek = async (to) => {
    await page.getByLabel('Moment').fill(String(to));
    await until(page, `moment ${to}`, (to) => {
      const [minutes, rest] = (document.querySelector('.time')?.textContent ?? '').split(':').map(Number);
      return Math.abs(minutes * 60 + rest - to) < 0.06;
    }, to);
    await page.waitForTimeout(500);
  };
  await seek(12.3);
  assert.match(await textOf(page, '.difference'), /First difference at 0:12\.6: soccer\/motion number \d+ by Attacker of blue-2/);
  await until(page, 'robots on both', () => document.querySelectorAll('.body').length === 12);
  assert.equal(await places(0), await places(1));
  assert.equal(await page.locator('.differs').count(), 0);
  await page.getByRole('button', { name: 'go there' }).click();
  await until(page, 'the difference', () => document.querySelector('.time')?.textContent === '0:12.6');
  await seek(13.3);
  const row = page.locator('tr.choice', { hasText: 'blue-2' });
  await row.getByText('≠').waitFor();
  await row.click();
  const list = (side) => page.locator('.list').nth(side).innerText();
  assert.match(await list(0), /kickBall|Kick/);
  assert.doesNotMatch((await list(1)).split('\n')[0], /Kick/);
  await shot(page, 'beside');
  await seek(18);
  assert.notEqual(await places(0), await places(1));
  await seek(12.3);
  assert.equal(await places(0), await places(1), 'the same when reached backwards');
  assert.deepEqual(faults, []);
  await page.close();
  await studio.stop();
}

/** A transition that does not fire, its values, the messages behind them, and its firings. */
async function whyNot(page, seek, time) {
  await seek(13.1);
  await page.locator('.robots button', { hasText: 'blue-2' }).click();
  const arrow = page.locator('[data-choice][aria-label*="takeAction/WalkTowardsBall [Ball.distance > near"]').first();
  await arrow.focus();
  await page.keyboard.press('Enter');
  await until(page, 'what fired instead', () => /instead of it fired .*kickBall/.test(document.querySelector('.why .reason')?.textContent ?? ''));
  assert.match(await textOf(page, '.atoms li.false'), /✗\s+Ball\.distance > near/);
  assert.match(await textOf(page, '.atoms li.false .read'), /Ball\.distance = 0\.1748/);
  assert.equal(await page.locator('.atoms li.true').count(), 2);
  await page.locator('.why details summary').first().click();
  assert.match(await textOf(page, '.why .chain'), /soccer\/ball[\s\S]*by Vision of Attacker on blue-2[\s\S]*body\/sensors[\s\S]*comes from outside/);
  await shot(page, 'why-not');
  await page.getByRole('button', { name: 'firing ›' }).click();
  await until(page, 'that it fired', () => document.querySelector('.why .now')?.textContent === 'Fired');
  assert.ok((await time()) > 14, 'its next firing');
  await page.locator('h2').first().click();
  await page.keyboard.press('<');
  await until(page, 'its last firing', () => (document.querySelector('.time')?.textContent ?? '').startsWith('0:1'));
  // events of one kind
  await page.getByLabel('Kind of events').selectOption('kick-off');
  await page.getByRole('button', { name: '‹ event' }).click();
  await until(page, 'the kick-off before', () => /0:10\.9/.test(document.querySelector('.time')?.textContent ?? ''));
  await page.locator('.why button', { hasText: 'back to now' }).click();
}

/** A run that pages may change: agents, messages, the referee, events; and one that they may not. */
async function steering(browser) {
  const run = start(PROGRAM, ['run', MATCH, '--studio', '--allow-control', '--pace', '0.05', '--seed', '1', '--for', '600s']);
  const { page, faults } = await open(browser, await run.url);
  await until(page, 'six charts', () => document.querySelectorAll('.robots li').length === 6);
  // the referee, by keyboard alone
  await page.getByRole('button', { name: 'Ready', exact: true }).focus();
  await page.keyboard.press('Enter');
  await until(page, 'READY', () => /ready/.test(document.querySelector('.panel header')?.textContent ?? ''));
  for (const [button, state] of [['Set', 'set'], ['Play', 'playing']]) {
    await page.getByRole('button', { name: button, exact: true }).click();
    await until(page, state, (state) => document.querySelector('.panel header')?.textContent?.includes(state), state);
  }
  await page.getByRole('button', { name: '1×' }).click();
  await page.locator('.robots button', { hasText: 'blue-2' }).click();
  await page.getByRole('button', { name: 'Penalize blue-2' }).click();
  await until(page, 'a robot off the field', () => document.querySelectorAll('.body.out').length === 1);
  await shot(page, 'referee');
  await page.getByRole('button', { name: 'Return blue-2' }).click();
  await until(page, 'all on the field', () => document.querySelectorAll('.body.out').length === 0);
  await page.getByRole('button', { name: 'Stop', exact: true }).click();
  await page.getByRole('button', { name: 'Resume', exact: true }).click();
  // an agent is paused, stepped and resumed
  await page.keyboard.press('2');
  await page.locator('tr.choice', { hasText: 'blue-2' }).click();
  const control = page.getByRole('region', { name: /Control Attacker of blue-2/ });
  const state = () => page.locator('tr.choice', { hasText: 'blue-2' }).locator('td').nth(2).innerText();
  const outcome = (pattern) => control.locator('.outcome', { hasText: pattern }).waitFor();
  const button = (name) => control.getByRole('button', { name, exact: true });
  const steps = () => page.locator('tr.choice', { hasText: 'blue-2' }).locator('td').nth(6).innerText();
  await button('Pause').click();
  await outcome(/pause: done/);
  await page.locator('tr.choice', { hasText: 'blue-2' }).getByText('pauses').waitFor();
  await page.waitForTimeout(1500);
  const before = await steps();
  await page.waitForTimeout(1500);
  assert.equal(await steps(), before, 'a paused agent makes no steps');
  await button('Step').click();
  await outcome(/step: done/);
  await shot(page, 'control');
  await button('Resume').click();
  await outcome(/resume: done/);
  await page.locator('tr.choice', { hasText: 'blue-2' }).getByText('runs').waitFor();
  assert.equal(await state(), 'runs');
  await control.getByLabel('Parameter name').fill('WalkTowardsBall.nonsense');
  await control.getByLabel('Value', { exact: true }).fill('1');
  await control.getByRole('button', { name: 'Set', exact: true }).click();
  await outcome(/refused.*nonsense/);
  // a model of its own, and one that is none
  const model = (name, text) => control.getByLabel('File of the model').setInputFiles({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });
  await model('broken.srm', 'Liveness:\n  x = (');
  await control.getByRole('button', { name: 'Replace', exact: true }).click();
  await outcome(/broken\.srm:\d+:\d+/);
  const attacker = readFileSync(new URL('../../../../models/attacker.srm', import.meta.url), 'utf8');
  await model('attacker.srm', attacker);
  await control.getByRole('button', { name: 'Replace', exact: true }).click();
  await outcome(/swap to attacker\.srm: done/);
  // a parameter of an activity, whose name is completed
  assert.equal(await control.locator('option[value="MotionController."]').count(), 1);
  await control.getByLabel('Parameter name').fill('MotionController.walk_forward');
  await control.getByLabel('Value', { exact: true }).fill('0.2');
  await control.getByRole('button', { name: 'Set', exact: true }).click();
  await outcome(/walk_forward=0\.2: done/);
  // the chart of an agent that was removed says so, and agents can be added to its host again
  await page.locator('tr.choice', { hasText: 'blue-3' }).click();
  const removal = page.getByRole('region', { name: /Control Attacker of blue-3/ }).getByRole('button', { name: /^Remove/ });
  await removal.click();
  await removal.click();
  await until(page, 'five agents', () => document.querySelectorAll('tr.choice').length === 5);
  assert.ok((await page.locator('[aria-label="Host of the agents"] option').allTextContents()).includes('blue-3'));
  await page.locator('h2').first().click();
  await page.keyboard.press('1');
  await page.locator('.robots button', { hasText: 'blue-3' }).getByText('no agent').waitFor();
  assert.equal(await page.locator('.robots .state').count(), 1);
  // a message by form
  await page.locator('h2').first().click();
  await page.keyboard.press('3');
  await page.getByLabel('Filter topics').fill('soccer/ball');
  await page.locator('tr.choice', { hasText: 'red-1' }).click();
  const form = page.getByRole('form', { name: 'Publish' });
  const publishing = page.locator('summary', { hasText: 'Publish' });
  await page.locator('.leaf', { hasText: 'distance' }).first().waitFor();
  assert.equal(await form.count(), 0, 'first the message is shown');
  await publishing.click();
  await form.getByLabel('distance').fill('far');
  await form.getByRole('button', { name: /Publish on red-1/ }).click();
  await form.locator('.outcome', { hasText: 'distance is not a number' }).waitFor();
  await page.getByRole('button', { name: 'Close' }).click();
  await page.getByLabel('Filter topics').fill('sim/referee');
  await page.locator('tr.choice', { hasText: 'sim/referee' }).filter({ hasText: 'field' }).click();
  await publishing.click();
  await form.getByLabel('kind').selectOption('STOP');
  await form.getByLabel('number').fill('3');
  await form.getByRole('button', { name: /Publish on field/ }).click();
  await form.locator('.outcome', { hasText: 'publish: done' }).waitFor();
  await until(page, 'the message in the tree', () => /kind\s*"STOP"/.test(document.querySelector('.message')?.textContent ?? ''));
  await until(page, 'its number', () => /number\s*3/.test(document.querySelector('.message')?.textContent ?? ''));
  await shot(page, 'publish');
  // held simulated time takes requests too
  await page.locator('h2').first().click();
  await page.keyboard.press(' ');
  await until(page, 'the run is held', () => document.querySelector('.link')?.textContent === 'Held');
  await page.waitForTimeout(3000);
  await form.getByLabel('kind').selectOption('RESUME');
  await form.getByRole('button', { name: /Publish on field/ }).click();
  await until(page, 'a message while held', () => /kind\s*"RESUME"/.test(document.querySelector('.message')?.textContent ?? ''));
  assert.equal(await textOf(page, '.link'), 'Held');
  // looking back there are no controls
  await page.locator('h2').first().click();
  await page.keyboard.press(' ');
  await page.getByLabel('Moment').fill('3');
  await until(page, 'a moment before', () => document.querySelector('.link')?.textContent === 'Looking back');
  assert.equal(await publishing.count(), 0);
  assert.equal(await page.getByText('may control').count(), 0);
  assert.deepEqual(faults, []);
  await page.close();
  await run.stop();

  const plain = start(PROGRAM, ['run', MATCH, '--studio', '--seed', '1', '--for', '600s']);
  const { page: looking } = await open(browser, await plain.url);
  await until(looking, 'six charts', () => document.querySelectorAll('.robots li').length === 6);
  for (const [key, what] of [['1', 'Referee'], ['2', /Control/]]) {
    await looking.keyboard.press(key);
    if (key === '2') {
      await looking.locator('tr.choice', { hasText: 'blue-2' }).click();
      await looking.locator('.inner').waitFor();
    }
    assert.equal(await looking.getByRole('region', { name: what }).count(), 0);
  }
  assert.equal(await looking.getByText('may control').count(), 0);
  const reply = await looking.evaluate(
    () =>
      new Promise((resolve) => {
        const socket = new WebSocket(`ws://${location.host}/socket`);
        socket.onopen = () => socket.send(JSON.stringify({ type: 'change', id: 5, host: 'blue-2', agent: 'Attacker', action: 'pause' }));
        socket.onmessage = (event) => {
          const message = JSON.parse(event.data);
          if (message.type === 'reply') {
            resolve(message);
          }
        };
      }),
  );
  assert.equal(reply.done, false);
  assert.match(reply.reason, /--allow-control/);
  await looking.waitForTimeout(1500);
  assert.equal(await looking.locator('tr.choice', { hasText: 'blue-2' }).locator('td').nth(2).innerText(), 'runs');
  await looking.close();
  await plain.stop();
}

mkdirSync(SCREENSHOTS, { recursive: true });
/** The images of the cameras of the chosen robot, on a tape. */
async function cameras(browser) {
  const tape = join(mkdtempSync(join(tmpdir(), 'monas-images-')), 'images.mcap');
  const images = fileURLToPath(new URL('../../../../config/match_images.xml', import.meta.url));
  // play begins at once, with which robots begin to look
  const rules = ['initial', 'ready', 'set'].flatMap((phase) => ['--set', `simulator.rules.${phase}_duration=0`]);
  execFileSync(PROGRAM, ['run', images, ...rules, '--for', '1s', '--no-control', '--record', tape], { stdio: 'ignore' });
  const studio = start(PROGRAM, ['studio', tape]);
  try {
    const { page, faults } = await open(browser, await studio.url);
    await until(page, 'two images with pixels', () => {
      const shown = [...document.querySelectorAll('.camera img')];
      return shown.length === 2 && shown.every((image) => image.complete && image.naturalWidth === 320);
    });
    await until(page, 'the end of the tape', () => document.querySelector('.play')?.textContent === 'Play');
    // the lines that the chosen robot sees lie on those of the field
    await until(page, 'lines that are seen', () => document.querySelectorAll('line.seen').length >= 3);
    const away = await page.evaluate(() => {
      const number = (line, name) => Number(line.getAttribute(name));
      // goal lines, middle line, fronts of the goal areas; touch lines, sides of the goal areas
      const off = (x, y) => Math.min(
        ...[3, 2.4, 0].map((at) => Math.abs(Math.abs(x) - at)),
        ...[2, 1.1].map((at) => Math.abs(Math.abs(y) - at)),
        Math.abs(Math.hypot(x, y) - 0.6),
      );
      return [...document.querySelectorAll('line.seen')].map((line) =>
        off((number(line, 'x1') + number(line, 'x2')) / 2, (number(line, 'y1') + number(line, 'y2')) / 2));
    });
    const near = away.filter((distance) => distance < 0.25);
    assert.ok(near.length >= 0.8 * away.length, `middles of seen lines are ${away} m off`);
    await page.getByLabel('Whose beliefs are shown').selectOption('all');
    await until(page, 'the lines of all', (least) => document.querySelectorAll('line.seen').length > least, away.length);
    await page.getByLabel('Whose beliefs are shown').selectOption('none');
    await until(page, 'no lines', () => document.querySelectorAll('line.seen').length === 0);
    await page.getByLabel('Whose beliefs are shown').selectOption('chosen');
    await until(page, 'the lines again', () => document.querySelectorAll('line.seen').length > 0);
    await shot(page, 'seen-lines');
    const title = await textOf(page, '.camera h2');
    await page.keyboard.press('j');
    await until(page, 'the images of another robot', (before) => {
      const now = document.querySelector('.camera h2')?.textContent;
      return now && now !== before && document.querySelectorAll('.camera img').length === 2;
    }, title);
    await shot(page, 'cameras');
    assert.deepEqual(faults, []);
    await page.close();
  } finally {
    await studio.stop();
  }
}

const browser = await launch();
/** With ONLY=words, only the parts with these words in their names. */
const ONLY = process.env.ONLY ?? '';
const run = start(PROGRAM, ['run', MATCH, '--studio', '--seed', '1', '--for', '600s']);
let failed = 0;
const check = async (name, test) => {
  if (!name.includes(ONLY)) {
    return;
  }
  try {
    await test();
    console.log(`ok      ${name}`);
  } catch (error) {
    failed += 1;
    console.error(`FAILED  ${name}\n${error.stack}`);
  }
};
try {
  const { page, faults } = await open(browser, await run.url);
  for (const [name, test] of Object.entries(TESTS)) {
    if (name === 'an end is said') {
      await check('no error on the page, no request elsewhere', () => assert.deepEqual(faults, []));
    }
    await check(name, () => test({ page, run }));
  }
  await page.close();
  await check('a studio beside runs follows them', () => beside(browser));
  await check('a tape is played, searched and stepped', () => tape(browser));
  await check('two tapes are shown on one timeline', () => besides(browser));
  await check('the cameras of a robot are shown, and the lines that it sees', () => cameras(browser));
  await check('an event is raised by its name', () => events(browser));
  await check('a run is steered only with permission', () => steering(browser));
  if ('editor'.includes(ONLY) || ONLY.startsWith('editor')) {
    await testEditor({ program: PROGRAM, browser, open, screenshots: SCREENSHOTS, check });
  }
} finally {
  await browser.close();
  await run.stop();
}
process.exit(failed === 0 ? 0 : 1);
