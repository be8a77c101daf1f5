import { afterEach, describe, expect, it, vi } from 'vitest'
import { Resource } from '@/transport/resource.svelte'
import { serve } from '../vitest.server'
import type { InboxRequest } from './api/types'
import { connectorStore } from './connector-store.svelte'

class FakeEventSource extends EventTarget {
  static newest: FakeEventSource | undefined
  onopen: (() => void) | null = null
  onerror: (() => void) | null = null
  constructor() {
    super()
    FakeEventSource.newest = this
  }
  close(): void {
    FakeEventSource.newest = undefined
  }
}

afterEach(() => {
  vi.unstubAllGlobals()
  vi.useRealTimers()
})

describe('what every page looks at', () => {
  it('is read again when rules have decided, and not before', async () => {
    vi.useFakeTimers()
    vi.stubGlobal('EventSource', FakeEventSource)
    const totals = {
      requests: 1,
      openRequests: 0,
      overdueRequests: 0,
      endedRequests: 0,
      pending: 0,
      mapped: 0,
      refused: 0,
    }
    const log = serve({ 'GET /inbox': () => ({ items: [], count: 0, totals }) })
    const counted = (): number => log.filter(({ path }) => path === '/inbox?limit=1').length
    const read = vi.fn(() => Promise.resolve({ items: [] as InboxRequest[] }))
    const stops = [connectorStore.open(), connectorStore.keep(new Resource(read))]
    await vi.advanceTimersByTimeAsync(60_000)
    expect([counted(), read.mock.calls.length]).toEqual([1, 0])

    FakeEventSource.newest?.dispatchEvent(
      new MessageEvent('decisions', { data: '{"count":3,"ruleCount":3}' }),
    )
    await vi.advanceTimersByTimeAsync(60_000)
    expect([counted(), read.mock.calls.length]).toEqual([2, 1])
    for (const stop of stops) stop()
  })

  it('leaves decisions on fields that no page shows to the other events', async () => {
    vi.useFakeTimers()
    vi.stubGlobal('EventSource', FakeEventSource)
    const log = serve({})
    const stop = connectorStore.open()
    await vi.advanceTimersByTimeAsync(1_000)
    const before = log.filter(({ path }) => path.startsWith('/inbox')).length
    const key = {
      operationNetworkId: 'n',
      operationId: 'op',
      dynamicDataRequestId: 'R',
      fieldName: 'count',
    }
    FakeEventSource.newest?.dispatchEvent(
      new MessageEvent('field', { data: JSON.stringify({ key, mappingState: 'REFUSED' }) }),
    )
    await vi.advanceTimersByTimeAsync(1_000)
    expect(log.filter(({ path }) => path.startsWith('/inbox'))).toHaveLength(before)
    stop()
  })
})
