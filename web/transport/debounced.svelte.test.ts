import { flushSync } from 'svelte'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { debounced, type Debounced } from './debounced.svelte'

const PAUSE_MS = 200

beforeEach(() => {
  vi.useFakeTimers()
})
afterEach(() => {
  vi.useRealTimers()
})

it('a debounced text follows after a pause in typing, and an empty one at once', () => {
  let typed = $state('')
  const type = (text: string, waitMs: number): void => {
    typed = text
    flushSync()
    vi.advanceTimersByTime(waitMs)
  }
  let followed: Debounced | undefined
  const stop = $effect.root(() => {
    followed = debounced(() => typed, PAUSE_MS)
  })
  type('a', PAUSE_MS - 1)
  type('ab', PAUSE_MS - 1)
  expect(followed?.current).toBe('')
  vi.advanceTimersByTime(1)
  expect(followed?.current).toBe('ab')
  type('', 0)
  expect(followed?.current).toBe('')
  stop()
})
