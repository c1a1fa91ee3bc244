import { html, nothing } from 'lit-html';
import type { Tissue } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { hint, notice, toggle, type Html } from '../widgets';
import { materialField } from './material_field';

const part = (title: string, ...content: unknown[]): Html =>
  html`<div class="part">
    <h3>${title}</h3>
    ${content}
  </div>`;

/** Tissues with a material of their own: skin, mucosa, muscle. */
export function layersSection(app: App): Html {
  const { plan } = app.model.doc;
  const { tissue = {} } = plan;
  const set = (part: Partial<Tissue>, gesture: string | null = null): void => {
    const next: Tissue = { ...tissue, ...part };
    for (const key of ['skin', 'mucosa', 'muscle', 'lips_and_nose_element_size_mm'] as const)
      if (next[key] === undefined) delete next[key];
    app.edit({ plan: { ...plan, tissue: next } }, gesture);
  };
  const { skin, mucosa, muscle } = tissue;
  const size = tissue.lips_and_nose_element_size_mm;
  const near = tissue.element_size_mm ?? 2.5;
  const named = [skin && 'skin', mucosa && 'mucosa', muscle && 'muscle', size !== undefined && 'lips and nose'].filter(
    Boolean,
  );
  return html`<details class="group" data-id="layers" ?open=${named.length > 0}>
    <summary>
      Skin, mucosa, muscle, lips${named.length ? html` <small>${named.join(', ')} set</small>` : nothing}
    </summary>
    <div>
      ${part(
        'Skin',
        toggle('Layers of its own', skin !== undefined, (on) => set({ skin: on ? {} : undefined })),
        skin
          ? html` ${numberField({
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
              'Dermis of ten heads: 0.8 mm (upper lid) to 2 mm (below the nose) (Chopra et al. 2015). One thickness serves for the whole face.',
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
            )}`
          : hint('Without, skin is of the same material as what is inside.'),
      )}
      ${part(
        'Mucosa',
        toggle('Of a material of its own', mucosa !== undefined, (on) =>
          set({ mucosa: on ? { thickness_mm: 2, material: tissue.material ?? 'face-compressible' } : undefined }),
        ),
        mucosa
          ? html` ${numberField({
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
            ${mucosa.thickness_mm < near
              ? notice(
                  'warning',
                  'Elements are larger',
                  `They are ${near} mm near the bone: of a thinner mucosa few would be taken.`,
                )
              : nothing}
            ${materialField('mucosa', mucosa.material, (material, gesture) =>
              set({ mucosa: { ...mucosa, material } }, gesture),
            )}
            ${hint('We know of no measured stiffness to recommend for mucosa.')}`
          : nothing,
      )}
      ${part(
        'Muscle',
        toggle('Of a material of its own', muscle !== undefined, (on) =>
          set({ muscle: on ? { material: tissue.material ?? 'face-compressible' } : undefined }),
        ),
        muscle
          ? html` ${materialField('muscle', muscle.material, (material, gesture) =>
              set({ muscle: { ...muscle, material } }, gesture),
            )}
            ${hint(
              'Muscle is where labels say so: paint it in step 2, Anatomy, or open labels that have it. We know of no measured stiffness to recommend.',
            )}`
          : nothing,
      )}
      ${part(
        'Lips and nose',
        toggle('Finer elements', size !== undefined, (on) =>
          set({ lips_and_nose_element_size_mm: on ? Math.min(near, 1.5) : undefined }),
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
            ${hint('At the landmarks of lips and nose; without any, at the foremost point of the face.')}`
          : nothing,
      )}
    </div>
  </details>`;
}
