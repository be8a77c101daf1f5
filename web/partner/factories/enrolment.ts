/** Hosts that lead a machine to itself. */
const OWN_MACHINE = /^(localhost|127(\.\d+){3}|0\.0\.0\.0|\[::1?\])$/

/** Parts of an enrolment token: `<platform's address, base64url>.<pin of its certificate>.<secret>`. */
export interface TokenParts {
  /** Address of the platform that the token carries. */
  address: string | undefined
  /** Whether the token names the platform's certificate. */
  hasPin: boolean
}

export function partsOf(token: string): TokenParts {
  const parts = token.split('.')
  return {
    address: parts.length > 1 ? decoded(parts[0] ?? '') : undefined,
    hasPin: parts.length === 3,
  }
}

/** True where the address of a token leads other machines nowhere, and that of this page does. */
export function isLocalOnly({ address }: TokenParts, origin: string): boolean {
  return (
    address !== undefined && isOwnMachine(address) && !isOwnMachine(origin) && URL.canParse(origin)
  )
}

/**
 * The line with which a connector spends the token. The token is read from standard input or from a
 * file, since every user of a machine sees the arguments of programs. It carries the platform's
 * address, which is given where it would be of no use.
 */
export function enrolmentCommand(token: string, origin: string, file?: string): string {
  const parts = partsOf(token)
  const isNeeded = parts.address === undefined || isLocalOnly(parts, origin)
  return [
    'factory-connector enrol',
    ...(file === undefined ? [] : [`--token-file ${file}`]),
    ...(isNeeded ? [`--platform ${origin}`] : []),
  ].join(' ')
}

function isOwnMachine(address: string): boolean {
  return URL.canParse(address) && OWN_MACHINE.test(new URL(address).hostname)
}

function decoded(part: string): string | undefined {
  try {
    const text = atob(part.replaceAll('-', '+').replaceAll('_', '/'))
    return text === '' ? undefined : text
  } catch {
    return undefined
  }
}
