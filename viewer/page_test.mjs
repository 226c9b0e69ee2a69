// Tests pages in a real browser, from file://: page_test.mjs FOLDER, with the pages that view_test wrote there.
// scripts/page_test runs it, where there are a browser and playwright-core.
import assert from 'node:assert/strict';
import {createRequire} from 'node:module';
import {readFileSync} from 'node:fs';
import {join, resolve} from 'node:path';

const folder = resolve(process.argv[2]);
const require = createRequire(join(process.env.PLAYWRIGHT_FOLDER || process.cwd(), 'x.js'));
const {chromium} = require('playwright-core');
const expected = JSON.parse(readFileSync(join(folder, 'expected.json')));

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox'],
});

/** Opens a page and fails the test for whatever it says on the console or asks of a network. */
async function open(name, options = {}) {
  const context = await browser.newContext({viewport: {width: 1280, height: 760}, ...options});
  const page = await context.newPage();
  const complaints = [];
  page.on('console', message => {
    if (['error', 'warning'].includes(message.type()) && !/GPU stall|swiftshader|GL Driver/i.test(message.text())) complaints.push(message.text());
  });
  page.on('pageerror', error => complaints.push(error.message));
  page.on('request', request => {
    if (!request.url().startsWith('file://') || !request.url().endsWith(name)) complaints.push(`request: ${request.url()}`);
  });
  if (options.before) await page.addInitScript(options.before);
  await page.goto(`file://${join(folder, name)}`);
  await page.waitForFunction(() => window.canonpose && window.canonpose.isOpen, null, {timeout: 60000});
  return {page, async close() {
    assert.deepEqual(complaints, []);
    await context.close();
  }};
}

const frameOf = page => page.evaluate(() => window.canonpose.state.frame);

/** The joints in the scene graph against those that the page was made from. */
async function expectJoints(page, frame) {
  for (let person = 0; person < expected.length; ++person) {
    const found = await page.evaluate(p => window.canonpose.jointPositions(p), person);
    assert.equal(found.length, expected[person][frame].length);
    found.forEach((joint, j) => {
      const wanted = expected[person][frame][j];
      assert.equal(joint === null, wanted === null, `person ${person}, frame ${frame}, joint ${j}`);
      if (joint) joint.forEach((x, k) => assert.ok(Math.abs(x - wanted[k]) < 0.15, `joint ${j}: ${joint} and ${wanted}`));
    });
  }
}

const tests = {
  async 'shows the joints where they are, at every frame that one goes to'() {
    const {page, close} = await open('page.html');
    await expectJoints(page, 0);
    for (const frame of [40, 149]) {
      await page.evaluate(f => window.canonpose.actions.seek(f), frame);
      await expectJoints(page, frame);
    }
    await close();
  },

  async 'plays, pauses and steps'() {
    const {page, close} = await open('page.html');
    await page.click('#play');
    await page.waitForFunction(() => window.canonpose.state.frame > 5);
    await page.click('#play');
    const paused = await frameOf(page);
    await page.waitForTimeout(200);
    assert.equal(await frameOf(page), paused);
    await page.evaluate(() => window.canonpose.actions.seek(60));
    await page.click('#forward');
    assert.equal(await frameOf(page), 61);
    await page.click('#back');
    await page.click('#back');
    assert.equal(await frameOf(page), 59);
    await expectJoints(page, 59);
    await close();
  },

  async 'obeys the keyboard and the slider'() {
    const {page, close} = await open('page.html');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Shift+ArrowRight');
    assert.equal(await frameOf(page), 11);
    await page.keyboard.press('End');
    assert.equal(await frameOf(page), 149);
    await page.keyboard.press('Home');
    await page.keyboard.press('ArrowDown');
    assert.equal(await page.evaluate(() => window.canonpose.state.speed), 0.5);
    await page.keyboard.press(' ');
    assert.equal(await page.evaluate(() => window.canonpose.state.isPlaying), true);
    await page.keyboard.press(' ');
    await page.fill('#slider', '77');
    assert.equal(await frameOf(page), 77);
    await expectJoints(page, 77);
    assert.match(await page.textContent('#clock'), /frame 77 of 149/);
    await close();
  },

  async 'shows each camera, and says which one is off'() {
    const {page, close} = await open('page.html');
    assert.equal(await page.locator('.tile').count(), 4);
    assert.deepEqual(await page.locator('.tile.off').evaluateAll(tiles => tiles.map(t => t.dataset.camera)), ['cam3']);
    await page.keyboard.press('2');
    assert.equal(await page.locator('.tile.selected').getAttribute('data-camera'), 'cam2');
    const widths = await page.locator('.tile canvas').evaluateAll(all => all.map(c => c.clientWidth));
    assert.ok(widths[1] > 1.8 * widths[0]);
    await page.locator('.tile[data-camera=cam4] .enlarge').click();
    assert.equal(await page.locator('.tile.selected').getAttribute('data-camera'), 'cam4');
    await page.locator('.tile[data-camera=cam1] .through').click();
    assert.equal(await page.evaluate(() => window.canonpose.state.through), 0);
    await page.locator('#views button', {hasText: 'Overview'}).click();
    assert.equal(await page.evaluate(() => window.canonpose.state.through), null);
    await close();
  },

  async 'shows and hides people, cameras and joints'() {
    const {page, close} = await open('page.html');
    await page.click('#tab-button-show');
    await page.getByRole('checkbox', {name: 'Person 2'}).uncheck();
    const hidden = await page.evaluate(() => window.canonpose.jointPositions(1));
    assert.ok(hidden.every(joint => joint === null));
    await page.getByRole('checkbox', {name: 'Left arm'}).uncheck();
    const joints = await page.evaluate(() => window.canonpose.models[0].people[0].joints);
    const shown = await page.evaluate(() => window.canonpose.jointPositions(0));
    assert.deepEqual(joints.filter((_, j) => shown[j] === null).sort(), ['LElbow', 'LShoulder', 'LWrist']);
    await page.getByRole('checkbox', {name: 'cam2'}).uncheck();
    await page.click('#tab-button-cameras');
    assert.equal(await page.locator('.tile:visible').count(), 3);
    await close();
  },

  async 'plots angles with a cursor that follows'() {
    const {page, close} = await open('page.html');
    await page.click('#tab-button-angles');
    assert.equal(await page.locator('.plot').count(), 8);
    await page.evaluate(() => window.canonpose.actions.seek(75));
    const left = await page.locator('.cursor').first().evaluate(cursor => parseFloat(cursor.style.left));
    assert.ok(Math.abs(left - 100 * 75 / 149) < 0.1, left);
    const ink = await page.locator('.plot canvas').first().evaluate(canvas => {
      const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      let blue = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200 && data[i] < 60 && data[i + 2] > 140) ++blue;
      return blue;
    });
    assert.ok(ink > 100, `${ink} pixels of the left side's curve`);
    await close();
  },

  async 'changes the sequence, the theme, and draws something'() {
    const {page, close} = await open('page.html');
    await page.selectOption('#scene', '1');
    assert.equal(await page.evaluate(() => window.canonpose.models[0].frames), 60);
    const before = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await page.click('#theme');
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), before);
    await page.click('#tab-button-report');
    assert.match(await page.textContent('#tab-report'), /No camera stands out/);
    // The report has the second sequence's capture and not the first one's.
    const verdict = await page.textContent('.verdict');
    assert.match(verdict, /Nothing speaks against this result/);
    assert.doesNotMatch(verdict, /not in this page/);
    await page.selectOption('#scene', '0');
    assert.match(await page.textContent('.verdict'), /not in this page/);
    const picture = await page.locator('#stage').screenshot();
    assert.ok(picture.length > 15000, `a picture of ${picture.length} bytes is empty`);
    await close();
  },

  async 'shows two results side by side'() {
    const {page, close} = await open('two.html');
    assert.equal(await page.locator('.result-name').count(), 2);
    const [a, b] = await page.evaluate(() => [window.canonpose.jointPositions(0, 0), window.canonpose.jointPositions(0, 1)]);
    assert.ok(a.every((joint, j) => Math.abs(joint[0] - b[j][0]) < 20));
    assert.ok(a.some((joint, j) => Math.abs(joint[0] - b[j][0]) > 5));
    await page.locator('.segments button', {hasText: 'two.h5'}).click();
    assert.equal(await page.evaluate(() => window.canonpose.state.active), 1);
    await close();
  },

  async 'fits a phone'() {
    const {page, close} = await open('page.html', {viewport: {width: 390, height: 780}, deviceScaleFactor: 2, hasTouch: true});
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(overflow <= 0, `${overflow} px too wide`);
    for (const id of ['play', 'forward', 'slider', 'canvas']) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 780, id);
    }
    await close();
  },

  async 'opens without the browser\'s own decompression'() {
    const {page, close} = await open('page.html', {before: () => { delete window.DecompressionStream; }});
    await expectJoints(page, 0);
    await close();
  },
};

let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  try {
    await test();
    console.log(`ok      ${name}`);
  } catch (error) {
    ++failed;
    console.log(`FAILED  ${name}\n${error.stack}`);
  }
}
await browser.close();
console.log(`${Object.keys(tests).length - failed} passed, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
