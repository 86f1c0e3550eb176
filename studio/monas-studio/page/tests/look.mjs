// Takes screenshots of a run: node tests/look.mjs PROGRAM FOLDER ARGUMENTS...
import { mkdirSync } from 'node:fs';
import { launch, start, useBuiltPage } from './browser.mjs';

const [program, folder, ...args] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const run = start(program, args);
const browser = await launch();
try {
  const url = await run.url;
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  page.on('console', (message) => console.log('console:', message.text()));
  page.on('pageerror', (error) => console.log('error:', error.message));
  await useBuiltPage(page);
  await page.goto(url);
  await page.waitForTimeout(Number(process.env.WAIT ?? 8000));
  await page.screenshot({ path: `${folder}/overview.png` });
  await page.keyboard.press('2');
  await page.waitForTimeout(2500);
  await page.screenshot({ path: `${folder}/agents.png` });
  await page.keyboard.press('3');
  await page.locator('tr.choice', { hasText: 'soccer/ball' }).first().click();
  await page.waitForTimeout(800);
  await page.locator('.leaf button').nth(1).click();
  await page.waitForTimeout(3000);
  await page.screenshot({ path: `${folder}/topics.png` });
  await page.keyboard.press('4');
  await page.waitForTimeout(500);
  await page.screenshot({ path: `${folder}/log.png` });
  await page.keyboard.press('1');
  await page.keyboard.press('t');
  await page.waitForTimeout(500);
  await page.screenshot({ path: `${folder}/dark.png` });
  await page.keyboard.press('t');
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(500);
  await page.screenshot({ path: `${folder}/phone.png`, fullPage: true });
} finally {
  await browser.close();
  await run.stop();

}
