//! Bytes that a glTF document names: in a file beside it, or written into it (`data:`, RFC 2397, base64).

use crate::mesh::job::Job;
use crate::system::file::FileError;

/// Whether the bytes stand in the document itself.
pub(super) fn is_data(uri: &str) -> bool {
    uri.starts_with("data:")
}

/// The bytes that a document names, at most `limit` of them.
pub(super) fn bytes(uri: &str, limit: u64, job: &Job) -> Result<Vec<u8>, FileError> {
    if !is_data(uri) {
        return job.needed(&decoded(uri), limit);
    }
    let fault = |what: &str| job.fault(what, "write data:application/octet-stream;base64, and the bytes");
    let (head, body) = uri.split_once(',').ok_or_else(|| fault("a data uri has no comma"))?;
    if !head.ends_with(";base64") {
        return Err(fault("a data uri is not in base64"));
    }
    if body.len() as u64 / 4 * 3 > limit {
        return Err(fault("a data uri is too long"));
    }
    base64(body).ok_or_else(|| fault("a data uri is not in base64"))
}

/// A name with its %-signs read; where one leads to no text, as it stands.
pub(super) fn decoded(uri: &str) -> String {
    let digit = |b: Option<&u8>| b.and_then(|b| char::from(*b).to_digit(16));
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        match (bytes[at], digit(bytes.get(at + 1)), digit(bytes.get(at + 2))) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8(out).unwrap_or_else(|_| uri.to_owned())
}

/// The bytes of a text in base64 (RFC 4648), padded or not.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let value = |c: u8| {
        Some(match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        })
    };
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for four in text.chunks(4) {
        let mut bits = 0u32;
        for c in four {
            bits = bits << 6 | u32::from(value(*c)?);
        }
        match four.len() {
            4 => out.extend(&bits.to_be_bytes()[1..]),
            3 => out.extend(&(bits << 6).to_be_bytes()[1..3]),
            2 => out.extend(&(bits << 12).to_be_bytes()[1..2]),
            _ => return None,
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_bytes_of_the_standards_examples() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE", "fooba")] {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes());
        }
        assert_eq!((base64("Z"), base64("Zm9?")), (None, None));
    }

    #[test]
    fn percent_signs_are_read_where_they_mean_something() {
        assert_eq!(decoded("a%20b%2Fc.bin"), "a b/c.bin");
        assert_eq!(decoded("100%.bin%"), "100%.bin%");
        assert_eq!(decoded("%ff"), "%ff");
    }
}
