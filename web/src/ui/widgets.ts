import { html, nothing, svg, type TemplateResult } from 'lit-html';
import type { Schemas } from '../api';

/** A template of lit-html, or nothing. */
export type Html = TemplateResult | typeof nothing | string;

const PATHS = {
  undo: 'M7 8H13a5 5 0 0 1 0 10h-3M7 8l3.5-3.5M7 8l3.5 3.5',
  redo: 'M17 8H11a5 5 0 0 0 0 10h3M17 8l-3.5-3.5M17 8l-3.5 3.5',
  sun:
    'M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8ZM12 3v2M12 19v2M3 12h2M19 12h2' +
    'M5.6 5.6 7 7M17 17l1.4 1.4M5.6 18.4 7 17M17 7l1.4-1.4',
  moon: 'M19 14.5A7.5 7.5 0 0 1 9.5 5 7.5 7.5 0 1 0 19 14.5Z',
  system: 'M4 5h16v11H4zM9 20h6M12 16v4',
  help: 'M9.2 9.2a2.8 2.8 0 1 1 4 2.5c-.8.4-1.2.9-1.2 1.8M12 16.6v.1',
  trash: 'M5 7h14M10 7V5h4v2M7 7l.8 12h8.4L17 7',
  plus: 'M12 6v12M6 12h12',
  flip: 'M12 4v16M8 8l-4 4 4 4M16 8l4 4-4 4',
  stop: 'M7.5 7.5h9v9h-9z',
  download: 'M12 5v9M8 10.5l4 4 4-4M5 19h14',
  camera: 'M4 8h3.5L9 6h6l1.5 2H20v10H4zM12 10.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 0 0 0-5.6Z',
  target: 'M12 7a5 5 0 1 0 0 10 5 5 0 0 0 0-10ZM12 3v4M12 17v4M3 12h4M17 12h4',
  warning: 'M12 4.5 21 19H3zM12 10v4M12 16.4v.1',
  check: 'M5.5 12.5l4 4 9-9.5',
  close: 'M6.5 6.5l11 11M17.5 6.5l-11 11',
  folder: 'M3.5 6.5h6l2 2.5h9v9.5h-17z',
} as const;

export type IconName = keyof typeof PATHS;

export const icon = (name: IconName): TemplateResult =>
  html`<svg class="icon" viewBox="0 0 24 24" aria-hidden="true">${svg`<path d=${PATHS[name]}></path>`}</svg>`;

export interface ButtonOptions {
  kind?: 'primary' | 'plain' | 'quiet' | 'danger';
  disabled?: boolean;
  title?: string;
  icon?: IconName;
  pressed?: boolean;
  id?: string;
}

export const button = (label: string, onClick: () => void, options: ButtonOptions = {}): TemplateResult => html`
  <button
    type="button"
    class="button ${options.kind ?? 'plain'}"
    data-id=${options.id ?? nothing}
    ?disabled=${options.disabled ?? false}
    title=${options.title ?? nothing}
    aria-pressed=${options.pressed === undefined ? nothing : String(options.pressed)}
    @click=${onClick}
  >
    ${options.icon ? icon(options.icon) : nothing}<span>${label}</span>
  </button>
`;

export const iconButton = (
  name: IconName,
  label: string,
  onClick: () => void,
  disabled = false,
): TemplateResult => html`
  <button type="button" class="icon-button" aria-label=${label} title=${label} ?disabled=${disabled} @click=${onClick}>
    ${icon(name)}
  </button>
`;

export const section = (title: string, ...content: unknown[]): TemplateResult => html`
  <section class="group">
    <h3>${title}</h3>
    ${content}
  </section>
`;

export const hint = (text: unknown): TemplateResult => html`<p class="hint">${text}</p>`;

export type NoticeKind = 'info' | 'warning' | 'error' | 'good';

export const notice = (
  kind: NoticeKind,
  title: string,
  text: unknown = nothing,
  action: unknown = nothing,
): TemplateResult => html`
  <div class="notice ${kind}" role=${kind === 'error' ? 'alert' : nothing}>
    ${icon(kind === 'good' ? 'check' : kind === 'info' ? 'help' : 'warning')}
    <div>
      <strong>${title}</strong>${text === nothing ? nothing : html`<div class="notice-text">${text}</div>`}${action}
    </div>
  </div>
`;

export interface SliderOptions {
  label: string;
  value: number;
  min: number;
  max: number;
  step: number;
  show: (value: number) => string;
  onInput: (value: number) => void;
  onChange?: () => void;
  disabled?: boolean;
}

export const slider = (o: SliderOptions): TemplateResult => html`
  <label class="slider">
    <span>${o.label}</span><output>${o.show(o.value)}</output>
    <input
      type="range"
      min=${o.min}
      max=${o.max}
      step=${o.step}
      .value=${String(o.value)}
      ?disabled=${o.disabled ?? false}
      @input=${(e: Event) => o.onInput(Number((e.target as HTMLInputElement).value))}
      @change=${() => o.onChange?.()}
    />
  </label>
`;

export const toggle = (
  label: string,
  on: boolean,
  onChange: (on: boolean) => void,
  disabled = false,
): TemplateResult => html`
  <label class="toggle">
    <input
      type="checkbox"
      role="switch"
      .checked=${on}
      ?disabled=${disabled}
      @change=${(e: Event) => onChange((e.target as HTMLInputElement).checked)}
    />
    <span class="track" aria-hidden="true"></span><span>${label}</span>
  </label>
`;

export function segmented<T extends string>(
  label: string,
  options: readonly { value: T; text: string; title?: string }[],
  value: T | null,
  onPick: (value: T) => void,
): TemplateResult {
  return html`
    <div class="segmented" role="group" aria-label=${label}>
      ${options.map(
        (o) =>
          html`<button
            type="button"
            title=${o.title ?? nothing}
            aria-pressed=${String(o.value === value)}
            @click=${() => onPick(o.value)}
          >
            ${o.text}
          </button>`,
      )}
    </div>
  `;
}

export const select = (
  label: string,
  options: readonly { value: string; text: string }[],
  value: string,
  onPick: (value: string) => void,
): TemplateResult => html`
  <label class="field"
    ><span>${label}</span>
    <select .value=${value} @change=${(e: Event) => onPick((e.target as HTMLSelectElement).value)}>
      ${options.map((o) => html`<option value=${o.value} ?selected=${o.value === value}>${o.text}</option>`)}
    </select>
  </label>
`;

const STATE_WORDS: Record<Schemas['Stage']['state'], string> = {
  missing: 'not made yet',
  fresh: 'up to date',
  stale: 'out of date',
  running: 'working',
  failed: 'failed',
  unconverged: 'not converged',
};

export const stateWord = (state: Schemas['Stage']['state']): string => STATE_WORDS[state];

export const chip = (state: Schemas['Stage']['state']): TemplateResult =>
  html`<span class="chip ${state}">${STATE_WORDS[state]}</span>`;

export const progressBar = (fraction: number, label: string): TemplateResult => html`
  <div
    class="progress"
    role="progressbar"
    aria-label=${label}
    aria-valuemin="0"
    aria-valuemax="100"
    aria-valuenow=${Math.round(fraction * 100)}
  >
    <span .style=${`width:${(fraction * 100).toFixed(1)}%`}></span>
  </div>
`;

export const empty = (title: string, text: unknown, action: unknown = nothing): TemplateResult => html`
  <div class="empty">
    <h3>${title}</h3>
    <p>${text}</p>
    ${action}
  </div>
`;
