import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { createPasskey, hasPasskeys, usePasskey } from './passkey'

const buffer = (...bytes: number[]): ArrayBuffer => new Uint8Array(bytes).buffer
const creation = {
  rp: { name: 'Verbund', id: 'localhost' },
  user: { id: 'AQI', name: 'eva', displayName: 'eva' },
  challenge: '-_8',
  pubKeyCredParams: [],
  excludeCredentials: [{ type: 'public-key', id: 'Aw' }],
}
const assertion = {
  id: 'Aw',
  type: 'public-key',
  response: {
    clientDataJSON: buffer(123, 125),
    authenticatorData: buffer(1),
    signature: buffer(251, 255),
    userHandle: null,
  },
}
let asked: unknown
let answer: () => Promise<unknown>

/** Browser with passkeys; `helpers` are its conversions of JSON. */
function browser(helpers: Record<string, unknown> = {}): void {
  vi.stubGlobal(
    'PublicKeyCredential',
    Object.assign(() => undefined, helpers),
  )
  const credentials = {
    create: (options: unknown) => ((asked = options), answer()),
    get: (options: unknown) => ((asked = options), answer()),
  }
  vi.stubGlobal('navigator', { ...navigator, credentials })
}

beforeEach(() => {
  asked = undefined
  answer = () => Promise.resolve(assertion)
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('passkeys of a browser', () => {
  it('are left to the browser where it converts JSON', async () => {
    browser({ parseRequestOptionsFromJSON: (options: unknown) => ({ parsed: options }) })
    answer = () => Promise.resolve({ toJSON: () => 'as JSON' })
    expect(await usePasskey({ challenge: 'AA' })).toBe('as JSON')
    expect(asked).toEqual({ publicKey: { parsed: { challenge: 'AA' } } })
  })

  it('are converted for a browser that does not', async () => {
    browser()
    expect(await usePasskey({ challenge: '-_8', allowCredentials: [] })).toEqual({
      id: 'Aw',
      rawId: 'Aw',
      type: 'public-key',
      clientExtensionResults: {},
      response: {
        clientDataJSON: 'e30',
        authenticatorData: 'AQ',
        signature: '-_8',
        userHandle: null,
      },
    })
    expect(asked).toEqual({
      publicKey: { challenge: new Uint8Array([251, 255]), allowCredentials: [] },
    })
    answer = () =>
      Promise.resolve({
        ...assertion,
        response: {
          clientDataJSON: buffer(123, 125),
          attestationObject: buffer(2),
          getTransports: () => ['usb'],
        },
      })
    const made = (await createPasskey(creation)) as { response: unknown }
    expect(made.response).toEqual({
      clientDataJSON: 'e30',
      attestationObject: 'Ag',
      transports: ['usb'],
    })
    expect(asked).toMatchObject({
      publicKey: {
        challenge: new Uint8Array([251, 255]),
        user: { id: new Uint8Array([1, 2]) },
        excludeCredentials: [{ id: new Uint8Array([3]) }],
      },
    })
  })

  it.each([
    ['InvalidStateError', 'has a passkey for this account already'],
    ['NotAllowedError', 'The browser broke off'],
    ['SecurityError', 'not at this address'],
  ])('say why there is none (%s)', async (name, sentence) => {
    browser()
    answer = () => Promise.reject(new DOMException('no', name))
    await expect(createPasskey(creation)).rejects.toThrow(sentence)
  })

  it('are missing in an insecure context', async () => {
    expect(hasPasskeys()).toBe(false)
    await expect(usePasskey({ challenge: 'AA' })).rejects.toThrow('has no passkeys')
  })
})
