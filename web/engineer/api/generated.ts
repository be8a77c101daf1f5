// Generated from openapi.json by `npm run generate`. Do not edit.

export interface paths {
    "/application-certificate": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the OPC UA server's own certificate.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description The certificate that the OPC UA server shows its clients. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ApplicationCertificateView"];
                    };
                };
            };
        };
        /**
         * Installs an issued certificate; the server shows it from the next connection on.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["IssuedCertificateBody"];
                };
            };
            responses: {
                /** @description The certificate that the OPC UA server shows its clients. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ApplicationCertificateView"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/application-certificate/request": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Makes a request for a certificate with the server's application URI and host names. The key
         *     stays here.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["CertificateRequestBody"];
                };
            };
            responses: {
                /** @description A request to be given to an authority. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["CertificateRequestView"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-authorities": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the authorities whose clients may connect, and those in between. They are added with the
         *     clients' certificates.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_ClientAuthorityView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-authorities/{thumbprint}": {
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
         * Removes an authority: its clients stay outside from the next connection on.
         * @description Least role: ENGINEER.
         */
        delete: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    thumbprint: string;
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-certificates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the certificates of OPC UA clients, those that wait for an approval first. A local
         *     discovery server's is among them.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_ClientCertificateView"];
                    };
                };
            };
        };
        put?: never;
        /**
         * Adds a certificate or a revocation list to the trust list.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["TrustFileBody"];
                };
            };
            responses: {
                /** @description Added */
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content?: never;
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-certificates/{thumbprint}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Trusts or rejects a client's certificate.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    thumbprint: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["ClientTrustBody"];
                };
            };
            responses: {
                /** @description A certificate that the OPC UA server has seen or was given. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ClientCertificateView"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-revocation-lists": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the authorities' lists of revoked certificates.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_ClientRevocationListView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-revocation-lists/{revocationListId}": {
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
         * Removes a list of revoked certificates: clients of its authority stay outside until there is a
         *     new one.
         * @description Least role: ENGINEER.
         */
        delete: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    revocationListId: string;
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/configuration": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every setting with its meaning, default and value, and who set it. Secrets are not shown.
         * @description Least role: ENGINEER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_Setting"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
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
         * Lists messages that were received or sent and rejected, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `nextCursor` of the page before. */
                    cursor?: string;
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
                        "application/json": components["schemas"]["Page_DeadLetter"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Server-sent events: `field` with the field's key, its state and its newest disclosed value,
         *     `decisions` with how many fields were decided at once and how many of them by standing rules,
         *     `inbox` and `comment` with the network's id, `operator` with the operation's key, `revocation`
         *     with the receipt's id, `policies`, `ledger` every other second while it grows, `status` where
         *     the link or a local server changes its state, and `reset` where events were missed and the page
         *     must load afresh.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "text/event-stream": string;
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows a field as it stands.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A requested field with its decision and value. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["FieldView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/consent-offer": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * What a consent begins with, and what "every change" instead of the partner's period would add.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description With what the consent for a field begins. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ConsentOffer"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/decision": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Decides about a field. The partner is told; values flow or stop at once.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["DecisionBody"];
                };
            };
            responses: {
                /** @description A requested field with its decision and value. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["FieldView"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/mapping-status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * How a field's mapping is doing: last values in and out, counts, faults, time spent.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Status of a mapping, for its page. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingStatus"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/mapping-status/restart": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Ends the rest of a field's scripts that did not keep to their budget: they are tried again at
         *     once.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Status of a mapping, for its page. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingStatus"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Runs a draft on the live values of its inputs; nothing is changed and nothing leaves.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["Draft"];
                };
            };
            responses: {
                /** @description Side by side: machine, mapping, what is disclosed, and the message. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Preview"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/shadow": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the mapping on trial, with its values beside those of the published one.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A mapping on trial beside the published one. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ShadowView"];
                    };
                };
            };
        };
        /**
         * Lets a mapping run on live values without writing, in place of the one on trial so far.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["MappingDraft"];
                };
            };
            responses: {
                /** @description A mapping on trial beside the published one. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ShadowView"];
                    };
                };
            };
        };
        post?: never;
        /**
         * Ends the trial.
         * @description Least role: ENGINEER.
         */
        delete: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/shadow/publish": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Publishes the mapping on trial as the next version, under the consent in force; the trial ends.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A requested field with its decision and value. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["FieldView"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/suggestions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Suggests variables for a field, each with its reasons.
         * @description Least role: ENGINEER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description At most so many, up to 100; 10 without it. */
                    limit?: number;
                };
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Variables that might be meant, best first, and where they were looked for. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Suggestions"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/template": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Makes a template of a field's mapping; it is not kept yet.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["TemplateDraft"];
                };
            };
            responses: {
                /** @description A mapping with gaps. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingTemplate"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/trial": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Runs a mapping on live or recorded values and shows every intermediate value; nothing is changed
         *     and nothing leaves.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["TrialBody"];
                };
            };
            responses: {
                /** @description What became of a trial. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Trial"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/value": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Enters a value for a field that was decided Manual. It goes through the same gate as any other.
         * @description Least role: OPERATOR.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["EnteredValue"];
                };
            };
            responses: {
                /** @description What became of it. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Entered"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/version-difference": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Compares two versions of a field's mapping.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query: {
                    /** @description The earlier version. */
                    from: number;
                    /** @description The later one; the field's mapping as it is now without it. */
                    to?: number;
                };
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description What differs between two versions. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Difference"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the versions of a field's mapping, newest first; the last hundred are kept.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
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
                        "application/json": components["schemas"]["Page_VersionView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/versions/{version}/rollback": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Goes back to a version: it is published again as the newest one, under the consent in force.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                    fieldName: components["schemas"]["FieldName"];
                    version: number;
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A requested field with its decision and value. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["FieldView"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/inbox": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the requests of all active networks with their fields, filtered, in pages, in the order of
         *     their addresses.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /**
                     * @description `nextCursor` of the page before: requests behind its last one, whatever came and went
                     *     meanwhile.
                     */
                    cursor?: string;
                    /** @description Requests per page, at most 200. */
                    limit?: number;
                    /** @description Requests with a field in this state: `PENDING`, `MAPPED` or `REFUSED`. */
                    state?: components["schemas"]["MappingState"];
                    /** @description Requests of this requester. */
                    partner?: string;
                    /** @description Requests of this network. */
                    operationNetworkId?: string;
                    /** @description Requests in whose ids, names, purpose, fields or partners all these words occur. */
                    search?: string;
                    /** @description Requests that have been open for longer than the time after which the inbox reminds. */
                    isOverdue?: boolean;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A page of the inbox, and how many there are. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["InboxPage"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/leak-budgets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * What each partner learns in sum from all open fields, and what it can conclude from them
         *     together.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description One organisation only. */
                    partner?: string;
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
                        "application/json": components["schemas"]["Page_PartnerLeaks"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/leak-budgets/summary": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * What each partner learns in short: how many fields, how much at most, how exactly, and how many
         *     conclusions.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description One organisation only. */
                    partner?: string;
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
                        "application/json": components["schemas"]["Page_PartnerSummary"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the entries of a recipient's chain, newest first, with what left; of the first recipient
         *     by name where none is named.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description Of this recipient's chain. */
                    recipient?: components["schemas"]["OrganisationId"];
                    /** @description Recorded at this time or later. */
                    from?: components["schemas"]["DateTime"];
                    /** @description Recorded before this time. */
                    until?: components["schemas"]["DateTime"];
                    /**
                     * @description Of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
                     *     `REVOKED`.
                     */
                    kind?: "CONSENT" | "QUEUED" | "SENT" | "RECEIPTED" | "COALESCED" | "EXPIRED" | "PURGED" | "REVOKED";
                    /**
                     * @description About this network: decisions about its fields, reports that carried them, and what became
                     *     of those.
                     */
                    operationNetworkId?: components["schemas"]["OperationNetworkId"];
                    /** @description Of it, only about this operation. */
                    operationId?: components["schemas"]["OperationId"];
                    /** @description Of it, only about this request. */
                    dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"];
                    /** @description Of it, only about this field. */
                    fieldName?: components["schemas"]["FieldName"];
                    /** @description `nextCursor` of the page before. */
                    after?: string;
                    /** @description Entries on the page, 1 to 500; 100 without it. */
                    limit?: number;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Entries of one chain, newest first. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["LedgerView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/checkpoints": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the signed checkpoints over all chains, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `nextCursor` of the page before. */
                    cursor?: string;
                    /** @description Checkpoints per page, at most 200; 20 without it. */
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
                        "application/json": components["schemas"]["Page_CheckpointView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Exports what left, as JSON lines, as a table for spreadsheets or as a page to print; in the
         *     order of the chains.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query: {
                    /** @description Of this recipient's chain. */
                    recipient?: components["schemas"]["OrganisationId"];
                    /** @description Recorded at this time or later. */
                    from?: components["schemas"]["DateTime"];
                    /** @description Recorded before this time. */
                    until?: components["schemas"]["DateTime"];
                    /**
                     * @description Of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
                     *     `REVOKED`.
                     */
                    kind?: "CONSENT" | "QUEUED" | "SENT" | "RECEIPTED" | "COALESCED" | "EXPIRED" | "PURGED" | "REVOKED";
                    /**
                     * @description About this network: decisions about its fields, reports that carried them, and what became
                     *     of those.
                     */
                    operationNetworkId?: components["schemas"]["OperationNetworkId"];
                    /** @description Of it, only about this operation. */
                    operationId?: components["schemas"]["OperationId"];
                    /** @description Of it, only about this request. */
                    dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"];
                    /** @description Of it, only about this field. */
                    fieldName?: components["schemas"]["FieldName"];
                    /** @description `jsonl`, `csv` or `html`. */
                    format: "jsonl" | "csv" | "html";
                    /** @description Of a page to print: `en` or `de`. */
                    language?: "en" | "de";
                };
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
                        "text/csv": string;
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/fields": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Searches the fields that the ledger speaks of, in the order of their addresses; those of ended
         *     requests included.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description Fields in whose ids all these words occur. */
                    search?: string;
                    /** @description Most fields, at most 200; 20 without it. */
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
                        "application/json": components["schemas"]["Page_LedgerField"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/verification": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Reads every chain from its beginning and finds any change, deletion or reordering.
         * @description Least role: VIEWER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description The outcome of a verification. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["VerificationView"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the templates.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_TemplateView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates/{templateId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Keeps a template, in place of the one with the same id.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    templateId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["MappingTemplate"];
                };
            };
            responses: {
                /** @description A mapping with gaps. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingTemplate"];
                    };
                };
            };
        };
        post?: never;
        /**
         * Forgets a template; mappings made from it stay.
         * @description Least role: ENGINEER.
         */
        delete: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    templateId: string;
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates/{templateId}/fill": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Fills a template once per member of a series and takes the mappings, as an import does: all or
         *     none.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: {
                    /** @description True: say what would happen and change nothing. */
                    dryRun?: boolean;
                };
                header?: never;
                path: {
                    templateId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["Series"];
                };
            };
            responses: {
                /** @description What an import did, or would do. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ImportOutcome"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * All mappings, in force and proposed, in a form that can be imported again; the file has the
         *     templates too.
         * @description Least role: ENGINEER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `file` (the default) or `csv`. */
                    form?: "file" | "csv";
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Mappings and templates as one JSON document. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingFile"];
                        "text/csv": string;
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/import": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Takes mappings from a table (`text/csv`) or a readable file (`application/json`), as exported.
         *     Either everything is taken or, where anything is wrong, nothing, and every fault is named with
         *     its place. Consents stay as they are: mappings of fields that are not mapped are proposals.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: {
                    /** @description True: say what would happen and change nothing. */
                    dryRun?: boolean;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["MappingFile"];
                    "text/csv": string;
                };
            };
            responses: {
                /** @description What an import did, or would do. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ImportOutcome"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/survey": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * How all published mappings are doing: how many do how, and the worst of them.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description Only those that are doing so. */
                    health?: components["schemas"]["MappingHealth"];
                    /** @description Up to 500; 50 without it, none with 0. */
                    limit?: number;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Health of the published mappings, without shadow mappings. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["MappingSurvey"];
                    };
                };
            };
        };
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
        /**
         * Lists all networks, withdrawn ones included.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_NetworkSummary"];
                    };
                };
            };
        };
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
         * Shows a network as received, and how its fields stand.
         * @description Least role: VIEWER.
         */
        get: {
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
                /** @description A network with its requests. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["NetworkView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
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
         * Lists the remarks about a network, oldest first.
         * @description Least role: VIEWER.
         */
        get: {
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
                /** @description A page of a list. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_StoredComment"];
                    };
                };
            };
        };
        put?: never;
        /**
         * Says something to the partners of a network.
         * @description Least role: OPERATOR.
         */
        post: {
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
                    "application/json": components["schemas"]["NewComment"];
                };
            };
            responses: {
                /** @description Said */
                204: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content?: never;
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/news": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * What is new in a network against the revision before.
         * @description Least role: VIEWER.
         */
        get: {
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
                /** @description What the revision in force changed. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["NetworkNews"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operator/entries": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists what was entered about an operation, newest first: the last 200 entries.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query: {
                    /** @description The network. */
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    /** @description The operation. */
                    operationId: components["schemas"]["OperationId"];
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
                        "application/json": components["schemas"]["Page_OperatorEntry"];
                    };
                };
            };
        };
        put?: never;
        /**
         * Takes entries. They are stored together when the answer comes; without an answer the page
         *     delivers them again.
         * @description Least role: OPERATOR.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["Delivery"];
                };
            };
            responses: {
                /** @description A page of a list. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_EntryResult"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operator/operations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the operations of a day that have fields for people to fill, and those that are running or
         *     interrupted.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description When the shown day begins; the present day in UTC without it. */
                    from?: components["schemas"]["DateTime"];
                    /** @description When it ends; a day later without it. */
                    until?: components["schemas"]["DateTime"];
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
                        "application/json": components["schemas"]["Page_OperatorOperation"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the named policies in their newest version, retired ones included.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_PolicyView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Keeps a new version of a named policy. What fields with it, or recipients with it, get changes
         *     at once; each change is a consent in the ledger and told to the partner. `If-Match` with the
         *     version read (`"0"` for a new one) keeps two engineers from overwriting each other.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: {
                    "If-Match"?: string | null;
                };
                path: {
                    policyId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["NamedPolicy"];
                };
            };
            responses: {
                /** @description One version of a policy or rule. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["DocumentVersion"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * The mapped fields that a draft of a named policy would change, at most 500; nothing is changed.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    policyId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["NamedPolicy"];
                };
            };
            responses: {
                /** @description A page of a list. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_PolicyUse"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Every version of a named policy, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    policyId: string;
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
                        "application/json": components["schemas"]["Page_Versioned_NamedPolicy"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/recipients": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every organisation that may get anything, with the policy set for it.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_RecipientView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/recipients/{recipient}/policy": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Sets a named policy for everything a recipient gets: all recipients of a request get the same
         *     values, so that the strictest of the field's and of all its recipients' policies holds. Changes
         *     at once what leaves.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: {
                    "If-Match"?: string | null;
                };
                path: {
                    recipient: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["RecipientBody"];
                };
            };
            responses: {
                /** @description What was set. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["RecipientVersion"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/requests/{operationNetworkId}/{operationId}/{dynamicDataRequestId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows one request of an active network with its fields.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: components["schemas"]["OperationNetworkId"];
                    operationId: components["schemas"]["OperationId"];
                    dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A request of a partner. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["RequestView"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the receipts of ended consents, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `nextCursor` of the page before. */
                    cursor?: string;
                    /** @description Receipts per page, at most 50. */
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
                        "application/json": components["schemas"]["Page_StoredRevocation"];
                    };
                };
            };
        };
        put?: never;
        /**
         * Ends consents: values stop at once, what waits is taken back, the partner is told, and the
         *     receipt says what had left.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["RevocationBody"];
                };
            };
            responses: {
                /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["StoredRevocation"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations/{revocationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows one receipt.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    revocationId: string;
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["StoredRevocation"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations/{revocationId}/print": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * A receipt as a page to print.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `en` or `de`. */
                    language?: "en" | "de";
                };
                header?: never;
                path: {
                    revocationId: string;
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
                        "text/html": string;
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rule-decisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists what rules have decided by themselves, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description `nextCursor` of the page before. */
                    cursor?: string;
                    /** @description Decisions per page, at most 100. */
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
                        "application/json": components["schemas"]["Page_RuleDecision"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rule-decisions/{id}/undo": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Takes back what rules decided about a field: it is undecided again and the engineer's. Conflicts
         *     where something else was decided since.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    id: string;
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Undone */
                204: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content?: never;
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the standing rules in their newest version.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_Versioned_Rule"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/apply": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Applies the enabled rules to all undecided fields; what an engineer left open stays open.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description What was decided. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Applied"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * What a draft of a rule means among the fields that are there; nothing is changed.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["Rule"];
                };
            };
            responses: {
                /** @description What a rule would match. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["RulePreview"];
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/{ruleId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Keeps a new version of a rule. Enabled, it decides about requests from now on; what is there
         *     already is decided by `POST /rules/apply`. `If-Match` as for policies.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: {
                    "If-Match"?: string | null;
                };
                path: {
                    ruleId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["Rule"];
                };
            };
            responses: {
                /** @description One version of a policy or rule. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["DocumentVersion"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/{ruleId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Every version of a rule, newest first.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    ruleId: string;
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
                        "application/json": components["schemas"]["Page_Versioned_Rule"];
                    };
                };
            };
        };
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
        /**
         * Says who is signed in.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description Who is signed in. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Session"];
                    };
                };
            };
        };
        put?: never;
        /** Signs in; the answer sets the session's cookie. */
        post: {
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
                /** @description Who is signed in. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Session"];
                    };
                };
            };
        };
        /**
         * Signs out.
         * @description Least role: VIEWER.
         */
        delete: {
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-certificates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the certificates that servers have shown.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_PeerCertificate"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-certificates/{thumbprint}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Trusts or rejects a server's certificate.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    thumbprint: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["TrustBody"];
                };
            };
            responses: {
                /** @description Certificate that a server has presented. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["PeerCertificate"];
                    };
                };
            };
        };
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the sources with their state.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": components["schemas"]["Page_SourceView"];
                    };
                };
            };
        };
        put?: never;
        /**
         * Adds a source; the connector connects to it at once.
         * @description Least role: ENGINEER.
         */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["SourceConfig"];
                };
            };
            responses: {
                /** @description Created */
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": unknown;
                    };
                };
            };
        };
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Changes a source; mappings that use it go on under the new settings.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    sourceId: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["SourceConfig"];
                };
            };
            responses: {
                /** @description OK */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": unknown;
                    };
                };
            };
        };
        post?: never;
        /**
         * Removes a source; mappings that use it keep their last value with a status that says so.
         * @description Least role: ENGINEER.
         */
        delete: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    sourceId: string;
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/nodes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Browses a source's address space.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: {
                    /** @description The node whose children to list; the Objects folder without it. */
                    parent?: components["schemas"]["NodeId"];
                    /** @description `nextCursor` of the page before. */
                    cursor?: string;
                    /** @description Children per page, 500 without it, at most 1000. */
                    limit?: number;
                };
                header?: never;
                path: {
                    sourceId: string;
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
                        "application/json": components["schemas"]["Page_BrowsedNode"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/search": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Finds variables of a server by words of their paths, in the list of its variables that the
         *     connector keeps.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query: {
                    /** @description Words that all occur in the variable's path, in any order, without regard to case. */
                    text: string;
                    /** @description At most so many, up to 200; 50 without it. */
                    limit?: number;
                };
                header?: never;
                path: {
                    sourceId: string;
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description What was found. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Finds"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/value": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Reads a variable of a source.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query: {
                    /** @description The variable. */
                    node: components["schemas"]["NodeId"];
                };
                header?: never;
                path: {
                    sourceId: string;
                };
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description A value as pages show it. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ShownValue"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/spool": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows how much waits to leave.
         * @description Least role: VIEWER.
         */
        get: {
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
                        "application/json": unknown;
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
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
        /**
         * Says how the connector stands.
         * @description Least role: VIEWER.
         */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                /** @description How the connector stands. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Status"];
                    };
                };
            };
        };
        put?: never;
        post?: never;
        delete?: never;
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
        /**
         * Lists everybody who may sign in.
         * @description Least role: ENGINEER.
         */
        get: {
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
            };
        };
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
        /**
         * Adds a person, or changes role or password. With a new password the person's sessions end,
         *     except the one in which the person did it; those of OPC UA clients also end with another role.
         * @description Least role: ENGINEER.
         */
        put: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    userName: string;
                };
                cookie?: never;
            };
            requestBody: {
                content: {
                    "application/json": components["schemas"]["UserBody"];
                };
            };
            responses: {
                /** @description A person who may sign in. */
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["UserView"];
                    };
                };
            };
        };
        post?: never;
        /**
         * Removes a person; the person's sessions end.
         * @description Least role: ENGINEER.
         */
        delete: {
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
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /** @description What was entered. */
        Action: {
            /** @enum {string} */
            action: "START";
        } | {
            /** @enum {string} */
            action: "ADD";
            /** @description Good pieces without it. */
            piece?: components["schemas"]["Piece"];
            /**
             * Format: double
             * @description How many; 1 without it.
             */
            quantity?: number;
        } | {
            /** @enum {string} */
            action: "DONE";
        } | {
            /** @enum {string} */
            action: "PROBLEM";
            /** @description What is wrong. */
            text: string;
        } | {
            /** @enum {string} */
            action: "VALUE";
            /** @description The field's request. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            /** @description The field. */
            fieldName: components["schemas"]["FieldName"];
            /** @description As plain JSON; 64-bit integers may be texts. */
            value: unknown;
        };
        /**
         * @description Function over the values in a window.
         * @enum {string}
         */
        Aggregate: "minimum" | "maximum" | "mean" | "sum" | "count" | "last";
        /**
         * @description Function that aggregates a window's values.
         * @enum {string}
         */
        AggregateFunction: "LAST" | "MAXIMUM" | "MINIMUM" | "SUM" | "MEAN";
        /** @description The certificate that the OPC UA server shows its clients. */
        ApplicationCertificateView: {
            /** @description The application it is for. */
            applicationUri?: string | null;
            /** @description The names and addresses of the machine it is for. */
            hostNames: string[];
            /**
             * @description The server made it itself, and renews it itself; otherwise somebody has to ask the authority
             *     in time.
             */
            isSelfSigned: boolean;
            /** @description The distinguished name of who issued it. */
            issuer: string;
            /** @description Length of its RSA key in bits. */
            keyBits: number;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits. */
            thumbprint: string;
        };
        /** @description What was decided. */
        Applied: {
            /** @description How many fields. */
            decidedCount: number;
        };
        /** @description One bit of an integer, as Boolean. */
        Bit: {
            /**
             * Format: int32
             * @description 0 is the lowest.
             */
            bit: number;
        };
        /** @description Text of one bit. */
        BitText: {
            /**
             * Format: int32
             * @description 0 is the lowest.
             */
            bit: number;
            /** @description Text that is yielded. */
            text: string;
        };
        /** @description The texts of all bits that are set, in their order. */
        BitTexts: {
            /** @description Texts of bits; bits without one are left out. */
            bits: components["schemas"]["BitText"][];
            /** @description The text when none of the bits is set. */
            none?: string;
            /** @description Separator between two texts. */
            separator?: string;
        };
        /**
         * @description Browse names from the Objects folder down to a node. In JSON a list of texts `nsu=<uri>;<name>`,
         *     those of namespace 0 bare.
         */
        BrowsePath: string[];
        /** @description A node as a person picks it in a tree. */
        BrowsedNode: {
            /** @description Its browse name, as an element of a browse path. */
            browseName: string;
            browsePath?: components["schemas"]["BrowsePath"] | null;
            builtInType?: components["schemas"]["BuiltInType"] | null;
            dataType?: components["schemas"]["NodeType"] | null;
            /** @description Description of the server, if it has one. */
            description?: string | null;
            /** @description Its name for people. */
            displayName: string;
            /** @description True when it has child nodes. */
            hasChildren: boolean;
            /** @description True when the signed-in user may write the value. */
            isWritable: boolean;
            nodeClass: components["schemas"]["NodeClass"];
            nodeId: components["schemas"]["NodeId"];
            /** @description The usual range of an analog variable, low and high. */
            range?: [
                number,
                number
            ] | null;
            typeDefinition?: components["schemas"]["NodeType"] | null;
            unit?: components["schemas"]["UnitName"] | null;
            /**
             * Format: int32
             * @description Of a variable: -1 scalar, 1 or more the number of dimensions, 0 one or more, -2 any, -3
             *     scalar or one.
             */
            valueRank?: number | null;
        };
        /**
         * @description An OPC UA built-in type by its name.
         * @enum {string}
         */
        BuiltInType: "Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo";
        /** @description Which buttons have an effect on a field; the others only tell this plant. */
        Buttons: {
            addGood: boolean;
            addScrap: boolean;
            done: boolean;
            problem: boolean;
            start: boolean;
        };
        /** @description What is asked of an authority, beside application and host names. */
        CertificateRequestBody: {
            /** @description The common name; the server's own where absent. */
            commonName?: string | null;
            /** @description The organisation. */
            organization?: string | null;
            /** @description Whether a new key is made; it is used from the installation on. */
            withNewKey?: boolean;
        };
        /** @description A request to be given to an authority. */
        CertificateRequestView: {
            /** @description PKCS #10, as PEM. */
            content: string;
        };
        /**
         * @description Aspects of a field or its request that differ.
         * @enum {string}
         */
        ChangeReason: "DESCRIPTION" | "REPORT_NAME" | "SLOWER_CADENCE" | "FASTER_CADENCE" | "SHORTER_VALIDITY" | "LONGER_VALIDITY" | "REQUESTER" | "RECIPIENTS" | "PURPOSE" | "BUFFER" | "TYPE" | "UNIT" | "VALUE_RANK" | "SEMANTIC";
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_OperationId: {
            /** @description Only in the new revision. */
            added: string[];
            /** @description In both, but not alike. */
            changed: string[];
            /** @description Only in the old revision. */
            removed: string[];
        };
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_OperationRelationId: {
            /** @description Only in the new revision. */
            added: string[];
            /** @description In both, but not alike. */
            changed: string[];
            /** @description Only in the old revision. */
            removed: string[];
        };
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_RequestKey: {
            /** @description Only in the new revision. */
            added: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
            /** @description In both, but not alike. */
            changed: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
            /** @description Only in the old revision. */
            removed: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
        };
        /** @description The head of one chain. */
        CheckpointHead: {
            /** @description Hash of its last entry, hexadecimal. */
            hash: string;
            /**
             * Format: int64
             * @description Number of its last entry.
             */
            number: number;
            /** @description Organisation of the chain. */
            recipient: components["schemas"]["OrganisationId"];
        };
        /**
         * @description A checkpoint: whoever keeps one elsewhere can prove later whether the ledger still holds what it
         *     held then.
         */
        CheckpointView: {
            /** @description The last entry of each chain then. */
            heads: components["schemas"]["CheckpointHead"][];
            /**
             * Format: int64
             * @description Its place, from 1 without gaps.
             */
            number: number;
            /** @description The key it is verified with, hexadecimal. */
            publicKey: string;
            /** @description When it was made. */
            recordedAt: components["schemas"]["DateTime"];
            /** @description The Ed25519 signature over that text, hexadecimal. */
            signature: string;
            /**
             * @description The exact text that was signed: factory, number, time, and of each chain the last number and
             *     hash.
             */
            signedText: string;
        };
        /** @description The endpoint in use. */
        ChosenEndpoint: {
            /** @description The server's application URI. */
            applicationUri: string;
            endpointUrl: string;
            messageSecurity: components["schemas"]["MessageSecurity"];
            securityPolicy: components["schemas"]["SecurityPolicy"];
            /** @description Application name of the server. */
            serverName: string;
        };
        /** @description State of the circuit breakers of a mapping's scripts. */
        CircuitState: {
            /** @enum {string} */
            state: "closed";
        } | {
            /** @enum {string} */
            state: "resting";
            /** @description Until when, by the local clock. */
            until: components["schemas"]["DateTime"];
        } | {
            /** @enum {string} */
            state: "trying";
        };
        /** @description The certificate of an authority. */
        ClientAuthorityView: {
            /**
             * @description Clients with a certificate of it may connect; otherwise it only leads to one that is
             *     trusted.
             */
            isTrusted: boolean;
            /** @description The distinguished name of who issued it; the subject's where it did so itself. */
            issuer: string;
            nextUpdate?: components["schemas"]["DateTime"] | null;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /**
             * @description Whether its list of revoked certificates is here. Its clients stay outside without a current
             *     one.
             */
            revocationList: components["schemas"]["RevocationListState"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits: its identity here. */
            thumbprint: string;
        };
        /** @description A certificate that the OPC UA server has seen or was given. */
        ClientCertificateView: {
            /** @description The application it was made for, as it says. */
            applicationUri?: string | null;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /** @description The address that it came from then; null where the twin itself had called. */
            rejectedAddress?: string | null;
            /** @description What the application called itself then; nothing of it is proven. */
            rejectedApplicationName?: string | null;
            rejectedAt?: components["schemas"]["DateTime"] | null;
            rejectionReason?: components["schemas"]["ClientRejection"] | null;
            /** @description Whether it opens the door. */
            state: components["schemas"]["ClientTrust"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits: its identity here. */
            thumbprint: string;
        };
        /**
         * @description Why a certificate was turned away.
         * @enum {string}
         */
        ClientRejection: "NOT_TRUSTED" | "OUT_OF_TIME" | "USAGE" | "KEY_LENGTH" | "UNREADABLE" | "REVOKED" | "REVOCATION_UNKNOWN";
        /** @description An authority's list of revoked certificates. */
        ClientRevocationListView: {
            /** @description An authority that is known here signed it; otherwise it is of no use. */
            isSignedByKnownAuthority: boolean;
            /** @description The distinguished name of the authority. */
            issuer: string;
            nextUpdate?: components["schemas"]["DateTime"] | null;
            /** @description Its identity here. */
            revocationListId: string;
            /** @description How many certificates it names. */
            revokedCount: number;
            /** @description When it was made. */
            thisUpdate: components["schemas"]["DateTime"];
        };
        /**
         * @description Whether a certificate opens the door.
         * @enum {string}
         */
        ClientTrust: "TRUSTED" | "REJECTED";
        /** @description Whether a client's certificate is trusted. */
        ClientTrustBody: {
            /**
             * @description True: its bearer may connect from now on. False: it is turned away from the next connection
             *     on.
             */
            isTrusted: boolean;
        };
        /**
         * @description A time of day, `HH:MM`, up to and including `24:00`.
         * @example 06:00
         */
        ClockTime: string;
        /**
         * @description Conclusion from fields that are disclosed together.
         * @enum {string}
         */
        Conclusion: "CYCLE_TIME" | "UTILISATION" | "ORDER_QUANTITY" | "YIELD";
        /**
         * @description Effect of a difference on the engineer's consent.
         * @enum {string}
         */
        ConsentEffect: "KEPT" | "BACK_TO_PENDING" | "REMOVED";
        /** @description With what the consent for a field begins. */
        ConsentOffer: components["schemas"]["Statement"] & {
            /**
             * @description The precision to begin with: what standing rules say, and a minimum interval as long as the
             *     partner's period.
             */
            disclosure: components["schemas"]["DisclosurePolicy"];
            /**
             * Format: double
             * @description Values per hour that "every change" would add to that, as far as it was measured.
             */
            everyChangeAddsPerHour?: number | null;
            measured?: components["schemas"]["Measured"] | null;
            /**
             * Format: int64
             * @description The period that the partner asked for, in milliseconds.
             */
            requestedIntervalMs?: number | null;
            /** @description The rules behind it. */
            rules: components["schemas"]["RuleReference"][];
            /**
             * Format: double
             * @description Values per hour at that period.
             */
            valuesPerHour?: number | null;
        };
        /** @description Yields the same value whatever comes in; with no input before it, once. */
        Constant: {
            /** @description Value that the step yields. */
            value: components["schemas"]["Literal"];
        };
        /**
         * @description Converts to another built-in type: numbers, Boolean, String, DateTime and Guid among each other
         *     where it makes sense. Text that is no number is a fault, never zero.
         */
        Convert: {
            /** @description Treatment of a number outside the wanted type's range. */
            overflow?: components["schemas"]["Overflow"];
            /** @description Rounding of a fraction to an integer. */
            rounding?: components["schemas"]["Rounding"];
            /** @description The wanted type. */
            to: components["schemas"]["TypeName"];
        };
        /** @description The sum of a counter's increments, across wraps, resets and restarts of machine and connector. */
        Counter: {
            counts?: components["schemas"]["CounterInput"] | null;
            modulus?: components["schemas"]["Number"] | null;
            /** @description As in `increment`. */
            onDecrease?: components["schemas"]["OnDecrease"];
            /** @description An input that sets the sum back to `start` when it becomes true (or not zero). */
            resetBy?: string | null;
            /** @description Sum before the first value. */
            start?: components["schemas"]["Number"];
        };
        /**
         * @description Kind of counting of a `counter`.
         * @enum {string}
         */
        CounterInput: "increments" | "risingEdges" | "values";
        /**
         * Format: date-time
         * @description An instant in UTC with a resolution of 100 ns. On the wire an RFC 3339 text.
         */
        DateTime: string;
        /** @description A message that was received or sent and rejected. */
        DeadLetter: {
            at: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Size of the body, in bytes.
             */
            bytes: number;
            /** @description Cause of the rejection, as a code. */
            code: string;
            /** @description `RECEIVED` or `SENT`. */
            direction: string;
            /** @description Number of the dead letter, as text. */
            id: string;
            /** @description Id of the message; none for one that could not be read. */
            messageId?: string | null;
            /** @description Cause of the rejection, in words. */
            reason: string;
            /** @description Type of the message, as far as it is known. */
            subject: string;
        };
        /**
         * @description Holds changes back that are too small. Without parameters only repeats of the same value are
         *     held back; values that are no numbers pass when they differ. A change of the status always
         *     passes.
         */
        Deadband: {
            absolute?: components["schemas"]["Number"] | null;
            /**
             * Format: double
             * @description The change must be greater than this share of the last value that passed, in percent.
             */
            percent?: number | null;
        };
        /** @description Lets a value pass once it has not changed for a while. */
        Debounce: {
            /**
             * Format: int64
             * @description Time that it must stay the same, in milliseconds.
             */
            quietMs: number;
        };
        /** @description Named policies and standing rules that a decision is based on, beside the engineer's own policy. */
        DecisionBasis: {
            /**
             * @description The named policies that contributed to the precision, in their versions at that time; in
             *     consents only.
             * @default []
             */
            policies: components["schemas"]["DocumentVersion"][];
            /** @default null */
            policyId: components["schemas"]["DocumentId"] | null;
            /**
             * @description The rules that decided, each in its version at that time.
             * @default []
             */
            rules: components["schemas"]["DocumentVersion"][];
        };
        /** @description What is decided. */
        DecisionBody: {
            /** @description How values are coarsened; every change as it is without it. */
            disclosure?: components["schemas"]["DisclosurePolicy"];
            mapping?: components["schemas"]["MappingDraft"] | null;
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description Told to the partner; needed with `REFUSED`. */
            reason?: string | null;
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /** @description Entries that a page kept. */
        Delivery: {
            /** @description Up to 500, in any order. */
            entries: components["schemas"]["NewEntry"][];
            sentAt?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description Stable codes of diagnostics.
         * @enum {string}
         */
        DiagnosticCode: "tooMany" | "missing" | "invalidName" | "unknownName" | "invalidParameter" | "typeMismatch" | "lossyConversion" | "unknownUnit" | "incompatibleUnits" | "unitMismatch" | "syntax" | "workerUnavailable" | "scriptFault" | "closureState" | "unusedInput";
        /** @description What differs between two versions. */
        Difference: {
            /** @description The later mapping. */
            after: components["schemas"]["Mapping"];
            /** @description The earlier mapping. */
            before: components["schemas"]["Mapping"];
            /** @description What differs. */
            changes: components["schemas"]["MappingChange"][];
        };
        /**
         * @description Coarsening of a field's values before they are released. Empty: every change is released
         *     unchanged.
         *
         *     In this order: values in a withheld state are dropped, each window is aggregated, the number is
         *     banded or rounded and then cut to its significant digits; the result waits for its delay, the
         *     intervals and rates, the time step and the working hours.
         */
        DisclosurePolicy: {
            aggregate?: components["schemas"]["WindowAggregate"] | null;
            /**
             * @description Numbers are replaced by the greatest of these bounds not above them (by the lowest, if below
             *     all); ascending.
             */
            bands?: number[];
            /**
             * Format: int64
             * @description Delay of every value, in milliseconds.
             */
            delayMs?: number | null;
            /** @description Values are released only within all of these hours, too. */
            furtherHours?: components["schemas"]["WorkingHours"][];
            /**
             * Format: int64
             * @description Shortest time between two released values, in milliseconds; the latest value wins.
             */
            minimumIntervalMs?: number | null;
            /** @description Most released values per period; all of these limits apply. */
            rateLimits?: components["schemas"]["RateLimit"][];
            roundingStep?: components["schemas"]["RoundingStep"] | null;
            /**
             * Format: int32
             * @description Most significant digits of numbers, 1 to 15.
             */
            significantDigits?: number | null;
            /**
             * Format: int64
             * @description Times are rounded down to multiples of this many milliseconds since 1970, and values are
             *     released only at these times.
             */
            timeStepMs?: number | null;
            /** @description No value is released while one of these conditions is met; candidates of that time never are. */
            withholdWhile?: components["schemas"]["WithholdCondition"][];
            workingHours?: components["schemas"]["WorkingHours"] | null;
        };
        /** @description The id of a policy or rule, chosen by its author. */
        DocumentId: string;
        /** @description One version of a policy or rule. */
        DocumentVersion: {
            id: components["schemas"]["DocumentId"];
            /**
             * Format: int32
             * @description From 1, increases by one with every change.
             */
            version: number;
        };
        /** @description What would be decided. */
        Draft: {
            /** @description How values would be coarsened. */
            disclosure?: components["schemas"]["DisclosurePolicy"];
            mapping?: components["schemas"]["MappingDraft"] | null;
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description Where values would come from. */
            valueSource: components["schemas"]["ValueSource"];
        };
        /** @description A dynamic data request, unique within its network. One request is one DataSetWriter. */
        DynamicDataRequestId: string;
        /** @description Lets a Boolean (or a number: not zero is true) pass only when it changes. */
        Edge: {
            /** @description Change that passes. */
            direction: components["schemas"]["EdgeDirection"];
        };
        /**
         * @description A change of a Boolean.
         * @enum {string}
         */
        EdgeDirection: "rising" | "falling" | "both";
        /** @description Effect of one part of a policy. */
        Effect: {
            /** @description True when it changes this value or its times, or withholds it at present. */
            isFelt: boolean;
            kind: components["schemas"]["EffectKind"];
            /** @description The same as codes with parameters. */
            parts: components["schemas"]["StatementPart"][];
            /** @description Sentence in English. */
            text: string;
        };
        /**
         * @description A part of a policy.
         * @enum {string}
         */
        EffectKind: "WITHHELD" | "AGGREGATED" | "BANDED" | "ROUNDED" | "DIGITS" | "TIME_STEP" | "DELAYED" | "INTERVAL" | "RATE" | "HOURS";
        /** @description What became of it. */
        Entered: {
            /** @description Less than was entered is disclosed. */
            isCoarsened: boolean;
            /**
             * @description `DISCLOSED`, `UNCHANGED`, `WITHHELD` (it leaves later) or `SUPPRESSED` (the policy withholds
             *     the present state: it never leaves).
             */
            outcome: string;
            until?: components["schemas"]["DateTime"] | null;
        };
        /** @description A value that a person enters. */
        EnteredValue: {
            /** @description The value as plain JSON; 64-bit integers may be texts. */
            value: unknown;
        };
        /** @description An entry's id, made where it was entered: 1 to 64 letters, digits, `-` or `_`. */
        EntryId: string;
        /** @description What became of an entry. */
        EntryResult: {
            /** @description For `REFUSED`: why, as a code. */
            code?: string | null;
            /** @description The entry. */
            entryId: string;
            /** @description Fields that took a value from it. */
            fields: components["schemas"]["FieldResult"][];
            /** @description For `REFUSED`: why, and what to do. */
            message?: string | null;
            /** @enum {string} */
            result: "TAKEN" | "REPEATED" | "REFUSED";
        };
        EntryView: {
            operationNetworkId?: string | null;
            operationId?: string | null;
            dynamicDataRequestId?: string | null;
            fieldName?: string | null;
            policy?: components["schemas"]["DisclosurePolicy"] | null;
            mappingState?: components["schemas"]["MappingState"] | null;
            decidedBy?: string | null;
            dataSetWriterId?: number | null;
            epoch?: number | null;
            firstSequence?: number | null;
            lastSequence?: number | null;
            lastDeliveredSequence?: number | null;
        } & {
            /** @description When it was recorded. */
            at: string;
            /**
             * Format: date-time
             * @description For a report: when the platform said that it holds it.
             */
            deliveredAt?: string | null;
            /** @description Its hash, hexadecimal. */
            hash: string;
            /** @description `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or `REVOKED`. */
            kind: string;
            /** @description For a report: the message it left in last. */
            leftInMessage?: string | null;
            /**
             * @description The precision under each consent that the entry names, by field, in the words that the
             *     partner was told.
             */
            precision: {
                [key: string]: string;
            };
            /** @description The same as codes with parameters. */
            precisionParts: {
                [key: string]: components["schemas"]["StatementPart"][];
            };
            /** @description Whose chain. */
            recipientId: string;
            /**
             * Format: date-time
             * @description For a report: when the broker accepted it last.
             */
            sentAt?: string | null;
            /**
             * Format: int64
             * @description Its place in the chain.
             */
            sequence: number;
            value?: {
                [key: string]: unknown;
            } | null;
        };
        /** @description From the numbers of an enumeration to texts. */
        Enumeration: {
            /** @description The text for any other number; the number itself in digits where absent. */
            otherwise?: string | null;
            /** @description Number to text. */
            texts: components["schemas"]["EnumerationText"][];
        };
        /** @description The text of one number of an enumeration. */
        EnumerationText: {
            /** @description Text that is yielded. */
            text: string;
            /**
             * Format: int64
             * @description Number of the enumeration.
             */
            value: number;
        };
        /**
         * @description An arithmetic expression over `value` and the inputs by name.
         *
         *     Numbers, texts in quotes, `true` and `false`; `+ - * / // %`, comparisons, `&& || !`, `c ? a :
         *     b`; `min max abs round floor ceil trunc sqrt pow exp ln log10 clamp mod bit length upper lower
         *     trim text number`. `//` divides towards minus infinity; `/` of two integers is an integer where
         *     it comes out even. `+` joins texts.
         */
        Expression: {
            /** @description Text of the expression. */
            expression: string;
        };
        /** @description A factory: one connector, one PublisherId, one pair of addresses on the broker. */
        FactoryId: string;
        /**
         * @description Kinds of faults.
         * @enum {string}
         */
        FaultKind: "typeMismatch" | "outOfRange" | "decoding" | "scriptSyntax" | "scriptError" | "scriptTimeout" | "scriptOutOfMemory" | "scriptResult" | "scriptCrash" | "workerUnavailable" | "circuitOpen";
        /** @description A fault with its place and time, as shown to the engineer. */
        FaultRecord: {
            /** @description Time of the fault by the local clock. */
            at: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description The column in the script, from 1.
             */
            column?: number | null;
            /** @description Kind, for programs. */
            kind: components["schemas"]["FaultKind"];
            /**
             * Format: int32
             * @description The line in the script, from 1.
             */
            line?: number | null;
            /** @description Sentence that names the fault, without the value. */
            message: string;
            /** @description Index of the function in the chain; absent for the end of the chain. */
            step?: number | null;
        };
        /**
         * @description Kind of a field's difference.
         * @enum {string}
         */
        FieldChange: "ADDED" | "CHANGED" | "REMOVED";
        /** @description Difference of one field, with its effects. */
        FieldDifference: {
            change: components["schemas"]["FieldChange"];
            consent: components["schemas"]["ConsentEffect"];
            key: components["schemas"]["FieldKey"];
            mapping: components["schemas"]["MappingEffect"];
            /** @description Reasons for the engineer to read; empty where the field is new or removed. */
            reasons: components["schemas"]["ChangeReason"][];
        };
        /** @description One report field, addressed from the network down. */
        FieldKey: components["schemas"]["RequestKey"] & {
            /** @description The field's name within that report. */
            fieldName: components["schemas"]["FieldName"];
        };
        /** @description Information in one field. */
        FieldLeak: components["schemas"]["Statement"] & {
            /**
             * Format: double
             * @description Most information of one value, in bits; none for texts and other values without a bound.
             */
            bitsPerValue?: number | null;
            key: components["schemas"]["FieldKey"];
            measured: components["schemas"]["Measured"];
            /**
             * Format: int64
             * @description Resolution of the times of changes, in milliseconds; 0 when every change is released at once.
             */
            timeResolutionMs: number;
            /**
             * Format: double
             * @description Most values per hour; none when only the publishing interval limits them.
             */
            valuesPerHourMax?: number | null;
        };
        /** @description The name of a report field: a key of the payload. */
        FieldName: string;
        /** @description What became of a value of an entry. */
        FieldResult: components["schemas"]["Entered"] & {
            key: components["schemas"]["FieldKey"];
        };
        /** @description A requested field with its decision and value. */
        FieldView: {
            /** @description Who decided. */
            decidedBy?: string | null;
            /** @description Why it was decided so. */
            decisionReason?: string | null;
            decisionTime?: components["schemas"]["DateTime"] | null;
            /** @description More about it. */
            description?: string | null;
            /** @description How values are coarsened at least, as decided. */
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description The same as codes with parameters; none while undecided. */
            disclosureParts: components["schemas"]["StatementPart"][];
            /** @description The same in words, as the partner is told. */
            disclosureStatement?: string | null;
            /**
             * @description How they are coarsened: the strictest of that, of the named policy and of the recipients'
             *     policies.
             */
            effectiveDisclosure: components["schemas"]["DisclosurePolicy"];
            /** @description The named policy and the rules on whose grounds it was decided. */
            grounds: components["schemas"]["DecisionBasis"];
            /** @description A mapping is on trial beside the published one. */
            hasShadow: boolean;
            /** @description Nothing leaves at present: the policy withholds the present state, or one that is not known. */
            isWithheld: boolean;
            /** @description Its address. */
            key: components["schemas"]["FieldKey"];
            mapping?: components["schemas"]["Mapping"] | null;
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            /**
             * Format: int32
             * @description The number of the newest version of the mapping; none before the first.
             */
            mappingVersion?: number | null;
            /** @description Its name. */
            name: string;
            offer?: components["schemas"]["RuleOfferView"] | null;
            /** @description What it means. */
            semantic?: string | null;
            /** @description Its built-in type by name. */
            type: string;
            /** @description Its unit as requested. */
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
            /**
             * Format: int32
             * @description -1 scalar, 1 array.
             */
            valueRank: number;
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /** @description What was found. */
        Finds: {
            /**
             * @description False while the server is still being walked through (ask again), or where it is too large
             *     to be listed.
             */
            isComplete: boolean;
            /** @description The variables, those whose own name fits first, each with its browse path. */
            items: components["schemas"]["BrowsedNode"][];
            listedAt?: components["schemas"]["DateTime"] | null;
            /** @description How many fit in all. */
            total: number;
        };
        /**
         * @description Puts values into a text: `Order {value}: {temperature:.1} of {limit}`.
         *
         *     `{value}` is the chain's value, `{name}` an input. After a colon: an optional `0` and width
         *     (`{value:06}`), an optional number of decimals (`{value:.2}`). `{{` and `}}` are braces.
         */
        Format: {
            /** @description The text with its placeholders. */
            template: string;
        };
        /**
         * @description Reason for sequence numbers that will never come.
         * @enum {string}
         */
        GapCause: "COALESCED" | "EXPIRED" | "WITHDRAWN" | "REVOKED";
        /** @description Number of mappings by health. */
        HealthCounts: {
            /** @description So many `CLOCK_AHEAD`. */
            clockAhead: number;
            /** @description So many `DOUBTFUL`. */
            doubtful: number;
            /** @description So many `FAILING`. */
            failing: number;
            /** @description So many `RESTING`. */
            resting: number;
            /** @description So many `WAITING`. */
            waiting: number;
            /** @description So many `WELL`. */
            well: number;
        };
        /** @description Sign-in of the client on a server. */
        Identity: {
            /** @enum {string} */
            kind: "anonymous";
        } | {
            /** @enum {string} */
            kind: "userName";
            userName: string;
            password?: string;
        } | {
            /** @description The certificate, DER or PEM. */
            certificatePath: string;
            /** @enum {string} */
            kind: "certificate";
            /** @description Its private key, PEM. */
            privateKeyPath: string;
        };
        /** @description What an import did, or would do. */
        ImportOutcome: {
            /** @description Nothing was changed. */
            isDryRun: boolean;
            /** @description Each mapping that was not there already, in the order of the file. */
            items: components["schemas"]["PlacedMapping"][];
            /** @description Mappings that are offered with the decision about their field, which is not mapped. */
            proposed: number;
            /** @description Mappings that are the next version of their field and run, under the consent in force. */
            published: number;
            /** @description Templates that were new or other. */
            templates: number;
            /** @description Mappings that were there already. */
            unchanged: number;
        };
        /** @description A page of the inbox, and how many there are. */
        InboxPage: {
            /** @description Requests that the query means. */
            count: number;
            /** @description The requests. */
            items: components["schemas"]["RequestView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
            /** @description All requests and fields, whatever the query. */
            totals: components["schemas"]["InboxTotals"];
        };
        /** @description How the fields of all active networks stand. */
        InboxTotals: {
            /** @description Requests whose validity has ended. */
            endedRequests: number;
            /** @description Fields whose values flow. */
            mapped: number;
            /** @description Requests with an undecided field. */
            openRequests: number;
            /** @description Of them, those that have been open for longer than the time after which the inbox reminds. */
            overdueRequests: number;
            /** @description Undecided fields. */
            pending: number;
            /** @description Refused fields. */
            refused: number;
            /** @description Requests. */
            requests: number;
        };
        /** @description Increment of a counter since its last value. The first value yields nothing. */
        Increment: {
            modulus?: components["schemas"]["Number"] | null;
            /** @description Meaning of a decrease that is no wrap. */
            onDecrease?: components["schemas"]["OnDecrease"];
        };
        /**
         * Format: int64
         * @description A caller's own key of one input. The same variable may be monitored under several keys.
         */
        InputKey: number;
        /** @description Reason why an input has no value. */
        InputProblem: {
            input: components["schemas"]["InputKey"];
            nodeId: components["schemas"]["NodeId"];
            reason: string;
            /** @description Status of the server, or of the connector when the server gave none. */
            status: components["schemas"]["StatusCode"];
        };
        /** @description Last value of an input. */
        InputStatus: {
            /**
             * Format: int64
             * @description Difference of the source's clock to ours, in milliseconds, transport included; positive
             *     where the source is ahead.
             */
            clockAheadMs?: number | null;
            /** @description Name of the input in the mapping. */
            name: string;
            receivedAt?: components["schemas"]["DateTime"] | null;
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description A variable with what its machine says. */
        InputView: components["schemas"]["ShownValue"] & {
            /** @description Its name in the mapping. */
            name: string;
        };
        /** @description The certificate that an authority made of the request. */
        IssuedCertificateBody: {
            /**
             * @description PEM: the certificate, and those of its authorities up to the root unless the trust list has
             *     them, in any order. Or the certificate alone as DER in base64.
             */
            content: string;
        };
        /**
         * @description Treatment of a value whose source time lies before that of the newest value of the same
         *     variable.
         *
         *     A value is late by at most ten seconds. A longer step back is a source whose clock was set back,
         *     and the value is used.
         * @enum {string}
         */
        LateValues: "ignore" | "use";
        /** @description Information that a partner gets in total. */
        LeakBudget: {
            /**
             * Format: double
             * @description Most bits per hour; none when a field has no limit.
             */
            bitsPerHourMax?: number | null;
            fields: components["schemas"]["FieldLeak"][];
            /**
             * Format: double
             * @description Most values per hour; none when a field has no limit.
             */
            valuesPerHourMax?: number | null;
            /**
             * Format: double
             * @description Values per hour as measured.
             */
            valuesPerHourMeasured: number;
            warnings: components["schemas"]["LeakWarning"][];
        };
        /** @description Information that a partner gets in total, as a summary. */
        LeakSummary: {
            /**
             * Format: double
             * @description Most bits per hour; none when a field has no limit.
             */
            bitsPerHourMax?: number | null;
            /**
             * Format: double
             * @description Most information of one value of any field, in bits; none when a field has no bound.
             */
            bitsPerValueMax?: number | null;
            /** @description Possible conclusions, each once. */
            conclusions: components["schemas"]["Conclusion"][];
            fieldCount: number;
            /**
             * Format: int64
             * @description Finest resolution of the times of changes of any field, in milliseconds; 0 when every change
             *     is released at once.
             */
            timeResolutionMs: number;
            /**
             * Format: double
             * @description Most values per hour; none when a field has no limit.
             */
            valuesPerHourMax?: number | null;
            /**
             * Format: double
             * @description Values per hour as measured.
             */
            valuesPerHourMeasured: number;
            /** @description Number of warnings in the full budget. */
            warningCount: number;
        };
        /** @description Warning about a conclusion that a partner can draw. */
        LeakWarning: {
            /** @description The conclusion, as a code with the other members as parameters. */
            conclusion: components["schemas"]["Conclusion"];
            /** @description The fields that allow the conclusion. */
            fields: components["schemas"]["FieldKey"][];
            /**
             * Format: int64
             * @description Resolution of times that prevents the conclusion, in milliseconds, if one does.
             */
            neededMs?: number | null;
            /**
             * Format: int64
             * @description Planned time of a piece in milliseconds, for `CYCLE_TIME` and when the plan has one.
             */
            pieceMs?: number | null;
            /** @description English text, with the remedy. */
            text: string;
        };
        /** @description A difference from what was written. */
        LedgerFault: {
            /** @description Description of the fault. */
            message: string;
            /**
             * Format: int64
             * @description Number of the entry or checkpoint.
             */
            number: number;
            /** @description Organisation of the chain; empty when no single chain is affected. */
            recipient: string;
        };
        /** @description A field that the ledger speaks of, requested still or no more. */
        LedgerField: {
            /** @description Its address. */
            key: components["schemas"]["FieldKey"];
        };
        /** @description Entries of one chain, newest first. */
        LedgerView: {
            /** @description The entries. */
            items: components["schemas"]["EntryView"][];
            /** @description Where the next page begins. */
            nextCursor?: string | null;
            /** @description Every recipient that has a chain. */
            recipients: string[];
        };
        /** @description A value: plain text, Boolean or number, or an object with its type. */
        Literal: string | boolean | number | {
            /** @description The built-in type. */
            type: components["schemas"]["TypeName"];
            /** @description The value; 64-bit integers as text. */
            value: unknown;
        };
        /** @description From values to values by a table. */
        Lookup: {
            /** @description The table. Numbers match by value whatever their types, texts exactly. */
            entries: components["schemas"]["LookupEntry"][];
            /** @description Between two numeric entries, interpolate linearly; outside, the nearest entry. */
            interpolate?: boolean;
            otherwise?: components["schemas"]["Literal"] | null;
        };
        /** @description One line of a lookup table. */
        LookupEntry: {
            /** @description The value that comes in. */
            from: components["schemas"]["Literal"];
            /** @description The value that goes out. */
            to: components["schemas"]["Literal"];
        };
        /** @description From local variables to a requested field. */
        Mapping: {
            /** @description The variables it reads. The first one enters the chain. */
            inputs: components["schemas"]["MappingInput"][];
            /** @description Treatment of values that arrive after newer ones of the same variable. */
            lateValues?: components["schemas"]["LateValues"];
            /** @description Its identity within the connector. */
            mappingId: components["schemas"]["MappingId"];
            /** @description The functions, applied in this order. */
            steps?: components["schemas"]["Step"][];
            /** @description The report field that gets the values. */
            target: components["schemas"]["FieldKey"];
            /** @description The built-in type of the field; what leaves the chain is of this type or a fault. */
            targetType: components["schemas"]["TypeName"];
            /** @description The unit the partner asked for (UNECE code or alias). */
            targetUnit?: string | null;
            /**
             * Format: int32
             * @description The ValueRank of the field: -1 scalar (default), 1 array, n matrix.
             */
            targetValueRank?: number;
        };
        /** @description One difference. */
        MappingChange: {
            /** @description Value in the later version; absent where it was taken away. */
            after?: unknown;
            /** @description Value in the earlier version; absent where it is new. */
            before?: unknown;
            /**
             * @description JSON pointer into the mapping: of the later version, or of the earlier one where something
             *     was taken away.
             */
            pointer: string;
        };
        /** @description Diagnostic of a mapping. */
        MappingDiagnostic: {
            /** @description A stable code in camelCase. */
            code: components["schemas"]["DiagnosticCode"];
            /**
             * Format: int32
             * @description The column in the expression or script, from 1.
             */
            column?: number | null;
            /**
             * Format: int32
             * @description The line in the expression or script, from 1.
             */
            line?: number | null;
            /** @description Fault and remedy, in a sentence. */
            message: string;
            /** @description JSON pointer into the mapping, as `/steps/2/factor`. */
            pointer: string;
            /** @description Severity; a mapping with an error does not run. */
            severity: components["schemas"]["Severity"];
        };
        /** @description From local variables to a field: inputs and functions. */
        MappingDraft: {
            /** @description The variables. */
            inputs: components["schemas"]["MappingInput"][];
            /** @description What happens to values that arrive after newer ones of the same variable. */
            lateValues?: components["schemas"]["LateValues"];
            /** @description The functions, applied in this order. */
            steps?: components["schemas"]["Step"][];
        };
        /**
         * @description Effect of a difference on a mapping.
         * @enum {string}
         */
        MappingEffect: "KEPT" | "OFFERED_AGAIN" | "SUGGESTED" | "REMOVED";
        /** @description Mappings and templates as one JSON document. */
        MappingFile: {
            /** @description Mappings without a template. */
            mappings?: components["schemas"]["Mapping"][];
            /** @description Templates for series of like machines. */
            templates?: components["schemas"]["MappingTemplate"][];
            /**
             * Format: int32
             * @description The format's version: 1.
             */
            version: number;
        };
        /**
         * @description Health of a mapping; the worst first.
         * @enum {string}
         */
        MappingHealth: "RESTING" | "FAILING" | "WAITING" | "DOUBTFUL" | "CLOCK_AHEAD" | "WELL";
        /** @description A mapping's identity within a connector. */
        MappingId: string;
        /** @description A variable of a local server, under the name that expressions and scripts use. */
        MappingInput: {
            /** @description Monitoring of the variable: sampling, queue, browse path to find it again, part of an array. */
            monitor?: components["schemas"]["MonitorOptions"];
            /** @description `[A-Za-z_][A-Za-z0-9_]*`, unique within the mapping, not `value`. */
            name: string;
            /** @description The variable, with its namespace's URI. */
            nodeId: components["schemas"]["NodeId"];
            /** @description The local server. */
            sourceId: components["schemas"]["SourceId"];
            /**
             * @description True where a change of this variable makes the mapping run; otherwise it is only read when
             *     another one changes.
             */
            triggers?: boolean;
            /** @description The variable's unit as seen when it was picked (UNECE code or alias). */
            unit?: string | null;
            valueType?: components["schemas"]["TypeName"] | null;
        };
        /**
         * @description State of a field's decision.
         * @enum {string}
         */
        MappingState: "PENDING" | "MAPPED" | "REFUSED";
        /** @description Status of a mapping, for its page. */
        MappingStatus: {
            /** @description State of the circuit breakers of its scripts. */
            circuit: components["schemas"]["CircuitState"];
            /**
             * Format: int64
             * @description Number of times that a source's clock was set back.
             */
            clockSteps: number;
            /**
             * Format: int64
             * @description Number of faults since the mapping was published.
             */
            faults: number;
            /** @description Last value of each input, in the mapping's order. */
            inputs: components["schemas"]["InputStatus"][];
            lastCandidate?: components["schemas"]["TracedValue"] | null;
            lastFault?: components["schemas"]["FaultRecord"] | null;
            lastYieldedAt?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int64
             * @description Values that were late.
             */
            late: number;
            mappingId: components["schemas"]["MappingId"];
            /**
             * Format: int64
             * @description Values that came.
             */
            received: number;
            /**
             * Format: int64
             * @description Values that were repeats.
             */
            repeated: number;
            /**
             * Format: int64
             * @description Time spent on it, in microseconds.
             */
            spentUs: number;
            /**
             * Format: int64
             * @description Values that newer ones replaced because a script did not keep up.
             */
            superseded: number;
            /** @description Field that gets the candidates. */
            target: components["schemas"]["FieldKey"];
            /**
             * Format: int64
             * @description Candidates that went out.
             */
            yielded: number;
        };
        /** @description Health of the published mappings, without shadow mappings. */
        MappingSurvey: {
            /** @description Numbers of all published mappings. */
            counts: components["schemas"]["HealthCounts"];
            /**
             * @description The worst of those that were asked for; of two that are doing alike, the one with more
             *     faults first.
             */
            items: components["schemas"]["SurveyedMapping"][];
        };
        /** @description A mapping with gaps. */
        MappingTemplate: {
            /** @description Purpose, for people. */
            description?: string | null;
            /** @description The JSON of a mapping with placeholders. */
            mapping: unknown;
            /** @description Name for people. */
            name?: string | null;
            /** @description The parameters, for the form that asks for them. */
            parameters: components["schemas"]["TemplateParameter"][];
            /** @description Its identity within the connector. */
            templateId: string;
        };
        /** @description Counts over a period. */
        Measured: {
            /**
             * Format: int64
             * @description Candidates from the source.
             */
            candidates: number;
            /**
             * Format: double
             * @description Length of the period in hours, at most 24; since the connector started or the field was
             *     opened.
             */
            hours: number;
            /**
             * Format: int64
             * @description Values that the gate released.
             */
            released: number;
        };
        /** @description One value from several inputs. */
        Merge: {
            /** @description The names of the inputs, in their order of precedence; all where empty. */
            inputs?: string[];
            /** @description Rule by which the inputs become one value. */
            rule: components["schemas"]["MergeRule"];
            /** @description Separator between the texts of `join`. */
            separator?: string | null;
        };
        /**
         * @description Rule by which several inputs become one value.
         * @enum {string}
         */
        MergeRule: "newest" | "firstGood" | "minimum" | "maximum" | "sum" | "mean" | "all" | "any" | "join" | "array";
        /**
         * @description Protection of messages.
         * @enum {string}
         */
        MessageSecurity: "none" | "sign" | "signAndEncrypt";
        /** @description Options of a monitored variable. */
        MonitorOptions: {
            browsePath?: components["schemas"]["BrowsePath"] | null;
            /** @description Only a part of an array, as OPC 10000-4 §7.27 writes it: `2` or `1:3`. */
            indexRange?: string | null;
            /**
             * Format: int32
             * @description Changes that the server queues between two publishings. Default: enough for the sampling and
             *     publishing interval, so that no change is lost.
             */
            queueSize?: number | null;
            /**
             * Format: double
             * @description Sampling interval of the server, in milliseconds. 0: on every change. Default: the
             *     publishing interval of the source.
             */
            samplingIntervalMs?: number | null;
        };
        /** @description A policy with a name, which can be chosen for fields and set for recipients. */
        NamedPolicy: {
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description True when it is no longer offered or applied. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        };
        /** @description Differences between two revisions of a network. */
        NetworkDifference: {
            /**
             * @description Every field of the old and the new network with what becomes of it; untouched ones are left
             *     out.
             */
            fields: components["schemas"]["FieldDifference"][];
            /** @description The network's own name or description. */
            isDescribedAnew: boolean;
            /** @description Operations, without regard to their requests. */
            operations: components["schemas"]["Changes_OperationId"];
            /** @description Relations with their conditions. */
            relations: components["schemas"]["Changes_OperationRelationId"];
            /** @description Requests, without regard to their fields. */
            requests: components["schemas"]["Changes_RequestKey"];
        };
        /** @description What the revision in force changed. */
        NetworkNews: {
            /**
             * @description What differs: operations, relations, requests, and each field with the reasons and with what
             *     became of its mapping and of the consent.
             */
            difference: components["schemas"]["NetworkDifference"];
            /**
             * Format: int64
             * @description The one before it, where there was one.
             */
            previousRevision?: number | null;
            /**
             * Format: int64
             * @description The revision in force.
             */
            revision: number;
        };
        /** @description A network in short. */
        NetworkSummary: {
            collaborationId?: string | null;
            fieldCount: number;
            isWithdrawn: boolean;
            name?: string | null;
            operationNetworkId: string;
            pendingCount: number;
            receivedAt: components["schemas"]["DateTime"];
            requestCount: number;
            /** Format: int64 */
            revision: number;
        };
        /** @description A network with its requests. */
        NetworkView: {
            /** @description The message as received; none once withdrawn. */
            message?: unknown;
            /** @description Its requests. */
            requests: components["schemas"]["RequestView"][];
            /**
             * Format: int64
             * @description Its revision.
             */
            revision: number;
        };
        /** @description A remark to make. */
        NewComment: {
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            fieldName?: components["schemas"]["FieldName"] | null;
            text: string;
        };
        /** @description An entry as the page made it. */
        NewEntry: components["schemas"]["OperationKey"] & components["schemas"]["Action"] & {
            /**
             * @description Made by the page, 1 to 64 letters, digits, `-` or `_`; an entry that comes again has no
             *     further effect.
             */
            entryId: components["schemas"]["EntryId"];
            /** @description When it was made, by the page's clock. */
            madeAt: components["schemas"]["DateTime"];
        };
        /**
         * @description Node classes (OPC 10000-3 §5.2.3).
         * @enum {string}
         */
        NodeClass: "object" | "variable" | "method" | "objectType" | "variableType" | "referenceType" | "dataType" | "view";
        /**
         * @description A NodeId as text; its namespace by URI.
         * @example nsu=urn:press;s=Cell.Counter
         */
        NodeId: string;
        /** @description A type's identity and name. */
        NodeType: {
            /** @description Its browse name without the namespace; empty where the server does not know the type. */
            name: string;
            nodeId: components["schemas"]["NodeId"];
        };
        /** @description A number; integers beyond 2^53 as text. */
        Number: number | string;
        /**
         * @description Meaning of a counter's decrease that is no wrap.
         * @enum {string}
         */
        OnDecrease: "reset" | "set" | "subtract";
        /** @description An operation, unique within its network. */
        OperationId: string;
        /** @description An operation of a network. */
        OperationKey: {
            /** @description The operation in it. */
            operationId: components["schemas"]["OperationId"];
            /** @description The network. */
            operationNetworkId: components["schemas"]["OperationNetworkId"];
        };
        /** @description An operation network, unique on a platform. */
        OperationNetworkId: string;
        /**
         * @description The state of an operation after the ISA-95 job states (OPC 10031-4).
         * @enum {string}
         */
        OperationState: "NotAllowedToStart" | "AllowedToStart" | "Running" | "Interrupted" | "Ended" | "Aborted";
        /** @description An entry as kept. */
        OperatorEntry: components["schemas"]["OperationKey"] & components["schemas"]["Action"] & {
            /** @description Made where it was entered. */
            entryId: components["schemas"]["EntryId"];
            /** @description When it was entered, by the connector's clock. */
            madeAt: components["schemas"]["DateTime"];
            /** @description Who. */
            madeBy: string;
            /** @description When it came here. */
            receivedAt: components["schemas"]["DateTime"];
        };
        /** @description A field that takes entered values. */
        OperatorField: {
            description?: string | null;
            /** @description What was entered last, as it was before the gate. */
            entered?: unknown;
            enteredAt?: components["schemas"]["DateTime"] | null;
            /** @description The value follows from the buttons; it can be typed all the same. */
            hasButton: boolean;
            key: components["schemas"]["FieldKey"];
            name: string;
            semantic?: string | null;
            type: string;
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
        };
        /** @description An operation as the operator sees it. */
        OperatorOperation: components["schemas"]["OperationKey"] & {
            buttons: components["schemas"]["Buttons"];
            description?: string | null;
            /** @description The fields that take entered values. */
            fields: components["schemas"]["OperatorField"][];
            name?: string | null;
            networkName?: string | null;
            /** @description `PRODUCTION`, `INSPECTION` or `TRANSPORTATION`. */
            operationType: string;
            plannedEnd?: components["schemas"]["DateTime"] | null;
            /** Format: double */
            plannedQuantity?: number | null;
            plannedStart?: components["schemas"]["DateTime"] | null;
            quantityUnit?: string | null;
            /** @description By the entries so far. */
            standing: components["schemas"]["Standing"];
        };
        /** @description An organisation that takes part in collaborations. */
        OrganisationId: string;
        /**
         * @description Treatment of a number outside the wanted type's range.
         * @enum {string}
         */
        Overflow: "fault" | "clamp";
        /** @description A page of a list. */
        Page_BrowsedNode: {
            /** @description The items. */
            items: components["schemas"]["BrowsedNode"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_CheckpointView: {
            /** @description The items. */
            items: components["schemas"]["CheckpointView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientAuthorityView: {
            /** @description The items. */
            items: components["schemas"]["ClientAuthorityView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientCertificateView: {
            /** @description The items. */
            items: components["schemas"]["ClientCertificateView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientRevocationListView: {
            /** @description The items. */
            items: components["schemas"]["ClientRevocationListView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_DeadLetter: {
            /** @description The items. */
            items: components["schemas"]["DeadLetter"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_EntryResult: {
            /** @description The items. */
            items: components["schemas"]["EntryResult"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_LedgerField: {
            /** @description The items. */
            items: components["schemas"]["LedgerField"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_NetworkSummary: {
            /** @description The items. */
            items: components["schemas"]["NetworkSummary"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_OperatorEntry: {
            /** @description The items. */
            items: components["schemas"]["OperatorEntry"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_OperatorOperation: {
            /** @description The items. */
            items: components["schemas"]["OperatorOperation"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PartnerLeaks: {
            /** @description The items. */
            items: components["schemas"]["PartnerLeaks"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PartnerSummary: {
            /** @description The items. */
            items: components["schemas"]["PartnerSummary"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PeerCertificate: {
            /** @description The items. */
            items: components["schemas"]["PeerCertificate"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PolicyUse: {
            /** @description The items. */
            items: components["schemas"]["PolicyUse"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PolicyView: {
            /** @description The items. */
            items: components["schemas"]["PolicyView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_RecipientView: {
            /** @description The items. */
            items: components["schemas"]["RecipientView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_RuleDecision: {
            /** @description The items. */
            items: components["schemas"]["RuleDecision"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Setting: {
            /** @description The items. */
            items: components["schemas"]["Setting"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_SourceView: {
            /** @description The items. */
            items: components["schemas"]["SourceView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_StoredComment: {
            /** @description The items. */
            items: components["schemas"]["StoredComment"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_StoredRevocation: {
            /** @description The items. */
            items: components["schemas"]["StoredRevocation"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_TemplateView: {
            /** @description The items. */
            items: components["schemas"]["TemplateView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_UserView: {
            /** @description The items. */
            items: components["schemas"]["UserView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_VersionView: {
            /** @description The items. */
            items: components["schemas"]["VersionView"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_NamedPolicy: {
            /** @description The items. */
            items: components["schemas"]["Versioned_NamedPolicy"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_Rule: {
            /** @description The items. */
            items: components["schemas"]["Versioned_Rule"][];
            /** @description Where the next page begins; none on the last. */
            nextCursor?: string | null;
        };
        /** @description Takes a value out of a text. */
        Parse: {
            /** @description A comma is the decimal sign, points group digits. */
            decimalComma?: boolean;
            /**
             * @description Position of the value: `{}` is the value, `*` any text, all else itself (`Temp={} *`). The
             *     whole text where absent.
             */
            pattern?: string | null;
            /**
             * Format: int32
             * @description The base of an integer: 2 to 36.
             */
            radix?: number | null;
            /** @description The type of the value. */
            to: components["schemas"]["TypeName"];
        };
        /** @description What one partner learns. */
        PartnerLeaks: components["schemas"]["LeakBudget"] & {
            /** @description The organisation: a requester or a recipient. */
            partner: components["schemas"]["OrganisationId"];
        };
        /** @description What one partner learns, in short. */
        PartnerSummary: components["schemas"]["LeakSummary"] & {
            /** @description The organisation: a requester or a recipient. */
            partner: components["schemas"]["OrganisationId"];
        };
        /** @description Certificate that a server has presented. */
        PeerCertificate: {
            /** @description The length of its RSA key in bits. */
            keyBits?: number | null;
            /** @description Distinguished name of the subject. */
            subject: string;
            /** @description SHA-1 thumbprint, hex. */
            thumbprint: string;
            trust: components["schemas"]["TrustState"];
            validFrom?: components["schemas"]["DateTime"] | null;
            validTo?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description What a counted piece is.
         * @enum {string}
         */
        Piece: "GOOD" | "SCRAP";
        /**
         * @description What placing a mapping does or would do.
         * @enum {string}
         */
        Placed: "PUBLISHED" | "PROPOSED" | "UNCHANGED";
        /** @description What became of a mapping. */
        PlacedMapping: {
            /** @description Its field. */
            key: components["schemas"]["FieldKey"];
            /** @description What became of it. */
            outcome: components["schemas"]["Placed"];
        };
        /** @description What a change of a policy would do to a field. */
        PolicyUse: components["schemas"]["Statement"] & {
            /** @description The field. */
            key: components["schemas"]["FieldKey"];
            /** @description What it would read with the draft. */
            statementThen: string;
            /** @description The same as codes with parameters. */
            statementThenParts: components["schemas"]["StatementPart"][];
        };
        /** @description A named policy and where it holds. */
        PolicyView: components["schemas"]["Versioned_NamedPolicy"] & components["schemas"]["Statement"] & {
            /** @description How many mapped fields take it by name. */
            fieldCount: number;
            /** @description The recipients that it is set for. */
            recipients: components["schemas"]["OrganisationId"][];
        };
        /** @description Side by side: machine, mapping, what is disclosed, and the message. */
        Preview: components["schemas"]["Statement"] & {
            candidate?: components["schemas"]["ShownValue"] | null;
            /** @description What is wrong or doubtful about the mapping. */
            diagnostics: components["schemas"]["MappingDiagnostic"][];
            disclosed?: components["schemas"]["ShownValue"] | null;
            disclosedAt?: components["schemas"]["DateTime"] | null;
            /**
             * @description The precision that would hold: the strictest of the draft, the named policy and the
             *     recipients' policies.
             */
            effectiveDisclosure: components["schemas"]["DisclosurePolicy"];
            /** @description What each part of it does to this value. */
            effects: components["schemas"]["Effect"][];
            /** @description What the machines say. */
            inputs: components["schemas"]["InputView"][];
            /** @description Nothing would leave now: the policy withholds the present state, or one that is not known. */
            isWithheld: boolean;
            /**
             * @description The NetworkMessage that the partner would receive, byte for byte but for its id, numbers and
             *     times.
             */
            message?: string | null;
            /** @description What the mapping makes of it, function by function. */
            steps: components["schemas"]["StepView"][];
            /** @description What partners could conclude if this were decided. */
            warnings: components["schemas"]["LeakWarning"][];
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
            /**
             * Format: int64
             * @description After how many seconds trying again makes sense; also the header `Retry-After`.
             */
            retryAfterSeconds?: number | null;
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
        /** @description Change per time, by the source's times, as Double. The first value yields nothing. */
        Rate: {
            /** @description Time that the rate refers to. */
            per?: components["schemas"]["RatePeriod"];
        };
        /** @description Most values that are released within any period of this length. */
        RateLimit: {
            /**
             * Format: int64
             * @description The period in milliseconds.
             */
            periodMs: number;
            /**
             * Format: int32
             * @description Number of values, 1 to 100.
             */
            values: number;
        };
        /**
         * @description The time that a rate refers to.
         * @enum {string}
         */
        RatePeriod: "second" | "minute" | "hour" | "day";
        /** @description A piece of evidence. */
        Reason: {
            /** @description Kind of evidence, for programs. */
            kind: components["schemas"]["ReasonKind"];
            /**
             * Format: int32
             * @description Its weight; negative where it speaks against.
             */
            points: number;
            /** @description In a sentence. */
            text: string;
        };
        /**
         * @description Kinds of evidence.
         * @enum {string}
         */
        ReasonKind: "name" | "semantic" | "place" | "description" | "type" | "unit" | "companionType" | "value" | "decision";
        /** @description Which policy holds for everything a recipient gets. */
        RecipientBody: {
            policyId?: components["schemas"]["DocumentId"] | null;
        };
        /** @description The policy that is set for everything one recipient gets. */
        RecipientPolicy: {
            /** @description When. */
            changedAt: components["schemas"]["DateTime"];
            /** @description Who set it. */
            changedBy: string;
            policyId?: components["schemas"]["DocumentId"] | null;
            /**
             * Format: int32
             * @description From 1, one more with every change.
             */
            version: number;
        };
        /** @description What was set. */
        RecipientVersion: {
            /**
             * Format: int32
             * @description Counts the changes.
             */
            version: number;
        };
        /** @description A recipient and the policy set for it. */
        RecipientView: {
            /** @description How many mapped fields it gets. */
            fieldCount: number;
            /** @description The organisation. */
            recipient: components["schemas"]["OrganisationId"];
            set?: components["schemas"]["RecipientPolicy"] | null;
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
        /** @description A request of a partner. */
        RequestView: {
            /**
             * Format: int32
             * @description Its DataSetWriter.
             */
            dataSetWriterId?: number | null;
            /** @description More about it. */
            description?: string | null;
            /** @description Its fields. */
            fields: components["schemas"]["FieldView"][];
            /** @description That time is over: nothing leaves any more. */
            hasEnded: boolean;
            /** @description It has waited for more than a day. */
            isOverdue: boolean;
            /** @description Its address. */
            key: components["schemas"]["RequestKey"];
            /** @description What the network is called. */
            networkName?: string | null;
            openSince?: components["schemas"]["DateTime"] | null;
            operation: components["schemas"]["OperationSummary"];
            /** @description What for. */
            purpose: string;
            /** @description When this revision came. */
            receivedAt: components["schemas"]["DateTime"];
            /** @description Who may see the answers. */
            recipientList: components["schemas"]["OrganisationId"][];
            /** @description What the report is called. */
            reportName: string;
            /** @description Who asks. */
            requesterId: string;
            /**
             * Format: int64
             * @description How often the partner wants to hear, as the time between two reports in milliseconds.
             */
            updateIntervalMs?: number | null;
            validFrom?: components["schemas"]["DateTime"] | null;
            validUntil?: components["schemas"]["DateTime"] | null;
        };
        /** @description Whose consent ends: single fields, or everything that the other members name together. */
        RevocationBody: {
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            /** @description These fields. */
            fields?: components["schemas"]["FieldKey"][];
            mappingState?: components["schemas"]["MappingState"] | null;
            operationId?: components["schemas"]["OperationId"] | null;
            operationNetworkId?: components["schemas"]["OperationNetworkId"] | null;
            /** @description Told to the partner; needed with `REFUSED`. */
            reason?: string | null;
            recipientId?: components["schemas"]["OrganisationId"] | null;
        };
        /**
         * @description Whether an authority's list of revoked certificates is here.
         * @enum {string}
         */
        RevocationListState: "CURRENT" | "OUTDATED" | "MISSING";
        /**
         * @description Statement about the reports that had left when a consent ended. It is signed with the ledger's key
         *     and never deleted.
         */
        RevocationReceipt: {
            /** @description `REVOKED`, or `WITHDRAWN` by the partner. */
            cause: components["schemas"]["GapCause"];
            factoryId: components["schemas"]["FactoryId"];
            /** @description The fields with the consents that ended. */
            fields: components["schemas"]["RevokedField"][];
            reason?: string | null;
            revocationId: string;
            /** @description Time of the end; no value of these fields left afterwards. */
            revokedAt: components["schemas"]["DateTime"];
            /** @description User who ended the consent; none when the partner withdrew or changed the request. */
            revokedBy?: string | null;
            /** @description The data sets that contained them. */
            writers: components["schemas"]["RevokedWriter"][];
        };
        /** @description A field whose consent ended. */
        RevokedField: {
            /**
             * Format: int32
             * @description Number of the consent that ended.
             */
            consentVersion: number;
            field: components["schemas"]["FieldKey"];
        };
        /** @description Delivery of a data set until the end of the consent. */
        RevokedWriter: {
            /** Format: int32 */
            dataSetWriterId: number;
            /**
             * Format: int32
             * @description The writer's epoch until then.
             */
            epoch: number;
            /** @description Sent without a confirmation: they may have arrived, and are not sent again. */
            inFlight: components["schemas"]["Sequences"][];
            /**
             * Format: int32
             * @description The last sequence number that the platform confirmed.
             */
            lastDeliveredSequence?: number | null;
            /**
             * Format: int32
             * @description The last sequence number given to a report; none when there was no report.
             */
            lastQueuedSequence?: number | null;
            /**
             * Format: int32
             * @description The last sequence number that the broker accepted.
             */
            lastSentSequence?: number | null;
            /** @description Organisations that received it. */
            recipientList: components["schemas"]["OrganisationId"][];
            /** @description The request that it reported for. */
            request: components["schemas"]["RequestKey"];
            /** @description Queued and withdrawn: they never left. */
            takenBack: components["schemas"]["Sequences"][];
        };
        /**
         * @description Rights of a person.
         * @enum {string}
         */
        Role: "ENGINEER" | "OPERATOR" | "VIEWER";
        /**
         * @description Rounding of a fraction to an integer.
         * @enum {string}
         */
        Rounding: "nearest" | "halfEven" | "down" | "up" | "towardZero" | "exact";
        /**
         * Format: double
         * @description A positive decimal with at most 15 significant digits: values are rounded to multiples of it.
         */
        RoundingStep: number;
        /** @description A standing rule. */
        Rule: {
            action: components["schemas"]["RuleAction"];
            /** @description The precision, with `ACCEPT` and `PREFILL`. */
            disclosure?: components["schemas"]["DisclosurePolicy"];
            /** @description True when it is applied to new requests. */
            isEnabled?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description Reason for the partner, with `REFUSE`. */
            reason?: string | null;
            valueSource?: components["schemas"]["ValueSource"] | null;
            /** @description Selection of fields. */
            when: components["schemas"]["RuleCondition"];
        };
        /**
         * @description Action of a rule for the fields that it matches.
         * @enum {string}
         */
        RuleAction: "ACCEPT" | "PREFILL" | "REFUSE";
        /** @description Selection of fields: those that every list contains. An empty list matches all. */
        RuleCondition: {
            /**
             * @description Built-in types by name.
             * @default []
             */
            dataTypes: string[];
            namePattern?: string | null;
            /**
             * @description Organisations. A rule that accepts or pre-fills matches requests of which the requester and
             *     *every* recipient are listed; a rule that refuses, requests of which any is.
             * @default []
             */
            partners: components["schemas"]["OrganisationId"][];
            /**
             * @description Semantics as requested.
             * @default []
             */
            semantics: string[];
            /**
             * @description Units as requested.
             * @default []
             */
            units: string[];
        };
        /** @description A decision of standing rules, with its undoing if there was one. */
        RuleDecision: {
            /** @description `ACCEPT` or `REFUSE`. */
            action: string;
            /**
             * Format: int32
             * @description Number of the consent that the decision made.
             */
            consentVersion: number;
            decidedAt: components["schemas"]["DateTime"];
            field: components["schemas"]["FieldKey"];
            /** @description Number of the decision, as text. */
            id: string;
            /** @description The rules, in the versions that decided. */
            rules: components["schemas"]["DocumentVersion"][];
            undoneAt?: components["schemas"]["DateTime"] | null;
            /** @description The person who undid it; none while it is in force. */
            undoneBy?: string | null;
        };
        /** @description A field that a rule means. */
        RuleMatch: {
            /** @description The field. */
            key: components["schemas"]["FieldKey"];
            /** @description `PENDING`, `MAPPED` or `REFUSED`: only undecided fields would be decided. */
            mappingState: components["schemas"]["MappingState"];
            /** @description What the rule says. */
            offer: components["schemas"]["RuleOfferView"];
            /** @description It is undecided and no engineer has left it open: the rule would decide now. */
            wouldDecide: boolean;
        };
        /** @description What standing rules say about a field. */
        RuleOfferView: components["schemas"]["Statement"] & {
            /** @description What they come to. */
            action: components["schemas"]["RuleAction"];
            /** @description The precision. */
            disclosure: components["schemas"]["DisclosurePolicy"];
            mapping?: components["schemas"]["Mapping"] | null;
            /** @description What the partner would be told. */
            reason?: string | null;
            /** @description The rules, the one that gives reason and source first. */
            rules: components["schemas"]["RuleReference"][];
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /** @description What a rule would match. */
        RulePreview: {
            /** @description All fields it means. */
            count: number;
            /** @description At most 500 of them, those it would decide first. */
            items: components["schemas"]["RuleMatch"][];
            /** @description Of them, those it would decide now. */
            wouldDecideCount: number;
        };
        /** @description A rule by name. */
        RuleReference: components["schemas"]["DocumentVersion"] & {
            /** @description What it is called. */
            name: string;
        };
        /**
         * @description `value * factor / divisor + offset`. Integers stay integers (of 64 bits) where factor, divisor
         *     and offset are and the division comes out even.
         */
        Scale: {
            /** @description Divisor of the product; not zero. */
            divisor?: components["schemas"]["Number"];
            /** @description Factor of the value. */
            factor?: components["schemas"]["Number"];
            /** @description Summand added at the end. */
            offset?: components["schemas"]["Number"];
        };
        /**
         * @description A JavaScript function `(value, ctx) => ...`, run in a worker process.
         *
         *     `ctx.state` is kept between calls (at most 4 KiB as JSON) and survives restarts; variables
         *     outside the function do not. `ctx.inputs.<name>` has `value`, `status` and `sourceTimestamp`,
         *     `ctx.status` and `ctx.sourceTimestamp` are those of `value`. 64-bit integers are BigInt.
         *     `undefined` yields nothing, `null` no value.
         */
        Script: {
            /** @description The source text. */
            source: string;
        };
        /** @description A server that was looked through. */
        SearchedSource: {
            /**
             * @description False while the list is being made, or where the server has more than is listed: ask again,
             *     or search by hand.
             */
            isComplete: boolean;
            listedAt?: components["schemas"]["DateTime"] | null;
            /** @description Why it could not be looked through. */
            problem?: string | null;
            /** @description The server. */
            sourceId: components["schemas"]["SourceId"];
            /** @description How many variables it has. */
            variables: number;
        };
        /** @description Choice among a server's endpoints. */
        SecurityChoice: {
            /** @enum {string} */
            choice: "strongest";
        } | {
            /** @enum {string} */
            choice: "none";
        } | {
            /** @enum {string} */
            choice: "exactly";
            /** @description Signed only, or encrypted too. */
            mode: components["schemas"]["MessageSecurity"];
            policy: components["schemas"]["SecurityPolicy"];
        };
        /**
         * @description Security policies (OPC 10000-7) that are not deprecated.
         * @enum {string}
         */
        SecurityPolicy: "None" | "Aes128Sha256RsaOaep" | "Basic256Sha256" | "Aes256Sha256RsaPss";
        /** @description Picks an element of an array or a field of a structure. */
        Select: {
            /** @description Field names and 0-based indexes, as `Axes[2].Position` or `[0]`. */
            path: string;
        };
        /** @description A range of consecutive sequence numbers. */
        Sequences: {
            /** Format: int32 */
            firstSequence: number;
            /** Format: int32 */
            lastSequence: number;
        };
        /** @description The members of a series. */
        Series: {
            /**
             * @description Or patterns of numbers, as `1..12` or `1,3,7..9`: the first mapping gets the first number of
             *     each, and so on; a pattern of one number, or another text, is the same for all.
             */
            patterns?: {
                [key: string]: string;
            };
            /** @description The values of the parameters, one set per mapping. */
            sets?: {
                [key: string]: string;
            }[];
        };
        /** @description A server's limits (OPC 10000-5 §6.3.2, §6.3.11); `None` where it declares none. */
        ServerLimits: {
            /** Format: int32 */
            browseContinuationPointsMax?: number | null;
            /** Format: int32 */
            itemsPerCallMax?: number | null;
            /** Format: int32 */
            itemsPerSubscriptionMax?: number | null;
            /** Format: int32 */
            nodesPerBrowseMax?: number | null;
            /** Format: int32 */
            nodesPerReadMax?: number | null;
            /** Format: int32 */
            nodesPerWriteMax?: number | null;
            /** Format: int32 */
            pathsPerTranslateMax?: number | null;
            /** Format: int32 */
            subscriptionsPerSessionMax?: number | null;
        };
        /** @description Who is signed in. */
        Session: {
            /** @description What changes must carry in the header `x-csrf-token`. */
            csrfToken: string;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /** @description One setting as a person reads it. */
        Setting: {
            /** @description Default as TOML; none when the setting has no default. */
            default?: string | null;
            /** @description True for a configured value that is not shown. */
            isHidden: boolean;
            /** @description Path of the key, as `web.listen`. */
            key: string;
            /** @description Description for people. */
            meaning: string;
            /** @description Origin of the value: a line of the file or a variable of the environment. */
            origin?: string | null;
            /** @description The section it stands in; empty at the top. */
            section: string;
            /** @description Configured value as TOML; none when the default is used. Secrets are not shown. */
            value?: string | null;
        };
        /**
         * @description Severity of a diagnostic.
         * @enum {string}
         */
        Severity: "hint" | "warning" | "error";
        /** @description A mapping on trial beside the published one. */
        ShadowView: {
            /** @description Who started it. */
            author: string;
            /** @description What differs from the published one; none where nothing is published. */
            changes: components["schemas"]["MappingChange"][];
            /** @description The mapping on trial. */
            mapping: components["schemas"]["Mapping"];
            published?: components["schemas"]["MappingStatus"] | null;
            /** @description When. */
            startedAt: components["schemas"]["DateTime"];
            status?: components["schemas"]["MappingStatus"] | null;
        };
        /** @description A value as pages show it. */
        ShownValue: {
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /** @description The status, by its name where it has one. */
            status: string;
            /** @description The value as plain JSON; 64-bit integers as text; null where there is none. */
            value: unknown;
        };
        /** @description Who wants to sign in. */
        SignIn: {
            /** Format: password */
            password: string;
            userName: string;
        };
        /**
         * @description One OPC UA server to read from. The password is accepted but never serialised; who persists a
         *     source stores [`Password::expose`] apart.
         */
        SourceConfig: {
            /** @description The server's address, `opc.tcp://host:port/path`. */
            endpointUrl: string;
            /** @description Sign-in of the client on the server. */
            identity?: components["schemas"]["Identity"];
            /** @description Name for people. */
            name?: string;
            /**
             * Format: int32
             * @description Publishing interval of the subscriptions, in milliseconds (1 to 60 000).
             */
            publishingIntervalMs?: number;
            /** @description Choice among the server's endpoints. */
            security?: components["schemas"]["SecurityChoice"];
            /**
             * Format: int32
             * @description After how many milliseconds without any sign of life a connection is given up (500 to 600
             *     000).
             */
            silenceMsMax?: number;
            /** @description The source's name, unique in a connector. */
            sourceId: components["schemas"]["SourceId"];
        };
        /** @description The name of a source: `[A-Za-z0-9_-]{1,64}`. */
        SourceId: string;
        /** @description Problem of a source, with its remedy. */
        SourceProblem: {
            kind: components["schemas"]["SourceProblemKind"];
            message: string;
            /** @description Action that resolves the problem, and the person who takes it. */
            remedy: string;
        };
        /**
         * @description Kinds of problems with a source.
         * @enum {string}
         */
        SourceProblemKind: "unreachable" | "noSuitableEndpoint" | "serverCertificateUntrusted" | "serverCertificateInvalid" | "clientCertificateRejected" | "credentialsRejected" | "serverFull" | "connectionLost" | "stalled" | "refused" | "configuration";
        /**
         * @description The state of a source.
         * @enum {string}
         */
        SourceState: "connecting" | "subscribing" | "connected" | "waiting";
        /** @description Status of a source, with the evidence. */
        SourceStatus: {
            /**
             * Format: int64
             * @description Changes received since the connector started.
             */
            changes: number;
            /**
             * Format: int64
             * @description Milliseconds by which the server's clock is ahead of the connector's, measured when the
             *     session was established.
             */
            clockAheadMs?: number | null;
            endpoint?: components["schemas"]["ChosenEndpoint"] | null;
            /**
             * @description Number of inputs with a known browse path. They are found again when the server changes its
             *     node ids.
             */
            findable: number;
            /** @description Number of inputs that are monitored on it. */
            inputs: number;
            lastChangeAt?: components["schemas"]["DateTime"] | null;
            lastSignOfLifeAt?: components["schemas"]["DateTime"] | null;
            limits?: components["schemas"]["ServerLimits"] | null;
            /** @description Number of inputs that the server monitors and has sent a first value for. */
            live: number;
            /** @description The inputs that are not live, each with the reason; the first 1000. */
            notLive: components["schemas"]["InputProblem"][];
            problem?: components["schemas"]["SourceProblem"] | null;
            /**
             * Format: int64
             * @description Sessions established since the connector started.
             */
            sessions: number;
            since: components["schemas"]["DateTime"];
            sourceId: components["schemas"]["SourceId"];
            state: components["schemas"]["SourceState"];
        };
        SourceView: components["schemas"]["SourceConfig"] & components["schemas"]["SourceStatus"];
        /** @description How an operation stands by its entries. */
        Standing: {
            endedAt?: components["schemas"]["DateTime"] | null;
            /**
             * Format: double
             * @description Good pieces counted with the buttons.
             */
            goodQuantity: number;
            lastEntryAt?: components["schemas"]["DateTime"] | null;
            problem?: components["schemas"]["OperatorProblem"] | null;
            /**
             * Format: double
             * @description Scrap counted with the buttons.
             */
            scrapQuantity: number;
            startedAt?: components["schemas"]["DateTime"] | null;
            state?: components["schemas"]["OperationState"] | null;
        };
        /** @description A state as a JSON value. */
        StateValue: boolean | number | string;
        /** @description A precision as published to the partner. */
        Statement: {
            /** @description The English sentence that the partner gets. */
            statement: string;
            /** @description The same as codes with parameters. */
            statementParts: components["schemas"]["StatementPart"][];
        };
        /**
         * @description Part of a policy as published to the partner: a code with parameters, for texts in another
         *     language.
         */
        StatementPart: {
            /** @enum {string} */
            code: "UNCHANGED";
        } | {
            /** @enum {string} */
            code: "AGGREGATED";
            function: components["schemas"]["AggregateFunction"];
            /**
             * Format: int64
             * @description The window's length in milliseconds.
             */
            windowMs: number;
        } | {
            /** @enum {string} */
            code: "ROUNDED";
            step: components["schemas"]["RoundingStep"];
            /** @description The field's unit. */
            unit?: string | null;
        } | {
            /** @description The bounds, ascending. */
            bounds: number[];
            /** @enum {string} */
            code: "BANDED";
            /** @description The field's unit. */
            unit?: string | null;
        } | {
            /** @enum {string} */
            code: "DIGITS";
            /** Format: int32 */
            digits: number;
        } | {
            /** @enum {string} */
            code: "INTERVAL";
            /**
             * Format: int64
             * @description The interval in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "RATE";
            /**
             * Format: int64
             * @description The period in milliseconds.
             */
            periodMs: number;
            /** Format: int32 */
            values: number;
        } | {
            /** @enum {string} */
            code: "TIME_STEP";
            /**
             * Format: int64
             * @description The step in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "DELAYED";
            /**
             * Format: int64
             * @description The delay in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "HOURS";
            hours: components["schemas"]["WorkingHours"];
        } | {
            /** @enum {string} */
            code: "WITHHELD";
        };
        /** @description How the connector stands. */
        Status: {
            factoryId: string;
            lease: components["schemas"]["LeaseStatus"];
            link: components["schemas"]["LinkStatus"] | null;
            /** @description Its own clock, to tell ages by. */
            now: components["schemas"]["DateTime"];
            /** @description The local servers. */
            sources: components["schemas"]["SourceStatus"][];
            spool: components["schemas"]["SpoolStatus"];
            startedAt: components["schemas"]["DateTime"];
            twin: components["schemas"]["TwinStatus"];
            version: string;
        };
        /**
         * Format: int32
         * @description An OPC UA status code: severity in the two highest bits, sub code below, flag bits at the end.
         */
        StatusCode: number;
        /**
         * @description One function of a chain. In JSON an object with `function` and the parameters.
         *
         *     A function gets the value the one before it yielded, and may keep it to itself: then the
         *     chain ends there until the next value.
         */
        Step: (components["schemas"]["Select"] & {
            /** @enum {string} */
            function: "select";
        }) | (components["schemas"]["Constant"] & {
            /** @enum {string} */
            function: "constant";
        }) | (components["schemas"]["Convert"] & {
            /** @enum {string} */
            function: "convert";
        }) | (components["schemas"]["Scale"] & {
            /** @enum {string} */
            function: "scale";
        }) | (components["schemas"]["UnitConversion"] & {
            /** @enum {string} */
            function: "unitConversion";
        }) | (components["schemas"]["Increment"] & {
            /** @enum {string} */
            function: "increment";
        }) | (components["schemas"]["Counter"] & {
            /** @enum {string} */
            function: "counter";
        }) | (components["schemas"]["Edge"] & {
            /** @enum {string} */
            function: "edge";
        }) | (components["schemas"]["Threshold"] & {
            /** @enum {string} */
            function: "threshold";
        }) | (components["schemas"]["Debounce"] & {
            /** @enum {string} */
            function: "debounce";
        }) | (components["schemas"]["Deadband"] & {
            /** @enum {string} */
            function: "deadband";
        }) | (components["schemas"]["Rate"] & {
            /** @enum {string} */
            function: "rate";
        }) | (components["schemas"]["Window"] & {
            /** @enum {string} */
            function: "window";
        }) | (components["schemas"]["Lookup"] & {
            /** @enum {string} */
            function: "lookup";
        }) | (components["schemas"]["Enumeration"] & {
            /** @enum {string} */
            function: "enumeration";
        }) | (components["schemas"]["Bit"] & {
            /** @enum {string} */
            function: "bit";
        }) | (components["schemas"]["BitTexts"] & {
            /** @enum {string} */
            function: "bitTexts";
        }) | (components["schemas"]["Format"] & {
            /** @enum {string} */
            function: "format";
        }) | (components["schemas"]["Parse"] & {
            /** @enum {string} */
            function: "parse";
        }) | (components["schemas"]["Expression"] & {
            /** @enum {string} */
            function: "expression";
        }) | (components["schemas"]["Merge"] & {
            /** @enum {string} */
            function: "merge";
        }) | (components["schemas"]["Script"] & {
            /** @enum {string} */
            function: "script";
        });
        /** @description What one function made of its value. */
        StepView: {
            /** @description The function. */
            function: string;
            /** @description Why it failed. */
            message?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
        };
        /** @description A comment as it was made. */
        StoredComment: {
            authorId: string;
            /** @description The request it is about; none for the whole network. */
            dynamicDataRequestId?: string | null;
            /** @description The field it is about; none for the whole request. */
            fieldName?: string | null;
            /**
             * Format: int64
             * @description Number of the comment at this connector, counting up in the order of arrival.
             */
            id: number;
            /** @description True if it was made at this factory. */
            isOwn: boolean;
            text: string;
            writtenAt: components["schemas"]["DateTime"];
        };
        /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
        StoredRevocation: components["schemas"]["RevocationReceipt"] & {
            /**
             * Format: int32
             * @description Reports that were on their way when the consent ended, of which the platform has said since
             *     that it holds them.
             */
            arrivedSince: number;
            /**
             * Format: int32
             * @description Reports of which it is still not known whether they arrived.
             */
            open: number;
            /** @description The key it is verified with, hexadecimal. */
            publicKey: string;
            /** @description The Ed25519 signature over that text, hexadecimal. */
            signature: string;
            /** @description The exact text that was signed. */
            signedText: string;
        };
        /** @description A variable that might be meant. */
        SuggestedVariable: components["schemas"]["Suggestion"] & {
            /** @description What the server says about it. */
            description?: string | null;
            /** @description What is to be decided if it is the right one. */
            mapping: components["schemas"]["MappingDraft"];
            /** @description Its unit, as people see it. */
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
            valueType?: components["schemas"]["TypeName"] | null;
        };
        /** @description A variable that might be meant. */
        Suggestion: {
            /** @description Node id with its namespace's URI. */
            nodeId: components["schemas"]["NodeId"];
            /** @description Names down to the variable, joined by `/`. */
            place: string;
            /** @description Evidence, the weightiest first. */
            reasons: components["schemas"]["Reason"][];
            /**
             * Format: int32
             * @description 20 to 100.
             */
            score: number;
            /** @description Source of the variable. */
            sourceId: components["schemas"]["SourceId"];
            /** @description The functions it would need. */
            steps: components["schemas"]["Step"][];
        };
        /** @description Variables that might be meant, best first, and where they were looked for. */
        Suggestions: {
            /** @description The variables; none is used before a person decides. */
            items: components["schemas"]["SuggestedVariable"][];
            /** @description The servers that were looked through. */
            sources: components["schemas"]["SearchedSource"][];
        };
        /** @description A mapping of a survey. */
        SurveyedMapping: {
            /** @description Health from which its rank follows. */
            health: components["schemas"]["MappingHealth"];
            /** @description Counters, inputs and last candidate. */
            status: components["schemas"]["MappingStatus"];
        };
        /** @description How to make a template of a field's mapping. */
        TemplateDraft: {
            /** @description What people call it. */
            name?: string | null;
            /** @description The parameters and the texts that they stand for in this mapping, as `machine` for `Press1`. */
            parameters: {
                [key: string]: string;
            };
            /** @description Its id: letters, digits, `_` and `-`. */
            templateId: string;
        };
        /** @description A parameter of a template. */
        TemplateParameter: {
            /** @description Value where none is given. */
            default?: string | null;
            /** @description Meaning, for people. */
            description?: string | null;
            /** @description Its name within `${...}`. */
            name: string;
        };
        /** @description A template as it is kept. */
        TemplateView: components["schemas"]["MappingTemplate"] & {
            /** @description Who changed it last. */
            author: string;
            /** @description When. */
            changedAt: components["schemas"]["DateTime"];
        };
        /** @description Comparison of a number with a limit, with hysteresis. */
        Threshold: {
            above?: components["schemas"]["Literal"] | null;
            below?: components["schemas"]["Literal"] | null;
            /** @description At or above this it is above. */
            limit: components["schemas"]["Number"];
            release?: components["schemas"]["Number"] | null;
        };
        /** @description Result of a dry run. */
        Trace: {
            /** @description All diagnostics of the mapping; with an error there are no runs. */
            diagnostics: components["schemas"]["MappingDiagnostic"][];
            /** @description One run per sample, and per timer that ran out in between. */
            runs: components["schemas"]["TraceRun"][];
        };
        /** @description One run of the chain. */
        TraceRun: {
            /** @description Time of the run by the local clock. */
            at: components["schemas"]["DateTime"];
            candidate?: components["schemas"]["TracedValue"] | null;
            fault?: components["schemas"]["TracedFault"] | null;
            /** @description The input that changed; absent where time passed. */
            input?: string | null;
            /** @description Results of the functions, as far as the chain got. */
            steps: components["schemas"]["TraceStep"][];
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description Result of one function on one value. */
        TraceStep: {
            fault?: components["schemas"]["TracedFault"] | null;
            /** @description Name of the function, as in JSON. */
            function: string;
            /** @description Index of the function. */
            step: number;
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description Fault of a function. */
        TracedFault: {
            /**
             * Format: int32
             * @description The column in the script, from 1.
             */
            column?: number | null;
            /** @description Kind, for programs. */
            kind: components["schemas"]["FaultKind"];
            /**
             * Format: int32
             * @description The line in the script, from 1.
             */
            line?: number | null;
            /** @description Sentence that names the fault. */
            message: string;
        };
        /**
         * @description A value for people: 64-bit integers as text, arrays cut after 256 elements, structures as
         *     objects.
         */
        TracedValue: {
            serverTimestamp?: components["schemas"]["DateTime"] | null;
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description The status code.
             */
            status: number;
            /** @description The status' name, where it is a well-known one. */
            statusName?: string | null;
            type?: components["schemas"]["TypeName"] | null;
            /** @description Value as plain JSON. */
            value: unknown;
        };
        /** @description What became of a trial. */
        Trial: components["schemas"]["Trace"] & {
            from?: components["schemas"]["DateTime"] | null;
            /** @description How many runs there were. */
            runsTotal: number;
            to?: components["schemas"]["DateTime"] | null;
            /**
             * @description Inputs of which nothing is recorded: only variables that a mapping at work (or on trial)
             *     uses are.
             */
            unrecorded: string[];
            /** @description How many values went in. */
            values: number;
        };
        /** @description A mapping to try. */
        TrialBody: {
            /** @description The last so many runs are shown, up to 2000; 200 without it. */
            limit?: number | null;
            /** @description The mapping. */
            mapping: components["schemas"]["MappingDraft"];
            /** @description What to run it on: `LIVE` (the default) or `HISTORY`. */
            on?: components["schemas"]["TrialOn"];
        };
        /**
         * @description What to run a mapping on.
         * @enum {string}
         */
        TrialOn: "LIVE" | "HISTORY";
        /** @description Whether a certificate is trusted. */
        TrustBody: {
            /** @description True: connections to the server are allowed. */
            isTrusted: boolean;
        };
        /** @description A file for the trust list. */
        TrustFileBody: {
            /** @description Its content: PEM, or DER in base64. One certificate or list. */
            content: string;
            /** @description What it is. */
            kind: components["schemas"]["TrustFileKind"];
        };
        /**
         * @description What a file for the trust list is.
         * @enum {string}
         */
        TrustFileKind: "CERTIFICATE" | "ISSUER" | "REVOCATION_LIST";
        /**
         * @description Trust in a server's certificate.
         * @enum {string}
         */
        TrustState: "trusted" | "rejected";
        /**
         * @description An OPC UA built-in type by its name.
         * @enum {string}
         */
        TypeName: "Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo";
        /** @description From one unit of measurement to another of the same kind, by UNECE codes. */
        UnitConversion: {
            /** @description The unit that comes in; the first input's unit where absent. */
            from?: string | null;
            /** @description The unit that goes out; the target's unit where absent. */
            to?: string | null;
        };
        /** @description A unit as the server gives it. */
        UnitName: {
            /** @description The UNECE code behind it (`C16`), where the unit is one of them. */
            code?: string | null;
            /** @description Symbol for people: `mm/s`. */
            displayName: string;
        };
        /** @description What a person may do, and a password. */
        UserBody: {
            /**
             * Format: password
             * @description At least ten characters; needed for a new person, unchanged without it.
             */
            password?: string | null;
            role: components["schemas"]["Role"];
        };
        /** @description A person who may sign in. */
        UserView: {
            role: components["schemas"]["Role"];
            userName: string;
        };
        /**
         * @description Source of a mapped field's values.
         * @enum {string}
         */
        ValueSource: "MAPPING" | "MANUAL" | "EXTERNAL";
        /** @description Result of a verification. */
        Verification: {
            /**
             * Format: int64
             * @description Number of verified checkpoints.
             */
            checkpoints: number;
            /**
             * Format: int64
             * @description Number of verified entries.
             */
            entries: number;
            /**
             * Format: int64
             * @description Number of entries that retention has removed, by the signed anchors.
             */
            entriesPruned: number;
            /**
             * Format: int64
             * @description Number of all faults.
             */
            faultCount: number;
            /** @description The first hundred faults. */
            faultList: components["schemas"]["LedgerFault"][];
            /**
             * @description The public key of all signatures, hexadecimal; to be compared with a copy outside of the
             *     connector.
             */
            publicKey?: string | null;
            /**
             * Format: int64
             * @description Number of verified receipts of ended consents.
             */
            revocations: number;
            /**
             * Format: int64
             * @description Number of entries that were compared with the values that they commit to.
             */
            valuesCompared: number;
            /**
             * Format: int64
             * @description Number of entries whose values retention has emptied.
             */
            valuesEmptied: number;
        };
        /** @description The outcome of a verification. */
        VerificationView: components["schemas"]["Verification"] & {
            /** @description How many chains there are. */
            chains: number;
            /** @description The first thing that is wrong, in words. */
            fault?: string | null;
            /** @description Nothing is wrong. */
            valid: boolean;
        };
        /** @description A published mapping. */
        VersionView: {
            /** @description Who published it. */
            author?: string | null;
            /** @description What differs from the version before; none for the oldest. */
            changes: components["schemas"]["MappingChange"][];
            /** @description It is the mapping of the field now. */
            isCurrent: boolean;
            /** @description The mapping. */
            mapping: components["schemas"]["Mapping"];
            /** @description Where it came from, where not from the editor. */
            note?: string | null;
            /** @description When. */
            publishedAt: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description Counts from 1.
             */
            version: number;
        };
        /** @description A document with its version, author and time. */
        Versioned_NamedPolicy: components["schemas"]["DocumentVersion"] & {
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description True when it is no longer offered or applied. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        } & {
            changedAt: components["schemas"]["DateTime"];
            /** @description User of the last change. */
            changedBy: string;
        };
        /**
         * @description A day of the week.
         * @enum {string}
         */
        Weekday: "MONDAY" | "TUESDAY" | "WEDNESDAY" | "THURSDAY" | "FRIDAY" | "SATURDAY" | "SUNDAY";
        /**
         * @description An aggregate over the last values (`samples`) or the last span of time (`durationMs`); exactly
         *     one of the two. Over time it also changes when values leave the window. At most 4096 values are
         *     kept; beyond, the oldest leave early.
         */
        Window: {
            /** @description Function over the values in the window. */
            aggregate: components["schemas"]["Aggregate"];
            /**
             * Format: int64
             * @description Span back from the newest value, in milliseconds.
             */
            durationMs?: number | null;
            /**
             * Format: int32
             * @description Number of values.
             */
            samples?: number | null;
        };
        /** @description An aggregate over windows. */
        WindowAggregate: {
            function: components["schemas"]["AggregateFunction"];
            /**
             * Format: int64
             * @description Length of a window in milliseconds.
             */
            windowMs: number;
        };
        /**
         * @description Condition that withholds a field: while a value is in one of these states, no value of the field
         *     is released, and candidates of that time never are.
         */
        WithholdCondition: {
            field?: components["schemas"]["FieldName"] | null;
            /** @description The states: texts, numbers or truth values. */
            states: components["schemas"]["StateValue"][];
        };
        /**
         * @description Hours in which values may be released. Of changes outside of them, the newest is released when
         *     they begin.
         */
        WorkingHours: {
            days: components["schemas"]["Weekday"][];
            /** @description The first minute, `HH:MM`. */
            from: components["schemas"]["ClockTime"];
            /** @description The first minute after them, `HH:MM`; later than `from`. */
            until: components["schemas"]["ClockTime"];
            /**
             * Format: int32
             * @description Offset of the plant's clock from UTC, in minutes; positive to the east.
             */
            utcOffsetMinutes?: number;
        };
        OperationSummary: {
            operationId: string;
            operationType: string;
            name?: string | null;
            plannedStart?: string | null;
            plannedEnd?: string | null;
        };
        LinkStatus: {
            state: string;
            since?: string | null;
            lastAcceptedAt?: string | null;
            lastReceiptedAt?: string | null;
            backlog?: number;
            reason?: string | null;
        };
        LeaseParty: {
            instanceId: string;
            host: string;
            since: string;
            lastHeardAt: string;
        };
        LeaseStatus: {
            /** @enum {string} */
            state: "ASKING" | "HELD" | "REFUSED";
            since: string;
            host: string;
            leaseNumber?: number | null;
            holder?: components["schemas"]["LeaseParty"] | null;
            contender?: components["schemas"]["LeaseParty"] | null;
        };
        SpoolStatus: {
            waiting: number;
            sent: number;
            bytes: number;
            oldestAt?: string | null;
        };
        TwinStatus: {
            endpointUrl?: string | null;
        };
        OperatorProblem: {
            text: string;
            since: string;
            toldBy: string;
        };
        Versioned_Rule: components["schemas"]["DocumentVersion"] & components["schemas"]["Rule"] & {
            changedBy: string;
            changedAt: string;
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
        /** @description It does not fit the present state. */
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
        /** @description It does not exist. */
        NotFound: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description A part that is needed is not there at the moment. */
        ServiceUnavailable: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Nobody is signed in. */
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
export type operations = Record<string, never>;
