import type { FieldKey, LedgerExportQuery, LedgerQuery } from '../api/types'

/** Part of the ledger: a recipient, a time, a kind of entry, a subject. */
export type LedgerFilter = Omit<LedgerQuery, 'after' | 'limit'>
export type EntryKind = NonNullable<LedgerQuery['kind']>

export const ENTRY_KINDS = [
  'CONSENT',
  'QUEUED',
  'SENT',
  'RECEIPTED',
  'COALESCED',
  'EXPIRED',
  'PURGED',
  'REVOKED',
  'RETENTION',
  'PAST_RELEASED',
] as const satisfies readonly EntryKind[]

export type LedgerSubject = Pick<
  LedgerFilter,
  'operationNetworkId' | 'operationId' | 'dynamicDataRequestId' | 'fieldName'
>

/** Text of the subject of a filter; empty for all subjects. */
export function subjectText({
  operationNetworkId,
  operationId,
  dynamicDataRequestId,
  fieldName,
}: LedgerSubject): string {
  return [operationNetworkId, operationId, dynamicDataRequestId, fieldName]
    .filter((part) => part !== undefined)
    .join(' / ')
}

/** The filter about something else, or about everything. */
export function withSubject(
  { recipient, from, until, kind }: LedgerFilter,
  subject: LedgerSubject,
): LedgerFilter {
  return {
    ...(recipient === undefined ? {} : { recipient }),
    ...(from === undefined ? {} : { from }),
    ...(until === undefined ? {} : { until }),
    ...(kind === undefined ? {} : { kind }),
    ...subject,
  }
}

/** Only a part of the chain is meant. */
export function isNarrow({ recipient: _, ...others }: LedgerFilter): boolean {
  return Object.keys(others).length > 0
}

/** Fields as they are found, each request before its fields. */
export function subjectsOf(keys: readonly FieldKey[]): LedgerSubject[] {
  const subjects = new Map<string, LedgerSubject>()
  for (const { fieldName, ...request } of keys) {
    for (const subject of [request, { ...request, fieldName }])
      subjects.set(subjectText(subject), subject)
  }
  return [...subjects.values()]
}

export type ExportFormat = LedgerExportQuery['format']

/** Converts the text of a local date and time input to a moment; `undefined` if it is empty. */
export function momentOf(written: string): string | undefined {
  const at = new Date(written)
  return written === '' || Number.isNaN(at.getTime()) ? undefined : at.toISOString()
}

/** The filter with entries of one kind, or of all. */
export function withKind(filter: LedgerFilter, kind: EntryKind | ''): LedgerFilter {
  const { kind: _, ...others } = filter
  return kind === '' ? others : { ...others, kind }
}

/** The filter with another time, or without one. */
export function withTime(
  filter: LedgerFilter,
  which: 'from' | 'until',
  written: string,
): LedgerFilter {
  const { [which]: _, ...others } = filter
  const at = momentOf(written)
  return at === undefined ? others : { ...others, [which]: at }
}
