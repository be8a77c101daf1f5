/* eslint-disable svelte/prefer-svelte-reactivity -- who listens is nobody's state to draw */
import { clock } from '@/format/clock.svelte'

export type FeedState = 'connecting' | 'live' | 'interrupted'

/** State of a feed, and since when it is in it. */
export interface FeedStatus {
  readonly state: FeedState
  readonly since: number
}

/** Event of a stream as an API describes it: its name and its data. */
export interface StreamEvent {
  event: string
  data: unknown
}

/** Names of the events that pages listen to; the feed itself heeds `reset`. */
export type NameOf<E extends StreamEvent> = Exclude<E['event'], 'reset'>
/** Event with a name, or with one of several. */
export type EventOf<E extends StreamEvent, Name extends E['event']> = Extract<E, { event: Name }>

const BACKOFF_MIN_MS = 1_000
const BACKOFF_MAX_MS = 15_000

type Listeners<E extends StreamEvent> = {
  [Name in NameOf<E>]?: Set<(event: EventOf<E, Name>) => void>
}

/**
 * Server-sent events of a daemon. The browser reconnects and sends the last event id, so that the
 * server can send missed events. If it gives up after an error, the feed starts again with growing
 * pauses. After every interruption the pages read their state again, as the server may not remember
 * all missed events.
 */
export class LiveFeed<E extends StreamEvent> implements FeedStatus {
  state = $state<FeedState>('connecting')
  since = $state(clock.now)

  readonly #address: string
  readonly #listeners: Listeners<E> = {}
  /** Names that were listened to; a browser tells of events by name only. */
  readonly #names = new Set<NameOf<E>>()
  readonly #catchUps = new Set<() => void>()
  #source: EventSource | undefined
  #retry: ReturnType<typeof setTimeout> | undefined
  #pause = BACKOFF_MIN_MS
  #wasLive = false

  constructor(address: string) {
    this.#address = address
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
    for (const name of this.#names) this.#listen(source, name)
  }

  stop(): void {
    clearTimeout(this.#retry)
    this.#source?.close()
    this.#source = undefined
    this.#wasLive = false
    this.#become('connecting')
  }

  /** Calls `listener` with every event of these names. Returns a function that stops this. */
  on<Name extends NameOf<E>>(
    wanted: Name | readonly Name[],
    listener: (event: EventOf<E, Name>) => void,
  ): () => void {
    const names = typeof wanted === 'string' ? [wanted] : wanted
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
   * Refreshes resources on events of these names and after interruptions. Returns a function that
   * stops.
   */
  keepFresh(names: readonly NameOf<E>[], ...resources: { refreshSoon(): void }[]): () => void {
    const refresh = (): void => {
      for (const each of resources) each.refreshSoon()
    }
    const stops = [this.on(names, refresh), this.onCatchUp(refresh)]
    return () => {
      for (const stop of stops) stop()
    }
  }

  #listen(source: EventSource, name: NameOf<E>): void {
    source.addEventListener(name, (message: MessageEvent<string>) => {
      this.#hear(name, message.data)
    })
  }

  #hear<Name extends NameOf<E>>(name: Name, json: string): void {
    let event: EventOf<E, Name>
    try {
      event = { event: name, data: JSON.parse(json) } as EventOf<E, Name>
    } catch {
      // An event that cannot be read is as good as lost.
      this.#catchUp()
      return
    }
    for (const listener of this.#of(name)) listener(event)
  }

  #catchUp(): void {
    for (const catchUp of this.#catchUps) catchUp()
  }

  #of<Name extends NameOf<E>>(name: Name): Set<(event: EventOf<E, Name>) => void> {
    if (!this.#names.has(name)) {
      this.#names.add(name)
      if (this.#source !== undefined) this.#listen(this.#source, name)
    }
    return (this.#listeners[name] ??= new Set<(event: EventOf<E, Name>) => void>())
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
