import { Api } from '@/transport/api'
import { LiveFeed } from '@/transport/live.svelte'
import type { paths } from '@/api/connector.generated'
import type { LiveEvent } from './types'

/** The connector's API. */
export const connector = new Api<paths>()

/** Path of a requested field; its sub-resources are below it. */
export const FIELD =
  '/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}' as const
/** Path of a data request. */
export const REQUEST =
  '/requests/{operationNetworkId}/{operationId}/{dynamicDataRequestId}' as const

/** Events of the connector as they happen. */
export const feed = new LiveFeed<LiveEvent>('/api/v1/events')
