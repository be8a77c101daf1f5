export type Appearance = 'system' | 'light' | 'dark'

const KEPT_AS = 'verbund.appearance'
const prefersDark = matchMedia('(prefers-color-scheme: dark)')

class Theme {
  appearance = $state<Appearance>(kept())

  constructor() {
    this.#apply()
    prefersDark.addEventListener('change', () => {
      this.#apply()
    })
  }

  choose(appearance: Appearance): void {
    this.appearance = appearance
    localStorage.setItem(KEPT_AS, appearance)
    this.#apply()
  }

  #apply(): void {
    const dark = this.appearance === 'dark' || (this.appearance === 'system' && prefersDark.matches)
    document.documentElement.dataset['theme'] = dark ? 'dark' : 'light'
  }
}

/** Light or dark: the reader's choice, else the system's. */
export const theme = new Theme()

function kept(): Appearance {
  const value = localStorage.getItem(KEPT_AS)
  return value === 'light' || value === 'dark' ? value : 'system'
}
