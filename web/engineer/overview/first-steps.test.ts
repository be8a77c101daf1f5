import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import type { InboxTotals } from '../api/types'
import { texts } from '../language/texts'
import type { LinkedStatus } from '../link/link-state'
import FirstSteps from './FirstSteps.svelte'

const status = (link: string, source?: string): LinkedStatus =>
  ({
    link: { state: link, backlog: 0 },
    sources: source === undefined ? [] : [{ sourceId: 's', state: source }],
  }) as unknown as LinkedStatus
const totals = (pending: number): InboxTotals =>
  ({ pending, refused: 0, mapped: 0 }) as unknown as InboxTotals

/** Headings of what is left to do, and where the first one leads. */
function left(known: LinkedStatus, pending: number): { titles: string[]; href: string | null } {
  const { unmount } = render(FirstSteps, {
    status: known,
    totals: totals(pending),
    pending: undefined,
  })
  const titles = screen.getAllByRole('heading', { level: 3 }).map((each) => each.textContent)
  const href = screen.getAllByRole('link')[0]?.getAttribute('href') ?? null
  unmount()
  return { titles, href }
}

describe('the first steps of a factory', () => {
  it('disappear one by one, and each leads to its page', () => {
    const all = [
      texts.firstSteps.link,
      texts.firstSteps.source,
      texts.firstSteps.request,
      texts.firstSteps.decide,
    ]
    expect(left(status('connecting'), 0)).toEqual({ titles: all, href: '#/link' })
    expect(left(status('up'), 0)).toEqual({ titles: all.slice(1), href: '#/new-source' })
    expect(left(status('up', 'connecting'), 0)).toEqual({
      titles: all.slice(1),
      href: '#/sources',
    })
    expect(left(status('up', 'connected'), 0)).toEqual({ titles: all.slice(2), href: '#/inbox' })
    expect(left(status('up', 'connected'), 3)).toEqual({ titles: all.slice(3), href: '#/inbox' })
  })
})
