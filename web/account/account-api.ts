import type { components as Connector } from '@/api/connector.generated'
import type { components as Platform } from '@/api/platform.generated'
import { request } from '@/transport/http'

type Schema<Name extends keyof Connector['schemas'] & keyof Platform['schemas']> =
  Connector['schemas'][Name] | Platform['schemas'][Name]

type PersonSession = Connector['schemas']['PersonSession']
/** A session; the connector also lists those at its OPC UA server. */
export type SessionSummary = Platform['schemas']['SessionSummary'] &
  Partial<Pick<PersonSession, 'kind' | 'clientCertificate'>>
export type SecondFactorOffer = Schema<'SecondFactorOffer'>
export type PasskeySummary = Schema<'PasskeySummary'>
export type SecondFactorState = Schema<'SecondFactorState'>
type PasswordChange = Schema<'PasswordChange'>
type Removal = Schema<'SecondFactorRemoval'>

/** Sessions of the signed-in person, or of another one by name. */
const sessionsOf = (userName: string | undefined): string =>
  userName === undefined ? '/sessions' : `/users/${encodeURIComponent(userName)}/sessions`

/** One's own account, which both daemons have alike. Every call throws a Problem. */
export const account = {
  changePassword: (body: PasswordChange): Promise<undefined> =>
    request('PUT', '/session/password', { body }),
  sessions: async (userName?: string, signal?: AbortSignal): Promise<SessionSummary[]> => {
    const list = await request<{ items: SessionSummary[] }>(
      'GET',
      sessionsOf(userName),
      signal === undefined ? {} : { signal },
    )
    return list.items
  },
  endSession: (sessionId: string, userName?: string): Promise<undefined> =>
    request('DELETE', `${sessionsOf(userName)}/${sessionId}`),
  secondFactor: (signal: AbortSignal): Promise<SecondFactorState> =>
    request('GET', '/session/second-factor', { signal }),
  beginSecondFactor: (password: string): Promise<SecondFactorOffer> =>
    request('POST', '/session/second-factor', { body: { password } }),
  confirmSecondFactor: async (code: string): Promise<string[]> => {
    const codes = await request<Schema<'RecoveryCodes'>>('PUT', '/session/second-factor', {
      body: { code },
    })
    return codes.recoveryCodes
  },
  removeSecondFactor: (body: Removal): Promise<undefined> =>
    request('POST', '/session/second-factor/removal', { body }),
  passkeys: (signal: AbortSignal): Promise<Schema<'PasskeyList'>> =>
    request('GET', '/session/passkeys', { signal }),
  /** Options with which the browser makes a passkey. */
  beginPasskey: async (password: string): Promise<PublicKeyCredentialCreationOptionsJSON> => {
    const offer = await request<Schema<'PasskeyOffer'>>('POST', '/session/passkeys', {
      body: { password },
    })
    return offer.options as unknown as PublicKeyCredentialCreationOptionsJSON
  },
  /** Adds a passkey; returns recovery codes where it is the first second factor. */
  addPasskey: async (name: string, credential: unknown): Promise<string[]> => {
    const codes = await request<Schema<'RecoveryCodes'>>('PUT', '/session/passkeys', {
      body: { name, credential },
    })
    return codes.recoveryCodes
  },
  removePasskey: (passkeyId: string, password: string): Promise<undefined> =>
    request('POST', `/session/passkeys/${passkeyId}/removal`, { body: { password } }),
  resetSecondFactor: (userName: string): Promise<undefined> =>
    request('DELETE', `/users/${encodeURIComponent(userName)}/second-factor`),
}
