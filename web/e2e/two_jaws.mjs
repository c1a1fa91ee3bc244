// The path of a surgeon with two jaws in a browser, from DICOM files and intraoral scans to files for a printer and the
// predicted face: docs/guide/surgeon.md. Nothing is typed but lengths.
// node e2e/two_jaws.mjs FOLDER [--predict] [-- OPTIONS]
//   FOLDER   pictures and downloads; the head and the case are put there, too. A head that is there is not made again:
//            FOLDER/head has dicom/ or ct.nrrd, and the scans upper_scan.stl, lower_scan.stl and bite_scan.stl
//   OPTIONS  of `lefort phantom --head dentition`: default --retrusion 5 --deviation 2
// LEFORT names the program.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, statSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { check, closeBrowser, lefort, openPage, serve } from './harness.mjs';
import { dot, id, idle, saved, settled, step, type } from './planner.mjs';

const args = process.argv.slice(2);
const folder = resolve(args[0] ?? 'two-jaws');
const options = args.includes('--') ? args.slice(args.indexOf('--') + 1) : ['--retrusion', '5', '--deviation', '2'];
mkdirSync(folder, { recursive: true });
const head = join(folder, 'head');
if (!existsSync(head))
  execFileSync(lefort, ['phantom', '--head', 'dentition', ...options, '-o', head], { stdio: 'inherit' });
const server = await serve(join(folder, 'case'));
// Without a GPU the animation of a running job needs a core, which the job then lacks.
const page = await openPage(server.address, { width: 1440, height: 900, motion: 'reduce' });
const started = Date.now();
let since = started;

/** Notes the time and takes a picture. */
async function done(name) {
  await settled(page);
  const faults = page.faults.splice(0);
  check(`no errors in the page: ${faults.join('; ')}`, faults.length === 0);
  const notices = await page.locator('.notice').allInnerTexts();
  console.log(`${((Date.now() - since) / 1000).toFixed(0).padStart(5)} s  ${name}`);
  for (const text of notices) console.log(`         ${text.replace(/\s+/g, ' ')}`);
  await page.screenshot({ path: join(folder, `${name}.png`) });
  since = Date.now();
}

async function choose(button, file) {
  const choosing = page.waitForEvent('filechooser');
  await page.click(button);
  await (await choosing).setFiles(file);
}

/** Starts a job by its button, and waits until the server has ended it and the page shows that. */
async function press(button, timeout = 900000) {
  const isStart = (response) =>
    response.request().method() === 'POST' && new URL(response.url()).pathname.endsWith('/jobs');
  const [accepted] = await Promise.all([page.waitForResponse(isStart), page.click(id(button))]);
  const url = `${accepted.url()}/${(await accepted.json()).id}`;
  const headers = { 'X-Lefort-Token': accepted.request().headers()['x-lefort-token'] };
  const until = Date.now() + timeout;
  for (;;) {
    const { state, message } = await (await page.request.get(url, { headers })).json();
    if (state === 'done') break;
    check(`${button}: ${state} ${message}`, state === 'queued' || state === 'running');
    check(`${button} ends within ${timeout / 1000} s`, Date.now() < until);
    await page.waitForTimeout(200);
  }
  await idle(page, timeout);
  await settled(page);
}

async function runJob(kind) {
  await press(`run-${kind}`);
  const failed = await page.locator('.notice.error').allInnerTexts();
  check(`${kind}: ${failed.join(' ')}`, failed.length === 0);
}

async function measure(name) {
  await step(page, 'measures');
  await page.click(id(`measure-${name}`));
  await settled(page);
}

const named = (name) => page.getByRole('button', { name, exact: true });
const textOf = async (name) => (await page.locator(id(name)).innerText()).replace(/\s+/g, ' ');

async function download(name) {
  const loading = page.waitForEvent('download');
  await page.click(id(`file-${name}`));
  const file = join(folder, name);
  await (await loading).saveAs(file);
  check(`${name} is not empty`, statSync(file).size > 1000);
}

async function anatomy() {
  if (existsSync(join(head, 'dicom'))) await choose('text=Choose a folder', join(head, 'dicom'));
  else await choose('text=Choose files', join(head, 'ct.nrrd'));
  await dot(page, 'case', 'fresh');
  await done('01-scan');
  await step(page, 'anatomy');
  if (!(await page.locator('[data-step=anatomy] .dot.fresh').count())) await dot(page, 'anatomy', 'fresh');
  await idle(page);
  await done('02-anatomy');
  await step(page, 'landmarks');
  await settled(page);
  await runJob('landmarks');
  await saved(page);
  const placed = Number((await page.locator('h2 .chip').innerText()).split(' ')[0]);
  check(`${placed} landmarks are placed`, placed > 40);
  await done('03-landmarks');
}

async function dental() {
  await measure('teeth');
  await runJob('teeth');
  await done('04-teeth');
  await page.click(id('measure-arches'));
  await choose(id('choose-upper'), join(head, 'upper_scan.stl'));
  await choose(id('choose-lower'), join(head, 'lower_scan.stl'));
  await runJob('arches');
  await done('05-scans');
  await runJob('occlusion');
  await done('06-occlusion-search');
  await named('Bite scan').click();
  await choose(id('choose-bite'), join(head, 'bite_scan.stl'));
  await runJob('occlusion');
  await done('07-occlusion-bite');
  await page.click(id('measure-nerve'));
  await runJob('nerve');
  await done('08-canals');
}

async function plan() {
  await step(page, 'osteotomy');
  await settled(page);
  for (const kind of ['le-fort-1', 'sagittal-split']) {
    await page.click(id(`template-${kind}`));
    await saved(page);
  }
  await press('cut');
  await dot(page, 'osteotomy', 'fresh');
  await done('09-cut');
  await step(page, 'movement');
  await settled(page);
  await named('le-fort-1').click();
  await type(page, 'move-anterior', 2);
  await type(page, 'move-superior', 2);
  await saved(page);
  await named('sagittal-split').click();
  await page.click(id('to-occlusion'));
  await saved(page);
  console.log(`         mandible: ${await textOf('in-words')}`);
  await done('10-movement');
  await checkPlan();
  await done('11-check');
}

async function checkPlan() {
  await step(page, 'movement');
  await press('check');
}

async function print() {
  await measure('splint');
  await named('Intermediate').click();
  await page.fill(id('splint-text'), 'STEP 1');
  await runJob('splint');
  await done('12-intermediate-splint');
  await named('Final').click();
  await page.fill(id('splint-text'), 'FINAL');
  await type(page, 'splint-open_mm', 3);
  await runJob('splint');
  await done('13-final-splint');
  for (const name of ['splint_final.3mf', 'splint_final.stl']) await download(name);
  await named('Intermediate').click();
  for (const name of ['splint_intermediate.3mf', 'splint_intermediate.stl']) await download(name);
  await page.click(id('measure-guides'));
  await runJob('guides');
  await done('14-guides');
  for (const one of await page.locator('[data-id^="file-guide_"]').all())
    await download((await one.getAttribute('data-id')).slice('file-'.length));
  await checkPlan(); // The worksheet names the splints and guides.
  await done('15-worksheet');
}

async function measures(words) {
  // A CT that is made from labels has no airway.
  for (const name of existsSync(join(head, 'dicom')) ? ['cephalogram', 'airway'] : ['cephalogram']) {
    await measure(name);
    await runJob(name);
    await done(`${words}-${name}`);
  }
}

async function predict() {
  await step(page, 'predict');
  await press('predict', 7200000);
  await dot(page, 'predict', 'fresh');
  await done('17-predicted');
  await step(page, 'compare');
  await done('18-compared');
  await measures('19');
}

let code = 0;
try {
  await anatomy();
  await dental();
  await plan();
  await print();
  await measures('16');
  if (args.includes('--predict')) await predict();
  console.log(`${((Date.now() - started) / 60000).toFixed(1)} minutes`);
} catch (error) {
  console.log(String(error.stack ?? error));
  await page.screenshot({ path: join(folder, 'failed.png') });
  code = 1;
}
await closeBrowser();
await server.kill();
process.exit(code);
