// Opens a report in headless Chromium and does what a reader does.
//
// node report_browser.mjs PACKAGES CHROMIUM FILE CHECK [SHOTS]
//   PACKAGES  a folder whose node_modules holds puppeteer-core
//   CHECK     looks (any report), view (of a part with a map), distance (the page of
//             report_browser_test.cc with two posts), comparison, without-webgl, times
//   SHOTS     where screenshots go, named after the check; none without
// Exit 0: all as it should be; 1: the first sentence on standard error says what is not.
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [packages, chromium, file, check, shots] = process.argv.slice(2);
const require = createRequire(join(packages, 'package.json'));
const loaded = await import(pathToFileURL(require.resolve('puppeteer-core')).href);
const puppeteer = loaded.default ?? loaded;

function must(holds, sentence) {
  if (!holds) throw new Error(sentence);
}

const flags = ['--no-sandbox', '--disable-dev-shm-usage'];
if (check === 'without-webgl') flags.push('--disable-3d-apis', '--disable-gpu');
else flags.push('--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader');

const browser = await puppeteer.launch({ executablePath: chromium, headless: true, args: flags });
const complaints = [];

async function open({ width = 1280, height = 860, dark = false, scripts = true } = {}) {
  const page = await browser.newPage();
  page.on('console', (message) => {
    // What Chromium says of its own drawing by software is no fault of the page.
    const own = /GPU stall|GL Driver Message|swiftshader|software WebGL/i.test(message.text());
    if (['error', 'warn'].includes(message.type()) && !own) complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => {
    if (!/^(file|data|blob):/.test(request.url())) complaints.push(`asks for ${request.url()}`);
  });
  page.on('dialog', (dialog) => {
    complaints.push('a dialog was opened');
    dialog.dismiss();
  });
  await page.setJavaScriptEnabled(scripts);
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }]);
  await page.goto(pathToFileURL(file).href, { waitUntil: 'load' });
  return page;
}

const ready = (page) => page.waitForFunction('window.rigmapView?.ready', { timeout: 60000 });
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

async function shoot(page, name, selector) {
  if (!shots) return;
  if (selector) await page.$eval(selector, (element) => element.scrollIntoView({ behavior: 'instant' }));
  await pause(400);
  await page.screenshot({ path: join(shots, `${name}.jpg`), type: 'jpeg', quality: 80 });
}

async function fits(page, what) {
  const beyond = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  must(beyond <= 0, `${what}: the page is ${beyond} px wider than the window`);
}

// The contrast of the page's text with its paper, as WCAG has it.
async function legible(page, what) {
  const ratio = await page.evaluate(() => {
    const light = (colour) => {
      const [r, g, b] = colour.match(/[\d.]+/g).map((c) => c / 255)
        .map((c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const style = getComputedStyle(document.body);
    const [a, b] = [light(style.color), light(style.backgroundColor)].sort((x, y) => y - x);
    return (a + 0.05) / (b + 0.05);
  });
  must(ratio > 7, `${what}: the text's contrast is ${ratio}`);
}

async function looks() {
  for (const dark of [false, true]) {
    for (const width of [1280, 390]) {
      const page = await open({ width, dark });
      const what = `${dark ? 'dark' : 'light'}, ${width} px`;
      must((await page.$eval('.headline', (e) => e.textContent)).length > 5, `${what}: no verdict`);
      await pause(300);
      await fits(page, what);
      await legible(page, what);
      await shoot(page, `first-${dark ? 'dark' : 'light'}-${width}`);
      await page.close();
    }
  }
  const plain = await open({ scripts: false });
  must((await plain.$eval('.headline', (e) => e.textContent)).length > 5, 'no verdict without scripts');
  const sheet = await plain.pdf({ format: 'A4', printBackground: true });
  must(sheet.length > 10000, `the print is of ${sheet.length} bytes`);
  await plain.close();
}

async function layers(page) {
  for (const box of await page.$$('.layers input')) {
    const before = await page.$eval('.stage canvas', (e) => e.toDataURL().length);
    const id = await box.evaluate((e) => e.dataset.layer);
    const was = await page.evaluate((name) => window.rigmapView.layers[name].object.visible, id);
    await box.click();
    const is = await page.evaluate((name) => window.rigmapView.layers[name].object.visible, id);
    must(was !== is, `the layer ${id} was not switched`);
    await box.click();
    must(before > 0, 'the canvas cannot be read');
  }
}

async function frameCost(page, frames = 40) {
  return page.evaluate(async (count) => {
    const view = window.rigmapView;
    view.work.length = 0;
    for (let i = 0; i < count; ++i) {
      view.turn(0.02);
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    const sorted = [...view.work].sort((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
  }, frames);
}

async function view() {
  const page = await open();
  await ready(page);
  await page.$eval('#view3d', (element) => element.scrollIntoView({ behavior: 'instant' }));
  await shoot(page, 'view', '#view3d');
  await layers(page);
  for (const mode of ['1', '2', '3', '0']) {
    await page.select('.bar select', mode);
    must(await page.$eval('.legend', (e) => e.hidden) === (mode === '0'), `legend of mode ${mode}`);
    if (mode !== '0') await shoot(page, `colour-${mode}`);
  }
  const place = () => page.evaluate(() => window.rigmapView.camera.position.toArray().join());
  await page.focus('.stage canvas');
  for (const key of ['t', 'p', 'a', '+', '-', 'o', 'ArrowLeft']) {
    const before = await place();
    await page.keyboard.press(key);
    must(before !== await place(), `the key ${key} does nothing`);
  }
  const before = await place();
  await page.keyboard.press('f');
  await page.waitForFunction((was) => window.rigmapView.camera.position.toArray().join() !== was,
    { timeout: 20000 }, before);
  await shoot(page, 'flight');
  await page.keyboard.press('Escape');
  must(!(await page.evaluate(() => window.rigmapView.flight)), 'the flight does not end');
  await ruler(page);
  await page.keyboard.press('o');
  await clickCamera(page);
  must((await page.$$('.uplot')).length > 1, 'no curves were drawn');
  for (const id of ['route', 'calibration', 'tracks', 'frames', 'gates']) {
    if (await page.$(`#${id}`)) await shoot(page, id, `#${id}`);
  }
  await page.emulateMediaType('print');
  must(await page.$eval('.viewer', (e) => getComputedStyle(e).display) === 'none', 'the view is printed');
  must((await page.pdf({ format: 'A4' })).length > 20000, 'the print is empty');
  await page.close();
}

// The bar of length against two points as far apart, where the camera turns about.
async function ruler(page) {
  await page.keyboard.press('t');
  const [bar_px, text, metre_px] = await page.evaluate(() => {
    const view = window.rigmapView;
    view.draw(performance.now());
    const bar = document.querySelector('.rulers .length');
    const middle = view.controls.target;
    const [u, v] = view.project(middle.toArray());
    const [u1, v1] = view.project([middle.x + 1, middle.y, middle.z]);
    return [bar.getBoundingClientRect().width, bar.textContent, Math.hypot(u1 - u, v1 - v)];
  });
  const [, number, unit] = text.match(/^([\d.]+) (mm|cm|m|km)$/) ?? [];
  const length_m = Number(number) * { mm: 0.001, cm: 0.01, m: 1, km: 1000 }[unit];
  must(Math.abs(bar_px / (length_m * metre_px) - 1) < 0.03, `${text} is drawn with ${bar_px} px, a metre is ${metre_px}`);
}

async function clickCamera(page) {
  const at = await page.evaluate(() => {
    const { world, place } = window.rigmapView;
    const box = place.getBoundingClientRect();
    const [x, y] = window.rigmapView.project([world.poses.x[0], world.poses.y[0], world.poses.z[0]]);
    return [x + box.left, y + box.top];
  });
  await page.mouse.click(...at);
  must(!(await page.$eval('.card', (e) => e.hidden)), 'a click on a camera shows nothing');
  must((await page.$eval('.card figcaption', (e) => e.textContent)).includes('Frame'), 'no caption');
  must(await page.$('.card img'), 'the camera has no image');
  await shoot(page, 'camera');
}

// The posts' tops are at (0, 0, 1) and (2, 0, 1), above a plane.
async function distance() {
  const page = await open();
  await ready(page);
  await page.$eval('#view3d', (element) => element.scrollIntoView({ behavior: 'instant' }));
  for (const tap of [false, true]) {
    await page.evaluate(() => window.rigmapView.clearPicked());
    for (const top of [[0, 0, 1], [2, 0, 1]]) {
      const at = await page.evaluate((x) => {
        const { data, place } = window.rigmapView;
        const box = place.getBoundingClientRect();
        const [u, v] = window.rigmapView.project(x.map((value, i) => value - data.points.origin[i]));
        return [u + box.left, v + box.top];
      }, top);
      if (tap) await page.touchscreen.tap(...at);
      else await page.mouse.click(...at);
      await pause(100);
    }
    const said = await page.$eval('.said', (e) => e.textContent);
    const read = Number(said.match(/Distance ([\d.]+) m/)?.[1]);
    must(Math.abs(read - 2) < 0.002, `of two posts 2 m apart it says: ${said}`);
    must(said.includes('\u00b1'), `no sigma: ${said}`);
    await shoot(page, 'distance');
  }
  await page.close();
}

async function withoutWebgl() {
  const page = await open();
  await pause(500);
  must(await page.$('.without-webgl'), 'a view without WebGL?');
  const shown = await page.$eval('.standin', (e) => getComputedStyle(e).display);
  must(shown !== 'none', 'no pictures stand in for the view');
  await page.close();
}

// Best of three, ms: other work on the machine only ever adds to it.
async function times() {
  const best = { first: Infinity, view: Infinity, frame: Infinity };
  await (await open()).close();
  for (let i = 0; i < 5; ++i) {
    const page = await open();
    await ready(page);
    const [first, view] = await page.evaluate(() => [
      performance.getEntriesByName('first-contentful-paint')[0]?.startTime, window.rigmapView.shownAt]);
    best.first = Math.min(best.first, first);
    best.view = Math.min(best.view, view);
    best.frame = Math.min(best.frame, await frameCost(page));
    await page.close();
  }
  console.log(JSON.stringify(best));
}

try {
  if (check === 'looks' || check === 'comparison') await looks();
  else if (check === 'view') await view();
  else if (check === 'distance') await distance();
  else if (check === 'without-webgl') await withoutWebgl();
  else if (check === 'times') await times();
  else throw new Error(`no check ${check}`);
  must(complaints.length === 0, `the browser says: ${complaints.join('; ')}`);
} catch (error) {
  console.error(error.message);
  process.exitCode = 1;
} finally {
  await browser.close();
}
