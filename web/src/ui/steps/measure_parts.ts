import { html, nothing } from 'lit-html';
import type { Schemas } from '../../api';
import { fixed } from '../../model';
import type { App } from '../app';
import { isBusyWith, lastJob, stageOf, type State } from '../state';
import { button, hint, icon, notice, progressBar, type Html } from '../widgets';

// Parts that the sections of teeth and measures have in common.

export type StageName = keyof Schemas['Case']['stages'];

/** Why a result is out of date. */
export function staleNotice(s: State, stage: StageName): Html {
  const { state, why } = stageOf(s, stage);
  return state === 'stale' ? notice('warning', 'Out of date', why) : nothing;
}

export interface JobOptions {
  kind: Schemas['JobKind'];
  /** The label of the button. */
  start: string;
  run: () => void;
  /** Whether the result exists and is not out of date: then the button is not the primary one. */
  isFresh: boolean;
  /** Why the job cannot be started. */
  needs?: string | null;
}

/** The button that starts a job; while it runs, its progress. */
export function jobControl(app: App, s: State, o: JobOptions): Html {
  if (isBusyWith(s, o.kind)) return jobProgress(app, s, o.kind);
  const job = lastJob(s, o.kind);
  return html`${job?.state === 'failed' ? notice('error', 'This has failed', job.message) : nothing}
    <div class="row wrap">
      ${button(o.start, o.run, {
        kind: o.isFresh ? 'plain' : 'primary',
        disabled: Boolean(o.needs),
        id: `run-${o.kind}`,
      })}
    </div>
    ${o.needs ? hint(o.needs) : nothing}`;
}

function jobProgress(app: App, s: State, kind: Schemas['JobKind']): Html {
  const job = lastJob(s, kind);
  return html`<div class="row">
      <span class="grow" data-id=${`${kind}-stage`}>${job?.stage || 'waiting'}</span>
      ${job
        ? button('Stop', () => void app.stopJob(job.id), { kind: 'danger', icon: 'stop', id: `stop-${kind}` })
        : nothing}
    </div>
    ${progressBar(job?.fraction ?? 0, 'Progress')}`;
}

/** Notes of the last job of a kind that are warnings. */
export function jobWarnings(s: State, kind: Schemas['JobKind']): Html {
  const job = lastJob(s, kind);
  if (job?.state !== 'done') return nothing;
  return html`${[...new Set(job.lines)]
    .filter((line) => line.startsWith('warning: '))
    .map((line) => notice('warning', 'Please check', line.slice('warning: '.length)))}`;
}

/** A file for download with the words for it. */
export type FileWords = readonly [name: string, words: string];

/** Files of a result; those of a result that is out of date cannot be downloaded. */
export function downloads(app: App, s: State, stage: StageName, files: readonly FileWords[]): Html {
  const { state, etag } = stageOf(s, stage);
  if (etag === null) return nothing;
  if (state !== 'fresh') return hint('Files that are out of date cannot be downloaded.');
  return html`<div class="list">
    ${files.map(
      ([name, words]) =>
        html`<button type="button" class="list-main" data-id=${`file-${name}`} @click=${() => void app.download(name)}>
          ${icon('download')}<span title=${name}>${words}</span>
        </button>`,
    )}
  </div>`;
}

/** Rows of names and values. */
export const figures = (id: string, rows: readonly (readonly [name: string, value: string])[]): Html =>
  html`<dl class="figures" data-id=${id}>
    ${rows.map(
      ([name, value]) =>
        html`<dt>${name}</dt>
          <dd>${value}</dd>`,
    )}
  </dl>`;

/** Cells of a table of numbers. */
export const cells = (values: readonly (number | null)[], digits: number): Html =>
  html`${values.map((value) => html`<td>${fixed(value, digits)}</td>`)}`;
