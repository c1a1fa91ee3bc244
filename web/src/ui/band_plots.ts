import { html, svg, type TemplateResult } from 'lit-html';
import type { Schemas } from '../api';
import { bandFrame, bandPath, profilePath, roundQuarters, ticksOf, viewBoxOf, type BandSection } from '../model';

/** Length of the scale bar [mm]. */
const SCALE_MM = 10;

/** Median and band of the face in the mid-sagittal plane, from the patient's right; dashed: before. */
export function bandProfilePlot(section: BandSection, before: Float32Array | null): TemplateResult | null {
  const frame = bandFrame(section);
  if (!frame) return null;
  const bottom = frame.height + 8;
  return html`<svg
    class="plot"
    viewBox=${viewBoxOf(frame)}
    .style=${'max-height:420px'}
    role="img"
    aria-label="Profile of the median face with its band from P5 to P95, from the right"
    data-id="band-profile"
  >
    ${before
      ? svg`<path d=${profilePath(before, frame)} fill="none" stroke="var(--ink-3)" stroke-width="1.2"
          vector-effect="non-scaling-stroke" stroke-dasharray="4 3"></path>`
      : ''}
    ${svg`<path d=${bandPath(section, frame)} fill="var(--accent)" stroke="var(--accent)" stroke-width="0.6"
        vector-effect="non-scaling-stroke" opacity="0.35"></path>
      <path d=${profilePath(section.middle, frame)} fill="none" stroke="var(--accent)" stroke-width="1.6"
        vector-effect="non-scaling-stroke"></path>
      <path d=${`M4 ${bottom}h${SCALE_MM}`} stroke="var(--ink-2)" stroke-width="1.5"
        vector-effect="non-scaling-stroke"></path>
      <text x=${4 + SCALE_MM / 2} y=${bottom - 1.2} text-anchor="middle" .style=${'font-size:3.6px'}>
        ${SCALE_MM} mm
      </text>`}
  </svg>`;
}

const W = 300;
const H = 150;
const LEFT = 40;
const BOTTOM = 34;
const TOP = 10;

/** Mean band width of the moved skin, estimated from the first samples, with its bootstrap interval. */
export function convergencePlot(rows: Schemas['Uncertainty']['convergence'], level: number): TemplateResult {
  const top = roundQuarters(Math.max(...rows.map((row) => Math.max(row.mean_band_mm, row.interval_mm[1]))));
  const logs = rows.map((row) => Math.log2(row.samples));
  const [from, to] = [Math.min(...logs), Math.max(...logs)];
  const x = (n: number): number =>
    to > from ? LEFT + 14 + ((W - LEFT - 30) * (logs[n] - from)) / (to - from) : (LEFT + W) / 2;
  const y = (value: number): number => H - BOTTOM - ((H - BOTTOM - TOP) * value) / top;
  const line = rows.map((row, n) => `${n === 0 ? 'M' : 'L'}${x(n).toFixed(1)} ${y(row.mean_band_mm).toFixed(1)}`);
  return html`<svg
    class="plot"
    viewBox="0 0 ${W} ${H}"
    role="img"
    aria-label="Mean band width by number of samples, with its interval"
    data-id="convergence"
    data-rows=${rows.length}
  >
    ${ticksOf(top).map((text, k) => {
      const at = y((k * top) / 4);
      return svg`<line x1=${LEFT} x2=${W - 8} y1=${at} y2=${at} stroke="var(--line)"></line>
        <text x=${LEFT - 6} y=${at + 3.5} text-anchor="end">${text}</text>`;
    })}
    ${rows.map(({ interval_mm: [low, high], mean_band_mm, samples }, n) => {
      const at = x(n);
      return svg`<path d=${`M${at} ${y(low)}V${y(high)}M${at - 4} ${y(low)}h8M${at - 4} ${y(high)}h8`} fill="none"
          stroke="var(--ink-3)" stroke-width="1.2"></path>
        <circle cx=${at} cy=${y(mean_band_mm)} r="3" fill="var(--accent)"></circle>
        <text x=${at} y=${H - BOTTOM + 13} text-anchor="middle">${samples}</text>`;
    })}
    ${svg`<path d=${line.join('')} fill="none" stroke="var(--accent)" stroke-width="1.5"></path>
      <text x=${(LEFT + W) / 2} y=${H - 6} text-anchor="middle">
        samples; mean width [mm], interval of ${Math.round(100 * level)} %
      </text>`}
  </svg>`;
}
