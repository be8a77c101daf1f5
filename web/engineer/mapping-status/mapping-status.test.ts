import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { FieldView, MappingStatus } from '../api/types'
import StatusPanel from './StatusPanel.svelte'

const HOUR_MS = 3_600_000
const key = {
  operationNetworkId: 'n',
  operationId: 'turn',
  dynamicDataRequestId: 'progress',
  fieldName: 'made',
}
const field = { key, name: 'made', type: 'UInt64', unit: 'PIECE' } as FieldView
const PATH = '/fields/n/turn/progress/made/mapping-status'
const at = '2026-01-02T03:04:05Z'
const well: MappingStatus = {
  mappingId: 'n/turn/progress/made',
  target: key,
  received: 1000,
  yielded: 998,
  repeated: 2,
  late: 0,
  clockSteps: 0,
  superseded: 0,
  faults: 0,
  lastYieldedAt: at,
  lastCandidate: { value: '42', status: 0 },
  spentUs: 2500,
  inputs: [{ name: 'parts', value: { value: 42, status: 0 }, receivedAt: at, clockAheadMs: 3 }],
  circuit: { state: 'closed' },
}
let status: MappingStatus
const text = (): string => document.body.textContent.replace(/\s+/g, ' ')

function show(): Asked[] {
  const log = serve({
    [`GET ${PATH}`]: () => status,
    [`POST ${PATH}/restart`]: () => {
      status = { ...status, circuit: { state: 'closed' } }
      return status
    },
  })
  render(StatusPanel, { field })
  return log
}

beforeEach(() => {
  status = well
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the status of a mapping', () => {
  it('shows the numbers of values and the time per value, without counters that are zero', async () => {
    show()
    expect(await screen.findByText('parts')).toBeTruthy()
    expect(text()).toContain('Received 1,000 Produced 998 Time per value 2.5 µs Repeats 2 Faults 0')
    expect(text()).not.toContain('Late')
    expect(text()).not.toMatch(/clock is|Measured/)
  })

  it('shows the position of a fault and a machine clock that is hours off', async () => {
    const [input] = well.inputs
    status = {
      ...well,
      faults: 3,
      lastFault: {
        at,
        kind: 'scriptError',
        message: 'ReferenceError: x is not defined',
        step: 1,
        line: 2,
        column: 7,
      },
      inputs: [
        { ...input, name: 'parts', clockAheadMs: 2 * HOUR_MS },
        { ...input, name: 'seldom', clockAheadMs: -3 * HOUR_MS },
      ],
    }
    show()
    expect(await screen.findByText('ReferenceError: x is not defined')).toBeTruthy()
    expect(text()).toContain('Function 2, line 2, column 7')
    expect(text()).toMatch(/clock is 2 h\w* ahead/)
    expect(text()).toMatch(/Measured 3 h\w* before it was received/)
  })

  it('has a button that retries a paused script', async () => {
    status = { ...well, circuit: { state: 'resting', until: at } }
    const log = show()
    await userEvent.click(await screen.findByRole('button', { name: 'Retry now' }))
    await vi.waitFor(() => expect(screen.queryByText('A script is paused')).toBeNull())
    expect(log.some(({ method, path }) => method === 'POST' && path === `${PATH}/restart`)).toBe(
      true,
    )
  })

  it('is not shown for a mapping that has ended', async () => {
    const log = serve({})
    render(StatusPanel, { field })
    await vi.waitFor(() => expect(log).toHaveLength(1))
    expect(screen.queryByText('Mapping status')).toBeNull()
  })
})
