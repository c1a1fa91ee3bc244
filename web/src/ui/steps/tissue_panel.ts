import { html } from 'lit-html';
import type { Material, Plan } from '../../model';
import type { App } from '../app';
import type { State } from '../state';
import { hint, section, segmented, type Html } from '../widgets';
import { advancedSection } from './advanced_section';
import { boundarySection } from './boundary_section';
import { interfaceMapSection } from './interface_map_section';
import { interfaceSection, outerSection } from './interface_section';
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
    ${materialSection(plan, set)} ${layersSection(app)} ${interfaceSection(plan, set)} ${outerSection(plan, set)}
    ${interfaceMapSection(app, s)} ${boundarySection(app, s)} ${resolutionSection(plan, set)}
    ${advancedSection(plan, set)}
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
