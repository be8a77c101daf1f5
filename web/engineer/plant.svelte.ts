/* eslint-disable svelte/prefer-svelte-reactivity -- what waits to be drawn and who shows requests is nobody's state to draw */
import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed, FIELD } from './api/client'
import type { Field, InboxRequest, InboxTotals, RequestKey } from './api/types'
import { withLink, type LinkedStatus } from './link/link-state'
import { talks } from './conversation/talks.svelte'

/** Events tell when a state changes; only asking tells how much waits, and when the last message left. */
const STATUS_EVERY_MS = 5_000
/** Events tell of requests and decisions; only asking tells what time alone has changed: what is overdue or has ended. */
const TOTALS_EVERY_MS = 300_000
const TOGETHER_MS = 100

/** Requests that a page shows. */
type Shown = Pick<Resource<{ items: InboxRequest[] }>, 'value' | 'amendByEvent' | 'refreshSoon'>

/**
 * What every page of the connector's UI looks at: how the connector and the sum of all fields stand. The requests
 * themselves are as many as partners ask; each page reads those that it shows, and has them kept fresh here.
 */
class Plant {
  readonly status = new Resource<LinkedStatus>(async (signal) =>
    withLink(await connector.get('/status', { signal })),
  )
  readonly totals = new Resource<InboxTotals>(
    async (signal) => (await connector.get('/inbox', { query: { limit: 1 }, signal })).totals,
  )
  readonly pending = $derived(this.totals.value?.pending ?? 0)
  readonly #shown = new Set<Shown>()
  readonly #news = new Map<string, Field>()
  #isDrawing = false

  /** Starts reading and listening. Returns how to stop. */
  open(): () => void {
    feed.start()
    void this.status.refresh()
    void this.totals.refresh()
    const stops = [
      feed.keepFresh(['status'], this.status),
      poll(STATUS_EVERY_MS, this.status),
      poll(TOTALS_EVERY_MS, this.totals),
      talks.open(),
      feed.keepFresh(['inbox', 'decisions'], this),
      feed.on('field', (event) => {
        this.#take(event)
      }),
    ]
    return () => {
      for (const stop of stops) stop()
      feed.stop()
      this.status.stop()
      this.totals.stop()
    }
  }

  /** Keeps requests fresh for as long as a page shows them. Returns how to stop. */
  keep(requests: Shown): () => void {
    this.#shown.add(requests)
    return () => this.#shown.delete(requests)
  }

  /** Reads again what is shown, as after a change that may concern any request. */
  refreshSoon(): void {
    this.totals.refreshSoon()
    for (const requests of this.#shown) requests.refreshSoon()
  }

  /** Puts a field that was decided in the place of the one we had. */
  put(field: Field): void {
    this.#put([field])
    this.refreshSoon()
  }

  #known(field: Field): Field | undefined {
    for (const { value } of this.#shown) {
      const request = value?.items.find(({ key }) => sameRequest(key, field.key))
      const known = request?.fields.find(({ key }) => key.fieldName === field.key.fieldName)
      if (known !== undefined) return known
    }
    return undefined
  }

  #put(fields: readonly Field[]): void {
    const byRequest = new Map<string, Field[]>()
    for (const field of fields)
      byRequest.set(nameOf(field.key), [...(byRequest.get(nameOf(field.key)) ?? []), field])
    for (const shown of this.#shown) {
      if (!shown.value?.items.some(({ key }) => byRequest.has(nameOf(key)))) continue
      shown.amendByEvent((page) => ({
        ...page,
        items: page.items.map((request) => {
          const news = byRequest.get(nameOf(request.key))
          if (news === undefined) return request
          return {
            ...request,
            fields: request.fields.map((known) => ({
              ...known,
              ...news.find((field) => field.key.fieldName === known.key.fieldName),
            })),
          }
        }),
      }))
    }
  }

  /** Events come as fast as machines run; the page is drawn a few times a second. */
  #take(event: unknown): void {
    if (event === null || typeof event !== 'object' || !('key' in event)) {
      this.refreshSoon()
      return
    }
    const field = event as Field
    const known = this.#known(field)
    if (known === undefined) return
    // A decision has more members than the event tells: that field is read again.
    if (field.mappingState !== undefined && field.mappingState !== known.mappingState) {
      void connector.get(FIELD, { path: field.key }).then(
        (whole) => {
          this.put(whole)
        },
        () => {
          this.refreshSoon()
        },
      )
      return
    }
    this.#news.set(Object.values(field.key).join('/'), field)
    if (this.#isDrawing) return
    this.#isDrawing = true
    setTimeout(() => {
      this.#isDrawing = false
      const fields = [...this.#news.values()]
      this.#news.clear()
      this.#put(fields)
    }, TOGETHER_MS)
  }
}

export const plant = new Plant()

export function nameOf(key: RequestKey): string {
  return `${key.operationNetworkId}/${key.operationId}/${key.dynamicDataRequestId}`
}

export function sameRequest(a: RequestKey, b: RequestKey): boolean {
  return (
    a.operationNetworkId === b.operationNetworkId &&
    a.operationId === b.operationId &&
    a.dynamicDataRequestId === b.dynamicDataRequestId
  )
}
