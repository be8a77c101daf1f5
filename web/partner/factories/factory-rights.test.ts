import { render, screen } from '@testing-library/svelte'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import FactoriesPage from './FactoriesPage.svelte'
import FactoryPage from './FactoryPage.svelte'

const contender = {
  host: 'second',
  instanceId: 'i2',
  place: 'p2',
  lastHeardAt: '2026-11-21T10:00:00Z',
  isSecond: true,
}
const holder = { host: 'first', instanceId: 'i1', place: 'p1', lastHeardAt: contender.lastHeardAt }
const ADMINISTRATION = [
  'Create an enrolment token',
  'Revoke the credentials',
  'Hand the lease over',
] as const

function signIn(role: 'VIEWER' | 'ADMINISTRATOR', organisationId?: string): Asked[] {
  session.state = {
    is: 'signedIn',
    who: { userName: 'p', role, csrfToken: 't', organisationId: organisationId ?? null },
  }
  return serve({
    'GET /factories': () => ({
      items: [{ factoryId: 'F', name: 'Mill', organisationId: 'steel' }],
    }),
    'GET /factories/F/lease': () => ({ holder, contenders: [contender] }),
    'GET /factories/F/writers': () => ({ items: [] }),
  })
}
const buttons = (): string[] =>
  screen.queryAllByRole('button').map((button) => button.textContent.trim())

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the pages of factories', () => {
  it('let administrators enrol, revoke and hand over', async () => {
    signIn('ADMINISTRATOR')
    render(FactoryPage, { factoryId: 'F' })
    expect(await screen.findByText('second')).toBeTruthy()
    expect(buttons()).toEqual(expect.arrayContaining([...ADMINISTRATION]))
  })
  it('show members of the organisation the lease, without what administrators do', async () => {
    signIn('VIEWER', 'steel')
    render(FactoryPage, { factoryId: 'F' })
    expect(await screen.findByText('second')).toBeTruthy()
    expect(buttons().filter((name) => ADMINISTRATION.some((each) => each === name))).toEqual([])
  })
  it('do not ask for the lease of a factory of others', async () => {
    const log = signIn('VIEWER', 'acme')
    render(FactoryPage, { factoryId: 'F' })
    expect(await screen.findByRole('heading', { name: 'Mill' })).toBeTruthy()
    await new Promise((done) => setTimeout(done, 20))
    expect(log.filter(({ path }) => path.endsWith('/lease'))).toEqual([])
  })
  it('say that there is no such factory, without buttons for it', async () => {
    signIn('ADMINISTRATOR')
    render(FactoryPage, { factoryId: 'NOPE' })
    expect(await screen.findByText(/^There is no such factory/)).toBeTruthy()
    expect(buttons().filter((name) => ADMINISTRATION.some((each) => each === name))).toEqual([])
  })
  it('let only administrators add one', async () => {
    signIn('VIEWER', 'steel')
    const { unmount } = render(FactoriesPage)
    expect(await screen.findByText('Mill')).toBeTruthy()
    expect(buttons()).not.toContain('Add a factory')
    unmount()
    signIn('ADMINISTRATOR')
    render(FactoriesPage)
    expect(await screen.findByRole('button', { name: 'Add a factory' })).toBeTruthy()
  })
})
