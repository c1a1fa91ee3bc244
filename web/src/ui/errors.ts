import { ApiError } from '../api';

/** The text of an error as the page shows it. */
export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** True if the server does not have the resource, or not yet. */
export const isNotFound = (error: unknown): boolean =>
  error instanceof ApiError && (error.code === 'not_found' || error.code === 'not_ready');

/** True if the resource was changed by another page (HTTP 412, Precondition Failed). */
export const isConflict = (error: unknown): boolean => error instanceof ApiError && error.status === 412;
