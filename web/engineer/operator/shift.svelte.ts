import { clock } from '@/format/clock.svelte'
import { poll, Resource } from '@/transport/resource.svelte'
import { connector, feed } from '../api/client'
import type { OperatorOperation } from '../api/types'
import { today } from './entries'
import { keepPage } from './keep-page'
import { BrowserKeep } from './kept-entries'
import { Outbox } from './outbox.svelte'

const EVERY_MS = 20_000

/** What the operator's page works on: today's operations, and the entries on their way. */
export class Shift {
  readonly #keep = new BrowserKeep()
  readonly operations = new Resource<OperatorOperation[]>((signal) => this.#read(signal))
  readonly outbox = new Outbox(this.#keep, () => {
    this.operations.refreshSoon()
  })

  /** Starts reading, listening and delivering. Returns how to stop. */
  open(): () => void {
    void this.#start()
    keepPage().catch(() => undefined)
    const stops = [
      this.outbox.open(),
      feed.keepFresh(['operator', 'inbox'], this.operations),
      feed.onCatchUp(() => void this.outbox.deliver()),
      poll(EVERY_MS, this.operations),
    ]
    return () => {
      for (const stop of stops) stop()
      this.operations.stop()
    }
  }

  /** First what was last seen, marked with its age, then what is. */
  async #start(): Promise<void> {
    const kept = await this.#keep.operations().catch(() => undefined)
    if (kept !== undefined && this.operations.value === undefined) {
      this.operations.value = kept.items
      this.operations.readAt = kept.at
    }
    await this.operations.refresh()
  }

  async #read(signal: AbortSignal): Promise<OperatorOperation[]> {
    const { from, until } = today()
    const { items } = await connector.get('/operator/operations', {
      query: { from, until },
      signal,
    })
    void this.#keep.putOperations(clock.now, items).catch(() => undefined)
    return items
  }
}
