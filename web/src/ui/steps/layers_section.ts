import { html, nothing } from 'lit-html';
import type { Tissue } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { hint, notice, toggle, type Html } from '../widgets';
import { materialField } from './material_field';

const DEFAULT_MATERIAL = 'face-compressible';

const part = (title: string, ...content: unknown[]): Html =>
  html`<div class="part">
    <h3>${title}</h3>
    ${content}
  </div>`;

type SetTissue = (part: Partial<Tissue>, gesture?: string | null) => void;

/** Tissues with a material of their own: skin, mucosa, muscle. */
export function layersSection(app: App): Html {
  const { plan } = app.model.doc;
  const { tissue = {} } = plan;
  const set: SetTissue = (part, gesture = null) => {
    const next: Tissue = { ...tissue, ...part };
    for (const key of ['skin', 'mucosa', 'muscle', 'lips_and_nose_element_size_mm'] as const)
      if (next[key] === undefined) delete next[key];
    app.edit({ plan: { ...plan, tissue: next } }, gesture);
  };
  const hasFineLips = tissue.lips_and_nose_element_size_mm !== undefined;
  const named = [
    tissue.skin && 'skin',
    tissue.mucosa && 'mucosa',
    tissue.muscle && 'muscle',
    hasFineLips && 'lips and nose',
  ].filter(Boolean);
  return html`<details class="group" data-id="layers" ?open=${named.length > 0}>
    <summary>
      Skin, mucosa, muscle, lips${named.length ? html` <small>${named.join(', ')} set</small>` : nothing}
    </summary>
    <div>${skinPart(tissue, set)} ${mucosaPart(tissue, set)} ${musclePart(tissue, set)} ${lipsPart(tissue, set)}</div>
  </details>`;
}

function skinPart({ skin }: Tissue, set: SetTissue): Html {
  return part(
    'Skin',
    toggle('Separate layers', skin !== undefined, (on) => set({ skin: on ? {} : undefined })),
    skin ? skinFields(skin, set) : hint('If off, skin has the material of the deep tissue.'),
  );
}

const skinFields = (skin: NonNullable<Tissue['skin']>, set: SetTissue): Html =>
  html` ${numberField({
    label: 'Thickness',
    value: skin.thickness_mm ?? 1.5,
    unit: 'mm',
    min: 0.2,
    max: 5,
    step: 0.1,
    id: 'skin-thickness',
    onInput: (v) => set({ skin: { ...skin, thickness_mm: v } }, 'skin-thickness'),
  })}
  ${hint(
    'Dermis of ten heads: 0.8 mm (upper lid) to 2 mm (below the nose) (Chopra et al. 2015). The ' +
      'whole face has one thickness.',
  )}
  ${numberField({
    label: 'Layers',
    value: skin.layers ?? 2,
    unit: '',
    digits: 0,
    min: 1,
    max: 8,
    step: 1,
    id: 'skin-layers',
    onInput: (v) => set({ skin: { ...skin, layers: Math.round(v) } }, 'skin-layers'),
  })}
  ${materialField('skin', skin.material ?? 'skin-barbarino-2011', (material, gesture) =>
    set({ skin: { ...skin, material } }, gesture),
  )}`;

function mucosaPart({ mucosa, material, element_size_mm = 2.5 }: Tissue, set: SetTissue): Html {
  return part(
    'Mucosa',
    toggle('Separate material', mucosa !== undefined, (on) =>
      set({ mucosa: on ? { thickness_mm: 2, material: material ?? DEFAULT_MATERIAL } : undefined }),
    ),
    mucosa ? mucosaFields(mucosa, element_size_mm, set) : nothing,
  );
}

const mucosaFields = (mucosa: NonNullable<Tissue['mucosa']>, near_mm: number, set: SetTissue): Html =>
  html` ${numberField({
    label: 'Thickness',
    hint: 'from the air of airway and sinuses',
    value: mucosa.thickness_mm,
    unit: 'mm',
    min: 0.2,
    max: 10,
    step: 0.1,
    id: 'mucosa-thickness',
    onInput: (v) => set({ mucosa: { ...mucosa, thickness_mm: v } }, 'mucosa-thickness'),
  })}
  ${mucosa.thickness_mm < near_mm
    ? notice(
        'warning',
        'Elements are larger than the mucosa',
        `They are ${near_mm} mm near the bone, so few of them become mucosa.`,
      )
    : nothing}
  ${materialField('mucosa', mucosa.material, (material, gesture) => set({ mucosa: { ...mucosa, material } }, gesture))}
  ${hint('We know of no measured stiffness to recommend for mucosa.')}`;

function musclePart({ muscle, material }: Tissue, set: SetTissue): Html {
  return part(
    'Muscle',
    toggle('Separate material', muscle !== undefined, (on) =>
      set({ muscle: on ? { material: material ?? DEFAULT_MATERIAL } : undefined }),
    ),
    muscle
      ? html` ${materialField('muscle', muscle.material, (next, gesture) =>
          set({ muscle: { ...muscle, material: next } }, gesture),
        )}
        ${hint(
          'Muscle is taken from the labels: paint it in step 2, Anatomy, or open labels that contain ' +
            'it. We know of no measured stiffness to recommend.',
        )}`
      : nothing,
  );
}

function lipsPart({ lips_and_nose_element_size_mm: size, element_size_mm = 2.5 }: Tissue, set: SetTissue): Html {
  return part(
    'Lips and nose',
    toggle('Finer elements', size !== undefined, (on) =>
      set({ lips_and_nose_element_size_mm: on ? Math.min(element_size_mm, 1.5) : undefined }),
    ),
    size !== undefined
      ? html`${numberField({
          label: 'Element size',
          value: size,
          unit: 'mm',
          min: 0.5,
          max: 20,
          step: 0.1,
          id: 'lips-size',
          onInput: (v) => set({ lips_and_nose_element_size_mm: v }, 'lips-size'),
        })}
        ${hint('Around the landmarks of lips and nose; without them, around the most anterior point of the face.')}`
      : nothing,
  );
}
