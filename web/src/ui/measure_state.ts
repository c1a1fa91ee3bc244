import type { Schemas } from '../api';
import {
  defaultGuides,
  defaultSplint,
  noRequests,
  type GuideSettings,
  type NervePoints,
  type OcclusionRequests,
  type SplintSettings,
  type ToothCorrection,
  type Vec3,
} from '../model';

export const MEASURES = [
  { name: 'teeth', title: 'Teeth' },
  { name: 'arches', title: 'Scans & occlusion' },
  { name: 'splint', title: 'Splint' },
  { name: 'nerve', title: 'Nerve' },
  { name: 'guides', title: 'Cutting guides' },
  { name: 'airway', title: 'Airway' },
  { name: 'cephalogram', title: 'Cephalogram' },
] as const;

export type MeasureName = (typeof MEASURES)[number]['name'];

/** A picture that a job wrote. */
export type PictureName = 'tracing.png' | 'lateral.png' | 'frontal.png' | 'airway.svg';

/** State of the step of teeth and measures. */
export interface MeasureState {
  /** What the panel and the views show. */
  measure: MeasureName;
  teeth: Schemas['Teeth'] | null;
  toothCorrections: readonly ToothCorrection[];
  /** Why the last number was refused. */
  toothFault: string | null;
  /** Intraoral scans that were chosen and not registered yet. */
  archFiles: { upper: File | null; lower: File | null };
  arches: Schemas['Arches'] | null;
  /** Where the next occlusion comes from. */
  occlusionSource: 'search' | 'as_scanned' | 'bite';
  /** What the next occlusion of a search has to be. */
  occlusionRequests: OcclusionRequests;
  /** Bite scans that were chosen. */
  biteFiles: { bite: File | null; bite2: File | null };
  occlusion: Schemas['Occlusion'] | null;
  /** Show the lower arch in occlusion, with the gap to the upper one. */
  showOcclusion: boolean;
  splintSettings: SplintSettings;
  splints: Record<SplintSettings['splint'], Schemas['Splint'] | null>;
  nerve: Schemas['Nerve'] | null;
  nervePoints: NervePoints;
  /** The selected point; see shownNervePoints(). */
  nervePoint: string | null;
  /** The point that is dragged. */
  nerveDrag: { name: string; position_mm: Vec3 } | null;
  guideSettings: GuideSettings;
  guides: Schemas['Guides'] | null;
  airway: Schemas['Airway'] | null;
  cephalogram: Schemas['Cephalogram'] | null;
  norms: 'female' | 'male';
  /** The picture of the cephalogram that is shown. */
  radiograph: Exclude<PictureName, 'airway.svg'>;
  /** Addresses of the pictures in the memory of the page. */
  pictures: Partial<Record<PictureName, string>>;
}

export const initialMeasures = (): MeasureState => ({
  measure: 'teeth',
  teeth: null,
  toothCorrections: [],
  toothFault: null,
  archFiles: { upper: null, lower: null },
  arches: null,
  occlusionSource: 'search',
  occlusionRequests: noRequests(),
  biteFiles: { bite: null, bite2: null },
  occlusion: null,
  showOcclusion: true,
  splintSettings: defaultSplint(),
  splints: { final: null, intermediate: null },
  nerve: null,
  nervePoints: {},
  nervePoint: null,
  nerveDrag: null,
  guideSettings: defaultGuides(),
  guides: null,
  airway: null,
  cephalogram: null,
  norms: 'female',
  radiograph: 'tracing.png',
  pictures: {},
});
