import { fileURLToPath } from 'node:url'
import { svelte } from '@sveltejs/vite-plugin-svelte'
import type { UserConfig } from 'vite'
import { bundledPackages } from './bundled-packages.ts'

const here = fileURLToPath(new URL('.', import.meta.url))

/**
 * Build configuration of one single-page app. The daemons' content security policy allows scripts,
 * styles and fonts only from themselves, so nothing may be inlined: neither the module-preload
 * helper nor small assets.
 */
export function app(name: 'engineer' | 'partner', backend: string): UserConfig {
  return {
    root: `${here}${name}`,
    base: '/',
    plugins: [
      svelte({ configFile: `${here}svelte.config.js` }),
      bundledPackages(`${here}dist/${name}.packages.json`),
    ],
    resolve: { alias: { '@': here.replace(/\/$/, '') } },
    build: {
      outDir: `${here}dist/${name}`,
      emptyOutDir: true,
      target: 'es2023',
      assetsInlineLimit: 0,
      modulePreload: { polyfill: false },
      chunkSizeWarningLimit: 700,
    },
    server: { proxy: { '/api/v1': { target: backend, changeOrigin: false } } },
  }
}
