import { html } from 'lit-html';
import type { Plan } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { hint, section, segmented, select, type Html } from '../widgets';
import type { State } from '../state';
import { boundarySection } from './boundary_section';
import { layersSection } from './layers_section';
import { MATERIALS, OWN_MATERIAL, ownConstants, type Preset } from './material_field';

const INSIDE: readonly Preset[] = ['face-compressible', 'face-nazari-2010'];

const SIZES = [
  { value: 'coarse', text: 'Coarse', near: 3.5, far: 7 },
  { value: 'standard', text: 'Standard', near: 2.5, far: 5 },
  { value: 'fine', text: 'Fine', near: 1.8, far: 4 },
] as const;

export function tissuePanel(app: App, s: State): Html {
  const { plan } = app.model.doc;
  const set = (part: Partial<Plan>, gesture: string | null = null) => app.edit({ plan: { ...plan, ...part } }, gesture);
  const { tissue = {}, boundary = {}, contact = {}, solver = {}, field = {} } = plan;
  const material = tissue.material ?? 'face-compressible';
  const own = typeof material === 'object' ? material : null;
  const near = tissue.element_size_mm ?? 2.5;
  const size = SIZES.find((x) => x.near === near && x.far === (tissue.far_element_size_mm ?? 5));
  return html`
    <h2>Tissue &amp; solver</h2>
    ${hint(
      'With the bone’s motion given, a uniform tissue’s shape depends on how compressible it is (ν) and not on its stiffness.',
    )}
    ${section(
      'Material',
      INSIDE.map(
        (name) =>
          html`<button
            type="button"
            class="choice"
            aria-pressed=${String(material === name)}
            @click=${() => set({ tissue: { ...tissue, material: name } })}
          >
            <strong>${MATERIALS[name].title}<span>${MATERIALS[name].constants}</span></strong
            ><small>${MATERIALS[name].source}</small>
          </button>`,
      ),
      html`<button
        type="button"
        class="choice"
        aria-pressed=${String(own !== null)}
        @click=${() => own || set({ tissue: { ...tissue, material: OWN_MATERIAL } })}
      >
        <strong>Constants of your own</strong><small>The same law, neo-Hookean. State where they come from.</small>
      </button>`,
      own
        ? ownConstants(own, 'tissue', (next, gesture) => set({ tissue: { ...tissue, material: next } }, gesture))
        : '',
    )}
    ${layersSection(app)}
    ${section(
      'Moved bone and its tissue',
      segmented(
        'Tissue on the moved bone',
        [
          { value: 'contact', text: 'Slides on it' },
          { value: 'attached', text: 'Sticks to it' },
        ] as const,
        boundary.moved_bone ?? 'contact',
        (v) => set({ boundary: { ...boundary, moved_bone: v } }),
      ),
      hint('Sliding finds contact and keeps tissue out of bone. Sticking is faster and pulls everything along.'),
      numberField({
        label: 'Elevated nearby',
        hint: 'tissue on still bone let go near the cut',
        value: boundary.release_mm ?? 8,
        unit: 'mm',
        min: 0,
        max: 100,
        step: 1,
        onInput: (v) => set({ boundary: { ...boundary, release_mm: v } }, 'release'),
      }),
    )}
    ${section(
      'Where the scan ends',
      segmented(
        'Tissue at the edge of the scan',
        [
          { value: 'free', text: 'Free' },
          { value: 'fixed', text: 'Fixed' },
        ] as const,
        boundary.scan_edge ?? 'free',
        (v) => set({ boundary: { ...boundary, scan_edge: v } }),
      ),
    )}
    ${boundarySection(app, s)}
    ${section(
      'Resolution',
      segmented(
        'Element size',
        SIZES.map((x) => ({
          value: x.value,
          text: x.text,
          title: `${x.near} mm near the bone, ${x.far} mm at the rim`,
        })),
        size?.value ?? null,
        (v) => {
          const chosen = SIZES.find((x) => x.value === v)!;
          set({ tissue: { ...tissue, element_size_mm: chosen.near, far_element_size_mm: chosen.far } });
        },
      ),
      hint(
        `Tetrahedra of ${near} mm near the bone, ${tissue.far_element_size_mm ?? 5} mm at the rim. Fine takes several times as long.`,
      ),
    )}
    <details class="group">
      <summary>Advanced</summary>
      <div>
        ${numberField({
          label: 'Element size',
          hint: 'near the moved bone',
          value: near,
          unit: 'mm',
          min: 0.5,
          max: 20,
          step: 0.1,
          onInput: (v) =>
            set(
              {
                tissue: {
                  ...tissue,
                  element_size_mm: v,
                  far_element_size_mm: Math.max(v, tissue.far_element_size_mm ?? 5),
                },
              },
              'near',
            ),
        })}
        ${numberField({
          label: 'Element size, rim',
          value: tissue.far_element_size_mm ?? 5,
          unit: 'mm',
          min: near,
          max: 20,
          step: 0.1,
          onInput: (v) => set({ tissue: { ...tissue, far_element_size_mm: v } }, 'far'),
        })}
        ${numberField({
          label: 'Meshed around the segment',
          value: tissue.margin_mm ?? 30,
          unit: 'mm',
          min: 5,
          max: 200,
          step: 1,
          onInput: (v) => set({ tissue: { ...tissue, margin_mm: v } }, 'margin'),
        })}
        ${numberField({
          label: 'Contact stiffness',
          hint: 'times E over element size',
          value: contact.stiffness_factor ?? 10,
          unit: '×',
          min: 0.01,
          max: 1e6,
          step: 1,
          onInput: (v) => set({ contact: { ...contact, stiffness_factor: v } }, 'stiffness'),
        })}
        ${select(
          'Distance to bone',
          [
            { value: 'smooth', text: 'Distance field, read smoothly' },
            { value: 'trilinear', text: 'Distance field, as in the paper' },
            { value: 'bvh', text: 'The triangles themselves' },
          ],
          contact.detection ?? 'smooth',
          (v) => set({ contact: { ...contact, detection: v as 'smooth' } }),
        )}
        ${select(
          'Distance field',
          ['64', '128', '256', '512'].map((n) => ({ value: n, text: `${n} cells a side` })),
          String(field.resolution ?? 256),
          (v) => set({ field: { ...field, resolution: Number(v) } }),
        )}
        ${numberField({
          label: 'Iterations at most',
          value: solver.max_iterations ?? 120,
          unit: '',
          digits: 0,
          min: 1,
          max: 1000,
          step: 10,
          onInput: (v) => set({ solver: { ...solver, max_iterations: Math.round(v) } }, 'iterations'),
        })}
      </div>
    </details>
  `;
}
