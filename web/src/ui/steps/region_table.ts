import { html, nothing } from 'lit-html';
import { fixed, gradientOf, ticksOf, type ScaleName } from '../../model';
import type { Html } from '../widgets';

const REGION_NAMES: Record<string, string> = {
  whole: 'Whole skin',
  moved: 'Moved > 0.5 mm',
  'right cheek': 'Cheek, right',
  'left cheek': 'Cheek, left',
};

const capitalized = (text: string): string => text[0].toUpperCase() + text.slice(1);

export const regionName = (region: string): string => REGION_NAMES[region] ?? capitalized(region);

/** Cells of a table of lengths [mm]; a dash for a value that does not exist. */
export const valueCells = (values_mm: readonly (number | null)[]): Html =>
  html`${values_mm.map((v) => html`<td>${v === null ? '–' : fixed(v, 1)}</td>`)}`;

/** The colors of a map, from 0 to `top`. */
export const legend = (scale: ScaleName, top: number, unit: string, id: string): Html =>
  html` <div class="legend" data-id=${id}>
    <div class="ramp" .style=${`background:${gradientOf(scale)}`}></div>
    <div class="ticks">${ticksOf(top).map((text) => html`<span>${text}</span>`)}<span>${unit}</span></div>
  </div>`;

/** The landmarks that regions without values need. */
export const missingRegions = (missing: readonly string[]): Html =>
  missing.length
    ? html`<details>
        <summary>Regions without values: ${missing.length}</summary>
        <div class="hint">Landmarks are missing. ${missing.join('; ')}.</div>
      </details>`
    : nothing;
