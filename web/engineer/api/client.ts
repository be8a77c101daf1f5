import { path, query, request } from '@/transport/http'
import { LiveFeed } from '@/transport/live.svelte'
import type { Entry } from '../operator/entries'
import { ledgerOf, statusOf, type LedgerAnswer, type StatusAnswer } from './answers'
import type {
  BrowsedNode,
  Certificate,
  ClientCertificate,
  Comment,
  DataValue,
  DeadLetter,
  Decision,
  Disclosure,
  EntryOutcome,
  Field,
  FieldKey,
  Found,
  InboxRequest,
  Mapping,
  NewClientCertificate,
  NewComment,
  OperatorOperation,
  Page,
  Preview,
  Setting,
  Source,
  SourceConfig,
  SpoolStatus,
  Status,
  Suggestions,
  ValueSource,
  Verification,
} from './types'

const fieldPath = (key: FieldKey): string => path('fields', key.operationNetworkId, key.operationId, key.dynamicDataRequestId, key.fieldName)

/** The connector's API. */
export const connector = {
  status: async (signal?: AbortSignal): Promise<Status> => statusOf(await request<StatusAnswer>('GET', '/status', { signal })),
  configuration: (signal?: AbortSignal) => request<Page<Setting>>('GET', '/configuration', { signal }),
  inbox: (cursor?: string, signal?: AbortSignal) => request<Page<InboxRequest>>('GET', `/inbox${query({ cursor })}`, { signal }),
  suggestions: (key: FieldKey, limit: number, signal?: AbortSignal) => request<Suggestions>('GET', `${fieldPath(key)}/suggestions${query({ limit })}`, { signal }),

  comments: (network: string, signal?: AbortSignal) => request<Page<Comment>>('GET', path('operation-networks', network, 'comments'), { signal }),
  comment: (network: string, comment: NewComment) => request<unknown>('POST', path('operation-networks', network, 'comments'), { body: comment }),

  decide: (key: FieldKey, decision: Decision) => request<Field>('PUT', `${fieldPath(key)}/decision`, { body: decision }),
  enter: (key: FieldKey, value: unknown) => request<unknown>('PUT', `${fieldPath(key)}/value`, { body: { value } }),
  preview: (key: FieldKey, draft: { valueSource: ValueSource; mapping?: Mapping; disclosure: Disclosure }, signal?: AbortSignal) =>
    request<Preview>('POST', `${fieldPath(key)}/preview`, { body: draft, signal }),

  operatorOperations: (from: string, until: string, signal?: AbortSignal) => request<Page<OperatorOperation>>('GET', `/operator/operations${query({ from, until })}`, { signal }),
  operatorEntries: (sentAt: string, entries: Entry[]) => request<{ items: EntryOutcome[] }>('POST', '/operator/entries', { body: { sentAt, entries } }),

  sources: (signal?: AbortSignal) => request<Page<Source>>('GET', '/sources', { signal }),
  addSource: (source: SourceConfig) => request<unknown>('POST', '/sources', { body: source }),
  changeSource: (source: SourceConfig) => request<unknown>('PUT', path('sources', source.sourceId), { body: source }),
  removeSource: (sourceId: string) => request<unknown>('DELETE', path('sources', sourceId)),
  certificates: (signal?: AbortSignal) => request<Page<Certificate>>('GET', '/source-certificates', { signal }),
  trust: (thumbprint: string, isTrusted: boolean) => request<Certificate>('PUT', path('source-certificates', thumbprint), { body: { isTrusted } }),
  clientCertificates: (signal?: AbortSignal) => request<Page<ClientCertificate>>('GET', '/client-certificates', { signal }),
  trustClient: (thumbprint: string, isTrusted: boolean) => request<ClientCertificate>('PUT', path('client-certificates', thumbprint), { body: { isTrusted } }),
  addClientCertificate: (certificate: NewClientCertificate) => request<unknown>('POST', '/client-certificates', { body: certificate }),
  nodes: (sourceId: string, parent?: string, cursor?: string, signal?: AbortSignal) =>
    request<Page<BrowsedNode>>('GET', `${path('sources', sourceId, 'nodes')}${query({ parent, cursor })}`, { signal }),
  search: (sourceId: string, text: string, signal?: AbortSignal) => request<Found>('GET', `${path('sources', sourceId, 'search')}${query({ text, limit: 500 })}`, { signal }),
  value: (sourceId: string, node: string, signal?: AbortSignal) =>
    request<DataValue>('GET', `${path('sources', sourceId, 'value')}${query({ node })}`, { signal }),

  ledger: async (recipient: string | undefined, after: string | undefined, limit: number, signal?: AbortSignal): Promise<LedgerAnswer> =>
    ledgerOf(await request<LedgerAnswer>('GET', `/ledger${query({ recipient, after, limit })}`, { signal })),
  verifyLedger: () => request<Verification>('POST', '/ledger/verification'),
  spool: (signal?: AbortSignal) => request<SpoolStatus>('GET', '/spool', { signal }),
  deadLetters: (signal?: AbortSignal) => request<Page<DeadLetter>>('GET', '/dead-letters', { signal }),
}

/** What happens at the connector, as it happens. */
export const feed = new LiveFeed('/api/v1/events', ['field', 'inbox', 'comment', 'operator', 'status'])
