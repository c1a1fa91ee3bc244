import { html, nothing } from 'lit-html';
import {
  cssOf,
  cutsNothing,
  editOsteotomy,
  editPlane,
  editSegment,
  fixed,
  flipped,
  mapVec3,
  missingFor,
  ml,
  renameSegment,
  roundVec3,
  scale,
  segmentColor,
  templateKey,
  templateKind,
  TEMPLATES,
  unit,
  withCurve,
  withoutCurve,
  withoutPlane,
  withoutSegment,
  withSegment,
  type Plane,
  type Segment,
  type Vec3,
} from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { button, chip, empty, hint, iconButton, notice, section, select, type Html } from '../widgets';
import { isBusyWith, lastJob, stageOf, type State } from '../state';

/** Volume of each segment, as the cut told it. */
export function volumesOf(s: State): Map<string, number> {
  const result = lastJob(s, 'cut')?.result as { bones?: { name?: string; volume_ml?: number }[] } | null | undefined;
  return new Map(
    (result?.bones ?? []).filter((x) => x.name && x.volume_ml !== undefined).map((x) => [x.name!, x.volume_ml!]),
  );
}

/** Closes the curve that is being drawn: it cuts inwards, against the mean of the surface's normals. */
export function closeCurve(app: App): void {
  const { s, doc } = app.model;
  const draft = s.curveDraft;
  if (!draft || draft.points.length < 3) return;
  const mean = draft.normals.reduce<Vec3>((sum, n) => [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]], [0, 0, 0]);
  const along = roundVec3(unit(scale(mean, -1)), 4);
  const curve = { points_mm: draft.points, along, depth_mm: 20 };
  const current = doc.plan.segments[s.segment];
  // A cut that a template places takes no curve beside it: then the curve is a cut of its own.
  const plan =
    current && current.osteotomy.template === undefined
      ? withCurve(doc.plan, s.segment, curve)
      : withSegment(doc.plan, 'piece', { curves: [curve] });
  app.edit({ plan });
  app.patch({
    curveDraft: null,
    tool: 'none',
    segment: current && current.osteotomy.template === undefined ? s.segment : plan.segments.length - 1,
  });
}

async function writeOut(app: App, index: number): Promise<void> {
  const { s, doc } = app.model;
  const { osteotomy } = doc.plan.segments[index];
  const placed = s.templatePlanes.get(templateKey(osteotomy.template, doc.landmarks));
  if (placed === undefined || typeof placed === 'string') return;
  const { template: _gone, ...rest } = osteotomy;
  void _gone;
  app.edit({ plan: editOsteotomy(doc.plan, index, () => ({ ...rest, ...(placed as object) })) });
}

function planeRow(app: App, s: State, plane: Plane, index: number, n: number): Html {
  const selected = s.segment === index && s.plane === n;
  const { plan } = app.model.doc;
  return html` <div class="list-row ${selected ? 'selected' : ''}">
      <span></span>
      <button
        type="button"
        class="list-main"
        aria-pressed=${String(selected)}
        data-id=${`plane-${index}-${n}`}
        @click=${() => app.patch({ segment: index, plane: selected ? null : n })}
      >
        <b>Plane ${n + 1}</b><span>${plane.size_mm ? 'bounded' : ''}</span>
      </button>
      <span class="row">
        ${iconButton('flip', 'The other side is the segment', () =>
          app.edit({ plan: editPlane(plan, index, n, flipped(plane)) }),
        )}
        ${iconButton('trash', `Remove plane ${n + 1}`, () => app.edit({ plan: withoutPlane(plan, index, n) }))}
      </span>
    </div>
    ${selected
      ? html`<div class="numbers">
            ${(['x', 'y', 'z'] as const).map((axis, c) =>
              numberField({
                label: ['To the left', 'To posterior', 'To superior'][c],
                hint: `position ${axis}`,
                value: plane.point_mm[c],
                unit: 'mm',
                step: 0.5,
                onInput: (v) =>
                  app.edit(
                    {
                      plan: editPlane(plan, index, n, {
                        ...plane,
                        point_mm: mapVec3(plane.point_mm, (old, k) => (k === c ? v : old)),
                      }),
                    },
                    `plane-${index}-${n}-${c}`,
                  ),
                onDone: () => app.settle(),
              }),
            )}
          </div>
          ${hint('Drag the arrow to shift the plane, the rings to tilt it. The arrow points to the segment.')}`
      : nothing}`;
}

function segmentCard(app: App, s: State, segment: Segment, index: number): Html {
  const { plan, landmarks } = app.model.doc;
  const selected = s.segment === index;
  const o = segment.osteotomy;
  const kind = templateKind(o);
  const template = kind ? TEMPLATES.find((t) => t.kind === kind)! : null;
  const placed = kind ? s.templatePlanes.get(templateKey(o.template, landmarks)) : undefined;
  const volume = volumesOf(s).get(segment.name);
  const earlier = plan.segments.slice(0, index);
  return html` <div
    class="card ${selected ? 'selected' : ''}"
    @pointerdown=${() => selected || app.patch({ segment: index, plane: null })}
  >
    <div class="card-head">
      <span class="swatch" .style=${`background:${cssOf(segmentColor(index))}`}></span>
      <input
        class="name"
        aria-label="Name of the segment"
        .value=${segment.name}
        spellcheck="false"
        @change=${(e: Event) => {
          const input = e.target as HTMLInputElement;
          const next = renameSegment(plan, index, input.value.trim());
          if (next) app.edit({ plan: next });
          else {
            app.toast('A name has letters, digits, - and _, and no other segment has it.', 'error');
            input.value = segment.name;
          }
        }}
      />
      ${volume === undefined ? nothing : html`<span class="chip">${ml(volume)}</span>`}
      ${iconButton('trash', `Remove ${segment.name}`, () => app.edit({ plan: withoutSegment(plan, index) }))}
    </div>
    ${selected
      ? html`<div class="card-body">
          ${template
            ? html`<div class="row">
                <span class="grow"><strong>${template.title}</strong> from landmarks</span> ${button(
                  'Edit planes',
                  () => void writeOut(app, index),
                  {
                    kind: 'quiet',
                    disabled: placed === undefined || typeof placed === 'string',
                    title: 'Writes the planes out, so that each can be moved',
                  },
                )}
              </div>`
            : nothing}
          ${typeof placed === 'string' ? notice('error', 'The template cannot be placed', placed) : nothing}
          ${kind === 'le-fort-1'
            ? numberField({
                label: 'Above the palate',
                value:
                  typeof o.template === 'object' && 'above_palate_mm' in o.template
                    ? Number(o.template.above_palate_mm)
                    : 5,
                unit: 'mm',
                step: 0.5,
                min: 0,
                max: 30,
                onInput: (v) =>
                  app.edit(
                    {
                      plan: editOsteotomy(plan, index, (old) => ({
                        ...old,
                        template: {
                          ...(typeof old.template === 'object' ? old.template : { kind: 'le-fort-1' as const }),
                          above_palate_mm: v,
                        },
                      })),
                    },
                    `palate-${index}`,
                  ),
              })
            : nothing}
          <div class="list">
            ${(o.planes ?? []).map((plane, n) => planeRow(app, s, plane, index, n))}
            ${(o.curves ?? []).map(
              (curve, n) =>
                html` <div class="list-row">
                    <span></span>
                    <span class="list-main"
                      ><b>Curve ${n + 1}</b
                      ><span
                        >${curve.points_mm?.length ?? 0} points,
                        ${curve.depth_mm ? `${fixed(curve.depth_mm, 0)} mm deep` : 'through all bone'}</span
                      ></span
                    >
                    ${iconButton('trash', `Remove curve ${n + 1}`, () =>
                      app.edit({ plan: withoutCurve(plan, index, n) }),
                    )}
                  </div>
                  ${numberField({
                    label: 'Depth',
                    value: curve.depth_mm ?? 20,
                    unit: 'mm',
                    step: 1,
                    min: 1,
                    max: 200,
                    onInput: (v) =>
                      app.edit(
                        {
                          plan: editOsteotomy(plan, index, (old) => ({
                            ...old,
                            curves: old.curves?.map((c, k) => (k === n ? { ...c, depth_mm: v } : c)),
                          })),
                        },
                        `depth-${index}-${n}`,
                      ),
                  })}`,
            )}
            ${cutsNothing(o) ? notice('warning', 'This cuts nothing yet', 'Add a plane or a curve.') : nothing}
          </div>
          <details>
            <summary>More</summary>
            <div>
              ${numberField({
                label: 'Saw width',
                value: o.kerf_mm ?? 0,
                unit: 'mm',
                step: 0.1,
                min: 0,
                max: 5,
                onInput: (v) =>
                  app.edit({ plan: editOsteotomy(plan, index, (old) => ({ ...old, kerf_mm: v })) }, `kerf-${index}`),
              })}
              ${earlier.length
                ? select(
                    'Cut out of',
                    [
                      { value: '', text: 'the bone that remains' },
                      ...earlier.map((e) => ({ value: e.name, text: e.name })),
                    ],
                    segment.from ?? '',
                    (v) =>
                      app.edit({
                        plan: editSegment(plan, index, (old) => {
                          const next = { ...old };
                          delete next.from;
                          return v ? { ...next, from: v } : next;
                        }),
                      }),
                  )
                : nothing}
            </div>
          </details>
        </div>`
      : nothing}
  </div>`;
}

export function osteotomyPanel(app: App, s: State): Html {
  const { plan, landmarks } = app.model.doc;
  const stage = stageOf(s, 'cut');
  const busy = isBusyWith(s, 'cut');
  const failed = lastJob(s, 'cut');
  if (stageOf(s, 'anatomy').state === 'missing')
    return html`<h2>Osteotomy</h2>
      ${empty(
        'No bone surface yet',
        'Tell the tissues apart in step 2, Anatomy.',
        button('To the anatomy', () => app.setStep('anatomy')),
      )}`;
  const names = landmarks.map((l) => l.name);
  const ready = TEMPLATES.filter((t) => missingFor(t.kind, names).length === 0);
  return html`
    <h2>Osteotomy ${plan.segments.length ? chip(busy ? 'running' : stage.state) : nothing}</h2>
    ${stage.state === 'stale' ? notice('warning', 'The cut is out of date', stage.why) : nothing}
    ${failed?.state === 'failed' && stage.state !== 'fresh'
      ? notice('error', 'The bone could not be cut', failed.message)
      : nothing}
    ${plan.segments.length === 0 && stageOf(s, 'plan').state !== 'missing'
      ? notice('info', 'The last cut is still kept', 'A plan needs one. It is replaced as soon as you add another.')
      : nothing}
    ${plan.segments.length === 0
      ? hint('A cut frees one piece of bone, the segment. Begin with a template, or draw the cut yourself.')
      : nothing}
    ${plan.segments.length
      ? html`<div class="group" .style=${'border:0;padding:0'}>
          ${plan.segments.map((segment, index) => segmentCard(app, s, segment, index))}
        </div>`
      : nothing}
    ${section(
      'Add a cut',
      html`<div class="row wrap">
        ${button('Plane', () => app.patch({ tool: s.tool === 'plane' ? 'none' : 'plane', curveDraft: null }), {
          icon: 'plus',
          pressed: s.tool === 'plane',
          id: 'add-plane',
        })}
        ${button(
          'Closed curve',
          () =>
            app.patch(
              s.tool === 'curve'
                ? { tool: 'none', curveDraft: null }
                : { tool: 'curve', curveDraft: { points: [], normals: [] } },
            ),
          { icon: 'plus', pressed: s.tool === 'curve', id: 'add-curve' },
        )}
      </div>`,
      s.tool === 'plane'
        ? notice(
            'info',
            'Click on the bone',
            plan.segments[s.segment] && templateKind(plan.segments[s.segment].osteotomy) === null
              ? `The plane is added to ${plan.segments[s.segment].name}: segment is what all its planes keep.`
              : 'A plane goes through that point; the bone below it is the segment.',
          )
        : nothing,
      s.tool === 'curve'
        ? notice(
            'info',
            `Click around the piece, point by point (${s.curveDraft?.points.length ?? 0})`,
            'At least three points; many follow a round shape better.',
            button('Close the curve', () => closeCurve(app), {
              kind: 'primary',
              disabled: (s.curveDraft?.points.length ?? 0) < 3,
              id: 'close-curve',
            }),
          )
        : nothing,
    )}
    ${section(
      'Templates',
      ready.length === 0 && landmarks.length === 0 ? hint('They are placed by landmarks, step 3.') : nothing,
      TEMPLATES.map((t) => {
        const lack = missingFor(t.kind, names);
        return html`<button
          type="button"
          class="choice"
          ?disabled=${lack.length > 0}
          data-id=${`template-${t.kind}`}
          @click=${() => {
            const next = withSegment(plan, t.kind, { template: t.kind });
            app.edit({ plan: next });
            app.patch({ segment: next.segments.length - 1, plane: null });
          }}
        >
          <strong>${t.title}</strong
          ><small>${lack.length ? html`<span class="lack">Lacks ${lack.join(', ')}</span>` : t.describes}</small>
        </button>`;
      }),
      hint('A template is a start to be looked at, not a cutting guide.'),
    )}
  `;
}

export function osteotomyFoot(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (plan.segments.length === 0) return nothing;
  const busy = isBusyWith(s, 'cut');
  const fresh = stageOf(s, 'cut').state === 'fresh';
  return html`${button(busy ? 'Cutting …' : fresh ? 'Cut again' : 'Cut the bone', () => void app.run({ kind: 'cut' }), {
    kind: fresh ? 'plain' : 'primary',
    disabled: busy || plan.segments.some((x) => cutsNothing(x.osteotomy)),
    id: 'cut',
  })}
  ${fresh ? button('Move the segments', () => app.setStep('movement'), { kind: 'primary' }) : nothing}`;
}
