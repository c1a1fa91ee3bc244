import type { Depths } from '../api';
import {
  add,
  BONE,
  cssOf,
  IDENTITY,
  kindOf,
  segmentColor,
  SKIN,
  toVec3,
  type DrawnSurface,
  type Mat4,
  type Vec3,
} from '../model';
import { PATIENT_AXES, planeAxes, SliceView, View3d, type BodyHit, type Phase, type SliceLines } from '../scene';
import type { App } from './app';
import { BandView } from './band_view';
import { BoundaryView } from './boundary_view';
import { CompareView } from './compare_view';
import { nerveOutlines } from './measure_marks';
import { measureColor, MeasuresView } from './measures_view';
import type { SceneListeners } from './planner_context';
import { ProfileDrag } from './profile_drag';
import { nextFrame } from './schedule';
import { isVariantsShown, stageOf, type State } from './state';
import { LABEL_TINTS } from './steps/anatomy_panel';
import { VariantsView } from './variants_view';
import { ViewerInput } from './viewer_input';
import { linesOf, markersOf, planeOutlines, planesOf, segmentOutlines, sliceMarkersOf } from './viewer_marks';

/** Overlap that has the strongest color [mm]. */
const DEPTH_TOP_MM = 2;

/** Overlap below which segments keep their color [mm]. */
const MIN_DEPTH_MM = 0.05;

/** Interval of the slices during a drag: three slices take as long as one picture of the bones. */
const SLICE_INTERVAL_MS = 100;

/** Delay of the preview, so that several changes request one. */
const PREVIEW_DELAY_MS = 30;

/** Properties of the state that change the views; the progress of jobs, for example, does not. */
const DRAWN_KEYS: readonly (keyof State)[] = [
  ...(['step', 'case', 'skullOpacity', 'skinOpacity', 'showLabels', 'labelsReady', 'tool', 'brush_mm'] as const),
  ...([
    'boundary',
    'showInterface',
    'paintOn',
    'paint_mm',
    'paintLabel',
    'landmark',
    'segment',
    'plane',
    'curveDraft',
  ] as const),
  ...(['templatePlanes', 'keyframe', 'scrub', 'planPoses', 'preview', 'showOverlap', 'showPreview'] as const),
  ...(['prediction', 'compareMode', 'compareStep', 'against', 'skinPaint', 'difference_mm', 'bonePaint'] as const),
  ...(['showBones', 'wipe', 'compareView', 'uncertainty', 'chosenVariants'] as const),
  ...(['measure', 'teeth', 'toothCorrections', 'showOcclusion', 'splintSettings', 'splints', 'guides'] as const),
  ...(['nerve', 'nervePoints', 'nervePoint', 'nerveDrag'] as const),
];

const SLICE_KEYS: readonly (keyof State)[] = ['window', 'cursor_L', 'thresholdOn', 'bone_hu', 'volume'];

/** Steps that show the segments at their planned pose. */
const isPosed = (step: State['step']): boolean => step === 'movement' || step === 'predict';

/** Steps that show the cut bone. */
const isCutShown = (s: State): boolean =>
  isPosed(s.step) || s.step === 'tissue' || (s.step === 'osteotomy' && stageOf(s, 'cut').state === 'fresh');

const isBandShown = (s: State): boolean => s.step === 'compare' && s.compareView === 'band';

/** Draws the document and the state in the 3D view and on the slices. */
export class Viewer implements SceneListeners {
  readonly view: View3d;
  readonly slices: readonly SliceView[];
  compare!: CompareView;
  band!: BandView;
  private measures!: MeasuresView;
  private variants!: VariantsView;
  profileDrag!: ProfileDrag;
  private boundary!: BoundaryView;
  private input!: ViewerInput;
  private app!: App;
  private depths: Depths | null = null;
  private paintedDepths: readonly unknown[] = [];
  private previewOn = false;
  /** Number of surfaces that were set; their colors must be painted again. */
  private surfaceCount = 0;
  private previewKey = '';
  private previewTimer: ReturnType<typeof setTimeout> | undefined;
  private depthKey = '';
  private slicesDrawnAt = 0;
  private pending = false;

  constructor() {
    this.view = new View3d({
      onPress: () => this.presentPending(),
      onGizmo: (drag, phase) => this.input.onGizmo(drag, phase),
      isPlacing: () => ['landmark', 'plane', 'curve', 'pivot'].includes(this.app.model.s.tool),
      onPick: (hit) => this.input.place(hit.point, hit.normal),
      isPainting: () => this.app.model.s.tool === 'paint',
      onPaint: (at, phase) => this.onBrush(at, phase),
      onMarkerDrag: (id, hit, phase) => this.input.onMarkerDrag(id, hit.point, phase === 'end' ? 'end' : 'move'),
      onMarkerSelect: (id) => this.input.onMarkerSelect(id),
      onWipe: (fraction) => this.app.patch({ wipe: fraction }),
    });
    this.slices = (['axial', 'coronal', 'sagittal'] as const).map((orientation) => {
      const slice: SliceView = new SliceView(orientation, {
        onCursor: (cursor_L) => this.app.patch({ cursor_L }),
        onWindow: (window) => this.app.patch({ window }),
        onMarkerDrag: (id, p_L, phase) => this.input.onMarkerDrag(id, p_L, phase),
        onMarkerSelect: (id) => this.input.onMarkerSelect(id),
        onTool: (p_L, phase) => this.onSliceTool(p_L, phase),
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
    this.band = new BandView(this.view, app);
    this.measures = new MeasuresView(this.view, app);
    this.variants = new VariantsView(this.view);
    this.profileDrag = new ProfileDrag(app, () => this.view.body('skin'));
    this.boundary = new BoundaryView(this.view, app);
    this.input = new ViewerInput(app, () => this.present());
    app.model.state.subscribe((state, before) => this.onState(state, before));
    app.model.history.subscribe(() => this.present());
  }

  // Results

  onSurface(name: string, surface: DrawnSurface | null): void {
    if (!surface) {
      this.view.removeBody(name);
      this.band.surfaceChanged(name);
      this.present();
      return;
    }
    const index = this.app.model.doc.plan.segments.findIndex((x) => `segments/${x.name}` === name);
    const color = name.startsWith('segments/')
      ? segmentColor(Math.max(0, index))
      : /skin|predicted|after_surgery|band|^variants\//.test(name)
        ? SKIN
        : (measureColor(name) ?? BONE);
    this.view.setBody(name, surface, color);
    this.surfaceCount++;
    this.previewKey = this.depthKey = '';
    this.compare.surfaceChanged(name);
    this.band.surfaceChanged(name);
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
    // Once per frame: the brush can be applied several times in a frame.
    this.view.beforePicture = () => this.boundary.present(this.app.model.s);
    this.view.render();
  }

  private onBrush(at: BodyHit | null, phase: Phase): void {
    const { boundaryBrush } = this.app;
    const surface = at && this.view.body(at.body)?.surface;
    if (at && surface) boundaryBrush.stamp(at.hit, surface);
    if (phase === 'end') boundaryBrush.endStroke();
  }

  private onSliceTool(p_L: Vec3, phase: Phase): void {
    if (this.app.model.s.tool === 'brush') this.app.labelBrush.brush(p_L, phase);
    else if (phase === 'end') this.input.place(p_L, [0, 0, 0]);
  }

  // State

  private onState(state: State, before: State): void {
    const hasChanged = (key: keyof State): boolean => state[key] !== before[key];
    const { volume, window, cursor_L } = state;
    if (hasChanged('volume'))
      for (const slice of this.slices) slice.setVolume(volume?.grid ?? null, volume?.data ?? null);
    if (SLICE_KEYS.some(hasChanged)) {
      const threshold_hu = state.thresholdOn ? state.bone_hu : null;
      for (const slice of this.slices) slice.set({ window, cursor_L, threshold_hu });
    }
    if (DRAWN_KEYS.some(hasChanged)) this.present();
  }

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
    const { s } = this.app.model;
    if (s.step === 'osteotomy' || s.step === 'tissue' || isPosed(s.step)) void this.app.placeTemplates();
    this.presentBodies(s);
    this.presentPoses(s);
    this.requestResults(s);
    this.paintDepths();
    this.boundary.present(s);
    this.presentMarks(s);
    this.presentGizmo(s);
    this.presentSlices(s);
    this.compare.present(s);
    if (isBandShown(s)) this.band.present();
    this.variants.present(s);
    this.measures.present(s);
    this.view.refreshMarkers();
  }

  /** Sets which bodies are visible, how opaque, and which of them can be picked. */
  private presentBodies(s: State): void {
    const { view } = this;
    const skinOpacity = this.skinOpacity(s);
    view.setOpacity('skin', skinOpacity);
    view.setOpacity('skull', s.step === 'anatomy' ? s.skullOpacity : 1);
    let bodies = this.bodies(s);
    // An opaque skin hides everything else.
    if (view.body('skin') && bodies.includes('skin') && s.step !== 'compare' && skinOpacity === 1) bodies = ['skin'];
    view.show(bodies);
    view.pickable = (name) => this.isPickable(s, name);
  }

  private bodies(s: State): string[] {
    if (isBandShown(s)) return ['band'];
    if (isVariantsShown(s)) return this.variants.bodies(s);
    if (s.step === 'compare') return this.compare.bodies(s);
    if (s.step === 'measures') return this.measures.bodies(s);
    const segments = this.app.model.doc.plan.segments.map((x) => `segments/${x.name}`);
    const isCut =
      s.case !== null && this.view.body('remainder') !== undefined && segments.some((name) => this.view.body(name));
    const bones = isCut && isCutShown(s) ? ['remainder', ...segments] : ['skull'];
    return this.boundary.isMapShown(s) ? [...bones, 'interface'] : [...bones, 'skin'];
  }

  private skinOpacity(s: State): number {
    const opacities: Record<State['step'], number> = {
      case: 1,
      anatomy: s.skinOpacity,
      landmarks: s.landmark && kindOf(s.landmark)?.on === 'skin' ? 1 : 0,
      osteotomy: 0,
      movement:
        s.showPreview && (s.preview.state === 'shown' || (s.preview.state === 'waiting' && this.previewOn)) ? 0.45 : 0,
      tissue: s.tool !== 'paint' ? 0.35 : s.paintOn === 'skin' ? 1 : 0,
      predict: s.showPreview ? 1 : 0.45,
      compare: 1,
      measures: 0,
    };
    return opacities[s.step];
  }

  private isPickable(s: State, name: string): boolean {
    if (s.step === 'landmarks') return !s.landmark || kindOf(s.landmark)?.on !== 'bone' || name === 'skull';
    if (s.step === 'osteotomy' || s.step === 'movement') return name !== 'skin';
    return s.step !== 'tissue' || this.boundary.isPaintable(s, name);
  }

  private presentPoses(s: State): void {
    const poses = this.app.poses();
    this.app.model.doc.plan.segments.forEach(({ name }, index) => {
      if (this.view.body(`segments/${name}`)) this.view.setPose(`segments/${name}`, this.poseOf(s, name, index, poses));
    });
  }

  private poseOf(s: State, name: string, index: number, poses: Record<string, Mat4>): Mat4 {
    if (s.step === 'compare') return this.compare.poseOf(s, index);
    return isPosed(s.step) ? (poses[name] ?? IDENTITY) : IDENTITY;
  }

  /** Requests overlap and preview of the shown poses. */
  private requestResults(s: State): void {
    const { live } = this.app;
    if (!isPosed(s.step)) {
      if (!this.previewOn || s.step === 'compare') return;
      live.dropPreview();
      this.previewKey = '';
      return;
    }
    const poses = this.app.cutPoses();
    const [cut, preview] = [stageOf(s, 'cut'), stageOf(s, 'preview')];
    const depthKey = JSON.stringify([poses, cut.state, cut.etag]);
    if (depthKey !== this.depthKey) {
      this.depthKey = depthKey;
      live.requestDepths(poses);
    }
    const previewKey = `${depthKey} ${preview.etag} ${preview.state} ${s.showPreview} ${this.isDragging}`;
    if (previewKey === this.previewKey) return;
    this.previewKey = previewKey;
    clearTimeout(this.previewTimer);
    if (this.isDragging) {
      live.requestPreview(null);
      return;
    }
    const since = Math.max(this.input.changedAt, performance.now() - 50);
    this.previewTimer = setTimeout(() => live.requestPreview(since), PREVIEW_DELAY_MS);
  }

  private presentMarks(s: State): void {
    const { view } = this;
    const { doc } = this.app.model;
    const painted = s.boundary?.names.find((x) => x.value === s.paintLabel);
    view.brush_mm = s.paint_mm;
    view.brushColor = cssOf(painted ? toVec3(painted.color) : BONE);
    view.markers = markersOf(doc, s);
    view.lines = linesOf(doc, s);
    const showsPlanes = s.step === 'osteotomy' && (stageOf(s, 'cut').state !== 'fresh' || s.plane !== null);
    view.setPlanes(showsPlanes ? planesOf(doc, s) : []);
  }

  private presentGizmo(s: State): void {
    const { gizmo } = this.view;
    const segment = this.app.model.doc.plan.segments[s.segment];
    const move = this.app.move();
    const plane = s.step === 'osteotomy' && s.plane !== null ? segment?.osteotomy.planes?.[s.plane] : undefined;
    if (s.step === 'movement' && move && segment && this.view.body(`segments/${segment.name}`) && s.scrub === null) {
      gizmo.at_L = add(move.about_mm, move.translation_mm);
      gizmo.axes = PATIENT_AXES;
    } else if (plane) {
      gizmo.at_L = plane.point_mm;
      if (!gizmo.isDragging) gizmo.axes = planeAxes(plane.towards_segment);
    } else gizmo.at_L = null;
  }

  /** Draws the slices; during a drag they follow at a lower rate. */
  private presentSlices(s: State): void {
    const now = performance.now();
    const isDue = s.step !== 'movement' || !this.isDragging || now - this.slicesDrawnAt > SLICE_INTERVAL_MS;
    if (isDue) this.slicesDrawnAt = now;
    const showsLabels = s.step === 'anatomy' && s.showLabels && s.labelsReady;
    for (const slice of this.slices) {
      slice.tool = s.tool === 'brush' ? 'brush' : s.tool === 'landmark' ? 'place' : 'none';
      slice.brush_mm = s.brush_mm;
      slice.setLabels(showsLabels ? this.app.model.labels : null, [...LABEL_TINTS]);
      slice.markers = sliceMarkersOf(this.app.model.doc, s);
      if (isDue) slice.draw();
    }
  }

  /** Colors the segments by their overlap with other bone. */
  private paintDepths(): void {
    const { s, doc } = this.app.model;
    const now = [this.depths, s.showOverlap, s.step, this.surfaceCount];
    if (now.every((value, n) => value === this.paintedDepths[n])) return;
    this.paintedDepths = now;
    const depths = s.showOverlap && isPosed(s.step) ? this.depths : null;
    doc.plan.segments.forEach(({ name }, index) => {
      const body = this.view.body(`segments/${name}`);
      if (!body) return;
      const values = depths?.bySegment.get(name);
      const fits = values?.length === body.surface.points.length / 3;
      if (values && fits && depths && depths.deepest_mm > MIN_DEPTH_MM)
        body.setValues(values, 'depth', 0, DEPTH_TOP_MM, segmentColor(index));
      else body.setColor(segmentColor(index));
    });
    this.view.render();
  }

  /** Lines on a slice: planes of the cuts, or outlines of the segments. */
  private outlines(at: { point: Vec3; normal: Vec3 }): SliceLines[] {
    const { s, doc } = this.app.model;
    if (s.step === 'osteotomy') return planeOutlines(doc, s, at);
    if (s.step === 'measures' && s.measure === 'nerve')
      return nerveOutlines(
        ['nerve_right', 'nerve_left'].flatMap((name) => this.view.body(name)?.surface ?? []),
        at,
      );
    if (s.step !== 'movement') return [];
    const poses = this.app.poses();
    return doc.plan.segments.flatMap(({ name }, index) => {
      const body = this.view.body(`segments/${name}`);
      return body ? segmentOutlines(body.surface, poses[name] ?? IDENTITY, cssOf(segmentColor(index)), at) : [];
    });
  }
}
