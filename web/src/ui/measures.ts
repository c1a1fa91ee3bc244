import {
  faultOfNumber,
  guideParameters,
  requestParameters,
  splintParameters,
  toothRows,
  withNervePoint,
  withoutNervePoint,
  withToothNumber,
  type NervePoints,
  type Vec3,
} from '../model';
import type { Schemas } from '../api';
import type { MeasureState, PictureName } from './measure_state';
import type { Planner } from './planner_context';
import { stageOf } from './state';

type StageName = keyof Schemas['Case']['stages'];

const RADIOGRAPHS: readonly PictureName[] = ['tracing.png', 'lateral.png', 'frontal.png'];

/** Teeth and measures, read from the server, and the user's corrections. */
export class Measures {
  /** ETag of each document when it was read. */
  private readonly etags = new Map<string, string | null>();
  private numbersEtag: string | null = null;
  private pointsEtag: string | null = null;
  /** Corrections are sent one after the other. */
  private writing: Promise<unknown> = Promise.resolve();

  constructor(private readonly planner: Planner) {}

  /** Reads what has changed since. */
  async load(): Promise<void> {
    const { client } = this.planner;
    await Promise.all([
      this.document('teeth', async () => ({ teeth: await client.teeth() }), { teeth: null }),
      this.document('arches', async () => ({ arches: await client.arches() }), { arches: null }),
      this.document('occlusion', async () => ({ occlusion: await client.occlusion() }), { occlusion: null }),
      this.splint('final'),
      this.splint('intermediate'),
      this.document('nerve', async () => ({ nerve: await client.nerve() }), { nerve: null }),
      this.document('guides', async () => ({ guides: await client.guides() }), { guides: null }),
      this.document('airway', async () => ({ airway: await client.airway() }), { airway: null }, ['airway.svg']),
      this.document(
        'cephalogram',
        async () => ({ cephalogram: await client.cephalogram() }),
        { cephalogram: null },
        RADIOGRAPHS,
      ),
      this.loadCorrections(),
    ]);
  }

  private async document(
    stage: StageName,
    read: () => Promise<Partial<MeasureState>>,
    none: Partial<MeasureState>,
    pictures: readonly PictureName[] = [],
  ): Promise<void> {
    const { planner } = this;
    const { etag } = stageOf(planner.model.s, stage);
    if ((this.etags.get(stage) ?? null) === etag) return;
    this.etags.set(stage, etag);
    const found = etag === null ? none : ((await planner.attempt(read)) ?? none);
    const urls = await Promise.all(pictures.map((name) => this.picture(name, etag)));
    if (this.etags.get(stage) !== etag) return; // A newer one is being read.
    const { s } = planner.model;
    const before = pictures.map((name) => s.pictures[name]);
    planner.patch({
      ...found,
      pictures: { ...s.pictures, ...Object.fromEntries(pictures.map((name, n) => [name, urls[n]])) },
    });
    for (const url of before) if (url) URL.revokeObjectURL(url);
  }

  private async splint(splint: 'final' | 'intermediate'): Promise<void> {
    const { planner } = this;
    const into = (found: Schemas['Splint'] | null): Partial<MeasureState> => ({
      splints: { ...planner.model.s.splints, [splint]: found },
    });
    const stage = `splint_${splint}` as const;
    const { etag } = stageOf(planner.model.s, stage);
    if ((this.etags.get(stage) ?? null) === etag) return;
    this.etags.set(stage, etag);
    const found = etag === null ? null : await planner.attempt(() => planner.client.splint(splint));
    if (this.etags.get(stage) === etag) planner.patch(into(found));
  }

  private async picture(name: PictureName, etag: string | null): Promise<string | undefined> {
    if (etag === null) return undefined;
    const blob = await this.planner.client.file(name).catch(() => null);
    const type = name.endsWith('.svg') ? 'image/svg+xml' : 'image/png';
    return blob ? URL.createObjectURL(blob.slice(0, blob.size, type)) : undefined;
  }

  private async loadCorrections(): Promise<void> {
    const { client } = this.planner;
    await this.writing;
    await this.planner.attempt(async () => {
      const [numbers, points] = await Promise.all([client.toothCorrections(), client.nervePoints()]);
      this.numbersEtag = numbers.etag;
      this.pointsEtag = points.etag;
      this.planner.patch({ toothCorrections: numbers.value.corrections, nervePoints: points.value.points });
    });
  }

  /** Corrects the number of a tooth; 0: not a tooth. */
  async setNumber(found: number, fdi: number): Promise<void> {
    const { planner } = this;
    const { s } = planner.model;
    const rows = toothRows(s.teeth?.teeth ?? [], s.toothCorrections);
    const toothFault = faultOfNumber(rows, found, fdi);
    planner.patch({ toothFault });
    if (toothFault !== null) return;
    const toothCorrections = withToothNumber(s.toothCorrections, found, fdi);
    planner.patch({ toothCorrections });
    await this.write(async () => {
      this.numbersEtag = await planner.client.putToothCorrections(toothCorrections, this.numbersEtag ?? '*');
    });
  }

  /** Shows a point of a canal while it is dragged; stores it at the end. */
  dragPoint(name: string, position: Vec3, isEnd: boolean): void {
    const { s } = this.planner.model;
    if (!s.nerve) return;
    if (!isEnd) {
      this.planner.patch({ nerveDrag: { name, position_mm: position } });
      return;
    }
    const points = withNervePoint(s.nervePoints, name, position, s.nerve);
    const at = Object.entries(points).find(([, p]) => p.every((v, n) => Math.abs(v - position[n]) < 0.01))?.[0];
    this.planner.patch({ nervePoints: points, nervePoint: at ?? null, nerveDrag: null, cursor_L: position });
    void this.putPoints(points);
  }

  async removePoint(name: string): Promise<void> {
    const points = withoutNervePoint(this.planner.model.s.nervePoints, name);
    this.planner.patch({ nervePoints: points, nervePoint: null });
    await this.putPoints(points);
  }

  private putPoints(points: NervePoints): Promise<void> {
    const plain = Object.fromEntries(Object.entries(points).map(([name, at]) => [name, [...at]]));
    return this.write(async () => {
      this.pointsEtag = await this.planner.client.putNervePoints(plain, this.pointsEtag ?? '*');
    });
  }

  /** Sends a correction; after an error, the server's are shown. */
  private write(send: () => Promise<void>): Promise<void> {
    const done = this.writing.then(async () => {
      const isSent = await this.planner.attempt(async () => {
        await send();
        return true;
      });
      return isSent;
    });
    this.writing = done;
    return done.then((isSent) => (isSent ? undefined : this.loadCorrections()));
  }

  /** Registers the chosen scans, or those of an earlier job again. */
  async register(): Promise<void> {
    const { planner } = this;
    const { archFiles } = planner.model.s;
    const request: Schemas['JobRequest'] = { kind: 'arches' };
    for (const jaw of ['upper', 'lower'] as const) {
      const file = archFiles[jaw];
      if (!file) continue;
      const upload = await planner.upload([file]);
      if (upload === null) return;
      request[jaw] = upload;
    }
    await planner.run(request, () => planner.patch({ archFiles: { upper: null, lower: null } }));
  }

  /** Finds the occlusion from what was chosen; bite scans are uploaded first. */
  async findOcclusion(): Promise<void> {
    const { planner } = this;
    const { occlusionSource: source, occlusionRequests, biteFiles } = planner.model.s;
    if (source === 'search') {
      await planner.run({ kind: 'occlusion', source, ...requestParameters(occlusionRequests) });
      return;
    }
    if (source === 'as_scanned') {
      await planner.run({ kind: 'occlusion', source });
      return;
    }
    const uploads: string[] = [];
    for (const file of [biteFiles.bite, biteFiles.bite2]) {
      if (!file) continue;
      const upload = await planner.upload([file]);
      if (upload === null) return;
      uploads.push(upload);
    }
    const [bite, bite2] = uploads as [string?, string?];
    if (bite === undefined) return;
    await planner.run({ kind: 'occlusion', source, bite, ...(bite2 === undefined ? {} : { bite2 }) });
  }

  async makeGuides(segment: string | null): Promise<void> {
    const { guideSettings } = this.planner.model.s;
    await this.planner.run({ kind: 'guides', ...guideParameters({ ...guideSettings, segment }) });
  }

  async makeSplint(segment: string | null): Promise<void> {
    const { splintSettings } = this.planner.model.s;
    const { splint } = splintSettings;
    const parameters = splintParameters(splintSettings);
    await this.planner.run(
      splint === 'final'
        ? { kind: 'splint', splint, ...parameters }
        : { kind: 'splint', splint, ...parameters, ...(segment === null ? {} : { segment }) },
    );
  }
}
