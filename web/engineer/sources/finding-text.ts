import { day, span } from '@/format/time'
import { numberText } from '@/format/value'
import type { ServerFinding } from '../api/types'
import { texts } from '../language/texts'

/** What was found about a server, and what to do, in the words of an engineer. */
export function findingText(finding: ServerFinding): string {
  const said = texts.servers.findings
  switch (finding.code) {
    case 'hostNameUnknown':
      return said.hostNameUnknown(finding.host, finding.usedUrl)
    case 'hostNameDiffers':
      return said.hostNameDiffers(finding.host, finding.usedUrl)
    case 'nothingEncrypted':
      return said.nothingEncrypted(finding.offered.join('; '))
    case 'certificateExpired':
      return said.certificateExpired(day(finding.validTo))
    case 'certificateNotYetValid':
      return said.certificateNotYetValid(day(finding.validFrom))
    case 'certificateOfOtherHost':
      return finding.hostNames.length === 0
        ? said.certificateOfOtherHostNone(finding.host)
        : said.certificateOfOtherHost(finding.host, finding.hostNames.join(', '))
    case 'certificateOfOtherApplication':
      return said.certificateOfOtherApplication(finding.applicationUri)
    case 'keyTooShort':
      return said.keyTooShort(numberText(finding.keyBits))
    case 'signedWithSha1':
      return said.signedWithSha1
    case 'clockDiffers':
      return finding.aheadMs < 0
        ? said.clockBehind(span(-finding.aheadMs))
        : said.clockAhead(span(finding.aheadMs))
  }
}
