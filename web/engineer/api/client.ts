import { address, download, path, query, request } from '@/transport/http'
import { LiveFeed } from '@/transport/live.svelte'
import type { ExportFormat, LedgerFilter } from '../ledger/filter'
import type { Entry } from '../operator/entries'
import { PATHS } from './generated'
import { ledgerOf, statusOf, type LedgerAnswer, type StatusAnswer } from './answers'
import type {
  ApplicationCertificate,
  BrowsedNode,
  Certificate,
  Checkpoint,
  ClientAuthority,
  ClientCertificate,
  ClientRevocationList,
  Comment,
  DataValue,
  DeadLetter,
  Decision,
  Disclosure,
  EntryOutcome,
  Field,
  FieldKey,
  Found,
  ImportOutcome,
  InboxAnswer,
  InboxQuery,
  InboxRequest,
  Mapping,
  MappingHealth,
  MappingStatus,
  MappingSurvey,
  MappingTemplate,
  MappingVersion,
  NamedPolicy,
  NewClientCertificate,
  NewComment,
  OperatorOperation,
  Page,
  PartnerLeaks,
  PartnerSummary,
  PolicyView,
  Preview,
  RecipientView,
  RequestKey,
  Revocation,
  RevocationBody,
  Role,
  Rule,
  RuleDecision,
  RulePreview,
  RuleView,
  Setting,
  Shadow,
  Source,
  SourceConfig,
  SpoolStatus,
  Status,
  Suggestions,
  Trial,
  User,
  ValueSource,
  Verification,
} from './types'

const fieldPath = (key: FieldKey): string =>
  path('fields', key.operationNetworkId, key.operationId, key.dynamicDataRequestId, key.fieldName)

/** A long ledger takes its time: every entry is hashed again. */
const VERIFYING_MS_MAX = 600_000
/** Few, as every row weighs on every dialog above the list: opening one is a new style for all that is beneath it. */
const RULE_DECISIONS_PER_PAGE = 25

/** Whether the connector of this build answers a path. */
export function offers(resourcePath: string): boolean {
  return PATHS.includes(`/api/v1${resourcePath}`)
}

/** The connector's API. */
export const connector = {
  status: async (signal?: AbortSignal): Promise<Status> =>
    statusOf(await request<StatusAnswer>('GET', '/status', { signal })),
  configuration: (signal?: AbortSignal) =>
    request<Page<Setting>>('GET', '/configuration', { signal }),
  inbox: (wanted: InboxQuery, signal?: AbortSignal) =>
    request<InboxAnswer>('GET', `/inbox${query({ ...wanted })}`, { signal }),
  request: (key: RequestKey, signal?: AbortSignal) =>
    request<InboxRequest>(
      'GET',
      path('requests', key.operationNetworkId, key.operationId, key.dynamicDataRequestId),
      { signal },
    ),
  suggestions: (key: FieldKey, limit: number, signal?: AbortSignal) =>
    request<Suggestions>('GET', `${fieldPath(key)}/suggestions${query({ limit })}`, { signal }),
  versions: (key: FieldKey, signal?: AbortSignal) =>
    request<Page<MappingVersion>>('GET', `${fieldPath(key)}/versions`, { signal }),
  rollBack: (key: FieldKey, version: number) =>
    request<Field>('POST', `${fieldPath(key)}/versions/${version}/rollback`),
  trial: (key: FieldKey, mapping: Mapping) =>
    request<Trial>('POST', `${fieldPath(key)}/trial`, { body: { mapping, on: 'HISTORY' } }),
  mappingStatus: (key: FieldKey, signal?: AbortSignal) =>
    request<MappingStatus>('GET', `${fieldPath(key)}/mapping-status`, { signal }),
  restartScripts: (key: FieldKey) =>
    request<MappingStatus>('POST', `${fieldPath(key)}/mapping-status/restart`),
  survey: (wanted: { health?: MappingHealth; limit: number }, signal?: AbortSignal) =>
    request<MappingSurvey>('GET', `/mappings/survey${query(wanted)}`, { signal }),
  shadow: (key: FieldKey, signal?: AbortSignal) =>
    request<Shadow>('GET', `${fieldPath(key)}/shadow`, { signal }),
  startShadow: (key: FieldKey, mapping: Mapping) =>
    request<Shadow>('PUT', `${fieldPath(key)}/shadow`, { body: mapping }),
  endShadow: (key: FieldKey) => request<unknown>('DELETE', `${fieldPath(key)}/shadow`),
  publishShadow: (key: FieldKey) => request<Field>('POST', `${fieldPath(key)}/shadow/publish`),

  exportMappings: (form: 'file' | 'csv') => download(`/mappings/export${query({ form })}`),
  importMappings: (text: string, isTable: boolean, dryRun: boolean) =>
    request<ImportOutcome>('POST', `/mappings/import${query({ dryRun })}`, {
      text,
      contentType: isTable ? 'text/csv' : 'application/json',
    }),
  templates: (signal?: AbortSignal) =>
    request<Page<MappingTemplate>>('GET', '/mapping-templates', { signal }),
  putTemplate: (template: MappingTemplate) =>
    request<MappingTemplate>('PUT', path('mapping-templates', template.templateId), {
      body: template,
    }),
  removeTemplate: (id: string) => request<unknown>('DELETE', path('mapping-templates', id)),
  templateOf: (
    key: FieldKey,
    draft: { templateId: string; name?: string; parameters: Record<string, string> },
  ) => request<MappingTemplate>('POST', `${fieldPath(key)}/template`, { body: draft }),
  fillTemplate: (id: string, patterns: Record<string, string>, dryRun: boolean) =>
    request<ImportOutcome>('POST', `${path('mapping-templates', id, 'fill')}${query({ dryRun })}`, {
      body: { patterns },
    }),

  policies: (signal?: AbortSignal) => request<Page<PolicyView>>('GET', '/policies', { signal }),
  putPolicy: (id: string, policy: NamedPolicy, version: number) =>
    request<unknown>('PUT', path('policies', id), { body: policy, ifMatch: version }),
  recipients: (signal?: AbortSignal) =>
    request<Page<RecipientView>>('GET', '/recipients', { signal }),
  setRecipientPolicy: (recipient: string, policyId: string | null) =>
    request<unknown>('PUT', path('recipients', recipient, 'policy'), { body: { policyId } }),
  rules: (signal?: AbortSignal) => request<Page<RuleView>>('GET', '/rules', { signal }),
  putRule: (id: string, rule: Rule, version: number) =>
    request<unknown>('PUT', path('rules', id), { body: rule, ifMatch: version }),
  previewRule: (rule: Rule, signal?: AbortSignal) =>
    request<RulePreview>('POST', '/rules/preview', { body: rule, signal }),
  applyRules: () => request<{ decidedCount: number }>('POST', '/rules/apply'),
  ruleDecisions: (cursor?: string, signal?: AbortSignal) =>
    request<Page<RuleDecision>>(
      'GET',
      `/rule-decisions${query({ cursor, limit: RULE_DECISIONS_PER_PAGE })}`,
      { signal },
    ),
  undoRuleDecision: (id: string) => request<unknown>('POST', path('rule-decisions', id, 'undo')),

  leakBudgets: (signal?: AbortSignal) =>
    request<Page<PartnerLeaks>>('GET', '/leak-budgets', { signal }),
  leakSummary: (signal?: AbortSignal) =>
    request<Page<PartnerSummary>>('GET', '/leak-budgets/summary', { signal }),

  field: (key: FieldKey, signal?: AbortSignal) => request<Field>('GET', fieldPath(key), { signal }),
  users: (signal?: AbortSignal) => request<Page<User>>('GET', '/users', { signal }),
  putUser: (userName: string, user: { role: Role; password?: string }) =>
    request<User>('PUT', path('users', userName), { body: user }),
  removeUser: (userName: string) => request<unknown>('DELETE', path('users', userName)),

  revoke: (body: RevocationBody) => request<Revocation>('POST', '/revocations', { body }),
  revocations: (cursor?: string, signal?: AbortSignal) =>
    request<Page<Revocation>>('GET', `/revocations${query({ cursor })}`, { signal }),
  revocationToPrint: (id: string, language: string) =>
    download(`${path('revocations', id, 'print')}${query({ language })}`),

  comments: (network: string, signal?: AbortSignal) =>
    request<Page<Comment>>('GET', path('operation-networks', network, 'comments'), { signal }),
  comment: (network: string, comment: NewComment) =>
    request<unknown>('POST', path('operation-networks', network, 'comments'), { body: comment }),

  decide: (key: FieldKey, decision: Decision) =>
    request<Field>('PUT', `${fieldPath(key)}/decision`, { body: decision }),
  enter: (key: FieldKey, value: unknown) =>
    request<unknown>('PUT', `${fieldPath(key)}/value`, { body: { value } }),
  preview: (
    key: FieldKey,
    draft: {
      valueSource: ValueSource
      mapping?: Mapping
      disclosure: Disclosure
      policyId?: string
    },
    signal?: AbortSignal,
  ) => request<Preview>('POST', `${fieldPath(key)}/preview`, { body: draft, signal }),

  operatorOperations: (from: string, until: string, signal?: AbortSignal) =>
    request<Page<OperatorOperation>>('GET', `/operator/operations${query({ from, until })}`, {
      signal,
    }),
  operatorEntries: (sentAt: string, entries: Entry[]) =>
    request<{ items: EntryOutcome[] }>('POST', '/operator/entries', { body: { sentAt, entries } }),

  sources: (signal?: AbortSignal) => request<Page<Source>>('GET', '/sources', { signal }),
  addSource: (source: SourceConfig) => request<unknown>('POST', '/sources', { body: source }),
  changeSource: (source: SourceConfig) =>
    request<unknown>('PUT', path('sources', source.sourceId), { body: source }),
  removeSource: (sourceId: string) => request<unknown>('DELETE', path('sources', sourceId)),
  certificates: (signal?: AbortSignal) =>
    request<Page<Certificate>>('GET', '/source-certificates', { signal }),
  trust: (thumbprint: string, isTrusted: boolean) =>
    request<Certificate>('PUT', path('source-certificates', thumbprint), { body: { isTrusted } }),
  clientCertificates: (signal?: AbortSignal) =>
    request<Page<ClientCertificate>>('GET', '/client-certificates', { signal }),
  trustClient: (thumbprint: string, isTrusted: boolean) =>
    request<ClientCertificate>('PUT', path('client-certificates', thumbprint), {
      body: { isTrusted },
    }),
  addClientCertificate: (certificate: NewClientCertificate) =>
    request<unknown>('POST', '/client-certificates', { body: certificate }),
  applicationCertificate: (signal?: AbortSignal) =>
    request<ApplicationCertificate>('GET', '/application-certificate', { signal }),
  requestApplicationCertificate: (wanted: {
    commonName?: string
    organization?: string
    withNewKey: boolean
  }) => request<{ content: string }>('POST', '/application-certificate/request', { body: wanted }),
  installApplicationCertificate: (content: string) =>
    request<ApplicationCertificate>('PUT', '/application-certificate', { body: { content } }),
  clientAuthorities: (signal?: AbortSignal) =>
    request<Page<ClientAuthority>>('GET', '/client-authorities', { signal }),
  removeClientAuthority: (thumbprint: string) =>
    request<unknown>('DELETE', path('client-authorities', thumbprint)),
  clientRevocationLists: (signal?: AbortSignal) =>
    request<Page<ClientRevocationList>>('GET', '/client-revocation-lists', { signal }),
  removeClientRevocationList: (id: string) =>
    request<unknown>('DELETE', path('client-revocation-lists', id)),
  nodes: (sourceId: string, parent?: string, cursor?: string, signal?: AbortSignal) =>
    request<Page<BrowsedNode>>(
      'GET',
      `${path('sources', sourceId, 'nodes')}${query({ parent, cursor })}`,
      { signal },
    ),
  search: (sourceId: string, text: string, signal?: AbortSignal) =>
    request<Found>('GET', `${path('sources', sourceId, 'search')}${query({ text, limit: 500 })}`, {
      signal,
    }),
  value: (sourceId: string, node: string, signal?: AbortSignal) =>
    request<DataValue>('GET', `${path('sources', sourceId, 'value')}${query({ node })}`, {
      signal,
    }),

  ledger: async (
    filter: LedgerFilter,
    after: string | undefined,
    limit: number,
    signal?: AbortSignal,
  ): Promise<LedgerAnswer> =>
    ledgerOf(
      await request<LedgerAnswer>('GET', `/ledger${query({ ...filter, after, limit })}`, {
        signal,
      }),
    ),
  /** Where a file of entries is read, for a link. */
  ledgerExport: (format: ExportFormat, filter: LedgerFilter, language: string): string =>
    address(`/ledger/export${query({ format, ...filter, language })}`),
  ledgerFields: (search: string, signal?: AbortSignal) =>
    request<Page<{ key: FieldKey }>>(
      'GET',
      `/ledger/fields${query({ search: search === '' ? undefined : search })}`,
      { signal },
    ),
  ledgerCheckpoints: (cursor?: string, signal?: AbortSignal) =>
    request<Page<Checkpoint>>('GET', `/ledger/checkpoints${query({ cursor })}`, { signal }),
  verifyLedger: () =>
    request<Verification>('POST', '/ledger/verification', { timeoutMs: VERIFYING_MS_MAX }),
  spool: (signal?: AbortSignal) => request<SpoolStatus>('GET', '/spool', { signal }),
  deadLetters: (signal?: AbortSignal) =>
    request<Page<DeadLetter>>('GET', '/dead-letters', { signal }),
}

/** What happens at the connector, as it happens. */
export const feed = new LiveFeed('/api/v1/events', [
  'field',
  'decisions',
  'inbox',
  'comment',
  'operator',
  'policies',
  'revocation',
  'ledger',
  'status',
])
