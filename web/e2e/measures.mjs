// Tests of teeth and measures in a browser, on a synthetic head without enamel: canals and their correction, the
// cephalogram, and input that is refused. node e2e/measures.mjs [--only WORDS]; LEFORT names the program.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { accessible } from './accessible.mjs';
import { check, freshFolder, lefort, openPage, runTests, serve, test } from './harness.mjs';
import { handleWhere, id, idle, saved, settled, step } from './planner.mjs';
import { api } from './small_case.mjs';

const args = process.argv.slice(2);
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

let made = null;
/** The head with its true labels and landmarks, and its server. */
async function measured() {
  made ??= await (async () => {
    const [phantom, caseInfo] = [freshFolder('phantom'), freshFolder('measures')];
    const file = (...parts) => join(phantom.folder, ...parts);
    execFileSync(lefort, ['phantom', '--head', 'teeth', '--voxel', '2', '-o', file('head')], { stdio: 'ignore' });
    execFileSync(lefort, ['import', file('head', 'dicom'), '-o', file('ct.nrrd')], { stdio: 'ignore' });
    const server = await serve(caseInfo.folder);
    const { run, upload } = api(server.address);
    await run({ kind: 'import', upload: await upload(readFileSync(file('ct.nrrd')), 'head.nrrd') });
    mkdirSync(join(caseInfo.folder, 'anatomy'), { recursive: true });
    copyFileSync(file('head', 'labels.seg.nrrd'), join(caseInfo.folder, 'anatomy', 'labels.seg.nrrd'));
    copyFileSync(file('head', 'landmarks.mrk.json'), join(caseInfo.folder, 'landmarks.mrk.json'));
    await run({ kind: 'segment', from_labels: true });
    phantom.remove();
    return { ...caseInfo, server };
  })();
  return made;
}

async function withMeasures(measure, run, options = { width: 1440, height: 900 }) {
  const { server } = await measured();
  const page = await openPage(server.address, options);
  try {
    await settled(page);
    await step(page, 'measures');
    await page.click(id(`measure-${measure}`));
    await settled(page);
    await run(page);
    check(`no errors in the page: ${page.faults.join('; ')}`, page.faults.length === 0);
    check('the page does not scroll', (await page.evaluate(() => document.scrollingElement.scrollTop)) === 0);
  } catch (error) {
    await page.screenshot({ path: join(output, 'failed.png') });
    throw error;
  } finally {
    await page.context().close();
  }
}

/** Starts a job by its button, and waits for its end. */
async function runJob(page, kind) {
  await page.click(id(`run-${kind}`));
  await page.waitForTimeout(500); // A job may fail before the page has drawn that it runs.
  await page.waitForSelector(id(`run-${kind}`), { timeout: 300000 });
  await idle(page);
  await settled(page);
}

/** Selects a point of the right canal in 3D, and drags it by pixels on the axial slice. */
async function dragOnSlice(page, name, dx, dy) {
  const view = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
  const [u, v] = await handleWhere(page, name);
  await page.mouse.click(view.x + u, view.y + v);
  await settled(page);
  const axial = page.locator('.slice[data-orientation=axial] canvas');
  // The color of points; the patient's right is on the left.
  const [i, j] = await axial.evaluate((canvas) => {
    const [width, height] = [Math.floor(canvas.width / 2), canvas.height];
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    let [count, x, y] = [0, 0, 0];
    for (let n = 0; n < data.length; n += 4)
      if (Math.abs(data[n] - 242) + Math.abs(data[n + 1] - 178) + Math.abs(data[n + 2] - 27) < 20) {
        count++;
        x += (n / 4) % width;
        y += Math.floor(n / 4 / width);
      }
    const scale = canvas.clientWidth / canvas.width;
    return [(scale * x) / count, (scale * y) / count];
  });
  const box = await axial.boundingBox();
  const [x, y] = [box.x + i, box.y + j];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let n = 1; n <= 6; n++) await page.mouse.move(x + (dx * n) / 6, y + (dy * n) / 6);
  await page.mouse.up();
}

const state = (page, measure) => page.locator('.measure-row', { has: page.locator(id(`measure-${measure}`)) });

test('step 9 is reached by its key; teeth without enamel are refused in one line', () =>
  withMeasures('teeth', async (page) => {
    await step(page, 'case');
    await page.keyboard.press('9');
    await page.waitForSelector('[data-step=measures][aria-current=step]');
    check(
      'the notice is in view',
      await page.getByText('Research software, not for clinical use. Check each result').isVisible(),
    );
    await runJob(page, 'teeth');
    const error = await page.locator('.notice.error').innerText();
    check(`the reason is stated: ${error}`, error.includes('the teeth must show enamel'));
    check('the list shows it', (await state(page, 'teeth').innerText()).includes('failed'));
    await accessible(page, 'a measure that has failed');
  }));

test('intraoral scans that are none are refused in one line', () =>
  withMeasures('arches', async (page) => {
    check('nothing can be registered yet', await page.locator(id('run-arches')).isDisabled());
    check('there is no occlusion without them', await page.locator(id('run-occlusion')).isDisabled());
    const choosing = page.waitForEvent('filechooser');
    await page.click(id('choose-upper'));
    await (
      await choosing
    ).setFiles({ name: 'DOE^JOHN.stl', mimeType: 'application/octet-stream', buffer: Buffer.from('solid no scan') });
    await runJob(page, 'arches');
    const error = await page.locator('.notice.error').innerText();
    check(
      `the jaw is named, the file is not: ${error}`,
      error.includes('upper jaw: the file') && !error.includes('DOE'),
    );
    await page.click(id('measure-splint'));
    await page.getByText('Register the intraoral scans of both jaws first.').waitFor();
    check('there is no splint without scans', await page.locator(id('run-splint')).isDisabled());
    await page.getByRole('button', { name: 'Intermediate', exact: true }).click();
    await accessible(page, 'the splint');
  }));

test('an occlusion of bite scans needs one', () =>
  withMeasures('arches', async (page) => {
    await page.getByRole('button', { name: 'As scanned', exact: true }).click();
    check('no bite scan is required', (await page.locator(id('choose-bite')).count()) === 0);
    await page.getByRole('button', { name: 'Bite scan', exact: true }).click();
    await page.locator(id('choose-bite2')).waitFor();
    await accessible(page, 'the choice of bite scans');
  }));

test('cutting guides need a segment of the plan', () =>
  withMeasures('guides', async (page) => {
    await page.getByText('The plan has no segment.').waitFor();
    check('no guide can be made', await page.locator(id('run-guides')).isDisabled());
    check('the width is that of the program', (await page.inputValue(id('guide-width_mm'))) === '9.0');
    await accessible(page, 'cutting guides');
  }));

test('canals are traced, corrected by a drag, and traced again', () =>
  withMeasures('nerve', async (page) => {
    await runJob(page, 'nerve');
    const rows = await page.locator(`${id('nerve-table')} tbody tr`).allInnerTexts();
    check(`both canals have a length: ${rows}`, rows.length === 2 && rows.every((row) => /\d\d mm/.test(row)));
    await page.screenshot({ path: `${output}/nerve.png` });
    await dragOnSlice(page, 'marker found IAN-R-2', 6, -4);
    await page.waitForSelector(id('nerve-points'));
    check(
      'the point has a number of its own',
      (await page.locator(id('nerve-points')).innerText()).includes('IAN-R-1'),
    );
    await page.getByText('points on the canals were corrected').waitFor();
    check('files are not offered', await page.getByText('Files that are out of date').isVisible());
    await accessible(page, 'a corrected canal');
    await runJob(page, 'nerve');
    await page.getByText('points on the canals were corrected').waitFor({ state: 'detached' });
    check('the list shows it', (await state(page, 'nerve').innerText()).includes('up to date'));
    // The point is still selected; a key removes it.
    await page.locator(`${id('nerve-points')} .list-main`).click();
    if ((await page.locator(`${id('nerve-points')} .list-row.selected`).count()) === 0)
      await page.locator(`${id('nerve-points')} .list-main`).click();
    await page.keyboard.press('Delete');
    await page.waitForSelector(id('nerve-points'), { state: 'detached' });
    await page.getByText('points on the canals were corrected').waitFor();
  }));

test('the cephalogram is shown, measured and downloaded', () =>
  withMeasures('cephalogram', async (page) => {
    await page.getByText('No cephalogram yet').waitFor();
    await runJob(page, 'cephalogram');
    const shown = page.locator(id('radiograph'));
    await shown.waitFor();
    const tracing = await shown.getAttribute('src');
    check('the picture is drawn', (await shown.evaluate((image) => image.naturalWidth)) > 200);
    const rows = await page.locator(`${id('cephalogram-table')} tbody tr`).count();
    check(`${rows} measurements are listed`, rows > 10);
    await page.screenshot({ path: `${output}/cephalogram.png` });
    await accessible(page, 'the cephalogram');
    await page.getByRole('button', { name: 'Frontal', exact: true }).click();
    await page.waitForFunction(
      ([sel, old]) => document.querySelector(sel)?.getAttribute('src') !== old,
      [id('radiograph'), tracing],
    );
    const loading = page.waitForEvent('download');
    await page.click(id('file-cephalometry.pdf'));
    const pdf = readFileSync(await (await loading).path());
    check('the PDF is downloaded', pdf.subarray(0, 5).toString() === '%PDF-');
  }));

test('an airway that the labels do not have is refused in one line', () =>
  withMeasures('airway', async (page) => {
    await runJob(page, 'airway');
    await page.locator('.notice.error').waitFor();
    await accessible(page, 'an airway that has failed');
  }));

test('a request is a field that may be empty', () =>
  withMeasures('arches', async (page) => {
    const overjet = id('request-overjet_mm');
    check('nothing is requested at first', (await page.inputValue(overjet)) === '');
    const type = async (text) => {
      await page.fill(overjet, text);
      await page.keyboard.press('Tab');
      await settled(page);
      return page.inputValue(overjet);
    };
    check('a number is requested', (await type('2.5')) === '2.5');
    check('a number out of range is not taken', (await type('11')) === '2.5');
    check('an emptied field is no request', (await type('')) === '');
    await accessible(page, 'requests of an occlusion');
    await page.getByRole('button', { name: 'As scanned', exact: true }).click();
    check('requests are for a search', (await page.locator(overjet).count()) === 0);
  }));

test('a sagittal split keeps the canals free', () =>
  withMeasures('nerve', async (page) => {
    await step(page, 'osteotomy');
    await page.click(id('template-sagittal-split'));
    await settled(page);
    const keep = page.getByRole('switch', { name: 'Keep the canals free' });
    if (await keep.isDisabled()) {
      await page.getByText('Trace the canals of the nerves first, in step 9.').waitFor();
      await step(page, 'measures');
      await page.click(id('measure-nerve'));
      await runJob(page, 'nerve');
      await step(page, 'osteotomy');
    }
    const placed = page.waitForResponse((response) => response.url().endsWith('/osteotomies'));
    await page.locator('.toggle', { hasText: 'Keep the canals free' }).click();
    const response = await placed;
    check('the canals are kept', response.request().postDataJSON().keep_canals === true);
    // The canals of this head lie close to its lateral cortex, where no split is possible.
    check(`such a split is refused: ${response.status()}`, response.status() === 422);
    await page.getByText('canal lies too lateral').waitFor();
    await page.waitForSelector(id('canals-0'));
    check('the distance is that of the program', (await page.inputValue(id('canals-0'))) === '2.0');
    await accessible(page, 'a split that keeps the canals');
  }));

test('landmarks are found; those that are placed stay', () =>
  withMeasures('cephalogram', async (page) => {
    await step(page, 'landmarks');
    const count = async () => Number((await page.locator('h2 .chip').innerText()).split(' ')[0]);
    const row = (name) => page.locator('.list-row', { has: page.locator(id(`landmark-${name}`)) });
    const all = await count();
    await page.getByRole('button', { name: 'Remove menton', exact: true }).click();
    check('menton is removed', (await count()) === all - 1);
    await saved(page);
    await runJob(page, 'landmarks');
    await page.waitForFunction(([sel]) => document.querySelector(sel)?.textContent.includes('±'), [id('landmark-Me')]);
    check(`it is found: ${await row('Me').innerText()}`, /± \d\.\d mm/.test(await row('Me').innerText()));
    check('the others stay as they were', !(await row('Pg').innerText()).includes('±'));
    check('nothing that is placed is listed as missing', (await page.locator(id('landmarks-missing')).count()) === 0);
    await page.screenshot({ path: `${output}/landmarks-found.png` });
    await accessible(page, 'landmarks that were found');
    await page.keyboard.press('Control+z');
    check('one undo removes what was placed', (await count()) === all - 1);
    await page.keyboard.press('Control+z');
    check('the next one restores menton', (await count()) === all);
    await saved(page);
  }));

const ok = await runTests({ all: false, only });
await made?.server.kill();
made?.remove();
process.exit(ok ? 0 : 1);
