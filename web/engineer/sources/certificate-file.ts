/** No certificate with its chain is larger. */
export const FILE_BYTES_MAX = 256 * 1024

/**
 * Reads a chosen file for the API: PEM as text, anything else as base64 of DER. Returns `undefined`
 * if it is too large.
 */
export async function fileContent(file: File): Promise<string | undefined> {
  if (file.size > FILE_BYTES_MAX) return undefined
  const bytes = new Uint8Array(await file.arrayBuffer())
  const text = new TextDecoder().decode(bytes)
  return text.includes('-----BEGIN')
    ? text
    : btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''))
}
