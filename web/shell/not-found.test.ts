import { render, screen } from '@testing-library/svelte'
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { serve } from '../vitest.server'
import EngineerPages from '../engineer/Pages.svelte'
import SourcePage from '../engineer/sources/SourcePage.svelte'
import PartnerPages from '../partner/Pages.svelte'

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  serve({ 'GET /sources': () => ({ items: [] }) })
  vi.stubGlobal(
    'EventSource',
    class extends EventTarget {
      close = (): void => undefined
    },
  )
})
afterEach(() => {
  vi.unstubAllGlobals()
  location.hash = ''
})

it.each([
  ['engineers', EngineerPages],
  ['partners', PartnerPages],
])('an address that leads nowhere says so to %s', async (_, Pages) => {
  location.hash = '#/nonsense'
  dispatchEvent(new HashChangeEvent('hashchange'))
  render(Pages)
  await screen.findByRole('heading', { name: 'Nothing here' })
  screen.getByText('No page has this address.')
})

it('a source that is not there has no page with buttons', async () => {
  render(SourcePage, { sourceId: 'gone' })
  await screen.findByText('There is no source gone, or it was removed.')
  expect(screen.queryByRole('button', { name: 'Remove the source' })).toBeNull()
})
