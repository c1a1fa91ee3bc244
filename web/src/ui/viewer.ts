import type { Depths } from '../api';
import {
  add,
  BONE,
  cssOf,
  posedSectionOf,
  kindOf,
  length,
  scale,
  sectionOf,
  segmentColor,
  SKIN,
  sub,
  templateKey,
  templateKind,
  unit,
  mapVec3,
  roundVec3,
  toPlane,
  toVec3,
  withLandmark,
  withPlane,
  withSegment,
  editPlane,
  IDENTITY,
  planeAt,
  cross,
  dot,
  type DrawnSurface,
  type Hit,
  type Move,
  type Plane,
  type Vec3,
} from '../model';
import {
  PATIENT_AXES,
  planeAxes,
  SliceView,
  View3d,
  type GizmoDrag,
  type Marker,
  type Phase,
  type PlaneMark,
  type SliceLines,
} from '../scene';
import type { App } from './app';
import { BoundaryView } from './boundary_view';
import { CompareView } from './compare_view';
import type { SceneListeners } from './planner_context';
import { nextFrame } from './schedule';
import { stageOf, type State } from './state';
import { LABEL_TINTS } from './steps/anatomy_panel';

/** Depth of overlap that is drawn in the strongest color [mm]. */
const DEPTH_TOP_MM = 2;

/** How often slices follow a bone that is dragged: three pictures of the scan take as long as one of the bones. */
const SLICES_EVERY_MS = 100;

/** Draws what the app knows, and tells the app what the hand does in the views. */
export class Viewer implements SceneListeners {
  readonly view: View3d;
  readonly slices: readonly SliceView[];
  compare!: CompareView;
  private boundary!: BoundaryView;
  private app!: App;
  private depths: Depths | null = null;
  private previewOn = false;
  /** How many surfaces have come: colors are painted anew on each. */
  private surfaceCount = 0;
  private moveAtStart: Move | null = null;
  private planeAtStart: Plane | null = null;
  private gesture = 0;
  /** When the last drag ended, for the preview's latency. */
  private changedAt = 0;
  private previewKey = '';
  private previewTimer = 0;
  private depthKey = '';
  private slicesDrawnAt = 0;

  constructor() {
    this.view = new View3d({
      onPress: () => this.presentPending(),
      onGizmo: (drag, phase) => this.onGizmo(drag, phase),
      isPlacing: () => ['landmark', 'plane', 'curve', 'pivot'].includes(this.app.model.s.tool),
      onPick: (hit) => this.onPick(hit),
      isPainting: () => this.app.model.s.tool === 'paint',
      onPaint: (at, phase) => this.onBrush(at, phase),
      onMarkerDrag: (id, hit, phase) => this.onMarkerDrag(id, hit.point, phase === 'end' ? 'end' : 'move'),
      onMarkerSelect: (id) => this.onMarkerSelect(id),
      onWipe: (share) => this.app.patch({ wipe: share }),
    });
    this.slices = (['axial', 'coronal', 'sagittal'] as const).map((orientation) => {
      const slice: SliceView = new SliceView(orientation, {
        onCursor: (cursor_L) => this.app.patch({ cursor_L }),
        onWindow: (window) => this.app.patch({ window }),
        onMarkerDrag: (id, p_L, phase) => this.onMarkerDrag(id, p_L, phase),
        onMarkerSelect: (id) => this.onMarkerSelect(id),
        onTool: (p_L, phase) => {
          if (this.app.model.s.tool === 'brush') this.app.labelBrush.brush(p_L, phase);
          else if (phase === 'end') this.place(p_L, [0, 0, 0]);
        },
      });
      slice.outlines = (at) => this.outlines(at);
      return slice;
    });
  }

  get isDragging(): boolean {
    return this.view.gizmo.isDragging;
  }

  attach(app: App): void {
    this.app = app;
    this.compare = new CompareView(this.view, app);
    this.boundary = new BoundaryView(this.view, app);
    app.model.state.subscribe((state, before) => this.onState(state, before));
    app.model.history.subscribe(() => this.present());
  }

  // What the app found

  onSurface(name: string, surface: DrawnSurface | null): void {
    if (!surface) {
      this.view.removeBody(name);
      this.present();
      return;
    }
    const index = name.startsWith('segments/')
      ? this.app.model.doc.plan.segments.findIndex((x) => `segments/${x.name}` === name)
      : -1;
    const color = name.startsWith('segments/')
      ? segmentColor(Math.max(0, index))
      : /skin|predicted|after_surgery/.test(name)
        ? SKIN
        : BONE;
    this.view.setBody(name, surface, color);
    this.surfaceCount++;
    this.previewKey = this.depthKey = '';
    this.compare.surfaceChanged(name);
    this.present();
  }

  onDepths(depths: Depths | null): void {
    this.depths = depths;
    this.paintDepths();
  }

  onPreview(xyz: Float32Array | null): void {
    const skin = this.view.body('skin');
    if (!skin || (!xyz && !this.previewOn)) return;
    skin.setDisplacement(xyz && xyz.length === skin.points.length ? xyz : null);
    this.previewOn = xyz !== null;
    this.view.render();
  }

  onLabels(): void {
    for (const slice of this.slices) slice.labelsChanged();
    this.present();
  }

  onPaint(): void {
    // With the next picture: several dabs come before one.
    this.view.beforePicture = () => this.boundary.present(this.app.model.s);
    this.view.render();
  }

  // From state to pictures

  private onState(state: State, before: State): void {
    if (state.volume !== before.volume)
      for (const slice of this.slices) slice.setVolume(state.volume?.grid ?? null, state.volume?.data ?? null);
    const threshold_hu = state.thresholdOn ? state.bone_hu : null;
    if (
      state.window !== before.window ||
      state.cursor_L !== before.cursor_L ||
      state.thresholdOn !== before.thresholdOn ||
      state.bone_hu !== before.bone_hu ||
      state.volume !== before.volume
    )
      for (const slice of this.slices) slice.set({ window: state.window, cursor_L: state.cursor_L, threshold_hu });
    // Only these concern the picture; job progress and numbers do not.
    const keys = [
      'step',
      'case',
      'skullOpacity',
      'skinOpacity',
      'showLabels',
      'labelsReady',
      'tool',
      'brush_mm',
      'boundary',
      'paintOn',
      'paint_mm',
      'paintLabel',
      'landmark',
      'segment',
      'plane',
      'curveDraft',
      'templatePlanes',
      'keyframe',
      'scrub',
      'planPoses',
      'preview',
      'showOverlap',
      'showPreview',
      'prediction',
      'compareMode',
      'compareStep',
      'against',
      'skinPaint',
      'difference_mm',
      'bonePaint',
      'showBones',
      'wipe',
    ] as const;
    if (keys.some((key) => state[key] !== before[key])) this.present();
  }

  private pending = false;

  present(): void {
    if (this.pending) return;
    this.pending = true;
    nextFrame(() => this.presentPending());
  }

  private presentPending(): void {
    if (!this.pending) return;
    this.pending = false;
    this.presentNow();
  }

  private presentNow(): void {
    const { s, doc } = this.app.model;
    const { view } = this;
    const { step } = s;
    const cut =
      s.case !== null &&
      view.body('remainder') !== undefined &&
      doc.plan.segments.some((x) => view.body(`segments/${x.name}`));
    const segments = doc.plan.segments.map((x) => `segments/${x.name}`);
    const face = step === 'compare' ? [] : ['skin'];
    const moving = step === 'movement' || step === 'predict' || step === 'tissue';

    if (step === 'osteotomy' || step === 'movement' || step === 'predict' || step === 'tissue')
      void this.app.placeTemplates();

    // Which bodies
    let bodies: string[];
    if (step === 'compare') bodies = this.compare.bodies(s);
    else if (cut && (moving || (step === 'osteotomy' && stageOf(s, 'cut').state === 'fresh')))
      bodies = ['remainder', ...segments, ...face];
    else bodies = ['skull', ...face];
    const opacityOfSkin: Record<string, number> = {
      case: 1,
      anatomy: s.skinOpacity,
      osteotomy: 0,
      tissue: s.tool !== 'paint' ? 0.35 : s.paintOn === 'skin' ? 1 : 0,
      landmarks: s.landmark && kindOf(s.landmark)?.on === 'skin' ? 1 : 0.0,
      movement: s.showPreview && s.preview.state === 'shown' ? 0.45 : 0,
      predict: s.showPreview ? 1 : 0.45,
    };
    view.setOpacity('skin', opacityOfSkin[step] ?? 1);
    view.setOpacity('skull', step === 'anatomy' ? s.skullOpacity : 1);
    // What a closed skin hides need not be drawn.
    if (view.body('skin') && bodies.includes('skin') && opacityOfSkin[step] === 1) bodies = ['skin'];
    view.show(bodies);
    view.pickable = (name) =>
      step === 'landmarks' && s.landmark && kindOf(s.landmark)?.on === 'bone'
        ? name === 'skull'
        : step === 'osteotomy' || step === 'movement'
          ? name !== 'skin'
          : step === 'tissue'
            ? this.boundary.isPaintable(s, name)
            : true;

    // Where the segments are
    const poses = this.app.poses();
    doc.plan.segments.forEach((segment, index) => {
      const name = `segments/${segment.name}`;
      if (!view.body(name)) return;
      const pose =
        step === 'compare'
          ? this.compare.poseOf(s, index)
          : moving && step !== 'tissue'
            ? (poses[segment.name] ?? IDENTITY)
            : IDENTITY;
      view.setPose(name, pose);
    });
    if (moving && step !== 'tissue') {
      const cutPoses = this.app.cutPoses();
      const key = JSON.stringify([cutPoses, stageOf(s, 'cut').state, stageOf(s, 'cut').etag]);
      if (key !== this.depthKey) {
        this.depthKey = key;
        this.app.live.requestDepths(cutPoses);
      }
      const previewKey = `${key} ${stageOf(s, 'preview').etag} ${stageOf(s, 'preview').state} ${s.showPreview}`;
      if (previewKey !== this.previewKey && !view.gizmo.isDragging) {
        this.previewKey = previewKey;
        const since = Math.max(this.changedAt, performance.now() - 50);
        clearTimeout(this.previewTimer);
        this.previewTimer = window.setTimeout(() => void this.app.live.requestPreview(since), 30);
      }
    } else if (this.previewOn && step !== 'compare') {
      this.app.live.dropPreview();
      this.previewKey = '';
    }
    this.paintDepths();
    this.boundary.present(s);
    view.brush_mm = s.paint_mm;
    const painted = s.boundary?.names.find((x) => x.value === s.paintLabel);
    view.brushColor = cssOf(painted ? toVec3(painted.colour) : BONE);

    // Marks
    view.markers = this.markers(s);
    view.lines = s.curveDraft
      ? [{ points: s.curveDraft.points, closed: s.curveDraft.points.length > 2, color: '#f2b84b', dashed: true }]
      : step === 'osteotomy'
        ? doc.plan.segments.flatMap((x, index) =>
            (x.osteotomy.curves ?? [])
              .filter((c) => c.points_mm)
              .map((c) => ({ points: c.points_mm!, closed: true, color: cssOf(segmentColor(index)) })),
          )
        : [];
    view.setPlanes(
      step === 'osteotomy' && !(stageOf(s, 'cut').state === 'fresh' && s.plane === null) ? this.planes(s) : [],
    );

    // Gizmo
    const move = this.app.move();
    const segment = doc.plan.segments[s.segment];
    const plane = step === 'osteotomy' && s.plane !== null ? segment?.osteotomy.planes?.[s.plane] : undefined;
    if (step === 'movement' && move && segment && view.body(`segments/${segment.name}`) && s.scrub === null) {
      view.gizmo.at_L = add(move.about_mm, move.translation_mm);
      view.gizmo.axes = PATIENT_AXES;
    } else if (plane) {
      view.gizmo.at_L = plane.point_mm;
      if (!view.gizmo.isDragging) view.gizmo.axes = planeAxes(plane.towards_segment);
    } else view.gizmo.at_L = null;

    // Slices: where bone is dragged they follow it, but not with every picture.
    const now = performance.now();
    const drawsSlices = step !== 'movement' || !view.gizmo.isDragging || now - this.slicesDrawnAt > SLICES_EVERY_MS;
    if (drawsSlices) this.slicesDrawnAt = now;
    for (const slice of this.slices) {
      slice.tool = s.tool === 'brush' ? 'brush' : s.tool === 'landmark' ? 'place' : 'none';
      slice.brush_mm = s.brush_mm;
      slice.setLabels(step === 'anatomy' && s.showLabels && s.labelsReady ? this.app.model.labels : null, [
        ...LABEL_TINTS,
      ]);
      slice.markers =
        step === 'landmarks'
          ? doc.landmarks.map((l) => ({
              id: l.name,
              position: l.position_mm,
              label: l.name,
              color: l.name === s.landmark ? '#f2b84b' : '#3fb2c8',
              selected: l.name === s.landmark,
            }))
          : [];
      if (drawsSlices) slice.draw();
    }
    this.compare.present(s);
    view.refreshMarkers();
  }

  private paintedDepths: { depths: Depths | null; on: boolean; step: string; bodies: number } | null = null;

  private paintDepths(): void {
    const { s, doc } = this.app.model;
    const now = { depths: this.depths, on: s.showOverlap, step: s.step, bodies: this.surfaceCount };
    if (
      JSON.stringify({ ...now, depths: null }) === JSON.stringify({ ...this.paintedDepths, depths: null }) &&
      this.paintedDepths?.depths === now.depths
    )
      return;
    this.paintedDepths = now;
    const on = s.showOverlap && (s.step === 'movement' || s.step === 'predict');
    doc.plan.segments.forEach((segment, index) => {
      const body = this.view.body(`segments/${segment.name}`);
      if (!body) return;
      const depth = on ? this.depths?.bySegment.get(segment.name) : undefined;
      if (depth && depth.length === body.surface.points.length / 3 && (this.depths?.deepest_mm ?? 0) > 0.05) {
        body.setValues(depth, 'depth', 0, DEPTH_TOP_MM, segmentColor(index));
      } else {
        body.setColor(segmentColor(index));
      }
    });
    this.view.render();
  }

  private markers(s: State): Marker[] {
    const { doc } = this.app.model;
    if (s.curveDraft)
      return s.curveDraft.points.map((position, n) => ({
        id: `curve ${n}`,
        position,
        color: '#f2b84b',
        draggable: true,
      }));
    if (s.step !== 'landmarks' && s.step !== 'osteotomy') return [];
    return doc.landmarks
      .filter((l) => s.step === 'landmarks' || kindOf(l.name)?.on === 'bone')
      .map((l) => ({
        id: l.name,
        position: l.position_mm,
        label: l.name,
        hides: true,
        selected: s.step === 'landmarks' && l.name === s.landmark,
        color: l.name === s.landmark && s.step === 'landmarks' ? '#f2b84b' : '#3fb2c8',
        draggable: s.step === 'landmarks' && s.tool !== 'landmark',
      }));
  }

  /** Planes of all cuts, those of templates too. */
  private planes(s: State): PlaneMark[] {
    const { doc } = this.app.model;
    const radius_mm = 110;
    return doc.plan.segments.flatMap((segment, index) => {
      const color = cssOf(segmentColor(index));
      const placed = templateKind(segment.osteotomy)
        ? s.templatePlanes.get(templateKey(segment.osteotomy.template, doc.landmarks))
        : undefined;
      const own = (segment.osteotomy.planes ?? []).map((plane, n) => ({
        plane,
        selected: index === s.segment && n === s.plane,
      }));
      const template =
        placed && typeof placed !== 'string'
          ? [...placed.planes, ...(placed.also ?? []).flatMap((region) => region.planes)].map((p) => ({
              plane: toPlane(p),
              selected: false,
            }))
          : [];
      return [...own, ...template].map(({ plane, selected }) => ({
        point: plane.point_mm,
        normal: plane.towards_segment,
        size_mm: plane.size_mm ? Math.max(...plane.size_mm) : radius_mm,
        color,
        selected,
      }));
    });
  }

  /** What is drawn on a slice: planes as lines, bones where they move as outlines, where they were dashed. */
  private outlines(at: { point: Vec3; normal: Vec3 }): SliceLines[] {
    const { s, doc } = this.app.model;
    const found: SliceLines[] = [];
    if (s.step === 'osteotomy')
      for (const mark of this.planes(s)) {
        const n = unit(mark.normal);
        const direction = cross(n, at.normal);
        if (length(direction) < 0.05) continue;
        const d = unit(direction);
        // The point of the plane's middle that lies in the slice: along the plane, towards it.
        const into = unit(cross(d, n));
        const reach = dot(sub(at.point, mark.point), at.normal) / dot(into, at.normal);
        if (Math.abs(reach) > mark.size_mm / 2) continue;
        const middle = [0, 1, 2].map((c) => mark.point[c] + reach * into[c]);
        const half = mark.size_mm / 2;
        const ends = [-half, half].flatMap((t) => middle.map((c, k) => c + t * d[k]));
        found.push({ lines: Float32Array.from(ends), color: mark.color });
      }
    if (s.step === 'movement') {
      const poses = this.app.poses();
      doc.plan.segments.forEach((segment, index) => {
        const body = this.view.body(`segments/${segment.name}`);
        if (!body) return;
        const color = cssOf(segmentColor(index));
        const pose = poses[segment.name] ?? IDENTITY;
        if (pose.some((v, n) => v !== IDENTITY[n]))
          found.push({ lines: sectionOf(body.surface, at.point, at.normal), color, dashed: true });
        found.push({ lines: posedSectionOf(body.surface, pose, at.point, at.normal), color });
      });
    }
    return found;
  }

  // From the hand to the app

  private onGizmo(drag: GizmoDrag, phase: Phase): void {
    const { app } = this;
    const { s, doc } = app.model;
    if (s.step === 'osteotomy') {
      if (s.plane === null) return;
      const plane = doc.plan.segments[s.segment]?.osteotomy.planes?.[s.plane];
      if (!plane) return;
      if (phase === 'start') {
        this.planeAtStart = plane;
        this.gesture++;
      }
      const from = this.planeAtStart ?? plane;
      const by = scale(drag.axis.direction, Math.round(drag.amount * 10) / 10);
      const next: Plane =
        drag.kind === 'translate'
          ? { ...from, point_mm: roundVec3(add(from.point_mm, by), 3) }
          : { ...from, towards_segment: tilted(from.towards_segment, drag.axis.direction, drag.amount) };
      if (phase !== 'start') app.edit({ plan: editPlane(doc.plan, s.segment, s.plane, next) }, `gizmo-${this.gesture}`);
    } else {
      if (phase === 'start') {
        this.moveAtStart = app.move();
        this.gesture++;
        return;
      }
      if (!this.moveAtStart) return;
      app.setMove(
        app.gizmoMove(this.moveAtStart, drag.kind, drag.axis.direction, drag.amount),
        `gizmo-${this.gesture}`,
      );
    }
    if (phase === 'end') {
      app.settle();
      this.changedAt = performance.now();
      this.moveAtStart = this.planeAtStart = null;
      this.present();
    }
  }

  private onBrush(at: { hit: Hit; body: string } | null, phase: Phase): void {
    const { boundaryBrush } = this.app;
    const surface = at && this.view.body(at.body)?.surface;
    if (at && surface) boundaryBrush.stamp(at.hit, surface);
    if (phase === 'end') boundaryBrush.endStroke();
  }

  private onPick(hit: Hit): void {
    this.place(hit.point, hit.normal);
  }

  /** A tool was used at a point. */
  private place(point: Vec3, normal: Vec3): void {
    const { app } = this;
    const { s, doc } = app.model;
    const at = roundVec3(point, 1);
    if (s.tool === 'landmark' && s.landmark) {
      app.edit({ landmarks: withLandmark(doc.landmarks, { name: s.landmark, position_mm: at }) });
      app.patch({ cursor_L: at, tool: 'none' });
    } else if (s.tool === 'plane') {
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
    } else if (s.tool === 'curve' && s.curveDraft) {
      app.patch({ curveDraft: { points: [...s.curveDraft.points, at], normals: [...s.curveDraft.normals, normal] } });
    } else if (s.tool === 'pivot') {
      // The bone stands where the plan has put it; a pivot is told in the bone as scanned.
      const move = app.move();
      if (!move) return;
      const back = inversePoint(this.app.poses()[doc.plan.segments[s.segment].name], at);
      app.setPivot(roundVec3(back, 1));
      app.patch({ tool: 'none' });
    }
  }

  private onMarkerSelect(id: string): void {
    const { s } = this.app.model;
    if (id.startsWith('curve ') || s.step !== 'landmarks') return;
    const landmark = this.app.model.doc.landmarks.find((l) => l.name === id);
    this.app.patch({ landmark: id, tool: 'none', ...(landmark ? { cursor_L: landmark.position_mm } : {}) });
    this.gesture++;
  }

  private onMarkerDrag(id: string, point: Vec3, phase: 'move' | 'end'): void {
    const { app } = this;
    const { s, doc } = app.model;
    const at = roundVec3(point, 1);
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

/** A direction turned about an axis. */
function tilted(direction: Vec3, axis: Vec3, deg: number): Vec3 {
  const k = unit(axis);
  const c = Math.cos((deg * Math.PI) / 180);
  const s = Math.sin((deg * Math.PI) / 180);
  const turned = cross(k, direction);
  const along = dot(k, direction) * (1 - c);
  return roundVec3(
    mapVec3(direction, (value, n) => value * c + turned[n] * s + k[n] * along),
    5,
  );
}

function inversePoint(X: readonly number[], p: Vec3): Vec3 {
  const d = [p[0] - X[3], p[1] - X[7], p[2] - X[11]];
  return mapVec3(p, (_, c) => X[c] * d[0] + X[4 + c] * d[1] + X[8 + c] * d[2]);
}
