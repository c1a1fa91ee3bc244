import { prepareSurface, type Surface } from '../model';

self.onmessage = (message: MessageEvent<{ id: number; surface: Surface }>) => {
  const { id, surface } = message.data;
  const ready = prepareSurface(surface);
  self.postMessage(
    { id, ready },
    {
      transfer: [
        ready.points.buffer,
        ready.triangles.buffer,
        ready.normals.buffer,
        ready.coarse.vertex.buffer,
        ready.coarse.triangles.buffer,
      ].filter((buffer, n, all) => all.indexOf(buffer) === n) as ArrayBuffer[],
    },
  );
};
