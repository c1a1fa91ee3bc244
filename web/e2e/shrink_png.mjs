// Compresses a PNG of a browser. The lowest bit of each color is cleared, which is noise in a scan and invisible in a
// page. RFC 2083.
import { deflateSync, inflateSync } from 'node:zlib';

const BYTES = { 2: 3, 6: 4 };

/** CRC of a PNG's chunks (RFC 2083, appendix 15); Node.js 18, which Debian 12 has, brings none. */
function crc(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) {
    c ^= byte;
    for (let k = 0; k < 8; k++) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  }
  return (c ^ 0xffffffff) >>> 0;
}

function chunk(type, data) {
  const out = Buffer.alloc(12 + data.length);
  out.writeUInt32BE(data.length, 0);
  out.write(type, 4, 'latin1');
  data.copy(out, 8);
  out.writeUInt32BE(crc(out.subarray(4, 8 + data.length)), 8 + data.length);
  return out;
}

const paeth = (a, b, c) => {
  const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
  return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
};

const predictors = [() => 0, (a) => a, (_, b) => b, (a, b) => (a + b) >> 1, paeth];

/** Converts 8-bit RGB or RGBA without interlacing to RGB. */
export function shrinkPng(png) {
  const width = png.readUInt32BE(16);
  const height = png.readUInt32BE(20);
  const size = BYTES[png[25]];
  if (png[24] !== 8 || !size || png[28] !== 0) throw new Error('shrink_png: not an 8-bit RGB or RGBA picture');
  const parts = [];
  for (let at = 8; at < png.length; ) {
    const length = png.readUInt32BE(at);
    if (png.toString('latin1', at + 4, at + 8) === 'IDAT') parts.push(png.subarray(at + 8, at + 8 + length));
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(parts));
  const line = width * size;
  let above = new Uint8Array(line);
  const rgb = Buffer.alloc(width * height * 3);
  for (let y = 0; y < height; y++) {
    const predict = predictors[raw[y * (line + 1)]];
    const row = new Uint8Array(line);
    for (let x = 0; x < line; x++)
      row[x] =
        raw[y * (line + 1) + 1 + x] + predict(x < size ? 0 : row[x - size], above[x], x < size ? 0 : above[x - size]);
    for (let x = 0; x < width; x++)
      for (let c = 0; c < 3; c++)
        rgb[(y * width + x) * 3 + c] = row[x * size + c] > 253 ? 255 : row[x * size + c] & 254;
    above = row;
  }
  const filtered = Buffer.alloc(height * (width * 3 + 1));
  const bytes = width * 3;
  const tries = predictors.map(() => new Uint8Array(bytes));
  for (let y = 0; y < height; y++) {
    let best = 0;
    let least = Infinity;
    predictors.forEach((predict, kind) => {
      let sum = 0;
      for (let x = 0; x < bytes; x++) {
        const at = y * bytes + x;
        const a = x < 3 ? 0 : rgb[at - 3];
        const b = y === 0 ? 0 : rgb[at - bytes];
        const c = x < 3 || y === 0 ? 0 : rgb[at - bytes - 3];
        const d = (rgb[at] - predict(a, b, c)) & 255;
        tries[kind][x] = d;
        sum += d < 128 ? d : 256 - d;
      }
      if (sum < least) {
        least = sum;
        best = kind;
      }
    });
    filtered[y * (bytes + 1)] = best;
    filtered.set(tries[best], y * (bytes + 1) + 1);
  }
  const head = Buffer.from(png.subarray(16, 29));
  head[9] = 2;
  return Buffer.concat([
    png.subarray(0, 8),
    chunk('IHDR', head),
    chunk('IDAT', deflateSync(filtered, { level: 9, memLevel: 9 })),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}
