import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import Value from '@/design/Value.svelte'
import { language } from '@/language/language.svelte'
import { session } from '@/transport/session.svelte'
import SignIn from './SignIn.svelte'

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('signing in', () => {
  const fill = async (): Promise<void> => {
    await userEvent.type(screen.getByLabelText('User name'), 'engineer')
    await userEvent.type(screen.getByLabelText('Password'), 'wrong')
    await userEvent.click(screen.getByRole('button', { name: 'Sign in' }))
  }
  it.each([
    [401, 'User name or password is not right.'],
    [429, 'Too many attempts. Wait a moment, then try again.'],
  ])('says why it did not work (%d)', async (status, text) => {
    vi.stubGlobal('fetch', () => Promise.resolve(new Response('{}', { status })))
    render(SignIn, { subtitle: 'Test', expired: false })
    await fill()
    expect((await screen.findByRole('alert')).textContent).toBe(text)
    expect(screen.getByLabelText<HTMLInputElement>('Password').value).toBe('')
  })
  it('asks for the code of a second factor, and keeps the password meanwhile', async () => {
    const bodies: unknown[] = []
    const answers = [
      new Response(
        JSON.stringify({
          title: 'Unauthorized',
          code: 'SECOND_FACTOR_NEEDED',
          detail: 'A code.',
          status: 401,
        }),
        { status: 401 },
      ),
      new Response('{}', { status: 401 }),
      new Response(JSON.stringify({ userName: 'engineer', role: 'ENGINEER', csrfToken: 't' })),
    ]
    vi.stubGlobal('fetch', (_: string, { body }: RequestInit) => {
      bodies.push(JSON.parse(body as string))
      return Promise.resolve(answers.shift())
    })
    render(SignIn, { subtitle: 'Test', expired: false })
    await fill()
    const code = await screen.findByLabelText<HTMLInputElement>('Code')
    expect(screen.getByRole('alert').textContent).toContain('authenticator app')
    await userEvent.type(code, '000000')
    await userEvent.click(screen.getByRole('button', { name: 'Sign in' }))
    await vi.waitFor(() => expect(screen.getByRole('alert').textContent).toContain('or code'))
    await userEvent.type(code, '123456')
    await userEvent.click(screen.getByRole('button', { name: 'Sign in' }))
    await vi.waitFor(() => expect(session.who?.userName).toBe('engineer'))
    const credentials = { userName: 'engineer', password: 'wrong' }
    expect(bodies).toEqual([
      credentials,
      { ...credentials, code: '000000' },
      { ...credentials, code: '123456' },
    ])
  })
  it('signs in by a passkey, with a new challenge after one was refused', async () => {
    const needed = (challenge: string): Response =>
      new Response(
        JSON.stringify({
          title: 'Unauthorized',
          code: 'SECOND_FACTOR_NEEDED',
          detail: 'A passkey.',
          status: 401,
          secondFactor: { kinds: ['PASSKEY'], passkeyOptions: { challenge } },
        }),
        { status: 401 },
      )
    const answers = [
      needed('first'),
      new Response('{}', { status: 401 }),
      needed('second'),
      new Response(JSON.stringify({ userName: 'engineer', role: 'ENGINEER', csrfToken: 't' })),
    ]
    const bodies: unknown[] = []
    vi.stubGlobal('fetch', (_: string, { body }: RequestInit) => {
      bodies.push(JSON.parse(body as string))
      return Promise.resolve(answers.shift())
    })
    vi.stubGlobal(
      'PublicKeyCredential',
      Object.assign(() => undefined, { parseRequestOptionsFromJSON: (each: unknown) => each }),
    )
    const get = ({ publicKey }: { publicKey: { challenge: string } }): Promise<unknown> =>
      Promise.resolve({ toJSON: () => ({ signed: publicKey.challenge }) })
    vi.stubGlobal('navigator', { ...navigator, credentials: { get } })
    render(SignIn, { subtitle: 'Test', expired: false })
    await fill()
    const button = await screen.findByRole('button', { name: 'Use a passkey' })
    expect(screen.getByRole('alert').textContent).toContain('recovery code')
    await userEvent.click(button)
    await vi.waitFor(() =>
      expect(screen.getByRole('alert').textContent).toContain('The passkey was not accepted'),
    )
    await userEvent.click(button)
    await vi.waitFor(() => expect(bodies).toHaveLength(4))
    const credentials = { userName: 'engineer', password: 'wrong' }
    expect(bodies).toEqual([
      credentials,
      { ...credentials, passkey: { signed: 'first' } },
      credentials,
      { ...credentials, passkey: { signed: 'second' } },
    ])
  })
  it('enters', async () => {
    vi.stubGlobal('fetch', () =>
      Promise.resolve(
        new Response(JSON.stringify({ userName: 'engineer', role: 'ENGINEER', csrfToken: 't' })),
      ),
    )
    render(SignIn, { subtitle: 'Test', expired: true })
    expect(screen.getByRole('status').textContent).toContain('session has ended')
    await fill()
    expect(session.who?.userName).toBe('engineer')
  })
  it('speaks German at once when asked to', async () => {
    render(SignIn, { subtitle: 'Test', expired: false })
    await userEvent.click(screen.getByLabelText('DE'))
    expect(screen.getByRole('button', { name: 'Anmelden' })).toBeTruthy()
    expect(language.code).toBe('de')
  })
})

describe('a value', () => {
  it('says in words what is wrong with it', () => {
    const { container } = render(Value, { value: 5, status: 0x408f0000, unit: 'KWT' })
    expect(container.textContent.replace(/\s+/g, ' ').trim()).toBe(
      '5 kW Source lost, last value kept',
    )
  })
  it('that is missing has no unit', () => {
    const { container } = render(Value, { value: null, status: 0, unit: 'KWT' })
    expect(container.textContent.trim()).toBe('no value')
  })
})
