import { noChange } from 'lit-html';
import { Directive, directive, PartType, type ElementPart, type PartInfo } from 'lit-html/directive.js';

/** Sets an input's text, except while the user types in it. */
class LiveValue extends Directive {
  constructor(info: PartInfo) {
    super(info);
    if (info.type !== PartType.ELEMENT) throw new Error('liveValue stands in the tag itself');
  }

  render(_value: string): typeof noChange {
    return noChange;
  }

  override update(part: ElementPart, [value]: [string]): typeof noChange {
    const input = part.element as HTMLInputElement;
    if (input.dataset.typing === undefined && input.value !== value) input.value = value;
    return noChange;
  }
}

export const liveValue = directive(LiveValue);
