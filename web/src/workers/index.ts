import type { DrawnSurface, Surface } from '../model';

let worker: Worker | null = null;
let next = 0;
const waiting = new Map<number, (ready: DrawnSurface) => void>();

/** Prepares a surface for drawing in a worker. The arrays of the surface are transferred. */
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
