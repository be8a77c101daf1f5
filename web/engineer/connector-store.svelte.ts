/* eslint-disable svelte/prefer-svelte-reactivity -- pending fields and registrations are not drawn */
import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed, FIELD } from './api/client'
import type { FieldView, InboxRequest, InboxTotals, LiveData, RequestKey } from './api/types'
import { withLink, type LinkedStatus } from './link/link-state'
import { unreadComments } from './comments/unread-comments.svelte'

/** Events announce changes of state; the backlog and the time of the last message are polled. */
const STATUS_EVERY_MS = 5_000
/** Events announce requests and decisions; requests that became overdue or ended are polled. */
const TOTALS_EVERY_MS = 300_000
const TOGETHER_MS = 100

/** Members of a field that an event brings. */
type FieldChange = LiveData<'field'>

/** Requests that a page shows. */
type Shown = Pick<Resource<{ items: InboxRequest[] }>, 'value' | 'amendByEvent' | 'refreshSoon'>

/**
 * Shared state of the pages: status of the connector and totals of all fields. Requests can be
 * many, so each page reads those that it shows and registers them here for updates by events.
 */
class ConnectorStore {
  readonly status = new Resource<LinkedStatus>(async (signal) =>
    withLink(await connector.get('/status', { signal })),
  )
  readonly totals = new Resource<InboxTotals>(
    async (signal) => (await connector.get('/inbox', { query: { limit: 1 }, signal })).totals,
  )
  readonly pending = $derived(this.totals.value?.pending ?? 0)
  readonly #shown = new Set<Shown>()
  readonly #changed = new Map<string, FieldChange>()
  #isDrawing = false

  /** Starts reading and listening. Returns a function that stops. */
  open(): () => void {
    feed.start()
    void this.status.refresh()
    void this.totals.refresh()
    const stops = [
      feed.keepFresh(['status'], this.status),
      poll(STATUS_EVERY_MS, this.status),
      poll(TOTALS_EVERY_MS, this.totals),
      unreadComments.open(),
      feed.keepFresh(['inbox', 'decisions'], this),
      feed.on('field', ({ data }) => {
        this.#take(data)
      }),
    ]
    return () => {
      for (const stop of stops) stop()
      feed.stop()
      this.status.stop()
      this.totals.stop()
    }
  }

  /** Updates requests while a page shows them. Returns a function that stops. */
  keep(requests: Shown): () => void {
    this.#shown.add(requests)
    return () => this.#shown.delete(requests)
  }

  /** Reads again all that is shown, after a change that may concern any request. */
  refreshSoon(): void {
    this.totals.refreshSoon()
    for (const requests of this.#shown) requests.refreshSoon()
  }

  /** Replaces a field that was decided. */
  put(field: FieldView): void {
    this.#put([field])
    this.refreshSoon()
  }

  #known(field: FieldChange): FieldView | undefined {
    for (const { value } of this.#shown) {
      const request = value?.items.find(({ key }) => sameRequest(key, field.key))
      const known = request?.fields.find(({ key }) => key.fieldName === field.key.fieldName)
      if (known !== undefined) return known
    }
    return undefined
  }

  #put(fields: readonly (FieldView | FieldChange)[]): void {
    const byRequest = new Map<string, (FieldView | FieldChange)[]>()
    for (const field of fields)
      byRequest.set(nameOf(field.key), [...(byRequest.get(nameOf(field.key)) ?? []), field])
    for (const shown of this.#shown) {
      if (!shown.value?.items.some(({ key }) => byRequest.has(nameOf(key)))) continue
      shown.amendByEvent((page) => ({
        ...page,
        items: page.items.map((request) => {
          const changed = byRequest.get(nameOf(request.key))
          if (changed === undefined) return request
          return {
            ...request,
            fields: request.fields.map((known) => ({
              ...known,
              ...changed.find((field) => field.key.fieldName === known.key.fieldName),
            })),
          }
        }),
      }))
    }
  }

  /**
   * Collects values of events, which may come often, so that the page is drawn a few times a
   * second.
   */
  #take(field: FieldChange): void {
    const known = this.#known(field)
    if (known === undefined) return
    // A decision has more members than its event: the field is read again.
    if (field.mappingState !== known.mappingState) {
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
    this.#changed.set(Object.values(field.key).join('/'), field)
    if (this.#isDrawing) return
    this.#isDrawing = true
    setTimeout(() => {
      this.#isDrawing = false
      const fields = [...this.#changed.values()]
      this.#changed.clear()
      this.#put(fields)
    }, TOGETHER_MS)
  }
}

export const connectorStore = new ConnectorStore()

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
