import { toasts } from '@/design/toasts.svelte'
import { words } from '@/language/words'
import type { Resource } from '@/transport/resource.svelte'
import { connector } from '../api/client'
import type { Certificate, SourceStatus } from '../api/types'
import { texts } from '../language/texts'

/** The certificate that a source waits for: its problem names the thumbprint. */
export function awaited(source: Pick<SourceStatus, 'problem'>, certificates: readonly Certificate[]): Certificate | undefined {
  if (source.problem?.kind !== 'serverCertificateUntrusted') return undefined
  const said = source.problem.message.toLowerCase()
  return certificates.find((certificate) => said.includes(certificate.thumbprint.toLowerCase()))
}

/** A thumbprint as it is compared by eye: in groups of four. */
export function grouped(thumbprint: string): string {
  return thumbprint.toUpperCase().match(/.{1,4}/g)?.join(' ') ?? thumbprint
}

/** Trusts a certificate or no longer, and offers the way back. */
export async function setTrust(certificate: Certificate, isTrusted: boolean, list: Pick<Resource<Certificate[]>, 'refresh'>): Promise<void> {
  try {
    await connector.trust(certificate.thumbprint, isTrusted)
    toasts.show('good', isTrusted ? texts.certificates.trusted : texts.certificates.rejected, {
      label: words.action.undo,
      run: () => void setTrust(certificate, !isTrusted, list),
    })
  } catch (failure) {
    toasts.problem(failure)
  }
  void list.refresh()
}
