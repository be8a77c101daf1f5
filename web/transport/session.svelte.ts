import { credentials, request } from './http'
import { Problem } from './problem'

/** Who is signed in. */
export interface SignedIn {
  userName: string
  role: string
  csrfToken: string
}

type State = { is: 'asking' } | { is: 'signedOut'; expired: boolean } | { is: 'signedIn'; who: SignedIn } | { is: 'unreachable'; problem: Problem }

class Session {
  state = $state.raw<State>({ is: 'asking' })

  constructor() {
    credentials.onExpired = () => {
      this.#leave(this.state.is === 'signedIn')
    }
  }

  get who(): SignedIn | undefined {
    return this.state.is === 'signedIn' ? this.state.who : undefined
  }

  /** Asks the server whether the cookie that this browser holds is still good. */
  async resume(): Promise<void> {
    try {
      this.#enter(await request<SignedIn>('GET', '/session', { signingIn: true }))
    } catch (failure) {
      const problem = Problem.from(failure)
      if (problem.status === 401 || problem.status === 403 || problem.status === 404) this.#leave(false)
      else this.state = { is: 'unreachable', problem }
    }
  }

  async signIn(userName: string, password: string): Promise<void> {
    this.#enter(await request<SignedIn>('POST', '/session', { body: { userName, password }, signingIn: true }))
  }

  async signOut(): Promise<void> {
    await request('DELETE', '/session').catch(() => undefined)
    this.#leave(false)
  }

  #enter(who: SignedIn): void {
    credentials.csrfToken = who.csrfToken
    this.state = { is: 'signedIn', who }
  }

  #leave(expired: boolean): void {
    credentials.csrfToken = undefined
    this.state = { is: 'signedOut', expired }
  }
}

/** The session of this page. */
export const session = new Session()
