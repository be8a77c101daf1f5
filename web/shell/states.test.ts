import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import Age from '@/design/Age.svelte'
import { clock } from '@/format/clock.svelte'
import type { FeedStatus } from '@/transport/live.svelte'
import FeedState from './FeedState.svelte'

describe('states are shown by their evidence and its age', () => {
  const shown = (state: FeedStatus['state'], secondsAgo: number): string => {
    render(FeedState, { feed: { state, since: clock.now - secondsAgo * 1000 } as FeedStatus })
    return screen.getByRole('status').textContent.replaceAll(/\s+/g, ' ').trim()
  }
  it('live updates have no age, interrupted ones that of their last sign', () => {
    expect(shown('live', 90)).toBe('Live')
  })
  it('an interruption names the time that has passed since', () => {
    expect(shown('interrupted', 90)).toMatch(/^Updates interrupted since .*min/)
  })
  it('what was never seen has no age', () => {
    render(Age, { at: null })
    expect(screen.queryByRole('time')).toBeNull()
    expect(screen.getByText('never')).toBeTruthy()
  })
  it('an age grows with the clock of the server', async () => {
    const at = clock.now - 5000
    const { container } = render(Age, { at })
    const before = container.textContent
    clock.now += 3_600_000
    await Promise.resolve()
    expect(container.textContent).not.toBe(before)
    expect(container.querySelector('time')?.dateTime).toBe(new Date(at).toISOString())
  })
})
