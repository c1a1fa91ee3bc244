import { ContractError, parse, type Schemas } from './contract';
import { EventParser } from './events';
import { decodeSurface, type WireSurface } from './surface';

/** A request that the server refused; the message is a sentence for the user. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
    readonly where = '',
  ) {
    super(message);
  }
}

/** A value with its ETag, which replaces it only if it is unchanged. */
export interface Tagged<T> {
  value: T;
  etag: string;
}

export interface Depths {
  /** Depth of each vertex of a segment in other bone [mm], 0 outside. */
  bySegment: Map<string, Float32Array>;
  deepest_mm: number;
  depthIsLowerBound: boolean;
}

/** First voxel along i, j, k, then the counts. */
export type VoxelBox = readonly [number, number, number, number, number, number];

export type Poses = Record<string, readonly number[]>;

export type CaseEvents = {
  job: Schemas['JobEvent'];
  newton: Schemas['NewtonEvent'];
  step: Schemas['StepEvent'];
  case: Schemas['CaseEvent'];
  reset: Schemas['ResetEvent'];
};

const EVENT_SCHEMA = {
  job: 'JobEvent',
  newton: 'NewtonEvent',
  step: 'StepEvent',
  case: 'CaseEvent',
  reset: 'ResetEvent',
} as const;

export class Client {
  constructor(
    private readonly base: string,
    private readonly token: string,
  ) {}

  private async send(
    method: string,
    path: string,
    init: RequestInit & { headers?: Record<string, string> } = {},
  ): Promise<Response> {
    let response: Response;
    try {
      response = await fetch(this.base + path, {
        ...init,
        method,
        cache: 'no-store',
        headers: { 'X-Lefort-Token': this.token, ...init.headers },
      });
    } catch (error) {
      if (init.signal?.aborted) throw error;
      throw new ApiError(0, 'unreachable', 'The server does not respond. Check that lefort serve is running.');
    }
    if (response.ok) return response;
    let refusal: Schemas['Error']['error'];
    try {
      refusal = parse('Error', await response.json()).error;
    } catch {
      throw new ApiError(
        response.status,
        'unknown',
        `The server refused the request (status ${response.status}) without a reason.`,
      );
    }
    throw new ApiError(response.status, refusal.code, refusal.message, refusal.where);
  }

  private async get<Name extends keyof Schemas>(name: Name, path: string): Promise<Schemas[Name]> {
    return parse(name, await (await this.send('GET', path)).json());
  }

  private async getTagged<Name extends keyof Schemas>(name: Name, path: string): Promise<Tagged<Schemas[Name]>> {
    const response = await this.send('GET', path);
    return { value: parse(name, await response.json()), etag: etagOf(response) };
  }

  /** The same of a resource that may have no version yet. */
  private async getIfTagged<Name extends keyof Schemas>(
    name: Name,
    path: string,
  ): Promise<{ value: Schemas[Name]; etag: string | null }> {
    const response = await this.send('GET', path);
    return { value: parse(name, await response.json()), etag: response.headers.get('ETag') };
  }

  private json(method: string, path: string, body: unknown, headers: Record<string, string> = {}): Promise<Response> {
    return this.send(method, path, {
      body: JSON.stringify(body),
      headers: { 'Content-Type': 'application/json', ...headers },
    });
  }

  case = () => this.get('Case', '/case');
  jobs = async () => (await this.get('JobList', '/jobs')).jobs;
  job = (id: number) => this.get('Job', `/jobs/${id}`);
  solveHistory = (job: number) => this.get('SolveHistory', `/jobs/${job}/iterates`);
  volume = () => this.get('Volume', '/volume');
  labels = () => this.get('Labels', '/labels');
  boundary = () => this.get('Boundary', '/boundary');
  surfaces = async () => (await this.get('SurfaceList', '/surfaces')).surfaces;
  prediction = () => this.get('Prediction', '/prediction');
  previewDistance = () => this.get('PreviewDistance', '/preview/distance');
  comparison = () => this.get('Comparison', '/comparison');
  uncertainty = () => this.get('Uncertainty', '/uncertainty');
  teeth = () => this.get('Teeth', '/teeth');
  toothCorrections = () => this.getIfTagged('ToothCorrections', '/teeth/corrections');
  arches = () => this.get('Arches', '/arches');
  occlusion = () => this.get('Occlusion', '/occlusion');
  splint = (splint: 'final' | 'intermediate') => this.get('Splint', `/splints/${splint}`);
  nerve = () => this.get('Nerve', '/nerve');
  nervePoints = () => this.getIfTagged('NervePoints', '/nerve/points');
  guides = () => this.get('Guides', '/guides');
  airway = () => this.get('Airway', '/airway');
  variants = () => this.get('VariantList', '/variants');
  sideBySide = () => this.get('SideBySide', '/side-by-side');
  cephalogram = () => this.get('Cephalogram', '/cephalogram');
  stepRegions = (step: number) => this.get('RegionShifts', `/prediction/steps/${step}/regions`);
  files = async () => (await this.get('FileList', '/files')).files;
  plan = () => this.getTagged('Plan', '/plan');
  landmarks = () => this.getTagged('Landmarks', '/landmarks');
  planPoses = (count: number) => this.get('PlanPoses', `/plan/poses?count=${count}`);

  async startJob(request: Schemas['JobRequest']): Promise<Schemas['Job']> {
    return parse('Job', await (await this.json('POST', '/jobs', request)).json());
  }

  async stopJob(id: number): Promise<void> {
    await this.send('DELETE', `/jobs/${id}`);
  }

  /** Uploads the files of one scan in sequence; reports the number of bytes sent. */
  async upload(files: readonly File[], onProgress: (sentBytes: number) => void): Promise<string> {
    const { id } = parse('Upload', await (await this.send('POST', '/uploads')).json());
    let sent = 0;
    try {
      for (let index = 0; index < files.length; index++) {
        const file = files[index];
        await this.send(
          'PUT',
          `/uploads/${id}/files/${index}?name=${encodeURIComponent(endingOnly(file.name, index))}`,
          {
            body: file,
            headers: { 'Content-Type': 'application/octet-stream' },
          },
        );
        sent += file.size;
        onProgress(sent);
      }
    } catch (error) {
      await this.send('DELETE', `/uploads/${id}`).catch(() => undefined);
      throw error;
    }
    return id;
  }

  async volumeData(): Promise<Int16Array> {
    return new Int16Array(await (await this.send('GET', '/volume/data')).arrayBuffer());
  }

  async labelsData(): Promise<Tagged<Uint8Array>> {
    const response = await this.send('GET', '/labels/data');
    return { value: new Uint8Array(await response.arrayBuffer()), etag: etagOf(response) };
  }

  async putLabels(labels: Uint8Array, etag: string): Promise<string> {
    const body = new Blob([labels as Uint8Array<ArrayBuffer>]);
    const response = await this.send('PUT', '/labels/data', {
      body,
      headers: { 'Content-Type': 'application/octet-stream', 'If-Match': etag },
    });
    return etagOf(response);
  }

  /** Paint on the tissue boundary, within its bounding box. */
  async boundaryData(): Promise<Tagged<Uint8Array> & { box: VoxelBox }> {
    const response = await this.send('GET', '/boundary/data');
    const box = toVoxelBox(response.headers.get('X-Lefort-Box') ?? '');
    const value = new Uint8Array(await response.arrayBuffer());
    if (value.length !== box[3] * box[4] * box[5])
      throw new ContractError('the painted box and its voxels differ in size');
    return { value, etag: etagOf(response), box };
  }

  async putBoundaryData(labels: Uint8Array, box: VoxelBox, etag: string): Promise<string> {
    const response = await this.send('PUT', `/boundary/data?box=${box.join(',')}`, {
      body: new Blob([labels as Uint8Array<ArrayBuffer>]),
      headers: { 'Content-Type': 'application/octet-stream', 'If-Match': etag },
    });
    return etagOf(response);
  }

  async putBoundaryFile(file: File, etag: string): Promise<void> {
    await this.send('PUT', '/boundary/file', {
      body: file,
      headers: { 'Content-Type': 'application/octet-stream', 'If-Match': etag },
    });
  }

  async deleteBoundaryData(etag: string): Promise<void> {
    await this.send('DELETE', '/boundary/data', { headers: { 'If-Match': etag } });
  }

  /** `name` as GET /surfaces lists it: skin, or segments/midface. */
  async surface(name: string): Promise<WireSurface> {
    const response = await this.send('GET', `/surfaces/${name}`);
    const scalars = (response.headers.get('X-Lefort-Scalars') ?? '').split(',').filter(Boolean);
    return decodeSurface(await response.arrayBuffer(), scalars);
  }

  async putPlan(plan: unknown, etag: string): Promise<Tagged<Schemas['PlanStored']>> {
    const response = await this.json('PUT', '/plan', plan, { 'If-Match': etag });
    return { value: parse('PlanStored', await response.json()), etag: etagOf(response) };
  }

  async putLandmarks(landmarks: Schemas['Landmarks'], etag: string): Promise<string> {
    return etagOf(await this.json('PUT', '/landmarks', landmarks, { 'If-Match': etag }));
  }

  /** Keeps the checked plan as a variant. */
  async keepVariant(name: string): Promise<Schemas['VariantList']> {
    return parse('VariantList', await (await this.json('POST', '/variants', { name })).json());
  }

  /** Makes a variant the plan of the case; `etag` is that of the plan to replace. */
  async loadVariant(name: string, etag: string): Promise<void> {
    await this.send('POST', `/variants/${encodeURIComponent(name)}/load`, { headers: { 'If-Match': etag } });
  }

  async deleteVariant(name: string): Promise<void> {
    await this.send('DELETE', `/variants/${encodeURIComponent(name)}`);
  }

  /** Returns the new ETag; null if there are no corrections now. */
  async putToothCorrections(
    corrections: Schemas['ToothCorrections']['corrections'],
    etag: string,
  ): Promise<string | null> {
    const body: Schemas['ToothCorrections'] = { lefort_tooth_corrections: 1, corrections };
    const response = await this.json('PUT', '/teeth/corrections', body, { 'If-Match': etag });
    return response.headers.get('ETag');
  }

  /** Returns the new ETag; null if there are no points now. */
  async putNervePoints(points: Schemas['Points'], etag: string): Promise<string | null> {
    const response = await this.json('PUT', '/nerve/points', { points }, { 'If-Match': etag });
    return response.headers.get('ETag');
  }

  async measure(
    before: Schemas['Points'],
    after?: Schemas['Points'],
  ): Promise<Schemas['Measurements']['measurements']> {
    const body = after ? { before, after } : { before };
    return parse('Measurements', await (await this.json('POST', '/measurements', body)).json()).measurements;
  }

  async placeTemplate(request: Schemas['OsteotomyRequest']): Promise<Schemas['Osteotomy']['osteotomy']> {
    return parse('Osteotomy', await (await this.json('POST', '/osteotomies', request)).json()).osteotomy;
  }

  async depths(poses: Poses, signal?: AbortSignal): Promise<Depths> {
    const response = await this.send('POST', '/poses', {
      body: JSON.stringify({ poses }),
      headers: { 'Content-Type': 'application/json' },
      signal,
    });
    const all = new Float32Array(await response.arrayBuffer());
    const bySegment = new Map<string, Float32Array>();
    let at = 0;
    for (const entry of (response.headers.get('X-Lefort-Segments') ?? '').split(',').filter(Boolean)) {
      const [name, count] = entry.split('=');
      bySegment.set(name, all.subarray(at, at + Number(count)));
      at += Number(count);
    }
    if (at !== all.length) throw new ContractError('the server sent more depths than vertices');
    return {
      bySegment,
      deepest_mm: Number(response.headers.get('X-Lefort-Deepest-Mm') ?? 0),
      depthIsLowerBound: response.headers.get('X-Lefort-Depth-Is-Lower-Bound') === '1',
    };
  }

  /**
   * Displacement of each vertex of the skin [mm], flat xyz. A preview, not a prediction. `dragging`: the face follows
   * the bones, without its equilibrium.
   */
  async preview(poses: Poses, dragging: boolean, signal?: AbortSignal): Promise<Float32Array> {
    const response = await this.send('POST', '/preview', {
      body: JSON.stringify({ poses, dragging }),
      headers: { 'Content-Type': 'application/json' },
      signal,
    });
    return new Float32Array(await response.arrayBuffer());
  }

  /** The translation of a segment that brings a point of the previewed skin to a wanted displacement. */
  async previewFit(
    request: Omit<Schemas['PreviewFitRequest'], 'poses'> & { poses: Poses },
  ): Promise<Schemas['PreviewFit']> {
    return parse('PreviewFit', await (await this.json('POST', '/preview/fit', request)).json());
  }

  /** Displacement of each vertex of surface skin_before at a step, from 1 [mm], flat xyz. */
  async predictionStep(step: number): Promise<Float32Array> {
    return new Float32Array(await (await this.send('GET', `/prediction/steps/${step}`)).arrayBuffer());
  }

  /** One value per vertex of a surface; NaN where there is none. With several segments, each has its own contact. */
  async values(name: Schemas['ValuesName'], segment?: string): Promise<Float32Array> {
    const query = segment === undefined ? '' : `?segment=${encodeURIComponent(segment)}`;
    return new Float32Array(await (await this.send('GET', `/values/${name}${query}`)).arrayBuffer());
  }

  async file(name: string): Promise<Blob> {
    return (await this.send('GET', `/files/${encodeURIComponent(name)}`)).blob();
  }

  /** Receives events until the signal is aborted; after an interruption, continues behind the last event. */
  async listen(
    on: <Kind extends keyof CaseEvents>(kind: Kind, event: CaseEvents[Kind]) => void,
    onConnection: (connected: boolean, error: ApiError | null) => void,
    signal: AbortSignal,
  ): Promise<void> {
    let last: string | null = null;
    let wait_ms = 500;
    while (!signal.aborted) {
      try {
        const headers: Record<string, string> = last === null ? {} : { 'Last-Event-ID': last };
        const response = await this.send('GET', '/events', { headers, signal });
        onConnection(true, null);
        wait_ms = 500;
        const parser = new EventParser();
        const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
        for (;;) {
          const { done, value } = await reader.read();
          if (done) break;
          for (const event of parser.push(value)) {
            if (event.id !== null) last = event.id;
            const kind = event.event as keyof CaseEvents;
            if (!(kind in EVENT_SCHEMA)) continue;
            on(kind, parse(EVENT_SCHEMA[kind], JSON.parse(event.data)) as CaseEvents[typeof kind]);
          }
        }
      } catch (error) {
        if (signal.aborted) return;
        if (!(error instanceof ApiError) && !(error instanceof TypeError)) console.error(error);
        onConnection(false, error instanceof ApiError ? error : null);
      }
      await new Promise((done) => setTimeout(done, wait_ms));
      wait_ms = Math.min(5000, wait_ms * 2);
    }
  }
}

function toVoxelBox(text: string): VoxelBox {
  const numbers = text.split(',').map(Number);
  if (numbers.length !== 6 || !numbers.every(Number.isInteger))
    throw new ContractError('the server sent no valid box of voxels');
  const [i, j, k, ni, nj, nk] = numbers;
  return [i, j, k, ni, nj, nk];
}

function etagOf(response: Response): string {
  const etag = response.headers.get('ETag');
  if (etag === null) throw new ContractError('the server sent no ETag');
  return etag;
}

/** A file name can contain the patient's name: only its extension is sent. */
export function endingOnly(name: string, index: number): string {
  const ending = /(\.nii\.gz|\.[A-Za-z0-9]{1,8})$/i.exec(name)?.[0].toLowerCase() ?? '';
  return `file${index}${/^\.\d+$/.test(ending) ? '' : ending}`;
}
