import { severity, statusText } from '@/format/status'
import { valueText } from '@/format/value'
import { words } from '@/language/words'
import type { FieldState } from '../api/types'
import { texts } from '../language/texts'

export interface EventText {
  where: string
  what: string
}

/** Text of an event on one line, with the address that it is about. */
export function eventText(event: unknown): EventText {
  if (event === null || typeof event !== 'object') return { where: '', what: String(event) }
  const members = event as Record<string, unknown>
  const key = (
    typeof members['key'] === 'object' && members['key'] !== null ? members['key'] : members
  ) as Record<string, unknown>
  const where = [
    'factoryId',
    'operationNetworkId',
    'operationId',
    'dynamicDataRequestId',
    'fieldName',
  ]
    .map((name) => key[name] ?? members[name])
    .filter((part) => typeof part === 'string')
    .join(' / ')
  return { where, what: what(members) }
}

function what(members: Record<string, unknown>): string {
  const parts: string[] = []
  if (Array.isArray(members['fields']))
    parts.push(
      (members['fields'] as FieldState[])
        .map((field) => `${field.key.fieldName} ${valueText(field.value)}`)
        .join(', '),
    )
  if (typeof members['mappingState'] === 'string')
    parts.push(words.mappingState[members['mappingState']] ?? members['mappingState'])
  if ('value' in members) parts.push(valueText(members['value']))
  if (severity(members['status'] as string | null | undefined) !== 'good')
    parts.push(statusText(members['status'] as string))
  if (typeof members['state'] === 'string')
    parts.push(
      words.operationState[members['state']] ??
        texts.network.part[members['state']] ??
        members['state'],
    )
  if (typeof members['quantity'] === 'number') parts.push(valueText(members['quantity']))
  if (typeof members['revision'] === 'number')
    parts.push(texts.networks.revision(members['revision']))
  if (typeof members['reason'] === 'string') parts.push(members['reason'])
  return parts.length > 0 ? parts.join(' · ') : ''
}
