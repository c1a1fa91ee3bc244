import { midsagittalX, sectionOf, translatedTo, vertexAt, vertexNear, type Mat4, type Vec3 } from '../model';
import type { Body } from '../scene';
import type { App } from './app';
import { messageOf } from './errors';
import { stageOf } from './state';

/** A press further than this from the profile picks nothing [mm]. */
const REACH_MM = 8;

/** A point of the skin that is dragged on the profile; the selected segment follows by the preview. */
export class ProfileDrag {
  private vertex: number | null = null;
  private wanted: [number, number] | null = null;
  private running = false;
  private isHeld = false;
  private gesture = 0;

  constructor(
    private readonly app: App,
    private readonly skin: () => Body | undefined,
  ) {}

  /** Whether the shown pose is that of the move, so that it can follow. */
  get isReady(): boolean {
    const { s } = this.app.model;
    return s.showPreview && stageOf(s, 'preview').state === 'fresh' && !!this.skin() && !!this.app.move();
  }

  /** Outlines of the skin before surgery and as the preview shows it. */
  outlines(): { before: Float32Array; after: Float32Array; x: number } | null {
    const skin = this.skin();
    if (!skin) return null;
    const x = midsagittalX(this.app.model.doc.landmarks, skin.surface.points);
    const point: Vec3 = [x, 0, 0];
    const shown = { points: skin.points, triangles: skin.surface.triangles };
    return { before: sectionOf(skin.surface, point, [1, 0, 0]), after: sectionOf(shown, point, [1, 0, 0]), x };
  }

  /** Picks the point of the shown profile at y and z. */
  start(y: number, z: number): void {
    const skin = this.skin();
    const profile = this.outlines();
    this.vertex = skin && profile ? vertexNear(skin.points, [profile.x, y, z], REACH_MM) : null;
    if (!skin || this.vertex === null) return;
    this.gesture++;
    this.isHeld = true;
    const [, atY, atZ] = vertexAt(skin.points, this.vertex);
    this.app.patch({ profilePoint: { wanted: [atY, atZ], reached: [atY, atZ], state: 'shown', why: '' } });
  }

  move(y: number, z: number): void {
    const { profilePoint } = this.app.model.s;
    if (!this.isHeld || !profilePoint) return;
    this.wanted = [y, z];
    this.app.patch({ profilePoint: { ...profilePoint, wanted: [y, z], state: 'waiting' } });
    if (!this.running) void this.follow();
  }

  end(): void {
    this.isHeld = false;
    if (!this.running) this.app.settle();
  }

  /** Fits the segment to the newest wanted position until there is no newer one. */
  private async follow(): Promise<void> {
    const { app } = this;
    this.running = true;
    while (this.wanted && this.vertex !== null) {
      const wanted = this.wanted;
      this.wanted = null;
      const skin = this.skin();
      const segment = app.model.doc.plan.segments[app.model.s.segment];
      const move = app.move();
      if (!skin || !segment || !move) break;
      const rest = vertexAt(skin.surface.points, this.vertex);
      try {
        const fit = await app.client.previewFit({
          poses: app.cutPoses(),
          segment: segment.name,
          vertex: this.vertex,
          displacement_mm: [0, wanted[0] - rest[1], wanted[1] - rest[2]],
          free: ['anterior', 'superior'],
        });
        app.setMove(translatedTo(move, fit.pose as unknown as Mat4), `profile-${this.gesture}`);
        this.report(fit.at_limit ? 'limit' : 'shown', '', [
          rest[1] + fit.displacement_mm[1],
          rest[2] + fit.displacement_mm[2],
        ]);
      } catch (error) {
        this.report('failed', messageOf(error), null);
      }
    }
    this.running = false;
    if (!this.isHeld) app.settle();
  }

  private report(state: 'shown' | 'limit' | 'failed', why: string, reached: [number, number] | null): void {
    const { profilePoint } = this.app.model.s;
    if (!profilePoint) return;
    const next = this.wanted ? 'waiting' : state;
    this.app.patch({ profilePoint: { ...profilePoint, reached: reached ?? profilePoint.reached, state: next, why } });
  }
}
