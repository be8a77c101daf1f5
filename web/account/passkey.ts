import { words } from '@/language/words'
import { Problem } from '@/transport/problem'

/**
 * Passkeys of the browser (Web Authentication Level 3). The server sends options and takes
 * credentials as JSON; browsers before 2025 convert neither, so that both is done here for them.
 */

type Creation = PublicKeyCredentialCreationOptionsJSON
type Request = PublicKeyCredentialRequestOptionsJSON

/** True where the browser has passkeys: in a secure context. */
export function hasPasskeys(): boolean {
  return typeof globalThis.PublicKeyCredential === 'function' && 'credentials' in navigator
}

/** Makes a passkey; returns it as the server takes it. Throws {@link Problem}. */
export async function createPasskey(options: Creation): Promise<unknown> {
  return asked(() => navigator.credentials.create({ publicKey: creationOptions(options) }))
}

/** Signs a challenge by a passkey; returns the assertion as the server takes it. Throws {@link Problem}. */
export async function usePasskey(options: Request): Promise<unknown> {
  return asked(() => navigator.credentials.get({ publicKey: requestOptions(options) }))
}

async function asked(ask: () => Promise<Credential | null>): Promise<unknown> {
  if (!hasPasskeys()) throw broken('NO_PASSKEYS', words.account.noPasskeySupport)
  let credential: Credential | null
  try {
    credential = await ask()
  } catch (failure) {
    const name = failure instanceof DOMException ? failure.name : ''
    if (name === 'InvalidStateError') throw broken('PASSKEY_TWICE', words.account.passkeyTwice)
    if (name === 'SecurityError') throw broken('NO_PASSKEYS', words.account.noPasskeySupport)
    // Browsers do not say which of it: cancelled, timed out, or nothing that fits.
    throw broken('PASSKEY_CANCELLED', words.account.passkeyCancelled)
  }
  if (credential === null) throw broken('PASSKEY_CANCELLED', words.account.passkeyCancelled)
  return asJson(credential as PublicKeyCredential)
}

function broken(code: string, detail: string): Problem {
  return new Problem({ type: 'about:blank', title: code, status: 409, code, detail })
}

function creationOptions(options: Creation): PublicKeyCredentialCreationOptions {
  if (typeof PublicKeyCredential.parseCreationOptionsFromJSON === 'function')
    return PublicKeyCredential.parseCreationOptionsFromJSON(options)
  return {
    ...options,
    challenge: bytes(options.challenge),
    user: { ...options.user, id: bytes(options.user.id) },
    excludeCredentials: options.excludeCredentials?.map(descriptor) ?? [],
  } as PublicKeyCredentialCreationOptions
}

function requestOptions(options: Request): PublicKeyCredentialRequestOptions {
  if (typeof PublicKeyCredential.parseRequestOptionsFromJSON === 'function')
    return PublicKeyCredential.parseRequestOptionsFromJSON(options)
  return {
    ...options,
    challenge: bytes(options.challenge),
    allowCredentials: options.allowCredentials?.map(descriptor) ?? [],
  } as PublicKeyCredentialRequestOptions
}

function descriptor(one: PublicKeyCredentialDescriptorJSON): PublicKeyCredentialDescriptor {
  return { ...one, id: bytes(one.id) } as PublicKeyCredentialDescriptor
}

function asJson(credential: PublicKeyCredential): unknown {
  if (typeof credential.toJSON === 'function') return credential.toJSON()
  const { id, type, response } = credential
  const clientDataJSON = text(response.clientDataJSON)
  const answer =
    'attestationObject' in response
      ? attestation(response as AuthenticatorAttestationResponse)
      : assertion(response as AuthenticatorAssertionResponse)
  return {
    id,
    rawId: id,
    type,
    clientExtensionResults: {},
    response: { clientDataJSON, ...answer },
  }
}

function attestation(response: AuthenticatorAttestationResponse): Record<string, unknown> {
  return {
    attestationObject: text(response.attestationObject),
    transports: response.getTransports(),
  }
}

function assertion(response: AuthenticatorAssertionResponse): Record<string, unknown> {
  return {
    authenticatorData: text(response.authenticatorData),
    signature: text(response.signature),
    userHandle: response.userHandle === null ? null : text(response.userHandle),
  }
}

/** Reads base64url without padding. */
function bytes(encoded: string): Uint8Array<ArrayBuffer> {
  const base64 = encoded.replaceAll('-', '+').replaceAll('_', '/')
  return Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))
}

/** Writes base64url without padding. */
function text(buffer: ArrayBuffer): string {
  const letters = Array.from(new Uint8Array(buffer), (byte) => String.fromCharCode(byte)).join('')
  return btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')
}
