/** Decisions, mappings, entries and certificates of the connector. */
export const plantCodes: Record<string, string> = {
  CHAIN_TOO_LONG: 'There are too many authorities up to the root.',
  DOES_NOT_FIT: 'This mapping does not fit the field.',
  EXPIRED: 'It is no longer valid.',
  INVALID_DECISION: 'This cannot be decided like that.',
  INVALID_LINE: 'This line cannot be read.',
  INVALID_MAPPING: 'The mapping has errors.',
  INVALID_POLICY: 'These settings of the disclosure do not fit the field.',
  INVALID_QUANTITY: 'A quantity lies between −1 000 000 and 1 000 000 and is not 0.',
  INVALID_ROOT: 'What was shown has changed. Look at the offer again.',
  INVALID_SERIES: 'The series of the template is not valid.',
  INVALID_TEMPLATE: 'The template has errors.',
  MISSING: 'Something that is needed is missing here.',
  MISSING_HOST_NAME:
    'A host name of the twin is missing in the certificate. The authority has to take the names over from the request.',
  NOTHING_IMPORTED: 'Nothing was imported. Correct the faults and try again.',
  NOTHING_NAMED: 'Name the fields, or the network or recipient whose fields are meant.',
  NOTHING_TO_SHOW: 'Nothing of this could be shown under the present consent.',
  NOT_AN_AUTHORITY: 'This certificate does not belong to an authority.',
  NOT_A_CERTIFICATE: 'This is no certificate that can be read.',
  NOT_A_FILE: 'This is neither PEM nor DER in base64.',
  NOT_A_REVOCATION_LIST: 'This is no revocation list that can be read.',
  NOT_FILLED: 'A parameter of the template is not filled in.',
  NOT_ISSUED:
    'This is a request for a certificate. Add the certificate that the authority makes of it.',
  NOT_MANUAL: 'This field takes no entered values. An engineer has to open it for them first.',
  NOT_MAPPED: 'The field has no mapping in effect. Decide about it first.',
  NOT_TEXT: 'The file is not UTF-8 text. Export it as UTF-8.',
  NOT_USABLE: 'It cannot be used, for the reasons listed here.',
  NOT_VALID_YET: 'It is not valid yet. Check the clocks of both machines.',
  NO_CONFLICT: 'There is nothing to decide: the platform holds no other history of this log.',
  NO_MAPPING: 'This field has no mapping yet.',
  NO_PAST: 'There are no values from before the consent.',
  NO_REASON: 'Give a reason of 1 to 1000 characters.',
  OFFER_CHANGED: 'The offer has changed since it was shown. Look at it again.',
  OLDER_THAN_KNOWN: 'The list is older than the one that is here already.',
  OUTDATED: 'The list is out of date. Get the authority’s current one.',
  OVER_CAP: 'Partners would get more information than a cap allows. Nothing was changed.',
  PREVIEW_OF_ANOTHER_DRAFT:
    'The preview shows something else than is decided. Look at the preview again.',
  PREVIEW_OF_ANOTHER_POLICY:
    'A policy was changed since the preview was shown. Look at the preview again.',
  PRIVATE_KEY: 'This is a private key. It must not leave its machine, and nothing here needs it.',
  SELF_SIGNED: 'It is signed by itself. Give the one that an authority issued.',
  SET_ASIDE_BY_BROKER:
    'The broker set this message aside; it keeps neither its content nor the reason.',
  SEVERAL: 'The file holds more than one certificate or list. Add them one by one.',
  SOURCE_REFUSED: 'The server of the machine refused, or did not answer.',
  TOO_LONG: 'This is too long.',
  TOO_MANY:
    'The operation has 10 000 entries already. Enter the total instead of counting single pieces.',
  TOO_OLD: 'It was entered more than 31 days ago. Enter the present value instead.',
  TWICE: 'This field occurs twice.',
  UNKNOWN_ISSUER: 'The authority that issued it is not known here. Add its certificate first.',
  UNKNOWN_PREVIEW: 'The preview is too old. Look at it again.',
  VERIFICATION_RUNS: 'The ledger is being verified already. Ask again when that is done.',
  WRONG_APPLICATION:
    'It was issued for another application. The authority has to take the names over from the request.',
  WRONG_KEY:
    'Its key does not fit: OPC UA needs RSA keys of 2048 to 4096 bits, and the key of the request.',
  WRONG_USAGE:
    'It may not be used for this: OPC UA needs an application’s certificate for signatures and key encipherment.',
}
