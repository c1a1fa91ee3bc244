import { readdirSync, readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { ContractError, fault, parse, type Schemas } from '../src/api';

const folder = new URL('../../contract/fixtures/', import.meta.url);
const fixtures = (kind: 'valid' | 'invalid') =>
  readdirSync(new URL(`${kind}/`, folder)).map((file) => ({
    file,
    schema: file.split('.')[0] as keyof Schemas,
    value: JSON.parse(readFileSync(new URL(`${kind}/${file}`, folder), 'utf8')) as unknown,
  }));

describe('the fixtures of the contract', () => {
  it.each(fixtures('valid'))('accepts $file', ({ schema, value }) => {
    expect(parse(schema, value)).toBe(value);
  });

  it.each(fixtures('invalid'))('rejects $file', ({ schema, value }) => {
    expect(() => parse(schema, value)).toThrow(ContractError);
  });

  it('has both kinds', () => {
    expect(fixtures('valid').length).toBeGreaterThan(20);
    expect(fixtures('invalid').length).toBeGreaterThan(20);
  });
});

describe('the validation', () => {
  it('names the key at fault', () => {
    const schema = { type: 'object', properties: { a: { type: 'array', items: { type: 'integer' } } } };
    expect(fault({ a: [1, 1.5] }, schema, schema)).toBe('a[1]: must be integer');
  });

  it('refuses infinite and undefined numbers', () => {
    expect(fault(Infinity, { type: 'number' }, {})).not.toBeNull();
    expect(fault(NaN, { type: 'number' }, {})).not.toBeNull();
  });

  it('does not accept inherited properties as keys', () => {
    expect(fault({}, { type: 'object', required: ['toString'] }, {})).not.toBeNull();
  });

  it('refuses a keyword it cannot check', () => {
    expect(() => fault(1, { multipleOf: 2 }, {})).toThrow(/multipleOf/);
  });
});
