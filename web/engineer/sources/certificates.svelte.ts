import { toasts } from '@/design/toasts.svelte'
import { words } from '@/language/words'
import type { Resource } from '@/transport/resource.svelte'
import { connector } from '../api/client'
import type { PeerCertificate, ClientCertificateView, SourceStatus } from '../api/types'
import { texts } from '../language/texts'

/** Certificate of a server or a client as the list shows it. */
export interface ShownCertificate {
  /** SHA-1: its name in paths of the API. */
  thumbprint: string
  /** SHA-256, for people to compare. */
  fingerprint: string
  subject: string
  validFrom?: string | null | undefined
  validTo?: string | null | undefined
  keyBits?: number | null | undefined
  isTrusted: boolean
  /** True where it came in through its authority, and can be denied by itself. */
  isIssued?: boolean
  /** True where an engineer denied the trust. */
  isDenied?: boolean
  /** True where it is trusted, and no person is known who approved it. */
  isUnapproved?: boolean
  /** Last rejection of its owner, with the reason and the owner's application and address. */
  rejection?:
    | { at: string; reason: string; address: string | null; applicationName: string | null }
    | undefined
}

/** The certificates of servers, as the list shows them. */
export function ofServers(certificates: readonly PeerCertificate[]): ShownCertificate[] {
  return certificates.map(({ trust, ...others }) => ({ ...others, isTrusted: trust === 'trusted' }))
}

/** The certificates of clients, as the list shows them. */
export function ofClients(certificates: readonly ClientCertificateView[]): ShownCertificate[] {
  return certificates.map(
    ({
      thumbprint,
      fingerprint,
      subject,
      notBefore,
      notAfter,
      state,
      approvedBy,
      rejectedAt,
      rejectionReason,
      rejectedAddress,
      rejectedApplicationName,
    }) => ({
      thumbprint,
      fingerprint,
      subject,
      validFrom: notBefore,
      validTo: notAfter,
      isTrusted: state === 'TRUSTED',
      isIssued: state === 'ISSUED',
      isDenied: state === 'DENIED',
      isUnapproved: state === 'TRUSTED' && approvedBy == null,
      rejection:
        rejectedAt == null
          ? undefined
          : {
              at: rejectedAt,
              reason: rejectionReason ?? '',
              address: rejectedAddress ?? null,
              applicationName: rejectedApplicationName ?? null,
            },
    }),
  )
}

const DAY_MS = 86_400_000
/** Period before its end in which a certificate should be renewed, in ms. */
export const SOON_DAYS = 30

/** Validity at a time, and the remaining time, where the certificate has dates. */
export function validity(
  { validFrom, validTo }: Pick<ShownCertificate, 'validFrom' | 'validTo'>,
  now: number,
  soonDays = SOON_DAYS,
): 'early' | 'valid' | 'soon' | 'over' {
  if (validTo != null && Date.parse(validTo) < now) return 'over'
  if (validFrom != null && Date.parse(validFrom) > now) return 'early'
  return validTo != null && Date.parse(validTo) < now + soonDays * DAY_MS ? 'soon' : 'valid'
}

/** The certificate that a source waits for: its problem names the fingerprint. */
export function awaited(
  source: Pick<SourceStatus, 'problem'>,
  certificates: readonly ShownCertificate[],
): ShownCertificate | undefined {
  if (source.problem?.kind !== 'serverCertificateUntrusted') return undefined
  const said = source.problem.message.toLowerCase()
  return certificates.find((certificate) => said.includes(certificate.fingerprint.toLowerCase()))
}

/** A fingerprint as it is compared by eye: in groups of four. */
export function grouped(fingerprint: string): string {
  return (
    fingerprint
      .toUpperCase()
      .match(/.{1,4}/g)
      ?.join(' ') ?? fingerprint
  )
}

/** Trusts a certificate or no longer, and offers the way back where it leads to what was before. */
export async function setTrust(
  change: (isTrusted: boolean) => Promise<unknown>,
  isTrusted: boolean,
  list: Pick<Resource<ShownCertificate[]>, 'refresh'>,
  mayUndo = true,
): Promise<void> {
  try {
    await change(isTrusted)
    const undo = { label: words.action.undo, run: () => void setTrust(change, !isTrusted, list) }
    const text = isTrusted ? texts.certificates.trusted : texts.certificates.rejected
    toasts.show('good', text, mayUndo ? undo : undefined)
  } catch (failure) {
    toasts.problem(failure)
  }
  void list.refresh()
}

/** The same for a server's certificate. */
export function trustServer(
  certificate: ShownCertificate,
  isTrusted: boolean,
  list: Pick<Resource<ShownCertificate[]>, 'refresh'>,
): Promise<void> {
  return setTrust(
    (wanted) =>
      connector.put('/source-certificates/{thumbprint}', {
        path: { thumbprint: certificate.thumbprint },
        body: { isTrusted: wanted },
      }),
    isTrusted,
    list,
  )
}
