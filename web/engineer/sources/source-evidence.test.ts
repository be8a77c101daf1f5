import { render, screen } from '@testing-library/svelte'
import { expect, it } from 'vitest'
import type { Resource } from '@/transport/resource.svelte'
import type { SourceStatus } from '../api/types'
import type { ShownCertificate } from './certificates.svelte'
import SourceEvidence from './SourceEvidence.svelte'

const certificates = { value: [] } as unknown as Resource<ShownCertificate[]>

function show(changes: Partial<SourceStatus>): void {
  const source: SourceStatus = {
    sourceId: 'press',
    state: 'connected',
    since: '2026-03-01T00:00:00Z',
    inputs: 0,
    live: 0,
    findable: 0,
    notLive: [],
    changes: 0,
    sessions: 1,
    coarse: [],
    filled: [],
    ...changes,
  }
  render(SourceEvidence, { source, certificates })
}

it('says what to do about a clock that is wrong, and nothing about one that is right', () => {
  show({ clockAheadMs: 7_200_000 })
  expect(screen.getByText(/Its clock is 2 h ahead of ours.*best by NTP/)).toBeTruthy()
})

it('has nothing to say about a clock that is right', () => {
  show({ clockAheadMs: 120 })
  expect(screen.queryByText(/NTP/)).toBeNull()
})

it('says each limit of a small controller, as granted and as stated', () => {
  const granted = { publishingMs: 500, keepAliveMs: 1500, silenceMsMax: 5000 }
  const limits = {
    itemsPerCallMax: 10,
    subscriptionsPerSessionMax: 2,
    sessionsMax: 3,
    queueSizeMax: 1,
  }
  show({
    granted: { ...granted, samplingMs: 250, queueSize: 1 },
    limits,
    coarse: [
      { input: 7, nodeId: 'nsu=urn:press;i=7', samplingMs: 250, queueSize: 1, overflows: 0 },
    ],
  })
  for (const said of [
    /changes every 500 ms, a sign of life every 1.?500 ms/,
    /looks every 250 ms and keeps the newest change of an input/,
    /10 items per call, 2 subscriptions per session, 3 sessions, 1 in the queue of an item/,
    'The server keeps the newest change between two messages and looks every 250 ms.',
  ]) {
    expect(screen.getByText(said)).toBeTruthy()
  }
})

it('leads from a certificate that a machine refuses to where it is handed out', () => {
  const problem = { kind: 'clientCertificateOutOfTime' as const, message: '…', remedy: '' }
  show({ state: 'waiting', problem })
  expect(screen.getByText(/many controllers start in 1970/)).toBeTruthy()
  expect(screen.getByRole('link', { name: 'Certificate of this connector' })).toBeTruthy()
})

it('says which inputs caught up with what they had missed', () => {
  const gap = { nodeId: 'nsu=urn:press;s=Counter', since: '2026-03-01T10:00:00Z' }
  show({
    filled: [
      { ...gap, input: 1, values: 119, isComplete: true },
      { ...gap, input: 2, values: 1000, isComplete: false },
    ],
  })
  expect(screen.getByText('Inputs that caught up')).toBeTruthy()
  expect(screen.getByText(/^119 values since/)).toBeTruthy()
  expect(screen.getByText(/^1.?000 values since.*some are missing/)).toBeTruthy()
})
