// The case that the tests of the planner share, and what they check on each page.
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { check, freshFolder, openPage, root, serve } from './harness.mjs';
import { shrinkPng } from './shrink_png.mjs';
import { settled } from './planner.mjs';

const args = process.argv.slice(2);
export const all = args.includes('--all');
export const only = args.includes('--only') ? args[args.indexOf('--only') + 1] : null;

export const output = new URL('output/', import.meta.url).pathname;
mkdirSync(output, { recursive: true });

/** One case shared by the tests; the first test creates it. */
let shared = null;
export async function withShared(run, size) {
  shared ??= await (async () => {
    // LEFORT_CASE: an existing folder, to work on one test.
    const caseInfo = process.env.LEFORT_CASE
      ? { folder: process.env.LEFORT_CASE, remove: () => undefined }
      : freshFolder('planner');
    return { ...caseInfo, server: await serve(caseInfo.folder) };
  })();
  const page = await openPage(shared.server.address, size);
  try {
    await run(page, shared).catch(async (error) => {
      const path = join(output, 'failed.png');
      await page.screenshot({ path, timeout: 180000 }).catch(() => undefined);
      console.log(`     screenshot: ${path}`);
      throw error;
    });
    check(`no errors in the page: ${page.faults.join('; ')}`, page.faults.length === 0);
  } finally {
    await page.context().close();
  }
}

/** Prints a time or a rate and its target. It does not fail the test, because it depends on the load of the machine. */
export function measured(what, value, unit, bound, budget) {
  const met = bound === 'at least' ? value >= budget : value <= budget;
  console.log(`     ${what}: ${value.toFixed(2)} ${unit}, ${bound} ${budget} required: ${met ? 'met' : 'missed'}`);
}

export async function picture(page, name) {
  const path = join(root, 'docs/images', `planner-${name}.png`);
  await page.mouse.move(5, 790);
  await settled(page);
  const small = shrinkPng(await page.screenshot({ timeout: 180000 }));
  writeFileSync(all ? path : join(output, `planner-${name}.png`), small);
  check(`${name}.png is smaller than 300 kB: ${small.length}`, small.length < 300e3);
}

/** Ends the server of the shared case and removes its folder. */
export async function endShared() {
  if (!shared) return;
  await shared.server.kill();
  shared.remove();
}
