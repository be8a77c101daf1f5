import { untrack } from 'svelte'
import { Problem } from '@/transport/problem'
import { Resource } from '@/transport/resource.svelte'
import { connector, REQUEST } from '../api/client'
import type { FieldKey, InboxAnswer, InboxQuery, InboxRequest } from '../api/types'
import { connectorStore } from '../connector-store.svelte'

/** Requests read at once while the list scrolls, and the largest page. */
const PAGE = 40
const PAGE_MAX = 200
const PAGES_MAX = 100

/** Requests that match a query, read as far as the list was scrolled. */
export class RequestList {
  readonly answer = new Resource<InboxAnswer>((signal) => this.#read(signal))
  /** Problem of the last attempt to read more. */
  problem = $state.raw<Problem>()
  #query: InboxQuery = {}
  /** Query of the present answer; while another query runs, no further page can be read. */
  #answered: InboxQuery | undefined
  #held = PAGE
  #isReading = false

  /** Shows other requests, from the beginning. What was shown stays until they are there. */
  ask(query: InboxQuery): void {
    this.#query = query
    this.#held = PAGE
    this.problem = undefined
    void this.answer.refresh()
  }

  /** Reads the next page, if there is one. An effect that calls this does not depend on the list. */
  readonly more = (): Promise<void> => untrack(() => this.#more())

  async #more(): Promise<void> {
    const cursor = this.answer.value?.nextCursor
    const query = this.#query
    if (!cursor || this.#isReading || query !== this.#answered) return
    this.#held += PAGE
    if (this.answer.isLoading) {
      this.answer.refreshSoon()
      return
    }
    this.#isReading = true
    this.problem = undefined
    try {
      const next = await connector.get('/inbox', { query: { ...query, cursor, limit: PAGE } })
      if (query === this.#query) this.answer.amend((known) => joined(known, next))
    } catch (failure) {
      this.problem = Problem.from(failure)
    }
    this.#isReading = false
  }

  async #read(signal: AbortSignal): Promise<InboxAnswer> {
    const query = this.#query
    const answer = await readOn(query, this.#held, signal)
    if (!signal.aborted) this.#answered = query
    return answer
  }
}

/**
 * Request list of a component. It is read again whenever the query changes, updated by events, read
 * on while `isEnough` says that too few requests are shown, and cancelled on unmount.
 */
export function requestList({
  query,
  isEnough,
}: {
  query: () => InboxQuery
  isEnough: () => boolean
}): RequestList {
  const list = new RequestList()
  $effect(() => {
    const wanted = query()
    untrack(() => {
      list.ask(wanted)
    })
  })
  $effect(() => connectorStore.keep(list.answer))
  $effect(() => () => {
    list.answer.stop()
  })
  $effect(() => {
    if (!isEnough() && list.answer.value?.nextCursor && list.problem === undefined) void list.more()
  })
  return list
}

/** Reads all requests that match a query. */
export async function everyRequest(
  query: InboxQuery,
  signal: AbortSignal,
): Promise<InboxRequest[]> {
  return (await readOn(query, PAGES_MAX * PAGE_MAX, signal)).items
}

/** Returns the request of a field as a page of one, or of none if it is no longer requested. */
export async function requestOf(
  key: FieldKey,
  signal: AbortSignal,
): Promise<{ items: InboxRequest[] }> {
  try {
    return { items: [await connector.get(REQUEST, { path: key, signal })] }
  } catch (failure) {
    if (Problem.from(failure).status === 404) return { items: [] }
    throw failure
  }
}

async function readOn(query: InboxQuery, count: number, signal: AbortSignal): Promise<InboxAnswer> {
  let answer = await connector.get('/inbox', {
    query: { ...query, limit: Math.min(count, PAGE_MAX) },
    signal,
  })
  while (answer.nextCursor && answer.items.length < count)
    answer = joined(
      answer,
      await connector.get('/inbox', {
        query: {
          ...query,
          cursor: answer.nextCursor,
          limit: Math.min(count - answer.items.length, PAGE_MAX),
        },
        signal,
      }),
    )
  return answer
}

/**
 * Joins two pages. The second starts behind the last request of the first, whatever changed in
 * between.
 */
function joined(known: InboxAnswer, next: InboxAnswer): InboxAnswer {
  return { ...next, items: [...known.items, ...next.items] }
}
