import { connector } from '../api/client'
import type { SecurityChoice, ServerOffer, SourceConfig, SourceTest } from '../api/types'
import { texts } from '../language/texts'
import { keyOf, tried } from './security-choice'
import { suggestedId } from './source-id'

export type SignIn = 'anonymous' | 'userName' | 'certificate'

/** An option of a selection. */
export interface Option {
  key: string
  label: string
}

/** The longest that asking a server takes, with the time to wait for a turn, in ms. */
const ASKING_MS = 30_000
/** The same of a test. */
const TESTING_MS = 60_000

/** What is typed about a source, and what its server answered. */
export class SourceDraft {
  #source: SourceConfig | undefined
  #typedId = $state<string>()
  name = $state('')
  endpointUrl = $state('opc.tcp://')
  security = $state<SecurityChoice>({ choice: 'strongest' })
  identity = $state<SignIn>('anonymous')
  userName = $state('')
  password = $state('')
  unprotected = $state(false)
  publishingIntervalMs = $state(20)
  /** Empty: as often as the server publishes. */
  samplingIntervalMs = $state<number | null>(null)
  silenceMsMax = $state(5000)
  #answer = $state.raw<{ from: string; offer: ServerOffer }>()
  #test = $state.raw<{ of: string; outcome: SourceTest }>()

  /** Taken once: what is typed stays, though the source goes on changing. */
  constructor(source?: SourceConfig) {
    this.#source = source
    if (source === undefined) return
    this.name = source.name ?? ''
    this.endpointUrl = source.endpointUrl
    this.security = source.security ?? this.security
    this.identity = source.identity?.kind ?? 'anonymous'
    this.userName = source.identity?.kind === 'userName' ? source.identity.userName : ''
    this.unprotected = source.sendsPasswordUnprotected ?? false
    this.publishingIntervalMs = source.publishingIntervalMs ?? this.publishingIntervalMs
    this.samplingIntervalMs = source.samplingIntervalMs ?? null
    this.silenceMsMax = source.silenceMsMax ?? this.silenceMsMax
  }

  /** The id follows the address until another one is typed. */
  idAmong(taken: readonly string[]): string {
    return this.#typedId ?? this.#source?.sourceId ?? suggestedId(this.endpointUrl, taken)
  }

  set typedId(id: string) {
    this.#typedId = id
  }

  get isNew(): boolean {
    return this.#source === undefined
  }

  /** What the server at the present address said that it offers. */
  get offer(): ServerOffer | undefined {
    return this.#answer?.from === this.endpointUrl.trim() ? this.#answer.offer : undefined
  }

  /** Outcome of the test of the address, security and sign-in that are typed now. */
  outcome(taken: readonly string[]): SourceTest | undefined {
    return this.#test?.of === tried(this.config(taken)) ? this.#test.outcome : undefined
  }

  /** Choices of security: those that the server offers once it was asked, the strongest first. */
  get securities(): Option[] {
    const usual: Option[] = [
      { key: 'strongest', label: texts.sources.securityStrongest },
      { key: 'Basic256Sha256 sign', label: texts.sources.securitySigned },
      { key: 'none', label: texts.sources.securityNone },
    ]
    const { modes, asOffered } = texts.servers
    const offered = this.offer?.endpoints.flatMap(({ choice, securityPolicy, messageSecurity }) =>
      choice == null || choice.choice === 'none'
        ? []
        : [{ key: keyOf(choice), label: asOffered(securityPolicy, modes[messageSecurity]) }],
    )
    const has = (mode: string): boolean =>
      this.offer?.endpoints.some(
        ({ choice, messageSecurity }) => choice != null && messageSecurity === mode,
      ) ?? true
    const [strongest, signed, none] = usual
    const listed = [
      ...(has('signAndEncrypt') ? [strongest] : []),
      ...(offered ?? [signed]),
      ...(has('none') ? [none] : []),
    ].filter((option) => option !== undefined)
    // A choice that is in force stays one, whatever is offered at the moment.
    return listed.some(({ key }) => key === keyOf(this.security))
      ? listed
      : [...listed, { key: keyOf(this.security), label: texts.sources.securityExactly }]
  }

  get securityKey(): string {
    return keyOf(this.security)
  }

  set securityKey(key: string) {
    const offered = this.offer?.endpoints.map(({ choice }) => choice)
    const exact: SecurityChoice = { choice: 'exactly', policy: 'Basic256Sha256', mode: 'sign' }
    const known = [...(offered ?? []), exact, this.#source?.security]
    this.security =
      key === 'strongest' || key === 'none'
        ? { choice: key }
        : (known.find((choice) => choice != null && keyOf(choice) === key) ?? this.security)
  }

  /** Ways to sign in that the chosen endpoint takes; all of them while that is not known. */
  get signIns(): SignIn[] {
    const endpoints = this.offer?.endpoints.filter(({ choice, messageSecurity }) =>
      this.security.choice === 'strongest'
        ? choice != null && messageSecurity === 'signAndEncrypt'
        : choice != null && keyOf(choice) === this.securityKey,
    )
    const ways: SignIn[] = ['anonymous', 'userName']
    // Its files are named in the configuration, not on this page.
    if (this.#source?.identity?.kind === 'certificate') ways.push('certificate')
    return endpoints === undefined
      ? ways
      : ways.filter((way) =>
          endpoints.some((endpoint) =>
            way === 'anonymous'
              ? endpoint.allowsAnonymous
              : way === 'userName'
                ? endpoint.allowsUserName
                : endpoint.allowsCertificate,
          ),
        )
  }

  config(taken: readonly string[]): SourceConfig {
    const id = this.idAmong(taken).trim()
    const { identity, userName, password } = this
    const before = this.#source?.identity
    return {
      sourceId: id,
      name: this.name.trim() || id,
      endpointUrl: this.endpointUrl.trim(),
      security: this.security,
      identity:
        identity === 'userName'
          ? { kind: 'userName', userName, ...(password === '' ? {} : { password }) }
          : identity === 'certificate' && before?.kind === 'certificate'
            ? before
            : { kind: 'anonymous' },
      sendsPasswordUnprotected:
        this.security.choice === 'none' && identity === 'userName' && this.unprotected,
      publishingIntervalMs: this.publishingIntervalMs,
      ...(this.samplingIntervalMs === null ? {} : { samplingIntervalMs: this.samplingIntervalMs }),
      silenceMsMax: this.silenceMsMax,
    }
  }

  /** Asks the server what it offers, and chooses the strongest of a new source. */
  async ask(): Promise<SourceTest['problem']> {
    const from = this.endpointUrl.trim()
    const body = { endpointUrl: from }
    const answer = await connector.post('/source-discovery', { body, timeoutMs: ASKING_MS })
    if (answer.offer == null) return answer.problem
    this.#answer = { from, offer: answer.offer }
    const [strongest] = this.securities
    if (this.isNew && strongest !== undefined) this.securityKey = strongest.key
    const [first] = this.signIns
    if (this.isNew && first !== undefined && !this.signIns.includes(this.identity))
      this.identity = first
    return undefined
  }

  async test(taken: readonly string[]): Promise<void> {
    const body = this.config(taken)
    const outcome = await connector.post('/source-test', { body, timeoutMs: TESTING_MS })
    this.#test = { of: tried(body), outcome }
  }

  async save(taken: readonly string[]): Promise<void> {
    const body = this.config(taken)
    await (this.isNew
      ? connector.post('/sources', { body })
      : connector.put('/sources/{sourceId}', { path: { sourceId: body.sourceId }, body }))
  }
}
