import type { FieldKey } from '../api/types'

/** The parts of a field's address on this site. */
export function fieldAddress(key: FieldKey): [string, string, string, string] {
  return [key.operationNetworkId, key.operationId, key.dynamicDataRequestId, key.fieldName]
}

/** Fields of one request that are shown at first; the others at a click. */
export const FIELDS_SHOWN = 40
