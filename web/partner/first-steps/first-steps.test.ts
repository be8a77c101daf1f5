import { render, screen } from '@testing-library/svelte'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { language } from '@/language/language.svelte'
import { session } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { Collaboration, Factory, NetworkSummary } from '../api/types'
import { texts } from '../language/texts'
import FirstSteps from './FirstSteps.svelte'
import { administratorSteps, plannerSteps, type FirstStep, type Known } from './steps'

const at = '2026-01-01T00:00:00Z'
const organisation = { organisationId: 'acme', name: 'Acme', createdAt: at }
const factory: Factory = {
  factoryId: 'MUC_1',
  organisationId: 'acme',
  name: 'Munich',
  createdAt: at,
}
const collaboration: Collaboration = {
  collaborationId: 'frames',
  name: 'Frames',
  createdAt: at,
  members: ['acme'],
  factories: ['MUC_1'],
}
const network: NetworkSummary = {
  operationNetworkId: 'n',
  collaborationId: 'frames',
  revision: 1,
  updatedAt: at,
  partsUnanswered: 0,
  partsRejected: 0,
}
const nothing: Known = { organisations: [], factories: [], collaborations: [], people: [] }
const titles = (steps: FirstStep[]): string[] =>
  steps.filter(({ done }) => !done).map(({ title }) => title)

function signIn(role: 'ADMINISTRATOR' | 'PLANNER' | 'VIEWER'): void {
  session.state = {
    is: 'signedIn',
    who: { userName: 'anna', role, organisationId: 'acme', csrfToken: 't' },
  }
}

beforeEach(() => {
  language.choose('en')
  signIn('ADMINISTRATOR')
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the first steps of those who run the platform', () => {
  it('disappear one by one', () => {
    let known = nothing
    const left = (more: Partial<Known>): string[] => {
      known = { ...known, ...more }
      return titles(administratorSteps(known))
    }
    const all = [
      texts.administration.firstSteps.organisation,
      texts.administration.firstSteps.factory,
      texts.administration.firstSteps.enrol,
      texts.administration.firstSteps.collaboration,
      texts.administration.firstSteps.person,
    ]
    expect(left({})).toEqual(all)
    expect(left({ organisations: [organisation] })).toEqual(all.slice(1))
    expect(left({ factories: [factory] })).toEqual(all.slice(2))
    expect(left({ factories: [factory, { ...factory, enrolledAt: at }] })).toEqual(all.slice(3))
    expect(left({ collaborations: [{ ...collaboration, factories: [] }] })).toEqual(all.slice(3))
    expect(left({ collaborations: [collaboration] })).toEqual([
      texts.administration.firstSteps.person,
    ])
    expect(left({ people: [{ userName: 'root', role: 'ADMINISTRATOR' }] })).toEqual([
      texts.administration.firstSteps.person,
    ])
    expect(
      left({ people: [{ userName: 'bert', role: 'PLANNER', organisationId: 'acme' }] }),
    ).toEqual([])
  })

  it('lead to the pages where they are done', () => {
    const known = {
      ...nothing,
      factories: [factory],
      collaborations: [{ ...collaboration, members: [] }],
    }
    const steps = administratorSteps(known)
    expect(steps.map(({ href }) => href)).toEqual([
      '#/administration/organisations',
      '#/administration/factories',
      '#/administration/factories',
      '#/administration/collaborations/frames',
      '#/administration/people',
    ])
    expect(steps[2]?.text).toContain('Munich')
    expect(plannerSteps(undefined, false).map(({ href }) => href)).toEqual([
      '#/new-network',
      '#/new-network',
    ])
    expect(plannerSteps('n', false)[1]?.href).toBe('#/networks/n')
  })
})

describe('the first steps on the start page', () => {
  const view = (requests: unknown[]) => () => ({
    network: {
      operationNetworkId: 'n',
      operationList: [{ operationId: 'o', dynamicDataRequestList: requests }],
    },
  })

  it('are those that are left', async () => {
    serve({
      'GET /organisations': () => ({ items: [organisation] }),
      'GET /factories': () => ({ items: [] }),
      'GET /collaborations': () => ({ items: [] }),
      'GET /users': () => ({ items: [] }),
      'GET /operation-networks/n': view([]),
    })
    render(FirstSteps, { networks: [network] })
    expect(
      await screen.findByRole('heading', { name: texts.administration.firstSteps.factory }),
    ).toBeTruthy()
    const headings = screen.getAllByRole('heading', { level: 3 }).map((each) => each.textContent)
    expect(headings).toEqual([
      texts.administration.firstSteps.factory,
      texts.administration.firstSteps.enrol,
      texts.administration.firstSteps.collaboration,
      texts.administration.firstSteps.person,
      texts.administration.firstSteps.request,
    ])
  })

  it('are of planners the network and the request alone, and of viewers none', async () => {
    const log = serve({})
    signIn('PLANNER')
    const { unmount } = render(FirstSteps, { networks: [] })
    expect(
      await screen.findByRole('heading', { name: texts.administration.firstSteps.network }),
    ).toBeTruthy()
    expect(screen.getAllByRole('listitem')).toHaveLength(2)
    expect(log).toEqual([])
    unmount()
    signIn('VIEWER')
    render(FirstSteps, { networks: [] })
    await Promise.resolve()
    expect(
      screen.queryByRole('heading', { name: texts.administration.firstSteps.title }),
    ).toBeNull()
  })

  it('are gone once something is asked, without a look into networks that report', async () => {
    signIn('PLANNER')
    let log: Asked[] = serve({ 'GET /operation-networks/n': view([{}]) })
    const { unmount } = render(FirstSteps, { networks: [network] })
    await vi.waitFor(() => {
      expect(log).toHaveLength(1)
    })
    expect(
      screen.queryByRole('heading', { name: texts.administration.firstSteps.title }),
    ).toBeNull()
    unmount()
    log = serve({})
    render(FirstSteps, { networks: [{ ...network, lastReportAt: at }] })
    await Promise.resolve()
    expect(log).toEqual([])
    expect(
      screen.queryByRole('heading', { name: texts.administration.firstSteps.title }),
    ).toBeNull()
  })
})
