import { problemText } from '@/language/said'
import { Problem } from '@/transport/problem'

export interface Toast {
  id: number
  tone: 'good' | 'bad'
  text: string
  action?: { label: string; run: () => void } | undefined
}

const SHOWN_MS = 6_000

class Toasts {
  list = $state.raw<Toast[]>([])
  #next = 1

  show(tone: Toast['tone'], text: string, action?: Toast['action']): void {
    const id = this.#next++
    this.list = [...this.list.slice(-3), { id, tone, text, action }]
    setTimeout(() => {
      this.dismiss(id)
    }, SHOWN_MS)
  }

  /** Shows a problem in the language of the page. */
  problem(thrown: unknown): void {
    this.show('bad', problemText(Problem.from(thrown)))
  }

  dismiss(id: number): void {
    this.list = this.list.filter((toast) => toast.id !== id)
  }
}

/** Short messages about the reader's last actions. */
export const toasts = new Toasts()
