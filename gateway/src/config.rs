//! Zenoh's configuration, which is set only here, so that no file can weaken it.
//!
//! The gateway is a peer at one TLS endpoint; neighbours are clients, because a client reports at once that it cannot
//! connect, while a peer retries silently. The access control denies by default, on both sides.

use serde_json::{Value, json};
use zenoh::Config;

use neighbours::line::Role;

use crate::{
    address::{Allow, Endpoint, Name, Right},
    keys::Keys,
    keyspace::{ANY, CellKeys},
};

const HANDSHAKE: u64 = 2000; // time limit of a handshake, ms
const OPENING: u64 = 5000; // time limit for opening a connection, ms
const SESSIONS: u64 = 32; // greatest number of connections
const MESSAGE: u64 = 64 * 1024; // greatest length of a message, bytes

#[derive(Default)]
struct Rules(Vec<Value>);

#[derive(Clone, Copy, Debug)]
enum Flow {
    Ingress,
    Egress,
}

impl Flow {
    const fn text(self) -> &'static str {
        match self {
            Self::Ingress => "ingress",
            Self::Egress => "egress",
        }
    }

    const fn reverse(self) -> Self {
        match self {
            Self::Ingress => Self::Egress,
            Self::Egress => Self::Ingress,
        }
    }
}

impl Rules {
    fn allow(&mut self, flow: Flow, messages: &[&str], key: String) {
        self.0.push(json!({
            "permission": "allow", "flows": [flow.text()], "messages": messages, "key_exprs": [key],
        }));
    }

    /// A claim of a role by a certificate. `to_gateway` is the direction of its samples.
    fn claim(&mut self, cell: &CellKeys, role: Role, name: &Name, to_gateway: Flow) {
        let (from_gateway, claim) = (to_gateway.reverse(), cell.claim(role, name, ANY));
        self.allow(to_gateway, &["query"], cell.open(role, name));
        self.allow(from_gateway, &["declare_queryable", "reply"], cell.open(role, name));
        self.allow(to_gateway, &["put"], claim.inward());
        self.allow(from_gateway, &["declare_subscriber"], claim.inward());
        self.allow(from_gateway, &["put"], claim.outward());
        self.allow(to_gateway, &["declare_subscriber"], claim.outward());
        self.allow(to_gateway, &["liveliness_token"], claim.alive());
        self.allow(from_gateway, &["declare_liveliness_subscriber", "liveliness_query"], claim.alive());
        self.allow(from_gateway, &["liveliness_token"], cell.alive(ANY));
        self.allow(to_gateway, &["declare_liveliness_subscriber", "liveliness_query"], cell.alive(ANY));
    }

    /// A reader may ask for the status of all cells at once, but receives only the status of `cell`, which may be
    /// [`ANY`].
    fn status(&mut self, cell: &CellKeys, to_reader: Flow) {
        let (every, from_reader) = (CellKeys::of(ANY), to_reader.reverse());
        self.allow(from_reader, &["declare_subscriber"], every.status());
        self.allow(from_reader, &["query"], every.run());
        self.allow(from_reader, &["declare_liveliness_subscriber", "liveliness_query"], every.alive(ANY));
        self.allow(to_reader, &["put"], cell.status());
        self.allow(to_reader, &["declare_queryable", "reply"], cell.run());
        self.allow(to_reader, &["liveliness_token"], cell.alive(ANY));
    }
}

fn access_control(certificates: &[(&Name, Rules)]) -> Value {
    let (mut rules, mut subjects, mut policies) = (Vec::new(), Vec::new(), Vec::new());
    for (name, own) in certificates {
        let mut ids = Vec::new();
        for mut rule in own.0.iter().cloned() {
            let id = rules.len().to_string();
            rule["id"] = json!(id);
            ids.push(id);
            rules.push(rule);
        }
        subjects.push(json!({ "id": name.as_str(), "cert_common_names": [name.as_str()] }));
        policies.push(json!({ "rules": ids, "subjects": [name.as_str()] }));
    }
    json!({
        "enabled": true, "default_permission": "deny",
        "rules": rules, "subjects": subjects, "policies": policies,
    })
}

fn common(mode: &str, keys: &Keys, access_control: &Value) -> Result<Config, zenoh::Error> {
    let mut config = Config::default();
    let values = [
        ("mode", json!(mode)),
        ("scouting/multicast/enabled", json!(false)),
        ("scouting/gossip/enabled", json!(false)),
        ("adminspace/enabled", json!(false)),
        ("access_control", access_control.clone()),
        ("transport/unicast/accept_timeout", json!(HANDSHAKE)),
        ("transport/unicast/open_timeout", json!(OPENING)),
        ("transport/unicast/max_sessions", json!(SESSIONS)),
        ("transport/link/protocols", json!(["tls"])),
        ("transport/link/rx/max_message_size", json!(MESSAGE)),
        (
            "transport/link/tls",
            json!({
                "root_ca_certificate": keys.authority,
                "listen_private_key": keys.key,
                "listen_certificate": keys.certificate,
                "connect_private_key": keys.key,
                "connect_certificate": keys.certificate,
                "enable_mtls": true,
                // Zenoh also trusts public authorities when it connects, so only the name excludes their certificates.
                "verify_name_on_connect": true,
                "close_link_on_expiration": true,
            }),
        ),
    ];
    for (key, value) in values {
        config.insert_json5(key, &value.to_string())?;
    }
    Ok(config)
}

/// A gateway listens at an endpoint, and connects to a router if there is one.
pub fn gateway(
    cell: &Name,
    endpoint: Endpoint,
    router: Option<Endpoint>,
    keys: &Keys,
    allowed: &[Allow],
) -> Result<Config, zenoh::Error> {
    let space = CellKeys::of(cell.as_str());
    let mut certificates: Vec<(&Name, Rules)> = Vec::new();
    for allow in allowed {
        for name in &allow.names {
            let at = certificates.iter().position(|(known, _)| *known == name);
            let at = at.unwrap_or_else(|| {
                certificates.push((name, Rules::default()));
                certificates.len() - 1
            });
            let rules = &mut certificates[at].1;
            match allow.right {
                Right::Claim(role) => rules.claim(&space, role, name, Flow::Ingress),
                Right::Monitor => rules.status(&space, Flow::Egress),
            }
        }
    }
    let mut config = common("peer", keys, &access_control(&certificates))?;
    // Scouting is off, so opening need not wait for it.
    config.insert_json5("open/return_conditions/connect_scouted", "false")?;
    listen(&mut config, endpoint)?;
    let routers: Vec<_> = router.iter().map(ToString::to_string).collect();
    config.insert_json5("connect/endpoints", &json!(routers).to_string())?;
    // The router may be started later, or restart.
    config.insert_json5("connect/exit_on_failure", "false")?;
    config.insert_json5("connect/timeout_ms", "-1")?;
    config.insert_json5(
        "connect/retry",
        "{ period_init_ms: 100, period_max_ms: 1000, period_increase_factor: 2 }",
    )?;
    Ok(config)
}

fn listen(config: &mut Config, endpoint: Endpoint) -> Result<(), zenoh::Error> {
    let limited = format!("{endpoint}#tls_handshake_timeout_ms={HANDSHAKE}");
    config.insert_json5("listen/endpoints", &json!([limited]).to_string())
}

/// A router between gateways and monitors. Each cell writes its own status, and monitors read all.
pub fn router(
    endpoint: Endpoint,
    keys: &Keys,
    cells: &[Name],
    monitors: &[Name],
) -> Result<Config, zenoh::Error> {
    let cells = cells.iter().map(|cell| (cell, CellKeys::of(cell.as_str()), Flow::Ingress));
    let monitors = monitors.iter().map(|name| (name, CellKeys::of(ANY), Flow::Egress));
    let certificates: Vec<_> = cells
        .chain(monitors)
        .map(|(name, space, to_reader)| {
            let mut rules = Rules::default();
            rules.status(&space, to_reader);
            (name, rules)
        })
        .collect();
    let mut config = common("router", keys, &access_control(&certificates))?;
    listen(&mut config, endpoint)?;
    config.insert_json5("connect/endpoints", "[]")?;
    Ok(config)
}

/// A monitor: a client of one router or gateway, or a peer of several gateways, which keeps trying.
pub fn monitor(endpoints: &[Endpoint], keys: &Keys) -> Result<Config, zenoh::Error> {
    let is_client = endpoints.len() == 1;
    let mode = if is_client { "client" } else { "peer" };
    // Access control is off, because a monitor publishes nothing.
    let mut config = common(mode, keys, &json!({ "enabled": false }))?;
    config.insert_json5("open/return_conditions/connect_scouted", "false")?;
    config.insert_json5("listen/endpoints", "[]")?;
    let endpoints: Vec<_> = endpoints.iter().map(ToString::to_string).collect();
    config.insert_json5("connect/endpoints", &json!(endpoints).to_string())?;
    config.insert_json5("connect/exit_on_failure", &json!(is_client).to_string())?;
    config.insert_json5("connect/timeout_ms", if is_client { "0" } else { "-1" })?;
    Ok(config)
}

/// A neighbour accepts samples from the gateway of its cell only.
pub fn neighbour(cell: &Name, endpoint: Endpoint, role: Role, keys: &Keys) -> Result<Config, zenoh::Error> {
    let mut rules = Rules::default();
    rules.claim(&CellKeys::of(cell.as_str()), role, &keys.name, Flow::Egress);
    let mut config = common("client", keys, &access_control(&[(cell, rules)]))?;
    config.insert_json5("listen/endpoints", "[]")?;
    config.insert_json5("connect/endpoints", &json!([endpoint.to_string()]).to_string())?;
    config.insert_json5("connect/exit_on_failure", "true")?;
    // Without a retry the error states the cause. The program at the socket tries again.
    config.insert_json5("connect/timeout_ms", "0")?;
    Ok(config)
}
