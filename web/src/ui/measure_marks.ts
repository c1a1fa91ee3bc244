import { shownNervePoints, sectionOf, toothRows, toVec3, type Surface, type Vec3 } from '../model';
import type { Marker, SliceLines } from '../scene';
import type { App } from './app';
import type { State } from './state';

// Marks of teeth and measures in the 3D view and on the slices.

const POINT_COLOR = '#f2b21b';
const CORRECTED_COLOR = '#d6409f';
const TOOTH_COLOR = '#3fb2c8';

/** Numbers of the teeth at their crowns, or the points on the canals. */
export function measureMarkers(s: State): (Marker & { label: string })[] {
  if (s.measure === 'teeth') return toothMarkers(s);
  return s.measure === 'nerve' ? nerveMarkers(s) : [];
}

function toothMarkers(s: State): (Marker & { label: string })[] {
  return toothRows(s.teeth?.teeth ?? [], s.toothCorrections).flatMap(({ found, fdi, tooth }) =>
    tooth && fdi !== 0
      ? [
          {
            id: `tooth ${found}`,
            position: toVec3(tooth.crown),
            label: String(fdi),
            color: fdi === found ? TOOTH_COLOR : CORRECTED_COLOR,
            hides: true,
          },
        ]
      : [],
  );
}

function nerveMarkers(s: State): (Marker & { label: string })[] {
  return shownNervePoints(s.nerve?.points ?? {}, s.nervePoints).map(({ name, position_mm, isCorrected }) => ({
    id: name,
    position: s.nerveDrag?.name === name ? s.nerveDrag.position_mm : position_mm,
    // Of points that were found, foramina only: others are numbered again after each correction.
    label: name.startsWith('found IAN') ? '' : name.replace(/^found /, ''),
    color: isCorrected ? CORRECTED_COLOR : POINT_COLOR,
    selected: name === s.nervePoint,
    // On the slices they are; in 3D a drag would bring them to the surface of the bone.
    draggable: false,
  }));
}

/** Selects a point of a canal, and moves the slices to it. */
export function selectNervePoint(app: App, name: string): void {
  const { s } = app.model;
  const point = shownNervePoints(s.nerve?.points ?? {}, s.nervePoints).find((one) => one.name === name);
  if (s.measure === 'nerve' && point) app.patch({ nervePoint: name, cursor_L: point.position_mm });
}

/** Outlines of the canals on a slice. */
export const nerveOutlines = (surfaces: readonly Surface[], at: { point: Vec3; normal: Vec3 }): SliceLines[] =>
  surfaces.map((surface) => ({ lines: sectionOf(surface, at.point, at.normal), color: POINT_COLOR }));
