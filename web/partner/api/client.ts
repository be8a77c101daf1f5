import { path, query, request } from '@/transport/http'
import { LiveFeed } from '@/transport/live.svelte'
import type {
  Collaboration,
  Comment,
  DeadLetter,
  DynamicDataRequest,
  EnrolmentToken,
  Factory,
  FactoryLease,
  NetworkSummary,
  NetworkView,
  NewComment,
  NewFactory,
  OperationNetwork,
  Organisation,
  Page,
  PlatformStatus,
  Report,
  Writer,
} from './types'

/** The platform's API. */
export const platform = {
  status: (signal?: AbortSignal) => request<PlatformStatus>('GET', '/status', { signal }),
  organisations: (signal?: AbortSignal) =>
    request<Page<Organisation>>('GET', '/organisations', { signal }),
  collaborations: (signal?: AbortSignal) =>
    request<Page<Collaboration>>('GET', '/collaborations', { signal }),

  factories: (signal?: AbortSignal) => request<Page<Factory>>('GET', '/factories', { signal }),
  addFactory: (factory: NewFactory) => request<Factory>('POST', '/factories', { body: factory }),
  enrol: (factoryId: string) =>
    request<EnrolmentToken>('POST', path('factories', factoryId, 'enrolment-tokens')),
  revokeCredentials: (factoryId: string) =>
    request<unknown>('DELETE', path('factories', factoryId, 'credentials')),
  lease: (factoryId: string, signal?: AbortSignal) =>
    request<FactoryLease>('GET', path('factories', factoryId, 'lease'), { signal }),
  handLeaseOver: (factoryId: string, instanceId: string) =>
    request<FactoryLease>('POST', path('factories', factoryId, 'lease', 'handovers'), {
      body: { instanceId },
    }),
  writers: (factoryId: string, signal?: AbortSignal) =>
    request<Page<Writer>>('GET', path('factories', factoryId, 'writers'), { signal }),

  networks: (signal?: AbortSignal) =>
    request<Page<NetworkSummary>>('GET', '/operation-networks', { signal }),
  network: (id: string, signal?: AbortSignal) =>
    request<NetworkView>('GET', path('operation-networks', id), { signal }),
  putNetwork: (collaborationId: string, network: OperationNetwork) =>
    request<unknown>('PUT', path('operation-networks', network.operationNetworkId), {
      body: { collaborationId, operationNetwork: network },
    }),
  withdrawNetwork: (id: string) => request<unknown>('DELETE', path('operation-networks', id)),
  addRequest: (id: string, operationId: string, wanted: DynamicDataRequest) =>
    request<unknown>(
      'POST',
      path('operation-networks', id, 'operations', operationId, 'requests'),
      { body: wanted },
    ),
  withdrawRequest: (id: string, operationId: string, requestId: string) =>
    request<unknown>(
      'DELETE',
      path('operation-networks', id, 'operations', operationId, 'requests', requestId),
    ),

  newestReports: (network: string, dataRequest: string, limit: number, signal?: AbortSignal) =>
    request<Page<Report>>(
      'GET',
      `/reports${query({ network, request: dataRequest, newest: true, limit })}`,
      { signal },
    ),
  comments: (id: string, signal?: AbortSignal) =>
    request<Page<Comment>>('GET', path('operation-networks', id, 'comments'), { signal }),
  comment: (id: string, comment: NewComment) =>
    request<Comment>('POST', path('operation-networks', id, 'comments'), { body: comment }),
  deadLetters: (signal?: AbortSignal) =>
    request<Page<DeadLetter>>('GET', '/dead-letters', { signal }),
}

/** What happens at the factories, as it arrives. */
export const feed = new LiveFeed('/api/v1/live', [
  'value',
  'decision',
  'part',
  'factory',
  'progress',
  'network',
  'comment',
])
