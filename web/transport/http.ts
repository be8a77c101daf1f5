import { clock } from '@/format/clock.svelte'
import { Problem } from './problem'

const TIMEOUT_MS = 15_000

/**
 * Credentials of the session: the CSRF token of changes, and the reaction to an expired session.
 */
export const credentials: { csrfToken: string | undefined; onExpired: () => void } = {
  csrfToken: undefined,
  onExpired: () => undefined,
}

/** Everything of a request beside method and path. */
export interface RequestOptions {
  body?: unknown
  /** A body that is no JSON of ours, as it is. */
  text?: string
  contentType?: string
  /** The version or tag that was read: the change is refused where another came in between. */
  ifMatch?: number | string
  /** Only adds: the change is refused where there is one already. */
  isNew?: boolean
  signal?: AbortSignal
  /** Timeout of an operation that takes longer than usual, in ms. */
  timeoutMs?: number
  /** The one call that may be answered 401 without ending the session: signing in. */
  signingIn?: boolean
}

type Method = 'GET' | 'POST' | 'PUT' | 'DELETE'

/** Address of an API path for a link that the browser follows. */
export function address(path: string): string {
  return `/api/v1${path}`
}

/** One request to the API of the daemon that served this page. Throws {@link Problem}. */
export async function request<T>(
  method: Method,
  path: string,
  options: RequestOptions = {},
): Promise<T> {
  const headers: Record<string, string> = { accept: 'application/json' }
  if (options.body !== undefined || options.text !== undefined)
    headers['content-type'] = options.contentType ?? 'application/json'
  if (options.ifMatch !== undefined) headers['if-match'] = `"${options.ifMatch}"`
  if (options.isNew === true) headers['if-none-match'] = '*'
  if (method !== 'GET' && credentials.csrfToken !== undefined)
    headers['x-csrf-token'] = credentials.csrfToken

  const timeout = AbortSignal.timeout(options.timeoutMs ?? TIMEOUT_MS)
  const response = await fetch(address(path), {
    method,
    headers,
    credentials: 'same-origin',
    cache: 'no-store',
    signal: options.signal === undefined ? timeout : AbortSignal.any([options.signal, timeout]),
    ...(options.text !== undefined
      ? { body: options.text }
      : options.body === undefined
        ? {}
        : { body: JSON.stringify(options.body) }),
  }).catch((failure: unknown) => {
    if (failure instanceof DOMException && failure.name === 'AbortError') throw failure
    throw Problem.from(failure)
  })
  clock.heard(response.headers.get('date'))
  if (!response.ok) {
    if (response.status === 401 && options.signingIn !== true) credentials.onExpired()
    throw await Problem.of(response)
  }
  if (response.status === 204 || response.headers.get('content-length') === '0')
    return undefined as T
  return (await response.json()) as T
}

/** Downloads a file of the API under the name that the server gives it. */
export async function download(path: string): Promise<void> {
  const response = await fetch(address(path), {
    credentials: 'same-origin',
    cache: 'no-store',
  }).catch((failure: unknown) => {
    throw Problem.from(failure)
  })
  if (!response.ok) {
    if (response.status === 401) credentials.onExpired()
    throw await Problem.of(response)
  }
  const name =
    /filename="([^"]+)"/.exec(response.headers.get('content-disposition') ?? '')?.[1] ?? 'download'
  const link = document.createElement('a')
  link.href = URL.createObjectURL(await response.blob())
  link.download = name
  link.click()
  URL.revokeObjectURL(link.href)
}
