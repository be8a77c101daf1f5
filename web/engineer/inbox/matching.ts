import type { FieldView, InboxRequest, MappingState } from '../api/types'

/** A request with those of its fields that are looked for. */
export interface Match {
  request: InboxRequest
  fields: FieldView[]
}

/**
 * Returns the fields that match the search. The connector finds whole requests, by all words and by
 * the state of any field.
 */
export function matching(
  requests: readonly InboxRequest[],
  state: MappingState | undefined,
  search: string,
): Match[] {
  const words = search
    .toLowerCase()
    .split(/\s+/)
    .filter((word) => word !== '')
  return requests
    .map((request) => ({ request, fields: fieldsIn(request, state, words) }))
    .filter(({ fields }) => fields.length > 0)
}

function fieldsIn(
  request: InboxRequest,
  state: MappingState | undefined,
  words: readonly string[],
): FieldView[] {
  const inState = request.fields.filter(
    (field) => state === undefined || field.mappingState === state,
  )
  const about = [
    request.requesterId,
    request.purpose,
    ...Object.values(request.key),
    request.networkName,
    request.operation.name,
    ...request.recipientList,
  ]
    .join('\n')
    .toLowerCase()
  // Words that the request does not have, its fields must.
  const wanted = words.filter((word) => !about.includes(word))
  return wanted.length === 0
    ? inState
    : inState.filter((field) => wanted.some((word) => field.name.toLowerCase().includes(word)))
}
