import { html } from 'lit-html';
import type { Contact, Plan } from '../../model';
import { numberField } from '../number_field';
import { select, type Html } from '../widgets';
import type { SetPlan } from './set_plan';

const DETECTIONS: { value: NonNullable<Contact['detection']>; text: string }[] = [
  { value: 'smooth', text: 'Distance field, smooth' },
  { value: 'trilinear', text: 'Distance field, trilinear (as in the paper)' },
  { value: 'bvh', text: 'Exact distance to the triangles' },
];

/** Options that rarely need a change. */
export const advancedSection = (plan: Plan, set: SetPlan): Html =>
  html`<details class="group">
    <summary>Advanced</summary>
    <div>${meshFields(plan, set)} ${contactFields(plan, set)} ${solverField(plan, set)}</div>
  </details>`;

function meshFields({ tissue = {} }: Plan, set: SetPlan): Html {
  const near = tissue.element_size_mm ?? 2.5;
  const far = tissue.far_element_size_mm ?? 5;
  return html`${numberField({
    label: 'Element size',
    hint: 'near the mobilized segment',
    value: near,
    unit: 'mm',
    min: 0.5,
    max: 20,
    step: 0.1,
    onInput: (v) => set({ tissue: { ...tissue, element_size_mm: v, far_element_size_mm: Math.max(v, far) } }, 'near'),
  })}
  ${numberField({
    label: 'Element size, far',
    value: far,
    unit: 'mm',
    min: near,
    max: 20,
    step: 0.1,
    onInput: (v) => set({ tissue: { ...tissue, far_element_size_mm: v } }, 'far'),
  })}
  ${numberField({
    label: 'Mesh margin',
    hint: 'around the segment',
    value: tissue.margin_mm ?? 30,
    unit: 'mm',
    min: 5,
    max: 200,
    step: 1,
    onInput: (v) => set({ tissue: { ...tissue, margin_mm: v } }, 'margin'),
  })}`;
}

const contactFields = ({ contact = {}, field = {} }: Plan, set: SetPlan): Html =>
  html`${numberField({
    label: 'Contact stiffness',
    hint: 'times E over element size',
    value: contact.stiffness_factor ?? 10,
    unit: '×',
    min: 0.01,
    max: 1e6,
    step: 1,
    onInput: (v) => set({ contact: { ...contact, stiffness_factor: v } }, 'stiffness'),
  })}
  ${select('Distance to bone', DETECTIONS, contact.detection ?? 'smooth', (v) => {
    const detection = DETECTIONS.find((x) => x.value === v)?.value;
    set({ contact: { ...contact, detection } });
  })}
  ${select(
    'Distance field',
    ['64', '128', '256', '512'].map((n) => ({ value: n, text: `${n} cells per side` })),
    String(field.resolution ?? 256),
    (v) => set({ field: { ...field, resolution: Number(v) } }),
  )}`;

const solverField = ({ solver = {} }: Plan, set: SetPlan): Html =>
  numberField({
    label: 'Maximum iterations',
    value: solver.max_iterations ?? 120,
    unit: '',
    digits: 0,
    min: 1,
    max: 1000,
    step: 10,
    onInput: (v) => set({ solver: { ...solver, max_iterations: Math.round(v) } }, 'iterations'),
  });
