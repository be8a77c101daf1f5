const WORKER = '/worker.js'

/**
 * Has the browser keep the page itself, so that it opens without the connector. Where that cannot be - no service
 * workers, or an address without TLS - an open page works on through an outage, and only a reload has to wait.
 */
export async function keepPage(): Promise<void> {
  if (!('serviceWorker' in navigator)) return
  const registration = await navigator.serviceWorker.register(WORKER)
  const { active } = await navigator.serviceWorker.ready
  const files = performance.getEntriesByType('resource').map((entry) => entry.name)
  ;(active ?? registration.active)?.postMessage({ files })
}
