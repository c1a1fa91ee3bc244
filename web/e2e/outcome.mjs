// What becomes of a plan, in a real browser, on a made-up head that is solved in seconds: iterations as they come, contact
// on the bone, the face after surgery, outlines on slices. node e2e/outcome.mjs [--only WORDS]; LEFORT names the program.
import { mkdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { check, freshFolder, openPage, runTests, serve, test } from './harness.mjs';
import { idle, id, settled, step } from './planner.mjs';

const args = process.argv.slice(2);
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

/** A ball of skin around a shell of bone: tests/support/small_head.h. */
function smallHead() {
  const n = 36;
  const spacing = 3;
  const origin = -0.5 * spacing * (n - 1);
  const values = new Int16Array(n * n * n);
  for (let v = 0; v < values.length; v++) {
    const r = Math.hypot(...[v % n, Math.floor(v / n) % n, Math.floor(v / (n * n))].map((c) => origin + spacing * c));
    values[v] = r > 47 ? -1000 : r > 24 && r < 32 ? 1200 : 40;
  }
  const header = `NRRD0004\ntype: short\ndimension: 3\nsizes: ${n} ${n} ${n}\nencoding: raw\nspace: left-posterior-superior\n`
    + `space directions: (${spacing},0,0) (0,${spacing},0) (0,0,${spacing})\nspace origin: (${origin},${origin},${origin})\nendian: little\n\n`;
  return Buffer.concat([Buffer.from(header), Buffer.from(values.buffer)]);
}

const LANDMARKS = {
  "N'": [0, -45, 20], Sn: [0, -47, 5], Stm: [0, -47, -6], 'Ch-R': [-12, -45, -6], 'Ch-L': [12, -45, -6],
  'Al-R': [-10, -46, 5], 'Al-L': [10, -46, 5], 'En-R': [-10, -43, 18], 'En-L': [10, -43, 18],
};

const PLAN = {
  lefort_plan: 1, ct: 'ct.nrrd', landmarks: 'landmarks.mrk.json',
  segments: [{
    name: 'front',
    osteotomy: { planes: [{ point_mm: [0, -16, 0], towards_segment: [0, -1, 0] }] },
    path: { steps: 4, keyframes: [{ at: 1, translation_mm: [0, -3, 0] }] },
  }],
  tissue: { element_size_mm: 5, far_element_size_mm: 5, margin_mm: 10 },
  field: { resolution: 64, band_mm: 4 },
};

/** The server's API as the page uses it, for what is made by hand elsewhere. */
function api(address) {
  const [base, token] = address.split('#token=');
  const ask = async (method, path, body, headers = {}) => {
    const response = await fetch(`${base}api/v1${path}`, { method, body, headers: { 'X-Lefort-Token': token, ...headers } });
    check(`${method} ${path} is answered: ${response.status}`, response.ok);
    return response;
  };
  const put = (path, value) => ask('PUT', path, JSON.stringify(value), { 'Content-Type': 'application/json', 'If-Match': '*' });
  const run = async (job) => {
    let now = await (await ask('POST', '/jobs', JSON.stringify(job), { 'Content-Type': 'application/json' })).json();
    while (now.state === 'queued' || now.state === 'running') {
      await new Promise((done) => setTimeout(done, 100));
      now = await (await ask('GET', `/jobs/${now.id}`)).json();
    }
    check(`${job.kind} is done: ${now.message}`, now.state === 'done');
  };
  const upload = async (bytes, name) => {
    const { id: upload } = await (await ask('POST', '/uploads')).json();
    await ask('PUT', `/uploads/${upload}/files/0?name=${name}`, bytes, { 'Content-Type': 'application/octet-stream' });
    return upload;
  };
  return { ask, put, run, upload };
}

let made = null;
/** The head, cut and planned, and its server. */
async function planned() {
  made ??= await (async () => {
    const case_ = freshFolder('outcome');
    const server = await serve(case_.folder);
    const { put, run, upload } = api(server.address);
    await run({ kind: 'import', upload: await upload(smallHead(), 'head.nrrd') });
    await run({ kind: 'segment' });
    await put('/landmarks', { landmarks: LANDMARKS });
    await put('/plan', PLAN);
    await run({ kind: 'cut' });
    return { ...case_, server, ...api(server.address) };
  })();
  return made;
}

/** The same with its face predicted. */
async function predicted() {
  const here = await planned();
  const { stages } = await (await here.ask('GET', '/case')).json();
  if (stages.prediction.state !== 'fresh') await here.run({ kind: 'predict' });
  return here;
}

async function withPage(find, run, options) {
  const here = await find();
  const page = await openPage(here.server.address, options);
  try {
    await settled(page);
    await run(page, here).catch(async (error) => {
      await page.screenshot({ path: join(output, 'failed.png') });
      throw error;
    });
    check(`no errors in the page: ${page.faults.join('; ')}`, page.faults.length === 0);
    check('the page as a whole never scrolls', (await page.evaluate(() => document.scrollingElement.scrollTop)) === 0);
  } finally {
    await page.context().close();
  }
}

async function chooseFile(page, button, name, buffer) {
  const choosing = page.waitForEvent('filechooser');
  await page.click(id(button));
  await (await choosing).setFiles({ name, mimeType: 'application/octet-stream', buffer });
}

const rows = (page, name) => page.locator(`${id(name)} tbody tr`).allInnerTexts();

test('every iteration of a solve is drawn', () => withPage(planned, async (page, { ask }) => {
  await step(page, 'predict');
  await page.click(id('predict'));
  await page.waitForSelector(id('iterate-now'));
  await page.waitForSelector(id('to-compare'), { timeout: 120000 });
  await idle(page);
  const { document } = await (await ask('GET', '/prediction')).json();
  const lines = document.steps.flatMap((s) => s.attempts).reduce((sum, attempt) => sum + attempt.newton.length, 0);
  const drawn = Number(await page.getAttribute(id('residual-plot'), 'data-points'));
  check(`${lines} iterations were found, ${drawn} are drawn`, drawn === lines);
}));

test('the face is told by region, at every step', () => withPage(predicted, async (page) => {
  await step(page, 'compare');
  await page.waitForSelector(id('distance-table'));
  const last = await rows(page, 'distance-table');
  check(`nose and upper lip are told: ${last}`, ['Whole skin', 'Moved', 'Nose', 'Upper lip'].every((name) => last.some((row) => row.startsWith(name))));
  await page.locator(id('compare-step')).fill('1');
  await page.waitForFunction(([sel, old]) => document.querySelector(`${sel} tbody tr`)?.innerText !== old, [id('distance-table'), last[0]]);
}));

test('contact is shown on the bone', () => withPage(predicted, async (page) => {
  await step(page, 'compare');
  await page.waitForSelector(id('distance-table'));
  await page.getByText('Bones under a clear skin').click();
  for (const [name, unit] of [['Pressure', 'kPa'], ['Depth', 'mm']]) {
    await page.getByRole('button', { name, exact: true }).click();
    await page.waitForFunction(([sel, words]) => document.querySelector(sel)?.innerText.includes(words), [id('bone-legend'), unit]);
  }
  await page.locator(id('compare-step')).fill('1');
  await page.getByText('Contact is kept for the last step alone').waitFor();
}));

test('a face after surgery is compared with, one that cannot be is told of', () => withPage(predicted, async (page, { ask }) => {
  await step(page, 'compare');
  await page.waitForSelector(id('distance-table'));
  await chooseFile(page, 'compare-files', 'after.vtp', Buffer.from('no surface'));
  await page.getByText('Not compared').waitFor({ timeout: 120000 });
  // The head again: surgery has moved nothing.
  await chooseFile(page, 'compare-files', 'after.nrrd', smallHead());
  await page.getByText('front has not moved').waitFor({ timeout: 120000 });
  const achieved = await page.locator(id('achieved')).innerText();
  check(`the plan is missed by its 3 mm: ${achieved}`, achieved.includes('From the plan it is 3.0 mm'));
  await page.getByRole('button', { name: 'After surgery', exact: true }).click();
  await idle(page);
  await chooseFile(page, 'compare-files', 'DOE^JOHN.vtp', Buffer.from(await (await ask('GET', '/files/skin_before.vtp')).arrayBuffer()));
  await page.waitForSelector(id('error-table'), { timeout: 120000 });
  await page.waitForSelector(id('error-legend'));
  const [whole] = (await rows(page, 'error-table')).map((row) => row.split(/\s*\t\s*/));
  check(`nothing had changed, and the prediction is off: ${whole}`, Number(whole[2]) > 0.5 && whole[3] === '0.0' && whole[4] === '0.0');
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => window.axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21aa'] }));
  check(`the dark comparison is accessible: ${violations.map((v) => `${v.id} ${v.nodes[0].html}`).join('; ')}`, violations.length === 0);
}, { scheme: 'dark' }));

test('slices show where the bone is and was, by keys alone', () => withPage(planned, async (page) => {
  await page.keyboard.press('5');
  await page.waitForSelector('[data-step=movement][aria-current=step]');
  const toggle = page.getByLabel('Slices with the moved outline');
  await toggle.focus();
  await page.keyboard.press('Space');
  await page.waitForSelector('.views[data-layout=slices]');
  await settled(page);
  // The outline's colour, which no grey of the scan is.
  const blue = await page.locator('.slice[data-orientation=sagittal] canvas').evaluate((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let n = 0; n < data.length; n += 4) if (data[n + 2] > data[n] + 60 && data[n + 2] > data[n + 1] + 20) count++;
    return count;
  });
  check(`the outline is drawn: ${blue} pixels`, blue > 200);
}));

const ok = await runTests({ all: false, only });
await made?.server.kill();
made?.remove();
process.exit(ok ? 0 : 1);
