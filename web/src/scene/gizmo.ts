import { acrossNormal, add, cross, dot, scale, unit, type Vec3 } from '../model';
import type { Projection } from './projection';

/** An axis of a gizmo: for translation along it, rotation about it, or both. */
export interface GizmoAxis {
  name: string;
  direction: Vec3;
  color: string;
  translates: boolean;
  rotates: boolean;
  /** Letters at the two ends of the arrow. */
  plus?: string;
  minus?: string;
}

export interface GizmoDrag {
  kind: 'translate' | 'rotate';
  axis: GizmoAxis;
  /** Since the drag began: mm or degrees. */
  amount: number;
}

interface Handle {
  kind: 'translate' | 'rotate';
  axis: GizmoAxis;
  /** Polyline on the screen. */
  line: [number, number][];
}

const ARM_PX = 96;
const RING_PX = 70;
const GRIP_PX = 9;

/**
 * Arrows and rings about a point, drawn over the picture, with a constant size on the screen.
 */
export class Gizmo {
  at_L: Vec3 | null = null;
  axes: readonly GizmoAxis[] = [];
  hovered: Handle | null = null;
  private dragged: { handle: Handle; from: [number, number]; fromAngle: number } | null = null;

  get isDragging(): boolean {
    return this.dragged !== null;
  }

  handles(projection: Projection): Handle[] {
    if (!this.at_L) return [];
    const mm = 1 / projection.px_per_mm;
    const found: Handle[] = [];
    for (const axis of this.axes) {
      const facing = Math.abs(dot(axis.direction, projection.forward));
      if (axis.translates && facing < 0.96) {
        // Arrows start away from the center, where all axes meet.
        for (const sign of [1, -1]) {
          const point = (px: number) => projection.toScreen(add(this.at_L!, scale(axis.direction, sign * px * mm)));
          found.push({ kind: 'translate', axis, line: [point(22), point(ARM_PX)] });
        }
      }
      if (axis.rotates && facing > 0.12) {
        const [u, v] = acrossNormal(axis.direction);
        const line: [number, number][] = [];
        for (let n = 0; n <= 64; n++) {
          const a = (n / 64) * 2 * Math.PI;
          const p = add(scale(u, Math.cos(a) * RING_PX * mm), scale(v, Math.sin(a) * RING_PX * mm));
          line.push(projection.toScreen(add(this.at_L, p)));
        }
        found.push({ kind: 'rotate', axis, line });
      }
    }
    return found;
  }

  /** The handle under a point of the screen. */
  find(projection: Projection, x: number, y: number): Handle | null {
    let best: Handle | null = null;
    let nearest = GRIP_PX;
    for (const handle of this.handles(projection))
      for (let n = 1; n < handle.line.length; n++) {
        const d = toSegment(x, y, handle.line[n - 1], handle.line[n]);
        if (d < nearest) {
          nearest = d;
          best = handle;
        }
      }
    return best;
  }

  begin(projection: Projection, x: number, y: number): boolean {
    const handle = this.find(projection, x, y);
    if (!handle) return false;
    this.dragged = { handle, from: [x, y], fromAngle: this.angleAt(projection, handle.axis, x, y) };
    return true;
  }

  drag(projection: Projection, x: number, y: number): GizmoDrag | null {
    if (!this.dragged) return null;
    const { handle, from, fromAngle } = this.dragged;
    if (handle.kind === 'rotate') {
      let turn = this.angleAt(projection, handle.axis, x, y) - fromAngle;
      turn = ((turn + 540) % 360) - 180;
      return { kind: 'rotate', axis: handle.axis, amount: turn };
    }
    const along = projection.directionOnScreen(handle.axis.direction); // px per mm of the axis
    const size2 = along[0] ** 2 + along[1] ** 2;
    const amount = ((x - from[0]) * along[0] + (y - from[1]) * along[1]) / size2;
    return { kind: 'translate', axis: handle.axis, amount };
  }

  end(): void {
    this.dragged = null;
  }

  /** Angle of a point of the screen about an axis, in the plane of the ring [degrees]. */
  private angleAt(projection: Projection, axis: GizmoAxis, x: number, y: number): number {
    const [cx, cy] = projection.toScreen(this.at_L!);
    const mm = 1 / projection.px_per_mm;
    // In an orthographic view the ray meets the plane of the ring at center + screen offset + s * forward.
    const offset = add(scale(projection.right, (x - cx) * mm), scale(projection.up, -(y - cy) * mm));
    const n = unit(axis.direction);
    const s = -dot(offset, n) / dot(projection.forward, n);
    const inPlane = add(offset, scale(projection.forward, s));
    const [u] = acrossNormal(n);
    return (Math.atan2(dot(cross(u, inPlane), n), dot(u, inPlane)) * 180) / Math.PI;
  }

  draw(context: CanvasRenderingContext2D, projection: Projection): void {
    if (!this.at_L) return;
    const active = this.dragged?.handle ?? this.hovered;
    for (const handle of this.handles(projection)) {
      const lit = active !== null && active.kind === handle.kind && active.axis.name === handle.axis.name;
      const path = () => {
        context.beginPath();
        handle.line.forEach(([x, y], n) => (n === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      };
      context.lineCap = 'round';
      path();
      context.strokeStyle = 'rgb(0 0 0 / 0.35)';
      context.lineWidth = lit ? 6.5 : 4.5;
      context.stroke();
      path();
      context.strokeStyle = lit ? '#ffffff' : handle.axis.color;
      context.lineWidth = lit ? 4 : 2.5;
      context.stroke();
      if (handle.kind === 'translate') this.drawHead(context, handle, lit, projection);
    }
    const [x, y] = projection.toScreen(this.at_L);
    context.beginPath();
    context.arc(x, y, 4.5, 0, 2 * Math.PI);
    context.fillStyle = '#ffffff';
    context.strokeStyle = 'rgb(0 0 0 / 0.6)';
    context.lineWidth = 1.5;
    context.fill();
    context.stroke();
  }

  private drawHead(context: CanvasRenderingContext2D, handle: Handle, lit: boolean, projection: Projection): void {
    const [[x0, y0], [x1, y1]] = handle.line;
    const size = Math.hypot(x1 - x0, y1 - y0) || 1;
    const [ux, uy] = [(x1 - x0) / size, (y1 - y0) / size];
    context.beginPath();
    context.moveTo(x1 + ux * 7, y1 + uy * 7);
    context.lineTo(x1 - ux * 5 - uy * 6, y1 - uy * 5 + ux * 6);
    context.lineTo(x1 - ux * 5 + uy * 6, y1 - uy * 5 - ux * 6);
    context.closePath();
    context.fillStyle = lit ? '#ffffff' : handle.axis.color;
    context.strokeStyle = 'rgb(0 0 0 / 0.35)';
    context.lineWidth = 1;
    context.stroke();
    context.fill();
    const along = projection.directionOnScreen(handle.axis.direction);
    const letter = along[0] * ux + along[1] * uy > 0 ? handle.axis.plus : handle.axis.minus;
    if (!letter) return;
    context.font = '600 12px "Inter Variable", sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.lineWidth = 3;
    context.strokeStyle = 'rgb(0 0 0 / 0.65)';
    context.strokeText(letter, x1 + ux * 19, y1 + uy * 19);
    context.fillStyle = '#ffffff';
    context.fillText(letter, x1 + ux * 19, y1 + uy * 19);
  }
}

function toSegment(x: number, y: number, [ax, ay]: [number, number], [bx, by]: [number, number]): number {
  const dx = bx - ax;
  const dy = by - ay;
  const t = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

/** The axes of the patient, for the movement of a segment. */
export const PATIENT_AXES: readonly GizmoAxis[] = [
  { name: 'AP', direction: [0, -1, 0], color: '#3fb27f', translates: true, rotates: true, plus: 'A', minus: 'P' },
  { name: 'SI', direction: [0, 0, 1], color: '#5b9cf0', translates: true, rotates: true, plus: 'S', minus: 'I' },
  { name: 'LR', direction: [1, 0, 0], color: '#ef7d6b', translates: true, rotates: true, plus: 'L', minus: 'R' },
];

/** Axes of a cutting plane: translation along its normal, rotation about two directions in it. */
export function planeAxes(normal: Vec3): GizmoAxis[] {
  const n = unit(normal);
  const [u, v] = acrossNormal(n);
  return [
    { name: 'normal', direction: n, color: '#f2b84b', translates: true, rotates: false, plus: 'moves' },
    { name: 'tilt 1', direction: u, color: '#5b9cf0', translates: false, rotates: true },
    { name: 'tilt 2', direction: v, color: '#ef7d6b', translates: false, rotates: true },
  ];
}
