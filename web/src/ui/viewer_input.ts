import {
  add,
  cross,
  dot,
  editPlane,
  mapVec3,
  planeAt,
  roundVec3,
  scale,
  templateKind,
  unit,
  withLandmark,
  withPlane,
  withSegment,
  type Mat4,
  type Move,
  type Plane,
  type Vec3,
} from '../model';
import type { GizmoDrag, Phase } from '../scene';
import type { App } from './app';
import { selectNervePoint } from './measure_marks';

/** Edits the document as the pointer acts on the views. */
export class ViewerInput {
  /** When the last drag ended, for the preview's latency. */
  changedAt = 0;
  private moveAtStart: Move | null = null;
  private planeAtStart: Plane | null = null;
  private gesture = 0;

  constructor(
    private readonly app: App,
    /** Draws the views after a drag. */
    private readonly redraw: () => void,
  ) {}

  onGizmo(drag: GizmoDrag, phase: Phase): void {
    if (phase === 'start') this.gesture++;
    if (this.app.model.s.step === 'osteotomy') this.dragPlane(drag, phase);
    else this.dragSegment(drag, phase);
    if (phase !== 'end') return;
    this.app.settle();
    this.changedAt = performance.now();
    this.moveAtStart = this.planeAtStart = null;
    this.redraw();
  }

  private dragPlane({ kind, axis, amount }: GizmoDrag, phase: Phase): void {
    const { s, doc } = this.app.model;
    const plane = s.plane === null ? undefined : doc.plan.segments[s.segment]?.osteotomy.planes?.[s.plane];
    if (s.plane === null || !plane) return;
    if (phase === 'start') {
      this.planeAtStart = plane;
      return;
    }
    const from = this.planeAtStart ?? plane;
    const by = scale(axis.direction, Math.round(amount * 10) / 10);
    const next: Plane =
      kind === 'translate'
        ? { ...from, point_mm: roundVec3(add(from.point_mm, by), 3) }
        : { ...from, towards_segment: tilted(from.towards_segment, axis.direction, amount) };
    this.app.edit({ plan: editPlane(doc.plan, s.segment, s.plane, next) }, `gizmo-${this.gesture}`);
  }

  private dragSegment({ kind, axis, amount }: GizmoDrag, phase: Phase): void {
    const { app } = this;
    if (phase === 'start') this.moveAtStart = app.move();
    else if (this.moveAtStart)
      app.setMove(app.gizmoMove(this.moveAtStart, kind, axis.direction, amount), `gizmo-${this.gesture}`);
  }

  /** Uses the current tool at a point; `normal` is that of the surface there. */
  place(point: Vec3, normal: Vec3): void {
    const { app } = this;
    const { s, doc } = app.model;
    const at = roundVec3(point, 1);
    if (s.tool === 'landmark' && s.landmark) {
      app.edit({ landmarks: withLandmark(doc.landmarks, { name: s.landmark, position_mm: at }) });
      app.patch({ cursor_L: at, tool: 'none' });
    } else if (s.tool === 'plane') this.placePlane(at);
    else if (s.tool === 'curve' && s.curveDraft)
      app.patch({ curveDraft: { points: [...s.curveDraft.points, at], normals: [...s.curveDraft.normals, normal] } });
    else if (s.tool === 'pivot') {
      // The view shows the segment at its planned pose; the pivot is a point of the segment as scanned.
      if (!app.move()) return;
      app.setPivot(roundVec3(inversePoint(app.poses()[doc.plan.segments[s.segment].name], at), 1));
      app.patch({ tool: 'none' });
    }
  }

  private placePlane(at: Vec3): void {
    const { app } = this;
    const { s, doc } = app.model;
    const segment = doc.plan.segments[s.segment];
    const plane = planeAt(at, [0, 0, -1]);
    if (segment && templateKind(segment.osteotomy) === null) {
      app.edit({ plan: withPlane(doc.plan, s.segment, plane) });
      app.patch({ tool: 'none', plane: segment.osteotomy.planes?.length ?? 0 });
    } else {
      const plan = withSegment(doc.plan, 'segment', { planes: [plane] });
      app.edit({ plan });
      app.patch({ tool: 'none', segment: plan.segments.length - 1, plane: 0 });
    }
  }

  onMarkerSelect(id: string): void {
    const { s, doc } = this.app.model;
    if (s.step === 'measures') selectNervePoint(this.app, id);
    if (id.startsWith('curve ') || s.step !== 'landmarks') return;
    const landmark = doc.landmarks.find((l) => l.name === id);
    this.app.patch({ landmark: id, tool: 'none', ...(landmark ? { cursor_L: landmark.position_mm } : {}) });
    this.gesture++;
  }

  onMarkerDrag(id: string, point: Vec3, phase: 'move' | 'end'): void {
    const { app } = this;
    const { s, doc } = app.model;
    const at = roundVec3(point, 1);
    if (s.step === 'measures') {
      if (s.measure === 'nerve') app.measures.dragPoint(id, at, phase === 'end');
      return;
    }
    if (id.startsWith('curve ') && s.curveDraft) {
      const n = Number(id.slice(6));
      app.patch({ curveDraft: { ...s.curveDraft, points: s.curveDraft.points.map((p, k) => (k === n ? at : p)) } });
      return;
    }
    app.edit({ landmarks: withLandmark(doc.landmarks, { name: id, position_mm: at }) }, `landmark-${this.gesture}`);
    if (phase === 'end') {
      app.settle();
      app.patch({ cursor_L: at });
    }
  }
}

/** A direction rotated about an axis. */
function tilted(direction: Vec3, axis: Vec3, deg: number): Vec3 {
  const k = unit(axis);
  const c = Math.cos((deg * Math.PI) / 180);
  const s = Math.sin((deg * Math.PI) / 180);
  const across = cross(k, direction);
  const along = dot(k, direction) * (1 - c);
  return roundVec3(
    mapVec3(direction, (value, n) => value * c + across[n] * s + k[n] * along),
    5,
  );
}

/** A point of L in the frame of a body at pose X. */
function inversePoint(X: Mat4, p: Vec3): Vec3 {
  const d = [p[0] - X[3], p[1] - X[7], p[2] - X[11]];
  return mapVec3(p, (_, c) => X[c] * d[0] + X[4 + c] * d[1] + X[8 + c] * d[2]);
}
