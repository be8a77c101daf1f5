// Schemas of members that the descriptions of the APIs leave open.
import { readFileSync } from 'node:fs'

const ref = (/** @type {string} */ name) => ({ $ref: `#/components/schemas/${name}` })
const optional = (/** @type {object} */ schema) => ({ oneOf: [schema, { type: 'null' }] })
const list = (/** @type {object} */ items) => ({ type: 'array', items })
const oneOf = (/** @type {string[]} */ ...values) => ({ type: 'string', enum: values })
const text = { type: 'string' }
const count = { type: 'integer' }
const optionalText = { type: ['string', 'null'] }
const optionalCount = { type: ['integer', 'null'] }

/** @param {Record<string, object>} required @param {Record<string, object>} [others] */
const object = (required, others = {}) => ({
  type: 'object',
  required: Object.keys(required),
  properties: { ...required, ...others },
})

/**
 * Schemas of a message between platform and factory, by name.
 *
 * @param {string} message
 */
function messageSchemas(message) {
  const file = new URL(`../asi-model/schema/${message}.schema.json`, import.meta.url)
  const schemas = JSON.stringify(JSON.parse(readFileSync(file, 'utf8')).$defs)
  return JSON.parse(schemas.replaceAll('#/$defs/', '#/components/schemas/'))
}

export const platformSupplements = () => ({
  schemas: {
    ...messageSchemas('operation-network'),
    ...messageSchemas('decision'),
    ReportedValue: object({ value: {} }, { status: optionalText, sourceTimestamp: optionalText }),
  },
  members: {
    'NetworkView.network': ref('OperationNetwork'),
    'PutBody.operationNetwork': ref('OperationNetwork'),
    'PartView.faultList': list(ref('ProblemFault')),
    'FieldView.disclosure': optional(ref('DisclosureStatement')),
    'FieldView.value': {},
    'Report.fields': { type: 'object', additionalProperties: ref('ReportedValue') },
  },
})

/**
 * The schema with members that may be left out instead of such with a default.
 *
 * @param {{ properties: Record<string, { default?: unknown }> }} known
 */
const withoutDefaults = ({ properties, ...others }) => ({
  ...others,
  properties: Object.fromEntries(
    Object.entries(properties).map(([name, { default: _, ...schema }]) => [name, schema]),
  ),
})

/** Members of a ledger entry that depend on its kind. */
const ledgerSubject = object(
  {},
  {
    operationNetworkId: optionalText,
    operationId: optionalText,
    dynamicDataRequestId: optionalText,
    fieldName: optionalText,
    policy: optional(ref('DisclosurePolicy')),
    mappingState: optional(ref('MappingState')),
    decidedBy: optionalText,
    dataSetWriterId: optionalCount,
    epoch: optionalCount,
    firstSequence: optionalCount,
    lastSequence: optionalCount,
    lastDeliveredSequence: optionalCount,
  },
)

export const connectorSupplements = () => ({
  schemas: {
    RequestKey: object({ operationNetworkId: text, operationId: text, dynamicDataRequestId: text }),
    MappingState: oneOf('PENDING', 'MAPPED', 'REFUSED'),
    ValueSource: oneOf('MAPPING', 'MANUAL', 'EXTERNAL'),
    OperationSummary: object(
      { operationId: text, operationType: text },
      { name: optionalText, plannedStart: optionalText, plannedEnd: optionalText },
    ),
    LinkStatus: object(
      { state: text },
      {
        since: optionalText,
        lastAcceptedAt: optionalText,
        lastReceiptedAt: optionalText,
        backlog: count,
        reason: optionalText,
      },
    ),
    LeaseParty: object({ instanceId: text, host: text, since: text, lastHeardAt: text }),
    LeaseStatus: object(
      { state: oneOf('ASKING', 'HELD', 'REFUSED'), since: text, host: text },
      {
        leaseNumber: optionalCount,
        holder: optional(ref('LeaseParty')),
        contender: optional(ref('LeaseParty')),
      },
    ),
    SpoolStatus: object({ waiting: count, sent: count, bytes: count }, { oldestAt: optionalText }),
    TwinStatus: object({}, { endpointUrl: optionalText }),
    OperatorProblem: object({ text, since: text, toldBy: text }),
    // Any part of a policy and of the monitoring options may be left out.
    DisclosurePolicy: withoutDefaults,
    MonitorOptions: withoutDefaults,
    Identity: (/** @type {{ oneOf: { properties: object }[] }} */ known) => ({
      ...known,
      oneOf: known.oneOf.map((variant) =>
        'user_name' in variant.properties
          ? { ...variant, properties: { ...variant.properties, password: text } }
          : variant,
      ),
    }),
    Versioned_Rule: {
      allOf: [ref('DocumentVersion'), ref('Rule'), object({ changedBy: text, changedAt: text })],
    },
    SourceView: { allOf: [ref('SourceConfig'), ref('SourceStatus')] },
    EntryView: (/** @type {{ allOf: object[] }} */ known) => ({
      allOf: [ledgerSubject, ...known.allOf.slice(1)],
    }),
  },
  members: {
    'DecisionBody.mappingState': ref('MappingState'),
    'DecisionBody.valueSource': optional(ref('ValueSource')),
    'Draft.valueSource': ref('ValueSource'),
    'EntryView.value': { type: ['object', 'null'], additionalProperties: {} },
    'EntryResult.result': oneOf('TAKEN', 'REPEATED', 'REFUSED'),
    'FieldLeak.key': ref('FieldKey'),
    'FieldResult.key': ref('FieldKey'),
    'FieldView.key': ref('FieldKey'),
    'FieldView.mapping': optional(ref('Mapping')),
    'FieldView.mappingState': ref('MappingState'),
    'FieldView.valueSource': optional(ref('ValueSource')),
    'LeakWarning.fields': list(ref('FieldKey')),
    'LedgerField.key': ref('FieldKey'),
    // The name of a built-in type; the description confuses it with a data type of a server.
    'Convert.to': text,
    'Mapping.targetType': text,
    'MappingInput.valueType': optionalText,
    'Parse.to': text,
    'TracedValue.type': optionalText,
    'OperatorField.key': ref('FieldKey'),
    'PlacedMapping.key': ref('FieldKey'),
    'PolicyUse.key': ref('FieldKey'),
    'RequestView.key': ref('RequestKey'),
    'RequestView.operation': ref('OperationSummary'),
    'RevocationBody.fields': list(ref('FieldKey')),
    'RevokedField.field': ref('FieldKey'),
    'RevokedWriter.request': ref('RequestKey'),
    'Rule.valueSource': optional(ref('ValueSource')),
    'RuleDecision.field': ref('FieldKey'),
    'RuleMatch.key': ref('FieldKey'),
    'RuleMatch.mappingState': ref('MappingState'),
    'RuleOfferView.mapping': optional(ref('Mapping')),
    'RuleOfferView.valueSource': optional(ref('ValueSource')),
    'Standing.problem': optional(ref('OperatorProblem')),
    'RuleCondition.namePattern': optionalText,
    'Status.lease': ref('LeaseStatus'),
    'Status.link': optional(ref('LinkStatus')),
    'Status.spool': ref('SpoolStatus'),
    'Status.twin': ref('TwinStatus'),
  },
})
