import { readdirSync, readFileSync } from 'node:fs'
import path from 'node:path'
import { parse } from 'svelte/compiler'
import { describe, expect, it } from 'vitest'
import { de as engineerDe } from '@/engineer/language/de'
import { en as engineerEn } from '@/engineer/language/en'
import { de as partnerDe } from '@/partner/language/de'
import { en as partnerEn } from '@/partner/language/en'
import { de } from './de'
import { en } from './en'
import { SAME_IN_BOTH } from './same-in-both'

const WEB = path.resolve(import.meta.dirname, '..')
/** Names that are the same in all languages. */
const NAMES = ['Verbund', 'RSA', 'ms', 'OPC UA', 'H1']
/** Attributes and properties that people read or hear. */
const READ =
  /^(aria-label|aria-description|title|placeholder|alt|label|hint|text|subtitle|action|submit|error|none|add|unitLabel)$/
/** Members of a server's answer that are English sentences, and are to be said by their code. */
const SENTENCES = /^(message|detail|remedy)$/

interface Node {
  type: string
  [member: string]: unknown
}

const isNode = (value: unknown): value is Node =>
  value !== null && typeof value === 'object' && typeof (value as Node).type === 'string'
const childrenOf = (node: Node): Node[] =>
  Object.entries(node)
    .filter(([name]) => name !== 'metadata')
    .flatMap(([, value]) => (Array.isArray(value) ? value : [value]))
    .filter(isNode)

/** What an expression may come to, as far as it is written there: texts, and members of objects. */
function outcomes(node: Node): Node[] {
  switch (node.type) {
    case 'ConditionalExpression':
      return [node['consequent'], node['alternate']].filter(isNode).flatMap(outcomes)
    case 'LogicalExpression':
      return [node['left'], node['right']].filter(isNode).flatMap(outcomes)
    case 'BinaryExpression':
      return node['operator'] === '+'
        ? [node['left'], node['right']].filter(isNode).flatMap(outcomes)
        : []
    case 'TemplateLiteral':
      return [...(node['quasis'] as Node[]), ...(node['expressions'] as Node[]).flatMap(outcomes)]
    default:
      return [node]
  }
}

/** True for a member of a catalogue: `texts.witness.remedy`. */
function isOfCatalogue(node: Node): boolean {
  const object = node['object'] as Node
  return object.type === 'MemberExpression'
    ? isOfCatalogue(object)
    : ['texts', 'words'].includes(String(object['name']))
}

/** Words of a text that are no names. */
function wordsOf(text: unknown): string {
  const left = NAMES.reduce((rest, name) => rest.replaceAll(name, ''), String(text))
  return /\p{L}{2,}/u.test(left) ? left.trim() : ''
}

/** Why an outcome is not in the language of the page; empty where it may be. */
function strange(node: Node): string {
  if (node.type === 'Literal' && typeof node['value'] === 'string') return wordsOf(node['value'])
  if (node.type === 'TemplateElement') return wordsOf((node['value'] as { cooked: string }).cooked)
  const property = node['property']
  if (node.type === 'MemberExpression' && isNode(property) && node['computed'] === false) {
    const name = String(property['name'])
    return SENTENCES.test(name) && !isOfCatalogue(node) ? `.${name}` : ''
  }
  return ''
}

/** Texts of a component that are not from the catalogues. */
function untranslated(source: string): string[] {
  const found: string[] = []
  const take = (nodes: readonly Node[]): void => {
    found.push(...nodes.map(strange).filter((text) => text !== ''))
  }
  const look = (node: Node): void => {
    if (node.type === 'Attribute') {
      const { name, value } = node as unknown as { name: string; value: unknown }
      if (!READ.test(name)) return
      for (const part of (Array.isArray(value) ? value : [value]).filter(isNode))
        if (part.type === 'Text') found.push(wordsOf(part['data']))
        else take(outcomes(part['expression'] as Node))
    } else if (node.type === 'Text') found.push(wordsOf(node['data']))
    else if (node.type === 'ExpressionTag') take(outcomes(node['expression'] as Node))
    else if (node.type !== 'StyleDirective' && !quotesServer(node)) childrenOf(node).forEach(look)
  }
  look(parse(source, { modern: true }).fragment as unknown as Node)
  return found.filter((text) => text !== '')
}

/** True for an element that says of itself that its content is English. */
function quotesServer(node: Node): boolean {
  return (
    Array.isArray(node['attributes']) &&
    (node['attributes'] as Node[]).some(
      (attribute) => attribute['name'] === 'lang' && JSON.stringify(attribute).includes('"en"'),
    )
  )
}

const components = readdirSync(WEB, { recursive: true, encoding: 'utf8' })
  .filter((file) => file.endsWith('.svelte') && !/^(node_modules|dist)\//.test(file))
  .map((file) => ({ file, source: readFileSync(path.join(WEB, file), 'utf8') }))

describe('every page', () => {
  it('takes its texts from the catalogues', () => {
    expect(components.length).toBeGreaterThan(150)
    const found = components.flatMap(({ file, source }) =>
      untranslated(source).map((text) => `${file}: ${text}`),
    )
    expect(found).toEqual([
      // The message to the partner, as it leaves.
      'engineer/decision/PreviewPanel.svelte: .message',
      // Of the catalogue, by the conclusion.
      'engineer/leaks/Warnings.svelte: .remedy',
    ])
  })
  it.each([
    ['<p>Good morning</p>', 'Good morning'],
    ['<Button title="Go on" />', 'Go on'],
    ['<p aria-label="Go {x}">{x}</p>', 'Go'],
    ["<p>{x ? 'yes' : texts.no}</p>", 'yes'],
    ['<p>{`${n} pieces`}</p>', 'pieces'],
    ["<Panel label={x ?? 'none'} />", 'none'],
    ['<p>{problem.message}</p>', '.message'],
    ['{#if x}<td title={fault.detail}>{texts.a}</td>{/if}', '.detail'],
  ])('is seen to have a text of its own: %s', (source, text) => {
    expect(untranslated(source)).toEqual([text])
  })
  it.each([
    '<p class="good morning">{texts.good}: {numberText(3)} – {x === "yes" ? 1 : 2}</p>',
    '<h1>Verbund</h1><span lang="en">{original.message}</span>',
    '<Said text={said(fault.code, fault.message)} original={fault.message} />',
  ])('may have what is no text: %s', (source) => {
    expect(untranslated(source)).toEqual([])
  })
})

/** Texts of both languages by their path; functions as they are written. */
function texts(node: unknown, at = ''): [string, string][] {
  if (typeof node === 'string') return [[at, node]]
  if (typeof node === 'function') return [[at, writtenIn(String(node))]]
  if (node === null || typeof node !== 'object') return []
  return Object.entries(node).flatMap(([name, child]) => texts(child, `${at}/${name}`))
}

/** The words in the literals of a function. */
function writtenIn(source: string): string {
  return [...source.matchAll(/'([^']*)'|"([^"]*)"|`([^`]*)`/g)]
    .map(([, one, two, three]) => (one ?? two ?? three ?? '').replace(/\$\{[^}]*\}/g, ''))
    .join(' ')
}

describe.each([
  ['shared', en, de],
  ['engineer', engineerEn, engineerDe],
  ['partner', partnerEn, partnerDe],
])('the German %s texts', (_, english, german) => {
  const byPath = new Map(texts(english))
  it('are not the English ones', () => {
    const same = texts(german).filter(
      ([at, text]) =>
        byPath.get(at) === text && wordsOf(text) !== '' && !SAME_IN_BOTH.includes(text),
    )
    expect(same).toEqual([])
  })
})

it('excuses no text that differs, or does not exist', () => {
  const german = [de, engineerDe, partnerDe].flatMap((catalogue) => texts(catalogue))
  const english = new Set([en, engineerEn, partnerEn].flatMap((it) => texts(it)).map(([, t]) => t))
  const said = new Set(german.map(([, text]) => text))
  expect(SAME_IN_BOTH.filter((text) => !said.has(text) || !english.has(text))).toEqual([])
})
