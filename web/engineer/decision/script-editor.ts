import { texts } from '../language/texts'
import {
  autocompletion,
  closeBrackets,
  completionKeymap,
  type CompletionContext,
  type CompletionResult,
} from '@codemirror/autocomplete'
import { defaultKeymap, history, historyKeymap } from '@codemirror/commands'
import { javascript } from '@codemirror/lang-javascript'
import {
  bracketMatching,
  HighlightStyle,
  indentOnInput,
  syntaxHighlighting,
} from '@codemirror/language'
import { lintGutter, setDiagnostics } from '@codemirror/lint'
import { EditorState } from '@codemirror/state'
import { EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view'
import { tags } from '@lezer/highlight'
import type { MappingDiagnostic } from '../api/types'

interface Options {
  label: string
  source: string
  onchange: (source: string) => void
  inputs: () => string[]
}

const colours = HighlightStyle.define([
  { tag: tags.keyword, color: 'var(--violet)' },
  { tag: [tags.string, tags.regexp], color: 'var(--good)' },
  { tag: [tags.number, tags.bool, tags.null], color: 'var(--info)' },
  { tag: tags.comment, color: 'var(--muted)', fontStyle: 'italic' },
  { tag: [tags.propertyName, tags.function(tags.variableName)], color: 'var(--accent)' },
])

const looks = EditorView.theme({
  '&': { fontSize: '12.5px', color: 'var(--text)', backgroundColor: 'var(--surface)' },
  '&.cm-focused': { outline: 'none' },
  '.cm-content': { fontFamily: 'var(--mono)', caretColor: 'var(--text)', minHeight: '6rem' },
  '.cm-cursor': { borderLeftColor: 'var(--text)' },
  '.cm-gutters': { color: 'var(--muted)', backgroundColor: 'var(--sunken)', border: 'none' },
  '.cm-activeLine, .cm-activeLineGutter': {
    backgroundColor: 'color-mix(in srgb, var(--accent) 9%, transparent)',
  },
  '&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground':
    { backgroundColor: 'color-mix(in srgb, var(--accent) 28%, transparent)' },
  '.cm-tooltip': {
    color: 'var(--text)',
    backgroundColor: 'var(--raised)',
    border: '1px solid var(--line)',
    borderRadius: '5px',
  },
  '.cm-tooltip-autocomplete ul li[aria-selected]': {
    color: 'var(--on-accent)',
    backgroundColor: 'var(--accent)',
  },
  '.cm-diagnostic-error': { borderLeftColor: 'var(--bad)' },
})

/**
 * JavaScript editor in a shadow root. There the editor adopts style sheets instead of writing style
 * elements, which the content security policy forbids.
 */
export class ScriptEditor {
  readonly #view: EditorView

  constructor(place: HTMLElement, { label, source, onchange, inputs }: Options) {
    const root = place.shadowRoot ?? place.attachShadow({ mode: 'open' })
    root.replaceChildren()
    this.#view = new EditorView({
      root,
      parent: root,
      state: EditorState.create({
        doc: source,
        extensions: [
          lineNumbers(),
          history(),
          indentOnInput(),
          bracketMatching(),
          closeBrackets(),
          highlightActiveLine(),
          lintGutter(),
          javascript(),
          syntaxHighlighting(colours),
          autocompletion({ override: [(context) => complete(context, inputs())] }),
          keymap.of([...completionKeymap, ...historyKeymap, ...defaultKeymap]),
          looks,
          EditorView.lineWrapping,
          EditorView.contentAttributes.of({ 'aria-label': label, spellcheck: 'false' }),
          EditorView.updateListener.of((update) => {
            if (update.docChanged) onchange(update.state.doc.toString())
          }),
        ],
      }),
    })
  }

  /** Replaces the text if it differs. */
  replace(source: string): void {
    if (this.#view.state.doc.toString() === source) return
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: source } })
  }

  /** Underlines the connector's diagnostics. */
  mark(diagnostics: readonly MappingDiagnostic[]): void {
    const { doc } = this.#view.state
    const marks = diagnostics
      .filter((diagnostic) => diagnostic.line != null && diagnostic.line >= 1)
      .map((diagnostic) => {
        const line = doc.line(Math.min(diagnostic.line ?? 1, doc.lines))
        const from = Math.min(line.from + Math.max(0, (diagnostic.column ?? 1) - 1), line.to)
        const word = this.#view.state.wordAt(from)
        return {
          from,
          to: Math.max(word?.to ?? line.to, from),
          severity: 'error' as const,
          message: `${texts.diagnostics[diagnostic.code]} ${diagnostic.message}`,
        }
      })
      .sort((a, b) => a.from - b.from)
    this.#view.dispatch(setDiagnostics(this.#view.state, marks))
  }

  focus(): void {
    this.#view.focus()
  }

  destroy(): void {
    this.#view.destroy()
  }
}

const CONTEXT = [
  { label: 'ctx.inputs', type: 'property' },
  { label: 'ctx.state', type: 'property' },
  { label: 'ctx.status', type: 'property' },
  { label: 'ctx.sourceTimestamp', type: 'property' },
  { label: 'value', type: 'variable' },
]

function complete(context: CompletionContext, inputs: readonly string[]): CompletionResult | null {
  const word = context.matchBefore(/[\w.$]+/)
  if (word === null && !context.explicit) return null
  const ofInputs = inputs.flatMap((name) =>
    ['value', 'status', 'sourceTimestamp'].map((member) => ({
      label: `ctx.inputs.${name}.${member}`,
      type: 'property',
    })),
  )
  return {
    from: word?.from ?? context.pos,
    options: [...CONTEXT, ...ofInputs],
    validFor: /^[\w.$]*$/,
  }
}
