import { describe, expect, it } from 'vitest'
import type { AccessView } from '../api/types'
import { days } from './days'

const entry = (recordedAt: string, valueCount: number): AccessView => ({
  number: 1,
  recordedAt,
  since: recordedAt,
  viewer: 'acme',
  agentKind: 'USER',
  agentId: '00ff',
  access: 'LOOKED',
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fields: ['made'],
  valueCount,
})

describe('days of accesses', () => {
  it('are counted, with those between them', () => {
    const found = days([
      entry('2026-03-30T12:00:00', 1),
      entry('2026-03-28T13:00:00', 2),
      entry('2026-03-28T01:00:00', 3),
    ])
    expect(found.map((day) => day.values)).toEqual([5, 0, 1])
    expect(found[0]?.at).toBe(new Date('2026-03-28T00:00:00').getTime())
  })

  it('are none without entries, and bounded with many', () => {
    expect(days([])).toEqual([])
    expect(days([entry('2026-11-24T12:00:00', 1), entry('2020-01-01T12:00:00', 1)])).toHaveLength(
      60,
    )
  })
})
