import {
  cross,
  cssOf,
  dot,
  IDENTITY,
  kindOf,
  length,
  mapVec3,
  posedSectionOf,
  scale,
  sectionOf,
  segmentColor,
  sub,
  templateKey,
  templateKind,
  toPlane,
  unit,
  add,
  type Mat4,
  type Plane,
  type Segment,
  type Surface,
  type Vec3,
} from '../model';
import type { Marker, PlaneMark, Polyline, SliceLines, SliceMarker } from '../scene';
import { checkedFragments } from './fragments';
import { measureMarkers } from './measure_marks';
import { stageOf, type Doc, type State } from './state';

// Marks of the plan in the 3D view and on the slices, as functions of document and state.

const SELECTED_COLOR = '#f2b84b';
const LANDMARK_COLOR = '#3fb2c8';
const FRAGMENT_COLOR = '#d6409f';

/** Side of a plane that has no size of its own [mm]. */
const PLANE_SIZE_MM = 110;

/** Landmarks, the corners of the curve that is being drawn, or fragments of the checked cuts. */
export function markersOf(doc: Doc, s: State): Marker[] {
  if (s.curveDraft)
    return s.curveDraft.points.map((position, n) => ({
      id: `curve ${n}`,
      position,
      color: SELECTED_COLOR,
      draggable: true,
    }));
  if (s.step === 'measures') return measureMarkers(s);
  if (s.step === 'movement')
    return checkedFragments(s).map(({ segment, center_mm }, n) => ({
      id: `fragment ${n}`,
      position: center_mm,
      label: `fragment of ${segment}`,
      color: FRAGMENT_COLOR,
    }));
  const isEditable = s.step === 'landmarks';
  if (!isEditable && s.step !== 'osteotomy') return [];
  return doc.landmarks
    .filter(({ name }) => isEditable || kindOf(name)?.on === 'bone')
    .map(({ name, position_mm }) => ({
      id: name,
      position: position_mm,
      label: name,
      hides: true,
      selected: isEditable && name === s.landmark,
      color: isEditable && name === s.landmark ? SELECTED_COLOR : LANDMARK_COLOR,
      draggable: isEditable && s.tool !== 'landmark',
    }));
}

/** Landmarks on the slices. */
export function sliceMarkersOf(doc: Doc, s: State): SliceMarker[] {
  if (s.step === 'measures') return measureMarkers(s).map((marker) => ({ ...marker, selected: !!marker.selected }));
  if (s.step !== 'landmarks') return [];
  return doc.landmarks.map(({ name, position_mm }) => ({
    id: name,
    position: position_mm,
    label: name,
    color: name === s.landmark ? SELECTED_COLOR : LANDMARK_COLOR,
    selected: name === s.landmark,
  }));
}

/** The curve that is being drawn, else the curves of the plan. */
export function linesOf(doc: Doc, s: State): Polyline[] {
  if (s.curveDraft) {
    const { points } = s.curveDraft;
    return [{ points, closed: points.length > 2, color: SELECTED_COLOR, dashed: true }];
  }
  if (s.step !== 'osteotomy') return [];
  return doc.plan.segments.flatMap(({ osteotomy }, index) =>
    (osteotomy.curves ?? []).flatMap(({ points_mm }) =>
      points_mm ? [{ points: points_mm, closed: true, color: cssOf(segmentColor(index)) }] : [],
    ),
  );
}

/** The planes of all cuts, also of templates. */
export function planesOf(doc: Doc, s: State): PlaneMark[] {
  return doc.plan.segments.flatMap((segment, index) => {
    const color = cssOf(segmentColor(index));
    const own = (segment.osteotomy.planes ?? []).map((plane, n) => ({
      plane,
      selected: index === s.segment && n === s.plane,
    }));
    const placed = templatePlanes(doc, s, segment).map((plane) => ({ plane, selected: false }));
    return [...own, ...placed].map(({ plane, selected }) => ({
      point: plane.point_mm,
      normal: plane.towards_segment,
      size_mm: plane.size_mm ? Math.max(...plane.size_mm) : PLANE_SIZE_MM,
      color,
      selected,
    }));
  });
}

function templatePlanes(doc: Doc, s: State, { osteotomy }: Segment): Plane[] {
  if (!templateKind(osteotomy)) return [];
  const placed = s.templatePlanes.get(templateKey(osteotomy, doc.landmarks, stageOf(s, 'nerve')));
  if (!placed || typeof placed === 'string') return [];
  return [...placed.planes, ...(placed.additional_regions ?? []).flatMap((region) => region.planes)].map(toPlane);
}

/** Where a slice cuts a plane; null if it does not. */
function planeLine(mark: PlaneMark, at: { point: Vec3; normal: Vec3 }): Float32Array | null {
  const normal = unit(mark.normal);
  const direction = cross(normal, at.normal);
  if (length(direction) < 0.05) return null;
  const along = unit(direction);
  // The line passes through the point of the slice that is nearest to the plane's middle, in the plane.
  const towards = unit(cross(along, normal));
  const offset = dot(sub(at.point, mark.point), at.normal) / dot(towards, at.normal);
  const half = mark.size_mm / 2;
  if (Math.abs(offset) > half) return null;
  const middle = mapVec3(mark.point, (c, k) => c + offset * towards[k]);
  return Float32Array.from([...add(middle, scale(along, -half)), ...add(middle, scale(along, half))]);
}

/** Lines of the cutting planes on a slice. */
export function planeOutlines(doc: Doc, s: State, at: { point: Vec3; normal: Vec3 }): SliceLines[] {
  return planesOf(doc, s).flatMap((mark) => {
    const lines = planeLine(mark, at);
    return lines ? [{ lines, color: mark.color }] : [];
  });
}

/** Outline of a segment on a slice at its pose, and dashed where it was scanned. */
export function segmentOutlines(
  surface: Surface,
  pose: Mat4,
  color: string,
  at: { point: Vec3; normal: Vec3 },
): SliceLines[] {
  const moved = { lines: posedSectionOf(surface, pose, at.point, at.normal), color };
  if (pose.every((v, n) => v === IDENTITY[n])) return [moved];
  return [{ lines: sectionOf(surface, at.point, at.normal), color, dashed: true }, moved];
}
