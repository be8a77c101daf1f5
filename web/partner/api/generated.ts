// Generated from openapi.json by `npm run generate`. Do not edit.

export interface paths {
    "/api/v1/collaborations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the collaborations of the viewer's organisation; administrators see all. */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_Collaboration"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        put?: never;
        /** Adds a collaboration. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Collaboration"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/collaborations/{collaborationId}/factories/{factoryId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds a factory; nothing happens where it takes part. */
        put: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Collaboration"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/collaborations/{collaborationId}/members/{organisationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds a member; nothing happens where it is one. */
        put: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Collaboration"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/dead-letters": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists dead letters, newest first; those of the embedded broker come with the first page. For administrators. */
        get: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_DeadLetterView"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/dead-letters/{deadLetterId}/replay": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Tries a dead letter again: one of ingest is taken as if it arrived now, one of the broker goes back to its queue. */
        post: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Replayed"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/enrolments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Uses a token up. Of a factory's credentials the newest two are alive. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Enrolment"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/factories": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the factories of the viewer's organisation and of its collaborations; administrators see all. */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_Factory"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        put?: never;
        /** Adds a factory; its queues are made. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Factory"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/factories/{factoryId}/credentials": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Takes all credentials of the factory's connector away and cuts its connections. */
        delete: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Revoked"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/factories/{factoryId}/enrolment-tokens": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Makes a single-use token with which the factory's connector enrols. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["TokenView"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/factories/{factoryId}/lease": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Shows who speaks for a factory and who else asked to: for its own organisation and administrators. */
        get: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["LeaseView"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/factories/{factoryId}/lease/handovers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Gives the lease to a connector that was refused, as when the old machine is gone for good. The former holder is
         *     refused from now on.
         */
        post: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["LeaseView"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/factories/{factoryId}/writers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists what is held of a factory's writers: for its own organisation and administrators. */
        get: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_WriterView"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/live": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Server-sent events: `value`, `decision`, `part`, `progress`, `network`, `factory`, `comment`, and `reset` where events
         *     were missed and the page must load afresh.
         */
        get: {
            parameters: {
                query?: {
                    /** @description As the header `Last-Event-ID`, for the first connection of a page: `lastEventId` of the view it shows. */
                    lastEventId?: string;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "text/event-stream": string;
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/operation-networks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the networks of the viewer's collaborations, by id. */
        get: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_NetworkSummary"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/operation-networks/{operationNetworkId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Shows a network with its parts, progress and the fields that concern the viewer. */
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["NetworkView"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        /**
         * Puts a whole network in place; each factory whose part differs is sent it. `If-Match` with the revision guards
         *     against overwriting somebody else's change. The same network again changes nothing.
         */
        put: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Changed"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        post?: never;
        /** Withdraws a network: its nodes and mappings go at every factory. */
        delete: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Changed"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/operation-networks/{operationNetworkId}/comments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the comments on a network, oldest first. */
        get: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_CommentEntry"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        put?: never;
        /** Adds a comment; it is sent to the factory. */
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
                    "application/json": components["schemas"]["AddComment"];
                };
            };
            responses: {
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["CommentEntry"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/operation-networks/{operationNetworkId}/operations/{operationId}/requests": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Adds a dynamic data request to an operation: a new revision goes to its factory. */
        post: {
            parameters: {
                query?: never;
                header?: never;
                path: {
                    operationNetworkId: string;
                    operationId: string;
                };
                cookie?: never;
            };
            /** @description A dynamic data request (wire contract) */
            requestBody: {
                content: {
                    "application/json": Record<string, never>;
                };
            };
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Changed"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/operation-networks/{operationNetworkId}/operations/{operationId}/requests/{dynamicDataRequestId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /** Removes a dynamic data request of the own organisation: nodes and mappings go at the factory, the history stays. */
        delete: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Changed"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/organisations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the organisations that the viewer shares a collaboration with; administrators see all. */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_Organisation"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        put?: never;
        /** Adds an organisation. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Organisation"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/reports": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the reports whose recipient the viewer is, in the order of their arrival. */
        get: {
            parameters: {
                query?: {
                    /** @description Only of this network. */
                    network?: string;
                    /** @description Only of this request. */
                    request?: string;
                    /** @description Only those that arrived after the report with this number; `nextCursor` of the page before. */
                    after?: number;
                    /** @description Most entries wanted, 1 to 1000. */
                    limit?: number;
                    /** @description The newest entries instead of the oldest; still in the order of their arrival, and without a next page. */
                    newest?: boolean;
                };
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_Report"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/session": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Session"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Too many attempts */
                429: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Says how the platform stands. */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Status"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/tools": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /** Lists the tools of the viewer's organisation; administrators see all. */
        get: {
            parameters: {
                query?: never;
                header?: never;
                path?: never;
                cookie?: never;
            };
            requestBody?: never;
            responses: {
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Page_Tool"];
                    };
                };
                /** @description A parameter is wrong. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        put?: never;
        /** Adds a tool; its queues are made. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Tool"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
    "/api/v1/tools/{toolId}/credentials": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /** Makes a credential for a tool; the newest two are alive. */
        post: {
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
                201: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["ToolCredential"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        /** Takes all credentials of a tool away and cuts its connections. */
        delete: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["Revoked"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
            };
        };
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/api/v1/users/{userName}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /** Adds or replaces a user; the user's sessions end. */
        put: {
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
                200: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/json": components["schemas"]["UserView"];
                    };
                };
                /** @description The request cannot be understood. */
                400: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Nobody is signed in. */
                401: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description The role does not allow it, or the CSRF token is wrong. */
                403: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not exist, or the viewer has no part in it. */
                404: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description It does not fit the present state. */
                409: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
                    };
                };
                /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
                422: {
                    headers: {
                        [name: string]: unknown;
                    };
                    content: {
                        "application/problem+json": components["schemas"]["Problem"];
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
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /** @description A comment to add. */
        AddComment: {
            /** @description The request talked about. */
            dynamicDataRequestId?: string | null;
            /** @description The factory to talk to; one that has a part in the network. */
            factoryId: string;
            /** @description The field talked about. */
            fieldName?: string | null;
            /** @description What is said; 1 to 10000 characters. */
            text: string;
        };
        /** @description What a change did. */
        Changed: {
            /** @description False where nothing differed. */
            isChanged: boolean;
            /**
             * Format: int64
             * @description The revision in effect.
             */
            revision: number;
            /** @description The factories that were sent something. */
            sentTo: string[];
        };
        /** @description A collaboration with its members and factories. */
        Collaboration: {
            /** @description Its id. */
            collaborationId: string;
            /**
             * Format: date-time
             * @description Since when it is here.
             */
            createdAt: string;
            /** @description The factories that take part, by id. */
            factories: string[];
            /** @description The organisations that take part, by id. */
            members: string[];
            /** @description What people call it. */
            name: string;
        };
        /** @description A comment as members of the collaboration see it. */
        CommentEntry: {
            /** @description Who says it. */
            authorId: string;
            /**
             * Format: int64
             * @description Its number, counting up.
             */
            commentId: number;
            /**
             * Format: date-time
             * @description When it came here.
             */
            createdAt: string;
            /** @description The request talked about. */
            dynamicDataRequestId?: string | null;
            /** @description The factory that takes part in the talk. */
            factoryId: string;
            /** @description The field talked about. */
            fieldName?: string | null;
            /** @description Whether it came from the factory. */
            isFromFactory: boolean;
            /** @description What is said. */
            text: string;
        };
        /** @description A message that could not be used. */
        DeadLetterView: {
            /** @description Where it was sent to. */
            address: string;
            /**
             * Format: date-time
             * @description When it was set aside.
             */
            at: string;
            /**
             * Format: int64
             * @description How large its body is.
             */
            bytes: number;
            /** @description A stable code, as `FORGED_PUBLISHER`. */
            code: string;
            /** @description `ingest-<number>` or `broker-<number>`. */
            id: string;
            messageId?: string | null;
            /** @description Why, for people. */
            reason: string;
            /**
             * Format: date-time
             * @description When it was tried again, if it was.
             */
            replayedAt?: string | null;
            subject?: string | null;
        };
        /** @description A token from `POST /factories/{factoryId}/enrolment-tokens`. */
        Enrol: {
            token: string;
        };
        /** @description All a connector needs to reach the broker, shown this once. */
        Enrolment: {
            /** @description The broker's address. */
            brokerUrl: string;
            factoryId: string;
            /** @description The connector's own secret. */
            password: string;
            /** @description What logical addresses are called there. */
            profile: Record<string, never>;
            /** @description The authority that vouches for the broker; absent where the system's roots do. */
            rootCertificatePem?: string | null;
            /** @description The name to sign in with. */
            userName: string;
        };
        /** @description A factory: one connector, with the evidence of its life. */
        Factory: {
            /**
             * Format: date-time
             * @description Since when it is known here.
             */
            createdAt: string;
            /**
             * Format: date-time
             * @description When its connector enrolled last; absent before.
             */
            enrolledAt?: string | null;
            /** @description Its id, also its PublisherId and part of its addresses. */
            factoryId: string;
            /**
             * Format: date-time
             * @description When a report of it arrived last.
             */
            lastReportAt?: string | null;
            /**
             * Format: date-time
             * @description When anything of it arrived last, keep-alives included.
             */
            lastSeenAt?: string | null;
            /** @description What people call it. */
            name: string;
            /** @description Whose it is. */
            organisationId: string;
            /** @description What its publisher said of itself last (`ua-status`), as `Operational`. */
            publisherState?: string | null;
        };
        /** @description One report field, addressed from the network down. */
        FieldKey: {
            /** @description The request. */
            dynamicDataRequestId: string;
            /** @description The field. */
            fieldName: string;
            /** @description The operation. */
            operationId: string;
            /** @description The network. */
            operationNetworkId: string;
        };
        /** @description A field with its decision and newest value. */
        FieldView: {
            /**
             * Format: date-time
             * @description When it was decided.
             */
            decidedAt?: string | null;
            /** @description The precision that recipients get. */
            disclosure?: Record<string, never> | null;
            /**
             * Format: int32
             * @description The writer's epoch.
             */
            epoch?: number | null;
            /** @description The factory that is asked. */
            factoryId: string;
            /** @description The field. */
            key: components["schemas"]["FieldKey"];
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            /** @description Why. */
            reason?: string | null;
            /**
             * Format: date-time
             * @description When it arrived.
             */
            receivedAt?: string | null;
            /**
             * Format: date-time
             * @description When the connector reported it.
             */
            reportTimestamp?: string | null;
            /**
             * Format: int32
             * @description The report's sequence number.
             */
            sequence?: number | null;
            /**
             * Format: date-time
             * @description When the source measured it.
             */
            sourceTimestamp?: string | null;
            /** @description Its quality, by the standard's name. */
            status?: string | null;
            /** @description The newest value; 64-bit integers are texts. */
            value?: Record<string, never> | null;
            /** @description Its OPC UA built-in type, by name. */
            valueType?: string | null;
        };
        /** @description An announced gap. */
        GapView: {
            /** @description `COALESCED`, `EXPIRED`, `WITHDRAWN` or `REVOKED`. */
            cause: string;
            /** Format: int32 */
            firstSequence: number;
            /** Format: int32 */
            lastSequence: number;
        };
        /** @description To whom the lease goes. */
        Handover: {
            /** @description One of the contenders. */
            instanceId: string;
        };
        /** @description How a factory's lease stands. */
        LeaseView: {
            /** @description Connectors that asked and were refused, whoever was heard last first. */
            contenders: components["schemas"]["Party"][];
            holder?: components["schemas"]["Party"] | null;
            /**
             * Format: int64
             * @description Counts up whenever the lease passes to another place; 0 while nobody has asked for it.
             */
            leaseNumber: number;
        };
        /**
         * @description Where a field stands.
         * @enum {string}
         */
        MappingState: "PENDING" | "MAPPED" | "REFUSED";
        /** @description A network in a list. */
        NetworkSummary: {
            /** @description The collaboration it belongs to. */
            collaborationId: string;
            /**
             * Format: date-time
             * @description When a report about it that the viewer may see arrived last.
             */
            lastReportAt?: string | null;
            /** @description What people call it. */
            name?: string | null;
            /** @description Its id. */
            operationNetworkId: string;
            /**
             * Format: int64
             * @description How many parts of it were rejected.
             */
            partsRejected: number;
            /**
             * Format: int64
             * @description How many parts of it wait for a factory's answer.
             */
            partsUnanswered: number;
            /**
             * Format: int64
             * @description Its newest revision.
             */
            revision: number;
            /**
             * Format: date-time
             * @description When that was made.
             */
            updatedAt: string;
            /**
             * Format: date-time
             * @description When it was withdrawn, if it was.
             */
            withdrawnAt?: string | null;
        };
        /** @description A network with its parts, progress and fields. */
        NetworkView: {
            /** @description The collaboration it belongs to. */
            collaborationId: string;
            /** @description The fields that concern the viewer. */
            fields: components["schemas"]["FieldView"][];
            /** @description The live event that this view includes: `GET /live` with it as `Last-Event-ID` misses nothing. */
            lastEventId: string;
            /** @description The whole network (wire contract `operation-network`). */
            network: Record<string, never>;
            /** @description How each operation stands, as far as the viewer's fields tell. */
            operations: components["schemas"]["OperationProgress"][];
            /** @description What each factory was sent. */
            parts: components["schemas"]["PartView"][];
            /**
             * Format: int64
             * @description Its newest revision.
             */
            revision: number;
            /**
             * Format: date-time
             * @description When that was made.
             */
            updatedAt: string;
            /** @description Who made it. */
            updatedBy: string;
            /**
             * Format: date-time
             * @description When it was withdrawn, if it was.
             */
            withdrawnAt?: string | null;
        };
        /** @description A collaboration to add. */
        NewCollaboration: {
            collaborationId: string;
            /** @description The factories that take part. */
            factories?: string[];
            /** @description The organisations that take part. */
            members?: string[];
            name: string;
        };
        /** @description A factory to add. */
        NewFactory: {
            factoryId: string;
            /** @description What people call it; the id where absent. */
            name?: string | null;
            organisationId: string;
        };
        /** @description An organisation to add. */
        NewOrganisation: {
            name: string;
            organisationId: string;
        };
        /** @description A tool to add. */
        NewTool: {
            name: string;
            organisationId: string;
            toolId: string;
        };
        /** @description How an operation stands, as far as the viewer's fields tell. */
        OperationProgress: {
            /**
             * Format: date-time
             * @description When it ended.
             */
            actualEnd?: string | null;
            /**
             * Format: date-time
             * @description When it started.
             */
            actualStart?: string | null;
            /**
             * Format: date-time
             * @description When the factory expects it to end.
             */
            expectedEnd?: string | null;
            /**
             * Format: double
             * @description What of it is good.
             */
            goodQuantity?: number | null;
            /** @description True where nobody reported the state and it is concluded from quantities and times. */
            isStateInferred: boolean;
            /**
             * Format: date-time
             * @description When a report about it arrived last.
             */
            lastReportAt?: string | null;
            /** @description The operation. */
            operationId: string;
            /** @description The factory that carries it out. */
            owningFactoryId?: string | null;
            /**
             * Format: double
             * @description How far it is, 0 to 100: as reported, else from the quantities.
             */
            percentComplete?: number | null;
            /**
             * Format: double
             * @description How much is planned.
             */
            plannedQuantity?: number | null;
            /**
             * Format: double
             * @description What is produced so far, in `quantityUnit`; the good ones where only those are reported.
             */
            quantity?: number | null;
            /** @description The unit of all quantities. */
            quantityUnit?: string | null;
            /**
             * Format: double
             * @description What of it is scrap.
             */
            scrapQuantity?: number | null;
            /** @description Its state after ISA-95. */
            state?: string | null;
        };
        /** @description A company, institute or person that takes part. */
        Organisation: {
            /**
             * Format: date-time
             * @description Since when it is here.
             */
            createdAt: string;
            /** @description What people call it. */
            name: string;
            /** @description Its id. */
            organisationId: string;
        };
        /** @description A page of a list. */
        Page_Collaboration: {
            /** @description The entries. */
            items: {
                /** @description Its id. */
                collaborationId: string;
                /**
                 * Format: date-time
                 * @description Since when it is here.
                 */
                createdAt: string;
                /** @description The factories that take part, by id. */
                factories: string[];
                /** @description The organisations that take part, by id. */
                members: string[];
                /** @description What people call it. */
                name: string;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_CommentEntry: {
            /** @description The entries. */
            items: {
                /** @description Who says it. */
                authorId: string;
                /**
                 * Format: int64
                 * @description Its number, counting up.
                 */
                commentId: number;
                /**
                 * Format: date-time
                 * @description When it came here.
                 */
                createdAt: string;
                /** @description The request talked about. */
                dynamicDataRequestId?: string | null;
                /** @description The factory that takes part in the talk. */
                factoryId: string;
                /** @description The field talked about. */
                fieldName?: string | null;
                /** @description Whether it came from the factory. */
                isFromFactory: boolean;
                /** @description What is said. */
                text: string;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_DeadLetterView: {
            /** @description The entries. */
            items: {
                /** @description Where it was sent to. */
                address: string;
                /**
                 * Format: date-time
                 * @description When it was set aside.
                 */
                at: string;
                /**
                 * Format: int64
                 * @description How large its body is.
                 */
                bytes: number;
                /** @description A stable code, as `FORGED_PUBLISHER`. */
                code: string;
                /** @description `ingest-<number>` or `broker-<number>`. */
                id: string;
                messageId?: string | null;
                /** @description Why, for people. */
                reason: string;
                /**
                 * Format: date-time
                 * @description When it was tried again, if it was.
                 */
                replayedAt?: string | null;
                subject?: string | null;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Factory: {
            /** @description The entries. */
            items: {
                /**
                 * Format: date-time
                 * @description Since when it is known here.
                 */
                createdAt: string;
                /**
                 * Format: date-time
                 * @description When its connector enrolled last; absent before.
                 */
                enrolledAt?: string | null;
                /** @description Its id, also its PublisherId and part of its addresses. */
                factoryId: string;
                /**
                 * Format: date-time
                 * @description When a report of it arrived last.
                 */
                lastReportAt?: string | null;
                /**
                 * Format: date-time
                 * @description When anything of it arrived last, keep-alives included.
                 */
                lastSeenAt?: string | null;
                /** @description What people call it. */
                name: string;
                /** @description Whose it is. */
                organisationId: string;
                /** @description What its publisher said of itself last (`ua-status`), as `Operational`. */
                publisherState?: string | null;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_NetworkSummary: {
            /** @description The entries. */
            items: {
                /** @description The collaboration it belongs to. */
                collaborationId: string;
                /**
                 * Format: date-time
                 * @description When a report about it that the viewer may see arrived last.
                 */
                lastReportAt?: string | null;
                /** @description What people call it. */
                name?: string | null;
                /** @description Its id. */
                operationNetworkId: string;
                /**
                 * Format: int64
                 * @description How many parts of it were rejected.
                 */
                partsRejected: number;
                /**
                 * Format: int64
                 * @description How many parts of it wait for a factory's answer.
                 */
                partsUnanswered: number;
                /**
                 * Format: int64
                 * @description Its newest revision.
                 */
                revision: number;
                /**
                 * Format: date-time
                 * @description When that was made.
                 */
                updatedAt: string;
                /**
                 * Format: date-time
                 * @description When it was withdrawn, if it was.
                 */
                withdrawnAt?: string | null;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Organisation: {
            /** @description The entries. */
            items: {
                /**
                 * Format: date-time
                 * @description Since when it is here.
                 */
                createdAt: string;
                /** @description What people call it. */
                name: string;
                /** @description Its id. */
                organisationId: string;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Report: {
            /** @description The entries. */
            items: (components["schemas"]["RequestKey"] & {
                /**
                 * Format: int32
                 * @description The writer.
                 */
                dataSetWriterId: number;
                /**
                 * Format: int32
                 * @description Its epoch.
                 */
                epoch: number;
                /** @description Who reported. */
                factoryId: string;
                /** @description Field name to `{value, status, sourceTimestamp}`. */
                fields: Record<string, never>;
                /** @description Whether it came late, after newer ones. */
                isReplay: boolean;
                /**
                 * Format: date-time
                 * @description When it arrived.
                 */
                receivedAt: string;
                /**
                 * Format: int64
                 * @description Its number on this platform, counting up in the order of arrival.
                 */
                reportId: number;
                /** @description The report's name. */
                reportName: string;
                /**
                 * Format: date-time
                 * @description When the connector made it.
                 */
                reportTimestamp?: string | null;
                /**
                 * Format: int32
                 * @description The sequence number within the epoch.
                 */
                sequence: number;
                /**
                 * Format: date-time
                 * @description The newest source time among the fields.
                 */
                shopfloorTimestamp?: string | null;
            })[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Tool: {
            /** @description The entries. */
            items: {
                /**
                 * Format: date-time
                 * @description Since when it is known here.
                 */
                createdAt: string;
                /** @description What people call it. */
                name: string;
                /** @description Whose it is. */
                organisationId: string;
                /** @description Its id, also part of its addresses. */
                toolId: string;
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_WriterView: {
            /** @description The entries. */
            items: {
                /** Format: int32 */
                dataSetWriterId: number;
                /**
                 * Format: int64
                 * @description Repeats that were discarded.
                 */
                duplicates: number;
                /** Format: int32 */
                epoch: number;
                /** @description Numbers that the factory announced will never come. */
                gaps: components["schemas"]["GapView"][];
                /**
                 * Format: date-time
                 * @description When a keep-alive arrived last.
                 */
                lastKeepAliveAt?: string | null;
                /**
                 * Format: date-time
                 * @description When a report arrived last.
                 */
                lastReportAt?: string | null;
                /** @description The lowest numbers below it that are missing, at most 1000. */
                missing: number[];
                /**
                 * Format: int64
                 * @description How many numbers are missing in all.
                 */
                missingCount: number;
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
            }[];
            /** @description Where the next page begins; absent on the last one. */
            nextCursor?: string | null;
        };
        /**
         * @description What became of a part.
         * @enum {string}
         */
        PartState: "SENT" | "ACCEPTED" | "UNCHANGED" | "REJECTED";
        /** @description What a factory was sent of a network, with the evidence of its life. */
        PartView: {
            /**
             * Format: date-time
             * @description When it was answered.
             */
            answeredAt?: string | null;
            /** @description The factory. */
            factoryId: string;
            /** @description What people call it. */
            factoryName?: string | null;
            /** @description Why it was rejected. */
            faultList: Record<string, never>[];
            /** @description True where the part ends the network at the factory. */
            isWithdrawal: boolean;
            /**
             * Format: date-time
             * @description When anything of the factory arrived last.
             */
            lastSeenAt?: string | null;
            /** @description Whose it is. */
            organisationId?: string | null;
            /**
             * Format: int64
             * @description The revision in which its part changed last.
             */
            revision: number;
            /**
             * Format: date-time
             * @description When it was sent last.
             */
            sentAt: string;
            /**
             * Format: int32
             * @description How often it was sent.
             */
            sentCount: number;
            /** @description What became of it. */
            state: components["schemas"]["PartState"];
        };
        /** @description A connector that holds the lease or asked for it. */
        Party: {
            /** @description Its machine and folder. */
            host: string;
            /** @description The running connector; another one at every start. */
            instanceId: string;
            /** @description The holder was heard after it had asked: both run. It gets the lease from an administrator only. */
            isSecond?: boolean;
            /**
             * Format: date-time
             * @description When it asked last.
             */
            lastHeardAt: string;
            /** @description Where its store is in use. */
            place: string;
            /**
             * Format: date-time
             * @description Since when it holds the lease, or when it asked first.
             */
            since: string;
        };
        /**
         * @description A problem document. `code` is stable and for programs, `detail` is for people; what went wrong inside is logged and
         *     never shown.
         */
        Problem: {
            /** @description A stable code, as `NOT_FOUND`. */
            code: string;
            /** @description What is wrong and what to do, for people. */
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
            /** @description `urn:verbund:problem:<code>`. */
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
        /** @description A whole network to put in place. */
        PutBody: {
            collaborationId: string;
            /** @description The whole network (wire contract `operation-network`), each operation with `owningFactoryId`. */
            operationNetwork: Record<string, never>;
        };
        /** @description What a user is to be. */
        PutUser: {
            /** @description For whom the user looks and acts. */
            organisationId?: string | null;
            /** Format: password */
            password: string;
            role: components["schemas"]["Role"];
        };
        /** @description What trying again did. */
        Replayed: {
            /** @description Whether it was taken this time or waits in its queue again. */
            isTaken: boolean;
        };
        /** @description A report as its recipients see it. */
        Report: components["schemas"]["RequestKey"] & {
            /**
             * Format: int32
             * @description The writer.
             */
            dataSetWriterId: number;
            /**
             * Format: int32
             * @description Its epoch.
             */
            epoch: number;
            /** @description Who reported. */
            factoryId: string;
            /** @description Field name to `{value, status, sourceTimestamp}`. */
            fields: Record<string, never>;
            /** @description Whether it came late, after newer ones. */
            isReplay: boolean;
            /**
             * Format: date-time
             * @description When it arrived.
             */
            receivedAt: string;
            /**
             * Format: int64
             * @description Its number on this platform, counting up in the order of arrival.
             */
            reportId: number;
            /** @description The report's name. */
            reportName: string;
            /**
             * Format: date-time
             * @description When the connector made it.
             */
            reportTimestamp?: string | null;
            /**
             * Format: int32
             * @description The sequence number within the epoch.
             */
            sequence: number;
            /**
             * Format: date-time
             * @description The newest source time among the fields.
             */
            shopfloorTimestamp?: string | null;
        };
        /** @description One dynamic data request, addressed through its network and operation. */
        RequestKey: {
            /** @description The request. */
            dynamicDataRequestId: string;
            /** @description The operation. */
            operationId: string;
            /** @description The network. */
            operationNetworkId: string;
        };
        /** @description What a revocation did. */
        Revoked: {
            /** @description Connections cut. */
            connections: number;
            /**
             * Format: int64
             * @description Credentials taken away.
             */
            credentials: number;
        };
        /**
         * @description What a user may do.
         * @enum {string}
         */
        Role: "ADMINISTRATOR" | "PLANNER" | "VIEWER";
        /** @description Who is signed in. */
        Session: {
            /** @description What changes must carry in the header `x-csrf-token`. */
            csrfToken: string;
            organisationId?: string | null;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /** @description Who wants to sign in. */
        SignIn: {
            /** Format: password */
            password: string;
            userName: string;
        };
        /** @description How the platform stands, with evidence. */
        Status: {
            /** @description Who is connected to the embedded broker; for administrators. */
            connections?: Record<string, never>[] | null;
            /** @description How the link to the broker stands. */
            link?: Record<string, never> | null;
            /**
             * Format: date-time
             * @description Its own clock, to tell ages by.
             */
            now: string;
            /** @description The queues of the embedded broker; for administrators. */
            queues?: Record<string, never>[] | null;
            /**
             * Format: date-time
             * @description When it started.
             */
            startedAt: string;
            /** @description The version of the program. */
            version: string;
        };
        /** @description A token to enrol with, shown this once. */
        TokenView: {
            /**
             * Format: date-time
             * @description Until when it can be used.
             */
            expiresAt: string;
            /** @description For `factory-connector enrol`; contains the platform's address. */
            token: string;
        };
        /** @description A tool of an organisation; it may do what a planner of that organisation may do. */
        Tool: {
            /**
             * Format: date-time
             * @description Since when it is known here.
             */
            createdAt: string;
            /** @description What people call it. */
            name: string;
            /** @description Whose it is. */
            organisationId: string;
            /** @description Its id, also part of its addresses. */
            toolId: string;
        };
        /** @description All a tool needs to reach the broker, shown this once. */
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
        /** @description A user. */
        UserView: {
            organisationId?: string | null;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /** @description What is held of a writer within an epoch. */
        WriterView: {
            /** Format: int32 */
            dataSetWriterId: number;
            /**
             * Format: int64
             * @description Repeats that were discarded.
             */
            duplicates: number;
            /** Format: int32 */
            epoch: number;
            /** @description Numbers that the factory announced will never come. */
            gaps: components["schemas"]["GapView"][];
            /**
             * Format: date-time
             * @description When a keep-alive arrived last.
             */
            lastKeepAliveAt?: string | null;
            /**
             * Format: date-time
             * @description When a report arrived last.
             */
            lastReportAt?: string | null;
            /** @description The lowest numbers below it that are missing, at most 1000. */
            missing: number[];
            /**
             * Format: int64
             * @description How many numbers are missing in all.
             */
            missingCount: number;
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
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export type operations = Record<string, never>;

/** The paths that the daemon of this build answers: a page offers nothing else. */
export const PATHS: readonly string[] = [
  "/api/v1/collaborations",
  "/api/v1/collaborations/{collaborationId}/factories/{factoryId}",
  "/api/v1/collaborations/{collaborationId}/members/{organisationId}",
  "/api/v1/dead-letters",
  "/api/v1/dead-letters/{deadLetterId}/replay",
  "/api/v1/enrolments",
  "/api/v1/factories",
  "/api/v1/factories/{factoryId}/credentials",
  "/api/v1/factories/{factoryId}/enrolment-tokens",
  "/api/v1/factories/{factoryId}/lease",
  "/api/v1/factories/{factoryId}/lease/handovers",
  "/api/v1/factories/{factoryId}/writers",
  "/api/v1/live",
  "/api/v1/operation-networks",
  "/api/v1/operation-networks/{operationNetworkId}",
  "/api/v1/operation-networks/{operationNetworkId}/comments",
  "/api/v1/operation-networks/{operationNetworkId}/operations/{operationId}/requests",
  "/api/v1/operation-networks/{operationNetworkId}/operations/{operationId}/requests/{dynamicDataRequestId}",
  "/api/v1/organisations",
  "/api/v1/reports",
  "/api/v1/session",
  "/api/v1/status",
  "/api/v1/tools",
  "/api/v1/tools/{toolId}/credentials",
  "/api/v1/users/{userName}"
]
