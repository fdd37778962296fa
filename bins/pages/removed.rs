//! Options of earlier versions, which are refused with a sentence that names the new way.

use std::convert::Infallible;

use clap::Args;

/// Options for TLS in the controller, which `rcs-gateway` has replaced.
#[derive(Clone, Debug, Args)]
pub struct RemovedTls {
    /// Directory with keys
    #[arg(long, hide = true, num_args = 0..=1, default_missing_value = "", value_parser = refuse_keys)]
    keys: Option<Infallible>,
    /// Zenoh's configuration
    #[arg(long, hide = true, num_args = 0..=1, default_missing_value = "", value_parser = refuse_keys)]
    zenoh_config: Option<Infallible>,
}

/// The replacement for keys and for Zenoh in the controller.
pub const KEYS_MOVED: &str = "connections to other machines have moved into rcs-gateway, which takes --keys; \
                              tools/keys.sh makes the keys (docs/several-machines.md)";

fn refuse_keys(_: &str) -> Result<Infallible, &'static str> {
    Err(KEYS_MOVED)
}
