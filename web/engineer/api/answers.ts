/** Where what the connector answers is not yet what the pages show. */
import type { LedgerEntry, LinkStatus, Page, Status } from './types'

/** The status while the connector may not be enrolled yet: then it has no link. */
export type StatusAnswer = Omit<Status, 'link'> & { link: LinkStatus | null }

export function statusOf({ link, ...others }: StatusAnswer): Status {
  return { ...others, link: link ?? { state: 'notConfigured', backlog: others.spool.waiting } }
}

export type LedgerAnswer = Page<LedgerEntry> & { recipients: string[] }

/** Members of a report that say where it belongs; all others are fields and their units. */
const HEADER = [
  'reportName',
  'dynamicDataRequestId',
  'operationId',
  'operationNetworkId',
  'shopfloorTimestamp',
]

/** Entries with the payload of their report taken apart: where it belongs, and the fields with their values. */
export function ledgerOf(answer: LedgerAnswer): LedgerAnswer {
  return { ...answer, items: answer.items.map(entryOf) }
}

function entryOf(entry: LedgerEntry): LedgerEntry {
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
