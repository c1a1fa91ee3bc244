import { vi } from 'vitest';
import { ApiError, parse, type CaseEvents, type Client, type Schemas } from '../src/api';
import type { Plan } from '../src/model';

type Stages = Schemas['Case']['stages'];
type Listen = Client['listen'];

const STAGES = [
  'scan',
  'anatomy',
  'landmarks',
  'plan',
  'boundary',
  'cut',
  'check',
  'preview',
  'prediction',
  'comparison',
  'uncertainty',
  'teeth',
  'arches',
  'occlusion',
  'splint_final',
  'splint_intermediate',
  'nerve',
  'guides',
  'airway',
  'cephalogram',
  'variants',
] as const satisfies readonly (keyof Stages)[];

const notReady = (): ApiError => new ApiError(409, 'not_ready', 'not ready');

/** A file of the server with its version; `put` checks the ETag as HTTP's If-Match. */
class VersionedFile<T> {
  value: T | null = null;
  version = 0;

  constructor(private readonly name: string) {}

  get etag(): string | null {
    return this.value === null ? null : `"${this.name}-${this.version}"`;
  }

  put(value: T, ifMatch: string): string {
    if (ifMatch !== '*' && ifMatch !== this.etag) throw new ApiError(412, 'changed', 'the file has changed');
    this.value = value;
    this.version++;
    return this.etag!;
  }

  get(): { value: T; etag: string } {
    if (this.value === null) throw new ApiError(404, 'not_found', 'no such file');
    return { value: this.value, etag: this.etag! };
  }
}

/** A case in memory with the methods of `Client` that the page needs to save and to follow the case. */
export class FakeServer {
  readonly plan = new VersionedFile<Plan>('plan');
  readonly landmarks = new VersionedFile<Record<string, readonly number[]>>('landmarks');
  readonly kept = new Map<string, { plan: Plan; landmarks: Record<string, readonly number[]> | null }>();
  readonly surfaceEtags = new Map<string, string>();
  hasScan = true;
  jobList: Schemas['Job'][] = [];
  /** Names of the requests, in the order they came. */
  requests: string[] = [];
  /** Requests of this name wait before they are answered. */
  gate: { name: string; promise: Promise<void> } | null = null;
  /** The next request of this name fails with this error. */
  failure: { name: string; error: Error } | null = null;
  /** The most requests at one time that write a file. */
  maxWriters = 0;
  private writers = 0;
  private handlers: { on: Parameters<Listen>[0]; onConnection: Parameters<Listen>[1] } | null = null;

  stages(): Stages {
    const etags: Partial<Record<keyof Stages, string | null>> = {
      scan: this.hasScan ? '"scan-1"' : null,
      plan: this.plan.etag,
      landmarks: this.landmarks.etag,
    };
    const stage = (name: keyof Stages): Schemas['Stage'] => {
      const etag = etags[name] ?? null;
      return { state: etag === null ? 'missing' : 'fresh', why: '', etag };
    };
    return Object.fromEntries(STAGES.map((name) => [name, stage(name)])) as Stages;
  }

  case(): Schemas['Case'] {
    return {
      lefort_case: 1,
      title: '',
      version: '0',
      notice: 'Research software. A simulation, not for clinical use.',
      start: '1',
      scan: this.hasScan ? { source_kind: 'nrrd', size: [2, 2, 2], spacing_mm: [1, 1, 1], warnings: [] } : null,
      stages: this.stages(),
      example_available: false,
      job_kinds: [],
      limits: { upload_file_bytes: 1e9, upload_files: 10, json_bytes: 1e6 },
    };
  }

  /** Sends an event to the page. */
  send<Kind extends keyof CaseEvents>(kind: Kind, event: CaseEvents[Kind]): void {
    this.handlers!.on(kind, event);
  }

  sendStages(): void {
    this.send('case', { stages: this.stages() });
  }

  connect(isConnected: boolean, error: ApiError | null = null): void {
    this.handlers!.onConnection(isConnected, error);
  }

  count(name: string): number {
    return this.requests.filter((request) => request === name).length;
  }

  private async answer<T>(name: string, result: () => T | Promise<T>): Promise<T> {
    this.requests.push(name);
    const { failure } = this;
    if (failure?.name === name) {
      this.failure = null;
      throw failure.error;
    }
    if (this.gate?.name === name) await this.gate.promise;
    return result();
  }

  private async write<T>(name: string, result: () => T | Promise<T>): Promise<T> {
    this.maxWriters = Math.max(this.maxWriters, ++this.writers);
    try {
      return await this.answer(name, result);
    } finally {
      this.writers--;
    }
  }

  /** The methods of the client; a call of any other fails the test. */
  private readonly methods = {
    case: () => this.answer('case', () => this.case()),
    jobs: () => this.answer('jobs', () => this.jobList),
    job: (id: number) => this.answer('job', () => this.jobList.find((job) => job.id === id)!),
    startJob: (request: Schemas['JobRequest']) => this.answer('startJob', () => this.startJob(request.kind)),
    listen: (on: Parameters<Listen>[0], onConnection: Parameters<Listen>[1]) => {
      this.handlers = { on, onConnection };
      return Promise.resolve();
    },
    solveHistory: () => this.answer('solveHistory', () => Promise.reject<never>(notReady())),
    plan: () => this.answer('plan', () => ({ ...this.plan.get(), value: parse('Plan', this.plan.value) })),
    putPlan: (plan: unknown, etag: string) =>
      this.write('putPlan', () => ({ value: { segments: [] }, etag: this.plan.put(plan as Plan, etag) })),
    landmarks: () => this.answer('landmarks', () => this.getLandmarks()),
    putLandmarks: ({ landmarks }: Schemas['Landmarks'], etag: string) =>
      this.write('putLandmarks', () => this.landmarks.put(landmarks, etag)),
    planPoses: () => this.answer('planPoses', () => ({ count: 0, segments: {} })),
    measure: () => this.answer('measure', () => []),
    volume: () =>
      this.answer('volume', () => ({
        size: [2, 2, 2],
        spacing_mm: [1, 1, 1],
        origin_mm: [0, 0, 0],
        direction: [1, 0, 0, 0, 1, 0, 0, 0, 1],
        value_range_hu: [-1000, 3000],
        presets: [],
        etag: '"scan-1"',
      })),
    volumeData: () => this.answer('volumeData', () => new Int16Array(8)),
    surfaces: () => this.answer('surfaces', () => [...this.surfaceEtags].map(([name, etag]) => ({ name, etag }))),
    surface: (name: string) =>
      this.answer(`surface ${name}`, () => ({
        points: new Float32Array(9),
        triangles: new Uint32Array(3),
        scalars: new Map<string, Float32Array>(),
      })),
    boundary: () => this.answer('boundary', () => Promise.reject<never>(notReady())),
    boundaryData: () => this.answer('boundaryData', () => Promise.reject<never>(notReady())),
    putBoundaryData: () => this.write('putBoundaryData', () => '"boundary-1"'),
    prediction: () => this.answer('prediction', () => Promise.reject<never>(notReady())),
    files: () => this.answer('files', () => []),
    variants: () => this.answer('variants', () => this.variantList()),
    sideBySide: () => this.answer('sideBySide', () => Promise.reject<never>(notReady())),
    keepVariant: (name: string) =>
      this.write('keepVariant', () => {
        this.kept.set(name, { plan: this.plan.value!, landmarks: this.landmarks.value });
        return this.variantList();
      }),
    loadVariant: (name: string, etag: string) =>
      this.write('loadVariant', async () => {
        await Promise.resolve(); // No request is answered at once.
        const { plan, landmarks } = this.kept.get(name)!;
        this.plan.put(plan, etag);
        if (landmarks) this.landmarks.put(landmarks, '*');
        this.sendStages(); // Before the reply.
      }),
    deleteVariant: (name: string) =>
      this.write('deleteVariant', () => {
        this.kept.delete(name);
      }),
  };

  get client(): Client {
    const methods: Partial<Client> = this.methods;
    return methods as Client;
  }

  private variantList(): Schemas['VariantList'] {
    const variants = [...this.kept].map(([name, { plan }]) => ({
      name,
      kept: '2026-01-01T00:00:00Z',
      segments: plan.segments.map((segment) => segment.name),
      findings: 0,
      has_prediction: false,
      is_current: plan === this.plan.value,
      why: '',
    }));
    return { variants, max_variants: 12 };
  }

  private getLandmarks(): { value: Schemas['Landmarks']; etag: string } {
    const { value, etag } = this.landmarks.get();
    return { value: parse('Landmarks', { landmarks: value }), etag };
  }

  private startJob(kind: Schemas['JobKind']): Schemas['Job'] {
    const job = makeJob(this.jobList.length + 1, kind, 'queued');
    this.jobList = [...this.jobList, job];
    return job;
  }
}

export const makeJob = (id: number, kind: Schemas['JobKind'], state: Schemas['JobState']): Schemas['Job'] => ({
  id,
  kind,
  parameters: {},
  state,
  stage: '',
  fraction: 0,
  lines: [],
  message: '',
  result: null,
  created: '2026-01-01T00:00:00Z',
  ended: null,
});

/** Holds requests of a name back until it is opened. */
export function makeGate(name: string): { name: string; promise: Promise<void>; open: () => void } {
  let open = (): void => undefined;
  const promise = new Promise<void>((done) => (open = done));
  return { name, promise, open };
}

/** Runs everything that is due within `ms` of the fake clock. */
export const wait = (ms: number): Promise<unknown> => vi.advanceTimersByTimeAsync(ms);

/** A plan of one segment whose last keyframe moves forward by `mm`. */
export const planOf = (mm: number): Plan => ({
  lefort_plan: 1,
  segments: [
    {
      name: 'front',
      osteotomy: { planes: [{ point_mm: [0, -16, 0], towards_segment: [0, -1, 0] }] },
      path: { keyframes: [{ translation_mm: [0, -mm, 0] }] },
    },
  ],
});
