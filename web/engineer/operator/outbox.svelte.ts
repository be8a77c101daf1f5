import { clock } from '@/format/clock.svelte'
import { Problem } from '@/transport/problem'
import { session } from '@/transport/session.svelte'
import { connector } from '../api/client'
import type { EntryOutcome } from '../api/types'
import { moment, type Entry, type KeptEntry, type Said } from './entries'
import type { Keep } from './kept-entries'

const BATCH = 200
const PAUSE_MIN_MS = 1_000
const PAUSE_MAX_MS = 20_000

/** An entry that the connector would not take, with its reason. */
export interface Refused {
  entry: Entry
  message: string
}

/** Where an entry belongs. */
export type Place = Pick<Entry, 'operationNetworkId' | 'operationId'>

/** What is sent with a batch, and what comes back. */
export type Send = (sentAt: string, entries: Entry[]) => Promise<EntryOutcome[]>

/**
 * Entries on their way to the connector. Each has an id and a time of its own from the moment the button was pressed, is
 * on the browser's disk before it is sent, and stays there until the connector has answered for it: an outage, a closed
 * tab or a reload costs nothing, and a repeated delivery counts once.
 */
export class Outbox {
  kept = $state.raw<KeptEntry[]>([])
  refused = $state.raw<Refused[]>([])
  /** Since when deliveries fail; nothing while they succeed. */
  failingSince = $state<number | undefined>()
  /** What an earlier page left is known; before that nobody can say that everything has arrived. */
  isRead = $state(false)
  /** The browser keeps nothing: entries live as long as this page. */
  isForgetful = $state(false)

  readonly #keep: Keep
  readonly #send: Send
  readonly #ondelivered: () => void
  #timer: ReturnType<typeof setTimeout> | undefined
  #pause = PAUSE_MIN_MS
  #isSending = false
  #isOpen = false

  constructor(
    keep: Keep,
    ondelivered: () => void,
    send: Send = async (sentAt, entries) =>
      (await connector.post('/operator/entries', { body: { sentAt, entries } })).items,
  ) {
    this.#keep = keep
    this.#ondelivered = ondelivered
    this.#send = send
  }

  /** The entries of whoever is signed in: only these are delivered and counted. */
  get own(): Entry[] {
    return this.kept.filter((kept) => kept.userName === this.#userName).map((kept) => kept.entry)
  }

  /** How many wait for somebody else to sign in. */
  get foreign(): number {
    return this.kept.length - this.own.length
  }

  /** Reads what an earlier page left and starts delivering. Returns how to stop. */
  open(): () => void {
    this.#isOpen = true
    const again = (): void => {
      this.#soon(0)
    }
    addEventListener('online', again)
    void this.#keep
      .entries()
      .then((kept) => {
        const known = kept.map((each) => each.entry.entryId)
        this.kept = [...kept, ...this.kept.filter((each) => !known.includes(each.entry.entryId))]
      })
      .catch(() => (this.isForgetful = true))
      .finally(() => {
        this.isRead = true
        again()
      })
    return () => {
      this.#isOpen = false
      clearTimeout(this.#timer)
      removeEventListener('online', again)
    }
  }

  /** Takes what somebody said, now. */
  say(place: Place, said: Said): Entry {
    const entry: Entry = { ...said, ...place, entryId: crypto.randomUUID(), madeAt: moment() }
    const kept: KeptEntry = { entry, userName: this.#userName }
    this.kept = [...this.kept, kept]
    void this.#keep
      .put(kept)
      .catch(() => (this.isForgetful = true))
      .finally(() => {
        this.#soon(0)
      })
    return entry
  }

  forgive(entryId: string): void {
    this.refused = this.refused.filter(({ entry }) => entry.entryId !== entryId)
  }

  /** Delivers now what waits; called by itself after every entry, when the network is back and every few seconds. */
  async deliver(): Promise<void> {
    const batch = this.own.slice(0, BATCH)
    if (this.#isSending || batch.length === 0) return
    this.#isSending = true
    try {
      const outcomes = await this.#send(moment(), batch)
      if (outcomes.length === 0) throw new Error('The connector answered for no entry.')
      this.#pause = PAUSE_MIN_MS
      this.failingSince = undefined
      await this.#settle(batch, outcomes)
      this.#ondelivered()
      if (this.own.length > 0) this.#soon(0)
    } catch (failure) {
      this.failingSince ??= clock.now
      // The connector was restarted and no longer knows the session's token: with a fresh one the next attempt succeeds.
      if (Problem.from(failure).status === 403) await session.resume()
      this.#soon(this.#pause)
      this.#pause = Math.min(this.#pause * 2, PAUSE_MAX_MS)
    }
    this.#isSending = false
  }

  get #userName(): string {
    return session.known?.userName ?? ''
  }

  async #settle(batch: readonly Entry[], outcomes: readonly EntryOutcome[]): Promise<void> {
    for (const outcome of outcomes) {
      const entry = batch.find((each) => each.entryId === outcome.entryId)
      if (entry === undefined) continue
      if (outcome.result === 'REFUSED')
        this.refused = [...this.refused, { entry, message: outcome.message ?? '' }]
      await this.#keep.drop(outcome.entryId).catch(() => undefined)
    }
    const answered = outcomes.map((outcome) => outcome.entryId)
    this.kept = this.kept.filter(({ entry }) => !answered.includes(entry.entryId))
  }

  #soon(pauseMs: number): void {
    clearTimeout(this.#timer)
    if (this.#isOpen) this.#timer = setTimeout(() => void this.deliver(), pauseMs)
  }
}
