import { fromLocalInput } from '@/format/local-time'
import { said } from '@/language/said'
import type { Problem } from '@/transport/problem'
import type { DynamicDataRequest, NetworkView, Operation, UpdateFrequencyUnit } from '../api/types'
import { fitting, nameOf, offersOf, QUESTIONS, type FieldDraft, type Offer } from './offers'

/** Faults that the platform found, by the field that they are about. */
const FIELD_POINTER = /^\/reportDataFormat\/reportFieldList\/(\d+)(?:\/|$)/

/** A request as it is being written. */
export class RequestDraft {
  id = $state('')
  requesterId = $state('')
  recipients = $state('')
  purpose = $state('')
  reportName = $state('ProgressReport')
  times = $state<number | undefined>(1)
  unit = $state<UpdateFrequencyUnit>('MINUTE')
  validUntil = $state('')
  fields = $state<FieldDraft[]>([])
  /** Texts of faults, by the index of their field. */
  faults = $state.raw<Readonly<Record<number, string>>>({})
  readonly offers: readonly Offer[]
  readonly #operation: Operation

  /**
   * Proposes a request of the organisation, or of the one that asked first. `describe` puts what
   * has no meaning of its own into words.
   */
  constructor(
    view: NetworkView,
    operation: Operation,
    own?: string | null,
    describe: (id: string) => string = (id) => id,
  ) {
    this.#operation = operation
    this.offers = offersOf(view, operation, describe)
    const others = view.network.operationList.flatMap((each) => each.dynamicDataRequestList ?? [])
    const pattern = others.find((other) => own == null || other.requesterId === own)
    this.id = freeId(others.map((other) => other.dynamicDataRequestId))
    this.requesterId = own ?? pattern?.requesterId ?? ''
    this.recipients = pattern?.recipientList.join(', ') ?? own ?? ''
    const first = this.offers.find(({ id }) => id === 'PRODUCED_QUANTITY') ?? this.offers[0]
    if (first !== undefined) this.toggle(first)
  }

  isAsked(offer: Offer): boolean {
    return this.fields.some((field) => field.offer === offer.id)
  }

  /** Asks for something offered, or no longer. */
  toggle(offer: Offer): void {
    this.faults = {}
    if (this.isAsked(offer)) this.fields = this.fields.filter((field) => field.offer !== offer.id)
    else this.fields.push({ ...offer.field })
  }

  /** Asks for something that the reader puts in words. */
  addField(): void {
    this.fields.push({ name: '', type: 'Double', unit: '', semantic: '', description: '' })
  }

  drop(index: number): void {
    this.faults = {}
    this.fields.splice(index, 1)
  }

  /** Gives a field another meaning, with the type and unit that fit it. */
  mean(field: FieldDraft, semantic: string): void {
    field.semantic = semantic
    if (QUESTIONS.some(({ id }) => id === semantic))
      Object.assign(field, fitting(semantic, this.#operation))
  }

  /** Technical name of a field, made of its description where none was written. */
  nameOf(field: FieldDraft): string {
    const written = field.name.trim()
    if (written !== '') return written
    const others = this.fields.filter((each) => each !== field).map(({ name }) => name.trim())
    const before = this.fields.slice(0, this.fields.indexOf(field))
    return nameOf(field.description, [
      ...others,
      ...before.filter(({ name }) => name.trim() === '').map((each) => this.nameOf(each)),
    ])
  }

  /** Keeps what the platform found wrong, at the fields. */
  takeFaults({ faults }: Problem): void {
    const found = faults.flatMap(({ pointer, code, message }): [number, string][] => {
      const index = FIELD_POINTER.exec(pointer.replace(/^.*(?=\/reportDataFormat\/)/, ''))?.[1]
      return index === undefined ? [] : [[Number(index), said(code, message)]]
    })
    this.faults = Object.fromEntries(found)
  }

  get request(): DynamicDataRequest {
    return {
      dynamicDataRequestId: this.id.trim(),
      requesterId: this.requesterId.trim(),
      recipientList: this.recipients
        .split(',')
        .map((each) => each.trim())
        .filter((each) => each !== ''),
      purpose: this.purpose.trim(),
      ...(this.validUntil === '' ? {} : { validUntil: fromLocalInput(this.validUntil) }),
      ...(this.times ? { updateFrequency: this.times, updateFrequencyUnit: this.unit } : {}),
      reportDataFormat: {
        reportName: this.reportName.trim(),
        reportFieldList: this.fields.map((field) => ({
          name: this.nameOf(field),
          type: field.type,
          ...(field.unit.trim() === '' ? {} : { unit: field.unit.trim() }),
          ...(field.semantic === '' ? {} : { semantic: field.semantic }),
          ...(field.description.trim() === '' ? {} : { description: field.description.trim() }),
        })),
      },
    }
  }
}

function freeId(taken: readonly string[]): string {
  for (let number = taken.length + 1; ; number += 1) {
    const id = `Request${number}`
    if (!taken.includes(id)) return id
  }
}
