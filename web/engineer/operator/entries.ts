import type { OperatorOperation } from '../api/types'

/** What a person at a machine says, as it is kept until the connector has it. */
export type Said =
  | { action: 'START' }
  | { action: 'DONE' }
  | { action: 'ADD'; quantity: number; piece: 'GOOD' | 'SCRAP' }
  | { action: 'PROBLEM'; text: string }
  | { action: 'VALUE'; dynamicDataRequestId: string; fieldName: string; value: unknown }

export type Entry = Said & {
  entryId: string
  operationNetworkId: string
  operationId: string
  madeAt: string
}

/** An entry with who made it: on a shared tablet each person's entries are delivered under that person's own name. */
export interface KeptEntry {
  entry: Entry
  userName: string
}

/** How an operation stands once everything that waits to be sent has arrived. */
export interface Expected {
  state: string | null
  good: number
  scrap: number
  problem: string | null
  waiting: number
}

/** The connector's word with the entries laid over it that it does not have yet, in the order in which they were made. */
export function expected(operation: OperatorOperation, waiting: readonly Entry[]): Expected {
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
      case 'ADD':
        if (entry.piece === 'GOOD') result.good = Math.max(0, result.good + entry.quantity)
        else result.scrap = Math.max(0, result.scrap + entry.quantity)
        break
      case 'VALUE':
        break
    }
  }
  return result
}

const DAYS_AHEAD = 7

/** From this place's midnight to the next, and a week on: `until` is where what is asked for ends, `tomorrow` where today does. */
export function today(now = new Date()): { from: string; tomorrow: string; until: string } {
  const midnight = (days: number): string =>
    new Date(now.getFullYear(), now.getMonth(), now.getDate() + days).toISOString()
  return { from: midnight(0), tomorrow: midnight(1), until: midnight(DAYS_AHEAD) }
}

/** This moment, as it is written. */
export function moment(): string {
  return new Date().toISOString()
}
