import { Problem } from '@/transport/problem'

const TYPING_MS = 300

/** Effect of a draft while it is typed, asked for a moment after each change. A name has no effect, so typing it asks nothing. */
export class DraftEffect<Draft extends object, Answer> {
  answer = $state.raw<Answer>()
  problem = $state.raw<Problem>()

  constructor(draft: () => Draft, ask: (draft: Draft, signal: AbortSignal) => Promise<Answer>) {
    const asked = $derived(JSON.stringify({ ...draft(), name: '–' }))
    $effect(() => {
      const wanted = JSON.parse(asked) as Draft
      const running = new AbortController()
      const soon = setTimeout(() => {
        ask(wanted, running.signal).then(
          (answer) => {
            this.answer = answer
            this.problem = undefined
          },
          (failure: unknown) => {
            if (!running.signal.aborted) this.problem = Problem.from(failure)
          },
        )
      }, TYPING_MS)
      return () => {
        clearTimeout(soon)
        running.abort()
      }
    })
  }
}
