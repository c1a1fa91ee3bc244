/**
 * Holds values from outside against the contract itself: a reader of the part of JSON Schema that
 * contract/openapi.json uses. A keyword it does not know is an error, so that nothing is let through unseen.
 */
export type Schema = { readonly [keyword: string]: unknown };

const SAYS_NOTHING = new Set(['description', 'format', 'title', '$schema', 'definitions']);

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

/** Returns what is wrong with a value, as "key: why", or null. */
export function fault(value: unknown, schema: Schema, root: Schema, at = ''): string | null {
  const here = at === '' ? 'it' : at;
  for (const [keyword, rule] of Object.entries(schema)) {
    if (SAYS_NOTHING.has(keyword)) continue;
    const found = check(keyword, rule);
    if (found !== null) return found;
  }
  return null;

  function check(keyword: string, rule: unknown): string | null {
    const object = typeOf(value) === 'object' ? (value as Record<string, unknown>) : null;
    const array = Array.isArray(value) ? value : null;
    switch (keyword) {
      case '$ref':
        return fault(value, resolve(root, rule as string), root, at);
      case 'type': {
        const types = Array.isArray(rule) ? (rule as string[]) : [rule as string];
        return types.some((type) => hasType(value, type)) ? null : `${here}: must be ${types.join(' or ')}`;
      }
      case 'const':
        return value === rule ? null : `${here}: must be ${JSON.stringify(rule)}`;
      case 'enum':
        return (rule as unknown[]).includes(value) ? null : `${here}: ${JSON.stringify(value)} is none of those known`;
      case 'oneOf': {
        const fits = (rule as Schema[]).filter((option) => fault(value, option, root, at) === null).length;
        return fits === 1 ? null : `${here}: fits ${fits} of the forms it may have`;
      }
      case 'required':
        for (const key of rule as string[]) if (object && !Object.hasOwn(object, key)) return `${here}: lacks ${key}`;
        return null;
      case 'properties':
        for (const [key, inner] of Object.entries(rule as Record<string, Schema>)) {
          if (!object || !Object.hasOwn(object, key)) continue;
          const found = fault(object[key], inner, root, at === '' ? key : `${at}.${key}`);
          if (found) return found;
        }
        return null;
      case 'patternProperties':
        for (const [pattern, inner] of Object.entries(rule as Record<string, Schema>))
          for (const key of Object.keys(object ?? {})) {
            if (!new RegExp(pattern, 'u').test(key)) continue;
            const found = fault(object![key], inner, root, at === '' ? key : `${at}.${key}`);
            if (found) return found;
          }
        return null;
      case 'additionalProperties': {
        const known = (schema.properties ?? {}) as Record<string, Schema>;
        const patterns = Object.keys((schema.patternProperties ?? {}) as object).map(
          (pattern) => new RegExp(pattern, 'u'),
        );
        for (const key of Object.keys(object ?? {})) {
          if (Object.hasOwn(known, key) || patterns.some((pattern) => pattern.test(key))) continue;
          if (rule === false) return `${here}: has an unknown key ${key}`;
          if (rule === true) continue;
          const found = fault(object![key], rule as Schema, root, at === '' ? key : `${at}.${key}`);
          if (found) return found;
        }
        return null;
      }
      case 'propertyNames':
        for (const key of Object.keys(object ?? {})) {
          const found = fault(key, rule as Schema, root, `${here}, key ${JSON.stringify(key)}`);
          if (found) return found;
        }
        return null;
      case 'minProperties':
        return object && Object.keys(object).length < (rule as number) ? `${here}: has too few keys` : null;
      case 'maxProperties':
        return object && Object.keys(object).length > (rule as number) ? `${here}: has too many keys` : null;
      case 'items':
        for (let n = 0; n < (array?.length ?? 0); n++) {
          const found = fault(array![n], rule as Schema, root, `${at}[${n}]`);
          if (found) return found;
        }
        return null;
      case 'minItems':
        return array && array.length < (rule as number) ? `${here}: must have at least ${rule} entries` : null;
      case 'maxItems':
        return array && array.length > (rule as number) ? `${here}: must have at most ${rule} entries` : null;
      case 'minimum':
        return typeof value === 'number' && value < (rule as number) ? `${here}: must be at least ${rule}` : null;
      case 'maximum':
        return typeof value === 'number' && value > (rule as number) ? `${here}: must be at most ${rule}` : null;
      case 'exclusiveMinimum':
        return typeof value === 'number' && value <= (rule as number) ? `${here}: must be above ${rule}` : null;
      case 'exclusiveMaximum':
        return typeof value === 'number' && value >= (rule as number) ? `${here}: must be below ${rule}` : null;
      case 'minLength':
        return typeof value === 'string' && value.length < (rule as number) ? `${here}: is too short` : null;
      case 'maxLength':
        return typeof value === 'string' && value.length > (rule as number) ? `${here}: is too long` : null;
      case 'pattern':
        return typeof value === 'string' && !new RegExp(rule as string, 'u').test(value)
          ? `${here}: does not look as it should`
          : null;
      default:
        throw new Error(`the contract uses ${keyword}, which the page cannot check`);
    }
  }
}
