import { describe, expect, it } from 'vitest'
import { layered, type LayoutSizes } from './layout'
import { completion, conditionText, type GraphOperation } from './model'
import { timescale } from './timescale'

const SIZES: LayoutSizes = { boxWidth: 100, boxHeight: 50, gapX: 20, gapY: 10, margin: 5 }
const edge = (from: string, to: string): { from: string; to: string } => ({ from, to })

describe('layered', () => {
  it('puts what waits to the right of what it waits for', () => {
    const edges = [edge('a', 'c'), edge('b', 'c'), edge('c', 'd'), edge('a', 'd')]
    const { boxes } = layered(['d', 'c', 'b', 'a'], edges, SIZES)
    for (const { from, to } of edges) expect(boxes.get(from)?.x).toBeLessThan(boxes.get(to)?.x ?? 0)
  })
  it('lets no two boxes overlap', () => {
    const ids = Array.from({ length: 40 }, (_, index) => `o${index}`)
    const edges = ids.slice(1).map((id, index) => edge(`o${Math.floor(index / 3)}`, id))
    const { boxes, width, height } = layered(ids, edges, SIZES)
    const all = [...boxes.values()]
    expect(all).toHaveLength(40)
    for (const [index, a] of all.entries()) {
      expect(
        a.x >= 0 && a.y >= 0 && a.x + SIZES.boxWidth <= width && a.y + SIZES.boxHeight <= height,
      ).toBe(true)
      for (const b of all.slice(index + 1))
        expect(
          Math.abs(a.x - b.x) >= SIZES.boxWidth || Math.abs(a.y - b.y) >= SIZES.boxHeight,
        ).toBe(true)
    }
  })
  it('removes a crossing', () => {
    const { boxes } = layered(['a', 'b', 'x', 'y'], [edge('a', 'y'), edge('b', 'x')], SIZES)
    const y = (id: string): number => boxes.get(id)?.y ?? 0
    expect(Math.sign(y('a') - y('b'))).toBe(Math.sign(y('y') - y('x')))
  })
  it('survives a cycle', () => {
    expect(layered(['a', 'b'], [edge('a', 'b'), edge('b', 'a')], SIZES).boxes.size).toBe(2)
  })
})

const operation = (more: Partial<GraphOperation>): GraphOperation => ({
  operationId: 'o',
  name: 'o',
  operationType: 'PRODUCTION',
  isStub: false,
  fields: { mapped: 0, pending: 0, refused: 0 },
  ...more,
})

describe('completion', () => {
  it.each([
    [{ percentComplete: 40, quantity: 12, plannedQuantity: 12 }, 0.4],
    [{ quantity: 3, plannedQuantity: 12 }, 0.25],
    [{ quantity: 15, plannedQuantity: 12 }, 1],
    [{ plannedQuantity: 12 }, undefined],
    [{ quantity: 1, plannedQuantity: 0 }, undefined],
  ])('%j', (more, share) => {
    expect(completion(operation(more))).toBe(share)
  })
})

describe('timescale', () => {
  const plan = operation({
    plannedStart: '2026-11-21T06:00:00Z',
    plannedEnd: '2026-11-22T16:00:00Z',
  })
  it('holds everything that is drawn, the present included', () => {
    const now = Date.parse('2026-11-22T20:00:00Z')
    const scale = timescale([plan], now)
    for (const at of [Date.parse('2026-11-21T06:00:00Z'), now]) {
      expect(scale?.at(at)).toBeGreaterThan(0)
      expect(scale?.at(at)).toBeLessThan(1)
    }
    expect(scale?.ticks.length).toBeLessThanOrEqual(6)
  })
  it('is not squeezed by a present far away', () => {
    const scale = timescale([plan], Date.parse('2030-01-01T00:00:00Z'))
    expect((scale?.end ?? 0) < Date.parse('2026-11-24T00:00:00Z')).toBe(true)
  })
  it('needs a time', () => {
    expect(timescale([operation({})], 0)).toBeUndefined()
  })
})

it('conditions are sentences', () => {
  expect(conditionText({ conditionId: 'c', conditionKind: 'MAXIMUM_GAP', duration: 'PT8H' })).toBe(
    'gap of at most 8 h',
  )
})
