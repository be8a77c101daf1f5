const WORKER = '/worker.js'

/**
 * Installs a service worker that stores the page, so that it opens without the connector. Without
 * service workers, as at an address without TLS, an open page works through an outage and only a
 * reload has to wait.
 */
export async function storePage(): Promise<void> {
  if (!('serviceWorker' in navigator)) return
  const registration = await navigator.serviceWorker.register(WORKER)
  const { active } = await navigator.serviceWorker.ready
  const files = performance.getEntriesByType('resource').map((entry) => entry.name)
  ;(active ?? registration.active)?.postMessage({ files })
}
