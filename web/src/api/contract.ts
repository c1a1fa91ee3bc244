import contract from '../../../contract/openapi.json';
import { fault, type Schema } from './schema';
import type { components } from './types.gen';

export type Schemas = components['schemas'];

const root: Schema = contract;
const schemas: Record<string, Schema> = contract.components.schemas;

/** What came is not what the contract says: the server is of another version, or broken. */
export class ContractError extends Error {}

/** A value from outside as the type of the contract it claims to be. */
export function parse<Name extends keyof Schemas>(name: Name, value: unknown): Schemas[Name] {
  const found = fault(value, schemas[name as string], root);
  if (found !== null) throw new ContractError(`the server's ${String(name)} is not as agreed: ${found}`);
  return value as Schemas[Name];
}
