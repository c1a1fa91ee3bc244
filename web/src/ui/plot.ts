import { svg, html, type TemplateResult } from 'lit-html';
import { profileFrame, profilePath, viewBoxOf } from '../model';
import type { NewtonPoint } from './state';

const W = 300;
const H = 150;
const LEFT = 40;
const BOTTOM = 20;

/** Relative residual of every Newton iteration, logarithmic; one line per attempt at an increment. */
export function residualPlot(points: readonly NewtonPoint[], tolerance: number): TemplateResult {
  const good = points.filter((p) => p.relative_residual > 0);
  const logs = good.map((p) => Math.log10(p.relative_residual));
  const top = Math.ceil(Math.max(0, ...logs));
  const bottom = Math.floor(Math.min(Math.log10(tolerance) - 0.5, ...logs.filter((v) => v > -14)));
  const x = (n: number) => LEFT + ((W - LEFT - 8) * n) / Math.max(20, good.length - 1);
  const y = (log: number) => 8 + ((H - BOTTOM - 8) * (top - Math.max(bottom, log))) / (top - bottom);
  const limit = y(Math.log10(tolerance));
  const paths: string[] = [];
  good.forEach((p, n) => {
    const before = good[n - 1];
    const begins = !before || before.step !== p.step || before.attempt !== p.attempt;
    if (begins) paths.push(`M${x(n).toFixed(1)} ${y(logs[n]).toFixed(1)}`);
    else paths[paths.length - 1] += `L${x(n).toFixed(1)} ${y(logs[n]).toFixed(1)}`;
  });
  const ticks = [];
  for (let log = top; log >= bottom; log -= Math.max(1, Math.round((top - bottom) / 5))) ticks.push(log);
  return html`<svg
    class="plot"
    viewBox="0 0 ${W} ${H}"
    role="img"
    aria-label="Residual of each iteration, logarithmic"
    data-id="residual-plot"
    data-points=${good.length}
  >
    ${ticks.map(
      (log) => svg`<line x1=${LEFT} x2=${W - 8} y1=${y(log)} y2=${y(log)} stroke="var(--line)"></line>
      <text x=${LEFT - 6} y=${y(log) + 3.5} text-anchor="end">1e${String(log).replace('-', '−')}</text>`,
    )}
    ${svg`<line x1=${LEFT} x2=${W - 8} y1=${limit} y2=${limit} stroke="var(--good)" stroke-dasharray="4 3"></line>`}
    ${svg`<path d=${paths.join('')} fill="none" stroke="var(--accent)" stroke-width="1.5"
      stroke-linejoin="round"></path>`} ${svg`<text x=${(W + LEFT) / 2} y=${H - 5}
      text-anchor="middle">iterations, one line per attempt; dashed: tolerance</text>`}
  </svg>`;
}

/** Outlines of the face in the mid-sagittal plane, before and after, from the patient's right. Pairs of points in L. */
export function profilePlot(before: Float32Array, after: Float32Array): TemplateResult | null {
  const frame = before.length === 0 ? null : profileFrame([before, after]);
  if (!frame) return null;
  return html`<svg
    class="plot"
    viewBox=${viewBoxOf(frame)}
    .style=${'max-height:240px'}
    role="img"
    aria-label="Profile before and after, from the right"
  >
    ${svg`<path d=${profilePath(before, frame)} fill="none" stroke="var(--ink-3)" stroke-width="1.4"
        vector-effect="non-scaling-stroke" stroke-dasharray="4 3"></path>
      <path d=${profilePath(after, frame)} fill="none" stroke="var(--accent)" stroke-width="2"
        vector-effect="non-scaling-stroke"></path>`}
  </svg>`;
}
