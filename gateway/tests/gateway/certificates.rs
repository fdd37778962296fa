//! Keys and certificates that the gateway does not accept.

use std::{
    fs,
    os::unix::fs::PermissionsExt as _,
    path::Path,
    process::{Command, Stdio},
};

use crate::shop::{CELL, Shop, eventually, make_keys};

pub fn openssl(shop: &Shop, arguments: &[&str]) -> String {
    let mut command = Command::new("openssl");
    command.args(["s_client", "-connect", &format!("127.0.0.1:{}", shop.port)]);
    command.arg("-CAfile").arg(shop.path("keys/ca.pem")).args(arguments);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // As long as its input is open, openssl reads until the gateway closes the connection.
    let input = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(input);
    String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned()
}

/// A certificate of the shop's authority, signed with the given extensions and validity.
fn sign(keys: &Path, name: &str, purpose: &str, validity: &[&str]) {
    let openssl = |arguments: &[&str]| {
        let done = Command::new("openssl").args(arguments).current_dir(keys).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    let file = |extension: &str| format!("{name}.{extension}");
    let (key, request, certificate) = (file("key"), file("csr"), file("pem"));
    openssl(&[
        "req",
        "-newkey",
        "ec",
        "-pkeyopt",
        "ec_paramgen_curve:P-256",
        "-nodes",
        "-subj",
        &format!("/CN={name}"),
        "-keyout",
        &key,
        "-out",
        &request,
    ]);
    fs::write(keys.join("ext"), format!("extendedKeyUsage={purpose}\nsubjectAltName=DNS:{name}\n")).unwrap();
    let signing = [
        "x509",
        "-req",
        "-in",
        &request,
        "-CA",
        "ca.pem",
        "-CAkey",
        "ca.key",
        "-CAcreateserial",
        "-extfile",
        "ext",
        "-out",
        &certificate,
    ];
    openssl(&[&signing[..], validity].concat());
    fs::set_permissions(keys.join(key), fs::Permissions::from_mode(0o600)).unwrap();
}

#[test]
fn wrong_certificates_are_refused_and_logged_with_the_reason() {
    let shop = Shop::new(&["hwsc-1"]);
    let keys = shop.path("keys");
    make_keys(&shop.path("foreign"), "t9", &["hwsc-1"]);
    sign(&keys, "server", "serverAuth", &["-days", "9"]);
    sign(&keys, "expired", "clientAuth", &["-days", "-1"]);
    let gateway = shop.serve(&["workstation=hwsc-1,server,expired"]);
    let file = |directory: &str, name: &str| shop.path(directory).join(name).display().to_string();
    let own = |directory: &str, name: &str| {
        [
            "-cert".to_owned(),
            file(directory, &format!("{name}.pem")),
            "-key".to_owned(),
            file(directory, &format!("{name}.key")),
        ]
    };
    for (what, arguments, reason) in [
        ("none", vec![], "peer sent no certificates"),
        ("of another authority", own("foreign", "hwsc-1").to_vec(), "UnknownIssuer"),
        ("of a server", own("keys", "server").to_vec(), "extended key usage"),
        ("expired", own("keys", "expired").to_vec(), "xpired"),
        ("TLS 1.2", [&["-tls1_2".to_owned()][..], &own("keys", "hwsc-1")].concat(), "SupportedVersions"),
    ] {
        let said = openssl(&shop, &arguments.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(said.contains("alert"), "{what}: {said}");
        assert!(
            eventually(|| gateway.errors().contains(reason)),
            "{what}: no {reason} in {}",
            gateway.errors()
        );
    }
}

#[test]
fn connect_reports_a_gateway_that_refuses_its_certificate() {
    let shop = Shop::new(&["hwsc-1"]);
    make_keys(&shop.path("foreign"), CELL, &["hwsc-1"]);
    let _gateway = shop.serve(&["workstation=hwsc-1"]);
    fs::copy(shop.path("foreign/hwsc-1.pem"), shop.path("keys/hwsc-1.pem")).unwrap();
    fs::copy(shop.path("foreign/hwsc-1.key"), shop.path("keys/hwsc-1.key")).unwrap();
    let connect = shop.connect("workstation", "hwsc-1");
    connect.wait_for("does it accept the certificate of hwsc-1?");
    assert_eq!(shop.hwsc("hwsc-1").err().unwrap(), "closed");
}

/// Each mistake ends the gateway with status 2 and a sentence that names it.
#[test]
fn unusable_keys_addresses_and_options_are_named() {
    let shop = Shop::new(&["hwsc-1"]);
    let keys = shop.path("keys");
    let fails = |allow: &[&str], expected: &str| {
        let mut gateway = shop.start_serve(allow);
        assert_eq!(gateway.finish().code(), Some(2), "{}", gateway.errors());
        assert!(gateway.errors().contains(expected), "expected {expected:?} in {}", gateway.errors());
    };
    fails(&["workstaton=hwsc-1"], "expected workstation, data-system, pedestal, vision, operator or monitor");
    fails(&["workstation"], "expected ROLE=NAME");
    let key = keys.join("t3.key");
    fs::set_permissions(&key, fs::Permissions::from_mode(0o640)).unwrap();
    fails(&["workstation=hwsc-1"], "other users can read this private key (mode 640)");
    fs::set_permissions(&key, fs::Permissions::from_mode(0o600)).unwrap();
    {
        let _other = shop.serve(&["workstation=hwsc-1"]);
        fails(&["workstation=hwsc-1"], "Address already in use");
    }
    fs::rename(keys.join("t3.pem"), keys.join("t4.pem")).unwrap();
    fails(&["workstation=hwsc-1"], "tools/keys.sh makes keys and certificates");
    sign(&keys, "t3", "serverAuth", &["-days", "-1"]);
    fails(&["workstation=hwsc-1"], "make a new certificate");
}
