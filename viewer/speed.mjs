// How fast a page opens and plays in a headless Chromium that draws in software: speed.mjs PAGE. benchmarks/view runs it.
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';

const require = createRequire(join(process.env.PLAYWRIGHT_FOLDER || process.cwd(), 'x.js'));
const {chromium} = require('playwright-core');
const PLAY_SECONDS = 6;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM || '/usr/bin/chromium',
  args: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--no-sandbox', '--disable-frame-rate-limit', '--disable-gpu-vsync'],
});
for (const tab of ['cameras', 'angles']) {
  const page = await (await browser.newContext({viewport: {width: 1280, height: 760}})).newPage();
  await page.goto(`file://${resolve(process.argv[2])}#tab=${tab}`);
  await page.waitForFunction(() => window.canonpose && window.canonpose.isOpen, null, {timeout: 120000});
  const opened = await page.evaluate(() => window.canonpose.openedAfterMilliseconds);
  // Faster than the recording, so that every picture is of another frame.
  await page.evaluate(() => {
    window.canonpose.actions.setSpeed(4);
    window.canonpose.actions.togglePlay();
  });
  await page.waitForTimeout(1000 * PLAY_SECONDS);
  const speed = await page.evaluate(() => window.canonpose.framesPerSecond());
  console.log(`tab ${tab}: open after ${(opened / 1000).toFixed(1)} s, ${speed.toFixed(0)} frames a second at 1280x760`);
  await page.close();
}
await browser.close();
