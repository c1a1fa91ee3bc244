// The page's budget: everything it may load, compressed, below 3 MB.
import { readdirSync, readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

const LIMIT_BYTES = 3e6;
const dist = new URL('../dist/', import.meta.url);
const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
const bytes = files.reduce(
  (sum, file) => sum + gzipSync(readFileSync(`${file.parentPath ?? file.path}/${file.name}`)).length,
  0,
);
console.log(`page: ${files.length} files, ${(bytes / 1e6).toFixed(3)} MB compressed (limit ${LIMIT_BYTES / 1e6} MB)`);
if (bytes > LIMIT_BYTES) process.exit(1);
