/** What the connector answers, made into what the pages show. */
import type { DataValue, DeadLetter, Diagnostic, Disclosure, LedgerEntry, LinkStatus, Page, Preview, SourceStatus, SpoolStatus, Status, Verification } from './types'

export interface StatusAnswer {
  factoryId: string
  version: string
  startedAt: string
  /** Absent while the connector is not enrolled. */
  link: (Omit<LinkStatus, 'backlog'> & { backlog?: SpoolStatus | null }) | null
  twin: { endpointUrl?: string | null }
  spool: SpoolStatus
  sources: SourceStatus[]
}

export function statusOf({ link, ...others }: StatusAnswer): Status {
  return { ...others, link: link === null ? { state: 'notConfigured', backlog: others.spool.waiting } : { ...link, backlog: link.backlog?.waiting ?? others.spool.waiting } }
}

export interface PreviewAnswer {
  inputs: Preview['inputs']
  steps: { function: string; value?: DataValue | null; fault?: { message: string; line?: number | null; column?: number | null } | null }[]
  candidate?: DataValue | null
  disclosed?: DataValue | null
  message?: string | null
  diagnostics: Diagnostic[]
}

export function previewOf({ steps, ...others }: PreviewAnswer): Preview {
  return { ...others, steps: steps.map((step) => ({ function: step.function, value: step.value ?? null, message: step.fault?.message ?? null })) }
}

interface LedgerRow {
  number: number
  hash: string
  entry: {
    recipient: string
    recordedAt: string
    event: string
    field?: { operationNetworkId: string; operationId: string; dynamicDataRequestId: string; fieldName: string }
    policy?: Disclosure
    dataSetWriterId?: number
    epoch?: number
    firstSequence?: number
    lastSequence?: number
  }
  report?: { Payload?: Record<string, unknown> } | null
}

export interface LedgerAnswer {
  recipients: string[]
  items: LedgerRow[]
  nextCursor?: string | null
}

/** Members of a report that say where it belongs; all others are fields and their units. */
const HEADER = ['reportName', 'dynamicDataRequestId', 'operationId', 'operationNetworkId', 'shopfloorTimestamp']

export function ledgerOf(answer: LedgerAnswer): Page<LedgerEntry> & { recipients: string[] } {
  return { recipients: answer.recipients, nextCursor: answer.nextCursor ?? null, items: answer.items.map(entryOf) }
}

function entryOf({ number, hash, entry, report }: LedgerRow): LedgerEntry {
  const payload = report?.Payload ?? {}
  const isField = (name: string): boolean => !HEADER.includes(name) && !(name.endsWith('Unit') && name.slice(0, -4) in payload)
  const said = (name: string): string | null => {
    const value = bare(payload[name])
    return typeof value === 'string' ? value : null
  }
  const fields = Object.entries(payload).filter(([name]) => isField(name))
  return {
    sequence: number,
    hash,
    at: entry.recordedAt,
    recipientId: entry.recipient,
    kind: entry.event,
    operationNetworkId: entry.field?.operationNetworkId ?? said('operationNetworkId'),
    operationId: entry.field?.operationId ?? said('operationId'),
    dynamicDataRequestId: entry.field?.dynamicDataRequestId ?? said('dynamicDataRequestId'),
    fieldName: entry.field?.fieldName ?? null,
    value: fields.length === 0 ? null : Object.fromEntries(fields.map(([name, value]) => [name, bare(value)])),
    policy: entry.policy ?? null,
    dataSetWriterId: entry.dataSetWriterId ?? null,
    epoch: entry.epoch ?? null,
    firstSequence: entry.firstSequence ?? null,
    lastSequence: entry.lastSequence ?? null,
  }
}

function bare(value: unknown): unknown {
  if (value === null || typeof value !== 'object') return value
  return 'Body' in value ? value.Body : 'Value' in value ? value.Value : value
}

export interface VerificationAnswer {
  isIntact: boolean
  entries: number
  valuesCompared: number
  valuesEmptied: number
  checkpoints: number
  faultList: { recipient: string; number: number; message: string }[]
}

export function verificationOf({ isIntact, faultList, ...others }: VerificationAnswer): Verification {
  const first = faultList[0]
  return { ...others, valid: isIntact, fault: first === undefined ? null : `${first.recipient} ${first.number}: ${first.message}` }
}

export type DeadLetterAnswer = Omit<DeadLetter, 'id' | 'at'> & { id: number; occurredAt: string }

export function lettersOf(page: Page<DeadLetterAnswer>): Page<DeadLetter> {
  return { nextCursor: page.nextCursor ?? null, items: page.items.map(({ id, occurredAt, ...others }) => ({ ...others, id: String(id), at: occurredAt })) }
}
