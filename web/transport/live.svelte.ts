/* eslint-disable svelte/prefer-svelte-reactivity -- who listens is nobody's state to draw */
import { clock } from '@/format/clock.svelte'

export type FeedState = 'connecting' | 'live' | 'interrupted'

const BACKOFF_MIN_MS = 1_000
const BACKOFF_MAX_MS = 15_000

type Listener = (event: unknown) => void

/**
 * Server-sent events of a daemon. The browser reconnects and sends the last event id, so that the
 * server can send missed events. If it gives up after an error, the feed starts again with growing
 * pauses. After every interruption the pages read their state again, as the server may not remember
 * all missed events.
 */
export class LiveFeed {
  state = $state<FeedState>('connecting')
  since = $state(clock.now)
  lastEventAt = $state<number | undefined>()

  readonly #address: string
  readonly #types: readonly string[]
  readonly #listeners = new Map<string, Set<Listener>>()
  readonly #catchUps = new Set<() => void>()
  #source: EventSource | undefined
  #retry: ReturnType<typeof setTimeout> | undefined
  #pause = BACKOFF_MIN_MS
  #wasLive = false

  constructor(address: string, types: readonly string[]) {
    this.#address = address
    this.#types = types
  }

  start(): void {
    if (this.#source !== undefined) return
    const source = new EventSource(this.#address)
    this.#source = source
    source.onopen = () => {
      this.#pause = BACKOFF_MIN_MS
      this.#become('live')
      this.#wasLive = true
      // Also after the first connection: events between reading the state and listening are missed.
      this.#catchUp()
    }
    source.onerror = () => {
      this.#become(this.#wasLive ? 'interrupted' : 'connecting')
      if (source.readyState === EventSource.CLOSED) this.#startAgain()
    }
    // More happened than the server remembers.
    source.addEventListener('reset', () => {
      this.#catchUp()
    })
    for (const type of this.#types) {
      source.addEventListener(type, (message) => {
        this.#hear(type, message as MessageEvent<string>)
      })
    }
  }

  stop(): void {
    clearTimeout(this.#retry)
    this.#source?.close()
    this.#source = undefined
    this.#wasLive = false
    this.#become('connecting')
  }

  /** Calls `listener` with the body of every event of these types. Returns how to stop that. */
  on(types: string | readonly string[], listener: Listener): () => void {
    const names = typeof types === 'string' ? [types] : types
    for (const name of names) this.#of(name).add(listener)
    return () => {
      for (const name of names) this.#of(name).delete(listener)
    }
  }

  /**
   * Calls `catchUp` whenever the stream is back after an interruption. Returns a function that
   * stops this.
   */
  onCatchUp(catchUp: () => void): () => void {
    this.#catchUps.add(catchUp)
    return () => this.#catchUps.delete(catchUp)
  }

  /**
   * Refreshes resources on events of these types and after interruptions. Returns a function that
   * stops.
   */
  keepFresh(types: readonly string[], ...resources: { refreshSoon(): void }[]): () => void {
    const refresh = (): void => {
      for (const each of resources) each.refreshSoon()
    }
    const stops = [this.on(types, refresh), this.onCatchUp(refresh)]
    return () => {
      for (const stop of stops) stop()
    }
  }

  #hear(type: string, message: MessageEvent<string>): void {
    this.lastEventAt = clock.now
    let body: unknown
    try {
      body = JSON.parse(message.data)
    } catch {
      body = message.data
    }
    for (const listener of this.#of(type)) listener(body)
  }

  #catchUp(): void {
    for (const catchUp of this.#catchUps) catchUp()
  }

  #of(type: string): Set<Listener> {
    const known = this.#listeners.get(type)
    if (known !== undefined) return known
    const fresh = new Set<Listener>()
    this.#listeners.set(type, fresh)
    return fresh
  }

  #become(state: FeedState): void {
    if (this.state === state) return
    this.state = state
    this.since = clock.now
  }

  #startAgain(): void {
    this.#source?.close()
    this.#source = undefined
    clearTimeout(this.#retry)
    this.#retry = setTimeout(
      () => {
        this.start()
      },
      this.#pause * (0.75 + Math.random() / 2),
    )
    this.#pause = Math.min(this.#pause * 2, BACKOFF_MAX_MS)
  }
}
