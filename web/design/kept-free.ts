/**
 * Keeps messages above a bar that sticks to the lower edge of the window: they never cover its buttons. An
 * attachment.
 */
export function keptFree(bar: HTMLElement): () => void {
  const root = document.documentElement.style
  const observer = new ResizeObserver(() => {
    root.setProperty('--kept-free', `${bar.offsetHeight}px`)
  })
  observer.observe(bar)
  return () => {
    observer.disconnect()
    root.removeProperty('--kept-free')
  }
}
