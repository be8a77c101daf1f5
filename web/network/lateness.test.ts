import { describe, expect, it } from 'vitest'
import { withStandings } from './lateness'
import { standingText, stateText, type GraphOperation, type GraphRelation } from './model'

const at = (hour: number): string => new Date(Date.UTC(2027, 0, 1, hour)).toISOString()
const operation = (operationId: string, more: Partial<GraphOperation> = {}): GraphOperation => ({
  operationId,
  name: operationId,
  operationType: 'PRODUCTION',
  isStub: false,
  plannedStart: at(8),
  plannedEnd: at(10),
  fields: { mapped: 0, pending: 0, refused: 0 },
  ...more,
})
const relation = (from: string, to: string, more: Partial<GraphRelation> = {}): GraphRelation => ({
  operationRelationId: `${from}-${to}`,
  predecessorOperationId: from,
  successorOperationId: to,
  relationType: 'FINISH_TO_START',
  conditionList: [],
  ...more,
})
const HOUR = 3_600_000
const standing = (operations: GraphOperation[], relations: GraphRelation[], hour: number) =>
  Object.fromEntries(
    withStandings(operations, relations, Date.parse(at(hour))).map((each) => [
      each.operationId,
      each.standing,
    ]),
  )

describe('the standing of an operation', () => {
  it.each([
    ['in time before its planned end', {}, 9, undefined],
    ['overdue with nothing reported', {}, 12, { lateMs: 2 * HOUR, isOverdue: true }],
    ['late as the factory expects', { expectedEnd: at(13) }, 9, { lateMs: 3 * HOUR }],
    ['later than an expected end that passed', { expectedEnd: at(11) }, 12, { lateMs: 2 * HOUR }],
    ['late as it ended', { state: 'Ended', actualEnd: at(11) }, 20, { lateMs: HOUR }],
    ['ended in time', { state: 'Ended', actualEnd: at(9) }, 20, undefined],
    ['ended at a time unknown', { state: 'Ended' }, 20, undefined],
    ['without a plan', { plannedEnd: undefined }, 20, undefined],
  ] as const)('is %s', (_, more, hour, expected) => {
    expect(standing([operation('a', more)], [], hour)).toEqual({ a: expected })
  })

  it('hits what waits for it, along the chain, by what the plan leaves as slack', () => {
    const chain = [
      operation('a', { expectedEnd: at(14) }),
      operation('b', { plannedStart: at(12), plannedEnd: at(16) }),
      operation('c', { plannedStart: at(17), plannedEnd: at(18) }),
      operation('d', { plannedStart: at(20), plannedEnd: at(21) }),
      operation('beside', { plannedStart: at(10), plannedEnd: at(20) }),
    ]
    const relations = [relation('a', 'b'), relation('b', 'c'), relation('c', 'd')]
    expect(standing(chain, relations, 9)).toEqual({
      a: { lateMs: 4 * HOUR },
      b: { heldUpBy: 'a' },
      c: { heldUpBy: 'b' },
      d: undefined,
      beside: undefined,
    })
  })

  it('leaves what has started and what waits for another end alone, and counts gaps', () => {
    const late = operation('a', { expectedEnd: at(11) })
    const next = operation('b', { plannedStart: at(12), plannedEnd: at(13) })
    const gap = relation('a', 'b', {
      conditionList: [{ conditionId: 'g', conditionKind: 'MINIMUM_GAP', duration: 'PT2H' }],
    })
    expect(standing([late, next], [relation('a', 'b')], 9)['b']).toBeUndefined()
    expect(standing([late, next], [gap], 9)['b']).toEqual({ heldUpBy: 'a' })
    const begun = { ...next, actualStart: at(9) }
    expect(standing([late, begun], [gap], 9)['b']).toBeUndefined()
    for (const state of ['Running', 'Interrupted', 'Ended'] as const)
      expect(standing([late, { ...next, state }], [gap], 9)['b']).toBeUndefined()
    const waiting = { ...next, state: 'AllowedToStart' as const }
    expect(standing([late, waiting], [gap], 9)['b']).toEqual({ heldUpBy: 'a' })
    const beside = { ...gap, relationType: 'START_TO_START' as const }
    expect(standing([late, next], [beside], 9)['b']).toBeUndefined()
  })

  it('ends for relations in a circle', () => {
    const circle = [operation('a', { expectedEnd: at(14) }), operation('b')]
    const relations = [relation('a', 'b'), relation('b', 'a')]
    expect(standing(circle, relations, 9)['b']).toEqual({ heldUpBy: 'a' })
  })

  it('is said in words', () => {
    const [overdue] = withStandings([operation('a')], [], Date.parse(at(12)))
    expect(overdue && standingText(overdue)).toBe('2 h overdue')
    const [late] = withStandings([operation('a', { expectedEnd: at(13) })], [], Date.parse(at(9)))
    expect(late && standingText(late)).toBe('3 h late')
    expect(standingText(operation('a'))).toBeUndefined()
    const running = operation('a', { state: 'Running' })
    expect(stateText(running)).toBe('Running')
    expect(stateText({ ...running, isStateInferred: true })).toBe('Running (concluded)')
    expect(stateText(operation('a', { isStateInferred: true }))).toBe('No state reported')
  })
})
