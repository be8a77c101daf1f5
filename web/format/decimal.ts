import { language } from '@/language/language.svelte'

/**
 * Number that a person wrote, with a decimal point or comma; `undefined` if it is none. A separator
 * of thousands in the language of the page is none either: nobody's "1.000" becomes 1.
 */
export function decimalOf(written: string): number | undefined {
  const text = written.trim()
  const isGrouped = language.code === 'de' ? /^-?\d{1,3}\.\d{3}$/ : /^-?\d{1,3},\d{3}$/
  if (!/^[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?$/.test(text) || isGrouped.test(text))
    return undefined
  const number = Number(text.replace(',', '.'))
  return Number.isFinite(number) ? number : undefined
}

/** Text of a number in an input, with the decimal sign of the language and without groups. */
export function decimalText(value: number): string {
  return language.code === 'de' ? String(value).replace('.', ',') : String(value)
}
