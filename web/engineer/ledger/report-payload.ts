import type { LedgerEntry } from '../api/types'

/** Members of a report that name its request; all others are fields and their units. */
const HEADER = [
  'reportName',
  'dynamicDataRequestId',
  'operationId',
  'operationNetworkId',
  'shopfloorTimestamp',
]

/**
 * The entry with the payload of its report taken apart: the request that it belongs to, and the
 * fields with their values.
 */
export function entryOf(entry: LedgerEntry): LedgerEntry {
  const payload = entry.value ?? {}
  const isField = (name: string): boolean =>
    !HEADER.includes(name) && !(name.endsWith('Unit') && name.slice(0, -4) in payload)
  const said = (name: string): string | null => {
    const value = bare(payload[name])
    return typeof value === 'string' ? value : null
  }
  const fields = Object.entries(payload).filter(([name]) => isField(name))
  return {
    ...entry,
    operationNetworkId: entry.operationNetworkId ?? said('operationNetworkId'),
    operationId: entry.operationId ?? said('operationId'),
    dynamicDataRequestId: entry.dynamicDataRequestId ?? said('dynamicDataRequestId'),
    value:
      fields.length === 0
        ? null
        : Object.fromEntries(fields.map(([name, value]) => [name, bare(value)])),
  }
}

/** A variant without its type. */
function bare(value: unknown): unknown {
  if (value === null || typeof value !== 'object') return value
  return 'Body' in value ? value.Body : 'Value' in value ? value.Value : value
}
