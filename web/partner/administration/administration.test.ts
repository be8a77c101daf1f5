import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { router } from '@/navigation/router.svelte'
import { language } from '@/language/language.svelte'
import { session } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import { feed } from '../api/client'
import { texts } from '../language/texts'
import Pages from '../Pages.svelte'
import Administration from './Administration.svelte'
import { newPassword } from './new-password'

const at = '2026-01-01T00:00:00Z'
const acme = { organisationId: 'acme', name: 'Acme Aero', createdAt: at }
const hull = { organisationId: 'hull', name: 'Hull Ltd', createdAt: at }
const factory = { factoryId: 'MUC_1', organisationId: 'hull', name: 'Munich', createdAt: at }
const frames = {
  collaborationId: 'frames',
  name: 'Frames',
  createdAt: at,
  members: ['acme'],
  factories: ['MUC_1'],
}
const lists = {
  'GET /organisations': () => ({ items: [acme, hull] }),
  'GET /users': () => ({ items: [{ userName: 'anna', role: 'PLANNER', organisationId: 'acme' }] }),
  'GET /factories': () => ({ items: [factory] }),
  'GET /collaborations': () => ({ items: [frames] }),
  'GET /tools': () => ({
    items: [{ toolId: 'Planning', name: 'Planning', organisationId: 'acme', createdAt: at }],
  }),
}
const changes = (log: Asked[]): Asked[] => log.filter(({ method }) => method !== 'GET')
const dialog = (): Promise<HTMLElement> => screen.findByRole('dialog')
const save = async (name: string): Promise<void> => {
  await userEvent.click(within(await dialog()).getByRole('button', { name }))
}

function signIn(role: 'ADMINISTRATOR' | 'PLANNER'): void {
  session.state = { is: 'signedIn', who: { userName: 'root', role, csrfToken: 't' } }
}

beforeEach(() => {
  language.choose('en')
  signIn('ADMINISTRATOR')
})
afterEach(() => {
  vi.unstubAllGlobals()
  router.parts = []
})

describe('the administration', () => {
  it.each([
    ['organisations', 'Acme Aero'],
    ['people', 'anna'],
    ['factories', 'Munich'],
    ['collaborations', 'Frames'],
    ['tools', 'Planning'],
  ] as const)('lists %s, each with a way to remove it', async (section, name) => {
    serve(lists)
    render(Administration, { section })
    expect(await screen.findAllByText(name)).toBeTruthy()
    expect(screen.getByText(texts.administration[section].hint)).toBeTruthy()
    expect(screen.getByRole('button', { name: texts.administration[section].add })).toBeTruthy()
    expect(screen.getAllByRole('button', { name: /^Remove: / }).length).toBeGreaterThan(0)
  })

  it('is for those who run the platform alone', () => {
    serve(lists)
    vi.spyOn(feed, 'start').mockImplementation(() => undefined)
    router.parts = ['administration']
    const { unmount } = render(Pages)
    expect(
      screen.getByRole('button', { name: texts.administration.organisations.add }),
    ).toBeTruthy()
    unmount()
    signIn('PLANNER')
    render(Pages)
    expect(
      screen.queryByRole('button', { name: texts.administration.organisations.add }),
    ).toBeNull()
    expect(screen.queryByRole('link', { name: texts.administration.title })).toBeNull()
  })

  it('adds an organisation, and none whose id is in use', async () => {
    const log = serve({ ...lists, 'POST /organisations': ({ body }: Asked) => body })
    render(Administration, {})
    await userEvent.click(
      await screen.findByRole('button', { name: texts.administration.organisations.add }),
    )
    await screen.findByText('Acme Aero')
    await userEvent.type(within(await dialog()).getByLabelText(texts.administration.id), 'acme')
    expect(within(await dialog()).getByText(texts.administration.idTaken)).toBeTruthy()
    await save('Add')
    expect(changes(log)).toEqual([])
    await userEvent.type(within(await dialog()).getByLabelText(texts.administration.id), '-2')
    await userEvent.type(
      within(await dialog()).getByLabelText(texts.administration.name),
      'Acme Two',
    )
    await save('Add')
    await vi.waitFor(() => {
      expect(changes(log).map(({ body }) => body)).toEqual([
        { organisationId: 'acme-2', name: 'Acme Two' },
      ])
    })
  })

  it('makes a password for a new person and shows it once', async () => {
    const log = serve({ ...lists, 'PUT /users/bert': ({ body }: Asked) => body })
    render(Administration, { section: 'people' })
    await screen.findByText('anna')
    await userEvent.click(screen.getByRole('button', { name: texts.administration.people.add }))
    await userEvent.type(within(await dialog()).getByLabelText('User name'), 'bert')
    await userEvent.selectOptions(
      within(await dialog()).getByLabelText(texts.administration.organisation),
      'acme',
    )
    await save('Save')
    const shown = await screen.findByLabelText(texts.administration.people.password)
    const [put] = changes(log)
    expect(put).toMatchObject({ path: '/users/bert' })
    expect(put?.body).toEqual({
      role: 'PLANNER',
      organisationId: 'acme',
      password: shown.textContent,
    })
    expect(shown.textContent).toHaveLength(20)
    await save(texts.administration.secret.done)
    expect(screen.queryByText(shown.textContent)).toBeNull()
  })

  it('ends sessions of a person, and asks before a second factor is reset', async () => {
    const session = {
      sessionId: 's1',
      kind: 'WEB',
      address: '10.0.0.7',
      userAgent: 'Firefox',
      startedAt: at,
      lastUsedAt: at,
      isPresent: false,
    }
    const log = serve({
      ...lists,
      'GET /users/anna/sessions': () => ({ items: [session] }),
      'DELETE /users/anna/sessions/s1': () => new Response(null, { status: 204 }),
      'DELETE /users/anna/second-factor': () => new Response(null, { status: 204 }),
    })
    render(Administration, { section: 'people' })
    await userEvent.click(await screen.findByRole('button', { name: 'Sessions: anna' }))
    await userEvent.click(await screen.findByRole('button', { name: /: 10\.0\.0\.7$/ }))
    const name = texts.administration.people.resetFactor
    await userEvent.click(screen.getByRole('button', { name }))
    expect(changes(log).map(({ path }) => path)).toEqual(['/users/anna/sessions/s1'])
    expect(screen.getByText(texts.administration.people.resetText)).toBeTruthy()
    await userEvent.click(screen.getAllByRole('button', { name }).at(-1) ?? document.body)
    await vi.waitFor(() => {
      expect(changes(log).at(-1)?.path).toBe('/users/anna/second-factor')
    })
  })

  it('hands a new factory its enrolment token at once', async () => {
    const log = serve({
      ...lists,
      'POST /factories': () => ({ ...factory, factoryId: 'HAM_1' }),
      'POST /factories/HAM_1/enrolment-tokens': () => ({ token: 'x.y', expiresAt: at }),
    })
    render(Administration, { section: 'factories' })
    await userEvent.click(
      await screen.findByRole('button', { name: texts.administration.factories.add }),
    )
    await userEvent.type(within(await dialog()).getByLabelText(texts.factories.id), 'HAM_1')
    const choice = within(await dialog()).getByLabelText(texts.factories.organisation)
    await userEvent.selectOptions(choice, 'hull')
    await save('Add')
    expect(await screen.findByText('x.y')).toBeTruthy()
    expect(changes(log).map(({ path }) => path)).toEqual([
      '/factories',
      '/factories/HAM_1/enrolment-tokens',
    ])
  })

  it('starts a collaboration with members and factories', async () => {
    const log = serve({ ...lists, 'POST /collaborations': ({ body }: Asked) => body })
    render(Administration, { section: 'collaborations' })
    await screen.findByText('Frames')
    await userEvent.click(
      screen.getByRole('button', { name: texts.administration.collaborations.add }),
    )
    await userEvent.type(within(await dialog()).getByLabelText(texts.administration.id), 'hulls')
    for (const name of [/^Acme Aero/, /^Hull Ltd/, /^Munich/])
      await userEvent.click(within(await dialog()).getByRole('checkbox', { name }))
    await save('Add')
    await vi.waitFor(() => {
      expect(changes(log).map(({ body }) => body)).toEqual([
        {
          collaborationId: 'hulls',
          name: 'hulls',
          members: ['acme', 'hull'],
          factories: ['MUC_1'],
        },
      ])
    })
  })

  it('says before a collaboration is removed that its members part', async () => {
    const log = serve({
      ...lists,
      'DELETE /collaborations/frames': ({ path }: Asked) => ({
        isDone: !path.includes('dryRun=true'),
        inForce: [],
        people: [],
        sessions: 0,
        credentials: 0,
        requests: [],
        remains: ['NETWORKS'],
      }),
    })
    render(Administration, { section: 'collaborations' })
    const name = texts.administration.removeOf('Frames')
    await userEvent.click(await screen.findByRole('button', { name }))
    expect(await screen.findByText(texts.administration.collaborations.removeNote)).toBeTruthy()
    await save(texts.removals.remove)
    await vi.waitFor(() => {
      expect(changes(log).map(({ path }) => path)).toEqual([
        '/collaborations/frames?dryRun=true',
        '/collaborations/frames?dryRun=false',
      ])
    })
  })

  it('changes who takes part in a collaboration, with what ends before it ends', async () => {
    const path = '/collaborations/frames/factories/MUC_1'
    const log = serve({
      ...lists,
      'PUT /collaborations/frames/members/hull': () => frames,
      [`DELETE ${path}`]: () => ({
        isDone: false,
        inForce: ['operation-networks/n'],
        people: [],
        sessions: 0,
        credentials: 0,
        requests: [],
        remains: [],
      }),
    })
    render(Administration, { section: 'collaborations', id: 'frames' })
    const choice = await screen.findByLabelText(texts.administration.collaborations.whichMember)
    expect(within(choice).queryByRole('option', { name: /Acme/ })).toBeNull()
    await userEvent.selectOptions(choice, 'hull')
    await userEvent.click(
      screen.getByRole('button', { name: texts.administration.collaborations.addMember }),
    )
    await userEvent.click(
      screen.getByRole('button', { name: texts.administration.removeOf('MUC_1') }),
    )
    expect(await screen.findByText('operation-networks/n')).toBeTruthy()
    expect(changes(log).map(({ method, path: asked }) => `${method} ${asked}`)).toEqual([
      'PUT /collaborations/frames/members/hull',
      `DELETE ${path}?dryRun=true`,
    ])
  })

  it('shows the credential of a new tool once, with all that the program needs', async () => {
    serve({
      ...lists,
      'POST /tools': ({ body }: Asked) => body,
      'POST /tools/Erp/credentials': () => ({
        brokerUrl: 'amqps://broker.example',
        userName: 'tool.Erp',
        password: 'its-secret',
      }),
    })
    render(Administration, { section: 'tools' })
    await screen.findByLabelText(texts.administration.removeOf('Planning'))
    await userEvent.click(screen.getByRole('button', { name: texts.administration.tools.add }))
    await userEvent.type(within(await dialog()).getByLabelText(texts.administration.id), 'Erp')
    await userEvent.selectOptions(
      within(await dialog()).getByLabelText(texts.administration.organisation),
      'acme',
    )
    await save('Add')
    for (const text of ['amqps://broker.example', 'tool.Erp', 'its-secret', 'tool.Erp.requests'])
      expect(await screen.findByText(text)).toBeTruthy()
    await save(texts.administration.secret.done)
    expect(screen.queryByText('its-secret')).toBeNull()
  })

  it('draws long lists in parts and finds in them', async () => {
    const items = Array.from({ length: 120 }, (_, index) => ({
      organisationId: `o${index}`,
      name: `Company ${index}`,
      createdAt: at,
    }))
    serve({ ...lists, 'GET /organisations': () => ({ items }) })
    render(Administration, {})
    await screen.findByText('Company 0')
    expect(screen.queryByText('Company 50')).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: texts.administration.more(50) }))
    expect(screen.getByText('Company 50')).toBeTruthy()
    await userEvent.type(screen.getByRole('searchbox'), 'company 119')
    expect(screen.getByText('Company 119')).toBeTruthy()
    expect(screen.queryByText('Company 0')).toBeNull()
  })
})

it('makes passwords that differ and that policies take', () => {
  const made = new Set(Array.from({ length: 100 }, newPassword))
  expect(made.size).toBe(100)
  for (const each of made) expect(each).toMatch(/^[\w-]{20}$/)
})
