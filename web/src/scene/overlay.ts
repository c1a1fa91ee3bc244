import { Quaternion, Vector3 } from 'three';
import { screenSides, unit, type Vec3 } from '../model';
import type { Projection } from './projection';

// Marks over the picture, drawn in 2D: sharp and fast on any graphics.

export interface Polyline {
  points: Vec3[];
  closed: boolean;
  color: string;
  dashed?: boolean;
}

export interface PlaneMark {
  point: Vec3;
  normal: Vec3;
  size_mm: number;
  color: string;
  selected: boolean;
}

export function drawLine(context: CanvasRenderingContext2D, projection: Projection, line: Polyline): void {
  if (line.points.length < 2) return;
  context.beginPath();
  line.points.forEach((p, n) => {
    const [x, y] = projection.toScreen(p);
    if (n === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  });
  if (line.closed) context.closePath();
  context.setLineDash(line.dashed ? [5, 5] : []);
  context.lineJoin = 'round';
  context.lineWidth = 4;
  context.strokeStyle = 'rgb(0 0 0 / 0.35)';
  context.stroke();
  context.lineWidth = 2;
  context.strokeStyle = line.color;
  context.stroke();
  context.setLineDash([]);
}

export function drawPlaneOutline(context: CanvasRenderingContext2D, projection: Projection, mark: PlaneMark): void {
  const n = new Vector3(...unit(mark.normal));
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), n);
  const h = mark.size_mm / 2;
  const corners = [
    [-h, -h],
    [h, -h],
    [h, h],
    [-h, h],
  ].map(
    ([a, b]) =>
      new Vector3(a, b, 0)
        .applyQuaternion(turn)
        .add(new Vector3(...mark.point))
        .toArray() as Vec3,
  );
  context.beginPath();
  corners.forEach((corner, k) => {
    const [x, y] = projection.toScreen(corner);
    if (k === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  });
  context.closePath();
  context.lineWidth = mark.selected ? 2 : 1.25;
  context.strokeStyle = mark.color;
  context.globalAlpha = mark.selected ? 1 : 0.7;
  context.stroke();
  context.globalAlpha = 1;
}

/** A label of a point. */
export interface Tag {
  x: number;
  y: number;
  text: string;
  strong: boolean;
}

type Rect = readonly [left: number, top: number, right: number, bottom: number];

const LABEL_HEIGHT = 17;

/**
 * Positions of labels with these widths: beside, above or below their points, without covering a dot or an earlier
 * label; null if there is no space. `dots`: all points, with their radius.
 */
export function placeLabels(
  tags: readonly Tag[],
  widths: readonly number[],
  dots: readonly (readonly [number, number])[],
  dotRadius: number,
): (readonly [left: number, middle: number] | null)[] {
  const taken: Rect[] = [];
  const gap = dotRadius + 1;
  return tags.map(({ x, y }, n) => {
    const width = widths[n];
    for (const [left, middle] of [
      [x + gap, y],
      [x - gap - width, y],
      [x - width / 2, y - gap - LABEL_HEIGHT / 2],
      [x - width / 2, y + gap + LABEL_HEIGHT / 2],
    ] as const) {
      const rect: Rect = [left, middle - LABEL_HEIGHT / 2, left + width, middle + LABEL_HEIGHT / 2];
      const coversDot = dots.some(
        ([dx, dy]) =>
          Math.hypot(dx - Math.min(rect[2], Math.max(rect[0], dx)), dy - Math.min(rect[3], Math.max(rect[1], dy))) <
          dotRadius,
      );
      const coversLabel = taken.some(
        (other) => rect[0] < other[2] && other[0] < rect[2] && rect[1] < other[3] && other[1] < rect[3],
      );
      if (coversDot || coversLabel) continue;
      taken.push(rect);
      return [left, middle] as const;
    }
    return null;
  });
}

/** Draws labels of points where they cover no point and no earlier label. */
export function drawLabels(
  context: CanvasRenderingContext2D,
  tags: readonly Tag[],
  dots: readonly (readonly [number, number])[],
  dotRadius: number,
): void {
  const font = (strong: boolean): string => `${strong ? 600 : 500} 11.5px "Inter Variable", sans-serif`;
  const widths = tags.map(({ text, strong }) => {
    context.font = font(strong);
    return context.measureText(text).width + 8;
  });
  placeLabels(tags, widths, dots, dotRadius).forEach((at, n) => {
    if (!at) return;
    const { text, strong } = tags[n];
    context.font = font(strong);
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    context.fillStyle = strong ? 'rgb(15 95 115 / 0.95)' : 'rgb(16 22 28 / 0.72)';
    context.beginPath();
    context.roundRect(at[0], at[1] - LABEL_HEIGHT / 2, widths[n], LABEL_HEIGHT, 4);
    context.fill();
    context.fillStyle = '#ffffff';
    context.fillText(text, at[0] + 4, at[1] + 0.5);
  });
}

/** Draws a stroke of the brush that the bodies do not show yet. */
export function drawStroke(
  context: CanvasRenderingContext2D,
  brushStamps: readonly [number, number][],
  radius_px: number,
  color: string,
): void {
  if (brushStamps.length === 0) return;
  context.beginPath();
  for (const [x, y] of brushStamps) {
    context.moveTo(x + radius_px, y);
    context.arc(x, y, radius_px, 0, 2 * Math.PI);
  }
  context.globalAlpha = 0.6;
  context.fillStyle = color;
  context.fill();
  context.globalAlpha = 1;
}

/** Draws the circle of the brush. */
export function drawBrush(context: CanvasRenderingContext2D, [x, y]: [number, number], radius_px: number): void {
  for (const [width, color] of [
    [3.5, 'rgb(0 0 0 / 0.45)'],
    [1.5, '#ffffff'],
  ] as const) {
    context.beginPath();
    context.arc(x, y, radius_px, 0, 2 * Math.PI);
    context.lineWidth = width;
    context.strokeStyle = color;
    context.stroke();
  }
}

export function drawSides(
  context: CanvasRenderingContext2D,
  projection: Projection,
  x: number,
  y: number,
  width: number,
  height: number,
  ink: string,
): void {
  const sides = screenSides(projection.forward, projection.up);
  context.font = '600 14px "Inter Variable", sans-serif';
  context.fillStyle = ink;
  context.textBaseline = 'middle';
  context.textAlign = 'center';
  context.fillText(sides.left, x + 16, y + height / 2);
  context.fillText(sides.right, x + width - 16, y + height / 2);
  context.fillText(sides.top, x + width / 2, y + 18);
  context.fillText(sides.bottom, x + width / 2, y + height - 18);
}

export function drawScale(
  context: CanvasRenderingContext2D,
  projection: Projection,
  width: number,
  height: number,
  ink: string,
): void {
  const mm = [100, 50, 20, 10, 5, 2, 1].find((step) => step * projection.px_per_mm < Math.min(160, width / 4)) ?? 1;
  const size = mm * projection.px_per_mm;
  const [x, y] = [16, height - 16];
  context.strokeStyle = ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y - 4);
  context.lineTo(x, y);
  context.lineTo(x + size, y);
  context.lineTo(x + size, y - 4);
  context.stroke();
  context.font = '500 11px "Inter Variable", sans-serif';
  context.fillStyle = ink;
  context.textAlign = 'left';
  context.textBaseline = 'alphabetic';
  context.fillText(`${mm} mm`, x, y - 8);
}

/** Draws the name of one side of a comparison. */
export function drawTag(
  context: CanvasRenderingContext2D,
  text: string,
  x: number,
  align: 'left' | 'right',
  y = 44,
): void {
  context.font = '600 12px "Inter Variable", sans-serif';
  context.textAlign = align;
  context.textBaseline = 'middle';
  const width = context.measureText(text).width;
  context.fillStyle = 'rgb(16 22 28 / 0.78)';
  context.beginPath();
  context.roundRect(align === 'left' ? x - 8 : x - width - 8, y, width + 16, 22, 6);
  context.fill();
  context.fillStyle = '#ffffff';
  context.fillText(text, x, y + 11.5);
}

export function drawWipe(context: CanvasRenderingContext2D, x: number, height: number): void {
  context.fillStyle = 'rgb(0 0 0 / 0.35)';
  context.fillRect(x - 2, 0, 4, height);
  context.fillStyle = '#ffffff';
  context.fillRect(x - 1, 0, 2, height);
  context.beginPath();
  context.arc(x, height / 2, 15, 0, 2 * Math.PI);
  context.fillStyle = '#ffffff';
  context.fill();
  context.lineWidth = 1;
  context.strokeStyle = 'rgb(0 0 0 / 0.35)';
  context.stroke();
  context.beginPath();
  for (const sign of [-1, 1]) {
    context.moveTo(x + sign * 4, height / 2 - 5);
    context.lineTo(x + sign * 9, height / 2);
    context.lineTo(x + sign * 4, height / 2 + 5);
  }
  context.strokeStyle = '#0f5f73';
  context.lineWidth = 2;
  context.stroke();
}
