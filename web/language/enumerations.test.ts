import { readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'
import { de as engineerDe } from '@/engineer/language/de'
import { en as engineerEn } from '@/engineer/language/en'
import { de as partnerDe } from '@/partner/language/de'
import { en as partnerEn } from '@/partner/language/en'
import { de } from './de'
import { en } from './en'

type Texts = Record<string, unknown>

/** Texts of the values of an enumeration, for each that a page shows. */
function textsOf(
  words: typeof en,
  engineer: typeof engineerEn,
  partner: typeof partnerEn,
): Record<string, Texts> {
  return {
    AccessKind: partner.accesses.access,
    Aggregate: engineer.options,
    AggregateFunction: engineer.policy.aggregates,
    AgentKind: partner.accesses.agent,
    AuditAgentKind: partner.audit.agent,
    AuditFactKind: partner.audit.fact,
    AuditOutcome: partner.audit.outcome,
    ClientRejection: engineer.certificates.reasons,
    Conclusion: engineer.leaks.conclusions,
    ConditionKind: words.condition,
    ConflictKind: engineer.witness.kind,
    CounterInput: engineer.options,
    DiagnosticCode: engineer.diagnostics,
    EdgeDirection: engineer.options,
    EvidenceKind: engineer.servers.evidence,
    FaultKind: engineer.valueFaults,
    GapCause: partner.factories.cause,
    LandlockState: engineer.safety.worker.landlock,
    LeaseState: engineer.lease.state,
    MappingHealth: engineer.survey.health,
    MappingState: words.mappingState,
    MergeRule: engineer.options,
    OnDecrease: engineer.options,
    OperationState: words.operationState,
    Overflow: engineer.options,
    PartState: partner.network.part,
    ProfileLimit: engineer.servers.figure,
    RatePeriod: engineer.options,
    ReasonKind: engineer.suggestions.reason,
    RelationType: words.relation,
    RemainingRecords: partner.removals.remains,
    Role: Object.fromEntries(
      Object.entries(words.session.role).map(([role, text]) => [role.toUpperCase(), text]),
    ),
    Rounding: engineer.options,
    RuleAction: engineer.rules.actions,
    SourceProblemKind: engineer.sources.problems,
    SourceState: engineer.sources.state,
    StatusCodes: engineer.policy.statusResolutions,
    TrustFileKind: engineer.certificates.kinds,
    UpdateFrequencyUnit: partner.request.unit,
    ValueSource: engineer.inbox.valueSource,
    WorkerPurpose: engineer.safety.worker.purpose,
  }
}

/** Enumerations of which no page shows a value, each with the reason. */
const NOT_SHOWN: Record<string, string> = {
  Acceptance: 'decides what the queue of entries does',
  AccessRetentionRule: 'is said by a whole sentence',
  BuiltInType: 'names of OPC UA, the same in all languages',
  ChangeReason: 'no page lists the changes of a revision',
  ClientTrust: 'decides the badge, whose texts have names',
  ConsentEffect: 'no page lists the changes of a revision',
  DiskState: 'no page shows it; it is in the status and in a metric',
  DryRunValues: 'is asked for only',
  EffectKind: 'is said by a whole sentence, with a test of its own',
  FieldChange: 'no page lists the changes of a revision',
  ImportEffect: 'is counted, and the counts have texts',
  LateValues: 'no page sets it',
  MappingEffect: 'no page lists the changes of a revision',
  MessageSecurity: 'decides the choice of security, whose texts have names',
  NodeClass: 'decides the icon in the tree',
  Piece: 'decides which of two buttons was pressed',
  RetentionRule: 'is said by a whole sentence',
  RevocationListState: 'decides the badge, whose texts have names',
  SecondFactorKind: 'decides the form of signing in',
  SecurityPolicy: 'names of OPC UA, the same in all languages',
  SessionKind: 'decides the badge, whose text has a name',
  Severity: 'decides the colour',
  StatusResolution: 'is said by a whole sentence, with a test of its own',
  TrustState: 'decides the badge, whose texts have names',
  TypeName: 'names of OPC UA, the same in all languages',
  Weekday: 'days are named by the browser, in the language of the page',
}

const enumerations = ['platform', 'factory-connector'].flatMap((daemon) => {
  const file = path.resolve(import.meta.dirname, '../..', daemon, 'openapi.json')
  const { components } = JSON.parse(readFileSync(file, 'utf8')) as {
    components: { schemas: Record<string, { enum?: string[] }> }
  }
  return Object.entries(components.schemas).flatMap(([name, schema]) =>
    schema.enum === undefined ? [] : [{ name, values: schema.enum }],
  )
})

describe.each([
  ['English', textsOf(en, engineerEn, partnerEn)],
  ['German', textsOf(de, engineerDe, partnerDe)],
])('the %s texts', (_, tables) => {
  it('say each value of each enumeration that pages show', () => {
    expect(enumerations.length).toBeGreaterThan(50)
    const missing = enumerations.flatMap(({ name, values }) => {
      if (name in NOT_SHOWN) return []
      const texts = tables[name]
      if (texts === undefined) return [`${name}: neither said nor excused`]
      return values.filter((value) => !(value in texts)).map((value) => `${name}: ${value}`)
    })
    expect(missing).toEqual([])
  })
  it('excuse no enumeration that is said or does not exist', () => {
    const known = new Set(enumerations.map(({ name }) => name))
    const listed = [...Object.keys(tables), ...Object.keys(NOT_SHOWN)]
    expect(listed.filter((name) => !known.has(name))).toEqual([])
    expect(Object.keys(NOT_SHOWN).filter((name) => name in tables)).toEqual([])
  })
})
