/* eslint-disable svelte/prefer-svelte-reactivity -- what waits to be drawn is nobody's state to draw */
import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed } from './api/client'
import type { Field, FieldKey, InboxRequest, RequestKey } from './api/types'
import { talks } from './conversation/talks.svelte'

const STATUS_EVERY_MS = 3_000
const TOGETHER_MS = 100

/** What every page of the connector's UI looks at, read once and kept fresh by events. */
class Plant {
  readonly status = new Resource((signal) => connector.status(signal))
  readonly inbox = new Resource<InboxRequest[]>((signal) =>
    everyRequest(signal, (known) => {
      // The first time the page shows what has come so far; later the old stays until the new is complete.
      if (!this.#wasRead) this.inbox.value = known
    }),
  )
  #wasRead = false
  readonly #news = new Map<string, Field>()
  #isDrawing = false

  readonly pending = $derived(this.inbox.value?.flatMap((request) => request.fields).filter((field) => field.mappingState === 'PENDING').length ?? 0)

  /** Starts reading and listening. Returns how to stop. */
  open(): () => void {
    feed.start()
    void this.status.refresh()
    this.#wasRead = false
    void this.inbox.refresh().then(() => (this.#wasRead = true))
    const stops = [
      feed.keepFresh(['status'], this.status),
      poll(STATUS_EVERY_MS, this.status),
      talks.open(),
      feed.keepFresh(['inbox'], this.inbox),
      feed.on('field', (event) => {
        this.#take(event)
      }),
    ]
    return () => {
      for (const stop of stops) stop()
      feed.stop()
      this.status.stop()
      this.inbox.stop()
    }
  }

  request(key: RequestKey): InboxRequest | undefined {
    return this.inbox.value?.find((request) => sameRequest(request.key, key))
  }

  field(key: FieldKey): Field | undefined {
    return this.request(key)?.fields.find((field) => field.key.fieldName === key.fieldName)
  }

  /** Puts a field that the server sent in the place of the one we had. */
  put(field: Field): void {
    this.#put([field])
  }

  #put(fields: readonly Field[]): void {
    const byRequest = new Map<string, Field[]>()
    for (const field of fields) byRequest.set(nameOf(field.key), [...(byRequest.get(nameOf(field.key)) ?? []), field])
    this.inbox.amend((requests) =>
      requests.map((request) => {
        const news = byRequest.get(nameOf(request.key))
        if (news === undefined) return request
        return { ...request, fields: request.fields.map((known) => ({ ...known, ...news.find((field) => field.key.fieldName === known.key.fieldName) })) }
      }),
    )
  }

  /** Events come as fast as machines run; the page is drawn a few times a second. */
  #take(event: unknown): void {
    if (event === null || typeof event !== 'object' || !('key' in event)) {
      this.inbox.refreshSoon()
      return
    }
    const field = event as Field
    const known = this.field(field.key)
    // A decision has more members than the event tells: that field is read again.
    if (known !== undefined && field.mappingState !== undefined && field.mappingState !== known.mappingState) {
      void connector.field(field.key).then((whole) => {
        this.put(whole)
      }, () => {
        this.inbox.refreshSoon()
      })
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

function nameOf(key: RequestKey): string {
  return `${key.operationNetworkId}/${key.operationId}/${key.dynamicDataRequestId}`
}

export function sameRequest(a: RequestKey, b: RequestKey): boolean {
  return a.operationNetworkId === b.operationNetworkId && a.operationId === b.operationId && a.dynamicDataRequestId === b.dynamicDataRequestId
}

const PAGES_MAX = 100

async function everyRequest(signal: AbortSignal, onpage: (known: InboxRequest[]) => void): Promise<InboxRequest[]> {
  const requests: InboxRequest[] = []
  let cursor: string | undefined
  for (let page = 0; page < PAGES_MAX; page += 1) {
    const next = await connector.inbox(cursor, signal)
    requests.push(...next.items)
    cursor = next.nextCursor ?? undefined
    if (cursor === undefined) break
    onpage([...requests])
  }
  return requests
}
