/** Decisions, mappings, entries and certificates of the connector. */
export const plantCodes: Record<string, string> = {
  CHAIN_TOO_LONG: 'Es sind zu viele Zertifizierungsstellen bis zur Wurzel.',
  DOES_NOT_FIT: 'Diese Zuordnung passt nicht zum Feld.',
  EXPIRED: 'Es ist nicht mehr gültig.',
  INVALID_DECISION: 'So lässt sich das nicht entscheiden.',
  INVALID_LINE: 'Diese Zeile lässt sich nicht lesen.',
  INVALID_MAPPING: 'Die Zuordnung hat Fehler.',
  INVALID_POLICY: 'Diese Einstellungen der Offenlegung passen nicht zum Feld.',
  INVALID_QUANTITY: 'Eine Menge liegt zwischen −1 000 000 und 1 000 000 und ist nicht 0.',
  INVALID_ROOT: 'Das Gezeigte hat sich geändert. Sehen Sie das Angebot noch einmal an.',
  INVALID_SERIES: 'Die Reihe der Vorlage ist ungültig.',
  INVALID_TEMPLATE: 'Die Vorlage hat Fehler.',
  MISSING: 'Hier fehlt etwas, das gebraucht wird.',
  MISSING_HOST_NAME:
    'Im Zertifikat fehlt ein Hostname des Zwillings. Die Zertifizierungsstelle muss die Namen aus dem Antrag übernehmen.',
  NOTHING_IMPORTED:
    'Es wurde nichts importiert. Berichtigen Sie die Fehler und versuchen Sie es noch einmal.',
  NOTHING_NAMED:
    'Nennen Sie die Felder, oder das Netz oder den Empfänger, dessen Felder gemeint sind.',
  NOTHING_TO_SHOW: 'Nach der jetzigen Einwilligung ließe sich nichts davon zeigen.',
  NOT_AN_AUTHORITY: 'Dieses Zertifikat gehört keiner Zertifizierungsstelle.',
  NOT_A_CERTIFICATE: 'Das ist kein lesbares Zertifikat.',
  NOT_A_FILE: 'Das ist weder PEM noch DER in Base64.',
  NOT_A_REVOCATION_LIST: 'Das ist keine lesbare Sperrliste.',
  NOT_FILLED: 'Ein Parameter der Vorlage ist nicht ausgefüllt.',
  NOT_ISSUED:
    'Das ist ein Antrag auf ein Zertifikat. Fügen Sie das Zertifikat hinzu, das die Zertifizierungsstelle daraus macht.',
  NOT_MANUAL:
    'In dieses Feld lässt sich nichts eintragen. Ein Ingenieur muss es zuerst dafür öffnen.',
  NOT_MAPPED: 'Für das Feld gilt keine Zuordnung. Entscheiden Sie zuerst darüber.',
  NOT_TEXT: 'Die Datei ist kein UTF-8-Text. Exportieren Sie sie als UTF-8.',
  NOT_USABLE: 'Es lässt sich nicht verwenden; die Gründe stehen hier.',
  NOT_VALID_YET: 'Es ist noch nicht gültig. Prüfen Sie die Uhren beider Rechner.',
  NO_CONFLICT:
    'Es gibt nichts zu entscheiden: Die Plattform hat keinen anderen Verlauf dieses Verzeichnisses.',
  NO_MAPPING: 'Dieses Feld hat noch keine Zuordnung.',
  NO_PAST: 'Es gibt keine Werte aus der Zeit vor der Einwilligung.',
  NO_REASON: 'Nennen Sie einen Grund mit 1 bis 1000 Zeichen.',
  OFFER_CHANGED:
    'Das Angebot hat sich geändert, seit es gezeigt wurde. Sehen Sie es noch einmal an.',
  OLDER_THAN_KNOWN: 'Die Liste ist älter als die, die schon hier ist.',
  OUTDATED: 'Die Liste ist veraltet. Holen Sie die aktuelle der Zertifizierungsstelle.',
  OVER_CAP:
    'Partner bekämen mehr Information, als eine Obergrenze erlaubt. Es wurde nichts geändert.',
  PREVIEW_OF_ANOTHER_DRAFT:
    'Die Vorschau zeigt etwas anderes, als entschieden wird. Sehen Sie die Vorschau noch einmal an.',
  PREVIEW_OF_ANOTHER_POLICY:
    'Eine Richtlinie wurde geändert, seit die Vorschau gezeigt wurde. Sehen Sie die Vorschau noch einmal an.',
  PRIVATE_KEY:
    'Das ist ein privater Schlüssel. Er darf seinen Rechner nicht verlassen, und nichts hier braucht ihn.',
  SELF_SIGNED:
    'Es ist von sich selbst signiert. Nehmen Sie das, das eine Zertifizierungsstelle ausgestellt hat.',
  SET_ASIDE_BY_BROKER:
    'Der Broker hat diese Nachricht beiseitegelegt; er behält weder ihren Inhalt noch den Grund.',
  SEVERAL:
    'Die Datei enthält mehr als ein Zertifikat oder eine Liste. Fügen Sie sie einzeln hinzu.',
  SOURCE_REFUSED: 'Der Server der Maschine hat abgelehnt oder nicht geantwortet.',
  TOO_LONG: 'Das ist zu lang.',
  TOO_MANY:
    'Der Vorgang hat schon 10 000 Einträge. Geben Sie die Summe ein, statt einzelne Stücke zu zählen.',
  TOO_OLD:
    'Es wurde vor mehr als 31 Tagen eingegeben. Geben Sie stattdessen den jetzigen Wert ein.',
  TWICE: 'Dieses Feld kommt zweimal vor.',
  UNKNOWN_ISSUER:
    'Die ausstellende Zertifizierungsstelle ist hier nicht bekannt. Fügen Sie zuerst ihr Zertifikat hinzu.',
  UNKNOWN_PREVIEW: 'Die Vorschau ist zu alt. Sehen Sie sie noch einmal an.',
  VERIFICATION_RUNS: 'Das Verzeichnis wird schon geprüft. Fragen Sie wieder, wenn das fertig ist.',
  WRONG_APPLICATION:
    'Es wurde für eine andere Anwendung ausgestellt. Die Zertifizierungsstelle muss die Namen aus dem Antrag übernehmen.',
  WRONG_KEY:
    'Sein Schlüssel passt nicht: OPC UA braucht RSA-Schlüssel mit 2048 bis 4096 Bit, und den Schlüssel des Antrags.',
  WRONG_USAGE:
    'Es darf dafür nicht verwendet werden: OPC UA braucht das Zertifikat einer Anwendung für Signaturen und Schlüsselverschlüsselung.',
}
