// Fails if files of src/ import each other in a circle. Imports of types count. Part of `npm run lint`.
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';

const root = resolve(process.argv[2] ?? 'src');
const IMPORT = /^\s*(?:import|export)\b[^'"]*?\bfrom\s*['"](\.[^'"]+)['"]|^\s*import\s*['"](\.[^'"]+)['"]/gm;

const files = readdirSync(root, { recursive: true })
  .map((name) => join(root, name))
  .filter((path) => path.endsWith('.ts'));

/** Files that a file imports. */
const imports = new Map(
  files.map((path) => {
    const found = [...readFileSync(path, 'utf8').matchAll(IMPORT)].map((match) => match[1] ?? match[2]);
    const targets = found.flatMap((name) => {
      const base = resolve(dirname(path), name);
      return [`${base}.ts`, join(base, 'index.ts')].filter(existsSync).slice(0, 1);
    });
    return [path, targets];
  }),
);

const done = new Set();
const cycles = [];

/** Depth-first search; `trail` is the chain of imports that leads to `path`. */
function visit(path, trail) {
  const start = trail.indexOf(path);
  if (start >= 0) {
    cycles.push([...trail.slice(start), path].map((file) => relative(root, file)).join(' -> '));
    return;
  }
  if (done.has(path)) return;
  for (const target of imports.get(path) ?? []) visit(target, [...trail, path]);
  done.add(path);
}

for (const path of files) visit(path, []);
if (files.length === 0) cycles.push(`no sources in ${root}`);
for (const cycle of cycles) console.error(`import cycle: ${cycle}`);
process.exit(cycles.length > 0 ? 1 : 0);
