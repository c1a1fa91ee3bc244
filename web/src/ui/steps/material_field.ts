import { html, nothing } from 'lit-html';
import type { Material } from '../../model';
import { numberField } from '../number_field';
import { hint, select, type Html } from '../widgets';

/** Presets and their sources, as in docs/materials.md. */
export const MATERIALS = {
  'face-compressible': {
    title: 'Face, compressible',
    constants: 'E 15 kPa, ν 0.45',
    source:
      'E: Nazari et al. 2010, as in ArtiSynth’s face demo. lefort lowers ν to reduce locking of ' +
      'linear elements. Default.',
  },
  'face-nazari-2010': {
    title: 'Face, Nazari 2010',
    constants: 'E 15 kPa, ν 0.49',
    source: 'E and ν of the whole-face model of Nazari et al. 2010, as in ArtiSynth’s face demo.',
  },
  'skin-barbarino-2011': {
    title: 'Skin, Barbarino 2011',
    constants: 'E 54.5 kPa, ν 0.45',
    source: 'Initial stiffness of the skin of Barbarino et al. 2011 (from memory); ν as for the deep tissue.',
  },
} as const;

export type Preset = keyof typeof MATERIALS;

export const OWN_MATERIAL = { law: 'neo-hookean', young_kpa: 15, poisson: 0.45 } as const;

/** Fields of custom constants. `gesture`: typing in one field is one undo step. */
export const ownConstants = (
  own: Exclude<Material, string>,
  gesture: string,
  set: (material: Material, gesture: string) => void,
): Html =>
  html`<div class="numbers">
    ${numberField({
      label: 'Young’s modulus',
      value: own.young_kpa,
      unit: 'kPa',
      min: 0.01,
      max: 1e6,
      step: 1,
      id: `${gesture}-young`,
      onInput: (v) => set({ ...own, young_kpa: v }, `${gesture}-young`),
    })}
    ${numberField({
      label: 'Poisson’s ratio',
      value: own.poisson,
      unit: '',
      digits: 3,
      min: 0,
      max: 0.499,
      step: 0.01,
      id: `${gesture}-poisson`,
      onInput: (v) => set({ ...own, poisson: v }, `${gesture}-poisson`),
    })}
  </div>`;

const OWN = 'own';

/** A material with its source. */
export function materialField(
  name: string,
  material: Material,
  set: (material: Material, gesture: string | null) => void,
): Html {
  const own = typeof material === 'object' ? material : null;
  const known = own ? null : MATERIALS[material as Preset];
  return html` ${select(
    'Material',
    [
      ...Object.entries(MATERIALS).map(([value, m]) => ({ value, text: `${m.title}: ${m.constants}` })),
      { value: OWN, text: 'Custom constants' },
    ],
    own ? OWN : (material as string),
    (v) => set(v === OWN ? OWN_MATERIAL : v, null),
  )}
  ${own ? ownConstants(own, name, set) : nothing}
  ${hint(own ? 'Neo-Hookean, as the presets. Document the source.' : (known?.source ?? ''))}`;
}
