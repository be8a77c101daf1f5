// Generated from openapi.json by `npm run generate`. Do not edit.

export interface paths {
    "/audit-entries": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists who changed what, newest first: to planners what their organisation did and what was done to its
         *     people, factories and tools, to administrators all.
         */
        get: operations["listAuditEntries"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/audit-entries/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Exports the same, oldest first, as a JSON object per line. */
        get: operations["exportAuditEntries"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/collaborations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the collaborations of the viewer's organisation; administrators see all. */
        get: operations["listCollaborations"];
        put?: never;
        /** Adds a collaboration. */
        post: operations["addCollaboration"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/collaborations/{collaborationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Removes a collaboration of which every network is withdrawn: its members and factories part in it. */
        delete: operations["removeCollaboration"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/collaborations/{collaborationId}/factories/{factoryId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds a factory; has no effect if it takes part. */
        put: operations["addCollaborationFactory"];
        post?: never;
        /**
         * Takes a factory out of a collaboration in which it performs nothing. Planners take factories of their organisation
         *     out within ten minutes of a sign-in.
         */
        delete: operations["removeCollaborationFactory"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/collaborations/{collaborationId}/members/{organisationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds a member; has no effect if it is one. */
        put: operations["addMember"];
        post?: never;
        /**
         * Takes a member out of a collaboration in which nothing of it is in force. What was released to it stays
         *     readable to it. Planners take their own organisation out within ten minutes of a sign-in.
         */
        delete: operations["removeMember"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/dead-letters": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists dead letters, newest first; those of the embedded broker come with the first page. For
         *     administrators.
         */
        get: operations["listDeadLetters"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/dead-letters/{deadLetterId}/replay": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Tries a dead letter again: one of ingest is taken as if it arrived now, one of the broker goes
         *     back to its queue. One that a broker of another make set aside (`dead-letters`) stays as it is: that broker does not
         *     say whose it was.
         */
        post: operations["replayDeadLetter"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/enrolments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Uses a token up. Of a factory's credentials the newest two are alive. */
        post: operations["enrol"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the factories of the viewer's organisation and of its collaborations; administrators see
         *     all.
         */
        get: operations["listFactories"];
        put?: never;
        /** Adds a factory; its queues are made. */
        post: operations["addFactory"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes a factory that is in no collaboration any more: credentials, tokens and connections end. Planners remove
         *     factories of their organisation within ten minutes of a sign-in.
         */
        delete: operations["removeFactory"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/accesses": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists who read values of a factory, newest first: for members of its organisation. Further reads
         *     of the same values within a minute are one entry.
         */
        get: operations["listAccesses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/accesses/audit": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Exports a factory's access log as an audit file, a JSON object per line, which `asi access verify`
         *     checks against a checkpoint that was kept elsewhere: for members of its organisation.
         */
        get: operations["exportAccesses"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/accesses/checkpoint": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the newest checkpoint of a factory's access log, which covers all entries but those of the
         *     last minute: for members of its organisation.
         */
        get: operations["showAccessCheckpoint"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/credentials": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Takes credentials and signing keys of the factory's connector away and cuts its connections. */
        delete: operations["revokeFactoryCredentials"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/enrolment-tokens": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Makes a single-use token with which the factory's connector enrols. */
        post: operations["makeEnrolmentToken"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/lease": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows who speaks for a factory and who else asked to: for its own organisation and
         *     administrators.
         */
        get: operations["showLease"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/lease/handovers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Gives the lease to a connector that was refused, as when the old machine is gone for good. The
         *     former holder is refused from now on.
         */
        post: operations["handLeaseOver"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/ledger-logs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the logs of a factory's ledger with their countersigned checkpoints: for a recipient those
         *     about what it gets, for the factory's own organisation all.
         */
        get: operations["listLedgerLogs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/factories/{factoryId}/writers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists a factory's data set writers with received sequence numbers: all for its own organisation
         *     and administrators; for recipients those whose reports they get, so that they can tell silence
         *     from reports that are missing or were given up. Numbers, times and gaps are those of the reports
         *     that were released to the viewer; what others are sent changes nothing in them. A page has at most 100.
         */
        get: operations["listWriters"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/live": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Streams server-sent events (HTML living standard §9.2). Of each event, the schema's `event` is
         *     the line `event:`, and its `data` is the JSON of the line `data:`.
         */
        get: operations["streamLive"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the networks of which the viewer sees anything, by id. */
        get: operations["listOperationNetworks"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows what the viewer sees of a network: operations, parts, progress and fields. Its own
         *     operations, those it drew and those of which a field is open to it are whole; those it asks about are
         *     shown in part, its neighbours as stubs.
         */
        get: operations["showOperationNetwork"];
        /**
         * Puts a network in place of what the author sees of it; each factory whose part differs is sent
         *     it. What is hidden stays as it is, and what belongs to others must come back as it was shown: it
         *     is compared member by member. `If-Match` with the revision guards against overwriting another
         *     author's change. The same network again changes nothing.
         */
        put: operations["putOperationNetwork"];
        post?: never;
        /** Withdraws a network of the own organisation: its nodes and mappings go at every factory. */
        delete: operations["withdrawOperationNetwork"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/comments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the comments on a network that the viewer may read, oldest first: about a request for its
         *     requester and the factory, about the network for its drawer and the factory.
         */
        get: operations["listComments"];
        put?: never;
        /** Adds a comment; it is sent to the factory. */
        post: operations["addComment"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/operations/{operationId}/requests": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Adds a dynamic data request to an operation: a new revision goes to its factory. */
        post: operations["addDynamicDataRequest"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/operations/{operationId}/requests/{dynamicDataRequestId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes a dynamic data request of the own organisation: nodes and mappings go at the factory,
         *     the history stays.
         */
        delete: operations["removeDynamicDataRequest"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/revocations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the signed receipts of revocations about requests of a network, oldest first: for those who
         *     received the values, and for the factory. `asi ledger receipt` verifies one.
         */
        get: operations["listRevocations"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/organisations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the organisations that the viewer shares a collaboration with; administrators see all. */
        get: operations["listOrganisations"];
        put?: never;
        /** Adds an organisation. */
        post: operations["addOrganisation"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/organisations/{organisationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Removes an organisation of which nothing is left in force, with its people. */
        delete: operations["removeOrganisation"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/reports": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the reports that their factories released to the viewer, in the order of their arrival. The
         *     factories can see that: as looked at where `newest` is set and at most 300 are wanted, else as
         *     exported.
         */
        get: operations["listReports"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Says who is signed in. */
        get: operations["showSession"];
        put?: never;
        /** Signs in; the answer sets the session's cookie. */
        post: operations["signIn"];
        /** Signs out. */
        delete: operations["signOut"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/passkeys": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the own passkeys. */
        get: operations["listPasskeys"];
        /** Adds a passkey that a browser made; the answer has recovery codes where it is the first second factor. */
        put: operations["addPasskey"];
        /** Makes the options with which a browser makes a passkey. */
        post: operations["beginPasskey"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/passkeys/{passkeyId}/removal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Removes one of the own passkeys. */
        post: operations["removePasskey"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/password": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Changes the own password; the person's other sessions end. */
        put: operations["changePassword"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/second-factor": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Says whether signing in takes a code. */
        get: operations["showSecondFactor"];
        /** Turns the second factor on with a code of the app; the answer has the recovery codes. */
        put: operations["confirmSecondFactor"];
        /** Makes a secret for an authenticator app, which counts once it is confirmed. */
        post: operations["beginSecondFactor"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/second-factor/removal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Turns the own second factor off. */
        post: operations["removeSecondFactor"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sessions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the own sessions. */
        get: operations["listSessions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sessions/{sessionId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Ends one of the own sessions. */
        delete: operations["endSession"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Shows the status of the platform. */
        get: operations["showStatus"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/tools": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the tools of the viewer's organisation; administrators see all. */
        get: operations["listTools"];
        put?: never;
        /** Adds a tool; its queues are made. */
        post: operations["addTool"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/tools/{toolId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes a tool: credentials and connections end, and it gets no more reports. Planners remove tools of their
         *     organisation within ten minutes of a sign-in.
         */
        delete: operations["removeTool"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/tools/{toolId}/credentials": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Makes a credential for a tool; the newest two are alive. */
        post: operations["makeToolCredential"];
        /** Takes all credentials of a tool away and cuts its connections. */
        delete: operations["revokeToolCredentials"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the people with an account, by name. */
        get: operations["listUsers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds or replaces a user; the user's sessions end. */
        put: operations["putUser"];
        post?: never;
        /**
         * Removes a person: the sessions end. The last administrator stays. People end their own accounts within ten minutes
         *     of a sign-in.
         */
        delete: operations["removeUser"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/second-factor": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Removes the second factor of a person who has lost it, passkeys included. */
        delete: operations["resetSecondFactor"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/sessions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the sessions of a person. */
        get: operations["listUserSessions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/sessions/{sessionId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Ends a session of a person. */
        delete: operations["endUserSession"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /** @description Values of one request that one agent got in one way. */
        Access: components["schemas"]["Agent"] & components["schemas"]["RequestKey"] & {
            access: components["schemas"]["AccessKind"];
            /** @description Names of the fields. */
            fields: string[];
            /** @description Time of the first read that the entry counts; the last was at the time of the entry or before. */
            since: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Number of values; one that was read twice counts twice.
             */
            valueCount: number;
            valuesFrom?: components["schemas"]["DateTime"] | null;
            valuesTo?: components["schemas"]["DateTime"] | null;
            /** @description Organisation that got the values. */
            viewer: components["schemas"]["OrganisationId"];
        };
        /** @description A signed statement of the size and the root of a factory's access log. */
        AccessCheckpointView: {
            /** @description The checkpoint, a C2SP signed note; absent in the first minute of a log. */
            checkpoint?: string | null;
            retention?: components["schemas"]["AccessRetentionEntry"] | null;
            /**
             * @description The key that signed it, as `name+id+key`. Note it once, and keep checkpoints where the
             *     platform cannot change them.
             */
            verifierKey: string;
        };
        /**
         * @description Way by which values were handed out.
         * @enum {string}
         */
        AccessKind: "LOOKED" | "STREAMED" | "EXPORTED" | "FORWARDED";
        /** @description Statement in a log about what retention removed from it. What is missing without one is a fault. */
        AccessRetention: {
            before?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int64
             * @description Number of entries that are kept; of `COUNT` only.
             */
            kept?: number | null;
            /**
             * Format: int64
             * @description Number of the last entry that was removed, with all before it.
             */
            removedThrough: number;
            rule: components["schemas"]["AccessRetentionRule"];
        };
        /** @description The entry of a statement, whose canonical text is a leaf of the tree. */
        AccessRetentionEntry: {
            factoryId: components["schemas"]["FactoryId"];
            /**
             * Format: int64
             * @description Number in the log, from 1 without gaps.
             */
            number: number;
            recordedAt: components["schemas"]["DateTime"];
            retention: components["schemas"]["AccessRetention"];
        };
        /**
         * @description Rule by which the oldest entries are removed.
         * @enum {string}
         */
        AccessRetentionRule: "AGE" | "COUNT" | "FORMER_VERSION";
        /** @description An entry of the record of who read a factory's values. */
        AccessView: components["schemas"]["Access"] & {
            /** @description Name of the person or tool; for the own organisation's only. */
            agentName?: string | null;
            /**
             * Format: int64
             * @description Number in the log, from 1 without gaps.
             */
            number: number;
            recordedAt: components["schemas"]["DateTime"];
        };
        /** @description A comment to add. */
        AddComment: {
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            /** @description The factory that the comment is for; one that has a part in the network. */
            factoryId: components["schemas"]["FactoryId"];
            fieldName?: components["schemas"]["FieldName"] | null;
            /** @description Text, 1 to 10000 characters. */
            text: string;
        };
        /** @description Person or tool that read for an organisation, under a pseudonym. */
        Agent: {
            /** @description Random id, the same in all entries of one factory; another at each factory. */
            agentId: string;
            agentKind: components["schemas"]["AgentKind"];
            /** @description Role of a user at the time; absent for tools. */
            role?: string | null;
        };
        /**
         * @description Nature of an agent: a person or a program.
         * @enum {string}
         */
        AgentKind: "USER" | "TOOL";
        /** @description Aggregate of the values of a window. */
        AggregateStatement: {
            /**
             * @description The aggregate in words: the last value, the maximum, the minimum, the sum, the mean over
             *     time.
             */
            function: string;
            /**
             * Format: int64
             * @description Length of a window in milliseconds; windows are multiples of it since 1970.
             */
            windowMs: number;
        };
        /** @description A concrete asset of a factory, as in its status data sets (OPC 10000-100 AssetId). */
        AssetId: string;
        /**
         * @description Kind of person or program that makes a change.
         * @enum {string}
         */
        AuditAgentKind: "USER" | "TOOL" | "FACTORY" | "COMMAND";
        /** @description An entry as a viewer may see it. */
        AuditEntry: {
            agentKind: components["schemas"]["AuditAgentKind"];
            /** @description Name of the person or program, for its own organisation and administrators. */
            agentName?: string | null;
            /** @description Ids, roles and numbers that operation and subject do not say, for who acted and whom it concerns. */
            detail: components["schemas"]["AuditFact"][];
            entryId: components["schemas"]["OpaqueId"];
            /**
             * @description Id of the operation in the description of the API, as `putUser`, or name of what a connector did, as
             *     `decideField`.
             */
            operation: string;
            organisationId?: components["schemas"]["OrganisationId"] | null;
            outcome: components["schemas"]["AuditOutcome"];
            recordedAt: components["schemas"]["DateTime"];
            /** @description Place of what it was about, as `factories/FOR_MUC`. */
            subject: string;
        };
        /** @description Fact of an entry. Never a secret, and never a value of a plant. */
        AuditFact: {
            /** @description Name, id or number before; absent where there was none. */
            former?: string | null;
            kind: components["schemas"]["AuditFactKind"];
            /** @description Name, id or number since; absent where there is none any more. */
            present?: string | null;
        };
        /**
         * @description Thing of which a fact says how it was and is.
         * @enum {string}
         */
        AuditFactKind: "ROLE" | "ORGANISATION" | "PASSWORD" | "SECOND_FACTOR" | "PERSON" | "MEMBER" | "FACTORY" | "REQUEST" | "REVISION" | "STATE" | "RECIPIENT" | "REPORTS" | "HOST" | "CREDENTIALS" | "SIGNING_KEY" | "ADDRESS" | "FURTHER";
        /**
         * @description Outcome of an operation.
         * @enum {string}
         */
        AuditOutcome: "DONE" | "UNCHANGED";
        /**
         * @description Numbers of rows and bytes in a spool, for the link's state and metrics. Parked rows are not
         *     counted.
         */
        Backlog: {
            /**
             * Format: int64
             * @description Bytes of waiting and sent rows.
             */
            bytes: number;
            /**
             * Format: date-time
             * @description Creation time of the oldest waiting or sent row.
             */
            oldestAt?: string | null;
            /**
             * Format: int64
             * @description Rows that are sent and wait for the receipt.
             */
            sent: number;
            /**
             * Format: int64
             * @description Rows that wait to be sent.
             */
            waiting: number;
        };
        /** @description Profile in a configuration: a name, or a table of templates. */
        BrokerProfile: string | components["schemas"]["BrokerTemplates"];
        /** @description Templates of a profile; each contains `{address}`, `{address:percent}` or `{address:path}`. */
        BrokerTemplates: {
            capability?: string | null;
            consume: string;
            name: string;
            produce: string;
        };
        /** @description Result of a change. */
        Changed: {
            /** @description False where nothing differed. */
            isChanged: boolean;
            /**
             * Format: int64
             * @description The revision in effect.
             */
            revision: number;
            /** @description The factories that were sent something, as far as the author may know of them. */
            sentTo: components["schemas"]["FactoryId"][];
        };
        /** @description A collaboration with its members and factories. */
        Collaboration: {
            collaborationId: components["schemas"]["CollaborationId"];
            /** @description Addition, by the platform's clock. */
            createdAt: components["schemas"]["DateTime"];
            /** @description The factories that take part, by id. */
            factories: components["schemas"]["FactoryId"][];
            /** @description The organisations that take part, by id. */
            members: components["schemas"]["OrganisationId"][];
            /** @description Name for people. */
            name: string;
        };
        /** @description A collaboration on the platform, under whose agreement networks are exchanged. */
        CollaborationId: string;
        /**
         * @description A comment as those who take part see it: about a request its requester and the factory, about the
         *     network its drawer and the factory.
         */
        CommentEntry: {
            /** @description User name of the author; where a factory states it, with the factory: `engineer@FOR_MUC`. */
            authorId: string;
            commentId: components["schemas"]["OpaqueId"];
            /** @description Time of arrival at the platform. */
            createdAt: components["schemas"]["DateTime"];
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            /** @description The factory with whose people the comments are exchanged. */
            factoryId: components["schemas"]["FactoryId"];
            fieldName?: components["schemas"]["FieldName"] | null;
            /** @description True if it came from the factory's connector. */
            isFromFactory: boolean;
            text: string;
        };
        /** @description A condition of a relation, unique within its network. */
        ConditionId: string;
        /**
         * @description The kinds of condition.
         * @enum {string}
         */
        ConditionKind: "START_NO_EARLIER_THAN" | "START_NO_LATER_THAN" | "FINISH_NO_EARLIER_THAN" | "FINISH_NO_LATER_THAN" | "MINIMUM_GAP" | "MAXIMUM_GAP";
        /** @description A connected peer. */
        ConnectionStatus: {
            /** @description Remote address of the TCP connection. */
            peer: string;
            /**
             * Format: date-time
             * @description Time of the sign-in.
             */
            since: string;
            /** @description Name of the signed-in user. */
            userName: string;
        };
        /**
         * Format: date-time
         * @description An instant in UTC with a resolution of 100 ns. On the wire an RFC 3339 text.
         */
        DateTime: string;
        /** @description A message that could not be used. */
        DeadLetterView: {
            /** @description Logical address it was sent to. */
            address: string;
            /** @description Time of the dead-lettering. */
            at: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Size of the body.
             */
            bytes: number;
            /** @description A stable code, as `FORGED_PUBLISHER`. */
            code: string;
            /** @description `ingest-<number>` or `broker-<number>`. */
            id: string;
            messageId?: string | null;
            /** @description Reason in a sentence for people. */
            reason: string;
            replayedAt?: components["schemas"]["DateTime"] | null;
            subject?: string | null;
        };
        /** @description Coarsening of a value before it leaves, in words and numbers. */
        DisclosureStatement: {
            aggregate?: components["schemas"]["AggregateStatement"] | null;
            /** @description Values are these bounds: of each the greatest not above it, in the field's unit. */
            bandList?: number[];
            /**
             * Format: int64
             * @description Values leave this many milliseconds late.
             */
            delayMs?: number | null;
            /** @description One sentence for people. */
            description: string;
            /** @description Values leave within these hours only; all of them hold. */
            hoursList?: components["schemas"]["HoursStatement"][];
            /** @description True where no value leaves in certain states; the states themselves are not disclosed. */
            isWithheldInStates?: boolean;
            /**
             * Format: int64
             * @description At most one value per this many milliseconds.
             */
            minimumIntervalMs?: number | null;
            /** @description At most so many values per period; all of these hold. */
            rateLimitList?: components["schemas"]["RateStatement"][];
            /**
             * Format: double
             * @description Values are rounded to multiples of this, in the field's unit.
             */
            roundingStep?: number | null;
            /**
             * Format: int32
             * @description Values have at most so many significant digits.
             */
            significantDigits?: number | null;
            statusCodes?: components["schemas"]["StatusResolution"] | null;
            /**
             * Format: int64
             * @description Times are rounded down to multiples of this many milliseconds.
             */
            timeStepMs?: number | null;
        };
        /**
         * @description Room on the disk of the embedded broker.
         * @enum {string}
         */
        DiskState: "ENOUGH" | "SHORT" | "FULL";
        /** @description A partner's request for data about an operation. One request is one DataSetWriter. */
        DynamicDataRequest: {
            /** @description The buffer or store the request is about. */
            bufferId?: string | null;
            /** @description More about the request. */
            description?: string | null;
            /** @description Unique within the network. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            dynamicDataRequestPublisherId?: components["schemas"]["ToolId"] | null;
            /** @description Purpose of the data in words, for the factory's engineer. */
            purpose: string;
            /** @description The organisations that may see the answers, and no others. */
            recipientList: components["schemas"]["OrganisationId"][];
            /** @description The composition of the report. */
            reportDataFormat: components["schemas"]["ReportDataFormat"];
            /** @description The organisation that asks. */
            requesterId: components["schemas"]["OrganisationId"];
            /**
             * Format: int32
             * @description Number of reports wanted per [`Self::update_frequency_unit`].
             */
            updateFrequency?: number | null;
            updateFrequencyUnit?: components["schemas"]["UpdateFrequencyUnit"] | null;
            validFrom?: components["schemas"]["DateTime"] | null;
            validUntil?: components["schemas"]["DateTime"] | null;
        };
        /** @description A dynamic data request, unique within its network. One request is one DataSetWriter. */
        DynamicDataRequestId: string;
        /** @description A token from `POST /factories/{factoryId}/enrolment-tokens`. */
        Enrol: {
            /** @description Ed25519 key that signs the connector's messages, as `x` of its JWK; absent where none does. */
            signingKey?: string | null;
            token: string;
        };
        /** @description Endpoint and credential of a connector, shown this once. */
        Enrolment: {
            /** @description The broker's address. */
            brokerUrl: string;
            factoryId: components["schemas"]["FactoryId"];
            /** @description The connector's own secret. */
            password: string;
            /** @description Names of logical addresses at this broker. */
            profile: components["schemas"]["BrokerProfile"];
            /** @description The authority that vouches for the broker; absent where the system's roots do. */
            rootCertificatePem?: string | null;
            /** @description The name to sign in with. */
            userName: string;
        };
        /** @description Equipment that an operation needs. */
        EquipmentRequirement: {
            assetId?: components["schemas"]["AssetId"] | null;
            /** @description IRI of a capability the equipment must have. */
            capability?: string | null;
            /** @description Unique within the network. */
            equipmentRequirementId: components["schemas"]["EquipmentRequirementId"];
            /** @description The class of equipment, as `ROBOT`. */
            equipmentType: string;
            /**
             * Format: double
             * @description Number of pieces of equipment, not negative.
             */
            quantity?: number | null;
        };
        /** @description An equipment requirement, unique within its network. */
        EquipmentRequirementId: string;
        /** @description A factory: one connector, with the evidence of its life. */
        Factory: {
            /** @description Addition, by the platform's clock. */
            createdAt: components["schemas"]["DateTime"];
            enrolledAt?: components["schemas"]["DateTime"] | null;
            /** @description Its id, also its PublisherId and part of its addresses. */
            factoryId: components["schemas"]["FactoryId"];
            lastReportAt?: components["schemas"]["DateTime"] | null;
            lastSeenAt?: components["schemas"]["DateTime"] | null;
            /** @description Name for people. */
            name: string;
            organisationId: components["schemas"]["OrganisationId"];
            /** @description State that its publisher reported last (`ua-status`), for example `Operational`. */
            publisherState?: string | null;
        };
        /** @description A factory: one connector, one PublisherId, one pair of addresses on the broker. */
        FactoryId: string;
        /** @description Fault of a message that a partner can mend. */
        Fault: {
            /** @description A stable code, as `UNKNOWN_OPERATION`. */
            code: string;
            /** @description A sentence that says what is wrong and what to do. */
            message: string;
            /** @description JSON pointer (RFC 6901) into the message; empty for the whole. */
            pointer: string;
        };
        /** @description One report field, addressed from the network down. */
        FieldKey: components["schemas"]["RequestKey"] & {
            /** @description The field's name within that report. */
            fieldName: components["schemas"]["FieldName"];
        };
        /** @description The name of a report field: a key of the payload. */
        FieldName: string;
        /** @description An OPC UA built-in type: its id (1 to 25) or its name. */
        FieldType: number | ("Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo");
        /** @description A newer value of a field. */
        FieldUpdate: {
            /** Format: int32 */
            epoch: number;
            key: components["schemas"]["FieldKey"];
            /** @description Time of arrival at the platform. */
            receivedAt: components["schemas"]["DateTime"];
            reportTimestamp?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description The report's sequence number.
             */
            sequence: number;
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /** @description Its quality, by the standard's name. */
            status: string;
            /** @description The value; 64-bit integers are texts. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description A field with its decision and newest value. */
        FieldView: {
            decidedAt?: components["schemas"]["DateTime"] | null;
            disclosure?: components["schemas"]["DisclosureStatement"] | null;
            /**
             * Format: int32
             * @description The writer's epoch.
             */
            epoch?: number | null;
            /** @description The factory that is asked. */
            factoryId: components["schemas"]["FactoryId"];
            key: components["schemas"]["FieldKey"];
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            reason?: string | null;
            receivedAt?: components["schemas"]["DateTime"] | null;
            reportTimestamp?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description The report's sequence number.
             */
            sequence?: number | null;
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /** @description Its quality, by the standard's name. */
            status?: string | null;
            /** @description The newest value; 64-bit integers are texts. */
            value?: components["schemas"]["PlainValue"];
            /** @description Its OPC UA built-in type, by name. */
            valueType?: string | null;
        };
        /**
         * @description Reason for sequence numbers that will never come.
         * @enum {string}
         */
        GapCause: "COALESCED" | "EXPIRED" | "WITHDRAWN" | "REVOKED";
        /** @description An announced gap. */
        GapView: {
            /** @description `COALESCED`, `EXPIRED`, `WITHDRAWN` or `REVOKED`. */
            cause: components["schemas"]["GapCause"];
            /** Format: int32 */
            firstSequence: number;
            /**
             * @description True where several gaps were merged into one, since they were too many; some of the numbers may be
             *     held.
             */
            isCoarse: boolean;
            /** Format: int32 */
            lastSequence: number;
        };
        /** @description The next holder of a lease. */
        Handover: {
            /** @description One of the contenders. */
            instanceId: components["schemas"]["InstanceId"];
        };
        /** @description Hours of the plant's clock. */
        HoursStatement: {
            /** @description The days, `MONDAY` to `SUNDAY`. */
            dayList: string[];
            /** @description The first minute, `HH:MM`. */
            from: string;
            /** @description The first minute no more, `HH:MM`. */
            until: string;
            /**
             * Format: int32
             * @description Offset of the plant's clock from UTC, in minutes; positive to the east.
             */
            utcOffsetMinutes?: number;
        };
        /** @description A running connector: a new id at every start. */
        InstanceId: string;
        /**
         * Format: duration
         * @description An ISO 8601 duration of fixed length: weeks, days, hours, minutes, seconds (`PT8H`, `P1DT30M`).
         *     Years and months have no fixed length and are refused. Digits beyond the microsecond are dropped
         *     on reading: as OPC UA's Duration, a Double of milliseconds, a hundred years stay exact to that.
         */
        IsoDuration: string;
        /** @description Lease of a factory with the connectors that were refused. */
        LeaseView: {
            /** @description Connectors that were refused, the last heard first. */
            contenders: components["schemas"]["Party"][];
            holder?: components["schemas"]["Party"] | null;
            /**
             * Format: int64
             * @description Counts up whenever the lease passes to another place; 0 while nobody has asked for it.
             */
            leaseNumber: number;
        };
        /** @description Log of what a factory discloses to one organisation. */
        LedgerLogView: {
            /** @description The newest checkpoint, a C2SP signed note with the signatures of the log and of the platform. */
            checkpoint: string;
            /** @description Time of the platform's signature. */
            cosignedAt: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description Number of the log among those that replaced each other, from 1. The factory decided to replace
             *     one; its audit file says who, when and why.
             */
            epoch: number;
            /** @description Time at which it came. */
            firstSeenAt: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Number of leaves in the first checkpoint that the platform saw. Unless it is 1 or 2, entries
             *     were made before the platform watched the log, or the platform has lost what it held.
             */
            firstSize: number;
            /** @description Name of the log (C2SP tlog-checkpoint). */
            origin: string;
            /** @description The organisation whose values the log is about. */
            recipientId: components["schemas"]["OrganisationId"];
            refusedAt?: components["schemas"]["DateTime"] | null;
            /** @description The last checkpoint that was refused: it contradicts the newest one, or has another key. */
            refusedCheckpoint?: string | null;
            /**
             * Format: int64
             * @description Number of leaves in the newest checkpoint: the entries, and one for the beginning.
             */
            size: number;
            /** @description The key of the log, pinned with its first checkpoint: name, id and key. */
            verifierKey: string;
            /** @description The platform's key as a witness: name, id and key. */
            witnessKey: string;
        };
        /** @description Progress of a link towards a connection with a broker. */
        LinkPhase: {
            /** @enum {string} */
            state: "connecting";
        } | {
            /** @enum {string} */
            state: "up";
        } | {
            /**
             * @description True when a person must act (credentials, permissions, certificates) before an attempt
             *     can succeed.
             */
            isPermanent: boolean;
            /**
             * Format: date-time
             * @description Time of the next attempt.
             */
            retryAt: string;
            /** @enum {string} */
            state: "down";
        } | {
            /** @enum {string} */
            state: "stopped";
        };
        /** @description State of a link and the evidence for it. */
        LinkState: {
            /** @description Waiting and sent rows, as last counted. */
            backlog: components["schemas"]["Backlog"];
            /** @description Address of the broker that the phase is about. */
            broker: string;
            /**
             * Format: int64
             * @description Number of connections established so far.
             */
            connects: number;
            /**
             * Format: date-time
             * @description Time at which the broker last accepted a message.
             */
            lastAcceptedAt?: string | null;
            /**
             * Format: date-time
             * @description Time at which the last receipt of the platform arrived, as the owner reported.
             */
            lastReceiptedAt?: string | null;
            /**
             * Format: date-time
             * @description Time at which the last message was received.
             */
            lastReceivedAt?: string | null;
            phase: components["schemas"]["LinkPhase"];
            /** @description Cause for which the link is not up, or an obstacle though it is; a sentence for people. */
            reason?: string | null;
            /**
             * Format: date-time
             * @description Time at which the phase was entered.
             */
            since: string;
        };
        /** @description Live event: `event` is its name, `data` says what changed. */
        LiveEvent: {
            /** @description Newer values, brought by a report. */
            data: components["schemas"]["RequestKey"] & {
                factoryId: components["schemas"]["FactoryId"];
                /** @description The values, each as `GET /operation-networks/{operationNetworkId}` would show it now. */
                fields: components["schemas"]["FieldUpdate"][];
            };
            /** @enum {string} */
            event: "value";
        } | {
            /** @description Decision of the factory's engineer about a field. */
            data: {
                decidedAt: components["schemas"]["DateTime"];
                key: components["schemas"]["FieldKey"];
                /** @description `PENDING`, `MAPPED` or `REFUSED`. */
                mappingState: components["schemas"]["MappingState"];
                /** @description The engineer's reason; absent for whom the decision may not have been made. */
                reason?: string | null;
            };
            /** @enum {string} */
            event: "decision";
        } | {
            /** @description State of a factory's part after it was sent or answered. */
            data: {
                factoryId: components["schemas"]["FactoryId"];
                /** @description Faults for which it was rejected. */
                faultList: components["schemas"]["Fault"][];
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                /**
                 * Format: int64
                 * @description The part's revision; absent for those who may know the state alone.
                 */
                revision?: number | null;
                state: components["schemas"]["PartState"];
            };
            /** @enum {string} */
            event: "part";
        } | {
            /**
             * @description Sign of life of a factory: for its own organisation at most once a second, for others at most
             *     once a minute, unless its publisher's state changes.
             */
            data: {
                factoryId: components["schemas"]["FactoryId"];
                /** @description Time as `GET /factories` shows it to the same viewer. */
                lastSeenAt: components["schemas"]["DateTime"];
                /** @description State that its publisher reported last. */
                publisherState?: string | null;
            };
            /** @enum {string} */
            event: "factory";
        } | {
            /** @description Progress of an operation, as far as this audience may know. */
            data: components["schemas"]["OperationProgress"] & {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            };
            /** @enum {string} */
            event: "progress";
        } | {
            /** @description New revision of a network that changed what the viewer sees of it, or its withdrawal. */
            data: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                /** Format: int64 */
                revision: number;
            };
            /** @enum {string} */
            event: "network";
        } | {
            /** @description Comment that was added to a network. */
            data: {
                commentId: components["schemas"]["OpaqueId"];
                /** @description The network talked about. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            };
            /** @enum {string} */
            event: "comment";
        } | {
            /** @description Loss of events: more happened than the platform remembers, and the page loads afresh. */
            data: Record<string, never>;
            /** @enum {string} */
            event: "reset";
        };
        /**
         * @description State of a field's decision.
         * @enum {string}
         */
        MappingState: "PENDING" | "MAPPED" | "REFUSED";
        /** @description A network in a list. */
        NetworkSummary: {
            /** @description The collaboration it belongs to. */
            collaborationId: components["schemas"]["CollaborationId"];
            lastReportAt?: components["schemas"]["DateTime"] | null;
            /** @description Name for people. */
            name?: string | null;
            operationNetworkId: components["schemas"]["OperationNetworkId"];
            /**
             * Format: int64
             * @description Number of rejected parts that the viewer may know of.
             */
            partsRejected: number;
            /**
             * Format: int64
             * @description Number of parts that the viewer may know of and that wait for a factory's acknowledgement.
             */
            partsUnanswered: number;
            /**
             * Format: int64
             * @description The last revision that changed what the viewer sees of it.
             */
            revision: number;
            /** @description Time of that revision. */
            updatedAt: components["schemas"]["DateTime"];
            withdrawnAt?: components["schemas"]["DateTime"] | null;
        };
        /** @description A network with its parts, progress and fields. */
        NetworkView: {
            /** @description The collaboration it belongs to. */
            collaborationId: components["schemas"]["CollaborationId"];
            drawnBy?: components["schemas"]["OrganisationId"] | null;
            /** @description The fields that concern the viewer. */
            fields: components["schemas"]["FieldView"][];
            /**
             * @description The live event that this view includes: `GET /live` with it as `Last-Event-ID` misses
             *     nothing.
             */
            lastEventId: string;
            /**
             * @description The network as the viewer sees it (wire contract `operation-network`): neighbours'
             *     operations are stubs with plan times. Put back with changes, it leaves what is hidden as it
             *     is.
             */
            network: components["schemas"]["OperationNetwork"];
            /** @description Progress of each operation, derived from the viewer's fields. */
            operations: components["schemas"]["OperationProgress"][];
            /** @description Parts as sent to the factories of whose operations the viewer sees any. */
            parts: components["schemas"]["PartView"][];
            /**
             * Format: int64
             * @description The last revision that changed what the viewer sees.
             */
            revision: number;
            /** @description Time of that revision. */
            updatedAt: components["schemas"]["DateTime"];
            /**
             * @description The user or tool that made it, for its own organisation and administrators. Others are shown
             *     the organisation; absent where that is none.
             */
            updatedBy?: string | null;
            withdrawnAt?: components["schemas"]["DateTime"] | null;
        };
        /** @description A collaboration to add. */
        NewCollaboration: {
            collaborationId: components["schemas"]["CollaborationId"];
            /** @description The factories that take part. */
            factories?: components["schemas"]["FactoryId"][];
            /** @description The organisations that take part. */
            members?: components["schemas"]["OrganisationId"][];
            name: string;
        };
        /** @description A factory to add. */
        NewFactory: {
            factoryId: components["schemas"]["FactoryId"];
            /** @description Name for people; the id by default. */
            name?: string | null;
            organisationId: components["schemas"]["OrganisationId"];
        };
        /** @description An organisation to add. */
        NewOrganisation: {
            name: string;
            organisationId: components["schemas"]["OrganisationId"];
        };
        /** @description New passkey from a browser. */
        NewPasskey: {
            /** @description Credential that the browser made: `RegistrationResponseJSON` of WebAuthn Level 3. */
            credential: Record<string, never>;
            /** @description Name by which its owner knows it, at most 64 characters. */
            name: string;
        };
        /** @description A tool to add. */
        NewTool: {
            name: string;
            organisationId: components["schemas"]["OrganisationId"];
            toolId: components["schemas"]["ToolId"];
        };
        /** @description A random id, which says nothing of an order or a number. */
        OpaqueId: string;
        /** @description A production, inspection or transportation step. */
        Operation: components["schemas"]["OperationKind"] & {
            /** @description More about it. */
            description?: string | null;
            /** @description Data that partners request about the operation. */
            dynamicDataRequestList?: components["schemas"]["DynamicDataRequest"][];
            /** @description Equipment that the operation needs. */
            equipmentRequirementList?: components["schemas"]["EquipmentRequirement"][];
            /** @description Name for people, at most 256 characters. */
            name?: string | null;
            /** @description Unique within the network. */
            operationId: components["schemas"]["OperationId"];
            owningFactoryId?: components["schemas"]["FactoryId"] | null;
            plannedEnd?: components["schemas"]["DateTime"] | null;
            /**
             * Format: double
             * @description Planned quantity in [`Self::quantity_unit`], not negative.
             */
            plannedQuantity?: number | null;
            plannedStart?: components["schemas"]["DateTime"] | null;
            /** @description The unit of the planned quantity: a UNECE common code or one of its aliases (`PIECE`). */
            quantityUnit?: string | null;
            /** @description A neighbour's operation that a relation names: only type, id, name and owner. */
            stub?: boolean;
        };
        /** @description An operation, unique within its network. */
        OperationId: string;
        /** @description The three kinds of operation. */
        OperationKind: {
            /** @enum {string} */
            operationType: "PRODUCTION";
            /** @description Product, by the partners' own id. */
            productId?: string | null;
        } | {
            /** @description Characteristic that is measured or judged. */
            characteristic?: string | null;
            inspectedOperationId?: components["schemas"]["OperationId"] | null;
            /** @enum {string} */
            operationType: "INSPECTION";
        } | {
            /** @description Place that the material is brought to. */
            destination?: string | null;
            /** @enum {string} */
            operationType: "TRANSPORTATION";
            /** @description Place that the material leaves. */
            origin?: string | null;
        };
        /** @description A network of operations, or the part of it that concerns one factory. */
        OperationNetwork: {
            /** @description More about it. */
            description?: string | null;
            /** @description Name for people, at most 256 characters. */
            name?: string | null;
            /** @description The operations, stubs of neighbours included. */
            operationList: components["schemas"]["Operation"][];
            /** @description Unique on a platform. */
            operationNetworkId: components["schemas"]["OperationNetworkId"];
            /** @description The relations between them. */
            operationRelationList?: components["schemas"]["OperationRelation"][];
        };
        /** @description An operation network, unique on a platform. */
        OperationNetworkId: string;
        /** @description Progress of an operation, derived from the viewer's fields. */
        OperationProgress: {
            actualEnd?: components["schemas"]["DateTime"] | null;
            actualStart?: components["schemas"]["DateTime"] | null;
            expectedEnd?: components["schemas"]["DateTime"] | null;
            /**
             * Format: double
             * @description Good part of the quantity.
             */
            goodQuantity?: number | null;
            /** @description True where nobody reported the state and it is concluded from quantities and times. */
            isStateInferred: boolean;
            lastReportAt?: components["schemas"]["DateTime"] | null;
            operationId: components["schemas"]["OperationId"];
            owningFactoryId?: components["schemas"]["FactoryId"] | null;
            /**
             * Format: double
             * @description Completion, 0 to 100: as reported, else derived from the quantities.
             */
            percentComplete?: number | null;
            /** Format: double */
            plannedQuantity?: number | null;
            /**
             * Format: double
             * @description Produced quantity in `quantityUnit`; the good quantity if only that is reported.
             */
            quantity?: number | null;
            /** @description The unit of all quantities. */
            quantityUnit?: string | null;
            /**
             * Format: double
             * @description Scrap part of the quantity.
             */
            scrapQuantity?: number | null;
            state?: components["schemas"]["OperationState"] | null;
        };
        /** @description "The successor's start or finish depends on the predecessor's." */
        OperationRelation: {
            /** @description Bounds on the dependency. */
            conditionList?: components["schemas"]["RelationCondition"][];
            /** @description Unique within the network. */
            operationRelationId: components["schemas"]["OperationRelationId"];
            /** @description The operation that comes first. */
            predecessorOperationId: components["schemas"]["OperationId"];
            /** @description Ends of the two operations that the relation connects. */
            relationType: components["schemas"]["RelationType"];
            /** @description The operation that waits. */
            successorOperationId: components["schemas"]["OperationId"];
        };
        /** @description A relation between two operations, unique within its network. */
        OperationRelationId: string;
        /**
         * @description The state of an operation after the ISA-95 job states (OPC 10031-4).
         * @enum {string}
         */
        OperationState: "NotAllowedToStart" | "AllowedToStart" | "Running" | "Interrupted" | "Ended" | "Aborted";
        /** @description A company, institute or person that takes part. */
        Organisation: {
            /** @description Addition, by the platform's clock. */
            createdAt: components["schemas"]["DateTime"];
            /** @description Name for people. */
            name: string;
            organisationId: components["schemas"]["OrganisationId"];
        };
        /** @description An organisation that takes part in collaborations. */
        OrganisationId: string;
        /** @description A page of a list. */
        Page_AccessView: {
            items: components["schemas"]["AccessView"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_AuditEntry: {
            items: components["schemas"]["AuditEntry"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Collaboration: {
            items: components["schemas"]["Collaboration"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_CommentEntry: {
            items: components["schemas"]["CommentEntry"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_DeadLetterView: {
            items: components["schemas"]["DeadLetterView"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Factory: {
            items: components["schemas"]["Factory"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_LedgerLogView: {
            items: components["schemas"]["LedgerLogView"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_NetworkSummary: {
            items: components["schemas"]["NetworkSummary"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Organisation: {
            items: components["schemas"]["Organisation"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Report: {
            items: components["schemas"]["Report"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_RevocationEntry: {
            items: components["schemas"]["RevocationEntry"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Tool: {
            items: components["schemas"]["Tool"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_UserView: {
            items: components["schemas"]["UserView"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_WriterView: {
            items: components["schemas"]["WriterView"][];
            /** @description Cursor of the next page; absent on the last one. */
            nextCursor?: string | null;
        };
        /**
         * @description Progress of a part of a network towards its factory.
         * @enum {string}
         */
        PartState: "SENT" | "ACCEPTED" | "UNCHANGED" | "REJECTED";
        /** @description Part of a network as sent to a factory, with evidence of the factory's life. */
        PartView: {
            answeredAt?: components["schemas"]["DateTime"] | null;
            factoryId: components["schemas"]["FactoryId"];
            /** @description Name for people. */
            factoryName?: string | null;
            /** @description Faults for which it was rejected. */
            faultList: components["schemas"]["Fault"][];
            /** @description True where the part ends the network at the factory. */
            isWithdrawal: boolean;
            lastSeenAt?: components["schemas"]["DateTime"] | null;
            organisationId?: components["schemas"]["OrganisationId"] | null;
            /**
             * Format: int64
             * @description The revision in which its part changed last; like the faults, the times and the count below,
             *     for the factory's own organisation and the drawer of the network.
             */
            revision?: number | null;
            sentAt?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description Number of transmissions.
             */
            sentCount?: number | null;
            /** @description State at the factory. */
            state: components["schemas"]["PartState"];
        };
        /** @description A connector that holds the lease or has requested it. */
        Party: {
            /** @description Machine and folder of its store. */
            host: string;
            /** @description The running connector; another one at every start. */
            instanceId: components["schemas"]["InstanceId"];
            /**
             * @description True if the holder was heard after the first request: both run, and only an administrator can
             *     grant the lease.
             */
            isSecond?: boolean;
            /** @description Time of the last request. */
            lastHeardAt: components["schemas"]["DateTime"];
            /** @description Place of its store. */
            place: components["schemas"]["PlaceId"];
            /** @description Time of the grant, or of the first refused request. */
            since: components["schemas"]["DateTime"];
        };
        /** @description Password that a new passkey takes. */
        PasskeyBegin: {
            /** Format: password */
            password: string;
        };
        /** @description Passkeys of a person, the oldest first. */
        PasskeyList: {
            items: components["schemas"]["PasskeySummary"][];
            /** @description Reason why browsers make no passkeys for these pages, for people; absent where they do. */
            unavailable?: string | null;
        };
        /** @description Options with which a browser makes a passkey. */
        PasskeyOffer: {
            /**
             * @description Options of `navigator.credentials.create`: `PublicKeyCredentialCreationOptionsJSON` of WebAuthn Level 3.
             *     Their challenge is good once, for two minutes.
             */
            options: Record<string, never>;
        };
        /** @description Password with which a passkey is removed. */
        PasskeyRemoval: {
            /** Format: password */
            password: string;
        };
        /** @description A passkey, shown to its owner. */
        PasskeySummary: {
            /** Format: date-time */
            createdAt: string;
            /**
             * Format: date-time
             * @description Last sign-in with it.
             */
            lastUsedAt?: string | null;
            /** @description Name that its owner gave. */
            name: string;
            /** @description Name by which the passkey is removed. */
            passkeyId: string;
        };
        /** @description Present and new password. */
        PasswordChange: {
            /**
             * Format: password
             * @description At least ten characters.
             */
            newPassword: string;
            /** Format: password */
            presentPassword: string;
        };
        /**
         * @description The place where a connector's store is in use. Two processes name the same place only where
         *     the operating system lets no more than one of them open the store.
         */
        PlaceId: string;
        /** @description A value as plain JSON of any kind: number, text, truth value, list, object, or null where there is none. 64-bit integers are texts. */
        PlainValue: unknown;
        /** @description An address of the configuration by which passwords and values leave this machine without TLS. */
        PlaintextWay: {
            address: string;
            /** @description Key with the address, as `web.listen`. */
            key: string;
        };
        /**
         * @description A problem document. `code` is stable and for programs, `detail` is for people; what went wrong
         *     inside is logged and never shown.
         */
        Problem: {
            /** @description A stable code, as `NOT_FOUND`. */
            code: string;
            /** @description Problem and remedy, for people. */
            detail: string;
            /** @description Each single fault, where a document has several. */
            faults?: components["schemas"]["ProblemFault"][];
            /** @description Values that a text of the code in another language names, by their names in it. */
            parameters?: {
                [key: string]: string;
            } | null;
            /**
             * Format: int64
             * @description Seconds after which trying again makes sense; also the header `Retry-After`.
             */
            retryAfterSeconds?: number | null;
            secondFactor?: components["schemas"]["SecondFactorNeeded"] | null;
            /**
             * Format: int32
             * @description The HTTP status.
             */
            status: number;
            /** @description The HTTP status in words. */
            title: string;
            /** @description Problem type, `urn:verbund:problem:<code>`. */
            type: string;
        };
        /** @description One fault of a document, placed. */
        ProblemFault: {
            /** @description A stable code. */
            code: string;
            /** @description A sentence that says what is wrong and what to do. */
            message: string;
            /** @description JSON pointer (RFC 6901) into the document that was sent. */
            pointer: string;
        };
        /** @description A network to put in place. */
        PutBody: {
            collaborationId: components["schemas"]["CollaborationId"];
            /**
             * @description The network as the author sees it (wire contract `operation-network`), each operation with
             *     `owningFactoryId`.
             */
            operationNetwork: components["schemas"]["OperationNetwork"];
        };
        /** @description User to add or replace. */
        PutUser: {
            organisationId?: components["schemas"]["OrganisationId"] | null;
            /** Format: password */
            password: string;
            role: components["schemas"]["Role"];
        };
        /** @description Counters of one queue at the moment of the call. */
        QueueStatus: {
            /**
             * Format: int64
             * @description Stored bytes of ready and unsettled messages.
             */
            bytes: number;
            /** Format: int64 */
            consumers: number;
            queue: string;
            /**
             * Format: int64
             * @description Messages that wait for a consumer.
             */
            ready: number;
            /**
             * Format: int64
             * @description Messages delivered and not settled yet.
             */
            unsettled: number;
        };
        /** @description At most so many values within any period of this length. */
        RateStatement: {
            /**
             * Format: int64
             * @description The period in milliseconds.
             */
            periodMs: number;
            /**
             * Format: int32
             * @description Most values within the period.
             */
            values: number;
        };
        /**
         * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
         *     codes of before, which stay good.
         */
        RecoveryCodes: {
            recoveryCodes: string[];
        };
        /** @description A bound: absolute for the first four kinds (`time`), relative for the gaps (`duration`). */
        RelationCondition: {
            /** @description Unique within the network. */
            conditionId: components["schemas"]["ConditionId"];
            /** @description Kind of bound, which tells whether a time or a duration is needed. */
            conditionKind: components["schemas"]["ConditionKind"];
            duration?: components["schemas"]["IsoDuration"] | null;
            time?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description Dependency between an end of the predecessor and an end of the successor.
         * @enum {string}
         */
        RelationType: "FINISH_TO_START" | "START_TO_START" | "FINISH_TO_FINISH" | "START_TO_FINISH";
        /**
         * @description Kind of records that stay of those who have left: others have a right to them.
         * @enum {string}
         */
        RemainingRecords: "REPORTS" | "NETWORKS" | "COMMENTS" | "REVOCATIONS" | "LEDGER_LOGS" | "ACCESSES" | "AUDIT";
        /** @description Effects of a removal, and what is in its way. */
        Removal: {
            /**
             * Format: int64
             * @description Number of broker credentials that end, with the connections that use them.
             */
            credentials: number;
            /** @description Places of what is in force and has to be ended first, at most a hundred of a kind. */
            inForce: string[];
            /** @description True once it has left. */
            isDone: boolean;
            /** @description People whose accounts end. */
            people: string[];
            /** @description Records that stay, since others have a right to them. All else goes, large amounts within minutes. */
            remains: components["schemas"]["RemainingRecords"][];
            /** @description Places of requests whose reports no tool gets any more, at most a hundred. */
            requests: string[];
            /**
             * Format: int64
             * @description Number of sessions that end.
             */
            sessions: number;
        };
        /** @description Result of a replay. */
        Replayed: {
            /** @description True if ingest accepted it this time, or if it waits in its queue again. */
            isTaken: boolean;
        };
        /** @description A report as its recipients see it. */
        Report: components["schemas"]["RequestKey"] & {
            /** Format: int32 */
            dataSetWriterId: number;
            /** Format: int32 */
            epoch: number;
            factoryId: components["schemas"]["FactoryId"];
            /** @description The fields by their names. */
            fields: {
                [key: string]: components["schemas"]["ReportedValue"];
            };
            /** @description True if it came late, after newer ones. */
            isReplay: boolean;
            /** @description Time of arrival at the platform. */
            receivedAt: components["schemas"]["DateTime"];
            /** @description Name of its format, as the request has it. */
            reportName: string;
            reportTimestamp?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description The sequence number within the epoch.
             */
            sequence: number;
            shopfloorTimestamp?: components["schemas"]["DateTime"] | null;
        };
        /** @description The fields of a report, under its name. */
        ReportDataFormat: {
            /** @description The fields, in payload order. */
            reportFieldList: components["schemas"]["ReportField"][];
            /** @description The report's name; the first payload member. */
            reportName: string;
        };
        /** @description One value that a partner requests. */
        ReportField: {
            /** @description More about the field. */
            description?: string | null;
            /** @description The field's name; unique within the report. */
            name: components["schemas"]["FieldName"];
            semantic?: components["schemas"]["Semantic"] | null;
            /** @description Its built-in type: id 1 to 25 or name. */
            type: components["schemas"]["FieldType"];
            /** @description The unit: a UNECE common code or one of its aliases (`PIECE`). */
            unit?: string | null;
            /**
             * Format: int32
             * @description OPC UA ValueRank: -1 scalar, 1 array, n matrix of n dimensions.
             */
            valueRank?: number;
        };
        /** @description A value with its quality and source time. */
        ReportedValue: {
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /** @description Quality, by the standard's name. */
            status: string;
            value: components["schemas"]["PlainValue"];
        };
        /** @description One dynamic data request, addressed through its network and operation. */
        RequestKey: {
            /** @description The request itself. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            /** @description The operation it asks about. */
            operationId: components["schemas"]["OperationId"];
            /** @description The network the request belongs to. */
            operationNetworkId: components["schemas"]["OperationNetworkId"];
        };
        /**
         * @description A receipt as its readers see it: for the organisations that received the values, and for the
         *     factory's own.
         */
        RevocationEntry: {
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            factoryId: components["schemas"]["FactoryId"];
            operationId: components["schemas"]["OperationId"];
            /**
             * @description Ed25519 key, hexadecimal, as the factory stated it; to be compared with the key of its
             *     ledger's checkpoints.
             */
            publicKey: string;
            receiptId: components["schemas"]["OpaqueId"];
            /** @description Time of arrival at the platform. */
            receivedAt: components["schemas"]["DateTime"];
            /** @description Ed25519 signature over the UTF-8 text, hexadecimal, as the factory stated it. */
            signature: string;
            /** @description The receipt, a JSON document, byte by byte as the factory signed it. */
            signedText: string;
        };
        /** @description Result of a revocation. */
        Revoked: {
            /**
             * @description Account at a broker of another make, which only its administrator can remove. Nothing of it counts and nothing
             *     is sent to it, but what waits there it can still read. Absent where the platform's own broker has cut it off.
             */
            brokerAccount?: string | null;
            /** @description Connections that were cut. */
            connections: number;
            /**
             * Format: int64
             * @description Credentials taken away.
             */
            credentials: number;
        };
        /**
         * @description Role of a user.
         * @enum {string}
         */
        Role: "ADMINISTRATOR" | "PLANNER" | "VIEWER";
        /** @description Password that a change of the second factor takes. */
        SecondFactorBegin: {
            /** Format: password */
            password: string;
        };
        /** @description A code from the authenticator app. */
        SecondFactorCode: {
            code: string;
        };
        /**
         * @description Proof that a person gives beside the password.
         * @enum {string}
         */
        SecondFactorKind: "CODE" | "PASSKEY";
        /** @description Second factors that a person has. */
        SecondFactorNeeded: {
            /** @description Kinds that are on; a recovery code is good in place of each. */
            kinds: components["schemas"]["SecondFactorKind"][];
            /**
             * @description Options of `navigator.credentials.get` for the person's passkeys: `PublicKeyCredentialRequestOptionsJSON`
             *     of WebAuthn Level 3. Their challenge is good once, for two minutes.
             */
            passkeyOptions?: Record<string, never> | null;
        };
        /** @description New secret for an authenticator app, shown this once. */
        SecondFactorOffer: {
            /** @description SVG image of a QR code with the URI. */
            qrCode: string;
            /** @description The secret in base 32, to type. */
            secret: string;
            /** @description URI `otpauth://...` of the secret, for the app. */
            uri: string;
        };
        /** @description Password and code with which a second factor is removed. */
        SecondFactorRemoval: {
            /** @description A code from the app, or a recovery code. */
            code: string;
            /** Format: password */
            password: string;
        };
        /** @description State of a user's second factor. */
        SecondFactorState: {
            /** @description True if codes of an authenticator app are on. Passkeys are listed by themselves. */
            isOn: boolean;
            /** @description Recovery codes that are left, for codes of an app and passkeys alike. */
            recoveryCodesLeft: number;
        };
        /** @description Meaning of a field: one of the names, or an IRI. */
        Semantic: ("PRODUCED_QUANTITY" | "GOOD_QUANTITY" | "SCRAP_QUANTITY" | "PERCENT_COMPLETE" | "OPERATION_STATE" | "ACTUAL_START" | "ACTUAL_END" | "EXPECTED_END") | string;
        /** @description The signed-in user and the token of its session. */
        Session: {
            /** @description Token that changes must carry in the header `x-csrf-token`. */
            csrfToken: string;
            organisationId?: components["schemas"]["OrganisationId"] | null;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /** @description Sessions of a person, the one used last first. */
        SessionList: {
            items: components["schemas"]["SessionSummary"][];
        };
        /** @description A session, told to its owner or to an administrator. */
        SessionSummary: {
            /** @description Address from which the person signed in. */
            address: string;
            /** @description True for the session that asks. */
            isPresent: boolean;
            /**
             * Format: date-time
             * @description Last use, to the minute. An open page uses its session.
             */
            lastUsedAt: string;
            /** @description Name by which the session is ended; nobody can use the session with it. */
            sessionId: string;
            /** Format: date-time */
            startedAt: string;
            /** @description Browser as it calls itself. */
            userAgent: string;
        };
        /** @description User name, password and second factor. */
        SignIn: {
            /** @description A code from the authenticator app or a recovery code, for people with a second factor. */
            code?: string | null;
            /** @description Assertion of a passkey in place of a code: `AuthenticationResponseJSON` of WebAuthn Level 3. */
            passkey?: Record<string, never> | null;
            /** Format: password */
            password: string;
            userName: string;
        };
        /** @description Status of the platform, with evidence. */
        Status: {
            brokerDisk?: components["schemas"]["DiskState"] | null;
            /** @description Connections of the embedded broker; for administrators. */
            connections?: components["schemas"]["ConnectionStatus"][] | null;
            /**
             * @description True where the key that seals passwords lies beside the store, so that a copy of the folder has both; for
             *     administrators.
             */
            isSealingKeyBesideStore?: boolean | null;
            link?: components["schemas"]["LinkState"] | null;
            /** @description Its own clock, to tell ages by. */
            now: components["schemas"]["DateTime"];
            /** @description Ways to other machines without TLS that the configuration allows; for administrators. */
            plaintextWays?: components["schemas"]["PlaintextWay"][] | null;
            /** @description The queues of the embedded broker; for administrators. */
            queues?: components["schemas"]["QueueStatus"][] | null;
            /** @description Start of this process. */
            startedAt: components["schemas"]["DateTime"];
            /** @description The version of the program. */
            version: string;
        };
        /**
         * @description Resolution in which status codes leave their factory.
         * @enum {string}
         */
        StatusResolution: "FULL" | "SEVERITY";
        /** @description A token to enrol with, shown this once. */
        TokenView: {
            /** @description End of its validity. */
            expiresAt: components["schemas"]["DateTime"];
            /** @description True where it names the certificate that the platform shows: then the connector enrols with nobody else. */
            isPinned: boolean;
            /** @description Token for `factory-connector enrol`; contains the platform's address. */
            token: string;
        };
        /** @description A tool of an organisation; it may do what a planner of that organisation may do. */
        Tool: {
            /** @description Addition, by the platform's clock. */
            createdAt: components["schemas"]["DateTime"];
            /** @description Name for people. */
            name: string;
            organisationId: components["schemas"]["OrganisationId"];
            /** @description Its id, also part of its addresses. */
            toolId: components["schemas"]["ToolId"];
        };
        /** @description Endpoint and credential of a tool, shown this once. */
        ToolCredential: {
            /** @description The broker's address. */
            brokerUrl: string;
            /** @description The tool's own secret. */
            password: string;
            /** @description The authority that vouches for the broker; absent where the system's roots do. */
            rootCertificatePem?: string | null;
            /** @description The name to sign in with. */
            userName: string;
        };
        /** @description A partner's tool that asks for data and receives reports. */
        ToolId: string;
        /**
         * @description The period of an update frequency.
         * @enum {string}
         */
        UpdateFrequencyUnit: "SECOND" | "MINUTE" | "HOUR" | "DAY" | "WEEK";
        /** @description Account of a person, without the password. */
        UserView: {
            organisationId?: components["schemas"]["OrganisationId"] | null;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /** @description Received sequence numbers of a data set writer within an epoch. */
        WriterView: {
            /**
             * Format: int32
             * @description Number up to which some of the missing ones may be held, since there were too many holes to count
             *     each; absent where all are missing.
             */
            coarseThrough?: number | null;
            /** Format: int32 */
            dataSetWriterId: number;
            /**
             * Format: int64
             * @description Repeats that were discarded; for the factory's own organisation and administrators.
             */
            duplicates?: number | null;
            /** @description The request that its last report answered. */
            dynamicDataRequestId?: string | null;
            /** Format: int32 */
            epoch: number;
            /** @description Number of announced gaps, listed or not. */
            gapCount: number;
            /** @description Numbers that the factory announced will never come: the newest gaps, at most 100. */
            gaps: components["schemas"]["GapView"][];
            lastKeepAliveAt?: components["schemas"]["DateTime"] | null;
            lastReportAt?: components["schemas"]["DateTime"] | null;
            /** @description The lowest numbers below it that are missing, at most 1000. */
            missing: number[];
            /**
             * Format: int64
             * @description Number of missing sequence numbers, listed or not.
             */
            missingCount: number;
            /** @description The network that its last report was about. */
            operationNetworkId?: string | null;
            /**
             * Format: int64
             * @description Reports that arrived, repeats not counted.
             */
            received: number;
            /**
             * Format: int32
             * @description The highest sequence number held.
             */
            throughSequence?: number | null;
        };
    };
    responses: {
        /** @description The request cannot be understood. */
        BadRequest: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The call does not fit the present state. */
        Conflict: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The role does not allow it, or the CSRF token is wrong. */
        Forbidden: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The resource does not exist, or the viewer has no part in it. */
        NotFound: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Reading takes too long; ask for less at once. */
        ServiceUnavailable: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Too many requests, downloads or live streams at once. */
        TooManyRequests: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description No user is signed in. */
        Unauthorized: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
        UnprocessableEntity: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
    };
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export interface operations {
    listAuditEntries: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_AuditEntry"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    exportAuditEntries: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description OK */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/x-ndjson": string;
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listCollaborations: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Collaboration"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addCollaboration: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewCollaboration"];
            };
        };
        responses: {
            /** @description A collaboration with its members and factories. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Collaboration"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeCollaboration: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                collaborationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    addCollaborationFactory: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                collaborationId: string;
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A collaboration with its members and factories. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Collaboration"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeCollaborationFactory: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                collaborationId: string;
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    addMember: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                collaborationId: string;
                organisationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A collaboration with its members and factories. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Collaboration"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeMember: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                collaborationId: string;
                organisationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listDeadLetters: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_DeadLetterView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    replayDeadLetter: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                deadLetterId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of a replay. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Replayed"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    enrol: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Enrol"];
            };
        };
        responses: {
            /** @description Endpoint and credential of a connector, shown this once. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Enrolment"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
        };
    };
    listFactories: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Factory"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addFactory: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewFactory"];
            };
        };
        responses: {
            /** @description A factory: one connector, with the evidence of its life. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Factory"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeFactory: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listAccesses: {
        parameters: {
            query?: {
                /** @description Restriction to accesses of this organisation. */
                viewer?: components["schemas"]["OrganisationId"];
                /** @description Restriction to values of this network. */
                network?: components["schemas"]["OperationNetworkId"];
                /** @description Restriction to values of this request. */
                request?: components["schemas"]["DynamicDataRequestId"];
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_AccessView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    exportAccesses: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description OK */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/x-ndjson": string;
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showAccessCheckpoint: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A signed statement of the size and the root of a factory's access log. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["AccessCheckpointView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    revokeFactoryCredentials: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of a revocation. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Revoked"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    makeEnrolmentToken: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A token to enrol with, shown this once. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["TokenView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    showLease: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Lease of a factory with the connectors that were refused. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["LeaseView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    handLeaseOver: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Handover"];
            };
        };
        responses: {
            /** @description Lease of a factory with the connectors that were refused. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["LeaseView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listLedgerLogs: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_LedgerLogView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listWriters: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                factoryId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_WriterView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    streamLive: {
        parameters: {
            query?: {
                /**
                 * @description Counterpart of the header `Last-Event-ID`, for the first connection of a page: `lastEventId`
                 *     of the view it shows.
                 */
                lastEventId?: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Live event: `event` is its name, `data` says what changed. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": components["schemas"]["LiveEvent"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listOperationNetworks: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_NetworkSummary"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showOperationNetwork: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A network with its parts, progress and fields. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["NetworkView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putOperationNetwork: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PutBody"];
            };
        };
        responses: {
            /** @description Result of a change. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    withdrawOperationNetwork: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of a change. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listComments: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_CommentEntry"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addComment: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["AddComment"];
            };
        };
        responses: {
            /**
             * @description A comment as those who take part see it: about a request its requester and the factory, about the
             *     network its drawer and the factory.
             */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["CommentEntry"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    addDynamicDataRequest: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
                operationId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DynamicDataRequest"];
            };
        };
        responses: {
            /** @description Result of a change. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeDynamicDataRequest: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
                operationId: string;
                dynamicDataRequestId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of a change. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Changed"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listRevocations: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before; absent for the first page. */
                cursor?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_RevocationEntry"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listOrganisations: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Organisation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addOrganisation: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewOrganisation"];
            };
        };
        responses: {
            /** @description A company, institute or person that takes part. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Organisation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeOrganisation: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                organisationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listReports: {
        parameters: {
            query?: {
                /** @description Restriction to this network. */
                network?: components["schemas"]["OperationNetworkId"];
                /** @description Restriction to this request. */
                request?: components["schemas"]["DynamicDataRequestId"];
                /** @description The report after which those listed arrived; `nextCursor` of the page before. */
                after?: string;
                /** @description Most entries wanted, 1 to 1000. */
                limit?: number;
                /**
                 * @description The newest entries instead of the oldest; still in the order of their arrival, and without a
                 *     next page.
                 */
                newest?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Report"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSession: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The signed-in user and the token of its session. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    signIn: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SignIn"];
            };
        };
        responses: {
            /** @description The signed-in user and the token of its session. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    signOut: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Signed out */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listPasskeys: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Passkeys of a person, the oldest first. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PasskeyList"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addPasskey: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewPasskey"];
            };
        };
        responses: {
            /**
             * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
             *     codes of before, which stay good.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RecoveryCodes"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    beginPasskey: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasskeyBegin"];
            };
        };
        responses: {
            /** @description Options with which a browser makes a passkey. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PasskeyOffer"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    removePasskey: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                passkeyId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasskeyRemoval"];
            };
        };
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    changePassword: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasswordChange"];
            };
        };
        responses: {
            /** @description Changed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    showSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description State of a user's second factor. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SecondFactorState"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    confirmSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorCode"];
            };
        };
        responses: {
            /**
             * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
             *     codes of before, which stay good.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RecoveryCodes"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    beginSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorBegin"];
            };
        };
        responses: {
            /** @description New secret for an authenticator app, shown this once. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SecondFactorOffer"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    removeSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorRemoval"];
            };
        };
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            /** @description Too many people are signing in at once. */
            503: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
        };
    };
    listSessions: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Sessions of a person, the one used last first. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SessionList"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    endSession: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sessionId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Ended */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    showStatus: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Status of the platform, with evidence. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Status"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listTools: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Tool"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addTool: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewTool"];
            };
        };
        responses: {
            /** @description A tool of an organisation; it may do what a planner of that organisation may do. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Tool"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeTool: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                toolId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    makeToolCredential: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                toolId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Endpoint and credential of a tool, shown this once. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ToolCredential"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    revokeToolCredentials: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                toolId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of a revocation. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Revoked"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listUsers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_UserView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putUser: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                /** @description The name to sign in with */
                userName: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PutUser"];
            };
        };
        responses: {
            /** @description Account of a person, without the password. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UserView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    removeUser: {
        parameters: {
            query?: {
                /** @description True where the answer shall only say what would end and what is in force. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Effects of a removal, and what is in its way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Removal"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    resetSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
    listUserSessions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Sessions of a person, the one used last first. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SessionList"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    endUserSession: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
                sessionId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Ended */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
        };
    };
}
