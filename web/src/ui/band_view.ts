import { bandSection, midsagittalX, roundQuarters, SKIN, type BandSection } from '../model';
import type { View3d } from '../scene';
import type { App } from './app';
import { saveBlob } from './download';
import { stageOf, type State } from './state';

/** Draws the uncertainty of the prediction: the median face, colored by the width of the band. */
export class BandView {
  private painted: unknown = null;
  private section: BandSection | null = null;

  constructor(
    private readonly view: View3d,
    private readonly app: App,
  ) {}

  surfaceChanged(name: string): void {
    if (name !== 'band') return;
    this.painted = null;
    this.section = null;
  }

  present(): void {
    this.view.setLayout({ mode: 'single' });
    const body = this.view.body('band');
    const band = this.app.model.surfaces.get('band')?.band;
    if (!body || !band || this.painted === body) return;
    this.painted = body;
    this.view.setOpacity('band', 1);
    const bandTop_mm = roundQuarters(band.width_mm.reduce((a, b) => Math.max(a, b), 0));
    // Skin that the mesh does not move has the width 0 and the color of skin.
    body.setValues(band.width_mm, 'distance', 0, bandTop_mm, SKIN);
    this.app.patch({ bandTop_mm });
    this.view.render();
  }

  /** The band in the mid-sagittal plane; null without a band. */
  profile(): BandSection | null {
    const found = this.app.model.surfaces.get('band');
    if (!found?.band) return null;
    const { surface, band } = found;
    this.section ??= bandSection(
      surface,
      band,
      [midsagittalX(this.app.model.doc.landmarks, surface.points), 0, 0],
      [1, 0, 0],
    );
    return this.section;
  }

  savePicture(s: State): void {
    const ground = getComputedStyle(document.documentElement).getPropertyValue('--view-top').trim();
    const stale = stageOf(s, 'uncertainty').state === 'stale' ? ' OUT OF DATE.' : '';
    this.view
      .snapshot(
        `Band width P95 − P5, light to dark: 0 to ${s.bandTop_mm.toFixed(1)} mm; named inputs only.${stale} ` +
          'Research software. A simulation, not for clinical use.',
        ground,
      )
      .toBlob((blob) => blob && saveBlob(blob, 'uncertainty.png'), 'image/png');
  }
}
