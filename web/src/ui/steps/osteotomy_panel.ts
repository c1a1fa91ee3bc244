import { html, nothing } from 'lit-html';
import {
  cutsNothing,
  missingFor,
  roundVec3,
  scale,
  TEMPLATES,
  templateKind,
  unit,
  withCurve,
  withSegment,
  type Vec3,
} from '../../model';
import type { App } from '../app';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { button, chip, empty, hint, notice, section, type Html } from '../widgets';
import { segmentCard } from './segment_card';

const CURVE_DEPTH_MM = 20;

/** Closes the curve that is being drawn. It cuts inwards, against the mean normal of the surface. */
export function closeCurve(app: App): void {
  const { s, doc } = app.model;
  const draft = s.curveDraft;
  if (!draft || draft.points.length < 3) return;
  const mean = draft.normals.reduce<Vec3>((sum, n) => [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]], [0, 0, 0]);
  const along = roundVec3(unit(scale(mean, -1)), 4);
  const curve = { points_mm: draft.points, along, depth_mm: CURVE_DEPTH_MM };
  const current = doc.plan.segments[s.segment];
  // A template excludes curves; the curve then cuts a segment of its own.
  const extendsCurrent = current !== undefined && current.osteotomy.template === undefined;
  const plan = extendsCurrent
    ? withCurve(doc.plan, s.segment, curve)
    : withSegment(doc.plan, 'piece', { curves: [curve] });
  app.edit({ plan });
  app.patch({ curveDraft: null, tool: 'none', segment: extendsCurrent ? s.segment : plan.segments.length - 1 });
}

export function osteotomyPanel(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (stageOf(s, 'anatomy').state === 'missing')
    return html`<h2>Osteotomy</h2>
      ${empty(
        'No bone surface yet',
        'Segment the tissues in step 2, Anatomy.',
        button('To the anatomy', () => app.setStep('anatomy')),
      )}`;
  const state = isBusyWith(s, 'cut') ? 'running' : stageOf(s, 'cut').state;
  return html`
    <h2>Osteotomy ${plan.segments.length ? chip(state) : nothing}</h2>
    ${cutNotices(app, s)}
    ${plan.segments.length
      ? html`<div class="group" .style=${'border:0;padding:0'}>
          ${plan.segments.map((segment, index) => segmentCard(app, s, segment, index))}
        </div>`
      : nothing}
    ${addSection(app, s)} ${templateSection(app)}
  `;
}

function cutNotices(app: App, s: State): Html {
  const stage = stageOf(s, 'cut');
  const job = lastJob(s, 'cut');
  const isEmpty = app.model.doc.plan.segments.length === 0;
  return html`${stage.state === 'stale' ? notice('warning', 'The cut is out of date', stage.why) : nothing}
  ${job?.state === 'failed' && stage.state !== 'fresh'
    ? notice('error', 'The bone could not be cut', job.message)
    : nothing}
  ${isEmpty && stageOf(s, 'plan').state !== 'missing'
    ? notice('info', 'The last cut is still stored', 'A plan needs at least one cut. The next cut replaces it.')
    : nothing}
  ${isEmpty ? hint('A cut separates one segment of bone. Start with a template, or draw the cut.') : nothing}`;
}

function addSection(app: App, s: State): Html {
  const draft: Partial<State> =
    s.tool === 'curve'
      ? { tool: 'none', curveDraft: null }
      : { tool: 'curve', curveDraft: { points: [], normals: [] } };
  return section(
    'Add a cut',
    html`<div class="row wrap">
      ${button('Plane', () => app.patch({ tool: s.tool === 'plane' ? 'none' : 'plane', curveDraft: null }), {
        icon: 'plus',
        pressed: s.tool === 'plane',
        id: 'add-plane',
      })}
      ${button('Closed curve', () => app.patch(draft), {
        icon: 'plus',
        pressed: s.tool === 'curve',
        id: 'add-curve',
      })}
    </div>`,
    s.tool === 'plane' ? planeNotice(app, s) : nothing,
    s.tool === 'curve' ? curveNotice(app, s) : nothing,
  );
}

function planeNotice(app: App, s: State): Html {
  const segment = app.model.doc.plan.segments[s.segment];
  const text =
    segment && templateKind(segment.osteotomy) === null
      ? `The plane is added to ${segment.name}. A segment is the bone on the selected side of all its planes.`
      : 'The plane passes through that point. The bone below it is the segment.';
  return notice('info', 'Click on the bone', text);
}

function curveNotice(app: App, s: State): Html {
  const count = s.curveDraft?.points.length ?? 0;
  return notice(
    'info',
    `Click around the piece, point by point (${count})`,
    'At least three points. More points follow a round shape better.',
    button('Close the curve', () => closeCurve(app), { kind: 'primary', disabled: count < 3, id: 'close-curve' }),
  );
}

function templateSection(app: App): Html {
  const { plan, landmarks } = app.model.doc;
  const names = landmarks.map((l) => l.name);
  return section(
    'Templates',
    names.length === 0 ? hint('Landmarks place the templates. Set them in step 3.') : nothing,
    TEMPLATES.map(({ kind, title, describes }) => {
      const missing = missingFor(kind, names);
      const add = (): void => {
        const next = withSegment(plan, kind, { template: kind });
        app.edit({ plan: next });
        app.patch({ segment: next.segments.length - 1, plane: null });
      };
      return html`<button
        type="button"
        class="choice"
        ?disabled=${missing.length > 0}
        data-id=${`template-${kind}`}
        @click=${add}
      >
        <strong>${title}</strong
        ><small>${missing.length ? html`<span class="lack">Missing: ${missing.join(', ')}</span>` : describes}</small>
      </button>`;
    }),
    hint('A template is a first proposal to review, not a cutting guide.'),
  );
}

export function osteotomyFoot(app: App, s: State): Html {
  const { plan } = app.model.doc;
  if (plan.segments.length === 0) return nothing;
  const isBusy = isBusyWith(s, 'cut');
  const isFresh = stageOf(s, 'cut').state === 'fresh';
  const label = isBusy ? 'Cutting …' : isFresh ? 'Cut again' : 'Cut the bone';
  return html`${button(label, () => void app.run({ kind: 'cut' }), {
    kind: isFresh ? 'plain' : 'primary',
    disabled: isBusy || plan.segments.some((x) => cutsNothing(x.osteotomy)),
    id: 'cut',
  })}
  ${isFresh ? button('Move the segments', () => app.setStep('movement'), { kind: 'primary' }) : nothing}`;
}
