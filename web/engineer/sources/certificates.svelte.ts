import { toasts } from '@/design/toasts.svelte'
import { words } from '@/language/words'
import type { Resource } from '@/transport/resource.svelte'
import { connector } from '../api/client'
import type { Certificate, SourceStatus } from '../api/types'
import { texts } from '../language/texts'

/** A certificate as the list shows it, whoever showed it. */
export interface ShownCertificate {
  thumbprint: string
  subject: string
  validFrom?: string | null | undefined
  validTo?: string | null | undefined
  keyBits?: number | null | undefined
  isTrusted: boolean
}

/** The certificates of servers, as the list shows them. */
export function ofServers(certificates: readonly Certificate[]): ShownCertificate[] {
  return certificates.map(({ trust, ...others }) => ({ ...others, isTrusted: trust === 'trusted' }))
}

/** Whether a certificate is valid at a time, where it says when it is. */
export function validity({ validFrom, validTo }: Pick<ShownCertificate, 'validFrom' | 'validTo'>, now: number): 'early' | 'valid' | 'over' {
  if (validTo != null && Date.parse(validTo) < now) return 'over'
  return validFrom != null && Date.parse(validFrom) > now ? 'early' : 'valid'
}

/** The certificate that a source waits for: its problem names the thumbprint. */
export function awaited(source: Pick<SourceStatus, 'problem'>, certificates: readonly ShownCertificate[]): ShownCertificate | undefined {
  if (source.problem?.kind !== 'serverCertificateUntrusted') return undefined
  const said = source.problem.message.toLowerCase()
  return certificates.find((certificate) => said.includes(certificate.thumbprint.toLowerCase()))
}

/** A thumbprint as it is compared by eye: in groups of four. */
export function grouped(thumbprint: string): string {
  return thumbprint.toUpperCase().match(/.{1,4}/g)?.join(' ') ?? thumbprint
}

/** Trusts a certificate or no longer, and offers the way back. */
export async function setTrust(change: (isTrusted: boolean) => Promise<unknown>, isTrusted: boolean, list: Pick<Resource<ShownCertificate[]>, 'refresh'>): Promise<void> {
  try {
    await change(isTrusted)
    toasts.show('good', isTrusted ? texts.certificates.trusted : texts.certificates.rejected, {
      label: words.action.undo,
      run: () => void setTrust(change, !isTrusted, list),
    })
  } catch (failure) {
    toasts.problem(failure)
  }
  void list.refresh()
}

/** The same for a server's certificate. */
export function trustServer(certificate: ShownCertificate, isTrusted: boolean, list: Pick<Resource<ShownCertificate[]>, 'refresh'>): Promise<void> {
  return setTrust((wanted) => connector.trust(certificate.thumbprint, wanted), isTrusted, list)
}
