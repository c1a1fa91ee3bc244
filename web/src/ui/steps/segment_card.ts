import { html, nothing } from 'lit-html';
import {
  CANAL_CLEARANCE_MM,
  canalClearance,
  cssOf,
  cutsNothing,
  editOsteotomy,
  editPlane,
  editSegment,
  fixed,
  flipped,
  keepsCanals,
  mapVec3,
  ml,
  renameSegment,
  segmentColor,
  templateKey,
  templateKind,
  TEMPLATES,
  toOsteotomy,
  withCanals,
  withoutCurve,
  withoutPlane,
  withoutSegment,
  type Curve,
  type Osteotomy,
  type Plane,
  type Segment,
} from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { lastJob, stageOf, type State } from '../state';
import { button, hint, iconButton, notice, select, toggle, type Html } from '../widgets';

/** Default of the Le Fort I template. */
const ABOVE_PALATE_MM = 5;

/** Volumes of the segments, as the last cut reported them. */
function volumesOf(s: State): Map<string, number> {
  const result = lastJob(s, 'cut')?.result as { bones?: { name?: string; volume_ml?: number }[] } | null | undefined;
  return new Map(
    (result?.bones ?? []).filter((x) => x.name && x.volume_ml !== undefined).map((x) => [x.name!, x.volume_ml!]),
  );
}

/** The cut of one segment: its name, its planes and curves, its options. */
export function segmentCard(app: App, s: State, segment: Segment, index: number): Html {
  const { plan } = app.model.doc;
  const isSelected = s.segment === index;
  const volume = volumesOf(s).get(segment.name);
  return html` <div
    class="card ${isSelected ? 'selected' : ''}"
    @pointerdown=${() => isSelected || app.patch({ segment: index, plane: null })}
  >
    <div class="card-head">
      <span class="swatch" .style=${`background:${cssOf(segmentColor(index))}`}></span>
      <input
        class="name"
        aria-label="Name of the segment"
        .value=${segment.name}
        spellcheck="false"
        @change=${(e: Event) => rename(app, index, e.target as HTMLInputElement)}
      />
      ${volume === undefined ? nothing : html`<span class="chip">${ml(volume)}</span>`}
      ${iconButton('trash', `Remove ${segment.name}`, () => app.edit({ plan: withoutSegment(plan, index) }))}
    </div>
    ${isSelected ? cardBody(app, s, segment, index) : nothing}
  </div>`;
}

function rename(app: App, index: number, input: HTMLInputElement): void {
  const { plan } = app.model.doc;
  const next = renameSegment(plan, index, input.value.trim());
  if (next) app.edit({ plan: next });
  else {
    app.toast('Use letters, digits, - and _ for a name. Names must be unique.', 'error');
    input.value = plan.segments[index].name;
  }
}

function cardBody(app: App, s: State, segment: Segment, index: number): Html {
  const o = segment.osteotomy;
  return html`<div class="card-body">
    ${templatePart(app, s, o, index)}
    <div class="list">
      ${(o.planes ?? []).map((plane, n) => planeRow(app, s, plane, index, n))}
      ${(o.curves ?? []).map((curve, n) => curveRow(app, curve, index, n))}
      ${cutsNothing(o) ? notice('warning', 'This cut is empty', 'Add a plane or a curve.') : nothing}
    </div>
    <details>
      <summary>More</summary>
      <div>${moreFields(app, segment, index)}</div>
    </details>
  </div>`;
}

/** Changes the osteotomy of a segment. */
function edit(app: App, index: number, change: (o: Osteotomy) => Osteotomy, gesture: string | null = null): void {
  app.edit({ plan: editOsteotomy(app.model.doc.plan, index, change) }, gesture);
}

function templatePart(app: App, s: State, o: Osteotomy, index: number): Html {
  const kind = templateKind(o);
  if (!kind) return nothing;
  const placed = placedTemplate(app, s, o);
  const { title } = TEMPLATES.find((t) => t.kind === kind)!;
  return html`<div class="row">
      <span class="grow"><strong>${title}</strong> from landmarks</span> ${button(
        'Edit planes',
        () => replaceTemplate(app, index),
        {
          kind: 'quiet',
          disabled: placed === undefined || typeof placed === 'string',
          title: 'Replaces the template by its planes, which can be moved one by one',
        },
      )}
    </div>
    ${typeof placed === 'string' ? notice('error', 'The template cannot be placed', placed) : nothing}
    ${kind === 'le-fort-1' ? palateField(app, o, index) : nothing}
    ${kind === 'sagittal-split' ? canalFields(app, s, o, index) : nothing}`;
}

/** The planes of a template, or why it cannot be placed; undefined before the server's answer. */
const placedTemplate = (app: App, s: State, o: Osteotomy) =>
  s.templatePlanes.get(templateKey(o, app.model.doc.landmarks, stageOf(s, 'nerve')));

/** Whether a sagittal split keeps the canals of the nerves in the distal segment. */
function canalFields(app: App, s: State, o: Osteotomy, index: number): Html {
  const keeps = keepsCanals(o);
  const isTraced = stageOf(s, 'nerve').state === 'fresh';
  return html`${toggle(
    'Keep the canals free',
    keeps,
    (on) => edit(app, index, (old) => withCanals(old, on ? CANAL_CLEARANCE_MM : null)),
    !keeps && !isTraced,
  )}
  ${isTraced ? nothing : hint('Trace the canals of the nerves first, in step 9.')}
  ${keeps
    ? numberField({
        label: 'Distance from the canals',
        hint: 'beside the saw width',
        value: canalClearance(o),
        unit: 'mm',
        step: 0.5,
        min: 0,
        max: 5,
        id: `canals-${index}`,
        onInput: (v) => edit(app, index, (old) => withCanals(old, v), `canals-${index}`),
      })
    : nothing}`;
}

function replaceTemplate(app: App, index: number): void {
  const { s, doc } = app.model;
  const { osteotomy } = doc.plan.segments[index];
  const placed = placedTemplate(app, s, osteotomy);
  if (placed === undefined || typeof placed === 'string') return;
  const rest = { ...osteotomy };
  delete rest.template;
  edit(app, index, () => ({ ...rest, ...toOsteotomy(placed) }));
}

function palateField(app: App, { template }: Osteotomy, index: number): Html {
  const settings = typeof template === 'object' ? template : { kind: 'le-fort-1' as const };
  return numberField({
    label: 'Above the palate',
    value: settings.above_palate_mm ?? ABOVE_PALATE_MM,
    unit: 'mm',
    step: 0.5,
    min: 0,
    max: 30,
    onInput: (v) =>
      edit(app, index, (o) => ({ ...o, template: { ...settings, above_palate_mm: v } }), `palate-${index}`),
  });
}

function planeRow(app: App, s: State, plane: Plane, index: number, n: number): Html {
  const isSelected = s.segment === index && s.plane === n;
  const { plan } = app.model.doc;
  return html` <div class="list-row ${isSelected ? 'selected' : ''}">
      <span></span>
      <button
        type="button"
        class="list-main"
        aria-pressed=${String(isSelected)}
        data-id=${`plane-${index}-${n}`}
        @click=${() => app.patch({ segment: index, plane: isSelected ? null : n })}
      >
        <b>Plane ${n + 1}</b><span>${plane.size_mm ? 'bounded' : ''}</span>
      </button>
      <span class="row">
        ${iconButton('flip', 'Swap the sides', () => app.edit({ plan: editPlane(plan, index, n, flipped(plane)) }))}
        ${iconButton('trash', `Remove plane ${n + 1}`, () => app.edit({ plan: withoutPlane(plan, index, n) }))}
      </span>
    </div>
    ${isSelected ? planeFields(app, plane, index, n) : nothing}`;
}

function planeFields(app: App, plane: Plane, index: number, n: number): Html {
  const move = (axis: number, value: number): void => {
    const point_mm = mapVec3(plane.point_mm, (old, k) => (k === axis ? value : old));
    app.edit({ plan: editPlane(app.model.doc.plan, index, n, { ...plane, point_mm }) }, `plane-${index}-${n}-${axis}`);
  };
  return html`<div class="numbers">
      ${(['x', 'y', 'z'] as const).map((axis, c) =>
        numberField({
          label: ['To the left', 'To posterior', 'To superior'][c],
          hint: `position ${axis}`,
          value: plane.point_mm[c],
          unit: 'mm',
          step: 0.5,
          onInput: (v) => move(c, v),
          onDone: () => app.settle(),
        }),
      )}
    </div>
    ${hint('Drag the arrow to translate the plane and the rings to tilt it. The arrow points to the segment.')}`;
}

function curveRow(app: App, curve: Curve, index: number, n: number): Html {
  const { plan } = app.model.doc;
  const depth = curve.depth_mm ? `${fixed(curve.depth_mm, 0)} mm deep` : 'through all bone';
  return html` <div class="list-row">
      <span></span>
      <span class="list-main"><b>Curve ${n + 1}</b><span>${curve.points_mm?.length ?? 0} points, ${depth}</span></span>
      ${iconButton('trash', `Remove curve ${n + 1}`, () => app.edit({ plan: withoutCurve(plan, index, n) }))}
    </div>
    ${numberField({
      label: 'Depth',
      value: curve.depth_mm ?? 20,
      unit: 'mm',
      step: 1,
      min: 1,
      max: 200,
      onInput: (v) => {
        const curvesOf = (o: Osteotomy) => o.curves?.map((c, k) => (k === n ? { ...c, depth_mm: v } : c));
        edit(app, index, (o) => ({ ...o, curves: curvesOf(o) }), `depth-${index}-${n}`);
      },
    })}`;
}

function moreFields(app: App, segment: Segment, index: number): Html {
  const { plan } = app.model.doc;
  const earlier = plan.segments.slice(0, index).map(({ name }) => ({ value: name, text: name }));
  const cutFrom = (name: string): void => {
    const change = (old: Segment): Segment => {
      const next = { ...old };
      delete next.cut_from;
      return name ? { ...next, cut_from: name } : next;
    };
    app.edit({ plan: editSegment(plan, index, change) });
  };
  return html`${numberField({
    label: 'Saw width',
    value: segment.osteotomy.kerf_mm ?? 0,
    unit: 'mm',
    step: 0.1,
    min: 0,
    max: 5,
    onInput: (v) => edit(app, index, (o) => ({ ...o, kerf_mm: v }), `kerf-${index}`),
  })}
  ${earlier.length
    ? select('Cut from', [{ value: '', text: 'the remaining bone' }, ...earlier], segment.cut_from ?? '', cutFrom)
    : nothing}`;
}
