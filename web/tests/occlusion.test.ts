import { describe, expect, it } from 'vitest';
import type { Schemas } from '../src/api';
import {
  defaultSplint,
  faultOfSplint,
  hasLowerTeeth,
  keepsCanals,
  moveToOcclusion,
  noRequests,
  poseOf,
  relationRows,
  requestParameters,
  requestRows,
  splintParameters,
  templateKey,
  templateRequest,
  transformPoint,
  upperJawOf,
  withCanals,
  type Move,
  type Osteotomy,
  type Segment,
} from '../src/model';

const occlusion = (part: Partial<Schemas['Occlusion']>): Schemas['Occlusion'] => ({
  notice: '',
  movement: { anterior_mm: 0, left_mm: 0, superior_mm: 3, rotation_deg: 0 },
  contacts: { left_mm2: 20, right_mm2: 20, patches: 10, max_penetration_mm: 0.1 },
  overjet_mm: 2.6,
  overbite_mm: null,
  ...part,
});

describe('requests of an occlusion', () => {
  it('are sent if their field is not empty, also zero', () => {
    expect(requestParameters(noRequests())).toEqual({});
    expect(requestParameters({ midline_mm: 0, overjet_mm: null, overbite_mm: -1.5 })).toEqual({
      midline_mm: 0,
      overbite_mm: -1.5,
    });
  });

  it('are shown with what was reached', () => {
    expect(requestRows(occlusion({}))).toEqual([]);
    const requests = {
      overjet_mm: { requested: 2, reached: 2.6, is_met: false },
      midline_mm: { requested: 0, reached: null, is_met: false },
    };
    expect(requestRows(occlusion({ requests }))).toEqual([
      { name: 'Midline', requested: 0, reached: null, isMet: false },
      { name: 'Overjet', requested: 2, reached: 2.6, isMet: false },
    ]);
  });
});

describe('relations of an occlusion', () => {
  const none = { mesial_mm: null, class: null };

  it('need the numbers of the teeth', () => {
    expect(relationRows(occlusion({}))).toEqual([]);
  });

  it('are the side of the midline and the classes of Angle', () => {
    const relations = {
      midline_mm: -0.44,
      right_canine: { mesial_mm: 0.6, class: 'I' as const },
      left_canine: { mesial_mm: -2.1, class: 'II' as const },
      right_molar: none,
      left_molar: { mesial_mm: -0.04, class: 'I' as const },
    };
    expect(relationRows(occlusion({ relations }))).toEqual([
      ['Lower midline', '0.4 mm to the right'],
      ['Canine, right', 'class I, +0.6 mm'],
      ['Canine, left', 'class II, −2.1 mm'],
      ['Molar, right', 'unknown'],
      ['Molar, left', 'class I, 0.0 mm'],
    ]);
    const inLine = { ...relations, midline_mm: 0.01 };
    expect(relationRows(occlusion({ relations: inLine }))[0][1]).toBe('in line');
    expect(relationRows(occlusion({ relations: { ...relations, midline_mm: null } }))[0][1]).toBe('unknown');
  });
});

describe('a move to the occlusion', () => {
  const segment = (name: string, template?: 'le-fort-1' | 'sagittal-split' | 'genioplasty'): Segment => ({
    name,
    osteotomy: template ? { template } : {},
    path: {},
  });
  const now: Move = { translation_mm: [9, 9, 9], rotation_deg: [0, 0, 9], about_mm: [100, 40, 20] };
  const lower: Move = { translation_mm: [0.5, -1, 3], rotation_deg: [2, -1, 4], about_mm: [90, 10, 15] };
  const close = (a: readonly number[], b: readonly number[]) => a.forEach((v, n) => expect(v).toBeCloseTo(b[n], 9));

  it('has the pose of the lower arch, about the point of the segment', () => {
    const move = moveToOcclusion(now, poseOf(lower), null);
    expect(move.about_mm).toEqual(now.about_mm);
    close(poseOf(move), poseOf(lower));
  });

  it('follows the upper jaw', () => {
    const upper: Move = { translation_mm: [0, -4, 2], rotation_deg: [-3, 0, 1], about_mm: [80, 0, 60] };
    const move = moveToOcclusion(now, poseOf(lower), upper);
    for (const p of [
      [100, 0, 0],
      [80, 30, 20],
      [95, -10, 5],
    ] as const)
      close(transformPoint(poseOf(move), p), transformPoint(poseOf(upper), transformPoint(poseOf(lower), p)));
  });

  it('is that of a segment with lower teeth', () => {
    const segments = [segment('chin', 'genioplasty'), segment('distal', 'sagittal-split'), segment('a', 'le-fort-1')];
    expect(segments.map(hasLowerTeeth)).toEqual([false, true, false]);
    expect(upperJawOf(segments)).toBe(2);
    expect(upperJawOf(segments.slice(0, 2))).toBe(-1);
    expect([segment('Maxilla'), segment('mandible')].map(hasLowerTeeth)).toEqual([false, true]);
  });
});

describe('a splint', () => {
  it('has a rim within the wall, edges within the rim, and 16 letters or fewer', () => {
    const settings = defaultSplint();
    expect(faultOfSplint(settings)).toBeNull();
    expect(faultOfSplint({ ...settings, wall_mm: 1.5 })).toContain('rim');
    expect(faultOfSplint({ ...settings, edge_mm: 1.1 })).toContain('edges');
    expect(faultOfSplint({ ...settings, text: 'sixteen letters!' })).toBeNull();
    expect(faultOfSplint({ ...settings, text: 'seventeen letters' })).toContain('17 letters');
  });

  it('has no text if that is blank', () => {
    expect(splintParameters({ ...defaultSplint(), text: '  ' })).not.toHaveProperty('text');
    expect(splintParameters({ ...defaultSplint(), text: ' A 7 ' })).toMatchObject({
      text: 'A 7',
      rim_mm: 2,
      edge_mm: 0.8,
    });
  });
});

describe('a sagittal split that keeps the canals', () => {
  const split: Osteotomy = { template: 'sagittal-split', kerf_mm: 0.8 };
  const nerve = (state: Schemas['Stage']['state'], etag: string): Schemas['Stage'] => ({ state, why: '', etag });

  it('names the canals of the case in the plan', () => {
    const kept = withCanals(split, 3);
    expect(kept).toEqual({
      template: { kind: 'sagittal-split', nerve: 'nerve/nerve.json', nerve_clearance_mm: 3 },
      kerf_mm: 0.8,
    });
    expect(keepsCanals(kept)).toBe(true);
    expect(keepsCanals(split)).toBe(false);
    expect(withCanals(kept, null)).toEqual(split);
    const deep: Osteotomy = { template: { kind: 'sagittal-split', split_depth_mm: 6 } };
    expect(withCanals(withCanals(deep, 2), null)).toEqual(deep);
    expect(withCanals({ planes: [] }, 2)).toEqual({ planes: [] });
  });

  it('is placed with its kerf, and without the file', () => {
    expect(templateRequest(withCanals(split, 3), [])).toEqual({
      template: { kind: 'sagittal-split', nerve_clearance_mm: 3 },
      landmarks: {},
      keep_canals: true,
      kerf_mm: 0.8,
    });
    expect(templateRequest(split, [])).toEqual({ template: 'sagittal-split', landmarks: {} });
    expect(templateRequest({ planes: [] }, [])).toBeNull();
  });

  it('is placed again when the canals are traced again', () => {
    const keys = [nerve('fresh', 'a'), nerve('stale', 'a'), nerve('fresh', 'b')].map((stage) => [
      templateKey(withCanals(split, 2), [], stage),
      templateKey(split, [], stage),
    ]);
    expect(new Set(keys.map(([kept]) => kept)).size).toBe(3);
    expect(new Set(keys.map(([, plain]) => plain)).size).toBe(1);
  });
});
