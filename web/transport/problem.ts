/** Content of a problem document (RFC 9457) of the server, or a substitute if none arrived. */
export interface ProblemDocument {
  title: string
  status: number
  detail?: string | undefined
  /** Single faults, where the server lists them: a pointer or a field, and a sentence. */
  faults: { pointer: string; message: string }[]
}

/** A request that did not succeed. `status` 0: the server was not reached. */
export class Problem extends Error {
  readonly document: ProblemDocument

  constructor(document: ProblemDocument) {
    super(document.detail ?? document.title)
    this.name = 'Problem'
    this.document = document
  }

  get status(): number {
    return this.document.status
  }

  get unreachable(): boolean {
    return this.document.status === 0
  }

  /** Reads the problem out of a response that is not ok. */
  static async of(response: Response): Promise<Problem> {
    const body: unknown = await response.json().catch(() => undefined)
    const members =
      body !== null && typeof body === 'object' ? (body as Record<string, unknown>) : {}
    return new Problem({
      title: text(members['title']) ?? (response.statusText || `HTTP ${response.status}`),
      status: response.status,
      detail: text(members['detail']),
      faults: faults(members),
    })
  }

  /** Converts anything thrown to a problem. */
  static from(thrown: unknown): Problem {
    if (thrown instanceof Problem) return thrown
    const detail = thrown instanceof Error ? thrown.message : String(thrown)
    return new Problem({ title: 'unreachable', status: 0, detail, faults: [] })
  }
}

function faults(members: Record<string, unknown>): ProblemDocument['faults'] {
  const list =
    members['faultList'] ?? members['faults'] ?? members['errors'] ?? members['diagnostics']
  if (!Array.isArray(list)) return []
  return list.map((entry: unknown) => {
    const fault = (
      entry !== null && typeof entry === 'object' ? entry : { message: entry }
    ) as Record<string, unknown>
    return {
      pointer: text(fault['pointer']) ?? text(fault['field']) ?? '',
      message: text(fault['message']) ?? text(fault['detail']) ?? JSON.stringify(entry),
    }
  })
}

function text(value: unknown): string | undefined {
  return typeof value === 'string' && value !== '' ? value : undefined
}
