import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { UserView } from '../api/types'
import UsersPage from './UsersPage.svelte'

const LAST_ENGINEER = 'This is the last engineer. Make another user one first.'
let people: UserView[]

/** Connector that stores users. */
function connector(refusing?: Response): Asked[] {
  const put = ({ path, body }: Asked): unknown => {
    if (refusing) return refusing
    const userName = path.slice('/users/'.length)
    const user = { userName, role: (body as UserView).role }
    people = [...people.filter((each) => each.userName !== userName), user]
    return user
  }
  const remove = (): unknown => refusing ?? new Response(null, { status: 204 })
  return serve({
    'GET /users': () => ({ items: people }),
    'PUT /users/otto': put,
    'PUT /users/ida': put,
    'DELETE /users/otto': remove,
  })
}
const changes = (log: Asked[]): Asked[] => log.filter(({ method }) => method !== 'GET')

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  people = [
    { userName: 'eva', role: 'ENGINEER' },
    { userName: 'otto', role: 'OPERATOR' },
  ]
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the users page', () => {
  it('adds a person with a role and a password', async () => {
    const log = connector()
    render(UsersPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Add a person' }))
    const dialog = within(screen.getByRole('dialog'))
    await userEvent.type(dialog.getByLabelText('User name'), 'ida')
    await userEvent.click(dialog.getByRole('radio', { name: 'Viewer' }))
    await userEvent.type(dialog.getByLabelText('Password'), 'correct horse battery')
    await userEvent.click(dialog.getByRole('button', { name: 'Save' }))
    expect(await screen.findByRole('combobox', { name: 'Role: ida' })).toHaveProperty(
      'value',
      'VIEWER',
    )
    expect(changes(log)).toEqual([
      {
        method: 'PUT',
        path: '/users/ida',
        body: { role: 'VIEWER', password: 'correct horse battery' },
        isNew: true,
      },
    ])
  })

  it('asks for a longer password before it asks the connector', async () => {
    const log = connector()
    render(UsersPage)
    await userEvent.click(await screen.findByRole('button', { name: 'New password: otto' }))
    await userEvent.type(screen.getByLabelText('Password'), 'too short')
    await userEvent.click(screen.getByRole('button', { name: 'Save' }))
    expect(screen.getByLabelText('Password').getAttribute('aria-invalid')).toBe('true')
    await userEvent.type(screen.getByLabelText('Password'), ' no more')
    await userEvent.click(screen.getByRole('button', { name: 'Save' }))
    expect(changes(log)).toEqual([
      {
        method: 'PUT',
        path: '/users/otto',
        body: { role: 'OPERATOR', password: 'too short no more' },
      },
    ])
  })

  it('changes a role at once, and back', async () => {
    const log = connector()
    render(UsersPage)
    await userEvent.selectOptions(
      await screen.findByRole('combobox', { name: 'Role: otto' }),
      'ENGINEER',
    )
    await vi.waitFor(() => expect(toasts.list).toHaveLength(1))
    toasts.list[0]?.action?.run()
    await vi.waitFor(() =>
      expect(changes(log).map(({ body }) => body)).toEqual([
        { role: 'ENGINEER' },
        { role: 'OPERATOR' },
      ]),
    )
    await vi.waitFor(() =>
      expect(screen.getByRole('combobox', { name: 'Role: otto' })).toHaveProperty(
        'value',
        'OPERATOR',
      ),
    )
  })

  it('says why the last engineer stays one, and shows the role that holds', async () => {
    people = [
      { userName: 'eva', role: 'OPERATOR' },
      { userName: 'otto', role: 'ENGINEER' },
    ]
    connector(problem(409, LAST_ENGINEER))
    render(UsersPage)
    const role = await screen.findByRole('combobox', { name: 'Role: otto' })
    await userEvent.selectOptions(role, 'VIEWER')
    await vi.waitFor(() => expect(toasts.list.map(({ text }) => text)).toEqual([LAST_ENGINEER]))
    await vi.waitFor(() => expect(role).toHaveProperty('value', 'ENGINEER'))
  })

  it('keeps what was typed when the connector refuses it', async () => {
    connector(
      problem(422, 'The name is taken.', [
        { pointer: '/userName', code: 'TAKEN', message: 'Choose another one.' },
      ]),
    )
    render(UsersPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Add a person' }))
    await userEvent.type(screen.getByLabelText('User name'), 'ida')
    await userEvent.type(screen.getByLabelText('Password'), 'correct horse battery')
    await userEvent.click(screen.getByRole('button', { name: 'Save' }))
    expect((await screen.findByRole('alert')).textContent).toContain('Choose another one.')
    expect(screen.getByLabelText('User name')).toHaveProperty('value', 'ida')
  })

  it('ends a session of another person, and resets a lost second factor', async () => {
    const times = { startedAt: '2026-01-01T08:00:00Z', lastUsedAt: '2026-01-01T08:00:00Z' }
    const otto = { sessionId: 'o', isPresent: false, address: '192.0.2.2', userAgent: '', ...times }
    const done = (): Response => new Response(null, { status: 204 })
    const log = serve({
      'GET /users': () => ({ items: people }),
      'GET /users/otto/sessions': () => ({ items: [otto] }),
      'DELETE /users/otto/sessions/o': done,
      'DELETE /users/otto/second-factor': done,
    })
    render(UsersPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Sessions: otto' }))
    await userEvent.click(await screen.findByRole('button', { name: 'End: 192.0.2.2' }))
    await userEvent.click(screen.getByRole('button', { name: 'Reset second factor' }))
    await vi.waitFor(() =>
      expect(changes(log).map(({ path }) => path)).toEqual([
        '/users/otto/sessions/o',
        '/users/otto/second-factor',
      ]),
    )
  })

  it('asks before removing a user, and never offers to remove oneself', async () => {
    const log = connector()
    render(UsersPage)
    expect(await screen.findByRole('combobox', { name: 'Role: eva' })).toHaveProperty(
      'disabled',
      true,
    )
    expect(screen.queryByRole('button', { name: 'Remove: eva' })).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: 'Remove: otto' }))
    expect(changes(log)).toEqual([])
    await userEvent.click(
      within(screen.getByRole('dialog')).getByRole('button', { name: 'Remove' }),
    )
    await vi.waitFor(() =>
      expect(changes(log)).toEqual([{ method: 'DELETE', path: '/users/otto', body: undefined }]),
    )
  })
})
