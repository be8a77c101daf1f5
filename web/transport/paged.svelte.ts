import { Problem } from './problem'
import { Resource } from './resource.svelte'

/** A page of a list, as the daemons give them out. */
export interface PageOf<T> {
  items: T[]
  nextCursor?: string | null
}

/** List that is read page by page on demand. Reading it again reads as many pages as before. */
export class PagedList<T> {
  readonly list = new Resource<T[]>((signal) => this.#read(signal))
  /** Problem of the last attempt to read more. */
  problem = $state.raw<Problem>()
  hasMore = $state(false)
  isReading = $state(false)

  readonly #load: (
    cursor: string | undefined,
    signal: AbortSignal | undefined,
  ) => Promise<PageOf<T>>
  #pages = 1
  #next: string | undefined

  constructor(
    load: (cursor: string | undefined, signal: AbortSignal | undefined) => Promise<PageOf<T>>,
  ) {
    this.#load = load
  }

  /** Reads on, where there is more. */
  async more(): Promise<void> {
    if (this.#next === undefined || this.isReading) return
    this.#pages += 1
    if (this.list.isLoading) {
      this.list.refreshSoon()
      return
    }
    this.isReading = true
    this.problem = undefined
    const before = this.list.value
    try {
      const page = await this.#load(this.#next, undefined)
      // A list that was read again meanwhile has this page already.
      if (this.list.value === before) {
        this.list.amend((known) => [...known, ...page.items])
        this.#noteNext(page)
      }
    } catch (failure) {
      this.#pages -= 1
      this.problem = Problem.from(failure)
    }
    this.isReading = false
  }

  async #read(signal: AbortSignal): Promise<T[]> {
    const items: T[] = []
    let page: PageOf<T> | undefined
    for (let read = 0; read < this.#pages && (page === undefined || page.nextCursor); read += 1) {
      page = await this.#load(page?.nextCursor ?? undefined, signal)
      items.push(...page.items)
    }
    if (!signal.aborted && page) this.#noteNext(page)
    return items
  }

  #noteNext(page: PageOf<T>): void {
    this.#next = page.nextCursor ?? undefined
    this.hasMore = this.#next !== undefined
  }
}

/** A paged list of a component: read when it appears, abandoned when it goes. */
export function paged<T>(
  load: (cursor: string | undefined, signal: AbortSignal | undefined) => Promise<PageOf<T>>,
): PagedList<T> {
  const current = new PagedList<T>(load)
  $effect(() => {
    void current.list.refresh()
    return () => {
      current.list.stop()
    }
  })
  return current
}
