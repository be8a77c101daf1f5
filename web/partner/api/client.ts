import { Api } from '@/transport/api'
import { LiveFeed } from '@/transport/live.svelte'
import type { paths } from '@/api/platform.generated'
import type { LiveEvent } from './types'

/** The platform's API. */
export const platform = new Api<paths>()

/** Events of the factories as they arrive. */
export const feed = new LiveFeed<LiveEvent>('/api/v1/live')
