//! An authenticator app: codes by time (RFC 6238) of a secret in base 32.

use std::time::SystemTime;

use hmac::{Hmac, Mac as _};
use sha1::Sha1;

/// Returns the code that an app shows, `steps` of 30 seconds from now.
#[must_use]
#[expect(clippy::disallowed_methods, reason = "an app has a clock of its own")]
pub fn code(secret: &str, steps: i64) -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).expect("after 1970");
    let step = i64::try_from(now.as_secs() / 30).expect("a number") + steps;
    code_of(&bytes(secret), step)
}

fn code_of(secret: &[u8], step: i64) -> String {
    let mut mac = Hmac::<Sha1>::new_from_slice(secret).expect("a key");
    mac.update(&step.to_be_bytes());
    let digest = mac.finalize().into_bytes();
    let offset = usize::from(digest[19] & 15);
    let number = u32::from_be_bytes(digest[offset..offset + 4].try_into().expect("four bytes"));
    format!("{:06}", (number & 0x7fff_ffff) % 1_000_000)
}

/// Reads base 32; bits beyond whole bytes are padding.
fn bytes(secret: &str) -> Vec<u8> {
    let digits = secret.bytes().map(|digit| match digit {
        b'A'..=b'Z' => digit - b'A',
        _ => digit - b'2' + 26,
    });
    let bits: Vec<u8> =
        digits.flat_map(|digit| (0..5).rev().map(move |bit| (digit >> bit) & 1)).collect();
    bits.chunks_exact(8).map(|byte| byte.iter().fold(0, |sum, bit| (sum << 1) | bit)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_the_standard() {
        // RFC 6238, appendix B, of which six digits count.
        assert_eq!(bytes("GEZDGNBVGY3TQOJQGEZDGNBVGY3TQOJQ"), b"12345678901234567890");
        assert_eq!(code_of(b"12345678901234567890", 1), "287082");
    }
}
