//! Queries of what a removal ends, and of what is in its way. Each has two parameters; the lists have a bound as third.

/// The one administrator that there is: without one nobody runs the platform.
pub(super) const LAST_ADMINISTRATOR: &str = "SELECT 'users/' || u.user_name AS path FROM user_account u
    WHERE u.user_name = $1 AND u.role = 'ADMINISTRATOR' AND $2 = '' AND NOT EXISTS (
        SELECT 1 FROM user_account o WHERE o.role = 'ADMINISTRATOR' AND o.user_name <> $1) LIMIT $3";
/// The administrators of an organisation, where there is no other one.
pub(super) const ALL_ADMINISTRATORS: &str =
    "SELECT 'users/' || u.user_name AS path FROM user_account u
    WHERE u.organisation_id = $1 AND u.role = 'ADMINISTRATOR' AND $2 = '' AND NOT EXISTS (
        SELECT 1 FROM user_account o WHERE o.role = 'ADMINISTRATOR'
        AND (o.organisation_id IS NULL OR o.organisation_id <> $1)) ORDER BY 1 LIMIT $3";
pub(super) const SESSIONS_OF_USER: &str =
    "SELECT COUNT(*) FROM session WHERE user_name = $1 AND $2 = ''";
pub(super) const SESSIONS_OF_PEOPLE: &str = "SELECT COUNT(*) FROM session s
    JOIN user_account u ON u.user_name = s.user_name WHERE u.organisation_id = $1 AND $2 = ''";
pub(super) const CREDENTIALS: &str =
    "SELECT COUNT(*) FROM broker_credential WHERE holder_kind = $1 AND holder_id = $2";
pub(super) const PEOPLE: &str =
    "SELECT user_name AS path FROM user_account WHERE organisation_id = $1 AND $2 = ''
    ORDER BY user_name LIMIT $3";
pub(super) const REQUESTS_OF_TOOL: &str =
    "SELECT 'operation-networks/' || t.operation_network_id || '/requests/'
        || t.dynamic_data_request_id AS path
    FROM request_tool t JOIN operation_network n ON n.operation_network_id = t.operation_network_id
    WHERE t.tool_id = $1 AND $2 = '' AND n.withdrawn_at IS NULL ORDER BY 1 LIMIT $3";
/// Networks in which a factory performs operations, in the collaboration `$2` where one is given.
pub(super) const PERFORMED: &str =
    "SELECT 'operation-networks/' || p.operation_network_id AS path FROM network_part p
    JOIN operation_network n ON n.operation_network_id = p.operation_network_id
    WHERE p.factory_id = $1 AND p.is_withdrawal = 0 AND n.withdrawn_at IS NULL
      AND ($2 = '' OR n.collaboration_id = $2) ORDER BY 1 LIMIT $3";
pub(super) const COLLABORATIONS: &str =
    "SELECT 'collaborations/' || collaboration_id || '/factories/' || factory_id AS path
    FROM collaboration_factory WHERE factory_id = $1 AND $2 = '' ORDER BY 1 LIMIT $3";
pub(super) const MEMBERSHIPS: &str =
    "SELECT 'collaborations/' || collaboration_id || '/members/' || organisation_id AS path
    FROM collaboration_member WHERE organisation_id = $1 AND $2 = '' ORDER BY 1 LIMIT $3";
pub(super) const FACTORIES: &str = "SELECT 'factories/' || factory_id AS path FROM factory
    WHERE organisation_id = $1 AND $2 = '' AND removed_at IS NULL ORDER BY 1 LIMIT $3";
pub(super) const TOOLS: &str = "SELECT 'tools/' || tool_id AS path FROM tool
    WHERE organisation_id = $1 AND $2 = '' AND removed_at IS NULL ORDER BY 1 LIMIT $3";
/// Networks of a collaboration that nobody has withdrawn.
pub(super) const STANDING: &str =
    "SELECT 'operation-networks/' || operation_network_id AS path FROM operation_network
    WHERE collaboration_id = $1 AND $2 = '' AND withdrawn_at IS NULL ORDER BY 1 LIMIT $3";
pub(super) const DRAWN: &str =
    "SELECT 'operation-networks/' || operation_network_id AS path FROM operation_network
    WHERE drawn_by = $1 AND collaboration_id = $2 AND withdrawn_at IS NULL ORDER BY 1 LIMIT $3";
/// Requests in force have fields.
pub(super) const ASKED: &str =
    "SELECT DISTINCT 'operation-networks/' || f.operation_network_id || '/operations/'
        || f.operation_id || '/requests/' || f.dynamic_data_request_id AS path
    FROM request_field f JOIN operation_network n ON n.operation_network_id = f.operation_network_id
    JOIN request_requester q ON q.operation_network_id = f.operation_network_id
        AND q.dynamic_data_request_id = f.dynamic_data_request_id
    WHERE q.requester_id = $1 AND n.collaboration_id = $2 ORDER BY 1 LIMIT $3";
pub(super) const RECEIVED: &str = "SELECT DISTINCT 'operation-networks/' || f.operation_network_id || '/operations/'
        || f.operation_id || '/requests/' || f.dynamic_data_request_id || '/recipients/' || r.organisation_id AS path
    FROM request_field f JOIN operation_network n ON n.operation_network_id = f.operation_network_id
    JOIN request_recipient r ON r.operation_network_id = f.operation_network_id
        AND r.dynamic_data_request_id = f.dynamic_data_request_id
    WHERE r.organisation_id = $1 AND n.collaboration_id = $2 ORDER BY 1 LIMIT $3";
pub(super) const OWN_FACTORIES: &str =
    "SELECT 'collaborations/' || c.collaboration_id || '/factories/' || c.factory_id AS path
    FROM collaboration_factory c JOIN factory f ON f.factory_id = c.factory_id
    WHERE f.organisation_id = $1 AND c.collaboration_id = $2 ORDER BY 1 LIMIT $3";
