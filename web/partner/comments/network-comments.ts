import { platform } from '../api/client'
import type { CommentEntry } from '../api/types'

/** Comments of one page of the platform's list. */
const PAGE = 1000

/** Comments on a network that the reader may see, oldest first, to the last page. */
export async function commentsOf(
  operationNetworkId: string,
  signal: AbortSignal,
): Promise<CommentEntry[]> {
  const all: CommentEntry[] = []
  let cursor: string | null | undefined
  do {
    const page = await platform.get('/operation-networks/{operationNetworkId}/comments', {
      path: { operationNetworkId },
      query: { limit: PAGE, ...(cursor ? { cursor } : {}) },
      signal,
    })
    all.push(...page.items)
    cursor = page.nextCursor
  } while (cursor)
  return all
}
