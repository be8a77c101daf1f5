import type { LedgerEntry } from '../api/types'

/** Members of a report that name its request; all others are fields and their units. */
const HEADER = [
  'reportName',
  'dynamicDataRequestId',
  'operationId',
  'operationNetworkId',
  'shopfloorTimestamp',
  'recipientList',
]

/** Ids of the field or request that an entry is about, from the outside in. */
export function subjectOf(entry: LedgerEntry): string[] {
  if (entry.kind === 'CONSENT')
    return [
      entry.operationNetworkId,
      entry.operationId,
      entry.dynamicDataRequestId,
      entry.fieldName,
    ]
  return ['operationNetworkId', 'operationId', 'dynamicDataRequestId']
    .map((name) => bare(entry.value?.[name]))
    .filter((id) => typeof id === 'string')
}

/** Fields of the report of an entry, each with its bare value. */
export function fieldsOf({ value }: Pick<LedgerEntry, 'value'>): [string, unknown][] {
  const payload = value ?? {}
  const isField = (name: string): boolean =>
    !HEADER.includes(name) && !(name.endsWith('Unit') && name.slice(0, -4) in payload)
  return Object.entries(payload)
    .filter(([name]) => isField(name))
    .map(([name, encoded]) => [name, bare(encoded)])
}

/** A variant without its type. */
function bare(value: unknown): unknown {
  if (value === null || typeof value !== 'object') return value
  return 'Body' in value ? value.Body : 'Value' in value ? value.Value : value
}
