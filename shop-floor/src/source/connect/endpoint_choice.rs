//! Choice among the endpoints that a server offers.

use opcua_stack::opcua::{
    crypto,
    types::{EndpointDescription, MessageSecurityMode, UAString, UserTokenType},
};

use crate::{
    Identity, MessageSecurity, SecurityChoice, SecurityPolicy, SourceProblem,
    SourceProblemKind as Kind,
};

/// Returns the strongest endpoint that fits the choice of security and the identity.
pub(super) fn choose<'a>(
    offered: &'a [EndpointDescription],
    choice: SecurityChoice,
    identity: &Identity,
) -> Result<&'a EndpointDescription, SourceProblem> {
    let unsuitable = |kind: Kind, message: String| Err(SourceProblem::new(kind, message));
    let fits = |endpoint: &&EndpointDescription| {
        let Some(policy) = policy_of(endpoint) else { return false };
        let mode = mode_of(endpoint.security_mode);
        match choice {
            // The list of endpoints comes without protection: who takes the encrypted ones out of it must
            // not get values that are signed alone, which everybody on the network reads.
            SecurityChoice::Strongest => {
                policy != SecurityPolicy::None && mode == MessageSecurity::SignAndEncrypt
            }
            SecurityChoice::None => policy == SecurityPolicy::None,
            SecurityChoice::Exactly { policy: chosen_policy, mode: chosen_mode } => {
                (policy, mode) == (chosen_policy, chosen_mode)
            }
        }
    };
    let secure_enough: Vec<_> = offered.iter().filter(fits).collect();
    if secure_enough.is_empty() {
        let names: Vec<_> = offered.iter().map(offer_name).collect();
        // Where nothing can be chosen instead, the server has to change.
        let is_outdated = !offered.is_empty() && offered.iter().all(|one| policy_of(one).is_none());
        let kind = if is_outdated { Kind::SecurityOutdated } else { Kind::NoSuitableEndpoint };
        let hint = match choice {
            _ if is_outdated => "only security policies that are outdated",
            SecurityChoice::Strongest => {
                "no endpoint with encryption that is not outdated; choose one of these to accept that"
            }
            SecurityChoice::None => "no unprotected endpoint",
            SecurityChoice::Exactly { .. } => "no endpoint with the wanted policy and mode",
        };
        let names = names.join(", ");
        return unsuitable(kind, format!("The server offers {hint}. It offers: {names}."));
    }
    let token = match identity {
        Identity::Anonymous => UserTokenType::Anonymous,
        Identity::UserName { .. } => UserTokenType::UserName,
        Identity::Certificate { .. } => UserTokenType::Certificate,
    };
    let strongest = secure_enough
        .into_iter()
        .filter(|endpoint| allows(endpoint, token))
        .max_by_key(|endpoint| {
            (mode_of(endpoint.security_mode), policy_of(endpoint), endpoint.security_level)
        });
    match strongest {
        Some(endpoint) => Ok(endpoint),
        None => {
            let message = format!("The server does not accept sign-in by {token:?} there.");
            unsuitable(Kind::NoSuitableEndpoint, message)
        }
    }
}

/// Returns whether signing in at an endpoint shows a password to everybody on the network. Encrypted with the key that an
/// unprotected server names it is no safer: anybody may name his own.
pub(super) fn exposes_password(endpoint: &EndpointDescription, identity: &Identity) -> bool {
    let is_unprotected = policy_of(endpoint).is_none_or(|policy| policy == SecurityPolicy::None)
        || mode_of(endpoint.security_mode) == MessageSecurity::None;
    is_unprotected && matches!(identity, Identity::UserName { .. })
}

pub(in crate::source) fn allows(endpoint: &EndpointDescription, token: UserTokenType) -> bool {
    endpoint.user_identity_tokens.iter().flatten().any(|policy| policy.token_type == token)
}

/// Returns the security policy of an endpoint; `None` for one that is deprecated or unknown.
pub(in crate::source) fn policy_of(endpoint: &EndpointDescription) -> Option<SecurityPolicy> {
    match crypto::SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref()) {
        crypto::SecurityPolicy::None => Some(SecurityPolicy::None),
        crypto::SecurityPolicy::Aes128Sha256RsaOaep => Some(SecurityPolicy::Aes128Sha256RsaOaep),
        crypto::SecurityPolicy::Basic256Sha256 => Some(SecurityPolicy::Basic256Sha256),
        crypto::SecurityPolicy::Aes256Sha256RsaPss => Some(SecurityPolicy::Aes256Sha256RsaPss),
        _ => None,
    }
}

pub(in crate::source) const fn mode_of(mode: MessageSecurityMode) -> MessageSecurity {
    match mode {
        MessageSecurityMode::Sign => MessageSecurity::Sign,
        MessageSecurityMode::SignAndEncrypt => MessageSecurity::SignAndEncrypt,
        _ => MessageSecurity::None,
    }
}

pub(in crate::source) fn text(text: &UAString) -> String {
    text.value().clone().unwrap_or_default()
}

/// Returns policy and mode of an endpoint for people.
pub(in crate::source) fn offer_name(endpoint: &EndpointDescription) -> String {
    let uri = endpoint.security_policy_uri.as_ref();
    let policy = uri.rsplit_once('#').map_or(uri, |(_, name)| name);
    format!("{policy} {:?}", mode_of(endpoint.security_mode))
}

/// Combines the configured host and port with the path of the address that the server returned.
pub(in crate::source) fn reachable_url(configured: &str, returned: &str) -> String {
    let split = |url: &str| {
        let rest = url.strip_prefix("opc.tcp://").unwrap_or(url);
        let at = rest.find('/').unwrap_or(rest.len());
        (rest[..at].to_owned(), rest[at..].to_owned())
    };
    format!("opc.tcp://{}{}", split(configured).0, split(returned).1)
}

#[cfg(test)]
mod tests {
    use opcua_stack::opcua::types::UserTokenPolicy;

    use super::*;

    fn endpoint(
        policy: &str,
        mode: MessageSecurityMode,
        tokens: &[UserTokenType],
    ) -> EndpointDescription {
        EndpointDescription {
            security_policy_uri: format!("http://opcfoundation.org/UA/SecurityPolicy#{policy}")
                .into(),
            security_mode: mode,
            user_identity_tokens: Some(
                tokens
                    .iter()
                    .map(|token_type| UserTokenPolicy {
                        token_type: *token_type,
                        ..UserTokenPolicy::default()
                    })
                    .collect(),
            ),
            ..EndpointDescription::default()
        }
    }

    #[test]
    fn the_strongest_suitable_endpoint_is_chosen_and_an_unprotected_one_only_on_request() {
        use MessageSecurityMode::{None, Sign, SignAndEncrypt};
        let both = [UserTokenType::Anonymous, UserTokenType::UserName];
        let offered = [
            endpoint("None", None, &both),
            endpoint("Basic256", SignAndEncrypt, &both),
            endpoint("Basic256Sha256", Sign, &both),
            endpoint("Basic256Sha256", SignAndEncrypt, &both),
            endpoint("Aes256_Sha256_RsaPss", SignAndEncrypt, &[UserTokenType::Certificate]),
        ];
        let user = Identity::UserName { user_name: "a".into(), password: "b".into() };
        let check = |offered: &[EndpointDescription],
                     choice,
                     identity: &Identity,
                     expected: Option<&str>| {
            let chosen = choose(offered, choice, identity).ok().map(offer_name);
            assert_eq!(chosen.as_deref(), expected, "{choice:?}");
        };
        let exactly =
            |mode| SecurityChoice::Exactly { policy: SecurityPolicy::Basic256Sha256, mode };
        check(&offered, SecurityChoice::Strongest, &user, Some("Basic256Sha256 SignAndEncrypt"));
        check(&offered, SecurityChoice::None, &Identity::Anonymous, Some("None None"));
        check(&offered, exactly(MessageSecurity::Sign), &user, Some("Basic256Sha256 Sign"));
        check(&offered[..2], SecurityChoice::Strongest, &user, Option::None);
        check(&offered[..3], SecurityChoice::Strongest, &user, Option::None);
        check(&offered[4..], SecurityChoice::Strongest, &user, Option::None);
    }

    #[test]
    fn a_server_whose_security_is_outdated_throughout_has_to_change() {
        use MessageSecurityMode::{None, SignAndEncrypt};
        let tokens = [UserTokenType::Anonymous];
        let outdated = endpoint("Basic128Rsa15", SignAndEncrypt, &tokens);
        let offered = [outdated, endpoint("None", None, &tokens)];
        let kind = |offered: &[EndpointDescription]| {
            let chosen = choose(offered, SecurityChoice::Strongest, &Identity::Anonymous);
            chosen.expect_err("nothing fits").kind
        };
        assert_eq!(kind(&offered[..1]), Kind::SecurityOutdated);
        assert_eq!(kind(&offered), Kind::NoSuitableEndpoint, "another choice is left");
    }

    #[test]
    fn a_password_is_exposed_where_nothing_protects_the_connection() {
        let user = Identity::UserName { user_name: "a".into(), password: "b".into() };
        let tokens = [UserTokenType::UserName];
        let unprotected = endpoint("None", MessageSecurityMode::None, &tokens);
        let signed = endpoint("Basic256Sha256", MessageSecurityMode::Sign, &tokens);
        let half = endpoint("Basic256Sha256", MessageSecurityMode::None, &tokens);
        for (endpoint, identity, expected) in [
            (&unprotected, &user, true),
            (&half, &user, true),
            (&signed, &user, false),
            (&unprotected, &Identity::Anonymous, false),
        ] {
            assert_eq!(exposes_password(endpoint, identity), expected, "{}", offer_name(endpoint));
        }
    }

    #[test]
    fn the_configured_host_and_port_replace_those_of_the_server() {
        for (configured, returned, expected) in [
            (
                "opc.tcp://10.0.0.7:4840",
                "opc.tcp://plc:4841/UA/Server",
                "opc.tcp://10.0.0.7:4840/UA/Server",
            ),
            ("opc.tcp://10.0.0.7:4840/x", "opc.tcp://plc", "opc.tcp://10.0.0.7:4840"),
        ] {
            assert_eq!(reachable_url(configured, returned), expected);
        }
    }
}
