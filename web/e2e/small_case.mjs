// A synthetic head that is solved in seconds, its server and pages: for tests without a real scan.
import { join } from 'node:path';
import { check, freshFolder, openPage, serve } from './harness.mjs';
import { settled } from './planner.mjs';

const output = new URL('output/', import.meta.url).pathname;

/** A ball of skin around a shell of bone: tests/support/small_head.h. */
export function smallHead() {
  const n = 36;
  const spacing = 3;
  const origin = -0.5 * spacing * (n - 1);
  const values = new Int16Array(n * n * n);
  for (let v = 0; v < values.length; v++) {
    const r = Math.hypot(...[v % n, Math.floor(v / n) % n, Math.floor(v / (n * n))].map((c) => origin + spacing * c));
    values[v] = r > 47 ? -1000 : r > 24 && r < 32 ? 1200 : 40;
  }
  const header =
    `NRRD0004\ntype: short\ndimension: 3\nsizes: ${n} ${n} ${n}\nencoding: raw\nspace: left-posterior-superior\n` +
    `space directions: (${spacing},0,0) (0,${spacing},0) (0,0,${spacing})\n` +
    `space origin: (${origin},${origin},${origin})\nendian: little\n\n`;
  return Buffer.concat([Buffer.from(header), Buffer.from(values.buffer)]);
}

const LANDMARKS = {
  "N'": [0, -45, 20],
  Sn: [0, -47, 5],
  Stm: [0, -47, -6],
  'Ch-R': [-12, -45, -6],
  'Ch-L': [12, -45, -6],
  'Al-R': [-10, -46, 5],
  'Al-L': [10, -46, 5],
  'En-R': [-10, -43, 18],
  'En-L': [10, -43, 18],
};

export const PLAN = {
  lefort_plan: 1,
  ct: 'ct.nrrd',
  landmarks: 'landmarks.mrk.json',
  segments: [
    {
      name: 'front',
      osteotomy: { planes: [{ point_mm: [0, -16, 0], towards_segment: [0, -1, 0] }] },
      path: { steps: 4, keyframes: [{ path_fraction: 1, translation_mm: [0, -3, 0] }] },
    },
  ],
  tissue: { element_size_mm: 5, far_element_size_mm: 5, margin_mm: 10 },
  field: { resolution: 64, band_mm: 4 },
};

/** The server's API, for steps that a test does not do on the page. */
export function api(address) {
  const [base, token] = address.split('#token=');
  const ask = async (method, path, body, headers = {}) => {
    const response = await fetch(`${base}api/v1${path}`, {
      method,
      body,
      headers: { 'X-Lefort-Token': token, ...headers },
    });
    check(`${method} ${path} succeeds: ${response.status}`, response.ok);
    return response;
  };
  const put = (path, value) =>
    ask('PUT', path, JSON.stringify(value), { 'Content-Type': 'application/json', 'If-Match': '*' });
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
/** The head with a cut and a plan, and its server. */
export async function planned() {
  made ??= await (async () => {
    const caseInfo = freshFolder('outcome');
    const server = await serve(caseInfo.folder);
    const { put, run, upload } = api(server.address);
    await run({ kind: 'import', upload: await upload(smallHead(), 'head.nrrd') });
    await run({ kind: 'segment' });
    await put('/landmarks', { landmarks: LANDMARKS });
    await put('/plan', PLAN);
    await run({ kind: 'cut' });
    return { ...caseInfo, server, ...api(server.address) };
  })();
  return made;
}

/** The same with a prediction. */
export async function predicted() {
  const here = await planned();
  const { stages } = await (await here.ask('GET', '/case')).json();
  if (stages.prediction.state !== 'fresh') await here.run({ kind: 'predict' });
  return here;
}

export async function withPage(find, run, options) {
  const here = await find();
  const page = await openPage(here.server.address, options);
  try {
    await settled(page);
    await run(page, here).catch(async (error) => {
      await page.screenshot({ path: join(output, 'failed.png') });
      throw error;
    });
    check(`no errors in the page: ${page.faults.join('; ')}`, page.faults.length === 0);
    check('the page does not scroll', (await page.evaluate(() => document.scrollingElement.scrollTop)) === 0);
  } finally {
    await page.context().close();
  }
}

/** Ends the server and its folder. */
export async function endSmallCase() {
  await made?.server.kill();
  made?.remove();
}
