import { defineConfig } from 'vite'
import { app } from './vite.base.ts'

export default defineConfig(
  app('engineer', process.env['CONNECTOR_URL'] ?? 'http://127.0.0.1:8081'),
)
