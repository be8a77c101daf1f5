import type { NewEntry, OperationState, OperatorOperation } from '../api/types'

/**
 * Entry with its author. On a shared tablet each person's entries are sent in that person's name.
 */
export interface StoredEntry {
  entry: NewEntry
  userName: string
}

/** Expected state of an operation once all entries that wait to be sent have arrived. */
export interface Expected {
  state: OperationState | null
  good: number
  scrap: number
  problem: string | null
  waiting: number
}

/** Applies the entries that the connector does not have yet to its state, in order of their time. */
export function expected(operation: OperatorOperation, waiting: readonly NewEntry[]): Expected {
  const { standing } = operation
  const own = waiting.filter(
    (entry) =>
      entry.operationId === operation.operationId &&
      entry.operationNetworkId === operation.operationNetworkId,
  )
  const result: Expected = {
    state: standing.state ?? null,
    good: standing.goodQuantity,
    scrap: standing.scrapQuantity,
    problem: standing.problem?.text ?? null,
    waiting: own.length,
  }
  for (const entry of own.toSorted((a, b) => a.madeAt.localeCompare(b.madeAt))) {
    switch (entry.action) {
      case 'START':
        result.state = 'Running'
        result.problem = null
        break
      case 'DONE':
        result.state = 'Ended'
        break
      case 'PROBLEM':
        result.state = 'Interrupted'
        result.problem = entry.text
        break
      case 'ADD': {
        const { piece = 'GOOD', quantity = 1 } = entry
        if (piece === 'GOOD') result.good = Math.max(0, result.good + quantity)
        else result.scrap = Math.max(0, result.scrap + quantity)
        break
      }
      case 'VALUE':
        break
    }
  }
  return result
}

const DAYS_AHEAD = 7

/** Local midnights: today's (`from`), tomorrow's, and a week ahead, where the query ends (`until`). */
export function today(now = new Date()): { from: string; tomorrow: string; until: string } {
  const midnight = (days: number): string =>
    new Date(now.getFullYear(), now.getMonth(), now.getDate() + days).toISOString()
  return { from: midnight(0), tomorrow: midnight(1), until: midnight(DAYS_AHEAD) }
}

/** Present time in ISO 8601. */
export function moment(): string {
  return new Date().toISOString()
}
