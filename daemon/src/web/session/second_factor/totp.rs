//! Codes by time (RFC 6238): HMAC-SHA1, 30 seconds, six digits, as authenticator apps expect.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use hmac::{Hmac, Mac};
use sha1::Sha1;
use subtle::ConstantTimeEq;

const STEP: Duration = Duration::from_secs(30);
/// Number of codes.
const MODULUS: u32 = 1_000_000;
/// Clocks of phones differ from ours by at most one step.
const STEPS_BESIDE: u64 = 1;
/// Digits of RFC 4648 in base 32.
const BASE32: &[u8; 32] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";

/// Returns the time step of a code of now or of the steps beside; `None` for a wrong code.
pub(super) fn step_of(secret: &[u8], code: &str, now: SystemTime) -> Option<u64> {
    let current = now.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs() / STEP.as_secs();
    let steps = current.saturating_sub(STEPS_BESIDE)..=current + STEPS_BESIDE;
    // All are compared: the time it takes does not tell which one was near.
    steps.fold(None, |found, step| {
        let is_equal = bool::from(self::code(secret, step).as_bytes().ct_eq(code.as_bytes()));
        if is_equal { Some(step) } else { found }
    })
}

/// Returns the code of a time step.
pub(super) fn code(secret: &[u8], step: u64) -> String {
    let mut mac = Hmac::<Sha1>::new_from_slice(secret).expect("HMAC takes keys of any length");
    mac.update(&step.to_be_bytes());
    let digest = mac.finalize().into_bytes();
    // RFC 4226, 5.3: the last four bits say where the number begins, and its sign is dropped.
    let offset = usize::from(digest[19] & 0x0f);
    let mut number = [0; 4];
    number.copy_from_slice(&digest[offset..offset + 4]);
    format!("{:06}", (u32::from_be_bytes(number) & 0x7fff_ffff) % MODULUS)
}

/// Writes bytes in base 32 (RFC 4648) without padding.
pub(super) fn base32(bytes: &[u8]) -> String {
    let (mut text, mut bits, mut count) = (String::new(), 0_u32, 0);
    for byte in bytes {
        bits = ((bits << 8) | u32::from(*byte)) & 0xffff;
        count += 8;
        while count >= 5 {
            count -= 5;
            text.push(char::from(BASE32[((bits >> count) & 31) as usize]));
        }
    }
    if count > 0 {
        text.push(char::from(BASE32[((bits << (5 - count)) & 31) as usize]));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECRET: &[u8] = b"12345678901234567890";

    #[test]
    fn codes_are_those_of_the_standard() {
        // RFC 6238, appendix B, of which six digits count.
        for (seconds, expected) in [
            (59, "287082"),
            (1_111_111_109, "081804"),
            (1_111_111_111, "050471"),
            (1_234_567_890, "005924"),
            (2_000_000_000, "279037"),
            (20_000_000_000, "353130"),
        ] {
            assert_eq!(code(SECRET, seconds / 30), expected);
        }
    }

    #[test]
    fn clocks_may_differ_by_one_step() {
        let at = |seconds| UNIX_EPOCH + Duration::from_secs(seconds);
        for (seconds, expected) in
            [(0, None), (30, Some(2)), (89, Some(2)), (119, Some(2)), (120, None)]
        {
            assert_eq!(step_of(SECRET, &code(SECRET, 2), at(seconds)), expected, "{seconds}");
        }
        assert_eq!(step_of(SECRET, "", at(60)), None);
    }

    #[test]
    fn base32_is_that_of_the_standard() {
        // RFC 4648, 10.
        for (bytes, expected) in
            [("", ""), ("f", "MY"), ("fo", "MZXQ"), ("foo", "MZXW6"), ("foobar", "MZXW6YTBOI")]
        {
            assert_eq!(base32(bytes.as_bytes()), expected);
        }
    }
}
