import { isoDuration } from '@/format/time'
import type { GraphOperation, GraphRelation, Standing } from './model'

/** Differences below this are noise of clocks and rounding. */
const NOISE_MS = 60_000
const ENDED = new Set(['Ended', 'Aborted'])
const BEGUN = new Set(['Running', 'Interrupted', ...ENDED])

/** Operations with how each stands against the plan at a moment. */
export function withStandings(
  operations: readonly GraphOperation[],
  relations: readonly GraphRelation[],
  now: number,
): GraphOperation[] {
  const found = standings(operations, relations, now)
  return operations.map((operation) => ({
    ...operation,
    standing: found.get(operation.operationId),
  }))
}

function standings(
  operations: readonly GraphOperation[],
  relations: readonly GraphRelation[],
  now: number,
): Map<string, Standing> {
  const found = new Map<string, Standing>()
  for (const operation of operations) {
    const standing = lateness(operation, now)
    if (standing !== undefined) found.set(operation.operationId, standing)
  }
  const byId = new Map(operations.map((operation) => [operation.operationId, operation]))
  // Along the chain: what is held up cannot end in time either.
  const ends = new Map<string, number>()
  for (const operation of operations) {
    const end = lateEnd(operation, found.get(operation.operationId))
    if (end !== undefined) ends.set(operation.operationId, end)
  }
  const following = new Map<string, GraphRelation[]>()
  for (const relation of relations) {
    const known = following.get(relation.predecessorOperationId)
    if (known === undefined) following.set(relation.predecessorOperationId, [relation])
    else known.push(relation)
  }
  const waiting = [...ends.keys()]
  for (let steps = 0; waiting.length > 0 && steps < operations.length ** 2; steps += 1) {
    const from = waiting.shift() ?? ''
    const end = ends.get(from) ?? 0
    for (const relation of following.get(from) ?? []) {
      const next = byId.get(relation.successorOperationId)
      const start = time(next?.plannedStart)
      const earliest = earliestStart(relation, end)
      if (next === undefined || start === undefined || earliest === undefined) continue
      if (hasBegun(next) || earliest - start < NOISE_MS) continue
      const known = found.get(next.operationId)
      found.set(next.operationId, { ...known, heldUpBy: known?.heldUpBy ?? from })
      const length = (time(next.plannedEnd) ?? start) - start
      if (earliest + length > (ends.get(next.operationId) ?? 0)) {
        ends.set(next.operationId, earliest + length)
        waiting.push(next.operationId)
      }
    }
  }
  return found
}

function hasBegun({ actualStart, state }: GraphOperation): boolean {
  return actualStart !== undefined || BEGUN.has(state ?? '')
}

/** Earliest start of the operation that waits for another one's end. */
function earliestStart(relation: GraphRelation, end: number): number | undefined {
  if (relation.relationType !== 'FINISH_TO_START') return undefined
  const gaps = relation.conditionList
    .filter(({ conditionKind }) => conditionKind === 'MINIMUM_GAP')
    .map(({ duration }) => (duration ? (isoDuration(duration) ?? 0) : 0))
  return end + Math.max(0, ...gaps)
}

function lateness(operation: GraphOperation, now: number): Standing | undefined {
  const planned = time(operation.plannedEnd)
  if (planned === undefined) return undefined
  const stated = time(operation.actualEnd ?? operation.expectedEnd)
  const hasEnded = operation.actualEnd !== undefined || ENDED.has(operation.state ?? '')
  if (stated === undefined && hasEnded) return undefined
  // An expected end that has passed is no better than none.
  const end = hasEnded ? (stated ?? planned) : Math.max(stated ?? now, now)
  if (!hasEnded && stated === undefined && now < planned) return undefined
  const lateMs = end - planned
  if (lateMs < NOISE_MS) return undefined
  return stated === undefined ? { lateMs, isOverdue: true } : { lateMs }
}

function lateEnd(operation: GraphOperation, standing: Standing | undefined): number | undefined {
  const planned = time(operation.plannedEnd)
  return planned === undefined || standing?.lateMs === undefined
    ? undefined
    : planned + standing.lateMs
}

function time(text: string | undefined): number | undefined {
  const at = text === undefined ? Number.NaN : Date.parse(text)
  return Number.isNaN(at) ? undefined : at
}
