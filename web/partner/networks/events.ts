import type { Resource } from '@/transport/resource.svelte'
import type { FieldKey, FieldView, LiveData, NetworkView } from '../api/types'

type Values = LiveData<'value'>

/** Applies newer values, as an event brought them, to their network. */
export function takeValues(view: Resource<NetworkView>, networkId: string, values: Values): void {
  if (values.operationNetworkId !== networkId) return
  view.amendByEvent((known) => ({
    ...known,
    fields: known.fields.map((field) => merge(field, values.fields)),
  }))
}

/** Applies the progress of an operation, as an event brought it, to its network. */
export function takeProgress(
  view: Resource<NetworkView>,
  networkId: string,
  { operationNetworkId, ...latest }: LiveData<'progress'>,
): void {
  if (operationNetworkId !== networkId) return
  view.amendByEvent((known) => ({
    ...known,
    operations: known.operations.map((operation) =>
      operation.operationId === latest.operationId ? { ...operation, ...latest } : operation,
    ),
  }))
}

function merge(field: FieldView, changed: Values['fields']): FieldView {
  const latest = changed.find((each) => sameField(each.key, field.key))
  if (latest === undefined) return field
  // Values that were delayed on their way do not replace newer ones.
  const isSameEpoch = latest.epoch === field.epoch
  if (isSameEpoch && field.sequence != null && latest.sequence < field.sequence) return field
  return { ...field, ...latest }
}

export function sameField(a: FieldKey, b: FieldKey): boolean {
  return (
    a.operationNetworkId === b.operationNetworkId &&
    a.operationId === b.operationId &&
    a.dynamicDataRequestId === b.dynamicDataRequestId &&
    a.fieldName === b.fieldName
  )
}
