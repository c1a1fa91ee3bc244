import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { fault } from '../src/api';
import {
  cutsNothing,
  editKeyframe,
  emptyPlan,
  keyframesOf,
  missingFor,
  renameSegment,
  retimeKeyframe,
  withCurve,
  withKeyframeAfter,
  withoutKeyframe,
  withoutPlane,
  withoutSegment,
  withBoundary,
  withPaintedBoundary,
  withPlane,
  withSegment,
  type Plan,
} from '../src/model';

const schema = JSON.parse(readFileSync(new URL('../../contract/plan.schema.json', import.meta.url), 'utf8'));
const isPlan = (plan: Plan) => expect(fault(JSON.parse(JSON.stringify(plan)), schema, schema)).toBeNull();

const plane = { point_mm: [122, 46, 66], towards_segment: [0, 0, -1] } as const;
const one = withSegment(emptyPlan(), 'midface', { planes: [plane] });

describe('edits of a plan', () => {
  it('make plans that the command line accepts', () => {
    isPlan(one);
    isPlan(withSegment(one, 'le-fort-1', { template: { kind: 'le-fort-1', above_palate_mm: 6 } }));
    isPlan(
      withPlane(
        withCurve(one, 0, {
          points_mm: [
            [0, 0, 0],
            [1, 0, 0],
            [0, 1, 0],
          ],
          along: [0, 1, 0],
          depth_mm: 20,
        }),
        0,
        plane,
      ),
    );
    isPlan(withKeyframeAfter(withKeyframeAfter(one, 0, 0), 0, 1));
    isPlan(editKeyframe(one, 0, 0, { translation_mm: [0, -12, -5], rotation_deg: [0, 0, 3], about_mm: [1, 2, 3] }));
    isPlan(retimeKeyframe(withKeyframeAfter(one, 0, 0), 0, 0, 0.3));
  });

  it('do not change the original plan', () => {
    const before = JSON.stringify(one);
    withPlane(one, 0, plane);
    withoutPlane(one, 0, 0);
    withKeyframeAfter(one, 0, 0);
    expect(JSON.stringify(one)).toBe(before);
  });

  it('give each segment a unique name', () => {
    const two = withSegment(withSegment(one, 'midface', {}), 'midface', {});
    expect(two.segments.map((s) => s.name)).toEqual(['midface', 'midface-2', 'midface-3']);
    expect(renameSegment(two, 1, 'midface')).toBeNull();
    expect(renameSegment(two, 1, 'a b')).toBeNull();
  });

  it('rename a segment from which others are cut', () => {
    const two = withSegment(one, 'wing', { planes: [plane] });
    const nested: Plan = { ...two, segments: [two.segments[0], { ...two.segments[1], cut_from: 'midface' }] };
    expect(renameSegment(nested, 0, 'maxilla')!.segments[1].cut_from).toBe('maxilla');
    expect('from' in withoutSegment(nested, 0).segments[0]).toBe(false);
  });

  it('keep keyframes in order, the last at the end', () => {
    const three = withKeyframeAfter(withKeyframeAfter(one, 0, 0), 0, 1);
    const times = (plan: Plan) => keyframesOf(plan.segments[0]).map((k) => k.path_fraction);
    expect(times(three)[2]).toBe(1);
    expect(times(retimeKeyframe(three, 0, 0, 5))[0]).toBeLessThan(times(three)[1]!);
    expect(times(retimeKeyframe(three, 0, 2, 0.1))[2]).toBe(1);
    expect(keyframesOf(withoutKeyframe(one, 0, 0).segments[0])).toHaveLength(1);
  });

  it('set and remove options of the boundary', () => {
    const own = withBoundary({ labels: 'boundary.seg.nrrd' }, { elevation_margin_mm: 5, interface: 'bonded' });
    expect(own).toEqual({ labels: 'boundary.seg.nrrd', elevation_margin_mm: 5, interface: 'bonded' });
    const byProcedure = withBoundary(own, { elevation_margin_mm: undefined });
    expect(Object.keys(byProcedure).sort()).toEqual(['interface', 'labels']);
  });

  it('set and remove the file of the painted boundary', () => {
    const named = withPaintedBoundary({ ...one, boundary: { elevation_margin_mm: 4 } }, 'boundary.seg.nrrd');
    isPlan(named);
    expect(named.boundary).toEqual({ elevation_margin_mm: 4, labels: 'boundary.seg.nrrd' });
    expect(withPaintedBoundary(named, 'boundary.seg.nrrd')).toBe(named);
    expect(withPaintedBoundary(named, null).boundary).toEqual({ elevation_margin_mm: 4 });
    expect(withPaintedBoundary(one, null)).toBe(one);
  });

  it('find an empty cut', () => {
    expect(cutsNothing(withoutPlane(one, 0, 0).segments[0].osteotomy)).toBe(true);
    expect(cutsNothing(one.segments[0].osteotomy)).toBe(false);
  });

  it('list the landmarks that a template needs', () => {
    expect(missingFor('le-fort-1', ['ANS'])).toEqual(['PNS']);
    expect(missingFor('le-fort-3', ['N', 'Or-R', 'Or-L', 'FZ-R', 'FZ-L', 'ANS', 'PNS'])).toEqual([]);
  });
});
