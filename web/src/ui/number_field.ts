import { html, nothing, type TemplateResult } from 'lit-html';
import { fixed, parseNumber } from '../model';
import { liveValue } from './live_value';

export interface NumberOptions {
  label: string;
  /** Null: empty. */
  value: number | null;
  unit: string;
  digits?: number;
  step?: number;
  min?: number;
  max?: number;
  hint?: string;
  disabled?: boolean;
  id?: string;
  /** `gesture` is the same for all steps of one key press or turn of the wheel. */
  onInput: (value: number) => void;
  onDone?: () => void;
  /** The field was emptied; without it, it must have a number. */
  onClear?: () => void;
}

/** A number with its unit: typed, or stepped with the arrow keys (Shift: ten steps). Invalid input is only marked. */
export function numberField(o: NumberOptions): TemplateResult {
  const digits = o.digits ?? 1;
  const step = o.step ?? 0.5;
  const clamp = (value: number) => Math.min(o.max ?? Infinity, Math.max(o.min ?? -Infinity, value));
  const shown = o.value === null ? '' : fixed(o.value, digits);
  const take = (input: HTMLInputElement): void => {
    if (o.onClear && input.value.trim() === '') {
      input.setAttribute('aria-invalid', 'false');
      o.onClear();
      return;
    }
    const value = parseNumber(input.value);
    const good = value !== null && value === clamp(value);
    input.setAttribute('aria-invalid', String(!good));
    if (good) o.onInput(value);
  };
  return html`
    <label class="number">
      <span class="number-label">${o.label}${o.hint ? html`<small>${o.hint}</small>` : nothing}</span>
      <span class="number-box">
        <input
          inputmode="decimal"
          data-id=${o.id ?? nothing}
          ?disabled=${o.disabled ?? false}
          ${liveValue(shown)}
          @input=${(e: Event) => ((e.target as HTMLInputElement).dataset.typing = '')}
          @change=${(e: Event) => {
            delete (e.target as HTMLInputElement).dataset.typing;
            take(e.target as HTMLInputElement);
            o.onDone?.();
          }}
          @blur=${(e: Event) => {
            const input = e.target as HTMLInputElement;
            delete input.dataset.typing;
            if (input.getAttribute('aria-invalid') === 'true') input.value = shown;
            input.setAttribute('aria-invalid', 'false');
          }}
          @keydown=${(e: KeyboardEvent) => {
            if (e.key === 'Enter') (e.target as HTMLInputElement).blur();
            const sign = e.key === 'ArrowUp' ? 1 : e.key === 'ArrowDown' ? -1 : 0;
            if (sign === 0) return;
            e.preventDefault();
            delete (e.target as HTMLInputElement).dataset.typing;
            const now = parseNumber((e.target as HTMLInputElement).value) ?? o.value ?? 0;
            o.onInput(clamp(Math.round((now + sign * step * (e.shiftKey ? 10 : 1)) * 1e6) / 1e6));
          }}
          @focus=${(e: Event) => (e.target as HTMLInputElement).select()}
        /><span class="unit">${o.unit}</span>
      </span>
    </label>
  `;
}
