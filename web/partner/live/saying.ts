import { statusText } from '@/format/status'
import { valueText } from '@/format/value'
import { words } from '@/language/words'

export interface Saying {
  where: string
  what: string
}

/** What an event says, on one line. */
export function saying(event: unknown): Saying {
  if (event === null || typeof event !== 'object') return { where: '', what: String(event) }
  const members = event as Record<string, unknown>
  const key = (typeof members['key'] === 'object' && members['key'] !== null ? members['key'] : members) as Record<string, unknown>
  const where = ['factoryId', 'operationNetworkId', 'operationId', 'dynamicDataRequestId', 'fieldName']
    .map((name) => key[name] ?? members[name])
    .filter((part) => typeof part === 'string')
    .join(' / ')
  return { where, what: what(members) }
}

function what(members: Record<string, unknown>): string {
  const parts: string[] = []
  if (typeof members['mappingState'] === 'string') parts.push(words.mappingState[members['mappingState']] ?? members['mappingState'])
  if ('value' in members) parts.push(valueText(members['value']))
  if (typeof members['status'] === 'number' && members['status'] !== 0) parts.push(statusText(members['status']))
  if (typeof members['state'] === 'string') parts.push(words.operationState[members['state']] ?? members['state'])
  if (typeof members['reason'] === 'string') parts.push(members['reason'])
  return parts.length > 0 ? parts.join(' · ') : ''
}
