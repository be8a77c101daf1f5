import { clock } from '@/format/clock.svelte'
import { Problem } from './problem'

const TIMEOUT_MS = 15_000

/** Set by the session: the token that changes need, and what to do when the server no longer knows us. */
export const credentials: { csrfToken: string | undefined; onExpired: () => void } = { csrfToken: undefined, onExpired: () => undefined }

interface Options {
  body?: unknown
  signal?: AbortSignal
  /** The one call that may be answered 401 without ending the session: signing in. */
  signingIn?: boolean
}

type Method = 'GET' | 'POST' | 'PUT' | 'DELETE'

/** One request to the API of the daemon that served this page. Throws {@link Problem}. */
export async function request<T>(method: Method, path: string, options: Options = {}): Promise<T> {
  const headers: Record<string, string> = { accept: 'application/json' }
  if (options.body !== undefined) headers['content-type'] = 'application/json'
  if (method !== 'GET' && credentials.csrfToken !== undefined) headers['x-csrf-token'] = credentials.csrfToken

  const timeout = AbortSignal.timeout(TIMEOUT_MS)
  const response = await fetch(`/api/v1${path}`, {
    method,
    headers,
    credentials: 'same-origin',
    cache: 'no-store',
    signal: options.signal === undefined ? timeout : AbortSignal.any([options.signal, timeout]),
    ...(options.body === undefined ? {} : { body: JSON.stringify(options.body) }),
  }).catch((failure: unknown) => {
    if (failure instanceof DOMException && failure.name === 'AbortError') throw failure
    throw Problem.from(failure)
  })
  clock.heard(response.headers.get('date'))
  if (!response.ok) {
    if (response.status === 401 && options.signingIn !== true) credentials.onExpired()
    throw await Problem.of(response)
  }
  if (response.status === 204 || response.headers.get('content-length') === '0') return undefined as T
  return (await response.json()) as T
}

/** A path of ids: every part is encoded, `/` inside an id included. */
export function path(...parts: (string | number)[]): string {
  return `/${parts.map((part) => encodeURIComponent(part)).join('/')}`
}

/** A query string without the parameters that are not set. */
export function query(parameters: Record<string, string | number | boolean | undefined>): string {
  const set = Object.entries(parameters).filter(([, value]) => value !== undefined && value !== '')
  return set.length === 0 ? '' : `?${set.map(([name, value]) => `${name}=${encodeURIComponent(String(value))}`).join('&')}`
}
