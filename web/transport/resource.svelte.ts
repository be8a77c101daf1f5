import { clock } from '@/format/clock.svelte'
import { Problem } from './problem'

const SOON_MS = 150
const RETRY_MS = 3_000

/**
 * Value read from the server: the last good value, its time, and the problem of later reads. A
 * failed refresh keeps the value, which becomes stale. While the server is out of reach the
 * resource retries every few seconds.
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
  /** Changes by events during a read, whose answer may be older. */
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

  /**
   * Reads after a short delay; several calls within it make one read. A running read is finished
   * first.
   */
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
   * Changes the value by an event. The answer of a running read may be older than the event, so it
   * is changed, too: the change must have no effect if it was already made.
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

/**
 * Resource of a component. It is read on mount and whenever a dependency of `load` changes, and
 * cancelled on unmount.
 */
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

/** Refreshes resources periodically while the page is visible. Returns a function that stops. */
export function poll(periodMs: number, ...resources: { refreshSoon(): void }[]): () => void {
  const timer = setInterval(() => {
    if (!document.hidden) for (const each of resources) each.refreshSoon()
  }, periodMs)
  return () => {
    clearInterval(timer)
  }
}
