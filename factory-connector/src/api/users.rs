//! Users of the pages and of the OPC UA server.

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, StatusCode, header},
};
use daemon::{
    Confidential,
    web::{
        ApiJson, ApiPath, Problem,
        problem::ProblemFault,
        session::{HashingError, PasswordError, PasswordHashing, PasswordPolicy},
    },
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{context::Api, problems::Problems, roles::Engineer, view::Page};
use crate::{
    clock::now,
    store::{Role, User},
};

/// Longest name, in characters.
const NAME_CHARS_MAX: usize = 64;
/// Most users of a connector; one more is refused. The list of users has no pages.
const USERS_MAX: usize = 1000;

/// A person who may sign in.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct UserView {
    user_name: String,
    role: Role,
}

/// Lists all users.
#[utoipa::path(
    get,
    path = "/users",
    tag = "users",
    responses((status = 200, body = Page<UserView>), Problems)
)]
pub async fn list_users(
    _: Engineer,
    State(api): State<Api>,
) -> Result<Json<Page<UserView>>, Problem> {
    Ok(Json(Page::whole(all_users(&api).await?)))
}

/// Role and password of a user.
#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct UserBody {
    role: Role,
    /// At least ten characters; needed for a new person, unchanged without it.
    #[schema(value_type = Option<String>, format = Password)]
    password: Option<Confidential<String>>,
}

/// Adds a person, or changes role or password. With a new password the person's sessions end,
/// except the one in which the person did it; those of OPC UA clients also end with another role.
/// `If-None-Match: *` adds only: it is refused (`ALREADY_EXISTS`) where the name is taken.
#[utoipa::path(
    put,
    path = "/users/{userName}",
    tag = "users",
    params(("userName" = String, Path), ("If-None-Match" = Option<String>, Header)),
    request_body = UserBody,
    responses((status = 200, body = UserView), Problems)
)]
pub async fn put_user(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(user_name): ApiPath<String>,
    headers: HeaderMap,
    ApiJson(body): ApiJson<UserBody>,
) -> Result<Json<UserView>, Problem> {
    check_name(&user_name)?;
    // Two engineers who take each other's role at once must not both succeed.
    let _change = api.accounts.change().await;
    let known = api.store().await?.users().lookup(&user_name).await?;
    let known_users = all_users(&api).await?;
    if known.is_some() && headers.contains_key(header::IF_NONE_MATCH) {
        return Err(Problem::conflict(
            "ALREADY_EXISTS",
            "There is a person with this name already.",
        ));
    }
    if known.is_none() && known_users.len() >= USERS_MAX {
        return Err(Problem::conflict(
            "LIMIT_REACHED",
            "There are 1000 users already. Remove some first.",
        ));
    }
    if body.role != Role::Engineer {
        keep_an_engineer(&known_users, &user_name)?;
    }
    let has_new_password = body.password.is_some();
    let password_hash = match (body.password, known) {
        (Some(password), _) => hash(api.sessions.hashing(), password).await?,
        (None, Some(known)) => known.password_hash,
        (None, None) => return Err(fault("/password", "A new person needs a password.")),
    };
    if has_new_password && user_name == user.principal.user_name {
        api.accounts.extend_to(&user.session, &password_hash);
    }
    let changed = User { user_name: user_name.clone(), role: body.role, password_hash };
    let writer = api.accounts.writer();
    writer
        .write(move |mut session| async move { session.users().put(&changed, now()).await })
        .await?;
    if has_new_password {
        api.accounts.end_sessions_of(&user_name, Some(&user.session));
    }
    api.users_changed.notify_one();
    tracing::info!(
        user.name = user_name,
        user.role = body.role.name(),
        by = user.principal.user_name,
        "A user was changed."
    );
    Ok(Json(UserView { user_name, role: body.role }))
}

/// Removes a person; the person's sessions end.
#[utoipa::path(
    delete,
    path = "/users/{userName}",
    tag = "users",
    params(("userName" = String, Path)),
    responses((status = 204, description = "Removed"), Problems)
)]
pub async fn remove_user(
    user: Engineer,
    State(api): State<Api>,
    ApiPath(user_name): ApiPath<String>,
) -> Result<StatusCode, Problem> {
    let _change = api.accounts.change().await;
    keep_an_engineer(&all_users(&api).await?, &user_name)?;
    let name = user_name.clone();
    let writer = api.accounts.writer();
    if !writer.write(move |mut session| async move { session.users().remove(&name).await }).await? {
        return Err(Problem::not_found(format_args!("user {user_name}")));
    }
    api.accounts.end_sessions_of(&user_name, None);
    api.users_changed.notify_one();
    tracing::info!(user.name = user_name, by = user.principal.user_name, "A user was removed.");
    Ok(StatusCode::NO_CONTENT)
}

async fn all_users(api: &Api) -> Result<Vec<UserView>, Problem> {
    let found = api.store().await?.users().all().await?;
    Ok(found
        .into_iter()
        .map(|user| UserView { user_name: user.user_name, role: user.role })
        .collect())
}

async fn hash(
    hashing: &PasswordHashing,
    password: Confidential<String>,
) -> Result<String, Problem> {
    use PasswordError::{TooLong, TooShort};
    match hashing.hash(password, PasswordPolicy::default()).await {
        Ok(hash) => Ok(hash.as_str().to_owned()),
        Err(HashingError::Password(error @ (TooShort { .. } | TooLong { .. }))) => {
            Err(fault("/password", &format!("{error}.")))
        }
        Err(HashingError::Busy) => Err(Problem::unavailable(
            "BUSY",
            "Too many passwords wait to be checked; try again in a moment.",
        )),
        Err(error) => Err(Problem::internal(&error)),
    }
}

/// Returns a conflict if no engineer would be left, who alone can add another one.
fn keep_an_engineer(users: &[UserView], but: &str) -> Result<(), Problem> {
    let is_left = users.iter().any(|user| user.role == Role::Engineer && user.user_name != but);
    if is_left || !users.iter().any(|user| user.user_name == but) {
        return Ok(());
    }
    Err(Problem::conflict(
        "LAST_ENGINEER",
        "This is the last engineer. Make another person one first.",
    ))
}

fn check_name(name: &str) -> Result<(), Problem> {
    let count = name.chars().count();
    let is_name = (1..=NAME_CHARS_MAX).contains(&count)
        && name.trim() == name
        && !name.chars().any(|letter| letter.is_control() || letter == '/');
    if is_name {
        return Ok(());
    }
    Err(fault("/userName", "A name has 1 to 64 characters, none of them / and none invisible."))
}

fn fault(pointer: &str, message: &str) -> Problem {
    let fault = ProblemFault {
        pointer: pointer.to_owned(),
        code: "INVALID_USER".to_owned(),
        message: message.to_owned(),
    };
    Problem::unprocessable("INVALID_USER", message, vec![fault])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn person(user_name: &str, role: Role) -> UserView {
        UserView { user_name: user_name.to_owned(), role }
    }

    #[test]
    fn the_last_engineer_stays() {
        let one = [person("eva", Role::Engineer), person("otto", Role::Operator)];
        assert!(keep_an_engineer(&one, "eva").is_err());
        assert!(keep_an_engineer(&one, "otto").is_ok());
        assert!(
            keep_an_engineer(&one, "nobody").is_ok(),
            "who is not there takes no engineer away"
        );
        let two = [person("eva", Role::Engineer), person("ida", Role::Engineer)];
        assert!(keep_an_engineer(&two, "eva").is_ok());
    }

    #[test]
    fn names_are_names() {
        for name in ["eva", "Eva Müller", "eva@plant"] {
            assert!(check_name(name).is_ok(), "{name}");
        }
        for name in ["", " eva", "a/b", "a\nb", &"x".repeat(65)] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
    }
}
