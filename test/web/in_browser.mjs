// usage: node in_browser.mjs ADDRESS STEPS   what a user does and sees, in a real browser; ends with 1 where it is not seen.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';

const { chromium } = createRequire(import.meta.url)('playwright-core');
const [address, steps] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ['--no-sandbox'] });
const page = await browser.newPage();
page.setDefaultTimeout(Number(process.env.GUARD_MS ?? 60000));
const problems = [];
page.on('pageerror', (problem) => problems.push(problem.message));
page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));

const node = (name) => page.locator(`svg .node[aria-label^="${name}:"]`);
const headline = (text) => page.locator('#headline', { hasText: text }).waitFor();

const all = {
  async cut_and_mend() {
    await headline('5 of 5 nodes up');
    await node('node1').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Enter');
    await page.locator('#details h2', { hasText: 'node2' }).waitFor();
    await page.locator('#details button', { hasText: 'Cut line to node3' }).click();
    await page.locator('svg .break.seen text', { hasText: 'cut' }).waitFor();
    await headline(/open chain|broken/i);
    await page.locator('#events li', { hasText: 'open_chain' }).first().waitFor();
    await page.locator('#details button', { hasText: 'Mend line to node3' }).click();
    await headline('5 of 5 nodes up');
    await page.locator('svg .break.seen').waitFor({ state: 'detached' });
    assert.equal(await page.locator('svg .node.good').count(), 5);
  },
  async read_only() {
    await headline('5 of 5 nodes up');
    await node('node1').click();
    await page.locator('#details h2', { hasText: 'node1' }).waitFor();
    assert.equal(await page.locator('#details button').count(), 0);
    assert.equal(await page.locator('#orders').isVisible(), false);
  },
};

try {
  await page.goto(address);
  await all[steps]();
  assert.deepEqual(problems, []);
} finally {
  await browser.close();
}
