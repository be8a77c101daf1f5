import { clock } from '@/format/clock.svelte'
import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed } from '../api/client'
import type { OperatorOperation } from '../api/types'
import { today } from './entries'
import { storePage } from './offline-page'
import { BrowserEntryStorage } from './entry-storage'
import { EntryQueue } from './entry-queue.svelte'

const EVERY_MS = 20_000

/** State of the operator's page: today's operations and the queue of entries. */
export class Shift {
  readonly #storage = new BrowserEntryStorage()
  readonly operations = new Resource<OperatorOperation[]>((signal) => this.#read(signal))
  readonly queue = new EntryQueue(this.#storage, () => {
    this.operations.refreshSoon()
  })

  /** Starts reading, listening and delivering. Returns a function that stops. */
  open(): () => void {
    void this.#start()
    storePage().catch(() => undefined)
    const stops = [
      this.queue.open(),
      feed.keepFresh(['operator', 'inbox'], this.operations),
      feed.onCatchUp(() => void this.queue.deliver()),
      poll(EVERY_MS, this.operations),
    ]
    return () => {
      for (const stop of stops) stop()
      this.operations.stop()
    }
  }

  /** Shows the operations that were read last, marked with their age, then reads them again. */
  async #start(): Promise<void> {
    const stored = await this.#storage.operations().catch(() => undefined)
    if (stored !== undefined && this.operations.value === undefined) {
      this.operations.value = stored.items
      this.operations.readAt = stored.at
    }
    await this.operations.refresh()
  }

  async #read(signal: AbortSignal): Promise<OperatorOperation[]> {
    const { from, until } = today()
    const { items } = await connector.get('/operator/operations', {
      query: { from, until },
      signal,
    })
    void this.#storage.putOperations(clock.now, items).catch(() => undefined)
    return items
  }
}
