export const settings = {
  safety: {
    title: 'What protects',
    plaintext: 'Ways without TLS',
    noPlaintext: 'Nothing leaves this machine without TLS.',
    withoutTls: (key: string, address: string) =>
      `WITHOUT TLS, as allowed by name: ${key}, ${address}. Anybody on the way reads passwords and values.`,
    sealingKey: 'Key of the passwords',
    keyBesideStore:
      'BESIDE THE STORE: a copy of the data directory has the passwords. Pass the key as a credential of the service manager, or set sealing.key_file to a file on another medium.',
    keyApart: 'Not in the folder of the store.',
    workers: 'Workers of scripts',
    worker: {
      none: 'None was started yet.',
      purpose: { mappings: 'Scripts of mappings', dryRuns: 'Scripts that are tried' },
      filtered: 'System calls are filtered.',
      unfiltered: 'System calls are NOT filtered; a setting allows that.',
      refused: 'It does not run: the machine gives it no walls, or none that suffice.',
      landlock: {
        none: 'The kernel has no Landlock.',
        partial: 'Landlock denies files and network, in part.',
        full: 'Landlock denies files, network and other processes.',
      },
      ownUser: (id: number) => `Runs as a user of its own (user ${id}).`,
      sharedUser: 'Runs as the connector’s user.',
      root: 'Runs as ROOT: a script that breaks its engine has this machine. A setting allows that.',
      limited: 'Memory, files and processes are bounded.',
      unlimited: 'Memory, files and processes are NOT bounded.',
    },
  },
  settings: {
    title: 'Settings',
    subtitle: 'This page, this session, and what the connector runs with',
    file: 'Configuration',
    isSet: 'Set',
    byDefault: 'otherwise',
    default: 'The default',
    absent: 'Not set',
    hidden: 'Set, not shown',
    sections: {
      '': 'General',
      sealing: 'Sealing of passwords',
      web: 'Pages and API',
      'web.tls': 'TLS of the pages',
      'web.share_per_person': 'Each person’s share of the pages',
      twin: 'Twin',
      'twin.security': 'Security of the twin',
      'twin.limits': 'Limits of the twin',
      'twin.discovery': 'Finding the twin',
      enrolment: 'Enrolment',
      broker: 'Way to the broker',
      'broker.client_certificate': 'Certificate at the broker',
      'broker.proxy': 'Proxy on the way',
      reports: 'Reports',
      spool: 'Spool',
      ledger: 'Ledger',
      'mapping.script': 'Scripts',
      'mapping.history': 'Recorded values',
      admin: 'First user',
      log: 'Log',
    } as Record<string, string>,
    /** Texts by the path of a key. */
    meaning: {
      data_directory:
        'Where the durable file, keys and certificates live. On a local disk; back it up as a whole.',
      allow_shared_data_directory:
        'Use that folder although group or others may enter it; the files in it are the user’s alone in either case.',
      'sealing.key_file':
        'File of the key that seals the passwords in the store. Default: a file beside the store, which protects copies of the store alone.',
      'web.allow_plaintext':
        'Plain HTTP with other machines, where anybody on the way reads passwords.',
      'enrolment.allow_plaintext':
        'Send the enrolment token to a platform on another machine without TLS.',
      'broker.allow_plaintext':
        'Speak with a broker on another machine without TLS, the one told at enrolment included.',
      'broker.proxy.allow_plaintext':
        'Send user name and password to a proxy on another machine, which they reach without TLS: anybody on the way reads them.',
      'web.listen': 'Where pages and API listen.',
      'web.public_url':
        'Address for browsers, as where a proxy speaks TLS. With https the session’s cookie is for TLS only. Passkeys need a domain name here, and HTTPS.',
      'web.trusted_proxies':
        'Proxies in front of the pages. They alone are believed about the address of their client. Those on other machines need TLS here, too; without it an open listener serves these proxies alone.',
      'web.forwarded_header': 'Header in which the proxies tell that address.',
      'web.share_per_person.requests_per_second':
        'Requests of one person per second, for long. Beyond it they are refused for a while.',
      'web.share_per_person.requests_at_once': 'Requests of one person at once, after a pause.',
      'web.share_per_person.downloads':
        'Exports, audits and verifications of one person at the same time.',
      'web.share_per_person.streams':
        'Live streams of one person at the same time; each open page has one.',
      'web.share_per_person.body_mib':
        'MiB that one person may send at the same time, over all its requests.',
      'web.tls.certificate':
        'Certificate as PEM. Without certificate and key plain HTTP, for this machine only or behind a proxy on it that speaks TLS.',
      'web.tls.key': 'Key as PEM.',
      'twin.listen': 'Where the OPC UA server with the interfaces of the operations listens.',
      'twin.host_names':
        'Names and addresses under which OPC UA clients reach this machine, for its certificate. Default: its own name.',
      'twin.security.allow_anonymous_unencrypted':
        'Development only: also an endpoint without encryption and user, in the viewer role.',
      'twin.security.allow_signed_unencrypted':
        'Also endpoints that sign only, for clients without encryption. Everybody on the way reads values and writes.',
      'twin.security.trust_unknown_certificates':
        'Development only: trust every client certificate instead of waiting for an approval.',
      'twin.security.login_failures_max':
        'Wrong passwords a user may give within the window before further attempts are refused for as long.',
      'twin.security.login_window_s': 'The window for wrong passwords, in seconds.',
      'twin.security.certificate_renewal_days':
        'Days before its end at which the twin’s own certificate is renewed.',
      'twin.security.certificate_validity_days': 'Days for which a renewed certificate is valid.',
      'twin.limits.sessions_max': 'Sessions of OPC UA clients at a time.',
      'twin.limits.sessions_per_client_max': 'Sessions of one user of OPC UA clients at a time.',
      'twin.limits.connections_max': 'Connections of OPC UA clients at a time.',
      'twin.limits.connections_per_address_max': 'Connections from one address at a time.',
      'twin.limits.subscriptions_per_client_max': 'Subscriptions of one user.',
      'twin.limits.monitored_items_per_client_max': 'Monitored items of one user.',
      'twin.limits.monitored_items_per_subscription_max': 'Monitored items of one subscription.',
      'twin.limits.publishing_interval_ms_min': 'Shortest publishing interval, in milliseconds.',
      'twin.limits.publishing_tick_ms':
        'How often due subscriptions are looked for, in milliseconds.',
      'twin.discovery.local_discovery_server_url':
        'A local discovery server to register with. Approve its certificate like that of a client.',
      'twin.discovery.registration_interval_s':
        'How often the twin registers there, in seconds: discovery servers forget what was silent for ten minutes.',
      'twin.discovery.announce_by_multicast_dns':
        'Announce the twin in the local network by multicast DNS.',
      'broker.url':
        'Another way to the platform’s broker than the one told at enrolment: amqps://host:5671, or a WebSocket where the firewall lets nothing but HTTPS out, amqp+wss://host. The protocol stays the same.',
      'broker.root_certificates':
        'PEM file with the authorities that may vouch for the broker. Default: the authority told at enrolment.',
      'broker.client_certificate.certificate':
        'Certificate as PEM, leaf first, by which the connector is known to a broker that asks for one, beside user name and password.',
      'broker.client_certificate.key':
        'Its key as PEM, for the connector’s user alone. Both are read at the start.',
      'broker.proxy.url':
        'The HTTP proxy on the way out; it must let CONNECT through to the broker’s port.',
      'broker.proxy.user_name': 'Who the connector is to the proxy, where it asks.',
      'broker.proxy.password': 'The password at the proxy.',
      'reports.encoding':
        'How values are written: digicor (1.04 reversible), 1.05-compact or 1.05-verbose.',
      'reports.publishing_interval_ms':
        'The shortest time between two reports of one data set, in milliseconds. Policies lengthen it, field by field.',
      'spool.bytes_max':
        'Bytes of reports at which older ones are given up for newer ones; the gap is announced.',
      'spool.age_hours_max': 'Age at which reports are given up, in hours.',
      'spool.resend_after_s':
        'Seconds without the platform’s receipt after which a report is sent again; doubles each time, up to an hour.',
      'spool.replay_share_percent':
        'Share of the reports that a backlog gets while new ones wait, in percent, 1 to 99. While no new ones wait, it has all.',
      'ledger.value_days':
        'Days after which values that left are emptied; what remains still proves them. For ever with 0.',
      'ledger.entry_days':
        'Days after which entries are removed; a signed anchor keeps the rest provable. For ever with 0.',
      'ledger.witness_wait_s':
        'Seconds after a start for which reports wait at most for the platform’s word that the ledger is the one it countersigned. None with 0.',
      'mapping.script.engine': 'The script engine: quickjs (the default), or deno for V8.',
      'mapping.script.denoPath':
        'The Deno executable; without it the one of the npm package beside this program.',
      'mapping.script.requireFilter':
        'Run no script where the kernel does not filter the system calls of its worker.',
      'mapping.script.userId':
        'User that workers run as where the connector runs as root; no script runs where that cannot be. 0 for root itself.',
      'mapping.script.workers': 'Worker processes that share the scripts.',
      'mapping.script.callBudgetMs': 'Computing time of one call, in milliseconds.',
      'mapping.history.valuesPerVariableMax':
        'Last values of a variable in use that are kept in memory, to try mappings on.',
      'mapping.history.valuesMax': 'Values of all variables together, about 100 bytes each.',
      'mapping.history.keptValuesMax':
        'So many of them outlast a restart; they are written beside the store each minute. None with 0.',
      'admin.user_name': 'The first user, an engineer, made at the first start.',
      'admin.password':
        'Without a password one is made up and written to a file that only its owner can read.',
      'log.format': 'text or json',
      'log.filter': 'A level, or pairs as “factory_connector=debug,info”.',
    } as Record<string, string>,
    appearance: 'Appearance and language',
    session: 'Session',
    signedInAs: 'Signed in as',
    role: 'Role',
    connector: 'Connector',
    factory: 'Factory',
    version: 'Version',
    started: 'Started',
    twin: 'OPC UA address of the twin',
    configuration:
      'The connector itself is set up in its configuration file; this page shows what it runs with.',
  },
}
