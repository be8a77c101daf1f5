// Stores the operator's page on the device, so that a tablet that restarts during an outage opens
// it. Nothing of the API is stored here: entries and operations are in the page's own database.

const CACHE = 'verbund-page'
const PAGE = '/'
/** Files of builds that went by are given up beyond this number, the oldest first. */
const FILES_MAX = 120

addEventListener('install', (event) => {
  event.waitUntil(
    caches
      .open(CACHE)
      .then((cache) => cache.add(PAGE))
      .then(() => skipWaiting()),
  )
})

addEventListener('activate', (event) => {
  event.waitUntil(clients.claim())
})

addEventListener('message', (event) => {
  const files = Array.isArray(event.data?.files)
    ? event.data.files.filter((file) => isFile(new URL(file, location.origin)))
    : []
  event.waitUntil(keep(files))
})

addEventListener('fetch', (event) => {
  const { request } = event
  const url = new URL(request.url)
  if (request.method !== 'GET' || url.origin !== location.origin) return
  if (request.mode === 'navigate') event.respondWith(page(request))
  else if (isFile(url)) event.respondWith(file(request))
})

/** Files are named by their content, so a stored file is always valid. */
function isFile(url) {
  return url.origin === location.origin && url.pathname.startsWith('/assets/')
}

async function file(request) {
  const known = await caches.match(request)
  if (known !== undefined) return known
  const answer = await fetch(request)
  if (answer.ok) await keepOne(request, answer.clone())
  return answer
}

/** The newest page while the connector answers, the last one known otherwise. */
async function page(request) {
  try {
    const answer = await fetch(request)
    if (answer.ok && new URL(request.url).pathname === PAGE) await keepOne(PAGE, answer.clone())
    return answer
  } catch (failure) {
    const known = await caches.match(PAGE)
    if (known !== undefined) return known
    throw failure
  }
}

async function keep(files) {
  const cache = await caches.open(CACHE)
  for (const name of files) if ((await cache.match(name)) === undefined) await cache.add(name)
}

async function keepOne(request, answer) {
  const cache = await caches.open(CACHE)
  await cache.put(request, answer)
  const known = (await cache.keys()).filter((each) => isFile(new URL(each.url)))
  for (const old of known.slice(0, Math.max(0, known.length - FILES_MAX))) await cache.delete(old)
}
