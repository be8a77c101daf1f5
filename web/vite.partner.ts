import { defineConfig } from 'vite'
import { app } from './vite.base.ts'

export default defineConfig(app('partner', process.env['PLATFORM_URL'] ?? 'http://127.0.0.1:8080'))
