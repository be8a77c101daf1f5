//! New secrets, as text, URI and picture, and recovery codes.

use qrcodegen::{QrCode, QrCodeEcc};
use rand::RngCore;
use sha2::{Digest, Sha256};

use super::totp::base32;

/// Length that RFC 4226 recommends, that of the digest.
const SECRET_BYTES: usize = 20;
/// Recovery codes of a second factor.
const RECOVERY_CODES: usize = 10;
/// Random bytes of a recovery code: sixteen digits in base 32.
const RECOVERY_BYTES: usize = 10;
/// Light modules around a QR code that scanners need.
const QR_BORDER: i32 = 4;

/// Makes a secret.
pub(super) fn new_secret() -> Vec<u8> {
    let mut secret = vec![0; SECRET_BYTES];
    rand::rng().fill_bytes(&mut secret);
    secret
}

/// Makes recovery codes, each as four groups of four digits.
pub(super) fn new_recovery_codes() -> Vec<String> {
    let code = |_| {
        let mut bytes = [0; RECOVERY_BYTES];
        rand::rng().fill_bytes(&mut bytes);
        let digits = base32(&bytes).into_bytes();
        let groups = digits.chunks(4).map(String::from_utf8_lossy);
        groups.collect::<Vec<_>>().join("-")
    };
    (0..RECOVERY_CODES).map(code).collect()
}

/// Returns the digest by which a recovery code is stored, however it is grouped and cased. The codes are
/// random, so a plain hash tells nothing.
pub(super) fn recovery_digest(code: &str) -> String {
    let digits: String =
        code.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_uppercase();
    hex::encode(Sha256::digest(digits.as_bytes()))
}

/// Returns the URI that authenticator apps read.
pub(super) fn uri(issuer: &str, user_name: &str, secret: &[u8]) -> String {
    let (issuer, user) = (encoded(issuer), encoded(user_name));
    let secret = base32(secret);
    format!("otpauth://totp/{issuer}:{user}?secret={secret}&issuer={issuer}")
}

/// Percent-encodes all but unreserved characters (RFC 3986).
fn encoded(text: &str) -> String {
    let byte = |byte: u8| match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
            char::from(byte).to_string()
        }
        other => format!("%{other:02X}"),
    };
    text.bytes().map(byte).collect()
}

/// Draws a QR code as SVG; `None` for a text that is too long for one.
pub(super) fn qr_code(text: &str) -> Option<String> {
    let code = QrCode::encode_text(text, QrCodeEcc::Medium).ok()?;
    let places = (0..code.size()).flat_map(|y| (0..code.size()).map(move |x| (x, y)));
    let dark: String = places
        .filter(|&(x, y)| code.get_module(x, y))
        .map(|(x, y)| format!("M{} {}h1v1h-1z", x + QR_BORDER, y + QR_BORDER))
        .collect();
    let size = code.size() + 2 * QR_BORDER;
    Some(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {size} {size}\">\
         <path fill=\"#fff\" d=\"M0 0h{size}v{size}H0z\"/><path d=\"{dark}\"/></svg>"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_encoded() {
        assert_eq!(
            uri("Verbund platform", "eva@plant:1", b"foobar"),
            "otpauth://totp/Verbund%20platform:eva%40plant%3A1?secret=MZXW6YTBOI&issuer=Verbund%20platform"
        );
    }

    #[test]
    fn recovery_codes_are_found_however_they_are_typed() {
        let codes = new_recovery_codes();
        assert_eq!(codes.len(), RECOVERY_CODES);
        let code = &codes[0];
        assert_eq!(code.len(), 19, "{code}");
        let typed = code.to_lowercase().replace('-', " ");
        assert_eq!(recovery_digest(&typed), recovery_digest(code));
        assert_ne!(recovery_digest(&codes[1]), recovery_digest(code));
    }

    #[test]
    fn the_picture_is_a_square_with_a_border() {
        let picture = qr_code(&uri("Verbund", &"x".repeat(256), &new_secret())).expect("a code");
        assert!(picture.starts_with("<svg ") && picture.contains("M4 4h1v1h-1z"), "{picture}");
        assert_eq!(qr_code(&"x".repeat(5000)), None);
    }
}
