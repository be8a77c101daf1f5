import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed } from './api/client'
import type { Field, FieldKey, InboxRequest } from './api/types'
import { talks } from './conversation/talks.svelte'

const STATUS_EVERY_MS = 3_000

/** What every page of the connector's UI looks at, read once and kept fresh by events. */
class Plant {
  readonly status = new Resource((signal) => connector.status(signal))
  readonly inbox = new Resource((signal) => everyRequest(signal))

  readonly pending = $derived(this.inbox.value?.flatMap((request) => request.fields).filter((field) => field.mappingState === 'PENDING').length ?? 0)

  /** Starts reading and listening. Returns how to stop. */
  open(): () => void {
    feed.start()
    void this.status.refresh()
    void this.inbox.refresh()
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

  request(key: Omit<FieldKey, 'fieldName'>): InboxRequest | undefined {
    return this.inbox.value?.find((request) => sameRequest(request.key, key))
  }

  field(key: FieldKey): Field | undefined {
    return this.request(key)?.fields.find((field) => field.key.fieldName === key.fieldName)
  }

  /** Puts a field that the server sent in the place of the one we had. */
  put(field: Field): void {
    this.inbox.amend((requests) =>
      requests.map((request) =>
        sameRequest(request.key, field.key)
          ? { ...request, fields: request.fields.map((known) => (known.key.fieldName === field.key.fieldName ? { ...known, ...field } : known)) }
          : request,
      ),
    )
  }

  #take(event: unknown): void {
    if (event !== null && typeof event === 'object' && 'key' in event) this.put(event as Field)
    else this.inbox.refreshSoon()
  }
}

export const plant = new Plant()

export function sameRequest(a: Omit<FieldKey, 'fieldName'>, b: Omit<FieldKey, 'fieldName'>): boolean {
  return a.operationNetworkId === b.operationNetworkId && a.operationId === b.operationId && a.dynamicDataRequestId === b.dynamicDataRequestId
}

const PAGES_MAX = 100

async function everyRequest(signal: AbortSignal): Promise<InboxRequest[]> {
  const requests: InboxRequest[] = []
  let cursor: string | undefined
  for (let page = 0; page < PAGES_MAX; page += 1) {
    const next = await connector.inbox(cursor, signal)
    requests.push(...next.items)
    cursor = next.nextCursor ?? undefined
    if (cursor === undefined) break
  }
  return requests
}
