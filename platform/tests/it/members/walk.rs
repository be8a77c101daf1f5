//! Walk over every reading operation of the description, with every parameter from a list of ids. A
//! new parameter without values fails the test.

use reqwest::Method;
use serde_json::Value;
use testkit::ApiClient;

/// Operation whose answer has no end; its events are read as they come.
const STREAM: &str = "/live";

/// Epoch of the writers in the stories.
const EPOCH: u32 = 608_926_829;

/// Ids that parameters take, those of things that do not exist among them.
pub struct Ids {
    pub networks: Vec<String>,
    pub factories: Vec<String>,
    pub requests: Vec<String>,
    pub organisations: Vec<String>,
}

impl Ids {
    fn values(&self, parameter: &str) -> Vec<String> {
        let texts = |list: &[&str]| list.iter().map(|&text| text.to_owned()).collect();
        match parameter {
            "operationNetworkId" | "network" => self.networks.clone(),
            "factoryId" => self.factories.clone(),
            "request" => self.requests.clone(),
            "viewer" => self.organisations.clone(),
            "userName" => self.organisations.iter().map(|id| format!("{id}-planner")).collect(),
            "cursor" => texts(&["1"]),
            "after" => {
                let cursor = |factory: &String| format!("1-{EPOCH}-0-{factory}");
                self.factories.iter().map(cursor).collect()
            }
            "limit" => texts(&["1", "1000"]),
            "newest" => texts(&["true", "false"]),
            other => panic!("the parameter {other} has no values"),
        }
    }
}

/// One call of an operation.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Path of the operation, with the names of its parameters.
    pub operation: String,
    pub path: String,
}

/// An answer to a reading.
pub struct ReadAnswer {
    pub reading: Reading,
    pub status: u16,
    /// Names and values of all headers.
    pub headers: String,
    pub body: String,
}

/// Lists the readings: each operation with each combination of ids in its path, without a query, with
/// each value of each parameter of it, and with the first and the last values of all parameters together.
pub fn readings(ids: &Ids) -> Vec<Reading> {
    let description: Value = serde_json::to_value(platform::api::openapi()).expect("it serialises");
    let mut readings = Vec::new();
    for (path, methods) in description["paths"].as_object().expect("paths") {
        let operation = path.strip_prefix("/api/v1").expect("all are under /api/v1");
        let Some(get) = methods.get("get").filter(|_| operation != STREAM) else { continue };
        let (mut paths, mut queries) = (vec![operation.to_owned()], vec![String::new()]);
        let (mut first, mut last) = (Vec::new(), Vec::new());
        for parameter in get["parameters"].as_array().into_iter().flatten() {
            let name = parameter["name"].as_str().expect("a name");
            let values = ids.values(name);
            if parameter["in"] == "path" {
                let mark = format!("{{{name}}}");
                let filled = |path: &String| -> Vec<String> {
                    values.iter().map(|value| path.replace(&mark, value)).collect()
                };
                paths = paths.iter().flat_map(filled).collect();
            } else {
                queries.extend(values.iter().map(|value| format!("?{name}={value}")));
                first.extend(values.first().map(|value| format!("{name}={value}")));
                last.extend(values.last().map(|value| format!("{name}={value}")));
            }
        }
        if first.len() > 1 {
            queries.extend([first, last].map(|all| format!("?{}", all.join("&"))));
        }
        for path in &paths {
            readings.extend(queries.iter().map(|query| Reading {
                operation: operation.to_owned(),
                path: format!("{path}{query}"),
            }));
        }
    }
    assert!(readings.len() > 50, "only {} readings", readings.len());
    readings
}

/// Reads all of these, one after the other.
pub async fn read(client: &ApiClient, readings: &[Reading]) -> Vec<ReadAnswer> {
    let mut answers = Vec::with_capacity(readings.len());
    for reading in readings {
        let request = client.request(Method::GET, &format!("/api/v1{}", reading.path));
        let response = request.send().await.expect("an answer");
        let (status, headers) = (response.status().as_u16(), format!("{:?}", response.headers()));
        let body = response.text().await.expect("a text");
        let is_known = [200, 403, 404].contains(&status);
        assert!(is_known, "{}: {status} {body}", reading.path);
        answers.push(ReadAnswer { reading: reading.clone(), status, headers, body });
    }
    answers
}
