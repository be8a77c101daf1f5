/** Which part of which chain, in the words of the connector's API. */
export interface LedgerFilter {
  recipient?: string
  /** RFC 3339: recorded then or later. */
  from?: string
  /** RFC 3339: recorded before then. */
  until?: string
}

export type ExportFormat = 'jsonl' | 'csv' | 'html'

/** What an input of date and time says, which is this machine's time, as a moment; none where it says nothing. */
export function momentOf(written: string): string | undefined {
  const at = new Date(written)
  return written === '' || Number.isNaN(at.getTime()) ? undefined : at.toISOString()
}

/** The filter with another time, or without one. */
export function withTime(filter: LedgerFilter, which: 'from' | 'until', written: string): LedgerFilter {
  const { [which]: _, ...others } = filter
  const at = momentOf(written)
  return at === undefined ? others : { ...others, [which]: at }
}
