import type { NetworkView, Operation, ReportField } from '../api/types'

/** A field as it is being written. */
export interface FieldDraft {
  /** Technical name; an empty one is made of the description. */
  name: string
  type: ReportField['type']
  unit: string
  semantic: string
  description: string
  /** The offer that it was chosen by; none for what the reader put in words. */
  offer?: string
}

/** Something that a buyer may want to know. */
export interface Offer {
  /** Meaning, or name where it has none: texts are by it. */
  id: string
  field: FieldDraft
  /** Requested elsewhere in the network: it has no text of ours, but its own. */
  isOfOthers?: boolean
}

type OperationType = Operation['operationType']
const ALL: readonly OperationType[] = ['PRODUCTION', 'INSPECTION', 'TRANSPORTATION']
const COUNTED: readonly OperationType[] = ['PRODUCTION', 'INSPECTION']

interface Question {
  id: string
  name: string
  type: ReportField['type']
  /** Kinds of operations that have it. */
  of: readonly OperationType[]
  unit?: 'planned' | 'percent'
  /** Without a meaning that programs know, the text says what is asked. */
  isText?: boolean
}

/** Questions about operations, the usual ones first. */
export const QUESTIONS: readonly Question[] = [
  { id: 'OPERATION_STATE', name: 'operationState', type: 'String', of: ALL },
  { id: 'PERCENT_COMPLETE', name: 'percentComplete', type: 'Double', of: ALL, unit: 'percent' },
  {
    id: 'PRODUCED_QUANTITY',
    name: 'producedQuantity',
    type: 'UInt32',
    of: COUNTED,
    unit: 'planned',
  },
  { id: 'GOOD_QUANTITY', name: 'goodQuantity', type: 'UInt32', of: COUNTED, unit: 'planned' },
  { id: 'SCRAP_QUANTITY', name: 'scrapQuantity', type: 'UInt32', of: COUNTED, unit: 'planned' },
  { id: 'ACTUAL_START', name: 'actualStart', type: 'DateTime', of: ALL },
  { id: 'EXPECTED_END', name: 'expectedEnd', type: 'DateTime', of: ALL },
  { id: 'ACTUAL_END', name: 'actualEnd', type: 'DateTime', of: ALL },
  { id: 'DELAY_REASON', name: 'delayReason', type: 'String', of: ALL, isText: true },
]

/** Units that count; of anything else there are fractions. */
const COUNTING = ['PIECE', 'PCE', 'H87', 'C62', 'EA']

/** Type and unit that fit a meaning, for an operation. */
export function fitting(id: string, operation: Operation): Pick<FieldDraft, 'type' | 'unit'> {
  const question = QUESTIONS.find((each) => each.id === id)
  if (question?.unit === undefined) return { type: question?.type ?? 'Double', unit: '' }
  if (question.unit === 'percent') return { type: 'Double', unit: 'PERCENT' }
  const unit = operation.quantityUnit ?? 'PIECE'
  return { type: COUNTING.includes(unit) ? 'UInt32' : 'Double', unit }
}

/** What can be asked about an operation: by its kind, and what is asked elsewhere in the network. */
export function offersOf(
  { network }: NetworkView,
  operation: Operation,
  describe: (id: string) => string,
): Offer[] {
  const questions = QUESTIONS.filter(({ of }) => of.includes(operation.operationType))
  const offers = questions.map(({ id, name, isText = false }): Offer => ({
    id,
    field: {
      name,
      ...fitting(id, operation),
      semantic: isText ? '' : id,
      description: isText ? describe(id) : '',
      offer: id,
    },
  }))
  const names = new Set(offers.map(({ field }) => field.name))
  const elsewhere = network.operationList
    .flatMap((each) => each.dynamicDataRequestList ?? [])
    .flatMap((request) => request.reportDataFormat.reportFieldList)
    .filter((field) => !QUESTIONS.some(({ id }) => id === field.semantic))
  for (const { name, type, unit, semantic, description } of elsewhere) {
    if (names.has(name)) continue
    names.add(name)
    const field = {
      name,
      type,
      unit: unit ?? '',
      semantic: semantic ?? '',
      description: description ?? '',
      offer: name,
    }
    offers.push({ id: name, field, isOfOthers: true })
  }
  return offers
}

/** A technical name made of words, and different from the others. */
export function nameOf(description: string, taken: readonly string[]): string {
  const words = description
    .normalize('NFKD')
    .replace(/ß/g, 'ss')
    .replace(/[^\w\s-]/g, '')
    .split(/[\s_-]+/)
    .filter((word) => word !== '')
    .slice(0, 6)
  const joined = words
    .map((word, index) =>
      index === 0 ? word.toLowerCase() : word.charAt(0).toUpperCase() + word.slice(1).toLowerCase(),
    )
    .join('')
    .slice(0, 48)
  const name = /^[a-z]/.test(joined) ? joined : `field${joined}`
  if (!taken.includes(name)) return name
  for (let number = 2; ; number += 1)
    if (!taken.includes(`${name}${number}`)) return `${name}${number}`
}
