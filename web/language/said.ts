import type { Problem } from '@/transport/problem'
import { words } from './words'

/** Parameters of a text: `{name}` in it stands for the one of this name. */
export type TextParameters = Readonly<Record<string, string | number | null | undefined>>

/**
 * Text of a server's code in the language of the page. The server's own sentence stands in for a
 * code that has no text here, and for a text of which a parameter is missing.
 */
export function said(code: string, original: string, parameters: TextParameters = {}): string {
  const text = Object.hasOwn(words.code, code) ? words.code[code] : undefined
  if (text === undefined) return original
  let isWhole = true
  const filled = text.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = Object.hasOwn(parameters, name) ? parameters[name] : undefined
    if (value === undefined || value === null) isWhole = false
    return String(value)
  })
  return isWhole ? filled : original
}

/** What the server refused, in the language of the page. */
export function problemText({ document, message, unreachable }: Problem): string {
  if (unreachable) return words.resource.offlineTitle
  return said(document.code, message, {
    ...document.parameters,
    seconds: document.retryAfterSeconds,
  })
}

/** The first fault of a problem, which says more than the problem where there is one. */
export function firstFaultText(problem: Problem): string {
  const [fault] = problem.faults
  return fault === undefined ? problemText(problem) : said(fault.code, fault.message)
}
