import { clock } from '@/format/clock.svelte'
import { said } from '@/language/said'
import { Problem } from '@/transport/problem'
import { session } from '@/transport/session.svelte'
import { connector } from '../api/client'
import type { NewEntry, EntryAction, EntryResult } from '../api/types'
import { moment, type StoredEntry } from './entries'
import type { EntryStorage } from './entry-storage'

const BATCH = 200
const PAUSE_MIN_MS = 1_000
const PAUSE_MAX_MS = 20_000

/** Entry that the connector did not accept, with its reason. */
export interface Refused {
  entry: NewEntry
  message: string
}

/** Operation that an entry is about. */
export type OperationKey = Pick<NewEntry, 'operationNetworkId' | 'operationId'>

/** Sends a batch and returns an outcome for each entry that the connector knows now. */
export type Send = (sentAt: string, entries: NewEntry[]) => Promise<EntryResult[]>

/**
 * Queue of entries for the connector. An entry gets its id and time when the button is pressed, is
 * stored on the browser's disk before it is sent, and stays there until the connector has answered
 * for it. Nothing is lost by an outage, a closed tab or a reload, and a repeated delivery counts
 * once.
 */
export class EntryQueue {
  stored = $state.raw<StoredEntry[]>([])
  refused = $state.raw<Refused[]>([])
  /** Time of the first of the failures in a row, in ms; undefined while deliveries succeed. */
  failingSince = $state<number | undefined>()
  /**
   * Set once the entries of an earlier page are read; before, it is unknown whether all have
   * arrived.
   */
  isRead = $state(false)
  /** Entries that are on their way to the browser's disk: closing the page now would lose them. */
  unwritten = $state(0)
  /** The browser stores nothing: entries are lost when this page is closed. */
  isVolatile = $state(false)

  readonly #storage: EntryStorage
  readonly #send: Send
  readonly #ondelivered: () => void
  #timer: ReturnType<typeof setTimeout> | undefined
  #pause = PAUSE_MIN_MS
  #isSending = false
  #isOpen = false

  constructor(
    storage: EntryStorage,
    ondelivered: () => void,
    send: Send = async (sentAt, entries) =>
      (await connector.post('/operator/entries', { body: { sentAt, entries } })).items,
  ) {
    this.#storage = storage
    this.#ondelivered = ondelivered
    this.#send = send
  }

  /** Entries of the person who is signed in. Only these are delivered and counted. */
  get own(): NewEntry[] {
    return this.stored.filter((each) => each.userName === this.#userName).map((each) => each.entry)
  }

  /** Number of entries that wait until another person signs in. */
  get foreign(): number {
    return this.stored.length - this.own.length
  }

  /** Reads the entries of an earlier page and starts delivering. Returns a function that stops. */
  open(): () => void {
    this.#isOpen = true
    const again = (): void => {
      this.#soon(0)
    }
    // A page that closes aborts what it is writing: the browser asks first.
    const hold = (closing: BeforeUnloadEvent): void => {
      if (this.unwritten > 0) closing.preventDefault()
    }
    addEventListener('online', again)
    addEventListener('beforeunload', hold)
    void this.#storage
      .entries()
      .then((earlier) => {
        const known = earlier.map((each) => each.entry.entryId)
        this.stored = [
          ...earlier,
          ...this.stored.filter((each) => !known.includes(each.entry.entryId)),
        ]
      })
      .catch(() => (this.isVolatile = true))
      .finally(() => {
        this.isRead = true
        again()
      })
    return () => {
      this.#isOpen = false
      clearTimeout(this.#timer)
      removeEventListener('online', again)
      removeEventListener('beforeunload', hold)
    }
  }

  /** Stores an entry with the present time and delivers it soon. */
  record(operation: OperationKey, action: EntryAction): NewEntry {
    const entry: NewEntry = {
      ...action,
      ...operation,
      entryId: crypto.randomUUID(),
      madeAt: moment(),
    }
    const stored: StoredEntry = { entry, userName: this.#userName }
    this.stored = [...this.stored, stored]
    this.unwritten += 1
    void this.#storage
      .put(stored)
      .catch(() => (this.isVolatile = true))
      .finally(() => {
        this.unwritten -= 1
        this.#soon(0)
      })
    return entry
  }

  dismiss(entryId: string): void {
    this.refused = this.refused.filter(({ entry }) => entry.entryId !== entryId)
  }

  /** Delivers a batch now. It also runs after every entry, when the network is back and after pauses. */
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
      // A restarted connector does not know the token of the session: with a fresh one the next
      // attempt succeeds.
      if (Problem.from(failure).status === 403) await session.resume()
      this.#soon(this.#pause)
      this.#pause = Math.min(this.#pause * 2, PAUSE_MAX_MS)
    }
    this.#isSending = false
  }

  get #userName(): string {
    return session.known?.userName ?? ''
  }

  async #settle(batch: readonly NewEntry[], outcomes: readonly EntryResult[]): Promise<void> {
    for (const outcome of outcomes) {
      const entry = batch.find((each) => each.entryId === outcome.entryId)
      if (entry === undefined) continue
      if (outcome.result === 'REFUSED')
        this.refused = [
          ...this.refused,
          { entry, message: said(outcome.code ?? '', outcome.message ?? '') },
        ]
      await this.#storage.drop(outcome.entryId).catch(() => undefined)
    }
    const answered = outcomes.map((outcome) => outcome.entryId)
    this.stored = this.stored.filter(({ entry }) => !answered.includes(entry.entryId))
  }

  #soon(pauseMs: number): void {
    clearTimeout(this.#timer)
    if (this.#isOpen) this.#timer = setTimeout(() => void this.deliver(), pauseMs)
  }
}
