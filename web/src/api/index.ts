export { ApiError, Client, endingOnly, type CaseEvents, type Depths, type Poses, type Tagged } from './client';
export { ContractError, parse, type Schemas } from './contract';
export { EventParser } from './events';
export { fault } from './schema';
export { decodeSurface, type WireSurface } from './surface';
