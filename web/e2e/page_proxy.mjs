// Serves web/dist and forwards /api to `lefort serve`: for work on the page without a build of the program.
import { createServer, request } from 'node:http';
import { createReadStream, existsSync } from 'node:fs';
import { extname, join } from 'node:path';

const TYPES = {
  '.html': 'text/html',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.svg': 'image/svg+xml',
  '.woff2': 'font/woff2',
};
const dist = new URL('../dist/', import.meta.url).pathname;

/** Resolves with the address to open instead of the server's own, and a way to end. */
export async function proxyPage(address) {
  const target = new URL(address);
  // As strict as the server is with its own page.
  const probe = await fetch(target.origin + '/');
  const policy = probe.headers.get('content-security-policy') ?? '';
  const proxy = createServer((req, res) => {
    const path = new URL(req.url, 'http://page').pathname;
    if (path.startsWith('/api/')) {
      const headers = { ...req.headers, host: target.host };
      if (headers.origin) headers.origin = target.origin;
      const onward = request(
        { host: target.hostname, port: target.port, path: req.url, method: req.method, headers },
        (answer) => {
          res.writeHead(answer.statusCode, answer.headers);
          answer.pipe(res);
        },
      );
      onward.on('error', () => res.destroy());
      res.on('close', () => onward.destroy());
      req.pipe(onward);
      return;
    }
    const file = join(dist, path === '/' ? 'index.html' : path);
    if (!file.startsWith(dist) || !existsSync(file)) {
      res.writeHead(404).end();
      return;
    }
    res.writeHead(200, {
      'Content-Type': TYPES[extname(file)] ?? 'application/octet-stream',
      'Content-Security-Policy': policy,
    });
    createReadStream(file).pipe(res);
  });
  await new Promise((done) => proxy.listen(0, '127.0.0.1', done));
  return {
    address: `http://127.0.0.1:${proxy.address().port}/${target.hash}`,
    close: () => {
      proxy.closeAllConnections();
      proxy.close();
    },
  };
}
