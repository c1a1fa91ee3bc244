import type { Gizmo } from './gizmo';
import { drawLabels, type Tag } from './overlay';
import type { Projection } from './projection';
import type { Marker } from './view_events';

/** Distance from a marker at which the pointer is on it. */
const GRAB_PX = 10;

/** Draws markers and their labels. A marker in `hidden` is dim and has no label. */
export function drawMarkers(
  context: CanvasRenderingContext2D,
  projection: Projection,
  markers: readonly Marker[],
  hidden: ReadonlySet<string>,
): void {
  const inOrder = [...markers].sort((a, b) => Number(b.selected ?? false) - Number(a.selected ?? false));
  for (const marker of inOrder)
    drawMarker(context, projection.toScreen(marker.position), marker, hidden.has(marker.id));
  const visible = inOrder.filter((marker) => !hidden.has(marker.id));
  const tags = visible
    .filter((marker) => marker.label)
    .map((marker): Tag => {
      const [x, y] = projection.toScreen(marker.position);
      return { x, y, text: marker.label!, strong: marker.selected ?? false };
    });
  const dots = visible.map((marker) => projection.toScreen(marker.position));
  drawLabels(context, tags, dots, 7.5);
}

function drawMarker(
  context: CanvasRenderingContext2D,
  [x, y]: [number, number],
  marker: Marker,
  isHidden: boolean,
): void {
  context.globalAlpha = isHidden ? 0.3 : 1;
  context.beginPath();
  context.arc(x, y, marker.selected ? 6 : 4.5, 0, 2 * Math.PI);
  context.fillStyle = marker.color;
  context.fill();
  context.lineWidth = marker.selected ? 2.5 : 1.5;
  context.strokeStyle = marker.selected ? '#ffffff' : 'rgb(255 255 255 / 0.9)';
  context.stroke();
  context.beginPath();
  context.arc(x, y, marker.selected ? 7.5 : 5.5, 0, 2 * Math.PI);
  context.lineWidth = 1;
  context.strokeStyle = 'rgb(0 0 0 / 0.55)';
  context.stroke();
  context.globalAlpha = 1;
}

/** The marker at a point of the screen that `isWanted` accepts; the nearest of several. */
export function markerAt(
  markers: readonly Marker[],
  projection: Projection,
  [x, y]: [number, number],
  isWanted: (marker: Marker) => boolean,
): Marker | null {
  let found: Marker | null = null;
  let nearest = GRAB_PX;
  for (const marker of markers) {
    const [mx, my] = projection.toScreen(marker.position);
    const distance = Math.hypot(mx - x, my - y);
    if (distance < nearest && isWanted(marker)) {
      nearest = distance;
      found = marker;
    }
  }
  return found;
}

/** Positions of handles and markers on the screen by name, for tests and assistive scripts. */
export function handlePositions(
  gizmo: Gizmo,
  markers: readonly Marker[],
  projection: Projection,
): Record<string, [number, number]> {
  const positions: Record<string, [number, number]> = {};
  const put = (name: string, [x, y]: [number, number]): void => {
    positions[name] = [Math.round(x), Math.round(y)];
  };
  for (const { kind, axis, line } of gizmo.handles(projection)) {
    if (kind === 'rotate') {
      put(`rotate ${axis.name}`, line[8]);
      continue;
    }
    const along = projection.directionOnScreen(axis.direction);
    const isPositive = along[0] * (line[1][0] - line[0][0]) + along[1] * (line[1][1] - line[0][1]) > 0;
    put(`translate ${axis.name} ${isPositive ? '+' : '-'}`, line[1]);
  }
  for (const marker of markers) put(`marker ${marker.id}`, projection.toScreen(marker.position));
  return positions;
}
