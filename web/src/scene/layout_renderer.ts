import { WebGLRenderer, type Scene } from 'three';
import type { Body } from './body';
import type { CameraRig } from './camera_rig';
import { drawsInSoftware } from './software';
import type { Layout } from './view_events';

/**
 * Rendered pixels per CSS pixel in software: multisampling would cost four samples of every pixel, so edges are
 * smoothed by rendering at a higher resolution when nothing moves.
 */
const SOFTWARE_RATIO = { moving: 0.5, still: 2 };

export interface Size {
  width: number;
  height: number;
}

/** Renders the bodies of a layout: one picture, two with a divider, or several side by side. */
export class LayoutRenderer {
  private readonly renderer: WebGLRenderer;
  private readonly gl: WebGL2RenderingContext;
  private fence: WebGLSync | null = null;

  constructor(
    canvas: HTMLCanvasElement,
    private readonly scene: Scene,
    private readonly rig: CameraRig,
    private readonly bodies: ReadonlyMap<string, Body>,
  ) {
    this.renderer = new WebGLRenderer({
      canvas,
      antialias: !drawsInSoftware(),
      alpha: true,
      powerPreference: 'high-performance',
    });
    this.renderer.autoClear = false;
    // Waiting for the compiler's messages stops the page for a second in software.
    this.renderer.debug.checkShaderErrors = false;
    this.gl = this.renderer.getContext() as WebGL2RenderingContext;
  }

  /** True if the last picture is finished. Only one is rendered at a time, so that none pile up on slow graphics. */
  get isReady(): boolean {
    return !this.fence || this.gl.getSyncParameter(this.fence, this.gl.SYNC_STATUS) === this.gl.SIGNALED;
  }

  setSize({ width, height }: Size): void {
    this.renderer.setSize(width, height, false);
  }

  render(layout: Layout, { width, height }: Size, isCoarse: boolean): void {
    const { renderer } = this;
    const ratio = drawsInSoftware() ? SOFTWARE_RATIO[isCoarse ? 'moving' : 'still'] : Math.min(2, devicePixelRatio);
    if (renderer.getPixelRatio() !== ratio) renderer.setPixelRatio(ratio); // Clears the picture, so not before.
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, width, height);
    renderer.clear();
    if (layout.mode === 'single') renderer.render(this.scene, this.rig.camera);
    else if (layout.mode === 'wipe') {
      const at = Math.round(width * layout.fraction);
      renderer.setScissorTest(true);
      renderer.setScissor(0, 0, at, height);
      this.renderOnly(layout.left);
      renderer.setScissor(at, 0, width - at, height);
      this.renderOnly(layout.right);
    } else {
      const pane = Math.floor(width / layout.panes.length);
      this.rig.aspect = pane / height;
      renderer.setScissorTest(true);
      layout.panes.forEach(({ bodies }, n) => this.renderPane(n * pane, pane, height, bodies));
    }
  }

  /** Ends a picture. */
  flush(): void {
    if (this.fence) this.gl.deleteSync(this.fence);
    this.fence = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
  }

  private renderPane(x: number, width: number, height: number, names: readonly string[]): void {
    this.renderer.setViewport(x, 0, width, height);
    this.renderer.setScissor(x, 0, width, height);
    this.renderOnly(names);
  }

  private renderOnly(names: readonly string[]): void {
    for (const [name, body] of this.bodies) body.group.visible = names.includes(name);
    this.renderer.render(this.scene, this.rig.camera);
    for (const body of this.bodies.values()) body.group.visible = true;
  }
}
