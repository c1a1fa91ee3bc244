import { defineConfig } from 'vitest/config';

export default defineConfig({
  base: './',
  // The contract lies beside web/, and `npm run dev` passes the API on to a server that runs already.
  server: {
    fs: { allow: ['..'] },
    proxy: { '/api': process.env.LEFORT_SERVER ?? 'http://127.0.0.1:8080' },
  },
  build: { target: 'es2022', chunkSizeWarningLimit: 1500, reportCompressedSize: true },
  worker: { format: 'es' },
  test: { include: ['tests/**/*.test.ts'] },
});
