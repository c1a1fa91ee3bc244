import type { Schemas } from '../api';
import { toRecord, type Landmark } from './landmarks';
import { templateKind, type Osteotomy, type Template } from './plan';

/** The canals of a case, as a plan names them. */
const NERVE_FILE = 'nerve/nerve.json';

/** Default distance of a sagittal split from the canals. */
export const CANAL_CLEARANCE_MM = 2;

const settingsOf = (template: Template) => (typeof template === 'string' ? { kind: template } : template);

/** Whether a template is placed so that the canals of the nerves stay in the distal segment. */
export const keepsCanals = ({ template }: Osteotomy): boolean =>
  typeof template === 'object' && template.nerve !== undefined;

/** Keeps the canals at a distance, or with null does not consider them. */
export function withCanals(osteotomy: Osteotomy, clearance_mm: number | null): Osteotomy {
  if (osteotomy.template === undefined) return osteotomy;
  const rest = { ...settingsOf(osteotomy.template) };
  delete rest.nerve;
  delete rest.nerve_clearance_mm;
  if (clearance_mm !== null)
    return { ...osteotomy, template: { ...rest, nerve: NERVE_FILE, nerve_clearance_mm: clearance_mm } };
  return { ...osteotomy, template: Object.keys(rest).length > 1 ? rest : rest.kind };
}

/** The distance at which the canals are kept. */
export const canalClearance = ({ template }: Osteotomy): number =>
  typeof template === 'object' ? (template.nerve_clearance_mm ?? CANAL_CLEARANCE_MM) : CANAL_CLEARANCE_MM;

/** The request that places a template; null if the osteotomy has none. */
export function templateRequest(
  osteotomy: Osteotomy,
  landmarks: readonly Landmark[],
): Schemas['OsteotomyRequest'] | null {
  const { template, kerf_mm = 0 } = osteotomy;
  if (template === undefined || templateKind(osteotomy) === null) return null;
  const points = toRecord(landmarks);
  if (typeof template === 'string' || template.nerve === undefined) return { template, landmarks: points };
  const settings = { ...template };
  delete settings.nerve;
  return { template: settings, landmarks: points, keep_canals: true, kerf_mm };
}

/** Identifies a placed template: its request, and the canals if it keeps them. */
export const templateKey = (osteotomy: Osteotomy, landmarks: readonly Landmark[], nerve: Schemas['Stage']): string =>
  JSON.stringify([
    templateRequest(osteotomy, landmarks),
    keepsCanals(osteotomy) ? [nerve.state === 'fresh', nerve.etag] : null,
  ]);
