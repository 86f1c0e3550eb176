// The editor of models in headless Chromium, on copies of real models and on a real run:
// `MONAS=path/to/monas npm test`. Screenshots are written to tests/screenshots.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { start } from './browser.mjs';

const project = (path) => fileURLToPath(new URL(`../../../../${path}`, import.meta.url));
const MODELS = {
  'attacker.srm': project('models/attacker.srm'),
  'extended_attacker.iac': project('models/extended_attacker.iac'),
  'attack.aip': project('models/attack.aip'),
  'goals.sag': project('methodology/aseme-models/tests/golden/goals/in.sag'),
  'cases.suc': project('methodology/aseme-models/tests/golden/roles/in.suc'),
  'roles.srm': project('methodology/aseme-models/tests/golden/table/in.srm'),
};
/** A file whose lines end in different ways. */
const MIXED = 'Liveness:\r\n  a = B\n';
const SOON = Number(process.env.SOON ?? 60_000);

async function until(page, what, condition, argument) {
  await page.waitForFunction(condition, argument, { timeout: SOON }).catch(() => assert.fail(`not within a minute: ${what}`));
}

const original = (name) => readFileSync(MODELS[name], 'utf8');
const saved = (folder, name) => readFileSync(join(folder, name), 'utf8');

/** The whole text of the editor: it draws only what is in view. */
const textOf = (page) => page.evaluate(() => document.querySelector('.code-area .cm-content').cmTile?.view.state.doc.toString() ?? document.querySelector('.code-area .cm-content').cmView.view.state.doc.toString());

/** Puts the cursor behind the first occurrence of a text, as if it was found there. */
async function goBehind(page, wanted) {
  const at = (await textOf(page)).indexOf(wanted);
  assert.ok(at >= 0, `${wanted} is in the text`);
  await page.evaluate((position) => {
    const content = document.querySelector('.code-area .cm-content');
    const view = content.cmTile?.view ?? content.cmView.view;
    view.dispatch({ selection: { anchor: position }, scrollIntoView: true });
    view.focus();
  }, at + wanted.length);
}

/** The text of the model, of which the editor draws only what is in view, once it fits a pattern. */
async function untilText(page, what, pattern) {
  await until(
    page,
    what,
    (source) => {
      const content = document.querySelector('.code-area .cm-content');
      const view = content.cmTile?.view ?? content.cmView.view;
      return new RegExp(source).test(view.state.doc.toString());
    },
    pattern.source,
  );
}

async function openModel(page, name) {
  const select = page.locator('select[aria-label="Model"]');
  const value = await select.locator('option', { hasText: name }).getAttribute('value');
  await select.selectOption(value);
  await until(page, `${name} is shown`, (file) => document.querySelector('select[aria-label="Model"]')?.selectedOptions[0]?.textContent?.endsWith(file) && document.querySelector('.code-area .cm-line')?.textContent !== '', name);
}

async function save(page) {
  await page.keyboard.press('Control+s');
  await until(page, 'it is saved', () => /saved/.test(document.querySelector('.editor .outcome')?.textContent ?? '') && !/not saved/.test(document.querySelector('.editor header')?.textContent ?? ''));
}

/** The lines that differ between two texts. */
function difference(before, after) {
  const [old, next] = [before.split('\n'), after.split('\n')];
  const known = new Set(old);
  const kept = new Set(next);
  return { gone: old.filter((line) => !kept.has(line)), added: next.filter((line) => !known.has(line)) };
}

/** Holds the next request of an edit back, as a slow connection does. Returns a function that sends it. */
async function holdEdit(page) {
  await page.evaluate(() => {
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (data) {
      if (/"type":"model edit"/.test(data)) {
        WebSocket.prototype.send = send;
        window.sendHeld = () => this.send(data);
      } else {
        send.call(this, data);
      }
    };
  });
  return async () => {
    await until(page, 'the edit is requested', () => window.sendHeld);
    await page.evaluate(() => {
      window.sendHeld();
      delete window.sendHeld;
    });
  };
}

const TESTS = {
  async 'a role is opened: its text, its chart, and what the check says'({ page, shot }) {
    await until(page, 'the chart', () => document.querySelectorAll('.drawing .node.BASIC').length > 10);
    await until(page, 'the check', () => /nothing found by the check/.test(document.querySelector('.findings')?.textContent ?? ''));
    assert.equal(await textOf(page), original('attacker.srm'));
    await shot('editor');
  },

  async 'the chart is redrawn as a formula is typed, and half a formula shows what is understood'({ page, shot }) {
    await goBehind(page, 'roam = TurnAround | WalkTowardsCentre');
    await page.keyboard.type(' | Rest');
    await page.keyboard.press('Escape');
    await until(page, 'the new state', () => document.querySelector('.drawing [data-state$="Rest"]'));
    await page.keyboard.type(' | (');
    await until(page, 'an error in its place', () => document.querySelector('.code-area .cm-lintRange-error') && /E02\d\d/.test(document.querySelector('.findings ul')?.textContent ?? ''));
    assert.ok((await page.locator('.drawing .node.BASIC').count()) > 10, 'what is understood is drawn');
    await shot('editor-half');
    const place = await page.locator('.findings .finding .place').first().innerText();
    assert.match(place, /^\d+:\d+$/);
  },

  async 'a finding leads to its line'({ page }) {
    await goBehind(page, 'Role: attacker');
    const line = Number((await page.locator('.findings .finding .place').first().innerText()).split(':')[0]);
    await page.locator('.findings .finding').first().click();
    await until(page, 'the cursor is there', (wanted) => {
      const content = document.querySelector('.code-area .cm-content');
      const { state } = content.cmTile?.view ?? content.cmView.view;
      return state.doc.lineAt(state.selection.main.head).number === wanted;
    }, line);
  },

  async 'undo and redo are those of the text'({ page }) {
    for (let presses = 0; presses < 60 && (await page.locator('button', { hasText: 'Undo' }).isEnabled()); presses += 1) {
      await page.locator('button', { hasText: 'Undo' }).click();
    }
    assert.equal(await textOf(page), original('attacker.srm'));
    await page.locator('button', { hasText: 'Redo' }).click();
    assert.notEqual(await textOf(page), original('attacker.srm'));
    await page.locator('button', { hasText: 'Undo' }).click();
    await until(page, 'the first chart', () => !document.querySelector('.drawing [data-state$="Rest"]') && document.querySelector('.drawing .node.BASIC'));
  },

  async 'topics, fields, functions and activities are completed'({ page, shot }) {
    await goBehind(page, 'CONDITION -> LeftKick : [Ball.y >= 0');
    await page.keyboard.type(' && Ball.');
    await until(page, 'fields', () => [...document.querySelectorAll('.cm-tooltip-autocomplete li')].some((one) => one.textContent?.includes('distance')));
    await shot('editor-completion');
    await page.keyboard.type('dist');
    await until(page, 'the field alone', () => /^distance/.test(document.querySelector('.cm-tooltip-autocomplete li')?.textContent ?? ''));
    await page.waitForTimeout(150);
    await page.keyboard.press('Enter');
    assert.match(await textOf(page), /CONDITION -> LeftKick : \[Ball\.y >= 0 && Ball\.distance\]/);
    await page.keyboard.type(' > ab');
    await until(page, 'functions', () => [...document.querySelectorAll('.cm-tooltip-autocomplete li')].some((one) => one.textContent?.startsWith('abs(')));
    await page.keyboard.press('Escape');
    await goBehind(page, 'roam = TurnAround | ');
    await page.keyboard.type('Walk');
    await until(page, 'activities', () => [...document.querySelectorAll('.cm-tooltip-autocomplete li')].some((one) => one.textContent?.startsWith('WalkTowardsGoal')));
    await page.keyboard.press('Escape');
    for (let presses = 0; presses < 60 && (await page.locator('button', { hasText: 'Undo' }).isEnabled()); presses += 1) {
      await page.locator('button', { hasText: 'Undo' }).click();
    }
  },

  async 'a transition is chosen in the drawing, edited there, checked, and saved with all comments'({ page, folder, shot }) {
    await until(page, 'the first chart', () => document.querySelector('.drawing [data-state$="LeftKick"]'));
    await page.locator('.drawing polyline.target[aria-label*="LeftKick Ball.y"], .drawing polyline.target[aria-label*="LeftKick [Ball.y"]').first().focus();
    await page.keyboard.press('Enter');
    const expression = page.locator('.inspector .cm-content');
    await until(page, 'its expression', () => /Ball\.y >= 0/.test(document.querySelector('.inspector .cm-content')?.textContent ?? ''));
    await expression.click();
    await page.keyboard.press('Control+a');
    await page.keyboard.type('[Ball.y >= zero]');
    await page.keyboard.press('Escape');
    await page.keyboard.press('Enter');
    await until(page, 'the check in place', () => /zero/.test(document.querySelector('.inspector p.bad')?.textContent ?? ''));
    await shot('editor-transition');
    await expression.click();
    await page.keyboard.press('Control+a');
    await page.keyboard.type('[0 < Ball.y]');
    await save(page);
    assert.match(saved(folder, 'attacker.srm'), /CONDITION -> LeftKick : \[0 < Ball\.y\]/);
    await expression.click();
    await page.keyboard.press('Control+a');
    await page.keyboard.type('[0 <= Ball.y]');
    await page.keyboard.press('Escape');
    await page.keyboard.press('Enter');
    await until(page, 'no finding', () => /nothing found by the check/.test(document.querySelector('.findings')?.textContent ?? ''));
    await save(page);
    const changed = difference(original('attacker.srm'), saved(folder, 'attacker.srm'));
    assert.deepEqual(changed, { gone: ['CONDITION -> LeftKick : [Ball.y >= 0]'], added: ['CONDITION -> LeftKick : [0 <= Ball.y]'] });
  },

  async 'a file that another program changes is not overwritten'({ page, folder, shot }) {
    const theirs = saved(folder, 'attacker.srm').replace('near = 0.25 ', 'near = 0.20 ');
    writeFileSync(join(folder, 'attacker.srm'), theirs);
    await goBehind(page, 'certain = 0.85');
    await page.keyboard.type('1');
    await page.keyboard.press('Control+s');
    await until(page, 'the conflict', () => document.querySelector('.conflict'));
    await page.locator('.conflict button', { hasText: 'Compare' }).click();
    const lines = await page.locator('.conflict pre').innerText();
    assert.match(lines, /- \d+ near = 0\.20/);
    assert.match(lines, /\+ \d+ certain = 0\.851/);
    await shot('editor-conflict');
    assert.equal(saved(folder, 'attacker.srm'), theirs);
    await page.locator('.conflict button', { hasText: 'Reload' }).click();
    await until(page, 'theirs is shown', () => !document.querySelector('.conflict'));
    assert.equal(await textOf(page), theirs);
  },

  async 'a state of a role is renamed and gets a setting'({ page, folder }) {
    await page.locator('.drawing [data-state$="SupportMate"]').first().click();
    const name = page.locator('.inspector input.name');
    await name.fill('HelpMate');
    await name.press('Enter');
    await until(page, 'its new name', () => document.querySelector('.drawing [data-state$="HelpMate"]'));
    await page.locator('#setting-activity').fill('SupportMate');
    await page.locator('#setting-activity').press('Enter');
    await until(page, 'its setting', () => /nothing found by the check/.test(document.querySelector('.findings')?.textContent ?? ''));
    await save(page);
    const text = saved(folder, 'attacker.srm');
    assert.ok(text.includes('CONDITION -> HelpMate : [') && text.includes('\nStates:\nHelpMate : activity = SupportMate\n'), text);
  },

  async 'the entries of a role are a form'({ page, folder, shot }) {
    await page.locator('.drawing [role=tab]', { hasText: 'Form' }).click();
    const near = page.locator('input[aria-label="Constants: near"]');
    await near.fill('near = 30 cm');
    await near.press('Enter');
    await untilText(page, 'the text has it', /near = 30 cm\s+# metres/);
    const sendEdit = await holdEdit(page);
    await near.fill('near = 32 cm');
    await near.press('Enter');
    await near.fill('near = 31 cm');
    await sendEdit();
    await untilText(page, 'the text has the first edit', /near = 32 cm\s+# metres/);
    assert.equal(await near.inputValue(), 'near = 31 cm', 'the second edit is still typed');
    await save(page);
    assert.match(saved(folder, 'attacker.srm'), /near = 31 cm {13}# metres; below this distance/);
    await near.fill('near = 30 cm');
    await near.press('Enter');
    await untilText(page, 'the text has it again', /near = 30 cm\s+# metres/);
    const table = await page.locator('.form table').innerText();
    assert.match(table, /LeftKick\s+.*(Narukom|hardware)/);
    await shot('editor-role-form');
    await save(page);
    assert.match(saved(folder, 'attacker.srm'), /near = 30 cm {13}# metres; below this distance/);
    await page.locator('.drawing [role=tab]', { hasText: 'Drawing' }).click();
  },

  async 'nodes and transitions of a chart are added and removed in the drawing'({ page, folder, shot }) {
    await openModel(page, 'extended_attacker.iac');
    await until(page, 'the chart', () => document.querySelector('.drawing [data-state$="LeftKick"]'));
    const choose = async (name) => {
      const option = page.locator('select[aria-label="Choose a state"] option', { hasText: name }).first();
      await page.locator('select[aria-label="Choose a state"]').selectOption(await option.getAttribute('value'));
    };
    await choose('kickBall (OR)');
    await page.locator('select[aria-label="Kind of the new state"]').selectOption('JUNCTION');
    await page.locator('input[aria-label="Name of the new state"]').fill('either');
    await page.locator('button', { hasText: 'Add inside' }).click();
    await until(page, 'the junction', () => document.querySelector('.drawing .node.JUNCTION'));
    await page.locator('.drawing .node.JUNCTION').first().focus();
    await page.keyboard.press('Enter');
    await page.locator('.inspector button', { hasText: 'Connect' }).click();
    await page.locator('.drawing [data-state$="LeftKick"]').first().click();
    await until(page, 'the transition', () => document.querySelector('.drawing polyline.target[aria-label*="either to"]'));
    await shot('editor-chart');
    await save(page);
    const added = difference(original('extended_attacker.iac'), saved(folder, 'extended_attacker.iac'));
    assert.deepEqual([added.gone, added.added.length], [[], 2], JSON.stringify(added));
    assert.match(added.added.join('\n'), /either JUNCTION\n.*either -> .*LeftKick/);
    await page.locator('.drawing .node.JUNCTION').first().focus();
    await page.keyboard.press('Enter');
    if ((await page.locator('.inspector button', { hasText: 'Remove' }).count()) === 0) {
      await page.keyboard.press('Enter');
    }
    await page.locator('.inspector button', { hasText: 'Remove' }).click();
    await until(page, 'it is gone', () => !document.querySelector('.drawing .node.JUNCTION'));
    await save(page);
    assert.equal(saved(folder, 'extended_attacker.iac'), original('extended_attacker.iac'));
  },

  async 'goals, use cases and protocols are forms'({ page, folder, shot }) {
    await openModel(page, 'goals.sag');
    await page.locator('input[aria-label="Name of the new Goal"]').fill('Rest');
    await page.locator('button', { hasText: 'Add Goal' }).click();
    await until(page, 'the goal', () => document.querySelector('[aria-label="Goal Rest"]'));
    await page.locator('[aria-label="Goal Rest"] select').first().selectOption({ index: 1 });
    await until(page, 'nothing is wrong with it', () => /nothing found|0 errors/.test(document.querySelector('.findings')?.textContent ?? ''));
    await shot('editor-goals');
    await save(page);
    const goals = difference(original('goals.sag'), saved(folder, 'goals.sag'));
    assert.deepEqual(goals.gone, []);
    assert.match(goals.added.join('\n'), /Goal: Rest/);

    await openModel(page, 'cases.suc');
    await page.locator('fieldset', { hasText: 'Role' }).first().locator('select').first().selectOption('Human');
    await untilText(page, 'its kind', /type = Human/);
    await save(page);
    assert.match(saved(folder, 'cases.suc'), /type = Human/);

    await openModel(page, 'attack.aip');
    const liveness = page.locator('[aria-label="Participant center_for"] textarea');
    const sendEdit = await holdEdit(page);
    await liveness.fill('WalkTowardsGoal . WalkTowardsBall');
    await liveness.press('Tab');
    await liveness.fill('WalkTowardsGoal . [WalkTowardsBall . AssessAttack]');
    await sendEdit();
    await untilText(page, 'the first formula', /WalkTowardsGoal \. WalkTowardsBall\n/);
    assert.equal(await liveness.inputValue(), 'WalkTowardsGoal . [WalkTowardsBall . AssessAttack]', 'the second is still typed');
    await liveness.press('Tab');
    await untilText(page, 'the formula', /WalkTowardsGoal \. \[WalkTowardsBall \. AssessAttack\]/);
    await save(page);
    const protocol = difference(original('attack.aip'), saved(folder, 'attack.aip'));
    assert.deepEqual(protocol, { gone: ['    WalkTowardsGoal . [WalkTowardsBall . AssessAttack . [kickBall]]'], added: ['    WalkTowardsGoal . [WalkTowardsBall . AssessAttack]'] });
  },

  async 'the functionality table of a system is edited by its cells'({ page, folder, shot }) {
    await openModel(page, 'roles.srm');
    const cell = page.locator('table[aria-label="Functionality table"] input[aria-label^="technology"]').first();
    await cell.fill('Rust');
    await cell.press('Enter');
    await untilText(page, 'the text has it', /technology = Rust/);
    await shot('editor-table');
    await save(page);
    assert.match(saved(folder, 'roles.srm'), /technology = Rust/);
  },

  async 'each file keeps its own text and changes, whatever was shown between'({ page, folder }) {
    await openModel(page, 'roles.srm');
    await openModel(page, 'attack.aip');
    await openModel(page, 'roles.srm');
    assert.equal(await textOf(page), saved(folder, 'roles.srm'));
    await goBehind(page, 'Role');
    await page.keyboard.type('X');
    await page.keyboard.press('Escape');
    const changed = await textOf(page);
    await openModel(page, 'attack.aip');
    assert.equal(await textOf(page), saved(folder, 'attack.aip'));
    const header = () => page.locator('.panel.text header').innerText();
    assert.match(await header(), /1 other file not saved/);
    const isWarned = () => page.evaluate(() => !window.dispatchEvent(new Event('beforeunload', { cancelable: true })));
    assert.ok(await isWarned(), 'another file has changes');
    await openModel(page, 'roles.srm');
    assert.equal(await textOf(page), changed);
    await page.locator('button', { hasText: 'Undo' }).click();
    assert.equal(await textOf(page), saved(folder, 'roles.srm'));
    assert.ok(!(await isWarned()), 'nothing has changes');
  },

  async 'what is typed in a field is kept when another file is chosen at once'({ page, folder }) {
    await openModel(page, 'attacker.srm');
    await until(page, 'the chart', () => document.querySelector('.drawing [data-state$="RightKick"]'));
    await page.locator('.drawing polyline.target[aria-label*="RightKick [Ball.y"]').first().focus();
    await page.keyboard.press('Enter');
    await page.locator('.inspector .cm-content').click();
    await page.keyboard.press('Control+a');
    await page.keyboard.type('[0 > Ball.y]');
    await page.locator('select[aria-label="Model"]').focus();
    await openModel(page, 'roles.srm');
    await until(page, 'the changed file', () => /1 other file not saved/.test(document.querySelector('.panel.text header')?.textContent ?? ''));
    assert.equal(await textOf(page), saved(folder, 'roles.srm'));
    await openModel(page, 'attacker.srm');
    assert.match(await textOf(page), /CONDITION -> RightKick : \[0 > Ball\.y\]/);
    await page.locator('button', { hasText: 'Undo' }).click();
    assert.equal(await textOf(page), saved(folder, 'attacker.srm'));
  },

  async 'a file that cannot be edited shows nothing of another'({ page, folder }) {
    await openModel(page, 'roles.srm');
    await page.locator('select[aria-label="Model"]').selectOption({ label: 'mixed.srm' });
    await until(page, 'why', () => /end in different ways/.test(document.querySelector('.panel.text [role=alert]')?.textContent ?? ''));
    assert.equal(await page.locator('.panel.drawing table, .panel.drawing svg').count(), 0);
    await page.keyboard.press('Control+s');
    await until(page, 'that nothing is saved', () => /the file was not opened/.test(document.querySelector('.editor .outcome')?.textContent ?? ''));
    assert.equal(saved(folder, 'mixed.srm'), MIXED);
  },

  async 'saving again at once is no conflict'({ page, folder }) {
    await openModel(page, 'roles.srm');
    await goBehind(page, 'Role');
    await page.keyboard.type('s');
    await page.evaluate(() => {
      for (let presses = 0; presses < 3; presses += 1) {
        const key = { key: 's', code: 'KeyS', ctrlKey: true, bubbles: true, cancelable: true };
        document.querySelector('.code-area .cm-content').dispatchEvent(new KeyboardEvent('keydown', key));
      }
    });
    await until(page, 'it is saved', () => /saved/.test(document.querySelector('.editor .outcome')?.textContent ?? ''));
    await page.waitForTimeout(300);
    assert.equal(await page.locator('.conflict').count(), 0);
    assert.equal(saved(folder, 'roles.srm'), await textOf(page));
    await page.locator('button', { hasText: 'Undo' }).click();
    await save(page);
  },

  async 'a file that was deleted is written again, if that is wanted'({ page, folder }) {
    await openModel(page, 'roles.srm');
    rmSync(join(folder, 'roles.srm'));
    await goBehind(page, 'Role');
    await page.keyboard.type('s');
    await page.keyboard.press('Control+s');
    await until(page, 'that it was deleted', () => /was deleted/.test(document.querySelector('.conflict')?.textContent ?? ''));
    assert.ok(!existsSync(join(folder, 'roles.srm')));
    await page.locator('.conflict button', { hasText: 'Save mine' }).click();
    await until(page, 'it is saved', () => /saved/.test(document.querySelector('.editor .outcome')?.textContent ?? ''));
    assert.equal(await page.locator('.conflict').count(), 0);
    assert.equal(saved(folder, 'roles.srm'), await textOf(page));
    await page.locator('button', { hasText: 'Undo' }).click();
    await save(page);
  },

  async 'a text that is too long is refused with the reason, and the connection goes on'({ page }) {
    await openModel(page, 'attacker.srm');
    const insert = (text) => page.evaluate((text) => {
      const content = document.querySelector('.code-area .cm-content');
      const view = content.cmTile?.view ?? content.cmView.view;
      view.dispatch({ changes: { from: view.state.doc.length, insert: text } });
    }, text);
    await insert(`${'# long\n'.repeat(200_000)}`);
    await until(page, 'the reason', () => /too long: \d+ KB/.test(document.querySelector('.editor .outcome')?.textContent ?? ''));
    assert.equal(await page.locator('.link').innerText(), 'Models');
    await page.locator('button', { hasText: 'Undo' }).click();
    await until(page, 'the chart', () => document.querySelectorAll('.drawing .node.BASIC').length > 10);
    await until(page, 'no reason any more', () => !document.querySelector('.editor .outcome'));
  },

  async 'it is readable in the dark and on a phone'({ page, shot }) {
    await openModel(page, 'attacker.srm');
    await until(page, 'the chart', () => document.querySelectorAll('.drawing .node.BASIC').length > 10);
    await page.locator('button[aria-label="Light or dark"]').click();
    await page.locator('.drawing [data-state$="TurnAround"]').first().click();
    await shot('editor-dark');
    await page.setViewportSize({ width: 800, height: 600 });
    await page.waitForTimeout(300);
    const [text, drawing] = await Promise.all(['.panel.text', '.panel.drawing'].map((panel) => page.locator(panel).boundingBox()));
    assert.ok(text.y + text.height <= drawing.y, `the text ends at ${text.y + text.height}, the drawing begins at ${drawing.y}`);
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(300);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 390, `${width} pixels wide`);
    await page.screenshot({ path: `${shot.folder}/editor-phone.png`, fullPage: true });
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.locator('button[aria-label="Light or dark"]').click();
  },
};

/** A swap of an edited role into a running robot, with the verdict before it. */
async function swapTest({ page, shot }) {
  // a run is shown first, whatever can be edited
  await until(page, 'the run', () => document.querySelectorAll('.robots li').length === 6);
  await page.locator('[role=tab]', { hasText: 'Editor' }).click();
  await until(page, 'the chart', () => document.querySelectorAll('.drawing .node.BASIC').length > 10);
  assert.equal(await textOf(page), original('attacker.srm'));
  assert.doesNotMatch(await page.locator('.panel.text header').innerText(), /not saved/);
  // what is typed in a field is kept when another view is chosen at once
  await page.locator('.drawing polyline.target[aria-label*="LeftKick [Ball.y"]').first().focus();
  await page.keyboard.press('Enter');
  await page.locator('.inspector .cm-content').click();
  await page.keyboard.press('Control+a');
  await page.keyboard.type('[0 <= Ball.y]');
  await page.locator('[role=tab]', { hasText: 'Overview' }).click();
  await page.locator('[role=tab]', { hasText: 'Editor' }).click();
  await untilText(page, 'the expression', /CONDITION -> LeftKick : \[0 <= Ball\.y\]/);
  await page.locator('button', { hasText: 'Undo' }).click();
  assert.equal(await textOf(page), original('attacker.srm'));
  await page.locator('button', { hasText: 'Swap…' }).click();
  const select = page.locator('select[aria-label="Running chart"]');
  await until(page, 'the running charts', () => [...document.querySelectorAll('select[aria-label="Running chart"] option')].some((one) => one.textContent?.includes('blue-2')));
  await select.selectOption(await select.locator('option', { hasText: 'blue-2' }).first().getAttribute('value'));
  await goBehind(page, 'near = 0.25');
  await page.keyboard.type('5');
  assert.ok(await page.locator('button', { hasText: 'Swap now' }).isDisabled(), 'not without a verdict');
  await page.locator('button', { hasText: 'Dry run' }).click();
  await until(page, 'the verdict', () => /possible: nothing has changed/.test(document.querySelector('.swap')?.textContent ?? ''));
  assert.match(await page.locator('.swap ul').innerText(), /\d+ kept/);
  await shot('editor-verdict');
  // a role without the running state
  await goBehind(page, 'active = Sensors ω || Vision ω || ');
  // one edit, so that one undo takes it back
  await page.keyboard.insertText('no');
  await page.keyboard.press('Escape');
  await page.locator('button', { hasText: 'Dry run' }).click();
  await until(page, 'the refusal', () => /refused: nothing has changed/.test(document.querySelector('.swap')?.textContent ?? ''));
  await page.locator('button', { hasText: 'Undo' }).click();
  await page.locator('button', { hasText: 'Dry run' }).click();
  await until(page, 'the verdict again', () => /possible: nothing has changed/.test(document.querySelector('.swap')?.textContent ?? ''));
  await page.locator('button', { hasText: 'Swap now' }).click();
  await until(page, 'it is done', () => /swapped after cycle/.test(document.querySelector('.swap')?.textContent ?? ''));
}

/** All tests of the editor. `open` opens a page that fails on errors. */
export async function testEditor({ program, browser, open, screenshots, check }) {
  const folder = mkdtempSync(join(tmpdir(), 'monas-models-'));
  for (const [name, path] of Object.entries(MODELS)) {
    copyFileSync(path, join(folder, name));
  }
  writeFileSync(join(folder, 'mixed.srm'), MIXED);
  const shotOf = (page) => Object.assign((name) => page.screenshot({ path: `${screenshots}/${name}.png` }), { folder: screenshots });
  const alone = start(program, ['studio', '--edit', join(folder, 'attacker.srm'), '--edit', folder]);
  try {
    const { page, faults } = await open(browser, await alone.url);
    for (const [name, test] of Object.entries(TESTS)) {
      await check(`editor: ${name}`, () => test({ page, folder, shot: shotOf(page) }));
    }
    await check('editor: no error on the page, no request elsewhere', () => assert.deepEqual(faults, []));
    await page.close({ runBeforeUnload: false });
  } finally {
    await alone.stop();
  }
  const match = start(program, ['run', project('config/match.xml'), '--studio', '--allow-control', '--edit', project('models/attacker.srm'), '--seed', '1', '--for', '600s']);
  try {
    const { page, faults } = await open(browser, await match.url);
    await check('editor: an edited chart is swapped into a running robot, with the verdict before', () => swapTest({ page, shot: shotOf(page) }));
    await check('editor: no error on the page of the run, no request elsewhere', () => assert.deepEqual(faults, []));
    await page.close({ runBeforeUnload: false });
  } finally {
    await match.stop();
  }
}
