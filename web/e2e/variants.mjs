// Tests of variants of the plan in a browser, on a synthetic head that is solved in seconds.
// node e2e/variants.mjs [--only WORDS]; LEFORT names the program.
import { mkdirSync, readFileSync } from 'node:fs';
import { accessible } from './accessible.mjs';
import { check, openPage, runTests, serve, test } from './harness.mjs';
import { id, idle, saved, settled, step } from './planner.mjs';
import { endSmallCase, PLAN, predicted, withPage } from './small_case.mjs';

const args = process.argv.slice(2);
const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;
const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

/** The plan with the segment moved forward by another length. */
function planOf(mm) {
  const plan = structuredClone(PLAN);
  plan.segments[0].path.keyframes[0].translation_mm = [0, -mm, 0];
  return plan;
}

const variant = (page, name) => page.locator(id(`variant-${name}`));
const textOf = (page, name) => variant(page, name).innerText();

async function showPlans(page) {
  await step(page, 'compare');
  await page.getByRole('button', { name: 'Plans', exact: true }).click();
  await settled(page);
}

async function keep(page, name) {
  await page.fill(id('variant-name'), name);
  await page.click(id('keep-variant'));
}

test('a plan is kept once it is checked; a bad name is refused', () =>
  withPage(predicted, async (page, { run }) => {
    await showPlans(page);
    await page.getByText('No variants yet').waitFor();
    await page.getByText('The plan is not checked.').waitFor();
    check('nothing can be kept yet', await page.locator(id('keep-variant')).isDisabled());
    await run({ kind: 'check' });
    await page.waitForSelector(`${id('keep-variant')}:not([disabled])`);
    for (const [name, reason] of [
      ['one/two', 'letters without accents'],
      ['', 'Give it a name'],
      ['x'.repeat(41), 'more than 40'],
    ]) {
      await keep(page, name);
      const error = await page.locator('.notice.error').innerText();
      check(`${name}: the reason is stated: ${error}`, error.includes(reason));
      check('the name stays', (await page.inputValue(id('variant-name'))) === name);
    }
    await page.fill(id('variant-name'), 'three-mm');
    await page.press(id('variant-name'), 'Enter');
    await variant(page, 'three-mm').waitFor();
    check(`it has a face: ${await textOf(page, 'three-mm')}`, /· face · current/.test(await textOf(page, 'three-mm')));
    check('it cannot be loaded over itself', await page.locator(id('load-three-mm')).isDisabled());
    await keep(page, 'three-mm');
    await page.getByText('There is a variant three-mm').waitFor();
    check('one variant cannot be compared', await page.locator(id('run-variants')).isDisabled());
    await accessible(page, 'a variant');
  }));

test('three plans are put side by side, and downloaded', () =>
  withPage(predicted, async (page, { put, run }) => {
    await showPlans(page);
    await put('/plan', planOf(5));
    await run({ kind: 'check' });
    await run({ kind: 'predict' });
    await keep(page, 'five-mm');
    await variant(page, 'five-mm').waitFor();
    await put('/plan', planOf(1));
    await page.getByText('The check is out of date').waitFor();
    check('an old check is not kept', await page.locator(id('keep-variant')).isDisabled());
    await run({ kind: 'check' });
    await page.getByText('It is kept without a face: its prediction is out of date.').waitFor();
    await keep(page, 'one-mm');
    await variant(page, 'one-mm').waitFor();
    check(`it has no face: ${await textOf(page, 'one-mm')}`, (await textOf(page, 'one-mm')).includes('no face'));
    await page.click(id('run-variants'));
    await page.locator(id('side-by-side')).first().waitFor();
    await idle(page);
    await page.getByText('variant one-mm has no predicted face').waitFor();
    const table = await page.locator(id('side-by-side')).first().innerText();
    for (const words of ['five-mm', '5.0 forward', '3.0 forward', '1.0 forward'])
      check(`the table has ${words}: ${table}`, table.includes(words));
    await settled(page);
    await page.screenshot({ path: `${output}/variants.png` });
    await accessible(page, 'three variants side by side');
    for (const [file, beginning] of [
      ['variants.pdf', '%PDF-'],
      ['variants.html', '<!'],
      ['variants.csv', '"segment'],
    ]) {
      const loading = page.waitForEvent('download');
      await page.click(id(`file-${file}`));
      const text = readFileSync(await (await loading).path());
      check(`${file} is downloaded`, text.subarray(0, 40).toString().startsWith(beginning));
    }
    await page.getByLabel('Show one-mm side by side').uncheck();
    await page.getByText('The tables are of').waitFor();
    await page.click(id('run-variants'));
    await page.getByText('The tables are of').waitFor({ state: 'detached' });
    await idle(page);
    await settled(page);
    await page.mouse.move(5, 790);
    await page.screenshot({ path: `${output}/variants-two.png` });
    await page.setViewportSize({ width: 760, height: 800 });
    await settled(page);
    await page.locator(id('side-by-side')).first().scrollIntoViewIfNeeded();
    await page.screenshot({ path: `${output}/variants-narrow.png` });
  }));

test('a variant is loaded with its results after a confirmation, and undone', () =>
  withPage(predicted, async (page, { ask, put }) => {
    await put('/plan', planOf(2));
    await page.reload(); // The change was that of another page.
    await settled(page);
    await showPlans(page);
    const shift = async () => {
      const plan = await (await ask('GET', '/plan')).json();
      return -plan.segments[0].path.keyframes[0].translation_mm[1];
    };
    await page.click(id('load-five-mm'));
    await page.screenshot({ path: `${output}/variants-confirm.png` });
    await accessible(page, 'the confirmation');
    await page.click(id('confirm-no'));
    check('nothing is replaced', (await shift()) === 2);
    await page.click(id('load-five-mm'));
    await page.keyboard.press('Escape');
    await page.waitForSelector(id('confirm'), { state: 'detached' });
    await page.click(id('load-five-mm'));
    await page.click(id('confirm-yes'));
    await page.getByText('The variant five-mm is the current plan.').waitFor();
    check('the plan is that of the variant', (await shift()) === 5);
    const { stages } = await (await ask('GET', '/case')).json();
    check('the check is up to date', stages.check.state === 'fresh');
    check('the prediction is up to date', stages.prediction.state === 'fresh');
    check('no other page is named', (await page.getByText('on another page').count()) === 0);
    await page.getByRole('button', { name: 'Faces', exact: true }).click();
    await page.waitForSelector(id('distance-table'));
    await page.keyboard.press('Control+z');
    await saved(page);
    check('the earlier plan is there again', (await shift()) === 2);
  }));

test('variants outlive a restart of the server; one is deleted after a confirmation', () =>
  withPage(predicted, async (page, { folder, server }) => {
    await server.kill('SIGKILL');
    const next = await serve(folder);
    const other = await openPage(next.address);
    await settled(other);
    await showPlans(other);
    check('all are there', (await other.locator('.variant-row').count()) === 3);
    await other.getByRole('button', { name: 'Delete one-mm', exact: true }).click();
    await other.click(id('confirm-no'));
    check('all are there still', (await other.locator('.variant-row').count()) === 3);
    await other.getByRole('button', { name: 'Delete one-mm', exact: true }).click();
    await other.click(id('confirm-yes'));
    await variant(other, 'one-mm').waitFor({ state: 'detached' });
    check('the others stay', (await other.locator('.variant-row').count()) === 2);
    check(`no errors in the page: ${other.faults.join('; ')}`, other.faults.length === 0);
    await other.context().close();
    await next.kill();
  }));

const good = await runTests({ all: true, only });
await endSmallCase();
process.exit(good ? 0 : 1);
