import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { linearOf, mapVec3 } from '../src/model';

const folder = new URL('../src/ui/style/', import.meta.url);
const css = [...readFileSync(new URL('index.css', folder), 'utf8').matchAll(/@import '(.*)'/g)]
  .map(([, file]) => readFileSync(new URL(file, folder), 'utf8'))
  .join('\n')
  .replace(/\/\*[\s\S]*?\*\//g, '');

/** The colors that a rule sets as variables. */
function variables(selector: string): Map<string, string> {
  const at = css.indexOf(`${selector} {`);
  const body = css.slice(css.indexOf('{', at) + 1, css.indexOf('}', at));
  return new Map([...body.matchAll(/--([\w-]+):\s*(#[0-9a-f]{6})\s*;/g)].map((m) => [m[1], m[2]]));
}

const light = variables('\n:root');
const themes = { light, dark: new Map([...light, ...variables(":root[data-theme='dark']")]) };

/** WCAG 2.2, contrast ratio of two colors. */
function contrast(a: string, b: string): number {
  const luminance = (hex: string): number => {
    const [r, g, b] = linearOf(mapVec3([1, 3, 5], (n) => parseInt(hex.slice(n, n + 2), 16) / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [high, low] = [luminance(a), luminance(b)].sort((x, y) => y - x);
  return (high + 0.05) / (low + 0.05);
}

interface Rule {
  selector: string;
  color: string;
  background: string | null;
}

/** Rules that set the color of text, with the ground they set beside it, if they do. */
const rules: Rule[] = [...css.matchAll(/([^{}]+)\{([^{}]*)\}/g)].flatMap(([, selector, body]) => {
  const color = /(?:^|[;\s])color:\s*var\(--([\w-]+)\)/.exec(body)?.[1];
  if (!color) return [];
  return [
    {
      selector: selector.trim(),
      color,
      background: /background(?:-color)?:\s*var\(--([\w-]+)\)/.exec(body)?.[1] ?? null,
    },
  ];
});

/** Grounds that text may stand on where its rule sets none. */
const GROUNDS = ['ground', 'panel', 'raised', 'sunken'];
const VIEW_GROUNDS = ['view-top', 'view-bottom'];

const groundsOf = ({ color, background }: Rule): string[] =>
  background
    ? [background]
    : color === 'view-ink'
      ? VIEW_GROUNDS
      : color.endsWith('-ink')
        ? [color.slice(0, -4)]
        : GROUNDS;

describe('contrast', () => {
  it('is computed as in WCAG', () => {
    expect(contrast('#000000', '#ffffff')).toBeCloseTo(21, 5);
    expect(contrast('#777777', '#ffffff')).toBeCloseTo(4.48, 2);
  });

  it('finds the colors', () => {
    expect(light.size).toBeGreaterThan(20);
    expect(variables(":root[data-theme='dark']").size).toBe(light.size);
    expect(rules.length).toBeGreaterThan(25);
  });

  for (const [theme, colors] of Object.entries(themes)) {
    it(`of text is at least 4.5 in the ${theme} theme`, () => {
      const poor = rules.flatMap((rule) =>
        groundsOf(rule).flatMap((ground) => {
          const ratio = contrast(colors.get(rule.color)!, colors.get(ground)!);
          return ratio < 4.5 ? [`${rule.selector}: --${rule.color} on --${ground} has ${ratio.toFixed(2)}`] : [];
        }),
      );
      expect(poor).toEqual([]);
    });

    it(`of notices is at least 4.5 in the ${theme} theme`, () => {
      for (const kind of ['good', 'warn', 'bad', 'accent'])
        for (const ink of [kind, 'ink', 'ink-2'])
          expect(
            contrast(colors.get(ink)!, colors.get(`${kind}-soft`)!),
            `--${ink} on --${kind}-soft`,
          ).toBeGreaterThanOrEqual(4.5);
    });

    it(`of other elements is at least 3 in the ${theme} theme`, () => {
      // Focus rings, switches and lines of plots; the edge of a field.
      for (const mark of ['accent', 'good', 'warn', 'bad', 'ink-3', 'edge'])
        for (const ground of GROUNDS)
          expect(contrast(colors.get(mark)!, colors.get(ground)!), `--${mark} on --${ground}`).toBeGreaterThanOrEqual(
            3,
          );
    });
  }
});
