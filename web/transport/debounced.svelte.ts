import { untrack } from 'svelte'

/** A text that follows another one once it has not changed for a while. */
export interface Debounced {
  readonly current: string
}

/**
 * Text of a component for queries, which follows `source` after a pause in typing. An empty text
 * is followed at once.
 */
export function debounced(source: () => string, pauseMs: number): Debounced {
  let current = $state(untrack(source))
  $effect(() => {
    const wanted = source()
    const soon = setTimeout(() => (current = wanted), wanted === '' ? 0 : pauseMs)
    return () => {
      clearTimeout(soon)
    }
  })
  return {
    get current() {
      return current
    },
  }
}
