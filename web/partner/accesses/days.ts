import type { AccessView } from '../api/types'

const DAY_MS = 24 * 60 * 60 * 1000
/** Most days that are drawn; the newest. */
const DAYS_MAX = 60

/** A day in this machine's time zone, with the values that were read in it. */
export interface DayOfAccesses {
  /** Its beginning. */
  at: number
  values: number
}

/** The days from the first entry to the last, those without any in between included. */
export function days(entries: readonly AccessView[]): DayOfAccesses[] {
  const counts = new Map<number, number>()
  for (const entry of entries) {
    const at = new Date(entry.recordedAt).setHours(0, 0, 0, 0)
    counts.set(at, (counts.get(at) ?? 0) + entry.valueCount)
  }
  const last = Math.max(...counts.keys())
  const first = Math.max(Math.min(...counts.keys()), last - (DAYS_MAX - 1) * DAY_MS)
  const all: DayOfAccesses[] = []
  // By half days past noon: a day on which the clock is changed has 23 or 25 hours.
  for (let noon = first + DAY_MS / 2; noon < last + DAY_MS; noon += DAY_MS) {
    const at = new Date(noon).setHours(0, 0, 0, 0)
    all.push({ at, values: counts.get(at) ?? 0 })
  }
  return all
}
