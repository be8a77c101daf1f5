import { SvelteSet } from 'svelte/reactivity'
import { feed } from '../api/client'

/** Networks with comments that arrived since this page was opened and were not read yet. */
class UnreadComments {
  readonly #unread = new SvelteSet<string>()

  /** Starts listening. Returns a function that stops. */
  open(): () => void {
    return feed.on('comment', ({ data }) => {
      this.#unread.add(data.operationNetworkId)
    })
  }

  isUnread(operationNetworkId: string): boolean {
    return this.#unread.has(operationNetworkId)
  }

  read(operationNetworkId: string): void {
    this.#unread.delete(operationNetworkId)
  }
}

export const unreadComments = new UnreadComments()
