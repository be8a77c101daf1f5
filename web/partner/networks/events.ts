import type { Resource } from '@/transport/resource.svelte'
import type { FieldKey, FieldState, NetworkView, OperationProgress } from '../api/types'

/**
 * Applies the value of an event to its network. An event of an unknown field makes the network be
 * read again.
 */
export function takeEvent(view: Resource<NetworkView>, networkId: string, event: unknown): void {
  const changed = fieldsOf(event).filter((field) => field.key.operationNetworkId === networkId)
  if (changed.length > 0) {
    view.amendByEvent((known) => ({
      ...known,
      fields: known.fields.map((field) => merge(field, changed)),
    }))
  } else if (fieldsOf(event).length === 0) view.refreshSoon()
}

/** Applies the progress of an operation, as an event brought it, to its network. */
export function takeProgress(view: Resource<NetworkView>, networkId: string, event: unknown): void {
  if (
    event === null ||
    typeof event !== 'object' ||
    !('operationId' in event) ||
    !('operationNetworkId' in event)
  )
    return
  if (event.operationNetworkId !== networkId) return
  const latest = event as unknown as OperationProgress
  view.amendByEvent((known) => ({
    ...known,
    operations: known.operations.map((operation) =>
      operation.operationId === latest.operationId ? { ...operation, ...latest } : operation,
    ),
  }))
}

function merge(field: FieldState, changed: readonly FieldState[]): FieldState {
  const latest = changed.find((each) => sameField(each.key, field.key))
  if (latest === undefined) return field
  // Values that were delayed on their way do not replace newer ones.
  const isSameEpoch = latest.epoch === field.epoch
  if (
    isSameEpoch &&
    latest.sequence != null &&
    field.sequence != null &&
    latest.sequence < field.sequence
  )
    return field
  return {
    ...field,
    ...Object.fromEntries(Object.entries(latest).filter(([, value]) => value !== undefined)),
  }
}

function fieldsOf(event: unknown): FieldState[] {
  if (event === null || typeof event !== 'object') return []
  if ('key' in event) return [event as FieldState]
  return 'fields' in event && Array.isArray(event.fields)
    ? (event.fields as FieldState[]).filter((field) => typeof field === 'object' && 'key' in field)
    : []
}

export function sameField(a: FieldKey, b: FieldKey): boolean {
  return (
    a.operationNetworkId === b.operationNetworkId &&
    a.operationId === b.operationId &&
    a.dynamicDataRequestId === b.dynamicDataRequestId &&
    a.fieldName === b.fieldName
  )
}
