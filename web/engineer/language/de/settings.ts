import type { settings as English } from '../en/settings'

export const settings: typeof English = {
  safety: {
    title: 'Was schützt',
    plaintext: 'Wege ohne TLS',
    noPlaintext: 'Nichts verlässt diesen Rechner ohne TLS.',
    withoutTls: (key: string, address: string) =>
      `OHNE TLS, wie ausdrücklich erlaubt: ${key}, ${address}. Wer am Weg sitzt, liest Passwörter und Werte.`,
    sealingKey: 'Schlüssel der Passwörter',
    keyBesideStore:
      'NEBEN DEM SPEICHER: Eine Kopie des Datenordners enthält die Passwörter. Den Schlüssel als Credential des Dienstverwalters übergeben oder mit sealing.key_file in eine Datei auf einem anderen Medium legen.',
    keyApart: 'Nicht im Ordner des Speichers.',
    workers: 'Prozesse für Skripte',
    worker: {
      none: 'Noch wurde keiner gestartet.',
      purpose: { mappings: 'Skripte von Zuordnungen', dryRuns: 'Skripte, die erprobt werden' },
      filtered: 'Systemaufrufe werden gefiltert.',
      unfiltered: 'Systemaufrufe werden NICHT gefiltert; eine Einstellung erlaubt das.',
      refused: 'Er läuft nicht: Der Rechner gibt ihm keine Wände, oder keine, die genügen.',
      landlock: {
        none: 'Der Kern hat kein Landlock.',
        partial: 'Landlock verwehrt Dateien und Netz, zum Teil.',
        full: 'Landlock verwehrt Dateien, Netz und andere Prozesse.',
      },
      ownUser: (id: number) => `Läuft als eigener Benutzer (Nummer ${id}).`,
      sharedUser: 'Läuft als Benutzer des Connectors.',
      root: 'Läuft als ROOT: Ein Skript, das aus seiner Maschine ausbricht, hat diesen Rechner. Eine Einstellung erlaubt das.',
      limited: 'Speicher, Dateien und Prozesse sind begrenzt.',
      unlimited: 'Speicher, Dateien und Prozesse sind NICHT begrenzt.',
    },
  },
  settings: {
    title: 'Einstellungen',
    subtitle: 'Diese Seite, diese Sitzung und womit die Anbindung läuft',
    file: 'Konfiguration',
    isSet: 'Gesetzt',
    byDefault: 'sonst',
    default: 'Vorgabe',
    absent: 'Nicht gesetzt',
    hidden: 'Gesetzt, wird nicht gezeigt',
    sections: {
      '': 'Allgemein',
      sealing: 'Versiegelung der Passwörter',
      web: 'Seiten und API',
      'web.tls': 'TLS der Seiten',
      'web.share_per_person': 'Anteil jeder Person an den Seiten',
      twin: 'Zwilling',
      'twin.security': 'Sicherheit des Zwillings',
      'twin.limits': 'Grenzen des Zwillings',
      'twin.discovery': 'Auffinden des Zwillings',
      enrolment: 'Aufnahme',
      broker: 'Weg zum Broker',
      'broker.client_certificate': 'Zertifikat beim Broker',
      'broker.proxy': 'Proxy auf dem Weg',
      reports: 'Berichte',
      spool: 'Ausgangspuffer',
      ledger: 'Ausgangsbuch',
      'mapping.script': 'Skripte',
      'mapping.history': 'Aufgezeichnete Werte',
      admin: 'Erster Benutzer',
      log: 'Protokoll',
    } as Record<string, string>,
    meaning: {
      data_directory:
        'Wo die dauerhafte Datei, Schlüssel und Zertifikate liegen. Auf einer lokalen Platte; als Ganzes sichern.',
      allow_shared_data_directory:
        'Diesen Ordner benutzen, obwohl Gruppe oder andere ihn betreten dürfen; die Dateien darin gehören in jedem Fall dem Benutzer allein.',
      'sealing.key_file':
        'Datei des Schlüssels, der die Passwörter im Speicher versiegelt. Sonst eine Datei neben dem Speicher, die nur Kopien des Speichers schützt.',
      'web.allow_plaintext':
        'Einfaches HTTP mit anderen Rechnern; wer am Weg sitzt, liest Passwörter.',
      'enrolment.allow_plaintext':
        'Den Aufnahmeschlüssel ohne TLS an eine Plattform auf einem anderen Rechner senden.',
      'broker.allow_plaintext':
        'Mit einem Broker auf einem anderen Rechner ohne TLS sprechen, auch mit dem bei der Aufnahme genannten.',
      'broker.proxy.allow_plaintext':
        'Benutzername und Passwort ohne TLS an einen Proxy auf einem anderen Rechner senden; wer am Weg sitzt, liest sie.',
      'web.listen': 'Wo Seiten und API erreichbar sind.',
      'web.public_url':
        'Adresse für Browser, etwa wo ein Proxy TLS spricht. Mit https gilt das Cookie der Sitzung nur über TLS. Passkeys brauchen hier einen Domainnamen und HTTPS.',
      'web.trusted_proxies':
        'Proxys vor den Seiten. Nur ihnen wird geglaubt, welche Adresse ihr Gegenüber hat. Auf anderen Rechnern brauchen sie auch hier TLS; ohne TLS bedient ein offener Zugang nur diese Proxys.',
      'web.forwarded_header': 'Kopfzeile, in der die Proxys diese Adresse nennen.',
      'web.share_per_person.requests_per_second':
        'Anfragen einer Person je Sekunde auf Dauer. Was darüber hinausgeht, wird eine Weile abgelehnt.',
      'web.share_per_person.requests_at_once':
        'Anfragen einer Person auf einmal, nach einer Pause.',
      'web.share_per_person.downloads':
        'Exporte, Prüfungen und Verifikationen einer Person zur gleichen Zeit.',
      'web.share_per_person.streams':
        'Live-Ströme einer Person zur gleichen Zeit; jede offene Seite hat einen.',
      'web.share_per_person.body_mib':
        'MiB, die eine Person zur gleichen Zeit senden darf, über alle ihre Anfragen.',
      'web.tls.certificate':
        'Zertifikat als PEM. Ohne Zertifikat und Schlüssel unverschlüsselt, nur für diesen Rechner oder hinter einem Proxy auf ihm, der TLS spricht.',
      'web.tls.key': 'Schlüssel als PEM.',
      'twin.listen': 'Wo der OPC-UA-Server mit den Schnittstellen der Vorgänge erreichbar ist.',
      'twin.host_names':
        'Namen und Adressen, unter denen OPC-UA-Clients diesen Rechner erreichen, für sein Zertifikat. Vorgabe: der eigene Name.',
      'twin.security.allow_anonymous_unencrypted':
        'Nur zur Entwicklung: auch ein Endpunkt ohne Verschlüsselung und Benutzer, in der Rolle Betrachter.',
      'twin.security.allow_signed_unencrypted':
        'Auch Endpunkte, die nur signieren, für Clients ohne Verschlüsselung. Wer am Weg sitzt, liest Werte und Schreibzugriffe.',
      'twin.security.trust_unknown_certificates':
        'Nur zur Entwicklung: jedem Zertifikat eines Clients vertrauen, statt auf eine Zulassung zu warten.',
      'twin.security.login_failures_max':
        'Falsche Passwörter eines Benutzers innerhalb des Zeitfensters, ab denen weitere Versuche ebenso lange abgewiesen werden.',
      'twin.security.login_window_s': 'Das Zeitfenster für falsche Passwörter in Sekunden.',
      'twin.security.certificate_renewal_days':
        'So viele Tage vor seinem Ablauf wird das eigene Zertifikat des Zwillings erneuert.',
      'twin.security.certificate_validity_days': 'So viele Tage gilt ein erneuertes Zertifikat.',
      'twin.limits.sessions_max': 'Gleichzeitige Sitzungen von OPC-UA-Clients.',
      'twin.limits.sessions_per_client_max':
        'Gleichzeitige Sitzungen eines Benutzers von OPC-UA-Clients.',
      'twin.limits.connections_max': 'Gleichzeitige Verbindungen von OPC-UA-Clients.',
      'twin.limits.connections_per_address_max': 'Gleichzeitige Verbindungen von einer Adresse.',
      'twin.limits.subscriptions_per_client_max': 'Abonnements eines Benutzers.',
      'twin.limits.monitored_items_per_client_max': 'Überwachte Werte eines Benutzers.',
      'twin.limits.monitored_items_per_subscription_max': 'Überwachte Werte eines Abonnements.',
      'twin.limits.publishing_interval_ms_min': 'Kürzestes Sendeintervall in Millisekunden.',
      'twin.limits.publishing_tick_ms':
        'Wie oft nach fälligen Abonnements gesehen wird, in Millisekunden.',
      'twin.discovery.local_discovery_server_url':
        'Ein lokaler Discovery-Server, bei dem sich der Zwilling anmeldet. Sein Zertifikat wird wie das eines Clients freigegeben.',
      'twin.discovery.registration_interval_s':
        'Wie oft er sich dort meldet, in Sekunden: Discovery-Server vergessen, wer zehn Minuten schweigt.',
      'twin.discovery.announce_by_multicast_dns':
        'Den Zwilling im lokalen Netz über Multicast-DNS bekannt machen.',
      'broker.url':
        'Ein anderer Weg zum Broker der Plattform als der bei der Aufnahme genannte: amqps://host:5671, oder ein WebSocket, wo die Firewall nur HTTPS hinauslässt, amqp+wss://host. Das Protokoll bleibt dasselbe.',
      'broker.root_certificates':
        'PEM-Datei mit den Stellen, die für den Broker bürgen dürfen. Vorgabe: die bei der Aufnahme genannte Stelle.',
      'broker.client_certificate.certificate':
        'Zertifikat als PEM, das eigene zuerst, mit dem sich die Anbindung bei einem Broker ausweist, der eines verlangt, neben Benutzername und Passwort.',
      'broker.client_certificate.key':
        'Dessen Schlüssel als PEM, für den Benutzer der Anbindung allein. Beide werden beim Start gelesen.',
      'broker.proxy.url':
        'Der HTTP-Proxy auf dem Weg hinaus; er muss CONNECT zum Port des Brokers erlauben.',
      'broker.proxy.user_name': 'Als wer sich die Anbindung beim Proxy ausweist, wo er fragt.',
      'broker.proxy.password': 'Das Passwort beim Proxy.',
      'reports.encoding':
        'Wie Werte geschrieben werden: digicor (1.04 umkehrbar), 1.05-compact oder 1.05-verbose.',
      'reports.publishing_interval_ms':
        'Der kürzeste Abstand zweier Berichte eines Datensatzes in Millisekunden. Richtlinien verlängern ihn, Feld für Feld.',
      'spool.bytes_max':
        'Größe der Berichte in Bytes, ab der ältere für neuere aufgegeben werden; die Lücke wird angekündigt.',
      'spool.age_hours_max': 'Alter in Stunden, ab dem Berichte aufgegeben werden.',
      'spool.resend_after_s':
        'Sekunden ohne Quittung der Plattform, nach denen ein Bericht noch einmal gesendet wird; verdoppelt sich jedes Mal, bis zu einer Stunde.',
      'spool.replay_share_percent':
        'Anteil an den Berichten, den ein Rückstand bekommt, während neue warten, in Prozent, 1 bis 99. Warten keine neuen, bekommt er alles.',
      'ledger.value_days':
        'Tage, nach denen hinausgegangene Werte geleert werden; was bleibt, beweist sie weiterhin. Mit 0 nie.',
      'ledger.entry_days':
        'Tage, nach denen Einträge entfernt werden; ein unterschriebener Anker hält den Rest beweisbar. Mit 0 nie.',
      'ledger.witness_wait_s':
        'Sekunden nach einem Start, die Berichte höchstens auf die Auskunft der Plattform warten, dass das Logbuch das von ihr gegengezeichnete ist. Mit 0 keine.',
      'mapping.script.engine': 'Die Skriptmaschine: quickjs (Vorgabe), oder deno für V8.',
      'mapping.script.denoPath':
        'Das Programm Deno; ohne Angabe das des npm-Pakets neben diesem Programm.',
      'mapping.script.requireFilter':
        'Kein Skript ausführen, wo der Kern die Systemaufrufe seines Prozesses nicht filtert.',
      'mapping.script.userId':
        'Benutzer, unter dem Skripte laufen, wo der Connector als root läuft; geht das nicht, läuft kein Skript. 0 für root selbst.',
      'mapping.script.workers': 'Prozesse, die sich die Skripte teilen.',
      'mapping.script.callBudgetMs': 'Rechenzeit eines Aufrufs in Millisekunden.',
      'mapping.history.valuesPerVariableMax':
        'So viele letzte Werte einer benutzten Variablen bleiben im Speicher, um Zuordnungen daran auszuprobieren.',
      'mapping.history.valuesMax': 'Werte aller Variablen zusammen, etwa 100 Byte je Wert.',
      'mapping.history.keptValuesMax':
        'So viele davon überdauern einen Neustart; sie werden jede Minute neben den Speicher geschrieben. Keiner bei 0.',
      'admin.user_name': 'Der erste Benutzer, ein Ingenieur, angelegt beim ersten Start.',
      'admin.password':
        'Ohne Passwort wird eines erfunden und in eine Datei geschrieben, die nur der Eigentümer lesen kann.',
      'log.format': 'text oder json',
      'log.filter': 'Eine Stufe, oder Paare wie „factory_connector=debug,info“.',
    } as Record<string, string>,
    appearance: 'Darstellung und Sprache',
    session: 'Sitzung',
    signedInAs: 'Angemeldet als',
    role: 'Rolle',
    connector: 'Fabrikanbindung',
    factory: 'Fabrik',
    version: 'Version',
    started: 'Gestartet',
    twin: 'OPC-UA-Adresse des Zwillings',
    configuration:
      'Die Anbindung selbst wird in ihrer Konfigurationsdatei eingerichtet; hier steht, womit sie läuft.',
  },
}
