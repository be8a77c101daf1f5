import type { components as Connector } from '@/api/connector.generated'
import type { components as Platform } from '@/api/platform.generated'

type BodyOf<Responses> = Responses[keyof Responses] extends {
  content: { 'application/problem+json': infer Document }
}
  ? Document
  : never

/** Problem document (RFC 9457): the body of each answer of both daemons that is no success. */
export type ProblemDocument = BodyOf<Connector['responses']> | BodyOf<Platform['responses']>

type Fault = NonNullable<ProblemDocument['faults']>[number]

/** A request that did not succeed. `status` 0: the server was not reached. */
export class Problem extends Error {
  readonly document: ProblemDocument

  constructor(document: ProblemDocument) {
    super(document.detail === '' ? document.title : document.detail)
    this.name = 'Problem'
    this.document = document
  }

  get status(): number {
    return this.document.status
  }

  get unreachable(): boolean {
    return this.document.status === 0
  }

  /** Single faults of the document that was sent, where the server lists them. */
  get faults(): readonly Fault[] {
    return this.document.faults ?? []
  }

  /** Reads the problem out of a response that is not ok. */
  static async of(response: Response): Promise<Problem> {
    const body: unknown = await response.json().catch(() => undefined)
    const title = response.statusText || `HTTP ${response.status}`
    return new Problem(isDocument(body) ? body : substitute(response.status, title))
  }

  /** Converts anything thrown to a problem. */
  static from(thrown: unknown): Problem {
    if (thrown instanceof Problem) return thrown
    return Problem.unreached(thrown instanceof Error ? thrown.message : String(thrown))
  }

  /** A problem of a request that did not reach the server. */
  static unreached(detail = ''): Problem {
    return new Problem(substitute(0, 'unreachable', detail))
  }
}

/** Document in the place of one that did not arrive, as from a proxy. */
function substitute(status: number, title: string, detail = ''): ProblemDocument {
  return { type: 'about:blank', title, status, code: 'NO_DOCUMENT', detail }
}

function isDocument(body: unknown): body is ProblemDocument {
  return (
    body !== null &&
    typeof body === 'object' &&
    ['title', 'detail', 'code'].every(
      (member) => typeof (body as Record<string, unknown>)[member] === 'string',
    )
  )
}
