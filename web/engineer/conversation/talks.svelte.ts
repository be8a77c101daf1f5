import { SvelteSet } from 'svelte/reactivity'
import { feed } from '../api/client'

/** Networks in which somebody said something that nobody has looked at since, as far as this page was open. */
class Talks {
  readonly #unread = new SvelteSet<string>()

  /** Listens. Returns how to stop. */
  open(): () => void {
    return feed.on('comment', (event) => {
      if (event !== null && typeof event === 'object' && 'operationNetworkId' in event)
        this.#unread.add(String(event.operationNetworkId))
    })
  }

  isUnread(operationNetworkId: string): boolean {
    return this.#unread.has(operationNetworkId)
  }

  read(operationNetworkId: string): void {
    this.#unread.delete(operationNetworkId)
  }
}

export const talks = new Talks()
