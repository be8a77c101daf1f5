import js from '@eslint/js'
import svelte from 'eslint-plugin-svelte'
import globals from 'globals'
import ts from 'typescript-eslint'
import svelteConfig from './svelte.config.js'

/**
 * No file of a folder imports these.
 * @param {string} folder
 * @param {string[]} forbidden
 * @returns {import('typescript-eslint').ConfigWithExtends}
 */
function walls(folder, forbidden) {
  const patterns = [
    { group: forbidden, message: 'Another part of the pages: see ARCHITECTURE.md.' },
  ]
  return { files: [`${folder}/**`], rules: { 'no-restricted-imports': ['error', { patterns }] } }
}

export default ts.config(
  { ignores: ['dist/', 'node_modules/', '**/*.generated.ts'] },
  js.configs.recommended,
  ...ts.configs.strict,
  ...ts.configs.stylistic,
  ...svelte.configs.recommended,
  {
    languageOptions: { globals: { ...globals.browser, ...globals.node } },
    rules: {
      'no-console': 'error',
      'max-lines': ['error', 400],
      '@typescript-eslint/consistent-type-definitions': ['error', 'interface'],
      'no-undef': 'off',
      '@typescript-eslint/no-unused-vars': [
        'error',
        { varsIgnorePattern: '^_', argsIgnorePattern: '^_' },
      ],
      '@typescript-eslint/restrict-template-expressions': 'off',
      // Components pass `children` as an explicit snippet wherever they pass other snippets.
      'svelte/no-useless-children-snippet': 'off',
    },
  },
  // The two applications stand beside each other; what both use knows neither.
  walls('engineer', ['@/partner/*']),
  walls('partner', ['@/engineer/*']),
  ...['account', 'api', 'design', 'format', 'navigation', 'network', 'shell', 'transport'].map(
    (folder) => walls(folder, ['@/engineer/*', '@/partner/*']),
  ),
  {
    files: ['**/*.svelte', '**/*.svelte.ts'],
    languageOptions: {
      parserOptions: { parser: ts.parser, svelteConfig, extraFileExtensions: ['.svelte'] },
    },
    rules: { 'max-lines': ['error', 200] },
  },
)
