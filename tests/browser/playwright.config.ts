import { defineConfig, devices } from '@playwright/test'

/**
 * Runs both pages in Debian's Chromium against running daemons; `world.ts` reads their addresses
 * from the environment. One worker, as the tests share and change one world.
 */
export default defineConfig({
  outputDir: '../../target/browser',
  workers: 1,
  fullyParallel: false,
  retries: 0,
  timeout: 60_000,
  expect: { timeout: 10_000 },
  reporter: [['list']],
  use: {
    ...devices['Desktop Chrome'],
    launchOptions: {
      executablePath: process.env['CHROMIUM'] ?? '/usr/bin/chromium',
      args: ['--no-sandbox'],
    },
    trace: 'retain-on-failure',
  },
  projects: [
    { name: 'story', testMatch: /story\.spec\.ts/ },
    { name: 'order', testMatch: /order\.spec\.ts/ },
    { name: 'findings', testMatch: /findings\.spec\.ts/, timeout: 120_000 },
    { name: 'passkey', testMatch: /passkey\.spec\.ts/ },
    { name: 'operator', testMatch: /operator\.spec\.ts/ },
    { name: 'newcomer', testMatch: /newcomer\.spec\.ts/ },
    { name: 'readme', testMatch: /readme\.spec\.ts/, expect: { timeout: 30_000 } },
    // The recorder would be measured, too.
    { name: 'scale', testMatch: /scale\.spec\.ts/, use: { trace: 'off' } },
    { name: 'accessibility', testMatch: /accessibility\.spec\.ts/, timeout: 300_000 },
    { name: 'screenshots', testMatch: /screenshots\.spec\.ts/, timeout: 240_000 },
  ],
})
