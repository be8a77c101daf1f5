/** The languages every text of both apps exists in. */
export type LanguageCode = 'en' | 'de'

export const LANGUAGES: readonly { code: LanguageCode; name: string }[] = [
  { code: 'en', name: 'English' },
  { code: 'de', name: 'Deutsch' },
]

const KEPT_AS = 'verbund.language'

class Language {
  code = $state<LanguageCode>(initial())

  choose(code: LanguageCode): void {
    this.code = code
    document.documentElement.lang = code
    localStorage.setItem(KEPT_AS, code)
  }
}

/** Chosen language: the stored one, else the first known one of the browser, else English. */
export const language = new Language()
document.documentElement.lang = language.code

/**
 * Catalogue of texts that follows the chosen language: reading `words.section.text` in a template
 * is reactive. Both languages have one type, so that a text missing in either is a compile error.
 */
export function catalogue<T extends object>(texts: Record<LanguageCode, T>): T {
  return new Proxy(texts.en, {
    get: (_, section) => texts[language.code][section as keyof T],
  })
}

function initial(): LanguageCode {
  const kept = localStorage.getItem(KEPT_AS)
  if (kept === 'en' || kept === 'de') return kept
  for (const wish of navigator.languages) {
    const code = wish.slice(0, 2).toLowerCase()
    if (code === 'en' || code === 'de') return code
  }
  return 'en'
}
