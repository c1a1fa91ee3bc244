import type { Schemas } from '../api';
import {
  startHistory,
  Store,
  emptyPlan,
  type Band,
  type DrawnSurface,
  type Grid,
  type History,
  type LabelEdit,
  type Landmark,
  type Plan,
  type Vec3,
  type Window,
  WINDOW_PRESETS,
} from '../model';

import { initialMeasures, type MeasureState } from './measure_state';
import { initialVariants, type VariantState } from './variant_state';

export const STEPS = [
  { name: 'case', title: 'Case' },
  { name: 'anatomy', title: 'Anatomy' },
  { name: 'landmarks', title: 'Landmarks' },
  { name: 'osteotomy', title: 'Osteotomy' },
  { name: 'movement', title: 'Movement' },
  { name: 'tissue', title: 'Tissue & solver' },
  { name: 'predict', title: 'Predict' },
  { name: 'compare', title: 'Compare' },
  { name: 'measures', title: 'Teeth & measures' },
] as const;

export type StepName = (typeof STEPS)[number]['name'];

export const isStepName = (name: string | null): name is StepName => STEPS.some((step) => step.name === name);

/** The document: undo and redo act on it. */
export interface Doc {
  readonly plan: Plan;
  readonly landmarks: readonly Landmark[];
  /** Strokes of the label brush since the labels were read. */
  readonly strokes: readonly LabelEdit[];
  /** Strokes on the tissue boundary since it was read. */
  readonly paint: readonly LabelEdit[];
}

export interface Volume {
  grid: Grid;
  data: Int16Array;
  presets: readonly (Window & { name: string })[];
}

export interface Toast {
  id: number;
  kind: 'info' | 'error';
  text: string;
}

/** One Newton iteration. */
export type NewtonPoint = Schemas['NewtonIterate'];

export type Tool = 'none' | 'landmark' | 'plane' | 'curve' | 'pivot' | 'brush' | 'paint';

export interface State extends MeasureState, VariantState {
  connection: 'connecting' | 'on' | 'lost';
  /** The planner cannot work: no token, or a server of another version. */
  fatal: string | null;
  step: StepName;
  case: Schemas['Case'] | null;
  jobs: readonly Schemas['Job'][];
  upload: { name: string; fraction: number } | null;
  saving: 'saved' | 'saving' | 'unsaved' | 'error';
  saveError: string | null;
  conflict: 'plan' | 'landmarks' | 'boundary' | null;

  volume: Volume | null;
  volumeLoading: boolean;
  surfacesLoading: number;
  window: Window;
  cursor_L: Vec3;
  skullOpacity: number;
  skinOpacity: number;
  showLabels: boolean;
  labelNames: Schemas['Labels']['names'];
  labelsReady: boolean;
  brushLabel: number;
  brush_mm: number;
  thresholdOn: boolean;
  bone_hu: number;

  boundary: Schemas['Boundary'] | null;
  /** Label of the boundary brush; 0 erases. */
  paintLabel: number;
  paint_mm: number;
  paintOn: 'bone' | 'skin';
  /** Show the interface map on the bones. */
  showInterface: boolean;
  /** Painted area of bone and skin by label [mm²]; null until known. */
  paintedAreas: readonly number[] | null;

  tool: Tool;
  landmark: string | null;
  measurements: Schemas['Measurements']['measurements'] | null;
  measurementError: string | null;
  segment: number;
  plane: number | null;
  curveDraft: { points: Vec3[]; normals: Vec3[] } | null;
  templatePlanes: ReadonlyMap<string, Schemas['Osteotomy']['osteotomy'] | string>;
  keyframe: number;
  /** Fraction of the path while the timeline is scrubbed. */
  scrub: number | null;
  planPoses: Schemas['PlanPoses'] | null;
  depth: { deepest_mm: number; depthIsLowerBound: boolean; perSecond: number } | null;
  showOverlap: boolean;
  /** Show slices beside the bones in the step of the movement. */
  showSlices: boolean;
  /** A point of the skin that is dragged on the profile: y and z in L. */
  profilePoint: {
    wanted: [number, number];
    reached: [number, number];
    state: 'waiting' | 'shown' | 'limit' | 'failed';
    why: string;
  } | null;
  preview: {
    state: 'none' | 'waiting' | 'shown' | 'failed';
    latency_ms: number | null;
    why: string;
    max_mm: number;
  };
  showPreview: boolean;

  prediction: Schemas['Prediction'] | null;
  newton: readonly NewtonPoint[];
  steps: readonly Schemas['StepEvent'][];
  previewDistance: Schemas['PreviewDistance'] | null;
  files: Schemas['FileList']['files'];
  compareMode: 'slider' | 'beside' | 'after';
  compareStep: number;
  /** The face in the left half. */
  against: 'before' | 'after_surgery';
  /** Color of the skin: plain, displacement, or distance to the face after surgery. */
  skinPaint: 'none' | 'moved' | 'error';
  bonePaint: 'none' | 'pressure' | 'depth';
  /** Upper end of the legend of the bone, kPa or mm; null if nothing is colored. */
  boneTop: number | null;
  regionShifts: Schemas['RegionShifts'] | null;
  comparison: Schemas['Comparison'] | null;
  /** Distance of each vertex of the predicted face to the face after surgery. */
  difference_mm: Float32Array | null;
  errorTop_mm: number;
  showBones: boolean;
  wipe: number;
  distanceTop_mm: number;

  /** The step of the comparison shows the faces, the band of the uncertain inputs, or variants of the plan. */
  compareView: 'faces' | 'band' | 'variants';
  uncertainty: Schemas['Uncertainty'] | null;
  /** Upper end of the legend of the band width. */
  bandTop_mm: number;
  /** Number of the region whose indices are listed. */
  bandRegion: number;
  /** Samples of the next computation. */
  bandSamples: number;

  toasts: readonly Toast[];
  help: boolean;
  theme: 'system' | 'light' | 'dark';
}

const initialCase = () =>
  ({
    connection: 'connecting',
    fatal: null,
    step: 'case',
    case: null,
    jobs: [],
    upload: null,
    saving: 'saved',
    saveError: null,
    conflict: null,
  }) satisfies Partial<State>;

const initialViews = () =>
  ({
    volume: null,
    volumeLoading: false,
    surfacesLoading: 0,
    window: { level_hu: WINDOW_PRESETS[0].level_hu, window_hu: WINDOW_PRESETS[0].window_hu },
    cursor_L: [0, 0, 0],
    skullOpacity: 1,
    skinOpacity: 0.35,
    showLabels: false,
    labelNames: [],
    labelsReady: false,
    brushLabel: 1,
    brush_mm: 3,
    thresholdOn: false,
    bone_hu: 226,
    boundary: null,
    paintLabel: 1,
    paint_mm: 4,
    paintOn: 'bone',
    showInterface: true,
    paintedAreas: null,
  }) satisfies Partial<State>;

const initialPlanning = () =>
  ({
    tool: 'none',
    landmark: null,
    measurements: null,
    measurementError: null,
    segment: 0,
    plane: null,
    curveDraft: null,
    templatePlanes: new Map(),
    keyframe: 0,
    scrub: null,
    planPoses: null,
    depth: null,
    showOverlap: true,
    showSlices: false,
    profilePoint: null,
    preview: { state: 'none', latency_ms: null, why: '', max_mm: 0 },
    showPreview: true,
  }) satisfies Partial<State>;

const initialResults = () =>
  ({
    prediction: null,
    newton: [],
    steps: [],
    previewDistance: null,
    files: [],
    compareMode: 'slider',
    compareStep: 0,
    against: 'before',
    skinPaint: 'none',
    bonePaint: 'none',
    boneTop: null,
    regionShifts: null,
    comparison: null,
    difference_mm: null,
    errorTop_mm: 1,
    showBones: false,
    wipe: 0.5,
    distanceTop_mm: 1,
    compareView: 'faces',
    uncertainty: null,
    bandTop_mm: 1,
    bandRegion: 0,
    bandSamples: 200,
    toasts: [],
    help: false,
    theme: 'system',
  }) satisfies Partial<State>;

export const initialState = (): State => ({
  ...initialCase(),
  ...initialViews(),
  ...initialPlanning(),
  ...initialResults(),
  ...initialMeasures(),
  ...initialVariants(),
});

export const emptyDoc = (): Doc => ({ plan: emptyPlan(), landmarks: [], strokes: [], paint: [] });

export interface LoadedSurface {
  etag: string;
  surface: DrawnSurface;
  /** Condition of each vertex of the surface `interface`: values of Boundary.conditions. */
  condition?: Uint8Array;
  /** Of the surface `band`. */
  band?: Band;
  /** Of the surface `lower_in_occlusion`: gap to the upper arch. */
  gap_mm?: Float32Array;
}

/** All data of the page. Large arrays are not part of the state, because no text depends on them. */
export class Model {
  readonly state = new Store<State>(initialState());
  readonly history = new Store<History<Doc>>(startHistory(emptyDoc()));
  readonly surfaces = new Map<string, LoadedSurface>();
  labels: Uint8Array | null = null;
  labelsEtag: string | null = null;

  get s(): State {
    return this.state.value;
  }

  get doc(): Doc {
    return this.history.value.present;
  }
}

export const stageOf = (state: State, name: keyof Schemas['Case']['stages']): Schemas['Stage'] =>
  state.case?.stages[name] ?? { state: 'missing', why: '', etag: null };

/** Whether the step of the comparison shows variants of the plan. */
export const isVariantsShown = (s: State): boolean => s.step === 'compare' && s.compareView === 'variants';

export const runningJob = (state: State): Schemas['Job'] | null =>
  state.jobs.find((job) => job.state === 'running') ?? state.jobs.find((job) => job.state === 'queued') ?? null;

export const lastJob = (state: State, kind: Schemas['JobKind']): Schemas['Job'] | null =>
  [...state.jobs].reverse().find((job) => job.kind === kind) ?? null;

export const isBusyWith = (state: State, kind: Schemas['JobKind']): boolean =>
  state.jobs.some((job) => job.kind === kind && (job.state === 'running' || job.state === 'queued'));
