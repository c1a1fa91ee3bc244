import { html } from 'lit-html';
import type { Material, Plan } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import type { State } from '../state';
import { hint, section, segmented, type Html } from '../widgets';
import { advancedSection } from './advanced_section';
import { boundarySection } from './boundary_section';
import { layersSection } from './layers_section';
import { MATERIALS, OWN_MATERIAL, ownConstants, type Preset } from './material_field';
import type { SetPlan } from './set_plan';

const INSIDE: readonly Preset[] = ['face-compressible', 'face-nazari-2010'];

const SIZES = [
  { value: 'coarse', text: 'Coarse', near: 3.5, far: 7 },
  { value: 'standard', text: 'Standard', near: 2.5, far: 5 },
  { value: 'fine', text: 'Fine', near: 1.8, far: 4 },
] as const;

export function tissuePanel(app: App, s: State): Html {
  const { plan } = app.model.doc;
  const set: SetPlan = (part, gesture = null) => app.edit({ plan: { ...plan, ...part } }, gesture);
  return html`
    <h2>Tissue &amp; solver</h2>
    ${hint(
      'The motion of the bone is prescribed. The shape of a uniform tissue then depends on its ' +
        'compressibility (ν), not on its stiffness.',
    )}
    ${materialSection(plan, set)} ${layersSection(app)} ${segmentSection(plan, set)} ${scanEdgeSection(plan, set)}
    ${boundarySection(app, s)} ${resolutionSection(plan, set)} ${advancedSection(plan, set)}
  `;
}

const materialChoice = (title: Html, source: string, isChosen: boolean, onPick: () => void): Html =>
  html`<button type="button" class="choice" aria-pressed=${String(isChosen)} @click=${onPick}>
    <strong>${title}</strong><small>${source}</small>
  </button>`;

function materialSection({ tissue = {} }: Plan, set: SetPlan): Html {
  const material = tissue.material ?? 'face-compressible';
  const own = typeof material === 'object' ? material : null;
  const setMaterial = (next: Material, gesture: string | null = null): void =>
    set({ tissue: { ...tissue, material: next } }, gesture);
  return section(
    'Material',
    INSIDE.map((name) => {
      const { title, constants, source } = MATERIALS[name];
      return materialChoice(html`${title}<span>${constants}</span>`, source, material === name, () =>
        setMaterial(name),
      );
    }),
    materialChoice('Custom constants', 'Neo-Hookean, as the presets. Document the source.', own !== null, () => {
      if (!own) setMaterial(OWN_MATERIAL);
    }),
    own ? ownConstants(own, 'tissue', setMaterial) : '',
  );
}

function segmentSection({ boundary = {} }: Plan, set: SetPlan): Html {
  return section(
    'Interface of the mobilized segment',
    segmented(
      'Tissue on the mobilized segment',
      [
        { value: 'contact', text: 'Sliding' },
        { value: 'attached', text: 'Bonded' },
      ] as const,
      boundary.moved_bone ?? 'contact',
      (v) => set({ boundary: { ...boundary, moved_bone: v } }),
    ),
    hint(
      'Sliding detects contact and prevents penetration of the bone. Bonded is faster; the tissue follows the bone.',
    ),
    numberField({
      label: 'Periosteal elevation',
      hint: 'tissue is released from stationary bone within this distance of the segment',
      value: boundary.release_mm ?? 8,
      unit: 'mm',
      min: 0,
      max: 100,
      step: 1,
      onInput: (v) => set({ boundary: { ...boundary, release_mm: v } }, 'release'),
    }),
  );
}

const scanEdgeSection = ({ boundary = {} }: Plan, set: SetPlan): Html =>
  section(
    'Edge of the scan',
    segmented(
      'Tissue at the edge of the scan',
      [
        { value: 'free', text: 'Free' },
        { value: 'fixed', text: 'Fixed' },
      ] as const,
      boundary.scan_edge ?? 'free',
      (v) => set({ boundary: { ...boundary, scan_edge: v } }),
    ),
  );

function resolutionSection({ tissue = {} }: Plan, set: SetPlan): Html {
  const near = tissue.element_size_mm ?? 2.5;
  const far = tissue.far_element_size_mm ?? 5;
  const options = SIZES.map((x) => ({
    value: x.value,
    text: x.text,
    title: `${x.near} mm near the bone, ${x.far} mm far from it`,
  }));
  return section(
    'Resolution',
    segmented('Element size', options, SIZES.find((x) => x.near === near && x.far === far)?.value ?? null, (v) => {
      const chosen = SIZES.find((x) => x.value === v)!;
      set({ tissue: { ...tissue, element_size_mm: chosen.near, far_element_size_mm: chosen.far } });
    }),
    hint(`Tetrahedra of ${near} mm near the bone, ${far} mm far from it. Fine takes several times as long.`),
  );
}
