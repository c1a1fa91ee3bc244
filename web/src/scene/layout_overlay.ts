import type { Size } from './layout_renderer';
import { drawTag, drawWipe } from './overlay';
import type { Layout } from './view_events';

/** Height of a caption below a picture. */
const CAPTION_PX = 28;

/** Width of a picture below which its name does not fit beside the buttons of the view, and a height below them. */
const NARROW_PX = 200;
const BELOW_BUTTONS_PX = 204;

/** Draws the names of several pictures and the lines between them. */
export function drawDivider(
  context: CanvasRenderingContext2D,
  layout: Layout,
  { width, height }: Size,
  ink: string,
): void {
  if (layout.mode === 'single') return;
  if (layout.mode === 'wipe') {
    const middle = width * layout.fraction;
    drawWipe(context, middle, height);
    drawTag(context, layout.names[0], middle - 12, 'right');
    drawTag(context, layout.names[1], middle + 12, 'left');
    return;
  }
  const pane = width / layout.panes.length;
  layout.panes.forEach(({ name }, n) => {
    // The name of the first is at its right end: banners are at its left.
    const y = pane < NARROW_PX ? BELOW_BUTTONS_PX : undefined;
    if (n === 0) drawTag(context, name, pane - 12, 'right', y);
    else drawTag(context, name, n * pane + 12, 'left', y);
    if (n === 0) return;
    context.fillStyle = ink;
    context.globalAlpha = 0.25;
    context.fillRect(n * pane - 0.5, 0, 1, height);
    context.globalAlpha = 1;
  });
}

/** Canvases on top of each other, with a line of text below them. */
export function withCaption(
  layers: readonly HTMLCanvasElement[],
  { width, height }: Size,
  caption: string,
  background: string,
  ink: string,
): HTMLCanvasElement {
  const picture = document.createElement('canvas');
  picture.width = width;
  picture.height = height + CAPTION_PX;
  const context = picture.getContext('2d')!;
  context.fillStyle = background;
  context.fillRect(0, 0, width, height + CAPTION_PX);
  for (const layer of layers) context.drawImage(layer, 0, 0, width, height);
  context.fillStyle = ink;
  context.font = '12px "Inter Variable", sans-serif';
  context.textBaseline = 'middle';
  context.fillText(caption, 12, height + CAPTION_PX / 2);
  return picture;
}
