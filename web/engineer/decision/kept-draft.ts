import type { DisclosurePolicy, FieldKey, MappingInput, ValueSource } from '../api/types'
import type { StepDraft } from './step-catalogue'

/** Draft as it is kept in the browser until it is consented to or discarded. */
export interface KeptDraft {
  source: ValueSource
  inputs: MappingInput[]
  steps: StepDraft[]
  disclosure: DisclosurePolicy
  policyId: string
  /** Tag of the field as it was shown when the draft was begun. */
  shownTag: string | undefined
}

/** Name under which the draft about a field is kept. */
export function draftName(key: FieldKey): string {
  return `draft/${Object.values(key).map(encodeURIComponent).join('/')}`
}
