import contract from '../../../contract/openapi.json';
import { fault, type Schema } from './schema';
import type { components } from './types.gen';

export type Schemas = components['schemas'];

const root: Schema = contract;
const schemas: Record<string, Schema> = contract.components.schemas;

/** A response does not match the contract: the server has another version, or an error. */
export class ContractError extends Error {}

/** Checks a value from the server against a schema of the contract. */
export function parse<Name extends keyof Schemas>(name: Name, value: unknown): Schemas[Name] {
  const found = fault(value, schemas[name as string], root);
  if (found !== null) throw new ContractError(`the server's ${String(name)} does not match the contract: ${found}`);
  return value as Schemas[Name];
}
