import type { Schemas } from '../api';
import { sub, toVec3, unit, type Vec3 } from './frames';

/** The plan file of the command line (contract/plan.schema.json), as far as the page edits it; it keeps other keys. */
export interface Plan {
  lefort_plan: 1;
  title?: string;
  segmentation?: { labels?: string; teeth?: string; bone_hu?: number; skin_hu?: number };
  landmarks?: string | Record<string, Vec3>;
  segments: Segment[];
  tissue?: Tissue;
  boundary?: Boundary;
  contact?: Contact;
  field?: { resolution?: number; band_mm?: number; tolerance_mm?: number };
  solver?: { relative_tolerance?: number; max_iterations?: number; min_increment_ratio?: number };
}

export interface Segment {
  name: string;
  cut_from?: string;
  osteotomy: Osteotomy;
  path: Path;
}

export interface Plane {
  point_mm: Vec3;
  towards_segment: Vec3;
  size_mm?: [number, number];
  across?: Vec3;
}

export interface Curve {
  points_mm?: Vec3[];
  file?: string;
  along: Vec3;
  depth_mm?: number;
}

export type TemplateKind = Schemas['TemplateKind'];

/** As in a request, with the canals of the case (canals.ts). */
export type Template = TemplateKind | (Exclude<Schemas['OsteotomyRequest']['template'], string> & { nerve?: string });

export interface Osteotomy {
  planes?: Plane[];
  curves?: Curve[];
  additional_regions?: { planes?: Plane[]; curves?: Curve[] }[];
  template?: Template;
  kerf_mm?: number;
  anchor_points?: (string | Vec3)[];
  min_piece_ml?: number;
  min_piece_fraction?: number;
}

export interface Keyframe {
  path_fraction?: number;
  translation_mm?: Vec3;
  rotation_deg?: Vec3;
  about_mm?: Vec3;
  about?: string;
  targets?: string | Record<string, Vec3>;
  tolerance_mm?: number;
  transform?: string;
  autorotate?: { closing_deg?: number; gap_mm?: number; to?: string; as?: string };
}

export interface Path {
  steps?: number;
  interpolation?: 'straight' | 'screw';
  distraction?: { towards: Vec3; mm_per_day: number; days: number }[];
  keyframes?: Keyframe[];
}

/** A preset's name, or constants. */
export type Material = string | { law: 'neo-hookean'; young_kpa: number; poisson: number };

export interface Tissue {
  material?: Material;
  skin?: { thickness_mm?: number; layers?: number; material?: Material };
  mucosa?: { thickness_mm: number; material: Material };
  muscle?: { material: Material };
  lips_and_nose_element_size_mm?: number;
  element_size_mm?: number;
  far_element_size_mm?: number;
  element_order?: 1 | 2;
  margin_mm?: number;
}

/** What a plane does in which the mesh ends. */
export type OuterBoundary = 'roller' | 'free' | 'fixed' | 'foundation';

export interface Boundary {
  interface?: 'clinical' | 'bonded' | 'contact';
  scan_boundary?: OuterBoundary;
  cut_boundary?: OuterBoundary;
  foundation_mm?: number;
  /** Without: the distances of the procedure. */
  elevation_margin_mm?: number;
  joint_margin_mm?: number;
  vestibule_mm?: number;
  interface_layer_mm?: number;
  lips?: 'separate' | 'joined';
  lip_tone_kpa?: number;
  contact_snap_mm?: number;
  labels?: string;
}

export interface Contact {
  stiffness_factor?: number;
  obstacle?: 'regularized' | 'bone';
  detection?: 'smooth' | 'trilinear' | 'bvh';
  penetration_tolerance_mm?: number | null;
}

/** Default number of steps of a path (docs/guide/osteotomies.md). */
export const DEFAULT_STEPS = 12;

export const TEMPLATES: readonly {
  kind: TemplateKind;
  title: string;
  needs: readonly string[];
  describes: string;
}[] = [
  {
    kind: 'le-fort-1',
    title: 'Le Fort I',
    needs: ['ANS', 'PNS'],
    describes: 'Parallel to the palate, above the roots of the teeth; posterior to PNS.',
  },
  {
    kind: 'le-fort-2',
    title: 'Le Fort II',
    needs: ['N', 'Or-R', 'Or-L', 'ANS', 'PNS'],
    describes: 'Pyramidal, through nasion and both orbital rims.',
  },
  {
    kind: 'le-fort-3',
    title: 'Le Fort III',
    needs: ['N', 'Or-R', 'Or-L', 'FZ-R', 'FZ-L', 'ANS', 'PNS'],
    describes: 'The midface, through the lateral walls of the orbits.',
  },
  {
    kind: 'sagittal-split',
    title: 'Sagittal split (BSSO)',
    needs: ['Me', 'Go-R', 'Go-L', 'Co-R', 'Co-L', 'L6-R', 'L6-L'],
    describes: 'The distal (tooth-bearing) segment of the mandible.',
  },
  { kind: 'genioplasty', title: 'Genioplasty', needs: ['Me', 'Pg', 'Go-R', 'Go-L'], describes: 'The chin.' },
];

/** Landmarks that a template still needs. */
export const missingFor = (kind: TemplateKind, placed: Iterable<string>): string[] => {
  const names = new Set(placed);
  return TEMPLATES.find((t) => t.kind === kind)!.needs.filter((name) => !names.has(name));
};

export const emptyPlan = (): Plan => ({ lefort_plan: 1, segments: [] });

export const templateKind = (osteotomy: Osteotomy): TemplateKind | null =>
  osteotomy.template === undefined
    ? null
    : typeof osteotomy.template === 'string'
      ? osteotomy.template
      : osteotomy.template.kind;

/** The server's plan as a `Plan`; the contract has checked its version and that it has segments. */
export const toPlan = (value: Schemas['Plan']): Plan => value as Plan;

/** A name no segment has yet: base, base-2, base-3 ... */
export function freeName(plan: Plan, base: string): string {
  const taken = new Set(plan.segments.map((s) => s.name));
  for (let n = 1; ; n++) {
    const name = n === 1 ? base : `${base}-${n}`;
    if (!taken.has(name)) return name;
  }
}

/** The path of a new segment: no movement. */
const REST: Path = { keyframes: [{ translation_mm: [0, 0, 0] }] };

export const withSegment = (plan: Plan, base: string, osteotomy: Osteotomy): Plan => ({
  ...plan,
  segments: [...plan.segments, { name: freeName(plan, base), osteotomy, path: REST }],
});

export const editSegment = (plan: Plan, index: number, edit: (segment: Segment) => Segment): Plan => ({
  ...plan,
  segments: plan.segments.map((segment, n) => (n === index ? edit(segment) : segment)),
});

/** Removes a segment; segments cut from it are then cut from its parent. */
export function withoutSegment(plan: Plan, index: number): Plan {
  const gone = plan.segments[index];
  const rest = plan.segments.filter((_, n) => n !== index);
  return {
    ...plan,
    segments: rest.map((segment) => {
      if (segment.cut_from !== gone.name) return segment;
      const free = { ...segment };
      delete free.cut_from;
      return gone.cut_from === undefined ? free : { ...free, cut_from: gone.cut_from };
    }),
  };
}

/** Renames a segment wherever it is named. Returns null if the name is taken or not allowed. */
export function renameSegment(plan: Plan, index: number, name: string): Plan | null {
  if (!/^[A-Za-z0-9_-]{1,40}$/.test(name)) return null;
  if (plan.segments.some((segment, n) => n !== index && segment.name === name)) return null;
  const before = plan.segments[index].name;
  return {
    ...plan,
    segments: plan.segments.map((segment, n) => ({
      ...segment,
      ...(n === index ? { name } : {}),
      ...(segment.cut_from === before ? { cut_from: name } : {}),
    })),
  };
}

export const editOsteotomy = (plan: Plan, index: number, edit: (osteotomy: Osteotomy) => Osteotomy): Plan =>
  editSegment(plan, index, (segment) => ({ ...segment, osteotomy: edit(segment.osteotomy) }));

export const withPlane = (plan: Plan, index: number, plane: Plane): Plan =>
  editOsteotomy(plan, index, (o) => ({ ...o, planes: [...(o.planes ?? []), plane] }));

export const editPlane = (plan: Plan, index: number, n: number, plane: Plane): Plan =>
  editOsteotomy(plan, index, (o) => ({ ...o, planes: o.planes?.map((p, k) => (k === n ? plane : p)) }));

export const withoutPlane = (plan: Plan, index: number, n: number): Plan =>
  editOsteotomy(plan, index, ({ planes, ...o }) => {
    const rest = planes?.filter((_, k) => k !== n) ?? [];
    return rest.length > 0 ? { ...o, planes: rest } : o;
  });

export const withCurve = (plan: Plan, index: number, curve: Curve): Plan =>
  editOsteotomy(plan, index, (o) => ({ ...o, curves: [...(o.curves ?? []), curve] }));

export const withoutCurve = (plan: Plan, index: number, n: number): Plan =>
  editOsteotomy(plan, index, ({ curves, ...o }) => {
    const rest = curves?.filter((_, k) => k !== n) ?? [];
    return rest.length > 0 ? { ...o, curves: rest } : o;
  });

/** True if the cut has no template, plane or curve; the server refuses it. */
export const cutsNothing = (o: Osteotomy): boolean =>
  o.template === undefined && !o.planes?.length && !o.curves?.length;

export const keyframesOf = (segment: Segment): Keyframe[] => segment.path.keyframes ?? [];

export const editKeyframe = (plan: Plan, index: number, k: number, keyframe: Keyframe): Plan =>
  editSegment(plan, index, (segment) => ({
    ...segment,
    path: { ...segment.path, keyframes: keyframesOf(segment).map((old, n) => (n === k ? keyframe : old)) },
  }));

const withoutTime = (keyframe: Keyframe): Keyframe => {
  const rest = { ...keyframe };
  delete rest.path_fraction;
  return rest;
};

/** Spreads keyframes evenly again; the last must be at 1. */
const spread = (keyframes: Keyframe[]): Keyframe[] =>
  keyframes.map((keyframe, n) =>
    keyframes.length === 1
      ? withoutTime(keyframe)
      : { ...keyframe, path_fraction: Math.round(((n + 1) / keyframes.length) * 1e6) / 1e6 },
  );

/** Inserts a copy of keyframe k after it. */
export const withKeyframeAfter = (plan: Plan, index: number, k: number): Plan =>
  editSegment(plan, index, (segment) => {
    const keyframes = keyframesOf(segment);
    const copy = [...keyframes.slice(0, k + 1), keyframes[k], ...keyframes.slice(k + 1)];
    return { ...segment, path: { ...segment.path, keyframes: spread(copy) } };
  });

export const withoutKeyframe = (plan: Plan, index: number, k: number): Plan =>
  editSegment(plan, index, (segment) => {
    const keyframes = keyframesOf(segment);
    if (keyframes.length < 2) return segment;
    return { ...segment, path: { ...segment.path, keyframes: spread(keyframes.filter((_, n) => n !== k)) } };
  });

/** Moves keyframe k along the path, between its neighbors; the last stays at 1. */
export const retimeKeyframe = (plan: Plan, index: number, k: number, at: number): Plan =>
  editSegment(plan, index, (segment) => {
    const keyframes = keyframesOf(segment);
    if (k >= keyframes.length - 1) return segment;
    const before = k === 0 ? 0 : (keyframes[k - 1].path_fraction ?? k / keyframes.length);
    const after = keyframes[k + 1].path_fraction ?? (k + 2) / keyframes.length;
    const gap = 0.01;
    const clamped = Math.min(after - gap, Math.max(before + gap, at));
    return {
      ...segment,
      path: {
        ...segment.path,
        keyframes: keyframes.map((old, n) => (n === k ? { ...old, path_fraction: clamped } : old)),
      },
    };
  });

/** True if the page can edit the path: its keyframes are numbers, not targets, files, autorotation or days. */
export const isEditablePath = (path: Path): boolean =>
  path.keyframes !== undefined &&
  path.keyframes.every((k) => k.targets === undefined && k.transform === undefined && k.autorotate === undefined);

/** Boundary options with a change; options that are undefined are removed. */
export function withBoundary(boundary: Boundary, part: Partial<Boundary>): Boundary {
  const all = Object.entries({ ...boundary, ...part });
  return Object.fromEntries(all.filter(([, value]) => value !== undefined));
}

/** Sets or removes the file of the painted boundary. */
export function withPaintedBoundary(plan: Plan, file: string | null): Plan {
  if (file !== null)
    return plan.boundary?.labels === file ? plan : { ...plan, boundary: { ...plan.boundary, labels: file } };
  if (plan.boundary?.labels === undefined) return plan;
  const boundary = { ...plan.boundary };
  delete boundary.labels;
  return { ...plan, boundary };
}

/** A plane from the server. */
export const toPlane = (plane: { point_mm: readonly number[]; towards_segment: readonly number[] }): Plane => ({
  ...plane,
  point_mm: toVec3(plane.point_mm),
  towards_segment: toVec3(plane.towards_segment),
});

/** The osteotomy that the server placed for a template. */
export function toOsteotomy({
  planes,
  additional_regions,
  anchor_points,
}: Schemas['Osteotomy']['osteotomy']): Osteotomy {
  const osteotomy: Osteotomy = { planes: planes.map(toPlane) };
  if (additional_regions)
    osteotomy.additional_regions = additional_regions.map((region) => ({ planes: region.planes.map(toPlane) }));
  if (anchor_points)
    osteotomy.anchor_points = anchor_points.map((point) => (typeof point === 'string' ? point : toVec3(point)));
  return osteotomy;
}

/** A plane through a point; its normal points to the segment. */
export const planeAt = (point_mm: Vec3, towards: Vec3): Plane => ({ point_mm, towards_segment: unit(towards) });

/** The plane with its sides swapped. */
export const flipped = (plane: Plane): Plane => ({ ...plane, towards_segment: sub([0, 0, 0], plane.towards_segment) });
