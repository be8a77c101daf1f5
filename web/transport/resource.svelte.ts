import { clock } from '@/format/clock.svelte'
import { Problem } from './problem'

const SOON_MS = 150
const RETRY_MS = 3_000

/**
 * Something read from the server: its last good value, when that was, and what went wrong since.
 *
 * A value is never thrown away because a refresh failed; it becomes stale and says so. While the server is out of reach
 * it is asked again every few seconds.
 */
export class Resource<T> {
  value = $state.raw<T | undefined>()
  problem = $state.raw<Problem | undefined>()
  readAt = $state<number | undefined>()
  isLoading = $state(false)

  readonly #load: (signal: AbortSignal) => Promise<T>
  #running: AbortController | undefined
  #soon: ReturnType<typeof setTimeout> | undefined
  #again = false
  /** What events told while a read was under way: what it brings may be older. */
  #overtaken: ((value: T) => T)[] = []

  constructor(load: (signal: AbortSignal) => Promise<T>) {
    this.#load = load
  }

  /** Reads now; a read under way is abandoned. */
  async refresh(): Promise<void> {
    this.#cancel()
    const running = new AbortController()
    this.#running = running
    this.#overtaken = []
    this.isLoading = true
    try {
      const value = await this.#load(running.signal)
      if (running.signal.aborted) return
      this.value = this.#overtaken.reduce<T>((read, change) => change(read), value)
      this.problem = undefined
      this.readAt = clock.now
    } catch (failure) {
      if (running.signal.aborted) return
      this.problem = Problem.from(failure)
      if (this.problem.unreachable) this.#soon = setTimeout(() => void this.refresh(), RETRY_MS)
    }
    this.#running = undefined
    this.isLoading = false
    if (this.#again) {
      this.#again = false
      this.refreshSoon()
    }
  }

  /** Reads in a moment; any number of calls within it are one read. A read under way is finished first. */
  refreshSoon(): void {
    if (this.#running !== undefined) {
      this.#again = true
      return
    }
    this.#soon ??= setTimeout(() => {
      this.#soon = undefined
      void this.refresh()
    }, SOON_MS)
  }

  /** Changes the value in place of reading it again. */
  amend(change: (value: T) => T): void {
    if (this.value === undefined) return
    this.value = change(this.value)
    this.readAt = clock.now
  }

  /**
   * Changes the value because an event told news. A read under way may bring what was before them, and is changed, too:
   * the change must be one that does nothing where it was made already.
   */
  amendByEvent(change: (value: T) => T): void {
    if (this.#running !== undefined) this.#overtaken.push(change)
    this.amend(change)
  }

  stop(): void {
    this.#cancel()
    this.#again = false
  }

  #cancel(): void {
    this.#running?.abort()
    this.#running = undefined
    clearTimeout(this.#soon)
    this.#soon = undefined
  }
}

/** A resource of a component: read when it appears and whenever what `load` depends on changes, abandoned when it goes. */
export function resource<T>(load: () => (signal: AbortSignal) => Promise<T>): Resource<T> {
  const current = new Resource<T>((signal) => load()(signal))
  $effect(() => {
    load()
    void current.refresh()
    return () => {
      current.stop()
    }
  })
  return current
}

/** Reads again every so often while somebody looks, for what no event tells. Returns how to stop. */
export function poll(periodMs: number, ...resources: { refreshSoon(): void }[]): () => void {
  const timer = setInterval(() => {
    if (!document.hidden) for (const each of resources) each.refreshSoon()
  }, periodMs)
  return () => {
    clearInterval(timer)
  }
}
