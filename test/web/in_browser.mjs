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
    await page.locator('#details dd', { hasText: 'INT0: reset, INT1: stop, INT2: sync' }).waitFor();
    await page.locator('#details pre[aria-label^="Log of node2"]').waitFor();
    // A click that lasts longer than from one status to the next.
    await page.locator('#details button', { hasText: 'Cut line to node3' }).click({ delay: 1500 });
    await page.locator('svg .break.seen text', { hasText: 'cut' }).waitFor();
    await node('node2').and(page.locator('[aria-label$="line to node3 cut"]')).waitFor(); // what a screen reader says
    await headline(/open chain|broken/i);
    await page.locator('#events li', { hasText: 'open_chain' }).first().waitFor();
    await page.locator('#details li', { hasText: 'up -> open_chain' }).first().waitFor();
    await page.locator('#details button', { hasText: 'Mend line to node3' }).click();
    await headline('5 of 5 nodes up');
    await page.locator('svg .break.seen').waitFor({ state: 'detached' });
    assert.equal(await page.locator('svg .node.good').count(), 5);
  },
  async phone() {
    await page.setViewportSize({ width: 390, height: 844 });
    await headline('5 of 5 nodes up');
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
    await node('node1').click();
    await page.locator('#details h2', { hasText: 'node1' }).waitFor();
    await page.waitForFunction(() => document.getElementById('details').getBoundingClientRect().top < innerHeight / 2);
    // Beside each other, they stay apart: the details cover no events.
    await page.setViewportSize({ width: 1200, height: 500 });
    await page.locator('#log').scrollIntoViewIfNeeded();
    assert.ok(await page.evaluate(() => document.getElementById('details').getBoundingClientRect().bottom <= document.getElementById('log').getBoundingClientRect().top));
  },
  async playground() {
    await headline('humanoid16: 16 of 16 nodes up');
    await node('left_knee').click();
    await page.locator('#details button', { hasText: 'Hang CPU' }).click();
    await node('left_knee').filter({ hasText: 'CPU hung' }).waitFor();
    await page.locator('#details button', { hasText: 'Reset CPU' }).click();
    await page.locator('#events li', { hasText: 'left_knee: CPU running, boot 2' }).first().waitFor();
    await page.locator('#details button', { hasText: 'Cut line to left_ankle' }).click();
    await headline('a line is broken');
    await page.locator('svg .break.seen text', { hasText: 'cut' }).waitFor();
    await page.locator('#clear').click();
    await headline('16 of 16 nodes up');
    await page.selectOption('#ring', 'plain4'); // which has no node in the place of the one that is chosen
    await headline('4 of 4 nodes up');
    await node('node3').click();
    await page.selectOption('#ring', 'humanoid16');
    await headline('16 of 16 nodes up');
    await page.locator('#run-case').click();
    await page.locator('#case-text', { hasText: 'measured 75.264 us' }).waitFor();
    assert.equal(await page.locator('#case-picture rect.own').count(), 16);
    await page.locator('#run-scenario').click();
    await page.locator('#scenario-verdict', { hasText: 'as expected' }).waitFor();
    assert.equal(await page.locator('#scenario-picture text.row').count(), 16);
    for (const [ring, rows] of [['leg8', 8], ['humanoid16', 16]]) { // the ring above, pasted or chosen
      await page.selectOption('#ring', ring);
      await page.locator('#scenario-yaml').fill('scenario: mine\nring: ring.yaml\nsteps:\n  - {at: 20ms, do: {hang: left_knee}}\n');
      await page.locator('#run-scenario').click();
      await page.locator('#scenario-report', { hasText: 'mine (seed' }).waitFor();
      await page.waitForFunction((rows) => document.querySelectorAll('#scenario-picture text.row').length === rows, rows);
    }
    await headline('16 of 16 nodes up');
    await page.locator('#pause').click();
    const shown = await page.locator('#headline').textContent();
    await page.goto('about:blank');
    await page.goBack();
    await headline(shown);
    await page.locator('#case-text, #scenario-verdict', { hasText: 'as expected' }).waitFor();
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
