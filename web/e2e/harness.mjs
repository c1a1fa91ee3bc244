// A browser, a server on a new case folder, and a list of tests that run in sequence.
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';
import { proxyPage } from './page_proxy.mjs';

export const root = new URL('../../', import.meta.url).pathname;
export const lefort = process.env.LEFORT ?? join(root, 'build/release/src/lefort/app/lefort');

const BROWSER = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find((path) => existsSync(path));
const FLAGS = [
  '--no-sandbox',
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

export function scan() {
  const at = [
    process.env.LEFORT_EXAMPLE,
    '/usr/share/doc/invesalius-examples/examples/Cranium.inv3',
    join(root, 'demo-output/invesalius-examples/usr/share/doc/invesalius-examples/examples/Cranium.inv3'),
  ];
  const found = at.find((path) => path && existsSync(path));
  if (!found)
    throw new Error('the example scan is missing: apt-get install invesalius-examples, or set LEFORT_EXAMPLE');
  return found;
}

/** Starts `lefort serve` on a folder; resolves when it has printed its address. */
export async function serve(folder, more = []) {
  const child = spawn(lefort, ['serve', folder, '--port', '0', '--example', scan(), ...more], {
    stdio: ['ignore', 'pipe', 'ignore'],
  });
  const address = await new Promise((done, fail) => {
    let text = '';
    child.stdout.on('data', (part) => {
      text += part;
      const found = /http:\/\/\S+#token=\S+/.exec(text);
      if (found) done(found[0]);
    });
    child.on('exit', (code) => fail(new Error(`lefort serve ended with ${code}`)));
  });
  const ended = new Promise((done) => child.on('exit', done));
  // LEFORT_OWN_PAGE: serves web/dist instead of the page in the program.
  const proxy = process.env.LEFORT_OWN_PAGE ? await proxyPage(address) : null;
  return {
    address: proxy?.address ?? address,
    kill: async (signal = 'SIGTERM') => {
      proxy?.close();
      child.kill(signal);
      await ended;
    },
  };
}

export function freshFolder(name) {
  const folder = mkdtempSync(join(tmpdir(), `lefort-${name}-`));
  return { folder, remove: () => rmSync(folder, { recursive: true, force: true }) };
}

let browser = null;
export async function openBrowser() {
  if (!BROWSER) throw new Error('no Chromium: apt-get install chromium');
  browser ??= await chromium.launch({ executablePath: BROWSER, args: FLAGS });
  return browser;
}

export async function openPage(
  address,
  { width = 1280, height = 800, scheme = 'light', motion = 'no-preference' } = {},
) {
  const context = await (
    await openBrowser()
  ).newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: motion, acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(String(error.stack ?? error)));
  page.on('console', (message) => {
    // The browser also logs refused requests; the tests check how the page handles them.
    if (message.type() === 'error' && !/Failed to load resource/.test(message.text())) page.faults.push(message.text());
  });
  await page.goto(address);
  await page.waitForSelector('.step');
  return page;
}

export async function closeBrowser() {
  await browser?.close();
}

export function check(what, holds) {
  if (!holds) throw new Error(`failed: ${what}`);
}

const tests = [];
export const test = (name, run, { slow = false } = {}) => tests.push({ name, run, slow });

export async function runTests({ all, only }) {
  let passed = 0;
  const failed = [];
  for (const { name, run, slow } of tests) {
    if (only ? !name.includes(only) : slow && !all) continue;
    const since = Date.now();
    try {
      await run();
      passed++;
      console.log(`ok   ${name} (${((Date.now() - since) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failed.push(name);
      console.log(
        `FAIL ${name} (${((Date.now() - since) / 1000).toFixed(1)} s)\n     ${String(error.stack ?? error)
          .split('\n')
          .slice(0, 6)
          .join('\n     ')}`,
      );
    }
  }
  await closeBrowser();
  console.log(`planner: ${passed} passed, ${failed.length} failed`);
  return failed.length === 0;
}
