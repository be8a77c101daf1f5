//! Bounds of what a peer may send, where the stack reads it first.

use std::sync::Arc;

use bytes::BytesMut;
use opcua_stack::opcua::{
    core::{
        comms::{
            secure_channel::{Role, SecureChannel},
            security_header::AsymmetricSecurityHeader,
            tcp_codec::{Message, TcpCodec},
        },
        sync::RwLock,
    },
    crypto::{self, CertificateStore, SecurityPolicy, X509, X509Data},
    types::{
        Argument, BinaryDecodable, ContextOwned, DataValue, DecodingOptions, DiagnosticInfo,
        ExtensionObject, MessageSecurityMode, NamespaceMap, SimpleBinaryEncodable, StatusCode,
        UAString, UserNameIdentityToken, UserTokenPolicy, Variant,
    },
};
use tokio_util::codec::Decoder;

fn context() -> ContextOwned {
    let options = DecodingOptions {
        max_string_length: 16 << 20,
        max_byte_string_length: 16 << 20,
        max_array_length: 1_000_000,
        ..DecodingOptions::default()
    };
    ContextOwned::new_default(NamespaceMap::new(), options)
}

/// Address space that this process has asked for so far, in MiB.
fn asked_for() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find(|line| line.starts_with("VmPeak:")).expect("a line");
    let kib: usize = line.split_whitespace().nth(1).expect("a number").parse().expect("a number");
    kib / 1024
}

#[test]
fn a_message_is_refused_by_its_header_where_it_is_too_large() {
    let refusal = |codec: &mut TcpCodec, kind: &[u8; 4], size: u32| {
        let mut bytes = BytesMut::from(kind.as_slice());
        bytes.extend(size.to_le_bytes());
        codec.decode(&mut bytes).err().map(|error| TcpCodec::status_of(&error))
    };
    let too_large = Some(StatusCode::BadTcpMessageTooLarge);
    for (kind, largest) in [
        (b"HELF", 8192),
        (b"ACKF", 8192),
        (b"ERRF", 8192),
        (b"RHEF", 8192),
        (b"MSGF", 65_536),
        (b"OPNF", 65_536),
    ] {
        let mut codec = TcpCodec::new(DecodingOptions::default());
        assert_eq!(refusal(&mut codec, kind, largest), None, "{kind:?}");
        assert_eq!(refusal(&mut codec, kind, largest + 1), too_large, "{kind:?}");
        assert_eq!(refusal(&mut codec, kind, u32::MAX), too_large, "{kind:?}");
    }
    let mut codec = TcpCodec::new(DecodingOptions::default()).with_max_chunk_size(8192);
    assert_eq!(refusal(&mut codec, b"MSGF", 8193), too_large, "as negotiated");
    assert!(refusal(&mut codec, b"XXXF", 100).is_some(), "of no type");
    assert!(refusal(&mut codec, b"MSGF", 7).is_some(), "shorter than its header");
    let whole =
        [b"ERRF".as_slice(), &16_u32.to_le_bytes(), &[0; 4], &(-1_i32).to_le_bytes()].concat();
    let decoded = codec.decode(&mut BytesMut::from(whole.as_slice())).expect("decoded");
    assert!(matches!(decoded, Some(Message::Error(_))), "{decoded:?}");
}

/// The certificate of a server with its key in a folder.
fn store(folder: &std::path::Path) -> CertificateStore {
    let description = X509Data {
        key_size: 2048,
        common_name: "server".into(),
        organization: "test".into(),
        organizational_unit: String::new(),
        country: String::new(),
        state: String::new(),
        alt_host_names: X509Data::alt_host_names("urn:test", None, false, true, false),
        certificate_duration_days: 10,
    };
    let (certificate, key) = (folder.join("own/cert.der"), folder.join("private/private.pem"));
    CertificateStore::create_certificate_and_key(&description, true, &certificate, &key)
        .expect("created");
    CertificateStore::new(folder)
}

/// A request for a channel: its headers, then noise in place of what is encrypted.
fn request(policy: SecurityPolicy, certificate: &X509, noise: usize) -> bytes::Bytes {
    let header = AsymmetricSecurityHeader::new(
        policy,
        certificate,
        certificate.thumbprint().as_byte_string(),
    );
    let mut body = 0_u32.to_le_bytes().to_vec();
    header.encode(&mut body).expect("encoded");
    body.extend(vec![7; noise]);
    let size = u32::try_from(body.len() + 8).expect("short");
    [b"OPNF".as_slice(), &size.to_le_bytes(), &body].concat().into()
}

#[test]
fn a_policy_that_no_endpoint_offers_never_reaches_the_private_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = Arc::new(RwLock::new(store(folder.path())));
    let certificate = store.read().read_own_cert().expect("a certificate");
    let channel = |has_key: bool| {
        let mut channel = SecureChannel::new(Arc::clone(&store), Role::Server, Arc::default());
        channel.set_accepted_policies(vec![SecurityPolicy::None, SecurityPolicy::Basic256Sha256]);
        if !has_key {
            channel.set_private_key(None);
        }
        channel
    };
    let answer = |channel: &mut SecureChannel, policy, noise| {
        let request = request(policy, &certificate, noise);
        channel
            .verify_and_remove_security_server(request)
            .map(|_| ())
            .map_err(|error| error.status())
    };
    for policy in [
        SecurityPolicy::Basic128Rsa15,
        SecurityPolicy::Basic256,
        SecurityPolicy::Aes256Sha256RsaPss,
    ] {
        // The same with a key as without: it was not asked for.
        for has_key in [true, false] {
            let refused = answer(&mut channel(has_key), policy, 256);
            assert_eq!(refused, Err(StatusCode::BadSecurityPolicyRejected), "{policy} {has_key}");
        }
    }
    let offered = SecurityPolicy::Basic256Sha256;
    assert_eq!(answer(&mut channel(false), offered, 256), Err(StatusCode::BadNoValidCertificates));
    for noise in [0, 1, 255, 256, 512, 60_000] {
        let refused = answer(&mut channel(true), offered, noise);
        assert_eq!(refused, Err(StatusCode::BadSecurityChecksFailed), "{noise} bytes");
    }

    // Also where nothing says what is offered, PKCS#1 v1.5 and SHA-1 signatures are not.
    let mut open = SecureChannel::new(Arc::clone(&store), Role::Server, Arc::default());
    for policy in [SecurityPolicy::Basic128Rsa15, SecurityPolicy::Basic256] {
        assert!(!policy.is_supported(), "{policy}");
        assert_eq!(answer(&mut open, policy, 256), Err(StatusCode::BadSecurityPolicyRejected));
    }
    // A channel that is open keeps its policy, and so does a client's from the beginning.
    let mut opened = channel(true);
    opened.set_secure_channel_id(1);
    opened.set_security_policy(offered);
    let downgraded = answer(&mut opened, SecurityPolicy::None, 0);
    assert_eq!(downgraded, Err(StatusCode::BadSecurityPolicyRejected));
    let mut client = SecureChannel::new(Arc::clone(&store), Role::Client, Arc::default());
    client.set_security_policy(offered);
    let answered = request(SecurityPolicy::None, &certificate, 0);
    assert!(client.verify_and_remove_security(answered).is_err());
}

#[test]
fn passwords_are_neither_encrypted_nor_decrypted_with_pkcs1_v1_5() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = store(folder.path());
    let certificate = store.read_own_cert().expect("a certificate");
    let policy = UserTokenPolicy {
        security_policy_uri: SecurityPolicy::Basic128Rsa15.to_uri().into(),
        ..UserTokenPolicy::default()
    };
    let encrypt = |certificate: &Option<X509>, policy: &UserTokenPolicy| {
        let (channel, mode) = (SecurityPolicy::Basic256Sha256, MessageSecurityMode::SignAndEncrypt);
        crypto::legacy_encrypt_secret(channel, mode, policy, &[1; 32], certificate, b"secret")
    };
    let refused = encrypt(&Some(certificate.clone()), &policy).err().map(|error| error.status());
    assert_eq!(refused, Some(StatusCode::BadSecurityPolicyRejected));
    assert!(encrypt(&None, &UserTokenPolicy::default()).is_err(), "to nobody");

    let key = store.read_own_pkey().expect("a key");
    let mut token = UserNameIdentityToken {
        encryption_algorithm: UAString::from("http://www.w3.org/2001/04/xmlenc#rsa-1_5"),
        password: vec![7; 256].into(),
        ..UserNameIdentityToken::default()
    };
    let reason = crypto::legacy_decrypt_secret(&token, &[1; 32], &key).expect_err("refused");
    assert!(reason.to_string().contains("unsupported encryption algorithm"), "{reason}");
    // And a secret that is no whole block is an error rather than a panic.
    token.encryption_algorithm = UAString::from("http://www.w3.org/2001/04/xmlenc#rsa-oaep");
    for length in [1, 255, 257] {
        token.password = vec![7; length].into();
        assert!(crypto::legacy_decrypt_secret(&token, &[1; 32], &key).is_err());
    }
}

#[test]
fn values_nest_to_a_depth_and_no_deeper() {
    let context = context();
    let inner = |level: &[u8], depth: usize| {
        let mut bytes = level.repeat(depth);
        bytes.push(0);
        bytes
    };
    for depth in [100, 1_000_000] {
        let bytes = inner(&[0x40], depth);
        assert!(DiagnosticInfo::decode(&mut bytes.as_slice(), &context.context()).is_err());
        let bytes = inner(&[0x01, 23], depth);
        assert!(DataValue::decode(&mut bytes.as_slice(), &context.context()).is_err());
        let bytes = inner(&[24], depth);
        assert!(Variant::decode(&mut bytes.as_slice(), &context.context()).is_err());
    }
    for depth in [0, 1, 5] {
        let bytes = inner(&[0x40], depth);
        assert!(DiagnosticInfo::decode(&mut bytes.as_slice(), &context.context()).is_ok());
    }
}

#[test]
fn lengths_that_are_claimed_take_no_memory() {
    let context = context();
    let before = asked_for();
    let claim = i32::MAX.to_le_bytes();
    // Extension objects of unknown type, in binary and in XML.
    for encoding in [1, 2] {
        let bytes = [[2, 9, 0xFF, 0x7F, encoding].as_slice(), &claim].concat();
        assert!(ExtensionObject::decode(&mut bytes.as_slice(), &context.context()).is_err());
    }
    // Within the limits of a trusted peer: texts, byte strings, arrays of each kind.
    for (kind, length) in [
        (12, 16 << 20),
        (15, 16 << 20),
        (0x80 | 12, 1_000_000),
        (0x80 | 24, 1_000_000),
        (0x80, 1_000_000),
        (0x80 | 30, 1_000_000),
    ] {
        let bytes = [[kind].as_slice(), &i32::to_le_bytes(length), &[0; 3]].concat();
        for _ in 0..8 {
            assert!(Variant::decode(&mut bytes.as_slice(), &context.context()).is_err());
        }
    }
    let grown = asked_for() - before;
    assert!(grown < 8, "{grown} MiB were asked for");
}

/// A value may be a single byte of a message, and thirty in memory.
#[test]
fn a_message_takes_bounded_memory_once_it_is_decoded() {
    const ARRAYS: i32 = 20;
    const LENGTH: usize = 1_000_000;
    let context = context();
    // A variant that is an array of variants, each an array of booleans.
    let mut bytes = vec![0x80 | 24];
    bytes.extend(ARRAYS.to_le_bytes());
    for _ in 0..ARRAYS {
        bytes.push(0x80 | 1);
        bytes.extend(i32::try_from(LENGTH).expect("fits").to_le_bytes());
        bytes.resize(bytes.len() + LENGTH, 0);
    }
    let before = asked_for();
    let refused = Variant::decode(&mut bytes.as_slice(), &context.context());
    let status = refused.err().map(|error| error.status());
    assert_eq!(status, Some(StatusCode::BadEncodingLimitsExceeded));
    let grown = asked_for() - before;
    assert!(grown < 150, "{grown} MiB were asked for");
    // One of them is a value that people have.
    let one = &bytes[5..5 + 5 + LENGTH];
    assert!(Variant::decode(&mut &*one, &context.context()).is_ok());
}

/// The header of any request may have an argument in it, before a sign-in, too.
#[test]
fn the_rank_of_an_argument_takes_no_memory() {
    let context = context();
    let argument = |rank: i32, dimensions: &[u32]| {
        // No name, the data type i=0, the rank, its dimensions, a description without texts.
        let mut bytes = vec![0xFF, 0xFF, 0xFF, 0xFF, 0, 0];
        bytes.extend(rank.to_le_bytes());
        bytes.extend(u32::try_from(dimensions.len()).expect("few").to_le_bytes());
        bytes.extend(dimensions.iter().flat_map(|length| length.to_le_bytes()));
        bytes.push(0);
        Argument::decode(&mut bytes.as_slice(), &context.context())
    };
    let before = asked_for();
    for rank in [65, 1_000, 1_000_000, i32::MAX] {
        assert!(argument(rank, &[]).is_err(), "{rank}");
        assert!(argument(rank, &[7]).is_err(), "{rank}");
    }
    let grown = asked_for() - before;
    assert!(grown < 8, "{grown} MiB were asked for");
    // As fuzzing found it: two of them in a structure among the values of a Write request, which took 400 MB.
    let found = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/corpus/services/rank_of_an_argument");
    crate::corpus::services(&std::fs::read(found).expect("an input"));
    let grown = asked_for() - before;
    assert!(grown < 8, "{grown} MiB were asked for");
    let filled = argument(2, &[7]).expect("decoded");
    assert_eq!(filled.array_dimensions, Some(vec![7, 0]));
    assert!(argument(1, &[7, 8]).is_err(), "more than the rank");
}
