import { fileURLToPath } from 'node:url'
import { svelte } from '@sveltejs/vite-plugin-svelte'
import { svelteTesting } from '@testing-library/svelte/vite'
import { defineConfig } from 'vitest/config'

const here = fileURLToPath(new URL('.', import.meta.url)).replace(/\/$/, '')

export default defineConfig({
  plugins: [svelte(), svelteTesting()],
  resolve: { alias: { '@': here } },
  test: {
    environment: 'jsdom',
    include: ['**/*.test.ts'],
    exclude: ['node_modules/**', 'dist/**'],
    // All files of a worker share one browser environment: creating one for each took two thirds of
    // the time.
    isolate: false,
    pool: 'threads',
    setupFiles: ['./vitest.setup.ts'],
    testTimeout: 20_000,
  },
})
