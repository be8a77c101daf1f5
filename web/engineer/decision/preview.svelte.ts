import { severity } from '@/format/status'
import { Problem } from '@/transport/problem'
import { connector, FIELD } from '../api/client'
import type { MappingDiagnostic, FieldKey, Preview } from '../api/types'
import { tidy, type Draft } from './draft.svelte'

const TYPING_MS = 250
const LIVE_MS = 1_500

/**
 * Preview of a draft. The connector computes it from live values after each change and
 * periodically.
 */
export class PreviewRun {
  value = $state.raw<Preview | undefined>()
  problem = $state.raw<Problem | undefined>()
  isRunning = $state(false)
  /** Draft that the preview shows. */
  #shown = ''

  get diagnostics(): MappingDiagnostic[] {
    return this.value?.diagnostics ?? []
  }

  diagnosticsOf(step: number): MappingDiagnostic[] {
    return this.diagnostics.filter((diagnostic) => stepOf(diagnostic) === step)
  }

  /** Faults that prevent consent. */
  get errors(): MappingDiagnostic[] {
    return this.diagnostics.filter((diagnostic) => diagnostic.severity === 'error')
  }

  /** Returns whether a function fails on the present values, by inputs that are good; `undefined` where they are not. */
  get isFailing(): boolean | undefined {
    const { inputs, steps } = this.value ?? { inputs: [], steps: [] }
    if (!steps.some((step) => step.message != null)) return false
    return inputs.every(({ status }) => severity(status) === 'good') ? true : undefined
  }

  /** Id of the preview as seen, for the decision; none while it still shows a former draft. */
  idFor(draft: Draft): { previewId?: string } {
    const isCurrent = this.value !== undefined && this.#shown === JSON.stringify(bodyOf(draft))
    return isCurrent && this.value ? { previewId: this.value.previewId } : {}
  }

  /** Follows a draft until the returned function is called. Reactive: to be called in an effect. */
  follow(key: FieldKey, draft: Draft): () => void {
    const body = bodyOf(draft)
    const text = JSON.stringify(body)
    if (!draft.isComplete) {
      this.value = undefined
      this.problem = undefined
      return () => undefined
    }
    const running = new AbortController()
    let next = setTimeout(() => void run(), TYPING_MS)
    const run = async (): Promise<void> => {
      this.isRunning = true
      try {
        const value = await connector.post(`${FIELD}/preview`, {
          path: key,
          body: JSON.parse(text) as typeof body,
          signal: running.signal,
        })
        if (running.signal.aborted) return
        this.value = value
        this.#shown = text
        this.problem = undefined
      } catch (failure) {
        if (running.signal.aborted) return
        this.problem = Problem.from(failure)
      }
      this.isRunning = false
      next = setTimeout(() => void (document.hidden ? wait() : run()), LIVE_MS)
    }
    const wait = (): void => {
      next = setTimeout(() => void (document.hidden ? wait() : run()), LIVE_MS)
    }
    return () => {
      clearTimeout(next)
      running.abort()
    }
  }
}

function bodyOf(draft: Draft) {
  return {
    valueSource: draft.source,
    mapping: draft.mapping,
    disclosure: tidy(draft.disclosure),
    ...(draft.policyId === '' ? {} : { policyId: draft.policyId }),
  }
}

/** Index of the function that a diagnostic is about; `undefined` for the mapping as a whole. */
export function stepOf(diagnostic: MappingDiagnostic): number | undefined {
  const match = /\/steps\/(\d+)(\/|$)/.exec(diagnostic.pointer)
  return match === null ? undefined : Number(match[1])
}
