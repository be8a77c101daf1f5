import type { components as Connector } from '@/api/connector.generated'
import type { components as Platform } from '@/api/platform.generated'
import { credentials, request } from './http'
import { Problem } from './problem'

type Session = (Connector | Platform)['schemas']['Session']

/** Person who is signed in on either daemon, with the token for changes. */
export type SignedIn = Pick<Session, 'userName' | 'role' | 'csrfToken'> & {
  /** Organisation for which the person acts; the platform's sessions only. */
  organisationId?: Platform['schemas']['Session']['organisationId']
}

type State =
  | { is: 'asking' }
  | { is: 'signedOut'; expired: boolean }
  | { is: 'signedIn'; who: SignedIn }
  | { is: 'unreachable'; problem: Problem }

/**
 * Person who was signed in last in this browser. That person's page may open while the server is
 * out of reach.
 */
export type Known = Pick<Session, 'userName' | 'role'>

const KEPT_AS = 'verbund.known'

class CurrentSession {
  state = $state.raw<State>({ is: 'asking' })

  constructor() {
    credentials.onExpired = () => {
      this.#leave(this.state.is === 'signedIn')
    }
  }

  get who(): SignedIn | undefined {
    return this.state.is === 'signedIn' ? this.state.who : undefined
  }

  /** Person who is signed in or, while the server is out of reach, who was last. */
  get known(): Known | undefined {
    return this.who ?? (this.state.is === 'unreachable' ? remembered() : undefined)
  }

  /** Asks the server whether the session cookie is still valid. */
  async resume(): Promise<void> {
    try {
      this.#enter(await request<SignedIn>('GET', '/session', { signingIn: true }))
    } catch (failure) {
      const problem = Problem.from(failure)
      if (problem.status === 401 || problem.status === 403 || problem.status === 404)
        this.#leave(false)
      else this.state = { is: 'unreachable', problem }
    }
  }

  /** Signs in; people with a second factor need a code or the assertion of a passkey, too. */
  async signIn(
    userName: string,
    password: string,
    factor: { code?: string; passkey?: unknown } = {},
  ): Promise<void> {
    this.#enter(
      await request<SignedIn>('POST', '/session', {
        body: { userName, password, ...factor },
        signingIn: true,
      }),
    )
  }

  async signOut(): Promise<void> {
    await request('DELETE', '/session').catch(() => undefined)
    this.#leave(false)
  }

  #enter(who: SignedIn): void {
    credentials.csrfToken = who.csrfToken
    localStorage.setItem(KEPT_AS, JSON.stringify({ userName: who.userName, role: who.role }))
    this.state = { is: 'signedIn', who }
  }

  #leave(expired: boolean): void {
    credentials.csrfToken = undefined
    localStorage.removeItem(KEPT_AS)
    this.state = { is: 'signedOut', expired }
  }
}

function remembered(): Known | undefined {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(KEPT_AS) ?? 'null')
    return kept !== null && typeof kept === 'object' && 'userName' in kept && 'role' in kept
      ? (kept as Known)
      : undefined
  } catch {
    return undefined
  }
}

/** The session of this page. */
export const session = new CurrentSession()
