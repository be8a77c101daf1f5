import type {
  BrowsedNode,
  DecisionBody,
  DisclosurePolicy,
  FieldView,
  InboxRequest,
  MappingDraft,
  MappingInput,
  ValueSource,
} from '../api/types'
import { identityOf } from './event-input'
import { inputName } from './input-name'
import type { KeptDraft } from './kept-draft'
import { newStep, stepKind, type StepDraft } from './step-catalogue'

/** Decision on a field that is being prepared; nothing takes effect before consent. */
export class Draft {
  source = $state<ValueSource>('MAPPING')
  inputs = $state<MappingInput[]>([])
  steps = $state<StepDraft[]>([])
  disclosure = $state<DisclosurePolicy>({})
  /** A named policy that holds beside it. */
  policyId = $state('')

  /** Tag of the field as it was shown when the draft was begun: a decision rests on that. */
  shownTag = $state.raw<string | undefined>()

  readonly #wanted: FieldView
  readonly #request: InboxRequest
  /** The stored decision, as the draft would repeat it. */
  #stored = $state.raw('')

  constructor(field: FieldView, request: InboxRequest, kept?: KeptDraft) {
    this.#wanted = field
    this.#request = request
    this.shownTag = field.shownTag ?? undefined
    const offer = field.mappingState === 'PENDING' ? field.offer : undefined
    const mapping = field.mapping ?? offer?.mapping
    this.source = field.valueSource ?? offer?.valueSource ?? 'MAPPING'
    this.inputs = structuredClone(mapping?.inputs ?? [])
    this.steps = structuredClone(mapping?.steps ?? [])
    this.policyId = field.grounds?.policyId ?? ''
    // The first decision on a field starts with the period that the partner requested.
    const asked: DisclosurePolicy = request.updateIntervalMs
      ? { minimumIntervalMs: request.updateIntervalMs }
      : {}
    this.disclosure = structuredClone(
      field.mappingState === 'MAPPED'
        ? (field.disclosure ?? {})
        : { ...asked, ...tidy(field.disclosure ?? {}), ...tidy(offer?.disclosure ?? {}) },
    )
    this.#stored = JSON.stringify(this.decision)
    if (kept !== undefined) Object.assign(this, kept)
  }

  /** Draft to be kept while it differs from the stored decision. */
  get kept(): KeptDraft | undefined {
    const { source, inputs, steps, disclosure, policyId, shownTag, isChanged } = this
    return isChanged ? { source, inputs, steps, disclosure, policyId, shownTag } : undefined
  }

  /** Goes on from the decision that was just stored. */
  settle(field: FieldView): void {
    this.shownTag = field.shownTag ?? undefined
    this.#stored = JSON.stringify(this.decision)
  }

  /** Goes on while the stored decision is the former one again. */
  settleUndone(field: FieldView): void {
    this.shownTag = field.shownTag ?? undefined
    this.#stored = new Draft(field, this.#request).#stored
  }

  /** Returns whether another decision or a changed request came in between. */
  isOvertakenBy(field: FieldView): boolean {
    return this.shownTag !== undefined && field.shownTag != null && this.shownTag !== field.shownTag
  }

  /** Field that is decided on. */
  get wanted(): FieldView {
    return this.#wanted
  }

  get mapping(): MappingDraft | undefined {
    if (this.source !== 'MAPPING') return undefined
    // The connector checks the parameters and reports faults.
    return { inputs: this.inputs, steps: this.steps as MappingDraft['steps'] }
  }

  /** Returns whether there is a source to consent to. */
  get isComplete(): boolean {
    return (
      this.source !== 'MAPPING' ||
      this.inputs.length > 0 ||
      this.steps.some((step) => step.function === 'constant')
    )
  }

  /** Returns whether the draft differs from the stored decision. */
  get isChanged(): boolean {
    return JSON.stringify(this.decision) !== this.#stored
  }

  get decision(): DecisionBody {
    return {
      mappingState: 'MAPPED',
      valueSource: this.source,
      ...(this.mapping === undefined ? {} : { mapping: this.mapping }),
      disclosure: tidy(this.disclosure),
      ...(this.policyId === '' ? {} : { policyId: this.policyId }),
    }
  }

  /** Difference between the first input's type and the requested one. */
  get typeDifference(): { is: string; wanted: string } | undefined {
    const is = this.inputs[0]?.valueType
    const wanted = this.#wanted.type
    if (!is || is === wanted || this.steps.length > 0) return undefined
    return { is, wanted }
  }

  /** Difference between the first input's unit and the requested one. */
  get unitDifference(): { is: string; wanted: string } | undefined {
    const is = this.inputs[0]?.unit
    const wanted = this.#wanted.unit
    if (!is || !wanted || is === wanted || this.steps.some((step) => step.function !== 'convert'))
      return undefined
    return { is, wanted }
  }

  has(sourceId: string, nodeId: string): boolean {
    return this.inputs.some((input) => identityOf(input) === identityOf({ sourceId, nodeId }))
  }

  take(sourceId: string, node: BrowsedNode): void {
    if (this.has(sourceId, node.nodeId)) return
    this.inputs.push({
      name: inputName(node.browseName, this.inputs),
      sourceId,
      nodeId: node.nodeId,
      ...(node.builtInType ? { valueType: node.builtInType } : {}),
      ...(node.unit?.code ? { unit: node.unit.code } : {}),
    })
  }

  /** Adopts a whole mapping from a suggestion or a template. Returns a function that undoes it. */
  adopt(mapping: MappingDraft): () => void {
    const [inputs, steps, source] = [
      $state.snapshot(this.inputs),
      $state.snapshot(this.steps),
      this.source,
    ]
    this.source = 'MAPPING'
    this.inputs = structuredClone(mapping.inputs)
    this.steps = structuredClone(mapping.steps ?? [])
    return () => {
      this.source = source
      this.inputs = inputs as MappingInput[]
      this.steps = steps as StepDraft[]
    }
  }

  drop(index: number): void {
    this.inputs.splice(index, 1)
  }

  addStep(name: string): void {
    const kind = stepKind(name)
    if (kind !== undefined) this.steps.push(newStep(kind))
  }

  addTypeConversion(): void {
    this.steps.push({ function: 'convert', to: this.#wanted.type })
  }

  addUnitConversion(): void {
    this.steps.unshift({ function: 'unitConversion' })
  }

  dropStep(index: number): void {
    this.steps.splice(index, 1)
  }

  moveStep(index: number, by: 1 | -1): void {
    const step = this.steps[index]
    if (step === undefined || index + by < 0 || index + by >= this.steps.length) return
    this.steps.splice(index, 1)
    this.steps.splice(index + by, 0, step)
  }
}

/** Returns the policy without empty members. */
export function tidy(disclosure: DisclosurePolicy): DisclosurePolicy {
  return Object.fromEntries(
    Object.entries(disclosure).filter(
      ([, value]) =>
        value !== null && value !== undefined && !(Array.isArray(value) && value.length === 0),
    ),
  )
}
