import type { DrawnSurface, Surface } from '../model';

let worker: Worker | null = null;
let next = 0;
const waiting = new Map<number, (ready: DrawnSurface) => void>();

/** Makes a surface ready to be drawn, beside the page. The surface's arrays go over to the worker. */
export function prepareSurfaceAside(surface: Surface): Promise<DrawnSurface> {
  if (!worker) {
    worker = new Worker(new URL('./prepare_surface.worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = (message: MessageEvent<{ id: number; ready: DrawnSurface }>) => {
      waiting.get(message.data.id)?.(message.data.ready);
      waiting.delete(message.data.id);
    };
  }
  const id = next++;
  const buffers = [surface.points.buffer, surface.triangles.buffer].filter((b, n, all) => all.indexOf(b) === n);
  return new Promise((done) => {
    waiting.set(id, done);
    worker!.postMessage(
      { id, surface: { points: surface.points, triangles: surface.triangles } },
      { transfer: buffers as ArrayBuffer[] },
    );
  });
}
