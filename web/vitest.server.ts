import { vi } from 'vitest'
import type { Problem } from '@/transport/problem'

/** A request that a page sent. */
export interface Asked {
  method: string
  /** Behind `/api/v1`, with its query. */
  path: string
  body: unknown
  /** Version or tag that the page had read. */
  ifMatch?: string
  /** Whether the page only adds. */
  isNew?: boolean
}

type Answer = (asked: Asked) => unknown

/**
 * Stands in for the daemon. Answers by `METHOD /path`, ignoring the query, and with 404 otherwise.
 * Returns the log of requests.
 */
export function serve(answers: Record<string, Answer>): Asked[] {
  const log: Asked[] = []
  vi.stubGlobal('fetch', (address: string, init: RequestInit = {}) => {
    const { method = 'GET', body } = init
    const headers = new Headers(init.headers)
    const ifMatch = headers.get('if-match')
    const asked: Asked = {
      method,
      path: address.replace('/api/v1', ''),
      body: typeof body === 'string' ? JSON.parse(body) : undefined,
      ...(ifMatch === null ? {} : { ifMatch }),
      ...(headers.has('if-none-match') ? { isNew: true } : {}),
    }
    log.push(asked)
    const answer =
      answers[`${method} ${asked.path.split('?')[0] ?? ''}`]?.(asked) ??
      problem(404, 'There is no such thing.')
    return Promise.resolve(
      answer instanceof Response ? answer : new Response(JSON.stringify(answer)),
    )
  })
  return log
}

/** A problem document (RFC 9457). */
export function problem(status: number, detail: string, faults: Problem['faults'] = []): Response {
  const document = { type: 'about:blank', title: 'Problem', status, code: 'TEST', detail, faults }
  return new Response(JSON.stringify(document), { status })
}
