// Tests of results in a browser, on a synthetic head that is solved in seconds: iterations, contact on the bone,
// the face after surgery, outlines on slices. node e2e/outcome.mjs [--only WORDS]; LEFORT names the program.
import { mkdirSync, readFileSync } from 'node:fs';
import { accessible } from './accessible.mjs';
import { check, runTests, test } from './harness.mjs';
import { handleWhere, idle, id, look, saved, settled, step } from './planner.mjs';
import { endSmallCase, PLAN, planned, predicted, smallHead, withPage } from './small_case.mjs';

const args = process.argv.slice(2);
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

async function chooseFile(page, button, name, buffer) {
  const choosing = page.waitForEvent('filechooser');
  await page.click(id(button));
  await (await choosing).setFiles({ name, mimeType: 'application/octet-stream', buffer });
}

const rows = (page, name) => page.locator(`${id(name)} tbody tr`).allInnerTexts();

test('every iteration of a solve is plotted', () =>
  withPage(planned, async (page, { ask }) => {
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

test('displacement by region, at every step', () =>
  withPage(predicted, async (page) => {
    await step(page, 'compare');
    await page.waitForSelector(id('distance-table'));
    const last = await rows(page, 'distance-table');
    check(
      `nose and upper lip have values: ${last}`,
      ['Whole skin', 'Moved', 'Nose', 'Upper lip'].every((name) => last.some((row) => row.startsWith(name))),
    );
    await page.locator(id('compare-step')).fill('1');
    await page.waitForFunction(
      ([sel, old]) => document.querySelector(`${sel} tbody tr`)?.innerText !== old,
      [id('distance-table'), last[0]],
    );
  }));

test('contact is shown on the bone', () =>
  withPage(predicted, async (page) => {
    await step(page, 'compare');
    await page.waitForSelector(id('distance-table'));
    await page.getByText('Bones under transparent skin').click();
    for (const [name, unit] of [
      ['Pressure', 'kPa'],
      ['Depth', 'mm'],
    ]) {
      await page.getByRole('button', { name, exact: true }).click();
      await page.waitForFunction(
        ([sel, words]) => document.querySelector(sel)?.innerText.includes(words),
        [id('bone-legend'), unit],
      );
    }
    await page.locator(id('compare-step')).fill('1');
    await page.getByText('Contact is stored for the last step only').waitFor();
  }));

test('comparison with a face after surgery; an unreadable file is reported', () =>
  withPage(
    predicted,
    async (page, { ask }) => {
      await step(page, 'compare');
      await page.waitForSelector(id('distance-table'));
      await chooseFile(page, 'compare-files', 'after.vtp', Buffer.from('no surface'));
      await page.getByText('The comparison failed').waitFor({ timeout: 120000 });
      // The same head: surgery has moved nothing.
      await chooseFile(page, 'compare-files', 'after.nrrd', smallHead());
      await page.getByText('front has not moved').waitFor({ timeout: 120000 });
      const achieved = await page.locator(id('achieved')).innerText();
      check(
        `the difference from the plan is its 3 mm: ${achieved}`,
        achieved.includes('Difference from the plan: translation 3.0 mm'),
      );
      await page.getByRole('button', { name: 'After surgery', exact: true }).click();
      await idle(page);
      await chooseFile(
        page,
        'compare-files',
        'DOE^JOHN.vtp',
        Buffer.from(await (await ask('GET', '/files/skin_before.vtp')).arrayBuffer()),
      );
      // A surface has no bone: the table of the earlier comparison is gone with its movement.
      await page.waitForSelector(id('achieved'), { state: 'detached' });
      await page.waitForSelector(id('error-table'), { timeout: 120000 });
      await page.waitForSelector(id('error-legend'));
      const [whole] = (await rows(page, 'error-table')).map((row) => row.split(/\s*\t\s*/));
      check(
        `the baseline is zero, and the prediction has an error: ${whole}`,
        Number(whole[2]) > 0.5 && whole[3] === '0.0' && whole[4] === '0.0',
      );
      await accessible(page, 'the dark comparison');
    },
    { scheme: 'dark' },
  ));

test('the band by uncertain inputs: computed, shown, and marked with another plan', () =>
  withPage(
    predicted,
    async (page, { put }) => {
      await step(page, 'compare');
      await page.getByRole('button', { name: 'Uncertainty', exact: true }).click();
      await page.getByText('No band yet').first().waitFor();
      await accessible(page, 'the page without a band');
      await page.fill(id('band-count'), '40');
      await page.press(id('band-count'), 'Enter');
      await page.click(id('compute-band'));
      await page.waitForSelector(`${id('band-stage')}:not(:empty)`);
      await page.click(id('stop-band'));
      await page.getByText('Solved samples are stored').waitFor({ timeout: 60000 });
      await page.click(id('compute-band'));
      await page.waitForSelector(id('band-table'), { timeout: 300000 });
      await idle(page);
      await settled(page);
      const table = await rows(page, 'band-table');
      check(`the moved skin and regions have widths: ${table}`, table[0].startsWith('Moved skin') && table.length >= 3);
      const [, mean, most] = table[0].split(/\s*\t\s*/).map(Number);
      check(`the mean width ${mean} is below the largest ${most}`, mean > 0.1 && mean < most);
      const top = Number((await page.locator(`${id('band-legend')} .ticks span`).allInnerTexts()).at(-2));
      check(`the legend ends at ${top} mm`, top >= most);
      check('as many bars as regions', (await page.locator('.sobol-bar').count()) === table.length);
      check('a profile is drawn', (await page.getAttribute(`${id('band-profile')} path >> nth=1`, 'd')).length > 100);
      check('the convergence is drawn', Number(await page.getAttribute(id('convergence'), 'data-rows')) >= 1);
      const samples = await page.locator(id('band-samples')).innerText();
      check(`the samples are counted: ${samples}`, /Samples,[^\n]*\n+\s*40/.test(samples));
      const inputs = await page.locator(id('band-inputs')).innerText();
      check(`inputs have sources: ${inputs}`, inputs.includes('Poisson') && inputs.includes('Source: assumed'));
      const scope = await page.locator(id('band-scope')).innerText();
      check(
        `what the band covers is said: ${scope}`,
        scope.includes('named inputs only') && scope.includes('not for clinical use'),
      );
      await accessible(page, 'the band');
      await page.screenshot({ path: `${output}/band.png` });
      for (const part of ['sobol', 'band-samples', 'compute-band']) {
        await page.locator(id(part)).evaluate((element) => element.scrollIntoView({ block: 'center' }));
        await page.screenshot({ path: `${output}/band-${part}.png` });
      }
      const loading = page.waitForEvent('download');
      await page.click(id('band-report'));
      const report = readFileSync(await (await loading).path(), 'utf8');
      check('the report is that of the band', report.includes('Sobol') && report.includes('not for clinical use'));
      await put('/plan', {
        ...PLAN,
        segments: [
          { ...PLAN.segments[0], path: { steps: 4, keyframes: [{ path_fraction: 1, translation_mm: [0, -2, 0] }] } },
        ],
      });
      await page.waitForSelector(id('stale-band'));
      await page.getByText('this band is of another plan or scan').first().waitFor();
      check('a band that is out of date is not exported', (await page.locator(id('band-report')).count()) === 0);
      await page.screenshot({ path: `${output}/band-stale.png` });
      await put('/plan', PLAN);
      await page.waitForSelector(id('band-banner'));
      await page.getByRole('button', { name: 'Faces', exact: true }).click();
      await page.waitForSelector(id('distance-table'));
    },
    { width: 1440, height: 900 },
  ));

test('slices show the bone before and after, with the keyboard only', () =>
  withPage(planned, async (page) => {
    await page.keyboard.press('5');
    await page.waitForSelector('[data-step=movement][aria-current=step]');
    const toggle = page.getByLabel('Slices with the moved outline');
    await toggle.focus();
    await page.keyboard.press('Space');
    await page.waitForSelector('.views[data-layout=slices]');
    await settled(page);
    // The outline's color, which differs from all grays of the scan.
    const blue = await page.locator('.slice[data-orientation=sagittal] canvas').evaluate((canvas) => {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let n = 0; n < data.length; n += 4)
        if (data[n + 2] > data[n] + 60 && data[n + 2] > data[n + 1] + 20) count++;
      return count;
    });
    check(`the outline is drawn: ${blue} pixels`, blue > 200);
  }));

test('slices follow a bone while it is dragged', () =>
  withPage(planned, async (page) => {
    await step(page, 'movement');
    await page.getByText('Slices with the moved outline').click();
    await page.waitForSelector('.views[data-layout=slices]');
    await look(page, 'From the patient’s right');
    await settled(page);
    const sagittal = page.locator('.slice[data-orientation=sagittal] canvas');
    const shown = () => sagittal.evaluate((canvas) => canvas.toDataURL());
    const [u, v] = await handleWhere(page, 'translate AP +');
    const box = await page.locator('.view3d canvas:not(.overlay)').boundingBox();
    const before = await shown();
    await page.mouse.move(box.x + u, box.y + v);
    await page.mouse.down();
    for (let n = 1; n <= 20; n++) await page.mouse.move(box.x + u + 2 * n, box.y + v);
    await page.waitForTimeout(500);
    const amid = await shown();
    await page.mouse.up();
    check('the outline moves during the drag', amid !== before);
    await settled(page);
    await page.keyboard.press('Control+z');
    await saved(page);
  }));

test('a page that is reloaded during or after a solve shows the earlier iterations', () =>
  withPage(planned, async (page, { put }) => {
    await put('/plan', {
      ...PLAN,
      segments: [
        { ...PLAN.segments[0], path: { steps: 8, keyframes: [{ path_fraction: 1, translation_mm: [0, -3.5, 0] }] } },
      ],
    });
    await step(page, 'predict');
    await page.click(id('predict'));
    await page.waitForSelector(id('iterate-now'), { timeout: 120000 });
    const points = () => page.getAttribute(id('residual-plot'), 'data-points').then(Number);
    const steps = () => page.locator(`${id('step-table')} tbody tr`).count();
    const before = await points();
    await page.reload();
    await page.waitForSelector(id('residual-plot'), { timeout: 60000 });
    check(`as many iterations as before: ${before}, ${await points()}`, (await points()) >= before);
    await page.waitForSelector(id('to-compare'), { timeout: 120000 });
    await idle(page);
    const all = await points();
    await page.reload();
    await page.waitForFunction(
      ([sel, n]) => Number(document.querySelector(sel)?.dataset.points) === n,
      [id('residual-plot'), all],
    );
    check('each step once', (await steps()) === 8);
    await put('/plan', PLAN);
  }));

test('a solve that is resumed shows its progress at once', () =>
  withPage(planned, async (page, { put }) => {
    await put('/plan', {
      ...PLAN,
      segments: [
        { ...PLAN.segments[0], path: { steps: 40, keyframes: [{ path_fraction: 1, translation_mm: [0, -3.7, 0] }] } },
      ],
    });
    await step(page, 'predict');
    await page.click(id('predict'));
    const rowsOf = `${id('step-table')} tbody tr`;
    await page.waitForFunction(([sel, n]) => document.querySelectorAll(sel).length >= n, [rowsOf, 3], {
      timeout: 120000,
    });
    await page.click(id('stop-predict'));
    await page.getByText('Stopped', { exact: true }).waitFor({ timeout: 60000 });
    await page
      .getByRole('button', { name: /predict/i })
      .last()
      .click();
    await page.waitForSelector(id('stop-predict'));
    // The earlier steps arrive one by one.
    await page.waitForFunction(([sel, n]) => document.querySelectorAll(sel).length >= n, [rowsOf, 3], {
      timeout: 120000,
    });
    const first = (await page.locator(rowsOf).allInnerTexts()).map((row) => Number(row.split(/\s/)[0]));
    check(`all earlier steps are shown: ${first}`, first.length >= 3 && first.at(-1) === 1);
    await page.click(id('stop-predict')).catch(() => undefined);
    await idle(page);
    await put('/plan', PLAN);
  }));

const ok = await runTests({ all: false, only });
await endSmallCase();
process.exit(ok ? 0 : 1);
