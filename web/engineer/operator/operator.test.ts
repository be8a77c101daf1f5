import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { Problem } from '@/transport/problem'
import { session } from '@/transport/session.svelte'
import type { NewEntry, EntryResult, OperatorOperation } from '../api/types'
import { expected, today, type StoredEntry } from './entries'
import type { EntryStorage } from './entry-storage'
import { EntryQueue } from './entry-queue.svelte'

const place = { operationNetworkId: 'n', operationId: 'o' }
const operation = (more: Partial<OperatorOperation['standing']> = {}): OperatorOperation => ({
  ...place,
  operationType: 'PRODUCTION',
  standing: { goodQuantity: 5, scrapQuantity: 0, ...more },
  buttons: { start: true, addGood: true, addScrap: true, done: true, problem: true },
  fields: [],
})

/** A disk that outlives pages. */
class Disk implements EntryStorage {
  stored: StoredEntry[] = []
  entries = (): Promise<StoredEntry[]> => Promise.resolve([...this.stored])
  put = (entry: StoredEntry): Promise<void> => {
    this.stored.push(entry)
    return Promise.resolve()
  }
  drop = (entryId: string): Promise<void> => {
    this.stored = this.stored.filter(({ entry }) => entry.entryId !== entryId)
    return Promise.resolve()
  }
  operations = (): Promise<undefined> => Promise.resolve(undefined)
  putOperations = (): Promise<void> => Promise.resolve()
}

/** A connector that counts each entry once, and can be out of reach. */
class Connector {
  isReachable = true
  taken: NewEntry[] = []
  send = (_: string, entries: NewEntry[]): Promise<EntryResult[]> => {
    if (!this.isReachable) return Promise.reject(Problem.unreached())
    const outcomes = entries.map((entry): EntryResult => {
      const isKnown = this.taken.some((known) => known.entryId === entry.entryId)
      if (!isKnown) this.taken.push(entry)
      return { entryId: entry.entryId, result: isKnown ? 'REPEATED' : 'TAKEN', fields: [] }
    })
    return Promise.resolve(outcomes)
  }
}

function signIn(userName: string): void {
  session.state = { is: 'signedIn', who: { userName, role: 'OPERATOR', csrfToken: 't' } }
}

describe('what a card shows', () => {
  it('lays what waits over what the connector says', () => {
    const entries = [
      {
        ...place,
        entryId: '2',
        madeAt: '2026-01-01T08:01:00Z',
        action: 'ADD',
        quantity: 2,
        piece: 'GOOD',
      },
      { ...place, entryId: '1', madeAt: '2026-01-01T08:00:00Z', action: 'START' },
      {
        ...place,
        entryId: '3',
        madeAt: '2026-01-01T08:02:00Z',
        action: 'ADD',
        quantity: -1,
        piece: 'GOOD',
      },
      {
        ...place,
        entryId: '4',
        madeAt: '2026-01-01T08:03:00Z',
        action: 'PROBLEM',
        text: 'Tool broken',
      },
      {
        ...place,
        operationId: 'another',
        entryId: '5',
        madeAt: '2026-01-01T08:03:00Z',
        action: 'DONE',
      },
    ] satisfies NewEntry[]
    expect(expected(operation(), entries)).toEqual({
      state: 'Interrupted',
      good: 6,
      scrap: 0,
      problem: 'Tool broken',
      waiting: 4,
    })
  })
  it('covers the day of this place', () => {
    const { from, tomorrow } = today(new Date(2026, 2, 29, 13))
    expect([
      new Date(from).getHours(),
      new Date(tomorrow).getHours(),
      new Date(tomorrow).getDate(),
    ]).toEqual([0, 0, 30])
  })
})

describe('entries on their way', () => {
  let disk: Disk
  let connector: Connector
  const open = (): { queue: EntryQueue; close: () => void } => {
    const queue = new EntryQueue(disk, () => undefined, connector.send)
    return { queue, close: queue.open() }
  }
  beforeEach(() => {
    vi.useFakeTimers()
    disk = new Disk()
    connector = new Connector()
    signIn('eva')
  })
  afterEach(() => {
    vi.useRealTimers()
  })

  it('leave the queue when the connector answered for them', async () => {
    const { queue, close } = open()
    queue.record(place, { action: 'START' })
    expect(queue.own).toHaveLength(1)
    await vi.advanceTimersByTimeAsync(10)
    expect([connector.taken.length, queue.own.length, disk.stored.length]).toEqual([1, 0, 0])
    close()
  })
  it('stay on the disk through an outage and a reload with id and time, and count once', async () => {
    connector.isReachable = false
    const before = open()
    const entry = before.queue.record(place, { action: 'ADD', quantity: 1, piece: 'GOOD' })
    await vi.advanceTimersByTimeAsync(60_000)
    expect(before.queue.failingSince).toBeDefined()
    before.close()

    connector.isReachable = true
    connector.taken.push(entry) // It had arrived, and only the answer was lost.
    const after = open()
    await vi.advanceTimersByTimeAsync(10)
    expect(connector.taken).toEqual([entry])
    expect([after.queue.own.length, disk.stored.length, after.queue.failingSince]).toEqual([
      0,
      0,
      undefined,
    ])
    after.close()
  })
  it('are on their way to the disk until the browser has written them, and hold the page', async () => {
    connector.isReachable = false
    let write = (): void => undefined
    disk.put = () => new Promise((resolve) => (write = resolve))
    const { queue, close } = open()
    const isHeld = (): boolean => !dispatchEvent(new Event('beforeunload', { cancelable: true }))
    expect([queue.unwritten, isHeld()]).toEqual([0, false])
    queue.record(place, { action: 'START' })
    await vi.advanceTimersByTimeAsync(10)
    expect([queue.own.length, queue.unwritten, isHeld()]).toEqual([1, 1, true])
    write()
    await vi.advanceTimersByTimeAsync(10)
    expect([queue.own.length, queue.unwritten, isHeld()]).toEqual([1, 0, false])
    close()
  })
  it('of another person wait for that person', async () => {
    connector.isReachable = false
    const eva = open()
    eva.queue.record(place, { action: 'START' })
    await vi.advanceTimersByTimeAsync(10)
    eva.close()

    connector.isReachable = true
    signIn('otto')
    const otto = open()
    await vi.advanceTimersByTimeAsync(10)
    expect([otto.queue.own.length, otto.queue.foreign, connector.taken.length]).toEqual([0, 1, 0])
    otto.close()
  })
  it('that are refused are shown and removed from the queue', async () => {
    const queue = new EntryQueue(
      disk,
      () => undefined,
      (_, entries) =>
        Promise.resolve(
          entries.map(({ entryId }) => ({
            entryId,
            result: 'REFUSED' as const,
            fields: [],
            message: 'The operation was withdrawn.',
          })),
        ),
    )
    const close = queue.open()
    const { entryId } = queue.record(place, { action: 'DONE' })
    await vi.advanceTimersByTimeAsync(10)
    expect(queue.refused.map(({ message }) => message)).toEqual(['The operation was withdrawn.'])
    expect(disk.stored).toEqual([])
    queue.dismiss(entryId)
    expect(queue.refused).toEqual([])
    close()
  })
})
