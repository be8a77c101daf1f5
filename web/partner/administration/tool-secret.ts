import type { ToolCredential } from '../api/types'
import { texts } from '../language/texts'

/** All that a program needs to sign in at the broker and to ask there. */
export function toolSecret(
  toolId: string,
  { brokerUrl, userName, password, rootCertificatePem }: ToolCredential,
): { label: string; text: string }[] {
  const { broker, user, asks, receives, root } = texts.administration.tools
  return [
    { label: broker, text: brokerUrl },
    { label: user, text: userName },
    { label: texts.administration.tools.password, text: password },
    { label: asks, text: `tool.${toolId}.requests` },
    { label: receives, text: `tool.${toolId}.reports` },
    ...(rootCertificatePem ? [{ label: root, text: rootCertificatePem }] : []),
  ]
}
