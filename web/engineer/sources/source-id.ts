/**
 * Suggests a source's id from its address: `opc.tcp://press-1.hall2:4840/x` gives `press-1-4840`.
 */
export function suggestedId(endpointUrl: string, taken: readonly string[]): string {
  const match = /^opc\.tcp:\/\/(\[[^\]]+\]|[^:/]+)(?::(\d+))?/.exec(endpointUrl.trim())
  if (match === null) return ''
  const host = match[1] ?? ''
  const isAddress = /^[\d.]+$/.test(host) || host.startsWith('[')
  const name = isAddress ? host : (host.split('.')[0] ?? host)
  const port = match[2] === undefined || match[2] === '4840' ? '' : `-${match[2]}`
  const base = `${name
    .replace(/[^A-Za-z0-9_-]+/g, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, 50)}${port}`
  let id = base
  for (let number = 2; id !== '' && taken.includes(id); number += 1) id = `${base}-${number}`
  return id
}
