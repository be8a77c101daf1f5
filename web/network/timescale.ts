import type { GraphOperation } from './model'

/** A stretch of time and the ticks to draw on it. */
export interface Timescale {
  start: number
  end: number
  ticks: number[]
  /** Distance of the ticks in milliseconds. */
  step: number
  /** Returns the position of a moment as a share of the width, 0 to 1. */
  at: (moment: number) => number
}

const MINUTE = 60_000
const HOUR = 60 * MINUTE
const DAY = 24 * HOUR
const STEPS = [
  MINUTE,
  5 * MINUTE,
  15 * MINUTE,
  30 * MINUTE,
  HOUR,
  3 * HOUR,
  6 * HOUR,
  12 * HOUR,
  DAY,
  2 * DAY,
  7 * DAY,
  14 * DAY,
  30 * DAY,
  91 * DAY,
  365 * DAY,
]
const TICKS_MAX = 5

/**
 * Scale that covers all planned and actual times and the present; `undefined` if there are none.
 */
export function timescale(
  operations: readonly GraphOperation[],
  now: number,
): Timescale | undefined {
  const moments = operations
    .flatMap((operation) => [
      operation.plannedStart,
      operation.plannedEnd,
      operation.actualStart,
      operation.actualEnd,
      operation.expectedEnd,
    ])
    .filter((moment) => moment !== undefined)
    .map((moment) => Date.parse(moment))
    .filter((moment) => !Number.isNaN(moment))
  if (moments.length === 0) return undefined
  let first = Math.min(...moments)
  let last = Math.max(...moments)
  // The present is shown where it is near; a plan of long ago is not squeezed for it.
  const length = Math.max(last - first, HOUR)
  if (now > first - length && now < last + length) {
    first = Math.min(first, now)
    last = Math.max(last, now)
  }
  const margin = Math.max(last - first, MINUTE) * 0.04
  const start = first - margin
  const end = last + margin
  const step = STEPS.find((size) => (end - start) / size <= TICKS_MAX) ?? (end - start) / TICKS_MAX
  const offset = new Date(start).getTimezoneOffset() * MINUTE
  const ticks: number[] = []
  for (let tick = Math.ceil((start - offset) / step) * step + offset; tick <= end; tick += step)
    ticks.push(tick)
  return { start, end, ticks, step, at: (moment) => (moment - start) / (end - start) }
}
