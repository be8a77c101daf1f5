import { beforeEach } from 'vitest'

// Tests of the build's own tools run without a browser.
if (typeof window !== 'undefined') {
  // A second is short where pages are tested beside a build of everything else.
  const { configure } = await import('@testing-library/svelte')
  configure({ asyncUtilTimeout: 10_000 })
  // jsdom has no media queries.
  window.matchMedia = (media) => ({
    matches: false,
    media,
    onchange: null,
    addEventListener: () => undefined,
    removeEventListener: () => undefined,
    addListener: () => undefined,
    removeListener: () => undefined,
    dispatchEvent: () => false,
  })
  // Nor does it compute layout.
  window.ResizeObserver = class {
    observe = (): void => undefined
    unobserve = (): void => undefined
    disconnect = (): void => undefined
  }
  Element.prototype.scrollIntoView = () => undefined
  // Nor does it put a dialog above everything else.
  HTMLDialogElement.prototype.showModal = function () {
    this.open = true
  }
  HTMLDialogElement.prototype.close = function () {
    this.open = false
  }
  const { language } = await import('@/language/language.svelte')
  beforeEach(() => {
    language.choose('en')
  })
}
