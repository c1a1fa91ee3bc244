import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { closestToHoles, fixed, GUIDE_LIMITS, warningsOf, type GuideSettings, type GuideSide } from '../../model';
import type { App } from '../app';
import { numberField } from '../number_field';
import { lastJob, stageOf, type State } from '../state';
import { hint, notice, section, select, type Html } from '../widgets';
import { cells, downloads, jobControl, jobWarnings, staleNotice, type FileWords } from './measure_parts';

const LENGTHS = [
  { key: 'thickness_mm', label: 'Thickness', hint: 'of the guide', step: 0.5, digits: 1 },
  { key: 'width_mm', label: 'Width', hint: 'on each side of the cut', step: 0.5, digits: 1 },
  { key: 'hole_diameter_mm', label: 'Holes', hint: 'diameter of the drill', step: 0.1, digits: 1 },
  { key: 'hole_distance_mm', label: 'Distance of holes', hint: 'from the cut', step: 0.5, digits: 1 },
] as const;

const SIDES = [
  { value: '', text: 'As the osteotomy needs' },
  { value: 'anterior', text: 'Anterior' },
  { value: 'right', text: 'Right' },
  { value: 'left', text: 'Left' },
  { value: 'inferior', text: 'Inferior' },
] as const;

/** Cutting guides of the osteotomies of the plan. */
export function guidesSection(app: App, s: State): Html {
  const set = (part: Partial<GuideSettings>): void =>
    app.patch({ guideSettings: { ...app.model.s.guideSettings, ...part } });
  const names = app.model.doc.plan.segments.map(({ name }) => name);
  return section(
    'Cutting guides',
    staleNotice(s, 'guides'),
    s.guides
      ? guidesResult(s.guides)
      : hint('A guide fits on the bone. It has slots for the saw, and holes that a plate uses after the movement.'),
    select(
      'Segment',
      [{ value: '', text: 'Each that is cut' }, ...names.map((name) => ({ value: name, text: name }))],
      chosenSegment(s, names) ?? '',
      (value) => set({ segment: value || null }),
    ),
    select('Put on from', SIDES, s.guideSettings.from ?? '', (value) =>
      set({ from: (value || null) as GuideSide | null }),
    ),
    LENGTHS.map(({ key, ...field }) =>
      numberField({
        ...field,
        value: s.guideSettings[key],
        unit: 'mm',
        min: GUIDE_LIMITS[key][0],
        max: GUIDE_LIMITS[key][1],
        id: `guide-${key}`,
        onInput: (value) => set({ [key]: value }),
      }),
    ),
    jobControl(app, s, {
      kind: 'guides',
      start: s.guides ? 'Make the guides again' : 'Make the guides',
      run: () => void app.measures.makeGuides(chosenSegment(s, names)),
      isFresh: stageOf(s, 'guides').state === 'fresh',
      needs: names.length > 0 ? null : 'The plan has no segment. Cut one in step 4, Osteotomy.',
    }),
    jobWarnings(s, 'guides'),
    summaryWarnings(s),
    downloads(app, s, 'guides', filesOf(s.guides)),
  );
}

/** The chosen segment, if the plan still has it. */
const chosenSegment = (s: State, names: readonly string[]): string | null => {
  const { segment } = s.guideSettings;
  return segment !== null && names.includes(segment) ? segment : null;
};

const guidesResult = (found: Schemas['Guides']): Html =>
  html`<table data-id="guides-table">
      <thead>
        <tr>
          <th>Guide</th>
          <th title="Length of all slots × their width">Slot</th>
          <th title="Clearance: median distance of the guide from the bone">Gap</th>
          <th title="Deepest penetration on the way in">Way in</th>
          <th>Holes</th>
          <th title="Distance of the holes from the closest root or nerve">Closest</th>
        </tr>
      </thead>
      <tbody>
        ${found.guides.map(guideRow)}
      </tbody>
    </table>
    ${hint(
      `mm. Gap: clearance. Closest root or nerve to a hole: wanted ${fixed(found.min_distance_mm, 1)} mm or more.`,
    )}
    ${found.are_nerves_considered
      ? nothing
      : notice('info', 'Without the nerves', 'Holes are not compared with the canals. Trace them first, under Nerve.')}
    ${found.are_roots_considered
      ? nothing
      : notice('info', 'Without the teeth', 'No teeth were found: holes are not compared with roots.')}`;

function guideRow({ name, slot_mm, slot_width_mm, fit, holes }: Schemas['Guide']): Html {
  const closest = closestToHoles(holes);
  return html`<tr>
    <td>${name}</td>
    <td>${fixed(slot_mm, 1)} × ${fixed(slot_width_mm, 2)}</td>
    ${cells([fit.clearance_mm.median, fit.max_penetration_mm], 2)}
    <td>${holes.length}</td>
    <td title=${closest?.name ?? nothing}>${fixed(closest?.distance_mm, 1)}</td>
  </tr>`;
}

/** Warnings in the summary of the last job. */
function summaryWarnings(s: State): Html {
  const job = lastJob(s, 'guides');
  if (job?.state !== 'done' || stageOf(s, 'guides').state !== 'fresh') return nothing;
  return html`${warningsOf(job.message).map((text) => notice('warning', 'Please check', text))}`;
}

const filesOf = (found: Schemas['Guides'] | null): FileWords[] => [
  ...(found?.guides ?? []).map(({ name }): FileWords => [`guide_${name}.stl`, `Guide ${name}, for a printer`]),
  ...((found?.guides ?? []).some(({ holes }) => holes.length > 0)
    ? ([
        ['holes_before.mrk.json', 'Holes before the movement'],
        ['holes_after.mrk.json', 'Holes after the movement'],
      ] as const)
    : []),
  ['guides.json', 'All measures of the guides'],
];
