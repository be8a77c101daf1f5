//! Tokens of sessions: role and name of a user, as the OPC UA stack holds them.

use std::sync::Arc;

use opcua_stack::opcua::server::authenticator::UserToken;

use crate::access::{Role, TwinUser};

/// The name of anonymous users, which only the development setting admits.
const ANONYMOUS: &str = "anonymous";

/// Returns the user of a session's token. A token of another form is a viewer's, the least role.
pub(crate) fn user_of(token: &UserToken) -> TwinUser {
    match token.0.split_once(':').and_then(|(role, name)| Some((Role::from_name(role)?, name))) {
        Some((role, name)) => TwinUser { name: Arc::from(name), role },
        None => TwinUser { name: Arc::from(ANONYMOUS), role: Role::Viewer },
    }
}

/// Makes the token of a user's session.
pub(crate) fn token_of(name: &str, role: Role) -> UserToken {
    UserToken(format!("{role}:{name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_contains_name_and_role() {
        for (name, role) in [("anna", Role::Engineer), ("b:c", Role::Operator), ("", Role::Viewer)]
        {
            let user = user_of(&token_of(name, role));
            assert_eq!((user.name.as_ref(), user.role), (name, role));
        }
        assert_eq!(user_of(&UserToken("ANONYMOUS".to_owned())).role, Role::Viewer);
        assert_eq!(user_of(&UserToken("root:anna".to_owned())).role, Role::Viewer);
    }
}
