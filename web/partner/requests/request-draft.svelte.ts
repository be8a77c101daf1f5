import type {
  DynamicDataRequest,
  NetworkView,
  Operation,
  ReportField,
  UpdateFrequencyUnit,
} from '../api/types'

interface FieldDraft {
  name: string
  type: ReportField['type']
  unit: string
  semantic: string
}

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

  /** Proposes a request of the organisation, or of the one that asked first. */
  constructor(view: NetworkView, operation: Operation, own?: string | null) {
    const others = view.network.operationList.flatMap((each) => each.dynamicDataRequestList ?? [])
    const pattern = others.find((other) => own == null || other.requesterId === own)
    this.id = freeId(others.map((other) => other.dynamicDataRequestId))
    this.requesterId = own ?? pattern?.requesterId ?? ''
    this.recipients = pattern?.recipientList.join(', ') ?? own ?? ''
    this.fields = [
      {
        name: 'producedQuantity',
        type: 'UInt32',
        unit: operation.quantityUnit ?? 'PIECE',
        semantic: 'PRODUCED_QUANTITY',
      },
    ]
  }

  addField(): void {
    this.fields.push({ name: '', type: 'Double', unit: '', semantic: '' })
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
      ...(this.validUntil === '' ? {} : { validUntil: instant(this.validUntil) }),
      ...(this.times ? { updateFrequency: this.times, updateFrequencyUnit: this.unit } : {}),
      reportDataFormat: {
        reportName: this.reportName.trim(),
        reportFieldList: this.fields.map((field) => ({
          name: field.name.trim(),
          type: field.type,
          ...(field.unit.trim() === '' ? {} : { unit: field.unit.trim() }),
          ...(field.semantic === '' ? {} : { semantic: field.semantic }),
        })),
      },
    }
  }
}

/** Converts the text of a `datetime-local` input, which is local time, to ISO 8601. */
function instant(local: string): string {
  return new Date(local).toISOString()
}

function freeId(taken: readonly string[]): string {
  for (let number = taken.length + 1; ; number += 1) {
    const id = `Request${number}`
    if (!taken.includes(id)) return id
  }
}
