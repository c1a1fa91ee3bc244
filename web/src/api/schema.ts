/**
 * Validates values from the server against the contract: the part of JSON Schema that contract/openapi.json uses. An
 * unknown keyword is an error, so that no rule is ignored.
 */
export type Schema = { readonly [keyword: string]: unknown };

const IGNORED = new Set(['description', 'format', 'title', '$schema', 'definitions']);

/** Resolves "#/a/b" in the document. */
function resolve(root: Schema, ref: string): Schema {
  let at: unknown = root;
  for (const part of ref.replace(/^#\//, '').split('/')) at = (at as Schema | undefined)?.[part];
  if (typeof at !== 'object' || at === null) throw new Error(`the contract has no ${ref}`);
  return at as Schema;
}

const typeOf = (value: unknown): string => (value === null ? 'null' : Array.isArray(value) ? 'array' : typeof value);

function hasType(value: unknown, type: string): boolean {
  if (type === 'integer') return Number.isInteger(value);
  if (type === 'number') return typeof value === 'number' && Number.isFinite(value);
  return typeOf(value) === type;
}

/** A place in a value: the schema it must match, the document of the schema, and its path. */
interface Place {
  schema: Schema;
  root: Schema;
  at: string;
}

type Check = (value: unknown, rule: unknown, place: Place) => string | null;

const here = ({ at }: Place): string => (at === '' ? 'it' : at);

const objectOf = (value: unknown): Record<string, unknown> | null =>
  typeOf(value) === 'object' ? (value as Record<string, unknown>) : null;

/** Checks the value of a key. */
const faultAtKey = (value: unknown, key: string, schema: Schema, { root, at }: Place): string | null =>
  fault(value, schema, root, at === '' ? key : `${at}.${key}`);

/** The first result that is not null. */
function first<T>(items: Iterable<T>, check: (item: T) => string | null): string | null {
  for (const item of items) {
    const found = check(item);
    if (found !== null) return found;
  }
  return null;
}

/** A check of a bound: `message` if the value has the type and exceeds it. */
const bound =
  (measure: (value: unknown) => number | null, fails: (n: number, limit: number) => boolean, message: string): Check =>
  (value, rule, place) => {
    const n = measure(value);
    return n !== null && fails(n, rule as number) ? `${here(place)}: ${message.replace('#', String(rule))}` : null;
  };

const numberOf = (value: unknown): number | null => (typeof value === 'number' ? value : null);
const entriesOf = (value: unknown): number | null => (Array.isArray(value) ? value.length : null);
const lengthOf = (value: unknown): number | null => (typeof value === 'string' ? value.length : null);
const keysOf = (value: unknown): number | null => {
  const object = objectOf(value);
  return object && Object.keys(object).length;
};

const isBelow = (n: number, limit: number): boolean => n < limit;
const isAbove = (n: number, limit: number): boolean => n > limit;
const isAtMost = (n: number, limit: number): boolean => n <= limit;
const isAtLeast = (n: number, limit: number): boolean => n >= limit;

const checkObject: Record<string, Check> = {
  required: (value, rule, place) => {
    const object = objectOf(value);
    return first(rule as string[], (key) =>
      object && !Object.hasOwn(object, key) ? `${here(place)}: lacks ${key}` : null,
    );
  },
  properties: (value, rule, place) => {
    const object = objectOf(value);
    return first(Object.entries(rule as Record<string, Schema>), ([key, inner]) =>
      object && Object.hasOwn(object, key) ? faultAtKey(object[key], key, inner, place) : null,
    );
  },
  patternProperties: (value, rule, place) => {
    const entries = Object.entries(objectOf(value) ?? {});
    return first(Object.entries(rule as Record<string, Schema>), ([pattern, inner]) =>
      first(entries, ([key, entry]) =>
        new RegExp(pattern, 'u').test(key) ? faultAtKey(entry, key, inner, place) : null,
      ),
    );
  },
  additionalProperties: (value, rule, place) => {
    const known = (place.schema.properties ?? {}) as Record<string, Schema>;
    const patterns = Object.keys((place.schema.patternProperties ?? {}) as object).map((p) => new RegExp(p, 'u'));
    return first(Object.entries(objectOf(value) ?? {}), ([key, entry]) => {
      if (Object.hasOwn(known, key) || patterns.some((pattern) => pattern.test(key)) || rule === true) return null;
      if (rule === false) return `${here(place)}: has an unknown key ${key}`;
      return faultAtKey(entry, key, rule as Schema, place);
    });
  },
  propertyNames: (value, rule, place) =>
    first(Object.keys(objectOf(value) ?? {}), (key) =>
      fault(key, rule as Schema, place.root, `${here(place)}, key ${JSON.stringify(key)}`),
    ),
  minProperties: bound(keysOf, isBelow, 'has too few keys'),
  maxProperties: bound(keysOf, isAbove, 'has too many keys'),
};

const checkArray: Record<string, Check> = {
  items: (value, rule, { root, at }) =>
    first(Array.isArray(value) ? value.keys() : [], (n) =>
      fault((value as unknown[])[n], rule as Schema, root, `${at}[${n}]`),
    ),
  minItems: bound(entriesOf, isBelow, 'must have at least # entries'),
  maxItems: bound(entriesOf, isAbove, 'must have at most # entries'),
};

const checkNumber: Record<string, Check> = {
  minimum: bound(numberOf, isBelow, 'must be at least #'),
  maximum: bound(numberOf, isAbove, 'must be at most #'),
  exclusiveMinimum: bound(numberOf, isAtMost, 'must be above #'),
  exclusiveMaximum: bound(numberOf, isAtLeast, 'must be below #'),
};

const checkString: Record<string, Check> = {
  minLength: bound(lengthOf, isBelow, 'is too short'),
  maxLength: bound(lengthOf, isAbove, 'is too long'),
  pattern: (value, rule, place) =>
    typeof value === 'string' && !new RegExp(rule as string, 'u').test(value)
      ? `${here(place)}: has the wrong format`
      : null,
};

const checkAny: Record<string, Check> = {
  $ref: (value, rule, { root, at }) => fault(value, resolve(root, rule as string), root, at),
  type: (value, rule, place) => {
    const types = Array.isArray(rule) ? (rule as string[]) : [rule as string];
    return types.some((type) => hasType(value, type)) ? null : `${here(place)}: must be ${types.join(' or ')}`;
  },
  const: (value, rule, place) => (value === rule ? null : `${here(place)}: must be ${JSON.stringify(rule)}`),
  enum: (value, rule, place) =>
    (rule as unknown[]).includes(value) ? null : `${here(place)}: ${JSON.stringify(value)} is not a known value`,
  oneOf: (value, rule, place) => {
    const fits = (rule as Schema[]).filter((option) => fault(value, option, place.root, place.at) === null).length;
    return fits === 1 ? null : `${here(place)}: matches ${fits} of the alternatives instead of one`;
  },
};

const CHECKS = new Map(
  [checkAny, checkObject, checkArray, checkNumber, checkString].flatMap((group) => Object.entries(group)),
);

/** Returns what is wrong with a value, as "key: reason", or null. */
export function fault(value: unknown, schema: Schema, root: Schema, at = ''): string | null {
  return first(Object.entries(schema), ([keyword, rule]) => {
    if (IGNORED.has(keyword)) return null;
    const check = CHECKS.get(keyword);
    if (!check) throw new Error(`the contract uses ${keyword}, which the page cannot check`);
    return check(value, rule, { schema, root, at });
  });
}
